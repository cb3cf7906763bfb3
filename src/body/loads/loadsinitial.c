/* Displacement and velocity at the start, from options. */
#include "loadsimpl.h"
#include <sys/units.h>

/* Composed with the body where the option of that name is given */
static const char *const   initial[]   = {"initial_displacement", "initial_velocity"};
static const UnitDimension dimension[] = {UNIT_LENGTH, UNIT_VELOCITY};
static const PetscReal     bound[]     = {1e22, 1e60};

static PetscErrorCode Evaluate(Body body, const Expression list[], Vec values)
{
  PetscScalar *value;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(values, &value));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    ExpressionPoint point = {{0}, {0}, 0};

    for (PetscInt d = 0; d < body->mesh.dim; d++) point.x[d] = body->mesh.coordinates[node * body->mesh.dim + d];
    for (PetscInt d = 0; d < body->mesh.dim; d++) {
      PetscReal component;

      PetscCall(ExpressionEvaluate(list[d], &point, &component));
      value[node * body->mesh.dim + d] = component;
    }
  }
  PetscCall(VecRestoreArrayWrite(values, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Beyond these no body moves that is between 1e-15 and 1e22 m large: a wrong unit, or a formula that runs away */
static PetscErrorCode CheckSize(Body body, int which, Vec values)
{
  PetscReal largest;

  PetscFunctionBegin;
  PetscCall(VecNorm(values, NORM_INFINITY, &largest));
  PetscCheck(largest <= bound[which], PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%s%s is up to %g%s; it must not be larger than %g%s", ((PetscObject)body)->prefix, initial[which], (double)largest,
             UnitsOf((PetscObject)body, dimension[which]), (double)bound[which], UnitsOf((PetscObject)body, dimension[which]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadVector(Body body, int which)
{
  Expression     list[3] = {NULL};
  const char    *name    = initial[which], *text;
  Vec            values;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(BodyLoadsGetText(body, name, &text));
  if (!text) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyLoadsGetComponents(body, name, text, PETSC_FALSE, list));
  PetscCall(BodyCreateVec(body, &values));
  error = BodyLoadsRefuse(body, name, LOADS_NORMAL, body->mesh.dim, list);
  if (!error) error = BodyLoadsRefuse(body, name, LOADS_TIME, body->mesh.dim, list);
  if (!error) error = Evaluate(body, list, values);
  if (!error) error = CheckSize(body, which, values);
  if (!error) error = PetscObjectCompose((PetscObject)body, name, (PetscObject)values);
  PetscCall(VecDestroy(&values));
  for (PetscInt d = 0; d < body->mesh.dim; d++) PetscCall(ExpressionDestroy(&list[d]));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLoadsReadInitialState(Body body)
{
  PetscFunctionBegin;
  for (int i = 0; i < 2; i++) PetscCall(ReadVector(body, i));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same displacement [m] or velocity [m/s] at all nodes */
PetscErrorCode BodyLoadsSetInitial(Body body, PetscBool velocity, const PetscReal value[])
{
  PetscScalar *at;
  Vec          values;

  PetscFunctionBegin;
  PetscCall(BodyCreateVec(body, &values));
  PetscCall(VecGetArrayWrite(values, &at));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++) at[i] = value[i % body->mesh.dim];
  PetscCall(VecRestoreArrayWrite(values, &at));
  PetscCall(PetscObjectCompose((PetscObject)body, initial[velocity ? 1 : 0], (PetscObject)values));
  PetscCall(VecDestroy(&values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error where nodes on the axis would leave it */
static PetscErrorCode CheckAxis(Body body, int which, Vec values)
{
  const PetscScalar *value;
  PetscBool          leaves = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(values, &value));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++)
    if (body->mesh.on_axis[node] && value[node * body->mesh.dim] != 0) leaves = PETSC_TRUE;
  PetscCall(VecRestoreArrayRead(values, &value));
  PetscCall(BodyAnyRank(body, &leaves));
  PetscCheck(
      !leaves, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
      "-%s%s moves nodes on the axis x = 0 of an axisymmetric body along x: they stay there; its first component must be 0, or a formula "
      "in x that is 0 there",
      ((PetscObject)body)->prefix, initial[which]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacement [m] and velocity [m/s] of owned nodes at the start: the options', else zero; of held dofs as prescribed */
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
  for (int i = 0; i < 2 && body->mesh.touches_axis; i++) PetscCall(CheckAxis(body, i, vecs[i]));
  PetscCall(BodyLoadsPrescribe(body, body->time.start, u, v, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mean velocity of the nodes at the start by BodySetInitialVelocity() and options, zeros beyond the dimension [m/s]. Collective. */
PetscErrorCode BodyGetInitialVelocity(Body body, PetscReal velocity[3])
{
  PetscReal          sums[4] = {0};
  const PetscScalar *v;
  Vec                values;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 3; d++) velocity[d] = 0;
  PetscCall(PetscObjectQuery((PetscObject)body, initial[1], (PetscObject *)&values));
  if (!values) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(values, &v));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++) sums[i % body->mesh.dim] += PetscRealPart(v[i]);
  PetscCall(VecRestoreArrayRead(values, &v));
  sums[3] = body->mesh.owned_nodes;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  for (PetscInt d = 0; d < body->mesh.dim; d++) velocity[d] = sums[d] / sums[3];
  PetscFunctionReturn(PETSC_SUCCESS);
}
