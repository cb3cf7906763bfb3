/*
   Newton's method for F(x) = x - G(x) by the compliance of the bodies. After a sweep the forces on both sides of each row are opposite, and
   its residual is what is missing between their displacements. Forces d that close it,

     S d = F,   S = sum over bodies of t_b W_b t_b,   t_b = 1 on rows whose Dirichlet side is b, -1 on those whose Neumann side it is,

   move the Dirichlet sides by W_b t_b d: the step of Newton's method in x, whatever the order of the bodies; where x is a force it is d.
   With several times in the controller step the matrices are those of a convolution in time. With more active rows than a dense matrix is
   good for, S is only multiplied with, by solutions with the bodies' factors, and d comes from conjugate gradients, for one time after the
   other; where there are several, or bodies make substeps, that is not the whole Jacobian, and secants do the rest.
*/
#include <contact/impls/schwarz/schwarzimpl.h>
#include <petscblaslapack.h>

static PetscErrorCode MakeRoom(InterfaceProblem *problem, PetscInt size, PetscInt most)
{
  PetscFunctionBegin;
  if (size <= problem->capacity) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree4(problem->matrices, problem->dirichlet, problem->factor, problem->pivots));
  PetscCall(PetscFree5(problem->rows, problem->body_rows, problem->residual, problem->force, problem->change));
  problem->capacity = PetscMax(size, PetscMin(2 * problem->capacity, most));
  size              = problem->capacity;
  PetscCall(PetscMalloc4(size * size, &problem->matrices, size * size, &problem->dirichlet, size * size, &problem->factor, size,
                         &problem->pivots));
  PetscCall(PetscMalloc5(size, &problem->rows, size, &problem->body_rows, size, &problem->residual, size, &problem->force, size,
                         &problem->change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds t_b W_b t_b of a body at a level to a matrix, or W_b t_b on its Dirichlet rows if `dirichlet` */
static PetscErrorCode AddBody(Contact contact, PetscInt b, PetscInt level, PetscBool dirichlet, PetscScalar matrix[])
{
  const InterfaceProblem *problem = &((Schwarz *)contact->data)->problem;
  const PetscScalar      *W;
  const PetscInt         *place;
  PetscInt                leading;

  PetscFunctionBegin;
  PetscCall(BodyGetCompliance(contact->bodies[b], level, &place, &leading, &W));
  for (PetscInt j = 0; j < problem->n; j++) {
    const ContactPair *pair_j = &contact->pairs[contact->all_row_pair[problem->rows[j]]];
    const PetscInt     sign_j = (DirichletBody(pair_j) == b) - (NeumannBody(pair_j) == b);

    if (!sign_j) continue;
    for (PetscInt i = 0; i < problem->n; i++) {
      const ContactPair *pair_i = &contact->pairs[contact->all_row_pair[problem->rows[i]]];
      const PetscInt     sign_i = (DirichletBody(pair_i) == b) - (dirichlet ? 0 : NeumannBody(pair_i) == b);

      if (sign_i) matrix[j * problem->n + i] += sign_i * sign_j * W[place[problem->rows[j]] * leading + place[problem->rows[i]]];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether forces at the same times act on all bodies: all are linear over the step, since Dirichlet sides make one substep or these forces
   are the unknowns, or all bodies of pairs make equally many substeps */
static PetscErrorCode CountLevels(Contact contact, PetscInt *levels, PetscBool *chain)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;
  PetscInt       first = 0, most = 1;
  PetscBool      equal = PETSC_TRUE, single = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt side = 0; side < 2; side++) {
      PetscInt substeps;

      if (contact->pairs[p].obstacle && side == 1) continue;
      PetscCall(BodyGetSubsteps(contact->bodies[contact->pairs[p].body[side]], &substeps));
      if (!first) first = substeps;
      if (substeps != first) equal = PETSC_FALSE;
      if (side == contact->pairs[p].dirichlet && (contact->pairs[p].by_force ? schwarz->levels[p] > 1 : substeps > 1)) single = PETSC_FALSE;
    }
  for (PetscInt p = 0; p < contact->n_pairs; p++) most = PetscMax(most, schwarz->levels[p]);
  *chain  = (PetscBool)(!single && !equal);
  *levels = single ? 1 : most;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Matrix level `l` of S, or of what forces do to Dirichlet sides */
static PetscErrorCode AssembleLevel(Contact contact, PetscInt l, PetscBool dirichlet, PetscScalar matrix[])
{
  const InterfaceProblem *problem = &((Schwarz *)contact->data)->problem;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(matrix, problem->n * problem->n));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(AddBody(contact, b, problem->levels == 1 ? -1 : l, dirichlet, matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Factor(Contact contact, PetscInt n)
{
  InterfaceProblem *problem = &((Schwarz *)contact->data)->problem;
  PetscBLASInt      size, info;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &size));
  PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&size, &size, problem->factor, &size, problem->pivots, &info));
  PetscCheck(info == 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_MAT_LU_ZRPVT,
             "The contact rows are not independent (LAPACK getrf info %d): they constrain each other", (int)info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where substeps differ: the matrix of the whole sweep, column by column, as differences of sweeps on the compliance, which is affine */
static PetscErrorCode AssembleChain(Contact contact)
{
  Schwarz          *schwarz = (Schwarz *)contact->data;
  InterfaceProblem *problem = &schwarz->problem;
  const PetscInt    L = problem->levels, size = problem->n * L;
  const PetscInt    sweeps = contact->counts_made.sweeps;
  const PetscBool   before = schwarz->responding;
  Vec               x, f;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(schwarz->outer.x, &x));
  PetscCall(VecDuplicate(schwarz->outer.x, &f));
  if (!before)
    for (PetscInt b = 0; b < contact->n_bodies; b++) {
      ContactGetConditions(contact, CONDITIONS_SCHWARZ, b, contact->conditions);
      PetscCall(BodySetRoles(contact->bodies[b], contact->conditions));
    }
  schwarz->responding = PETSC_TRUE;
  for (PetscInt column = -1; column < size; column++) {
    const PetscScalar *values;
    PetscScalar       *out = column < 0 ? problem->residual : problem->factor + column * size;

    PetscCall(VecZeroEntries(x));
    if (column >= 0) {
      const PetscInt row = problem->rows[column % problem->n], local = row - contact->row_begin;

      if (local >= 0 && local < contact->n_rows && column / problem->n < schwarz->levels[contact->row_pair[local]])
        PetscCall(VecSetValue(x, schwarz->all_offset[row] + column / problem->n, 1, INSERT_VALUES));
      PetscCall(VecAssemblyBegin(x));
      PetscCall(VecAssemblyEnd(x));
    }
    PetscCall(SchwarzSweep(NULL, x, f, contact));
    PetscCall(VecGetArrayRead(f, &values));
    for (PetscInt k = 0; k < L; k++)
      for (PetscInt i = 0; i < problem->n; i++) {
        const PetscInt local = problem->rows[i] - contact->row_begin;

        out[k * problem->n + i] = local >= 0 && local < contact->n_rows && k < schwarz->levels[contact->row_pair[local]]
                                      ? values[schwarz->offset[local] + k]
                                      : 0;
      }
    PetscCall(VecRestoreArrayRead(f, &values));
    if (contact->size > 1)
      PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, out, (PetscMPIInt)size, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
    if (column < 0) continue;
    for (PetscInt i = 0; i < size; i++) out[i] -= problem->residual[i];
    /* pairs with fewer unknowns to a row leave the others as they are */
    if (column / problem->n >= schwarz->levels[contact->all_row_pair[problem->rows[column % problem->n]]]) out[column] = 1;
  }
  schwarz->responding         = before;
  contact->counts_made.sweeps = sweeps;
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the active rows, and those whose force fades, known to the bodies that they concern */
static PetscErrorCode ExtendBodies(Contact contact)
{
  Schwarz          *schwarz = (Schwarz *)contact->data;
  InterfaceProblem *problem = &schwarz->problem;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt n = 0;

    for (PetscInt i = 0; i < problem->n_known; i++) {
      const ContactPair *pair = &contact->pairs[contact->all_row_pair[problem->rows[i]]];

      if (pair->body[0] == b || pair->body[1] == b) problem->body_rows[n++] = problem->rows[i];
    }
    PetscCall(BodyExtendCompliance(contact->bodies[b], n, problem->body_rows));
  }
  for (PetscInt i = 0; i < contact->n_rows; i++) schwarz->known[i] = (PetscBool)(schwarz->known[i] || contact->mine_active[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the rows that are active now, and makes everything known that it wants to know of the bodies */
PetscErrorCode SchwarzUpdateInterfaceProblem(Contact contact)
{
  Schwarz          *schwarz  = (Schwarz *)contact->data;
  InterfaceProblem *problem  = &schwarz->problem;
  PetscInt          count[3] = {0, 0, 0}, next[3] = {0, 0, 0};

  PetscFunctionBegin;
  if (!schwarz->stale) PetscFunctionReturn(PETSC_SUCCESS);
  schwarz->stale = PETSC_FALSE;
  PetscCall(ContactGatherActive(contact));
  for (PetscInt i = 0; i < contact->n_all_rows; i++) count[contact->all_active[i]]++;
  PetscCall(CountLevels(contact, &problem->levels, &problem->chain));
  problem->n        = count[1];
  problem->n_known  = count[1] + count[2];
  problem->factored = PETSC_FALSE;
  problem->dense    = (PetscBool)(problem->n_known * problem->levels <= schwarz->dense_limit);
  if (!problem->dense) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeRoom(problem, problem->n_known * problem->levels, schwarz->dense_limit));
  next[2] = count[1];
  for (PetscInt i = 0; i < contact->n_all_rows; i++)
    if (contact->all_active[i]) problem->rows[next[contact->all_active[i]]++] = i;
  PetscCall(ExtendBodies(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FactorProblem(Contact contact)
{
  InterfaceProblem *problem = &((Schwarz *)contact->data)->problem;
  const PetscInt    n       = problem->n;

  PetscFunctionBegin;
  if (problem->chain) {
    PetscCall(AssembleChain(contact));
    PetscCall(Factor(contact, n * problem->levels));
  } else {
    for (PetscInt l = 0; l < problem->levels; l++) {
      PetscCall(AssembleLevel(contact, l, PETSC_FALSE, problem->matrices + l * n * n));
      PetscCall(AssembleLevel(contact, l, PETSC_TRUE, problem->dirichlet + l * n * n));
    }
    PetscCall(PetscArraycpy(problem->factor, problem->matrices, n * n));
    PetscCall(Factor(contact, n));
  }
  problem->factored = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Residual of the active rows on every rank, one level after the other */
static PetscErrorCode GatherResidual(Contact contact, Vec F)
{
  const Schwarz          *schwarz = (const Schwarz *)contact->data;
  const InterfaceProblem *problem = &schwarz->problem;
  const PetscScalar      *f;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(F, &f));
  for (PetscInt k = 0; k < problem->levels; k++)
    for (PetscInt i = 0; i < problem->n; i++) {
      const PetscInt local = problem->rows[i] - contact->row_begin;

      problem->residual[k * problem->n + i] = local >= 0 && local < contact->n_rows && k < schwarz->levels[contact->row_pair[local]]
                                                  ? f[schwarz->offset[local] + k]
                                                  : 0;
    }
  PetscCall(VecRestoreArrayRead(F, &f));
  if (contact->size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, problem->residual, (PetscMPIInt)(problem->n * problem->levels), MPIU_SCALAR, MPIU_SUM,
                               PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* change = W_D S^{-1} residual, a convolution in time, or the inverse of the chain */
static PetscErrorCode SolveDense(Contact contact)
{
  InterfaceProblem *problem = &((Schwarz *)contact->data)->problem;
  const PetscInt    n       = problem->n;
  const PetscScalar plus = 1, minus = -1, zero = 0;
  PetscBLASInt      size, one = 1, info;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(problem->chain ? n * problem->levels : n, &size));
  PetscCall(PetscArraycpy(problem->change, problem->residual, n * problem->levels));
  if (problem->chain) {
    PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &size, &one, problem->factor, &size, problem->pivots, problem->change, &size, &info));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt k = 0; k < problem->levels; k++) {
    PetscScalar *force = problem->force + k * n, *change = problem->change + k * n;

    PetscCall(PetscArraycpy(force, problem->residual + k * n, n));
    for (PetscInt l = 0; l < k; l++)
      PetscCallBLAS("BLASgemv", BLASgemv_("N", &size, &size, &minus, problem->matrices + (k - l) * n * n, &size, problem->force + l * n,
                                          &one, &plus, force, &one));
    PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &size, &one, problem->factor, &size, problem->pivots, force, &size, &info));
    for (PetscInt l = 0; l <= k; l++)
      PetscCallBLAS("BLASgemv", BLASgemv_("N", &size, &size, &plus, problem->dirichlet + (k - l) * n * n, &size, problem->force + l * n,
                                          &one, l ? &plus : &zero, change, &one));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Y = F'^{-1} F by the compliance alone; rows that are not active stay where they are */
static PetscErrorCode ApplyCompliance(Contact contact, Vec F, Vec Y)
{
  Schwarz          *schwarz = (Schwarz *)contact->data;
  InterfaceProblem *problem = &schwarz->problem;
  PetscScalar      *y;

  PetscFunctionBegin;
  if (!problem->dense) {
    PetscCall(SchwarzSolveIteratively(contact, F, Y));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!problem->factored) PetscCall(FactorProblem(contact));
  PetscCall(GatherResidual(contact, F));
  PetscCall(SolveDense(contact));
  PetscCall(VecZeroEntries(Y));
  PetscCall(VecGetArray(Y, &y));
  for (PetscInt k = 0; k < problem->levels; k++)
    for (PetscInt i = 0; i < problem->n; i++) {
      const PetscInt local = problem->rows[i] - contact->row_begin;

      if (local >= 0 && local < contact->n_rows && k < schwarz->levels[contact->row_pair[local]])
        y[schwarz->offset[local] + k] = !problem->chain && ByForce(contact, local)
                                            ? problem->force[k * problem->n + i] / ContactForceUnit(contact, local)
                                            : problem->change[k * problem->n + i];
    }
  PetscCall(VecRestoreArray(Y, &y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyNewton(PC pc, Vec F, Vec Y)
{
  Contact     contact;
  Schwarz    *schwarz;
  Vec         rest;
  PetscInt    n, which[SCHWARZ_MAX_SECANTS];
  PetscScalar c[SCHWARZ_MAX_SECANTS];

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &contact));
  schwarz = (Schwarz *)contact->data;
  if (!schwarz->uses_secants || (schwarz->exact && schwarz->problem.dense)) {
    PetscCall(ApplyCompliance(contact, F, Y));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(SchwarzApplySecants(contact, F, &rest, &n, which, c));
  PetscCall(ApplyCompliance(contact, rest, Y));
  for (PetscInt i = 0; i < n; i++) PetscCall(VecAXPY(Y, c[i], schwarz->secants.dx[which[i]]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nothing to assemble: the interface problem is ready before the outer iteration begins */
static PetscErrorCode ComputeJacobian(SNES snes, Vec X, Mat J, Mat P, void *ctx)
{
  PetscFunctionBegin;
  (void)snes;
  (void)X;
  (void)J;
  (void)P;
  (void)ctx;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts Newton's step by the interface problem into the outer iteration */
PetscErrorCode SchwarzSetUpInterfaceProblem(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(OuterSolverSetNewton(contact, &((Schwarz *)contact->data)->outer, ComputeJacobian, ApplyNewton));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroyInterfaceProblem(Contact contact)
{
  InterfaceProblem *problem = &((Schwarz *)contact->data)->problem;

  PetscFunctionBegin;
  PetscCall(PetscFree4(problem->matrices, problem->dirichlet, problem->factor, problem->pivots));
  PetscCall(PetscFree5(problem->rows, problem->body_rows, problem->residual, problem->force, problem->change));
  PetscCall(KSPDestroy(&problem->iterative));
  PetscCall(VecDestroy(&problem->force_vec));
  PetscCall(VecDestroy(&problem->residual_vec));
  for (PetscInt k = 0; k < 2; k++) PetscCall(VecDestroy(&problem->work[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
