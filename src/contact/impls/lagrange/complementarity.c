/* Linear complementarity on the contact rows by a primal-dual active set: the forces of the active rows by a dense matrix of these alone,
   factored again only when they change, or, with many of them, by conjugate gradients. */
#include "complementarity.h"

/* Above so many active rows forces come from conjugate gradients: on matching or not matching faces with lumped mass they take about 20
   iterations, as long as a factor of 441 rows that is kept through the contact, and half as long as one of 1936 */
#define MAX_DENSE_ROWS 400
/* of the gaps, by conjugate gradients: near what factors leave; and what may be left where round-off keeps them from it */
#define GAP_TOLERANCE 1e-14
#define WORST_GAP     1e-9
#define MAX_ROUNDS    100

PetscErrorCode ComplementarityDestroy(Complementarity *problem)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->compliance));
  PetscCall(PetscFree6(problem->gaps, problem->forces, problem->active, problem->mine, problem->factored, problem->place));
  PetscCall(VecDestroy(&problem->force_vec));
  PetscCall(VecDestroy(&problem->gap_vec));
  PetscCall(VecDestroy(&problem->rhs_vec));
  PetscCall(PetscFree4(problem->rows, problem->factor, problem->rhs, problem->pivots));
  PetscCall(KSPDestroy(&problem->iterative));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Direction in which the force of a row acts on body b: Neumann sides are pushed along the rows, Dirichlet sides against them */
static PetscInt Sign(const ContactPair *pair, PetscInt b)
{
  return (pair->body[1] == b) - (pair->body[0] == b);
}

/* t C_b t, with the directions t of the rows */
static PetscErrorCode Orient(Contact contact, PetscInt b, Vec sign, Mat matrix)
{
  PetscScalar *signs;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(sign, &signs));
  for (PetscInt i = 0; i < contact->n_rows; i++) signs[i] = Sign(&contact->pairs[contact->row_pair[i]], b);
  PetscCall(VecRestoreArrayWrite(sign, &signs));
  PetscCall(MatDiagonalScale(matrix, sign, sign));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C, with the rows as they are: the sum of what `compute` tells of each body */
PetscErrorCode ComplementaritySetCompliance(Contact contact, PetscErrorCode (*compute)(Body, Mat *), Complementarity *problem)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->compliance));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Mat matrix;

    PetscCall((*compute)(contact->bodies[b], &matrix));
    PetscCall(Orient(contact, b, problem->gap_vec, matrix));
    if (problem->compliance) {
      PetscCall(MatAXPY(problem->compliance, 1, matrix, DIFFERENT_NONZERO_PATTERN));
      PetscCall(MatDestroy(&matrix));
    } else problem->compliance = matrix;
  }
  problem->current = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MakeRoom(Complementarity *problem, PetscInt size)
{
  PetscFunctionBegin;
  if (size <= problem->capacity) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree4(problem->rows, problem->factor, problem->rhs, problem->pivots));
  problem->capacity = PetscMax(size, PetscMin(2 * problem->capacity, MAX_DENSE_ROWS));
  size              = problem->capacity;
  PetscCall(PetscMalloc4(size, &problem->rows, size * size, &problem->factor, size, &problem->rhs, size, &problem->pivots));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* LU of C on the active rows, on every rank */
