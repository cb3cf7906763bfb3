/* Loads that come suddenly, at the start of a run, and a factor that lets them grow. */
#include "loadsimpl.h"

/* Controller steps over which such a factor lets a load grow; a step that fails later does not fail for it */
#define STEPS 10

/* Whether a component is not zero at the start, whatever the place. One that depends on time and place is taken to grow. */
static PetscErrorCode IsSudden(Expression component, PetscReal start, PetscBool *sudden)
{
  const ExpressionPoint point = {.t = start};
  PetscBool             steady, uniform;
  PetscReal             value = 0;

  PetscFunctionBegin;
  *sudden = PETSC_FALSE;
  if (!component) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ExpressionGetNature(component, &steady, &uniform, NULL));
  if (uniform) PetscCall(ExpressionEvaluate(component, &point, &value));
  *sudden = uniform ? (PetscBool)(value != 0) : steady;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The option of the first of the components that is sudden, but for a table, which cannot stand in a formula; else as it was */
static PetscErrorCode FindSudden(Body body, const Expression components[], const char *option[])
{
  PetscFunctionBegin;
  for (PetscInt d = 0; d < body->mesh.dim && !*option; d++) {
    const char *formula;
    PetscBool   sudden, table = PETSC_FALSE;

    PetscCall(IsSudden(components[d], body->time.start, &sudden));
    if (!sudden) continue;
    PetscCall(ExpressionGetText(components[d], &formula));
    PetscCall(PetscStrbeginswith(formula, "table:", &table));
    if (!table) PetscCall(ExpressionGetOption(components[d], option));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A remedy where a step fails soon after the start: "A load comes suddenly: ..." with a factor that lets it grow, and its option; empty
   where no load or prescribed displacement is there at once, or after the first ten controller steps. Gravity takes no formula: a force in
   the volume of a static body does. Bodies with inertia fall as they are to. */
PetscErrorCode BodyDescribeSuddenLoad(Body body, char text[BODY_SUDDEN_LENGTH])
{
  const struct _BodyLoads *loads  = body->loads;
  const char              *prefix = ((PetscObject)body)->prefix, *option = NULL;
  const double             start = (double)body->time.start, duration = (double)(STEPS * body->time.whole_step);
  char                     time[32] = "t", of[256];

  PetscFunctionBegin;
  text[0] = 0;
  if (!loads || !(body->saved.time - body->time.start < STEPS * body->time.whole_step)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < loads->n_loads; i++) PetscCall(FindSudden(body, loads->loads[i].component, &option));
  for (PetscInt i = 0; i < loads->n_prescribed; i++) PetscCall(FindSudden(body, loads->prescribed[i].component, &option));
  if (option) PetscCall(PetscSNPrintf(of, sizeof(of), "-%s", option));
  else if (!loads->has_gravity || body->integrator->has_inertia) PetscFunctionReturn(PETSC_SUCCESS);
  else PetscCall(PetscSNPrintf(of, sizeof(of), "-%sbody_force, of density times -%sgravity in place of that", prefix, prefix));
  if (start != 0) PetscCall(PetscSNPrintf(time, sizeof(time), "(t%+.9g)", -start));
  PetscCall(PetscSNPrintf(text, BODY_SUDDEN_LENGTH,
                          "A load comes suddenly: let it grow, as over %d controller steps by a factor of min(1,%s/%.4g) in %s", STEPS,
                          time, duration, of));
  PetscFunctionReturn(PETSC_SUCCESS);
}
