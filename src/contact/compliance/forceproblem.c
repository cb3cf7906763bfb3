/*
   Newton's step for contact forces that answer to the gaps. On rows n that do not push it is y = F; on those that do, p,

     (I + D S_pp) y_p = F_p - D S_pn F_n,   or   (D^{-1} + S_pp) y_p = D^{-1} F_p - S_pn F_n,

   which is S with the compliance of the springs on its diagonal.
*/
#include "forceproblem.h"
#include <checkpoint/checkpoint.h>

/* Rows of interfaces with so few are known from the start, which leaves nothing to allocate later */
#define FEW_ROWS 16
/* Up to so many rows matrices are dense: their factors take 32 MB then; and up to so many from the start, where factoring is cheap beside a
 * step */
#define DENSE_LIMIT 2000
#define DENSE_ROWS  256
/* Conjugate gradients, relative to the right-hand side: a step that leaves so much takes one more evaluation at most */
#define FORCE_TOLERANCE 1e-10

/* Takes the rows that push now, with the forces x; collective */
PetscErrorCode ForceProblemUpdate(Contact contact, ForceProblem *problem, const PetscBool pushing[], Vec X)
{
  const PetscScalar *x;
  PetscBool          dense;
  int                flags[2] = {problem->stale, problem->stale}; /* the list has changed, the factor has */

  PetscFunctionBegin;
  if (problem->rigid) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(X, &x));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (problem->pushing[i] != pushing[i]) flags[1] = 1;
    problem->pushing[i] = pushing[i];
    if (problem->listed[i] || (!pushing[i] && x[i] == 0)) continue;
    problem->listed[i] = INTERFACE_SOLVED;
    flags[0]           = 1;
  }
  if (contact->ranks.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, flags, 2, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)contact)));
  if (flags[0]) PetscCall(InterfaceOperatorSetRows(problem->S, problem->listed, 1));
  InterfaceOperatorGetRows(problem->S, NULL, NULL, &dense);
  if (flags[0] && !dense) {
    /* many that pushed once may have come away since */
    for (PetscInt i = 0; i < contact->rows.n; i++) problem->listed[i] = pushing[i] || x[i] != 0 ? INTERFACE_SOLVED : INTERFACE_LEFT_OUT;
    PetscCall(InterfaceOperatorSetRows(problem->S, problem->listed, 1));
  }
  PetscCall(VecRestoreArrayRead(X, &x));
  if (flags[0] || flags[1]) {
    for (PetscInt i = 0; i < contact->rows.n; i++) problem->springs[i] = pushing[i] ? 1 / problem->stiffness[i] : 0;
    PetscCall(InterfaceOperatorFactor(problem->S, problem->pushing, problem->springs));
  }
  problem->stale = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Y = (I + D S)^{-1} F */
PetscErrorCode ForceProblemSolve(Contact contact, ForceProblem *problem, Vec F, Vec Y)
{
  const PetscScalar *f;
  PetscScalar       *y;

  PetscFunctionBegin;
  PetscCall(VecCopy(F, Y));
  if (problem->rigid) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(F, &f));
  for (PetscInt i = 0; i < contact->rows.n; i++) problem->rest[i] = problem->pushing[i] ? 0 : f[i];
  PetscCall(InterfaceOperatorMultiply(problem->S, INTERFACE_GAP, problem->rest, problem->opened));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    problem->rest[i] = problem->pushing[i] ? f[i] / problem->stiffness[i] - problem->opened[i] : 0;
  PetscCall(VecRestoreArrayRead(F, &f));
  PetscCall(InterfaceOperatorSolve(problem->S, problem->rest, problem->solution));
  PetscCall(VecGetArray(Y, &y));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (problem->pushing[i]) y[i] = problem->solution[i];
  PetscCall(VecRestoreArray(Y, &y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `stiffness`: one for each row of this rank, which may change while the problem is marked as stale */
PetscErrorCode ForceProblemCreate(Contact contact, PetscReal stiffness[], ForceProblem *problem)
{
  const InterfaceSettings settings = {.prefix      = "penalty_interface_",
                                      .tolerance   = FORCE_TOLERANCE,
                                      .worst       = 0,
                                      .dense_limit = DENSE_LIMIT,
                                      .few         = DENSE_ROWS,
                                      .sparse      = PETSC_TRUE};
  const PetscInt          n        = contact->rows.n;

  PetscFunctionBegin;
  problem->stiffness = stiffness;
  problem->rigid     = PETSC_TRUE;
  problem->stale     = PETSC_TRUE;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool feels;

    PetscCall(BodyFeelsEndForce(contact->bodies[b], &feels));
    if (feels) problem->rigid = PETSC_FALSE;
  }
  PetscCall(PetscCalloc6(n, &problem->listed, n, &problem->pushing, n, &problem->springs, n, &problem->rest, n, &problem->opened, n,
                         &problem->solution));
  PetscCall(InterfaceOperatorCreate(contact, &settings, &problem->S));
  if (problem->rigid || contact->rows.n_all > FEW_ROWS) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < n; i++) problem->listed[i] = INTERFACE_SOLVED;
  PetscCall(InterfaceOperatorSetRows(problem->S, problem->listed, 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As after its creation, but for room: steps have been made that are not to count */
PetscErrorCode ForceProblemForget(Contact contact, ForceProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(problem->listed, contact->rows.n));
  PetscCall(PetscArrayzero(problem->pushing, contact->rows.n));
  problem->stale = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint */
PetscErrorCode ForceProblemVisit(Contact contact, ForceProblem *problem, Checkpoint checkpoint)
{
  const PetscInt n = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitBools(checkpoint, "stale", 1, &problem->stale));
  PetscCall(CheckpointVisitBytes(checkpoint, "listed", (size_t)n * sizeof(*problem->listed), problem->listed));
  PetscCall(CheckpointVisitBools(checkpoint, "pushing", n, problem->pushing));
  PetscCall(CheckpointVisitReals(checkpoint, "springs", n, problem->springs));
  PetscCall(CheckpointVisitReals(checkpoint, "solution", n, problem->solution));
  PetscCall(InterfaceOperatorVisit(problem->S, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ForceProblemDestroy(ForceProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(PetscFree6(problem->listed, problem->pushing, problem->springs, problem->rest, problem->opened, problem->solution));
  PetscCall(InterfaceOperatorDestroy(&problem->S));
  PetscFunctionReturn(PETSC_SUCCESS);
}
