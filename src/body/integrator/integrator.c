/* The integrators that there are, by the type of their TS. */
#include <body/layout/bodyimpl.h>

static const struct {
  const char *type, *meaning;
  PetscErrorCode (*create)(BodyIntegrator);
} known[] = {
    {TSALPHA2, "implicit", BodyIntegratorCreate_Implicit},
    {TSCENTRALDIFFERENCE, "explicit", BodyIntegratorCreate_Explicit},
    {TSSTATIC, "without inertia", BodyIntegratorCreate_Static},
    {TSRIGID, "rigid", BodyIntegratorCreate_Rigid},
};
#define N_KNOWN ((PetscInt)(sizeof(known) / sizeof(known[0])))

/* The types and their meanings, for an error message */
static PetscErrorCode ListKnown(char text[], size_t size)
{
  size_t used = 0;

  PetscFunctionBegin;
  text[0] = 0;
  for (PetscInt i = 0; i < N_KNOWN; i++) {
    PetscCall(PetscSNPrintf(text + used, size - used, "%s%s (%s)", i ? ", " : "", known[i].type, known[i].meaning));
    PetscCall(PetscStrlen(text, &used));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The integrator for a TS of that type, as body->integrator, in place of the present one, which stays where the type is unknown */
PetscErrorCode BodyIntegratorCreate(Body body, const char type[])
{
  char text[256];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < N_KNOWN; i++) {
    PetscBool same;

    PetscCall(PetscStrcmp(type, known[i].type, &same));
    if (!same) continue;
    PetscCall(BodyIntegratorDestroy(body));
    PetscCall(PetscNew(&body->integrator));
    body->integrator->type    = known[i].type;
    body->integrator->deforms = PETSC_TRUE;
    PetscCall((*known[i].create)(body->integrator));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ListKnown(text, sizeof(text)));
  SETERRQ(PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_UNKNOWN_TYPE, "Unknown -%sts_type '%s'; known: %s", ((PetscObject)body)->prefix,
          type, text);
}

PetscErrorCode BodyIntegratorDestroy(Body body)
{
  PetscFunctionBegin;
  if (!body->integrator) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->integrator->ops.destroy) PetscCall((*body->integrator->ops.destroy)(body));
  PetscCall(PetscFree(body->integrator->data));
  PetscCall(PetscFree(body->integrator));
  PetscFunctionReturn(PETSC_SUCCESS);
}
