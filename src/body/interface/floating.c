/* Static bodies that contact or ties alone hold: how contact sees their artificial springs, see src/body/system/springs.c. */
#include <body/layout/bodyimpl.h>
#include <petscblaslapack.h>

/* Whether contact or ties alone hold a static body in one direction at least: it has artificial springs then */
PetscErrorCode BodyIsFloating(Body body, PetscBool *floating)
{
  PetscFunctionBegin;
  *floating = (PetscBool)(body->springs.n > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the stiffness of artificial springs to their part of `least`, the least BodyGetLeastStiffness() of the bodies that may touch each
   other [N/m]; after BodySetUpSteps(), before BodyBeginSetUp() */
PetscErrorCode BodySetSpringStiffness(Body body, PetscReal least)
{
  PetscFunctionBegin;
  body->springs.stiffness = body->springs.part * least;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacements of the dofs that the springs pull at, on every rank */
static PetscErrorCode GatherDisplacements(Body body, Vec u, PetscReal values[BODY_MAX_RIGID])
{
  const PetscScalar *array;

  PetscFunctionBegin;
  if (!body->springs.n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(u, &array));
  for (PetscInt k = 0; k < body->springs.n; k++) values[k] = body->springs.dof[k] >= 0 ? PetscRealPart(array[body->springs.dof[k]]) : 0;
  PetscCall(VecRestoreArrayRead(u, &array));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, values, (PetscMPIInt)body->springs.n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts artificial springs at rest in the saved state, as each controller step begins. Collective. */
PetscErrorCode BodyResetSprings(Body body)
{
  PetscFunctionBegin;
  PetscCall(GatherDisplacements(body, body->saved.u, body->springs.start));
  PetscCall(PetscArraycpy(body->springs.place, body->springs.start, BODY_MAX_RIGID));
  body->repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Parts of the rigid motions that the springs have with these values, and of the free motions */
static PetscErrorCode FindMotions(Body body, const PetscReal values[], PetscReal amounts[], PetscReal parts[])
{
  const BodySprings *springs = &body->springs;
  const PetscInt     dim = body->mesh.dim, n_rigid = dim == 1 ? 1 : 3 * (dim - 1);
  PetscReal          matrix[BODY_MAX_RIGID * BODY_MAX_RIGID];
  PetscBLASInt       order = (PetscBLASInt)springs->n, one = 1, info, pivots[BODY_MAX_RIGID];

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(matrix, springs->at_springs, springs->n * springs->n));
  PetscCall(PetscArraycpy(amounts, values, springs->n));
  PetscCallBLAS("LAPACKgesv", LAPACKgesv_(&order, &one, matrix, &order, pivots, amounts, &order, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK gesv info %d", (int)info);
  PetscCall(PetscArrayzero(parts, BODY_MAX_RIGID));
  for (PetscInt k = 0; k < springs->n; k++)
    for (PetscInt i = 0; i < n_rigid; i++) parts[i] += amounts[k] * springs->motions[k * n_rigid + i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What of the stretch is a translation of the body, of those that are free */
static PetscErrorCode FindFall(Body body, BodySpringState *state)
{
  const BodySprings *springs = &body->springs;
  const PetscInt     dim = body->mesh.dim, n_rigid = dim == 1 ? 1 : 3 * (dim - 1);
  PetscReal          amounts[BODY_MAX_RIGID], parts[BODY_MAX_RIGID];

  PetscFunctionBegin;
  PetscCall(FindMotions(body, state->stretch, amounts, parts));
  for (PetscInt k = 0; k < springs->n; k++) {
    PetscReal amount = 0;

    for (PetscInt i = 0; i < dim; i++) amount += parts[i] * springs->motions[k * n_rigid + i];
    for (PetscInt n = 0; n < springs->n; n++) state->falls[n] += amount * springs->at_springs[k * springs->n + n];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How artificial springs are stretched at the end of the step, the same on every rank. Collective. */
PetscErrorCode BodyMeasureSprings(Body body, BodySpringState *state)
{
  BodySprings *springs = &body->springs;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(state, sizeof(*state)));
  state->n         = springs->n;
  state->stiffness = springs->stiffness;
  state->part      = springs->part;
  state->linear    = body->model.linear;
  state->size      = springs->size;
  PetscCall(GatherDisplacements(body, body->state.u, springs->reached));
  for (PetscInt k = 0; k < springs->n; k++) {
    state->stretch[k]   = springs->reached[k] - springs->place[k];
    state->displacement = PetscMax(state->displacement, PetscAbsReal(springs->reached[k]));
    state->way          = PetscMax(state->way, PetscAbsReal(springs->reached[k] - springs->start[k]));
  }
  if (springs->n) PetscCall(FindFall(body, state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the places at which artificial springs are at rest, each by `move` [m]; a move by the stretch brings them to where the body is */
PetscErrorCode BodyMoveSprings(Body body, const PetscReal move[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < body->springs.n; k++) body->springs.place[k] += move[k];
  body->repeats = PETSC_FALSE; /* the end state was found with the springs where they have been */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How a floating body has moved as a whole, after BodyMeasureSprings(), in words: "move along x and turn about z" */
PetscErrorCode BodyDescribeDrift(Body body, size_t size, char text[])
{
  const BodySprings *springs = &body->springs;
  PetscReal          values[BODY_MAX_RIGID], amounts[BODY_MAX_RIGID], parts[BODY_MAX_RIGID];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < springs->n; k++) values[k] = springs->reached[k] - springs->start[k];
  PetscCall(FindMotions(body, values, amounts, parts));
  PetscCall(BodyDescribeMotions(body->mesh.dim, parts, size, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}
