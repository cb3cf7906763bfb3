/* Linear complementarity on the contact rows by a primal-dual active set, on every rank alike. */
#include "complementarity.h"

PetscErrorCode ComplementarityCreate(Contact contact, Complementarity *problem)
{
  const PetscInt n = contact->n_all_rows;

  PetscFunctionBegin;
  PetscCall(PetscCalloc7(n * n, &problem->compliance, n, &problem->gaps, n, &problem->forces, n, &problem->active, n * n, &problem->matrix, n, &problem->rhs, n, &problem->pivots));
  PetscCall(PetscCalloc1(contact->n_rows, &problem->mine));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ComplementarityDestroy(Complementarity *problem)
{
  PetscFunctionBegin;
  PetscCall(PetscFree7(problem->compliance, problem->gaps, problem->forces, problem->active, problem->matrix, problem->rhs, problem->pivots));
  PetscCall(PetscFree(problem->mine));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The gaps of all rows on every rank, from those of each rank's own rows */
PetscErrorCode ComplementarityGather(Contact contact, const PetscScalar gaps[], Complementarity *problem)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Allgatherv(gaps, (PetscMPIInt)contact->n_rows, MPIU_SCALAR, problem->gaps, contact->counts, contact->offsets, MPIU_SCALAR, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces that close the gaps of the active rows, zero for the others */
PetscErrorCode ComplementaritySolveActive(Contact contact, Complementarity *problem)
{
  const PetscInt n = contact->n_all_rows;
  PetscInt       k = 0, count = 0;
  PetscBLASInt   size, one    = 1, info;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) count += problem->active[i];
  for (PetscInt j = 0; j < n; j++) {
    PetscInt l = 0;

    if (!problem->active[j]) continue;
    for (PetscInt i = 0; i < n; i++)
      if (problem->active[i]) problem->matrix[k * count + l++] = problem->compliance[j * n + i];
    problem->rhs[k++] = -problem->gaps[j];
  }
  PetscCall(PetscArrayzero(problem->forces, n));
  if (!k) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscBLASIntCast(k, &size));
  PetscCallBLAS("LAPACKgesv", LAPACKgesv_(&size, &one, problem->matrix, &size, problem->pivots, problem->rhs, &size, &info));
  PetscCheck(info == 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_LIB, "The matrix of the Lagrange multipliers is singular (LAPACK gesv info %d): contact constraints depend on each other", (int)info);
  for (PetscInt i = 0, l = 0; i < n; i++)
    if (problem->active[i]) problem->forces[i] = problem->rhs[l++];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows whose gap stays below -tolerance join, rows that are pulled leave, until none does. Starts from all negative gaps. */
PetscErrorCode ComplementaritySolve(Contact contact, PetscReal tolerance, Complementarity *problem)
{
  const PetscInt n       = contact->n_all_rows;
  PetscBool      changed = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) problem->active[i] = (PetscBool)(problem->gaps[i] < 0);
  for (PetscInt round = 0; changed; round++) {
    PetscCheck(round < 100, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED, "The active set of the Lagrange multipliers has changed 100 times in one step");
    PetscCall(ComplementaritySolveActive(contact, problem));
    changed = PETSC_FALSE;
    for (PetscInt i = 0; i < n; i++) {
      PetscReal gap = problem->gaps[i];

      for (PetscInt j = 0; j < n; j++) gap += problem->compliance[j * n + i] * problem->forces[j];
      if (problem->active[i] ? problem->forces[i] < 0 : gap < -tolerance) {
        problem->active[i] = (PetscBool)!problem->active[i];
        changed            = PETSC_TRUE;
      }
    }
    if (changed) contact->counts_made.set_changes++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces on the rows of a body, as it takes them: Neumann sides are pushed along the rows, Dirichlet sides against them */
PetscErrorCode ComplementarityGetBodyForces(Contact contact, PetscInt b, const Complementarity *problem, PetscScalar forces[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const ContactPair *pair = &contact->pairs[contact->row_pair[i]];

    forces[i] = ((pair->body[1] == b) - (pair->body[0] == b)) * problem->forces[contact->row_begin + i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
