/* Conjugate gradients on the contact rows, for interfaces with too many of them for a dense matrix. */
#include <impakt/private/contactimpl.h>

/* y = S x, S = sum over bodies of t_b W_b t_b, t_b = 1 on rows whose first body is b, -1 on those whose second it is: how forces on the
   rows that are marked (NULL: all) open their gaps; or, if `first`, W_b t_b x of the first bodies alone: how these move. One solution of
   each body. */
PetscErrorCode ContactMultiplyCompliance(Contact contact, const PetscBool marked[], PetscBool first, Vec work[2], Vec x, Vec y)
{
  PetscFunctionBegin;
  PetscCall(VecZeroEntries(y));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const PetscScalar *in, *moved;
    PetscScalar       *force, *out;

    PetscCall(VecGetArrayRead(x, &in));
    PetscCall(VecGetArrayWrite(work[0], &force));
    for (PetscInt i = 0; i < contact->n_rows; i++) {
      const ContactPair *pair = &contact->pairs[contact->row_pair[i]];

      force[i] = !marked || marked[i] ? ((pair->body[0] == b) - (pair->body[1] == b)) * in[i] : 0;
    }
    PetscCall(VecRestoreArrayWrite(work[0], &force));
    PetscCall(VecRestoreArrayRead(x, &in));
    PetscCall(BodyApplyCompliance(contact->bodies[b], work[0], work[1]));
    PetscCall(VecGetArrayRead(work[1], &moved));
    PetscCall(VecGetArray(y, &out));
    for (PetscInt i = 0; i < contact->n_rows; i++) {
      const ContactPair *pair = &contact->pairs[contact->row_pair[i]];

      if (!marked || marked[i]) out[i] += ((pair->body[0] == b) - (first ? 0 : pair->body[1] == b)) * moved[i];
    }
    PetscCall(VecRestoreArray(y, &out));
    PetscCall(VecRestoreArrayRead(work[1], &moved));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A solver with a matrix that is known by its product alone; `ctx` is what the product finds in MatShellGetContext() */
PetscErrorCode ContactCreateRowSolver(Contact contact, const char prefix[], PetscReal tolerance, PetscErrorCode (*multiply)(Mat, Vec, Vec),
                                      void *ctx, KSP *solver)
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
