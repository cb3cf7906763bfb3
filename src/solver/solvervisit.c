/* The state of a constrained solver, for checkpoints. */
#include "constrainedsolverimpl.h"

/* The columns of A^{-1} B^T follow from A and B, as they are, to the last bit if each was found by itself */
static PetscErrorCode VisitColumns(ConstrainedSolver s, Checkpoint checkpoint)
{
  PetscInt local;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitBools(checkpoint, "columns", s->global, s->fresh));
  PetscCall(VecGetLocalSize(s->rhs, &local));
  for (PetscInt j = 0; j < s->global; j++) {
    PetscScalar *values;

    if (!s->fresh[j]) continue;
    if (s->global <= FEW_ROWS || !s->keeps) {
      if (!CheckpointLoads(checkpoint)) continue;
      s->fresh[j] = PETSC_FALSE;
      PetscCall(ConstrainedSolverMakeColumn(s, j));
      continue;
    }
    if (!s->columns[j]) PetscCall(VecDuplicate(s->rhs, &s->columns[j]));
    PetscCall(VecGetArray(s->columns[j], &values));
    PetscCall(CheckpointVisitReals(checkpoint, "column", local, values));
    PetscCall(VecRestoreArray(s->columns[j], &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint. A and B are loaded before. Collective. */
PetscErrorCode ConstrainedSolverVisit(ConstrainedSolver s, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointCheckInts(checkpoint, "rows", 1, &s->global));
  PetscCall(VisitColumns(s, checkpoint));
  PetscCall(ConstrainedSolverVisitConstraints(s, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}