static PetscErrorCode Factor(Contact contact, Complementarity *problem)
{
  const PetscInt n = problem->n;
  PetscBLASInt   size, info;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(problem->factor, n * n));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt     local = problem->rows[i] - contact->row_begin, *columns;
    const PetscScalar *values;
    PetscInt           count;

    if (local < 0 || local >= contact->n_rows) continue;
    PetscCall(MatGetRow(problem->compliance, problem->rows[i], &count, &columns, &values));
    for (PetscInt k = 0; k < count; k++)
      if (problem->place[columns[k]] >= 0) problem->factor[problem->place[columns[k]] * n + i] = values[k];
    PetscCall(MatRestoreRow(problem->compliance, problem->rows[i], &count, &columns, &values));
  }
  if (contact->size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, problem->factor, (PetscMPIInt)(n * n), MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscCall(PetscBLASIntCast(n, &size));
  PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&size, &size, problem->factor, &size, problem->pivots, &info));
  PetscCheck(info == 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_LIB,
             "The matrix of the Lagrange multipliers is singular (LAPACK getrf info %d): contact constraints depend on each other",
             (int)info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The active rows on every rank, and their factor, unless they are those of the last time */
static PetscErrorCode TakeActive(Contact contact, Complementarity *problem)
{
  int differs = !problem->current;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    differs |= problem->factored[i] != problem->active[i];
    problem->factored[i]    = problem->active[i];
    contact->mine_active[i] = problem->active[i] ? 1 : 0;
  }
  PetscCall(ContactOr(contact, &differs));
  if (!differs) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Allgatherv(contact->mine_active, (PetscMPIInt)contact->n_rows, MPI_INT, contact->all_active, contact->counts,
                              contact->offsets, MPI_INT, PetscObjectComm((PetscObject)contact)));
  problem->n = 0;
  for (PetscInt i = 0; i < contact->n_all_rows; i++) problem->n += contact->all_active[i];
  problem->dense   = (PetscBool)(problem->n <= MAX_DENSE_ROWS);
  problem->current = PETSC_TRUE;
  if (!problem->dense || !problem->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeRoom(problem, problem->n));
  problem->n = 0;
  for (PetscInt i = 0; i < contact->n_all_rows; i++) {
    problem->place[i] = contact->all_active[i] ? problem->n : -1;
    if (contact->all_active[i]) problem->rows[problem->n++] = i;
  }
  PetscCall(Factor(contact, problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolveDense(Contact contact, Complementarity *problem)
{
  PetscBLASInt size, one = 1, info;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < problem->n; k++) {
    const PetscInt local = problem->rows[k] - contact->row_begin;

    problem->rhs[k] = local >= 0 && local < contact->n_rows ? -problem->gaps[local] : 0;
  }
  if (contact->size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, problem->rhs, (PetscMPIInt)problem->n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscCall(PetscBLASIntCast(problem->n, &size));
  PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &size, &one, problem->factor, &size, problem->pivots, problem->rhs, &size, &info));
  for (PetscInt k = 0; k < problem->n; k++) {
    const PetscInt local = problem->rows[k] - contact->row_begin;

    if (local >= 0 && local < contact->n_rows) problem->forces[local] = problem->rhs[k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = C x on active rows, y = x on the others, which x is zero on */
static PetscErrorCode MultiplyActive(Mat shell, Vec x, Vec y)
{
  Complementarity   *problem;
  const PetscScalar *in;
  PetscScalar       *out;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &problem));
  PetscCall(MatMult(problem->compliance, x, y));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArray(y, &out));
  for (PetscInt i = 0; i < problem->contact->n_rows; i++)
    if (!problem->active[i]) out[i] = in[i];
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Jacobi's preconditioner needs the diagonal; where no body has mass there is none */
static PetscErrorCode GetDiagonal(Mat shell, Vec diagonal)
{
  Complementarity *problem;
  PetscScalar     *values;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &problem));
  PetscCall(MatGetDiagonal(problem->compliance, diagonal));
  PetscCall(VecGetArray(diagonal, &values));
  for (PetscInt i = 0; i < problem->contact->n_rows; i++)
    if (!problem->active[i] || values[i] <= 0) values[i] = 1;
  PetscCall(VecRestoreArray(diagonal, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateIterative(Contact contact, Complementarity *problem)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)contact);
  Mat      shell;
  PC       pc;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(comm, contact->n_rows, contact->n_rows, contact->n_all_rows, contact->n_all_rows, problem, &shell));
  PetscCall(MatShellSetOperation(shell, MATOP_MULT, (void (*)(void))MultiplyActive));
  PetscCall(MatShellSetOperation(shell, MATOP_GET_DIAGONAL, (void (*)(void))GetDiagonal));
  PetscCall(KSPCreate(comm, &problem->iterative));
  PetscCall(KSPSetOptionsPrefix(problem->iterative, "lagrange_interface_"));
  PetscCall(KSPSetOperators(problem->iterative, shell, shell));
  PetscCall(KSPSetType(problem->iterative, KSPCG));
  PetscCall(KSPSetInitialGuessNonzero(problem->iterative, PETSC_TRUE));
  PetscCall(KSPGetPC(problem->iterative, &pc));
  PetscCall(PCSetType(pc, PCJACOBI));
  PetscCall(KSPSetNormType(problem->iterative, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetTolerances(problem->iterative, GAP_TOLERANCE, 0, PETSC_CURRENT, 1000));
  PetscCall(KSPSetFromOptions(problem->iterative));
  PetscCall(MatDestroy(&shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ComplementarityCreate(Contact contact, Complementarity *problem)
{
  const PetscInt n = contact->n_rows;

  PetscFunctionBegin;
  problem->contact = contact;
  PetscCall(PetscCalloc6(n, &problem->gaps, n, &problem->forces, n, &problem->active, n, &problem->mine, n, &problem->factored,
                         contact->n_all_rows, &problem->place));
  PetscCall(MatCreateVecs(contact->interfaces[0], NULL, &problem->force_vec));
  PetscCall(VecDuplicate(problem->force_vec, &problem->gap_vec));
  PetscCall(VecDuplicate(problem->force_vec, &problem->rhs_vec));
  if (contact->n_all_rows > MAX_DENSE_ROWS) PetscCall(CreateIterative(contact, problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From the forces of the last time on */
static PetscErrorCode SolveIteratively(Contact contact, Complementarity *problem)
{
  const PetscScalar *solution;
  PetscScalar       *rhs, *force;
  PetscReal          left, all;
  PetscInt           iterations;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(problem->rhs_vec, &rhs));
  PetscCall(VecGetArray(problem->force_vec, &force));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    rhs[i] = problem->active[i] ? -problem->gaps[i] : 0;
    if (!problem->active[i]) force[i] = 0;
  }
  PetscCall(VecRestoreArray(problem->force_vec, &force));
  PetscCall(VecRestoreArrayWrite(problem->rhs_vec, &rhs));
  PetscCall(KSPSolve(problem->iterative, problem->rhs_vec, problem->force_vec));
  PetscCall(KSPGetIterationNumber(problem->iterative, &iterations));
  contact->counts_made.inner_iterations += iterations;
  PetscCall(KSPGetResidualNorm(problem->iterative, &left));
  PetscCall(VecNorm(problem->rhs_vec, NORM_2, &all));
  PetscCheck(left <= WORST_GAP * all, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
             "Conjugate gradients for the Lagrange multipliers of %" PetscInt_FMT " contact nodes leave %g of the gaps after %" PetscInt_FMT
             " iterations; raise -lagrange_interface_ksp_max_it, or choose -contact_type schwarz",
             problem->n, (double)(left / all), iterations);
  PetscCall(VecGetArrayRead(problem->force_vec, &solution));
  PetscCall(PetscArraycpy(problem->forces, solution, contact->n_rows));
  PetscCall(VecRestoreArrayRead(problem->force_vec, &solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces that close the gaps of the active rows, zero for the others */
PetscErrorCode ComplementaritySolveActive(Contact contact, Complementarity *problem)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(problem->forces, contact->n_rows));
  PetscCall(TakeActive(contact, problem));
  if (!problem->n) PetscFunctionReturn(PETSC_SUCCESS);
  if (problem->dense) PetscCall(SolveDense(contact, problem));
  else PetscCall(SolveIteratively(contact, problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows whose gap stays below -tolerance under the forces join, rows that are pulled leave; whether any does */
static PetscErrorCode ChangeActive(Contact contact, PetscReal tolerance, Complementarity *problem, PetscBool *changed)
{
  const PetscScalar *moved;
  PetscScalar       *force;
  int                any = 0;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(problem->force_vec, &force));
  PetscCall(PetscArraycpy(force, problem->forces, contact->n_rows));
  PetscCall(VecRestoreArrayWrite(problem->force_vec, &force));
  PetscCall(MatMult(problem->compliance, problem->force_vec, problem->gap_vec));
  PetscCall(VecGetArrayRead(problem->gap_vec, &moved));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    if (contact->tied[i] || !(problem->active[i] ? problem->forces[i] < 0 : problem->gaps[i] + moved[i] < -tolerance)) continue;
    problem->active[i] = (PetscBool)!problem->active[i];
    any                = 1;
  }
  PetscCall(VecRestoreArrayRead(problem->gap_vec, &moved));
  PetscCall(ContactOr(contact, &any));
  *changed = (PetscBool)(any > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Starts from all negative gaps, and those that are tied */
PetscErrorCode ComplementaritySolve(Contact contact, PetscReal tolerance, Complementarity *problem)
{
  PetscBool changed = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) problem->active[i] = (PetscBool)(contact->tied[i] || problem->gaps[i] < 0);
  for (PetscInt round = 0; changed; round++) {
    PetscCheck(round < MAX_ROUNDS, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
               "The active set of the Lagrange multipliers has changed %d times in one step", MAX_ROUNDS);
    PetscCall(ComplementaritySolveActive(contact, problem));
    PetscCall(ChangeActive(contact, tolerance, problem, &changed));
    if (changed) contact->counts_made.set_changes++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces on the rows of a body, as it takes them */
PetscErrorCode ComplementarityGetBodyForces(Contact contact, PetscInt b, const Complementarity *problem, PetscScalar forces[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) forces[i] = Sign(&contact->pairs[contact->row_pair[i]], b) * problem->forces[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}
