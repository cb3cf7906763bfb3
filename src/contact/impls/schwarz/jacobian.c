/*
   Newton's method for F(x) = x - G(x) by S, the interface operator of all bodies (interfaceoperator.h). After a sweep the forces on both
   sides of each row are opposite, and its residual is what is missing between their displacements. Forces d that close it,

     S d = F,

   move the Dirichlet sides by W_D d, W_D being the displacement of the Dirichlet sides under opposite forces: the step of Newton's method
   in x, whatever the order of the bodies; where x is a force it is d. With forces at several times in the controller step S and W_D are
   matrices of a convolution in time; where substeps differ so that they are not, the matrix of the whole sweep is found column by column.

   Under Robin conditions x is the right-hand side f + alpha w of the Dirichlet sides. With f_D, f_N and w_D, w_N the errors of forces and
   displacements on both sides after a sweep, F = 2 (f_D + f_N) = 2 alpha (w_D - w_N), so that

     S f_D = F / (2 alpha) - W_GN F / 2,   w_D = W_D f_D + W_DN F / 2,   x = f_D + alpha w_D,

   W_GN and W_DN being the gap and the displacement of the Dirichlet sides under forces on the Neumann sides.

   Where the contact nodes of a Dirichlet side have mass and hand their internal force over, which has no inertia in it, a sweep changes
   little (about (c dt / h)^2 / 2 of what comes in), and the identity is taken for the Jacobian.

   All this is exact for linear bodies; else, and where forces at several times meet conjugate gradients, secants of earlier sweeps do the
   rest.
*/
#include "schwarzimpl.h"

/* Rows of interfaces with so few are known to the bodies from the start, which leaves nothing to allocate in the time loop */
#define FEW_ROWS 16
/* Dense matrices that cost no more than so many products with S are made at once. Two cubes that come into contact with all 961 and 625
   nodes of a face each take 55 products a controller step where conjugate gradients do without, most of them in sweeps that prescribe
   displacements, and their dense matrices cost 75. */
#define AT_ONCE 100
/* Conjugate gradients, relative to the residual: a step of Newton's method that leaves so much takes one more sweep at most */
#define FORCE_TOLERANCE 1e-9
/* Where one step closes all gaps: part of what the outer iteration may leave, so that no other sweep corrects it; or round-off */
#define PART_OF_OUTER   0.03
#define FORCE_ROUND_OFF 1e-12

