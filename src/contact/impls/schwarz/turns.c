/*
   Turns of gaps as unknowns of the outer iteration, with which forces have the same sum along the normals of both sides of a pair
   (src/interface/balance.c). Beside the unknowns x of the rows there are the turns t of the controller step, for which

     gap = g + L t + ...,   C^T lambda = 0.

   L is a mean of C and of what it was in the step before. Newton's step takes forces d from those that hold the Dirichlet sides, and z
   from t, for S d = F + s L z and C^T d = -s C^T lambda, s being the sign of a force on the Neumann side (see jacobian.c). With
   D = S^{-1} L that is

     C^T D z = -C^T lambda - s C^T S^{-1} F,   d = S^{-1} F + s D z.

   A set of rows whose c have all one sign cannot have a force: the turn grows until another row joins. Where that would take it beyond the
   edge of an element, since forces press nodes deep into the partner that would spring back without them, the step is made without turns,
   and again with the row that a turn would close first. Where there is no such row, it stays without turns.

   A turn that hardly changes the gap of any active row stays as it is: nodes that lie flat on each other need none.
*/
#include "schwarzimpl.h"

/* Turns stay as they are where the mean c of active rows is below this part of what it is half way between two nodes without strain */
#define EVEN 1e-6
/* What holds them then, in parts of what it takes to turn without strain */
#define HOLD 1e6
/* Least c without strain [rad]: surfaces that are flatter are not turned */
#define PARALLEL 1e-3
/* Turn of a pair in contact, at most [edges of an element, of the coarser body]. Nodes lie half an edge of a face off the place where
   surfaces meet, and faces may be larger than the mean element. */
#define LARGEST 2.0

