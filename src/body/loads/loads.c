/* Loads of a body from options: displacements that are prescribed on its surfaces, forces from outside, and its initial state. */
#include "loadsimpl.h"

/* PetscStrToArray() would skip it */
static PetscBool HasEmptyName(const char text[])
{
  for (const char *c = text;; c++) {
    const size_t length = strcspn(c, ",");

    if (strspn(c, " \t") >= length) return PETSC_TRUE;
    c += length;
    if (!*c) return PETSC_FALSE;
  }
}

/* The names in a list such as -<body>_boundary_traction a,b; none if it is not given */
static PetscErrorCode GetNames(Body body, const char name[], PetscInt *n, char ***names)
{
  MPI_Comm    comm   = PetscObjectComm((PetscObject)body);
  const char *prefix = ((PetscObject)body)->prefix, *text;
  int         count  = 0;
  PetscBool   twice  = PETSC_FALSE;

  PetscFunctionBegin;
  *n     = 0;
  *names = NULL;
  PetscCall(BodyLoadsGetText(body, name, &text));
  if (!text) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(!HasEmptyName(text), comm, PETSC_ERR_USER_INPUT,
             "-%s%s '%s' has an empty name in it; give names of surfaces with commas between them", prefix, name, text);
  PetscCall(PetscStrToArray(text, ',', &count, names));
  for (int i = 0; i < count && !twice; i++)
    for (int k = 0; k < i && !twice; k++) PetscCall(PetscStrcasecmp((*names)[i], (*names)[k], &twice));
  if (twice) PetscCall(PetscStrToArrayDestroy(count, *names));
  PetscCheck(!twice, comm, PETSC_ERR_USER_INPUT, "-%s%s '%s' names a surface twice (upper and lower case are the same in options)", prefix,
             name, text);
  *n = count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The value of -<body>_<list>_<surface> */
static PetscErrorCode GetSurfaceText(Body body, const char list[], const char surface[], const char *text[])
{
  const char *prefix = ((PetscObject)body)->prefix, *const zeros[] = {"0", "0,0", "0,0,0"};
  char name[LOADS_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_%s", list, surface));
  PetscCall(BodyLoadsGetText(body, name, text));
  PetscCheck(*text, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%s%s names '%s', but its components are missing; give them, as in -%s%s %s", prefix, list, surface, prefix, name,
             zeros[body->mesh.dim - 1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What -<body>_<list> names, with the components of each */
static PetscErrorCode ReadSurfaces(Body body, const char list[], PetscInt n, char **names,
                                   PetscErrorCode (*add)(Body, const char[], const char[]))
{
  const char *text;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    PetscCall(GetSurfaceText(body, list, names[i], &text));
    PetscCall((*add)(body, names[i], text));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadGravity(Body body, const char text[])
{
  struct _BodyLoads *loads    = body->loads;
  Expression         list[3]  = {NULL};
  PetscBool          constant = PETSC_TRUE;

  PetscFunctionBegin;
  if (!text) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyLoadsGetComponents(body, "gravity", text, PETSC_FALSE, list));
  loads->has_gravity = PETSC_TRUE;
  for (PetscInt d = 0; d < body->mesh.dim; d++) {
    PetscBool is_number;

    PetscCall(ExpressionIsConstant(list[d], &is_number, &loads->gravity[d]));
    if (!is_number) constant = PETSC_FALSE;
    PetscCall(ExpressionDestroy(&list[d]));
  }
  PetscCall(BodyLoadsCheckGravity(body));
  PetscCheck(constant, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sgravity '%s': components are numbers; -%sbody_force takes formulas", ((PetscObject)body)->prefix, text,
             ((PetscObject)body)->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prescribed displacements, tractions, gravity and body forces, the initial state, and what leads a rigid body, from the options of a body
   with mesh and elements, see options/README.md. Where several surfaces prescribe a component of a node, that named last holds; `free` says
   nothing of it. Nodes of rings on the axis are held in x. Velocity and acceleration of prescribed displacements, the initial velocity too,
   are differences in time, ExpressionEvaluateRates(). Collective. */
PetscErrorCode BodyLoadsSetFromOptions(Body body)
{
  PetscInt       n_displacements = 0, n_tractions = 0;
  char         **displacements = NULL, **tractions = NULL;
  const char    *gravity, *body_force, *lead[2] = {NULL, NULL};
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCheck(!body->loads, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Body '%s' has its loads already", body->hdr.name);
  PetscCall(BodyLoadsReadInitialState(body));
  PetscCall(BodyLoadsGetText(body, "gravity", &gravity));
  PetscCall(BodyLoadsGetText(body, "body_force", &body_force));
  if (!body->integrator->deforms) { /* else unused options */
    PetscCall(BodyLoadsGetText(body, "rigid_displacement", &lead[0]));
    PetscCall(BodyLoadsGetText(body, "rigid_rotation", &lead[1]));
  }
  PetscCall(GetNames(body, "boundary_displacement", &n_displacements, &displacements));
  error = GetNames(body, "boundary_traction", &n_tractions, &tractions);
  if (!error && (gravity || body_force || n_displacements || n_tractions || lead[0] || lead[1])) {
    error = PetscNew(&body->loads);
    if (!error && lead[0]) error = BodyLoadsSetRigidDisplacement(body, lead[0]);
    if (!error && lead[1]) error = BodyLoadsSetRigidRotation(body, lead[1]);
    if (!error) error = ReadSurfaces(body, "boundary_displacement", n_displacements, displacements, BodyLoadsAddDisplacement);
    if (!error) error = BodyLoadsSetUpHeld(body);
    if (!error) error = ReadSurfaces(body, "boundary_traction", n_tractions, tractions, BodyLoadsAddTraction);
    if (!error && body_force) error = BodyLoadsAddBodyForce(body, body_force);
    if (!error) error = ReadGravity(body, gravity);
  }
  if (!error) error = BodyLoadsHoldAxis(body);
  if (n_displacements) PetscCall(PetscStrToArrayDestroy((int)n_displacements, displacements));
  if (n_tractions) PetscCall(PetscStrToArrayDestroy((int)n_tractions, tractions));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLoadsDestroy(Body body)
{
  PetscFunctionBegin;
  if (!body->loads) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyLoadsDestroyHeld(body->loads));
  for (PetscInt i = 0; i < 6; i++) PetscCall(ExpressionDestroy(&body->loads->lead[i]));
  PetscCall(BodyLoadsDestroyForces(body->loads));
  PetscCall(PetscFree(body->loads));
  PetscFunctionReturn(PETSC_SUCCESS);
}
