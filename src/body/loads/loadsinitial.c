/* Displacement and velocity at the start, from options. */
#include "loadsimpl.h"

/* Composed with the body where the option of that name is given */
static const char *const initial[] = {"initial_displacement", "initial_velocity"};

static PetscErrorCode Evaluate(Body body, const Expression list[], Vec values)
{
  PetscScalar *value;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(values, &value));
  for (PetscInt node = 0; node < body->owned_nodes; node++) {
    ExpressionPoint point = {{0}, {0}, 0};

    for (PetscInt d = 0; d < body->dim; d++) point.x[d] = body->coordinates[node * body->dim + d];
    for (PetscInt d = 0; d < body->dim; d++) {
      PetscReal component;

      PetscCall(ExpressionEvaluate(list[d], &point, &component));
      value[node * body->dim + d] = component;
    }
  }
  PetscCall(VecRestoreArrayWrite(values, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckSteady(Body body, const char name[], const Expression list[])
{
  PetscFunctionBegin;
  PetscCall(BodyLoadsRefuseNormal(body, name, list));
  for (PetscInt d = 0; d < body->dim; d++) {
    PetscBool steady;

    PetscCall(ExpressionIsSteady(list[d], &steady));
    PetscCheck(steady, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
               "-%s%s cannot vary in time: it is what there is at the start; use x, y, z", ((PetscObject)body)->prefix, name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadVector(Body body, const char name[])
{
  Expression     list[3] = {NULL};
  const char    *text;
  Vec            values;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(BodyLoadsGetText(body, name, &text));
  if (!text) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyLoadsGetComponents(body, name, text, PETSC_FALSE, list));
  PetscCall(BodyCreateVec(body, &values));
  error = CheckSteady(body, name, list);
  if (!error) error = Evaluate(body, list, values);
  if (!error) error = PetscObjectCompose((PetscObject)body, name, (PetscObject)values);
  PetscCall(VecDestroy(&values));
  for (PetscInt d = 0; d < body->dim; d++) PetscCall(ExpressionDestroy(&list[d]));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLoadsReadInitialState(Body body)
{
  PetscFunctionBegin;
  for (int i = 0; i < 2; i++) PetscCall(ReadVector(body, initial[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same value at all nodes */
static PetscErrorCode SetUniform(Body body, const char name[], const PetscReal value[])
{
  PetscScalar *at;
  Vec          values;

  PetscFunctionBegin;
  PetscCheck(!body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Body '%s': after BodySetUp(), call BodySetInitialState()", body->hdr.name);
  PetscCall(BodySetUpDiscretization(body));
  PetscCall(BodyCreateVec(body, &values));
  PetscCall(VecGetArrayWrite(values, &at));
  for (PetscInt i = 0; i < body->owned_nodes * body->dim; i++) at[i] = value[i % body->dim];
  PetscCall(VecRestoreArrayWrite(values, &at));
  PetscCall(PetscObjectCompose((PetscObject)body, name, (PetscObject)values));
  PetscCall(VecDestroy(&values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetInitialDisplacement - sets the displacement that all nodes have at the start

  Collective

  Input Parameters:
+ body         - the `Body`, with mesh and material, not yet set up
- displacement - as many numbers as the body has dimensions [m]

  Options Database Key:
. -<body>_initial_displacement ux,uy,uz - expressions in x, y, z [m], default 0

  Level: beginner

.seealso: `Body`, `BodySetInitialVelocity()`, `BodySetInitialState()`
@*/
PetscErrorCode BodySetInitialDisplacement(Body body, const PetscReal displacement[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(displacement, 2);
  PetscCall(SetUniform(body, initial[0], displacement));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetInitialVelocity - sets the velocity that all nodes have at the start

  Collective

  Input Parameters:
+ body     - the `Body`, with mesh and material, not yet set up
- velocity - as many numbers as the body has dimensions [m/s]

  Options Database Key:
. -<body>_initial_velocity vx,vy,vz - expressions in x, y, z [m/s], default 0

  Level: beginner

  Note:
  For a velocity that is not the same everywhere, call `BodySetInitialState()` after `BodySetUp()`.

.seealso: `Body`, `BodySetInitialDisplacement()`, `BodySetInitialState()`
@*/
PetscErrorCode BodySetInitialVelocity(Body body, const PetscReal velocity[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(velocity, 2);
  PetscCall(SetUniform(body, initial[1], velocity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacement [m] and velocity [m/s] of owned nodes at the start: those of the options, else zero, and those of held dofs as they
   are prescribed */
PetscErrorCode BodyLoadsInitialState(Body body, Vec u, Vec v)
{
  const Vec vecs[] = {u, v};

  PetscFunctionBegin;
  for (int i = 0; i < 2; i++) {
    Vec values;

    PetscCall(PetscObjectQuery((PetscObject)body, initial[i], (PetscObject *)&values));
    if (values) PetscCall(VecCopy(values, vecs[i]));
    else PetscCall(VecZeroEntries(vecs[i]));
  }
  PetscCall(BodyLoadsPrescribe(body, body->time_start, u, v, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