PetscErrorCode SchwarzMakeJacobianRoom(Jacobian *jacobian, PetscInt size, PetscInt most)
{
  PetscFunctionBegin;
  if (size <= jacobian->room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3(jacobian->residual, jacobian->force, jacobian->change));
  jacobian->room = PetscMax(size, PetscMin(2 * jacobian->room, most));
  PetscCall(PetscMalloc3(jacobian->room, &jacobian->residual, jacobian->room, &jacobian->force, jacobian->room, &jacobian->change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether forces at the same times act on all bodies: all are linear over the step, since Dirichlet sides make one substep or these forces
   are the unknowns, or all bodies of pairs make equally many substeps. Under Robin conditions the former alone is simple. */
static PetscErrorCode CountLevels(Contact contact, PetscInt *levels, PetscBool *chain)
{
  const Schwarz  *schwarz = (const Schwarz *)contact->data;
  const PetscBool robin   = (PetscBool)(schwarz->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN);
  PetscInt        first = 0, most = 1;
  PetscBool       equal = PETSC_TRUE, single = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt side = 0; side < 2; side++) {
      PetscInt substeps;

      if (contact->pairs[p].obstacle && side == 1) continue;
      PetscCall(BodyGetSubsteps(contact->bodies[contact->pairs[p].body[side]], &substeps));
      if (!first) first = substeps;
      if (substeps != first) equal = PETSC_FALSE;
      if (robin && substeps > 1) single = equal = PETSC_FALSE;
      if (side == contact->pairs[p].dirichlet && (contact->pairs[p].by_force ? schwarz->levels[p] > 1 : substeps > 1)) single = PETSC_FALSE;
    }
  for (PetscInt p = 0; p < contact->n_pairs; p++) most = PetscMax(most, schwarz->levels[p]);
  *chain  = (PetscBool)(!single && !equal);
  *levels = single ? 1 : most;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All levels of a local vector of unknowns, one after the other, on the rows that are solved for, of every rank */
static PetscErrorCode GatherLevels(Contact contact, const PetscScalar x[], PetscScalar all[])
{
  const Schwarz  *schwarz  = (const Schwarz *)contact->data;
  const Jacobian *jacobian = &schwarz->jacobian;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < jacobian->levels; k++)
    for (PetscInt i = 0; i < jacobian->n; i++) {
      const PetscInt local = jacobian->rows[i] - contact->rows.begin;

      all[k * jacobian->n + i] = local >= 0 && local < contact->rows.n && k < schwarz->levels[contact->rows.pair[local]]
                                     ? x[schwarz->offset[local] + k]
                                     : 0;
    }
  PetscCall(InterfaceOperatorSum(jacobian->S, jacobian->n * jacobian->levels, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where substeps differ: column by column, as differences of sweeps on the compliance, which is affine */
static PetscErrorCode AssembleChain(Contact contact)
{
  Schwarz          *schwarz  = (Schwarz *)contact->data;
  Jacobian         *jacobian = &schwarz->jacobian;
  const PetscInt    L = jacobian->levels, size = jacobian->n * L;
  const PetscInt    sweeps = contact->counts.sweeps;
  const SchwarzStep before = schwarz->step;

  PetscFunctionBegin;
  if (!jacobian->probe[0])
    for (PetscInt k = 0; k < 2; k++) PetscCall(VecDuplicate(schwarz->outer.x, &jacobian->probe[k]));
  if (before != STEP_CONDENSED) {
    for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetRestBase(contact->bodies[b]));
    PetscCall(SchwarzSetRoles(contact));
  }
  schwarz->step = STEP_CONDENSED;
  for (PetscInt column = -1; column < size; column++) {
    const PetscScalar *values;
    PetscScalar       *out = column < 0 ? jacobian->residual : jacobian->chained.values + column * size;

    PetscCall(VecZeroEntries(jacobian->probe[0]));
    if (column >= 0) {
      const PetscInt row = jacobian->rows[column % jacobian->n], local = row - contact->rows.begin;

      if (local >= 0 && local < contact->rows.n && column / jacobian->n < schwarz->levels[contact->rows.pair[local]])
        PetscCall(VecSetValue(jacobian->probe[0], schwarz->all_offset[row] + column / jacobian->n, 1, INSERT_VALUES));
      PetscCall(VecAssemblyBegin(jacobian->probe[0]));
      PetscCall(VecAssemblyEnd(jacobian->probe[0]));
    }
    PetscCall(SchwarzSweep(NULL, jacobian->probe[0], jacobian->probe[1], contact));
    PetscCall(VecGetArrayRead(jacobian->probe[1], &values));
    PetscCall(GatherLevels(contact, values, out));
    PetscCall(VecRestoreArrayRead(jacobian->probe[1], &values));
    if (column < 0) continue;
    for (PetscInt i = 0; i < size; i++) out[i] -= jacobian->residual[i];
    /* pairs with fewer unknowns to a row leave the others as they are */
    if (column / jacobian->n >= schwarz->levels[contact->ranks.row_pair[jacobian->rows[column % jacobian->n]]]) out[column] = 1;
  }
  schwarz->step          = before;
  contact->counts.sweeps = sweeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the rows that are active now, and those whose force fades: where matrices are dense, the bodies find their compliance */
PetscErrorCode SchwarzUpdateJacobian(Contact contact)
{
  Schwarz  *schwarz  = (Schwarz *)contact->data;
  Jacobian *jacobian = &schwarz->jacobian;

  PetscFunctionBegin;
  /* iterations may have cost as much as dense matrices in the meantime */
  if (!schwarz->stale && !(jacobian->S && InterfaceOperatorWantsDense(jacobian->S))) PetscFunctionReturn(PETSC_SUCCESS);
  schwarz->stale = PETSC_FALSE;
  if (schwarz->mode == SCHWARZ_MASS && schwarz->traction == BODY_TRACTION_INTERNAL) PetscFunctionReturn(PETSC_SUCCESS);
  ContactMarkActive(contact, jacobian->marks);
  PetscCall(CountLevels(contact, &jacobian->levels, &jacobian->chain));
  PetscCall(InterfaceOperatorSetRows(jacobian->S, jacobian->marks, jacobian->levels));
  InterfaceOperatorGetRows(jacobian->S, &jacobian->n, &jacobian->rows, &jacobian->dense);
  jacobian->chained.factored = PETSC_FALSE;
  if (!jacobian->dense) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SchwarzMakeJacobianRoom(jacobian, jacobian->n * jacobian->levels, schwarz->dense_limit));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    schwarz->known[i] = (PetscBool)(schwarz->known[i] || jacobian->marks[i] != INTERFACE_LEFT_OUT);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolveChain(Contact contact)
{
  Schwarz  *schwarz  = (Schwarz *)contact->data;
  Jacobian *jacobian = &schwarz->jacobian;

  PetscFunctionBegin;
  if (!jacobian->chained.factored) {
    const PetscInt size = jacobian->n * jacobian->levels;
    PetscBool      singular;

    PetscCall(PetscArraycpy(jacobian->change, jacobian->residual, size));
    PetscCall(DenseFactorResize(&jacobian->chained, size, schwarz->dense_limit));
    PetscCall(AssembleChain(contact));
    PetscCall(DenseFactorCompute(&jacobian->chained, &singular));
    PetscCheck(!singular, PetscObjectComm((PetscObject)contact), PETSC_ERR_MAT_LU_ZRPVT,
               "The matrix of the outer iteration is singular: contact rows are not independent, and constrain each other");
  } else PetscCall(PetscArraycpy(jacobian->change, jacobian->residual, jacobian->n * jacobian->levels));
  PetscCall(DenseFactorSolve(&jacobian->chained, jacobian->change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* change = W_D S^{-1} residual, a convolution in time */
static PetscErrorCode SolveConvolution(Jacobian *jacobian)
{
  const PetscInt n = jacobian->n;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(jacobian->change, n * jacobian->levels));
  for (PetscInt k = 0; k < jacobian->levels; k++) {
    PetscScalar *force = jacobian->force + k * n, *change = jacobian->change + k * n;

    PetscCall(PetscArraycpy(force, jacobian->residual + k * n, n));
    for (PetscInt l = 0; l < k; l++)
      PetscCall(InterfaceOperatorMultiplyListed(jacobian->S, INTERFACE_GAP, k - l, -1, jacobian->force + l * n, force));
    PetscCall(InterfaceOperatorSolveListed(jacobian->S, force));
    for (PetscInt l = 0; l <= k; l++)
      PetscCall(InterfaceOperatorMultiplyListed(jacobian->S, INTERFACE_DIRICHLET, k - l, 1, jacobian->force + l * n, change));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Y from F, both on every rank in between */
static PetscErrorCode ApplyDense(Contact contact, const PetscScalar f[], PetscScalar y[])
{
  Schwarz  *schwarz  = (Schwarz *)contact->data;
  Jacobian *jacobian = &schwarz->jacobian;

  PetscFunctionBegin;
  PetscCall(GatherLevels(contact, f, jacobian->residual));
  if (jacobian->chain) PetscCall(SolveChain(contact));
  else PetscCall(SolveConvolution(jacobian));
  for (PetscInt k = 0; k < jacobian->levels; k++)
    for (PetscInt i = 0; i < jacobian->n; i++) {
      const PetscInt local = jacobian->rows[i] - contact->rows.begin;

      if (local < 0 || local >= contact->rows.n || k >= schwarz->levels[contact->rows.pair[local]]) continue;
      y[schwarz->offset[local] + k] = !jacobian->chain && ByForce(contact, local)
                                          ? jacobian->force[k * jacobian->n + i] / ContactForceUnit(contact, local)
                                          : jacobian->change[k * jacobian->n + i];
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Level k of the pair with most unknowns to a row: the levels of all pairs end together */
static void GetLastLevels(Contact contact, PetscInt most, PetscInt k, const PetscScalar x[], PetscScalar level[])
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscInt at = k - (most - schwarz->levels[contact->rows.pair[i]]);

    level[i] = contact->end.active[i] && at >= 0 ? x[schwarz->offset[i] + at] : 0;
  }
}

/* On the rows of this rank, level by level: what the force at one time does later is left to the next sweep, so that with equal substeps
   the last level is right after as many sweeps as there are levels, and to secants */
static PetscErrorCode ApplyByLevels(Contact contact, const PetscScalar f[], PetscScalar y[])
{
  Schwarz     *schwarz  = (Schwarz *)contact->data;
  Jacobian    *jacobian = &schwarz->jacobian;
  PetscScalar *residual = schwarz->row_work, *force = residual + contact->rows.n, *moved = force + contact->rows.n;
  PetscInt     most     = 1;
  PetscBool    by_force = PETSC_TRUE; /* all forces are unknowns themselves */

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    most     = PetscMax(most, schwarz->levels[p]);
    by_force = (PetscBool)(by_force && contact->pairs[p].by_force);
  }
  for (PetscInt k = 0; k < most; k++) {
    GetLastLevels(contact, most, k, f, residual);
    PetscCall(InterfaceOperatorSolve(jacobian->S, residual, force));
    if (!by_force) PetscCall(InterfaceOperatorMultiply(jacobian->S, INTERFACE_DIRICHLET, force, moved));
    else if (most == 1) PetscCall(InterfaceOperatorTellAnswers(jacobian->S));
    for (PetscInt i = 0; i < contact->rows.n; i++) {
      const PetscInt at = k - (most - schwarz->levels[contact->rows.pair[i]]);

      if (contact->end.active[i] && at >= 0)
        y[schwarz->offset[i] + at] = ByForce(contact, i) ? force[i] / ContactForceUnit(contact, i) : moved[i];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Robin conditions, on the rows of this rank, level by level */
static PetscErrorCode ApplyRobin(Contact contact, const PetscScalar f[], PetscScalar y[])
{
  Schwarz         *schwarz  = (Schwarz *)contact->data;
  Jacobian        *jacobian = &schwarz->jacobian;
  const PetscReal *alpha    = schwarz->weight;
  PetscScalar     *residual = schwarz->row_work, *force = residual + contact->rows.n, *moved = force + contact->rows.n;
  PetscInt         most = 1;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) most = PetscMax(most, schwarz->levels[p]);
  for (PetscInt k = 0; k < most; k++) {
    GetLastLevels(contact, most, k, f, residual);
    PetscCall(InterfaceOperatorMultiply(jacobian->S, INTERFACE_NEUMANN_GAP, residual, moved));
    for (PetscInt i = 0; i < contact->rows.n; i++) moved[i] = contact->end.active[i] ? 0.5 * (residual[i] / alpha[i] - moved[i]) : 0;
    PetscCall(InterfaceOperatorSolve(jacobian->S, moved, force));
    for (PetscInt pass = 0; pass < 2; pass++) {
      PetscCall(
          InterfaceOperatorMultiply(jacobian->S, pass ? INTERFACE_NEUMANN_DIRICHLET : INTERFACE_DIRICHLET, pass ? residual : force, moved));
      for (PetscInt i = 0; i < contact->rows.n; i++) {
        const PetscInt at = k - (most - schwarz->levels[contact->rows.pair[i]]);

        if (!contact->end.active[i] || at < 0) continue;
        if (pass) y[schwarz->offset[i] + at] += 0.5 * alpha[i] * moved[i];
        else y[schwarz->offset[i] + at] = force[i] + alpha[i] * moved[i];
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Y = F'^{-1} F by the compliance alone; rows that are not active stay where they are */
static PetscErrorCode ApplyCompliance(Contact contact, Vec F, Vec Y)
{
  Schwarz           *schwarz  = (Schwarz *)contact->data;
  Jacobian          *jacobian = &schwarz->jacobian;
  const PetscScalar *f;
  PetscScalar       *y;

  PetscFunctionBegin;
  if (schwarz->mode == SCHWARZ_MASS && schwarz->traction == BODY_TRACTION_INTERNAL) {
    PetscCall(VecCopy(F, Y));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecZeroEntries(Y));
  PetscCall(VecGetArrayRead(F, &f));
  PetscCall(VecGetArray(Y, &y));
  if (schwarz->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN && !(jacobian->dense && jacobian->chain))
    PetscCall(ApplyRobin(contact, f, y));
  else if (jacobian->dense) PetscCall(ApplyDense(contact, f, y));
  else PetscCall(ApplyByLevels(contact, f, y));
  PetscCall(VecRestoreArray(Y, &y));
  PetscCall(VecRestoreArrayRead(F, &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyNewton(PC pc, Vec F, Vec Y)
{
  Contact  contact;
  Schwarz *schwarz;
  Vec      rest;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &contact));
  schwarz = (Schwarz *)contact->data;
  if (!schwarz->secants.dx || (schwarz->exact && schwarz->jacobian.dense)) PetscCall(ApplyCompliance(contact, F, Y));
  else {
    PetscCall(SchwarzApplySecants(contact, F, &rest));
    PetscCall(ApplyCompliance(contact, rest, Y));
    PetscCall(SchwarzAddSecants(contact, Y));
  }
  PetscCall(SchwarzHoldUnknowns(contact, Y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nothing to assemble: S is ready before the outer iteration begins */
PetscErrorCode SchwarzComputeJacobian(SNES snes, Vec X, Mat J, Mat P, void *ctx)
{
  PetscFunctionBegin;
  (void)snes;
  (void)X;
  (void)J;
  (void)P;
  (void)ctx;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The Jacobian of a level of controller steps; all rows of a small interface become known to the bodies. Overwrites the active set. */
PetscErrorCode SchwarzCreateJacobian(Contact contact)
{
  Schwarz                *schwarz  = (Schwarz *)contact->data;
  const PetscBool         closes   = (PetscBool)(schwarz->exact && !schwarz->substeps &&
                                                 schwarz->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN);
  const InterfaceSettings settings = {.prefix       = "schwarz_interface_",
                                      .tolerance    = closes ? FORCE_ROUND_OFF : FORCE_TOLERANCE,
                                      .enough       = closes ? PART_OF_OUTER * schwarz->atol : 0,
                                      .dense_limit  = schwarz->dense_limit,
                                      .few          = PetscMin(SCHWARZ_DENSE_ROWS, schwarz->dense_limit),
                                      .at_once      = AT_ONCE,
                                      .precondition = PETSC_TRUE,
                                      .sparse       = PETSC_TRUE,
                                      .direct       = PETSC_TRUE};

  PetscFunctionBegin;
  schwarz->stale = PETSC_TRUE;
  PetscCall(InterfaceOperatorCreate(contact, &settings, &schwarz->jacobian.S));
  PetscCall(PetscCalloc1(contact->rows.n, &schwarz->jacobian.marks));
  if (contact->rows.n_all > FEW_ROWS) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->end.active[i] = contact->rows.opposite[i];
  PetscCall(SchwarzUpdateJacobian(contact));
  schwarz->stale = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts Newton's step into the outer iteration */
PetscErrorCode SchwarzSetUpJacobian(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(OuterSolverSetNewton(contact, &schwarz->outer, SchwarzComputeJacobian, ApplyNewton));
  PetscCall(SchwarzCreateJacobian(contact));
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->end.active[i] = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
