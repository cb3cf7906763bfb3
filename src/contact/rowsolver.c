/* Conjugate gradients on the contact rows, for interfaces with too many of them for a dense matrix. */
#include "contactimpl.h"

/* A solver with a matrix that is known by its product alone; `ctx` is what the product finds in MatShellGetContext() */
PetscErrorCode ContactCreateRowSolver(Contact contact, const char prefix[], PetscReal tolerance, PetscErrorCode (*multiply)(Mat, Vec, Vec), void *ctx, KSP *solver)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)contact);
  Mat      shell;
  PC       pc;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(comm, contact->n_rows, contact->n_rows, contact->n_all_rows, contact->n_all_rows, ctx, &shell));
  PetscCall(MatShellSetOperation(shell, MATOP_MULT, (void (*)(void))multiply));
  PetscCall(KSPCreate(comm, solver));
  PetscCall(KSPSetOptionsPrefix(*solver, prefix));
  PetscCall(KSPSetOperators(*solver, shell, shell));
  PetscCall(KSPSetType(*solver, KSPCG));
  PetscCall(KSPGetPC(*solver, &pc));
  PetscCall(PCSetType(pc, PCNONE));
  PetscCall(KSPSetTolerances(*solver, tolerance, PETSC_CURRENT, PETSC_CURRENT, 1000));
  PetscCall(KSPSetFromOptions(*solver));
  PetscCall(MatDestroy(&shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}