/* The number of turns of a pair, and C and L of a turn k and row i of it: uneven[n (i - begin) + k], and lever */
static PetscErrorCode GetTurns(Contact contact, PetscInt p, PetscInt *n, const PetscReal *uneven[], const PetscReal *lever[])
{
  PetscFunctionBegin;
  *n = contact->turns.begin[p + 1] - contact->turns.begin[p];
  if (*n) PetscCall(TransferGetTurns(contact->pairs[p].transfer, NULL, uneven, lever, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SumOverRanks(Contact contact, PetscInt n, PetscReal sums[])
{
  PetscFunctionBegin;
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds room for the turns to the unknowns of this rank: the first rank has them */
PetscErrorCode SchwarzSetUpTurns(Contact contact, PetscInt *unknowns)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n       = contact->turns.n;
  PetscMPIInt    rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)contact), &rank));
  schwarz->turns.offset = rank == 0 ? *unknowns : -1;
  if (rank == 0) *unknowns += n;
  PetscCall(PetscCalloc7(4 * contact->n_pairs, &schwarz->turns.hold, contact->n_pairs, &schwarz->turns.fixed, contact->n_pairs,
                         &schwarz->turns.joined, n, &schwarz->turns.sums, n, &schwarz->turns.step, n * n, &schwarz->turns.matrix, n,
                         &schwarz->turns.kept));
  if (n) PetscCall(PetscCalloc2(3 * contact->rows.n, &schwarz->turns.rows, n * contact->rows.n, &schwarz->turns.forces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What turns need of the method */
PetscErrorCode SchwarzCheckTurns(Contact contact)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;
  const char    *wrong   = NULL;

  PetscFunctionBegin;
  if (!contact->turns.n) PetscFunctionReturn(PETSC_SUCCESS);
  if (!schwarz->newton) wrong = "-schwarz_snes_type newtonls";
  if (schwarz->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN) wrong = "-schwarz_transmission dirichlet_neumann";
  if (schwarz->mode == SCHWARZ_MASS) wrong = "massless contact nodes of the first side (-<body>_mass_redistribute true)";
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP) wrong = "-contact_constraint gap";
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (schwarz->levels[p] > 1) wrong = "forces that are linear over the controller step (-contact_shared_times true)";
  PetscCheck(!wrong, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_balance goes with %s", wrong);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether turns suit the method, before it is set up */
PetscErrorCode SchwarzMayTurn(Contact contact, PetscBool *may)
{
  const Schwarz *schwarz  = (const Schwarz *)contact->data;
  char           type[64] = SNESNEWTONLS;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, "schwarz_", "-snes_type", type, sizeof(type), NULL));
  PetscCall(PetscStrcmp(type, SNESNEWTONLS, may));
  if (schwarz->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN || schwarz->swap) *may = PETSC_FALSE;
  for (PetscInt p = 0; p < contact->n_pairs && *may; p++) {
    PetscBool mass;

    PetscCall(BodyPrescribesMass(contact->bodies[contact->pairs[p].body[0]], &mass));
    if (mass) *may = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroyTurns(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(PetscFree7(schwarz->turns.hold, schwarz->turns.fixed, schwarz->turns.joined, schwarz->turns.sums, schwarz->turns.step,
                       schwarz->turns.matrix, schwarz->turns.kept));
  PetscCall(PetscFree2(schwarz->turns.rows, schwarz->turns.forces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Holds turns along the unit vector v where the mean of the squares of c along it is too small. `scale`: what it takes to turn where this
   is one */
static void HoldDirection(PetscReal mean, PetscReal scale, const PetscReal v[], PetscReal hold[])
{
  for (PetscInt k = 0; k < 4 && mean < PetscSqr(EVEN); k++) hold[k] += HOLD * scale * v[k / 2] * v[k % 2];
}

/* Sums over active rows: their number, bends, and products of their c */
static PetscErrorCode SumActive(Contact contact, PetscInt p, PetscInt n, PetscReal sums[])
{
  const ContactPair *pair = &contact->pairs[p];
  const PetscReal   *uneven, *bend;

  PetscFunctionBegin;
  PetscCall(TransferGetTurns(pair->transfer, NULL, &uneven, NULL, &bend, NULL));
  PetscCall(PetscArrayzero(sums, 5));
  for (PetscInt i = pair->begin; i < pair->end; i++) {
    const PetscReal *c = uneven + n * (i - pair->begin);

    if (!contact->end.active[i]) continue;
    sums[0]++;
    sums[1] += bend[i - pair->begin];
    sums[2] += c[0] * c[0];
    sums[3] += c[0] * c[n - 1] * (n - 1);
    sums[4] += c[n - 1] * c[n - 1] * (n - 1);
  }
  PetscCall(SumOverRanks(contact, 5, sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What holds turns with the active set as it is */
PetscErrorCode SchwarzHoldTurns(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs && contact->turns.n; p++) {
    PetscReal     *hold = schwarz->turns.hold + 4 * p;
    const PetscInt n    = contact->turns.begin[p + 1] - contact->turns.begin[p];
    PetscReal      sums[5], bend, scale, middle, radius, angle;

    if (!n) continue;
    PetscCall(SumActive(contact, p, n, sums));
    for (PetscInt k = 0; k < 5; k++) sums[k] = sums[0] > 0 ? sums[k] / (k ? sums[0] : 1) : 0;
    bend   = PetscMax(sums[1], PARALLEL);
    scale  = PetscSqr(bend) * contact->turns.stiffness[p];
    middle = 0.5 * (sums[2] + sums[4]) / PetscSqr(bend);
    radius = PetscSqrtReal(PetscSqr(0.5 * (sums[2] - sums[4])) + PetscSqr(sums[3])) / PetscSqr(bend);
    angle  = 0.5 * PetscAtan2Real(2 * sums[3], sums[2] - sums[4]);
    PetscCall(PetscArrayzero(hold, 4));
    HoldDirection(middle + radius, scale, (const PetscReal[]){PetscCosReal(angle), PetscSinReal(angle)}, hold);
    HoldDirection(middle - radius, scale, (const PetscReal[]){-PetscSinReal(angle), PetscCosReal(angle)}, hold);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums over all rows of values times what turns of the rows are */
static PetscErrorCode SumTurns(Contact contact, const PetscScalar values[], PetscReal sums[])
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(sums, contact->turns.n));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const PetscReal *uneven = NULL;
    PetscInt         n;

    PetscCall(GetTurns(contact, p, &n, &uneven, NULL));
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++)
      for (PetscInt k = 0; k < n; k++)
        sums[contact->turns.begin[p] + k] += uneven[n * (i - contact->pairs[p].begin) + k] * PetscRealPart(values[i]);
  }
  PetscCall(SumOverRanks(contact, contact->turns.n, sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Before a sweep: gaps are turned as the unknowns say */
PetscErrorCode SchwarzTakeTurns(Contact contact, const PetscScalar x[])
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n       = contact->turns.n;

  PetscFunctionBegin;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt t = 0; t < n; t++) schwarz->turns.step[t] = schwarz->turns.offset >= 0 ? PetscRealPart(x[schwarz->turns.offset + t]) : 0;
  PetscCall(SumOverRanks(contact, n, schwarz->turns.step));
  PetscCall(ContactTurn(contact, schwarz->turns.step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After a sweep: C^T lambda as the length by which forces of that sum would shift nodes [m], and turns that are not free */
PetscErrorCode SchwarzCompareTurns(Contact contact, PetscScalar f[])
{
  Schwarz     *schwarz = (Schwarz *)contact->data;
  PetscScalar *force   = schwarz->turns.rows;
  PetscReal   *sums    = schwarz->turns.sums;

  PetscFunctionBegin;
  if (!contact->turns.n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SchwarzGetForces(contact, force));
  PetscCall(SumTurns(contact, force, sums));
  for (PetscInt p = 0; p < contact->n_pairs && schwarz->turns.offset >= 0; p++) {
    const PetscInt   n    = contact->turns.begin[p + 1] - contact->turns.begin[p];
    const PetscReal *turn = contact->turns.change + contact->turns.begin[p], *hold = schwarz->turns.hold + 4 * p;
    PetscScalar     *out = f + schwarz->turns.offset + contact->turns.begin[p];

    for (PetscInt k = 0; k < n; k++) {
      out[k] = turn[k];
      if (schwarz->turns.fixed[p]) continue;
      out[k] = -sums[contact->turns.begin[p] + k];
      for (PetscInt l = 0; l < n; l++) out[k] += hold[2 * k + l] * turn[l];
      out[k] /= contact->turns.stiffness[p];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaussian elimination on a small matrix by columns, which is symmetric and positive definite but for what L is not C */
static void SolveSmall(PetscInt n, PetscReal a[], PetscReal b[])
{
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt i = k + 1; i < n; i++) {
      const PetscReal factor = a[n * k + i] / a[n * k + k];

      for (PetscInt j = k; j < n; j++) a[n * j + i] -= factor * a[n * j + k];
      b[i] -= factor * b[k];
    }
  for (PetscInt k = n - 1; k >= 0; k--) {
    for (PetscInt j = k + 1; j < n; j++) b[k] -= a[n * j + k] * b[j];
    b[k] /= a[n * k + k];
  }
}

/* D = S^{-1} L, and the matrix C^T D by columns, with what holds turns; the stiffness on the diagonal for turns that are fixed */
static PetscErrorCode MakeMatrix(Contact contact)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n = contact->turns.n, n_rows = contact->rows.n;
  PetscReal     *matrix = schwarz->turns.matrix;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const PetscReal *lever = NULL;
    PetscInt         count;

    PetscCall(GetTurns(contact, p, &count, NULL, &lever));
    for (PetscInt k = 0; k < count; k++) {
      const PetscInt t      = contact->turns.begin[p] + k;
      PetscScalar   *opened = schwarz->turns.rows, *forces = schwarz->turns.forces + t * n_rows;

      PetscCall(PetscArrayzero(opened, n_rows));
      PetscCall(PetscArrayzero(forces, n_rows));
      for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++)
        if (contact->end.active[i]) opened[i] = lever[count * (i - contact->pairs[p].begin) + k];
      PetscCall(InterfaceOperatorSolve(schwarz->jacobian.S, opened, forces));
      PetscCall(SumTurns(contact, forces, matrix + n * t));
    }
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const PetscInt begin = contact->turns.begin[p], end = contact->turns.begin[p + 1];

    for (PetscInt k = begin; k < end; k++) {
      for (PetscInt l = 0; l < n && schwarz->turns.fixed[p]; l++) matrix[n * l + k] = k == l ? contact->turns.stiffness[p] : 0;
      for (PetscInt l = begin; l < end && !schwarz->turns.fixed[p]; l++)
        matrix[n * l + k] += schwarz->turns.hold[4 * p + 2 * (k - begin) + l - begin];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newton's step for rows and turns, where each row has one unknown */
PetscErrorCode SchwarzApplyTurned(Contact contact, const PetscScalar f[], PetscScalar y[])
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n = contact->turns.n, n_rows = contact->rows.n;
  PetscScalar   *residual = schwarz->turns.rows, *force = residual + n_rows, *moved = force + n_rows;
  PetscReal     *z = schwarz->turns.step, *sums = schwarz->turns.sums;

  PetscFunctionBegin;
  PetscCall(MakeMatrix(contact));
  for (PetscInt i = 0; i < n_rows; i++) residual[i] = contact->end.active[i] ? f[schwarz->offset[i]] : 0;
  PetscCall(PetscArrayzero(force, n_rows));
  PetscCall(InterfaceOperatorSolve(schwarz->jacobian.S, residual, force));
  PetscCall(SumTurns(contact, force, sums));
  for (PetscInt t = 0; t < n; t++) z[t] = schwarz->turns.offset >= 0 ? PetscRealPart(f[schwarz->turns.offset + t]) : 0;
  PetscCall(SumOverRanks(contact, n, z));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt t = contact->turns.begin[p]; t < contact->turns.begin[p + 1]; t++)
      z[t] = z[t] * contact->turns.stiffness[p] - (schwarz->turns.fixed[p] ? 0 : NeumannSign(&contact->pairs[p]) * sums[t]);
  SolveSmall(n, schwarz->turns.matrix, z);
  for (PetscInt t = 0; t < n && schwarz->turns.offset >= 0; t++) y[schwarz->turns.offset + t] = z[t];
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt t = contact->turns.begin[p]; t < contact->turns.begin[p + 1]; t++)
      for (PetscInt i = 0; i < n_rows; i++) force[i] += NeumannSign(&contact->pairs[p]) * z[t] * schwarz->turns.forces[t * n_rows + i];
  PetscCall(InterfaceOperatorMultiply(schwarz->jacobian.S, INTERFACE_DIRICHLET, force, moved));
  for (PetscInt i = 0; i < n_rows; i++)
    if (contact->end.active[i]) y[schwarz->offset[i]] = ByForce(contact, i) ? force[i] / ContactForceUnit(contact, i) : moved[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After Newton's step Y: pairs whose gaps it would turn too far are not turned in this controller step, and the iteration begins anew */
PetscErrorCode SchwarzLimitTurns(Contact contact, Vec Y)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n       = contact->turns.n;
  PetscReal     *step    = schwarz->turns.step;
  PetscBool      any     = PETSC_FALSE;
  PetscScalar   *y;

  PetscFunctionBegin;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArray(Y, &y));
  for (PetscInt t = 0; t < n; t++) step[t] = schwarz->turns.offset >= 0 ? PetscRealPart(y[schwarz->turns.offset + t]) : 0;
  PetscCall(VecRestoreArray(Y, &y));
  PetscCall(SumOverRanks(contact, n, step));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const PetscInt begin = contact->turns.begin[p], end = contact->turns.begin[p + 1];
    PetscReal      turn[2] = {0, 0}, square = 0;

    if (begin == end || schwarz->turns.fixed[p]) continue;
    PetscCall(TransferGetTurns(contact->pairs[p].transfer, NULL, NULL, NULL, NULL, turn));
    for (PetscInt t = begin; t < end; t++) square += PetscSqr(turn[t - begin] + contact->turns.change[t] - step[t]);
    if (square <= PetscSqr(LARGEST * contact->turns.edge[p])) continue;
    schwarz->turns.fixed[p] = any = PETSC_TRUE;
  }
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecZeroEntries(Y));
  if (schwarz->secants.dx) SchwarzResetSecants(contact, PETSC_TRUE);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lets the open row join that a turn of a pair would close first, in the direction in which its forces drive it */
static PetscErrorCode JoinNext(Contact contact, PetscInt p, PetscReal largest, PetscBool *joined)
{
  const Schwarz     *schwarz = (const Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  const PetscReal   *drive = schwarz->turns.sums + contact->turns.begin[p], *uneven = NULL;
  PetscReal          length = 0, nearest = 2 * largest, least;
  PetscInt           n, row              = -1;

  PetscFunctionBegin;
  PetscCall(ContactComputeGaps(contact));
  PetscCall(GetTurns(contact, p, &n, &uneven, NULL));
  for (PetscInt k = 0; k < n; k++) length += PetscSqr(drive[k]);
  length = PetscSqrtReal(length);
  for (PetscInt i = pair->begin; i < pair->end && length > 0; i++) {
    PetscReal closes = 0;

    for (PetscInt k = 0; k < n; k++) closes -= uneven[n * (i - pair->begin) + k] * drive[k] / length;
    if (contact->end.active[i] || !contact->rows.opposite[i] || !(closes * nearest > contact->end.gap[i])) continue;
    nearest = contact->end.gap[i] / closes;
    row     = i;
  }
  least = nearest;
  if (contact->ranks.size > 1)
    PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, &least, 1, MPIU_REAL, MPIU_MIN, PetscObjectComm((PetscObject)contact)));
  *joined = (PetscBool)(least < 2 * largest); /* from one end to the other */
  if (row >= 0 && nearest == least) contact->end.active[row] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Pairs that are not turned in this step: it has to be made again, once, with the row that a turn would close first */
PetscErrorCode SchwarzJoinTurned(Contact contact, PetscBool *again)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  *again = PETSC_FALSE;
  for (PetscInt p = 0; p < contact->n_pairs && contact->turns.n; p++) {
    PetscBool joined;

    if (!schwarz->turns.fixed[p] || schwarz->turns.joined[p]) continue;
    PetscCall(JoinNext(contact, p, LARGEST * contact->turns.edge[p], &joined));
    schwarz->turns.joined[p] = PETSC_TRUE;
    schwarz->turns.fixed[p]  = (PetscBool)!joined;
    *again                   = (PetscBool)(*again || joined);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
