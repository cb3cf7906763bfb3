/*
   Newton's step for contact forces that answer to the gaps. On rows that do not push it is y = F; on those that do,

     (I + D S_pp) y_p = F_p - D S_pn F_n,   S = sum over bodies of t_b W_b t_b,   t_b = 1 on rows whose second body is b, -1 where it is the
   first,

   with the compliance W_b that bodies have of the rows that pushed once. Beyond what a dense matrix is good for S is only multiplied with,
   by solutions with the bodies' factors, and what is left of the force comes from conjugate gradients:

     (I + R S R) z = R^{-1} F_p - R S F_n,   y_p = R z,   R = D^{1/2}.
*/
#include "forceproblem.h"

/* Above so many rows forces come from conjugate gradients */
#define MAX_DENSE_ROWS 2000
/* Rows of interfaces with so few are known from the start, which leaves nothing to allocate later */
#define FEW_ROWS 16
/* of the residual: a step that leaves so much takes one more evaluation at most */
#define FORCE_TOLERANCE 1e-10

static PetscErrorCode MakeRoom(ForceProblem *problem, PetscInt size)
{
  PetscFunctionBegin;
  if (size <= problem->capacity) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree4(problem->rows, problem->body_rows, problem->places, problem->pivots));
  PetscCall(PetscFree5(problem->compliance, problem->factor, problem->residual, problem->step, problem->springs));
  size              = PetscMax(size, PetscMin(2 * problem->capacity, MAX_DENSE_ROWS));
  problem->capacity = size;
  PetscCall(PetscMalloc4(size, &problem->rows, size, &problem->body_rows, size, &problem->places, size, &problem->pivots));
  PetscCall(PetscMalloc5(size * size, &problem->compliance, size * size, &problem->factor, size, &problem->residual, size, &problem->step,
                         size, &problem->springs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Direction in which the force of a row acts on body b */
static PetscInt Sign(const ContactPair *pair, PetscInt b)
{
  return (pair->body[1] == b) - (pair->body[0] == b);
}

/* Makes the listed rows known to a body, and adds what they do to each other through it */
static PetscErrorCode AddBody(Contact contact, ForceProblem *problem, PetscInt b)
{
  const PetscScalar *W;
  const PetscInt    *place;
  PetscInt           leading, n = 0;
  PetscBool          feels;

  PetscFunctionBegin;
  PetscCall(BodyFeelsEndForce(contact->bodies[b], &feels));
  if (!feels) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < problem->n; i++)
    if (Sign(&contact->pairs[contact->all_row_pair[problem->rows[i]]], b)) problem->body_rows[n++] = problem->rows[i];
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyExtendCompliance(contact->bodies[b], n, problem->body_rows));
  PetscCall(BodyGetCompliance(contact->bodies[b], -1, &place, &leading, &W));
  for (PetscInt j = 0; j < problem->n; j++) {
    const PetscInt sign_j = Sign(&contact->pairs[contact->all_row_pair[problem->rows[j]]], b);

    if (!sign_j) continue;
    for (PetscInt i = 0; i < problem->n; i++) {
      const PetscInt sign_i = Sign(&contact->pairs[contact->all_row_pair[problem->rows[i]]], b);

      if (sign_i)
        problem->compliance[j * problem->n + i] += sign_i * sign_j * W[place[problem->rows[j]] * leading + place[problem->rows[i]]];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The listed rows of all ranks, and their compliance */
static PetscErrorCode ListRows(Contact contact, ForceProblem *problem)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) contact->mine_active[i] = problem->listed[i] ? 1 : 0;
  PetscCallMPI(MPI_Allgatherv(contact->mine_active, (PetscMPIInt)contact->n_rows, MPI_INT, contact->all_active, contact->counts,
                              contact->offsets, MPI_INT, PetscObjectComm((PetscObject)contact)));
  problem->n = 0;
  for (PetscInt i = 0; i < contact->n_all_rows; i++) problem->n += contact->all_active[i];
  problem->dense = (PetscBool)(problem->n <= MAX_DENSE_ROWS);
  if (!problem->dense) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeRoom(problem, problem->n));
  problem->n = 0;
  for (PetscInt i = 0; i < contact->n_all_rows; i++)
    if (contact->all_active[i]) problem->rows[problem->n++] = i;
  PetscCall(PetscArrayzero(problem->compliance, problem->n * problem->n));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(AddBody(contact, problem, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Values of this rank's rows on all ranks, for the listed ones */
static PetscErrorCode GatherListed(Contact contact, const ForceProblem *problem, const PetscScalar mine[], PetscScalar all[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < problem->n; i++) {
    const PetscInt local = problem->rows[i] - contact->row_begin;

    all[i] = local >= 0 && local < contact->n_rows ? mine[local] : 0;
  }
  if (contact->size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all, (PetscMPIInt)problem->n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* LU of I + D S on the rows that push */
static PetscErrorCode Factor(Contact contact, ForceProblem *problem)
{
  PetscBLASInt size, info;
  PetscInt     m = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < problem->n; i++) {
    const PetscInt local = problem->rows[i] - contact->row_begin;

    problem->springs[i] = local >= 0 && local < contact->n_rows && problem->pushing[local] ? problem->stiffness[local] : 0;
  }
  if (contact->size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, problem->springs, (PetscMPIInt)problem->n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  for (PetscInt i = 0; i < problem->n; i++)
    if (problem->springs[i] > 0) problem->places[m++] = i;
  problem->n_pushing = m;
  if (!m) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < m; j++)
    for (PetscInt i = 0; i < m; i++)
      problem->factor[j * m + i] = (i == j ? 1 : 0) + problem->springs[problem->places[i]] *
                                                          problem->compliance[problem->places[j] * problem->n + problem->places[i]];
  PetscCall(PetscBLASIntCast(m, &size));
  PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&size, &size, problem->factor, &size, problem->pivots, &info));
  PetscCheck(info == 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_MAT_LU_ZRPVT,
             "The matrix of the contact forces is singular (LAPACK getrf info %d): the contact rows constrain each other", (int)info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the rows that push now, with the forces x; collective */
PetscErrorCode ForceProblemUpdate(Contact contact, ForceProblem *problem, const PetscBool pushing[], Vec X)
{
  const PetscScalar *x;
  int                flags[2] = {problem->stale, problem->stale}; /* the list has changed, the factor has */

  PetscFunctionBegin;
  if (problem->rigid) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(X, &x));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    if (problem->pushing[i] != pushing[i]) flags[1] = 1;
    problem->pushing[i] = pushing[i];
    if (problem->listed[i] || (!pushing[i] && x[i] == 0)) continue;
    problem->listed[i] = PETSC_TRUE;
    flags[0]           = 1;
  }
  if (contact->size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, flags, 2, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)contact)));
  if (flags[0]) PetscCall(ListRows(contact, problem));
  if (flags[0] && !problem->dense) {
    /* many that pushed once may have come away since */
    for (PetscInt i = 0; i < contact->n_rows; i++) problem->listed[i] = (PetscBool)(pushing[i] || x[i] != 0);
    PetscCall(ListRows(contact, problem));
  }
  PetscCall(VecRestoreArrayRead(X, &x));
  if (problem->dense && (flags[0] || flags[1])) PetscCall(Factor(contact, problem));
  problem->stale = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolveDense(Contact contact, ForceProblem *problem, Vec F, Vec Y)
{
  const PetscInt     n = problem->n, m = problem->n_pushing;
  const PetscScalar *f;
  PetscScalar       *y, *step  = problem->step;
  PetscBLASInt       size, one = 1, info;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(F, &f));
  PetscCall(GatherListed(contact, problem, f, problem->residual));
  PetscCall(VecRestoreArrayRead(F, &f));
  for (PetscInt k = 0; k < m; k++) step[k] = problem->residual[problem->places[k]];
  for (PetscInt j = 0; j < n; j++) {
    if (problem->springs[j] > 0 || problem->residual[j] == 0) continue;
    for (PetscInt k = 0; k < m; k++)
      step[k] -= problem->springs[problem->places[k]] * problem->compliance[j * n + problem->places[k]] * problem->residual[j];
  }
  PetscCall(PetscBLASIntCast(m, &size));
  if (m) PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &size, &one, problem->factor, &size, problem->pivots, step, &size, &info));
  PetscCall(VecCopy(F, Y));
  PetscCall(VecGetArray(Y, &y));
  for (PetscInt k = 0; k < m; k++) {
    const PetscInt local = problem->rows[problem->places[k]] - contact->row_begin;

    if (local >= 0 && local < contact->n_rows) y[local] = step[k];
  }
  PetscCall(VecRestoreArray(Y, &y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Root(const ForceProblem *problem, PetscInt i)
{
  return problem->pushing[i] ? PetscSqrtReal(problem->stiffness[i]) : 0;
}

/* y = x + R S R x */
static PetscErrorCode Multiply(Mat shell, Vec x, Vec y)
{
  ForceProblem      *problem;
  Contact            contact;
  const PetscScalar *in;
  PetscScalar       *scaled, *out;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &problem));
  contact = problem->contact;
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArrayWrite(problem->work[2], &scaled));
  for (PetscInt i = 0; i < contact->n_rows; i++) scaled[i] = Root(problem, i) * in[i];
  PetscCall(VecRestoreArrayWrite(problem->work[2], &scaled));
  PetscCall(ContactMultiplyCompliance(contact, NULL, PETSC_FALSE, problem->work, problem->work[2], y));
  PetscCall(VecGetArray(y, &out));
  for (PetscInt i = 0; i < contact->n_rows; i++) out[i] = in[i] + Root(problem, i) * out[i];
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateIterative(Contact contact, ForceProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(MatCreateVecs(contact->interfaces[0], NULL, &problem->unknown));
  PetscCall(VecDuplicate(problem->unknown, &problem->rhs));
  for (PetscInt k = 0; k < 3; k++) PetscCall(VecDuplicate(problem->unknown, &problem->work[k]));
  PetscCall(ContactCreateRowSolver(contact, "penalty_interface_", FORCE_TOLERANCE, Multiply, problem, &problem->iterative));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolveIteratively(Contact contact, ForceProblem *problem, Vec F, Vec Y)
{
  const PetscScalar *f, *z, *opened;
  PetscScalar       *rest, *y, *rhs;
  PetscInt           iterations;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(F, &f));
  PetscCall(VecGetArrayWrite(problem->work[2], &rest));
  for (PetscInt i = 0; i < contact->n_rows; i++) rest[i] = Root(problem, i) > 0 ? 0 : f[i];
  PetscCall(VecRestoreArrayWrite(problem->work[2], &rest));
  PetscCall(ContactMultiplyCompliance(contact, NULL, PETSC_FALSE, problem->work, problem->work[2], problem->unknown));
  PetscCall(VecGetArrayRead(problem->unknown, &opened));
  PetscCall(VecGetArrayWrite(problem->rhs, &rhs));
  for (PetscInt i = 0; i < contact->n_rows; i++) rhs[i] = Root(problem, i) > 0 ? f[i] / Root(problem, i) - Root(problem, i) * opened[i] : 0;
  PetscCall(VecRestoreArrayWrite(problem->rhs, &rhs));
  PetscCall(VecRestoreArrayRead(problem->unknown, &opened));
  PetscCall(KSPSolve(problem->iterative, problem->rhs, problem->unknown));
  PetscCall(KSPGetIterationNumber(problem->iterative, &iterations));
  contact->counts_made.inner_iterations += iterations;
  PetscCall(VecGetArrayRead(problem->unknown, &z));
  PetscCall(VecGetArrayWrite(Y, &y));
  for (PetscInt i = 0; i < contact->n_rows; i++) y[i] = Root(problem, i) > 0 ? Root(problem, i) * z[i] : f[i];
  PetscCall(VecRestoreArrayWrite(Y, &y));
  PetscCall(VecRestoreArrayRead(problem->unknown, &z));
  PetscCall(VecRestoreArrayRead(F, &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Y = (I + D S)^{-1} F */
PetscErrorCode ForceProblemSolve(Contact contact, ForceProblem *problem, Vec F, Vec Y)
{
  PetscFunctionBegin;
  if (problem->rigid) PetscCall(VecCopy(F, Y));
  else if (problem->dense) PetscCall(SolveDense(contact, problem, F, Y));
  else PetscCall(SolveIteratively(contact, problem, F, Y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `stiffness`: one for each row of this rank, which may change while the problem is marked as stale */
PetscErrorCode ForceProblemCreate(Contact contact, PetscReal stiffness[], ForceProblem *problem)
{
  PetscFunctionBegin;
  problem->contact   = contact;
  problem->stiffness = stiffness;
  problem->rigid     = PETSC_TRUE;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool feels;

    PetscCall(BodyFeelsEndForce(contact->bodies[b], &feels));
    if (feels) problem->rigid = PETSC_FALSE;
  }
  PetscCall(PetscCalloc2(contact->n_rows, &problem->listed, contact->n_rows, &problem->pushing));
  problem->stale = PETSC_TRUE;
  if (!problem->rigid && contact->n_all_rows > MAX_DENSE_ROWS) PetscCall(CreateIterative(contact, problem));
  if (problem->rigid || contact->n_all_rows > FEW_ROWS) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->n_rows; i++) problem->listed[i] = PETSC_TRUE;
  PetscCall(ListRows(contact, problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ForceProblemDestroy(ForceProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(problem->listed, problem->pushing));
  PetscCall(PetscFree4(problem->rows, problem->body_rows, problem->places, problem->pivots));
  PetscCall(PetscFree5(problem->compliance, problem->factor, problem->residual, problem->step, problem->springs));
  PetscCall(KSPDestroy(&problem->iterative));
  PetscCall(VecDestroy(&problem->unknown));
  PetscCall(VecDestroy(&problem->rhs));
  for (PetscInt k = 0; k < 3; k++) PetscCall(VecDestroy(&problem->work[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
