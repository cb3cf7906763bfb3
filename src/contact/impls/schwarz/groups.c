/*
   Groups of bodies that touch each other, directly or by others. They have nothing to do with each other, but share the outer iteration: it
   goes on until the slowest has converged, and begins anew when the active set changes anywhere. So a group that has converged rests: its
   unknowns stay as they are, to the last bit, and its bodies with them, until a row of one of them joins or leaves, or starts with another
   force. Bodies that nothing touches rest after one sweep.

   A group has converged at half of the tolerance on the change of position, shared out evenly among the groups by squares: then the test of
   all of them is met when the last one rests.
*/
#include "schwarzimpl.h"

#define PART_OF_TOLERANCE 0.5

PetscErrorCode SchwarzSetUpGroups(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  Groups  *groups  = &schwarz->groups;
  PetscInt unknowns;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(schwarz->outer.x, &unknowns));
  PetscCall(PetscCalloc4(contact->n_bodies, &groups->of, contact->n_bodies, &groups->state, contact->n_bodies, &groups->mismatch,
                         contact->n_bodies, &groups->rests));
  PetscCall(PetscCalloc4(contact->n_bodies + 1, &groups->found, 2 * contact->n_pairs, &groups->flags, contact->rows.n, &groups->active,
                         unknowns, &groups->residual));
  PetscCall(PetscCalloc5(2 * contact->n_bodies, &groups->largest, contact->n_bodies, &groups->before, 2 * contact->n_bodies,
                         &groups->margin, 2 * contact->rows.n, &groups->beyond, contact->n_bodies, &groups->wrong));
  for (PetscInt k = 0; k < 2; k++) schwarz->rounds.margin[k] = groups->beyond + k * contact->rows.n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroyGroups(Contact contact)
{
  Groups *groups = &((Schwarz *)contact->data)->groups;

  PetscFunctionBegin;
  PetscCall(PetscFree4(groups->of, groups->state, groups->mismatch, groups->rests));
  PetscCall(PetscFree4(groups->found, groups->flags, groups->active, groups->residual));
  PetscCall(PetscFree5(groups->largest, groups->before, groups->margin, groups->beyond, groups->wrong));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newton's steps alone leave unknowns where they are, and the residual alone tells what has converged where nothing else goes from sweep to
   sweep: velocities of nodes with mass, trials that the first guess comes from */
static PetscBool MayRest(Contact contact)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  return (PetscBool)(contact->n_bodies > 2 && schwarz->newton && schwarz->step == STEP_WHOLE && schwarz->mode != SCHWARZ_MASS &&
                     schwarz->convergence == SCHWARZ_CONVERGENCE_MISMATCH && schwarz->predictor != SCHWARZ_PREDICTOR_TRIAL &&
                     !schwarz->jacobian.chain && !schwarz->tied.any);
}

/* Bodies are to be integrated whatever has been found before */
void SchwarzWakeBodies(Contact contact)
{
  Groups *groups = &((Schwarz *)contact->data)->groups;

  for (PetscInt b = 0; b < contact->n_bodies; b++) groups->rests[b] = PETSC_FALSE;
}

/* Groups that were left before they had converged do not rest any more */
static void WakeLeft(Contact contact)
{
  Groups *groups = &((Schwarz *)contact->data)->groups;

  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (groups->state[groups->of[b]] == GROUP_LEFT) groups->rests[b] = PETSC_FALSE;
}

/* A controller step begins. In another attempt at it, groups that rest, and start as they did, are where they were. */
PetscErrorCode SchwarzBeginGroups(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  Groups  *groups  = &schwarz->groups;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const PetscInt g = groups->of[b];

    if (!contact->energy.stays[b]) groups->rests[g] = groups->rests[b] = PETSC_FALSE;
  }
  WakeLeft(contact);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    groups->rests[b] = (PetscBool)(groups->rests[b] && groups->rests[groups->of[b]]);
    /* the body has been made complete since, with reactions of the rows that it prescribes alone */
    if (groups->rests[b] && schwarz->has_forces) PetscCall(SchwarzReportByForce(contact, b));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether bodies of a pair rest: then its rows are where they were */
PetscBool SchwarzPairRests(Contact contact, PetscInt p)
{
  const Groups      *groups = &((const Schwarz *)contact->data)->groups;
  const ContactPair *pair   = &contact->pairs[p];

  return (PetscBool)(groups->rests[pair->body[0]] && (pair->obstacle || groups->rests[pair->body[1]]));
}

/* The first unknown of a row, or the end of all of this rank's */
static PetscInt FirstUnknown(Contact contact, PetscInt i)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  return i < contact->rows.n ? schwarz->offset[i] : contact->rows.n ? schwarz->offset[i - 1] + schwarz->room[contact->rows.pair[i - 1]] : 0;
}

/* Which pairs of all ranks have active rows, and of which rows have joined or left since the last time */
static PetscErrorCode FlagPairs(Contact contact, int has[], int differs[])
{
  Groups *groups = &((Schwarz *)contact->data)->groups;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    has[p] = differs[p] = 0;
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++) {
      has[p] |= contact->end.active[i] || ContactRowFades(contact, i);
      differs[p] |= contact->end.active[i] != groups->active[i];
      groups->active[i] = contact->end.active[i];
    }
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, groups->flags, (PetscMPIInt)(2 * contact->n_pairs), MPI_INT, MPI_MAX,
                               PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Squares of where the active rows of a pair are at the start of the step [m^2] */
static PetscErrorCode AddPositions(Contact contact, PetscInt p, PetscReal *sum)
{
  const ContactPair *pair = &contact->pairs[p];
  PetscScalar       *start;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(contact->traces[DirichletBody(pair)].displacement, 0, &start));
  for (PetscInt i = pair->begin; i < pair->end; i++)
    if (contact->end.active[i]) *sum += PetscSqr(start[i - DirichletShift(pair)]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The groups of the active set as it is; those in which rows have joined or left rest no more */
PetscErrorCode SchwarzFindGroups(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  Groups  *groups  = &schwarz->groups;
  int     *has = groups->flags, *differs = has + contact->n_pairs;

  PetscFunctionBegin;
  groups->on = contact->energy.reuses = MayRest(contact);
  groups->n                           = 0;
  if (!groups->on) {
    SchwarzWakeBodies(contact);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(FlagPairs(contact, has, differs));
  WakeLeft(contact);
  groups->position = 0;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    groups->of[b]    = b;
    groups->state[b] = GROUP_FREE;
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++)
      if (differs[p]) groups->rests[pair->body[side]] = PETSC_FALSE;
    if (!has[p]) continue;
    PetscCall(AddPositions(contact, p, &groups->position));
    if (!pair->obstacle) ContactJoinGroups(groups->of, pair->body[0], pair->body[1]);
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) groups->of[b] = ContactGroupOf(groups->of, b);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    /* nothing is said of rows that are not active any more */
    if (!has[p] && differs[p])
      PetscCall(PetscArrayzero(groups->residual + FirstUnknown(contact, pair->begin),
                               FirstUnknown(contact, pair->end) - FirstUnknown(contact, pair->begin)));
    if (has[p]) groups->state[groups->of[pair->body[0]]] = GROUP_RESTS;
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (groups->state[groups->of[b]] == GROUP_RESTS && !groups->rests[b]) groups->state[groups->of[b]] = GROUP_MOVES;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    groups->n += groups->of[b] == b && groups->state[b] != GROUP_FREE;
    if (groups->state[groups->of[b]] == GROUP_MOVES) groups->rests[b] = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a pair has rows that may move: others have nothing to hand over, and a residual that stays */
PetscBool SchwarzPairMoves(Contact contact, PetscInt p)
{
  const Groups *groups = &((const Schwarz *)contact->data)->groups;

  return (PetscBool)(!groups->on || (groups->flags[p] && !SchwarzPairRests(contact, p)));
}

/* Whether a body is to be told what comes in along the rows of a pair: one of which rows have left a last time */
PetscBool SchwarzPairTells(Contact contact, PetscInt p)
{
  const Groups *groups = &((const Schwarz *)contact->data)->groups;

  return (PetscBool)(!groups->on || groups->flags[p] || groups->flags[contact->n_pairs + p]);
}

/* Unknowns of this rank that Newton's step may change: all, or those of pairs that move */
PetscErrorCode SchwarzListMoving(Contact contact, PetscInt *n, PetscInt listed[])
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  if (!schwarz->groups.on) {
    PetscCall(VecGetLocalSize(schwarz->outer.x, n));
    for (PetscInt k = 0; k < *n; k++) listed[k] = k;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *n = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    if (!SchwarzPairMoves(contact, p)) continue;
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++)
      for (PetscInt k = 0; k < schwarz->room[p] && contact->end.active[i]; k++) listed[(*n)++] = schwarz->offset[i] + k;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Unknowns of pairs that rest stay where they are */
PetscErrorCode SchwarzHoldUnknowns(Contact contact, Vec Y)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;
  PetscScalar   *y;

  PetscFunctionBegin;
  if (!schwarz->groups.on) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArray(Y, &y));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    if (!schwarz->groups.flags[p] || !SchwarzPairRests(contact, p)) continue;
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++)
      for (PetscInt k = 0; k < schwarz->room[p]; k++) y[schwarz->offset[i] + k] = 0;
  }
  PetscCall(VecRestoreArray(Y, &y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The residual of all pairs, in whichever vector it is wanted */
PetscErrorCode SchwarzCopyResidual(Contact contact, PetscScalar f[])
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(f, schwarz->groups.residual, FirstUnknown(contact, contact->rows.n)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The squared change of position that the residual is for each group that moves, and after these the squares of all positions, of all
   ranks [m^2] */
static PetscErrorCode MeasureGroups(Contact contact)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;
  const Groups  *groups  = &schwarz->groups;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(groups->found, contact->n_bodies));
  groups->found[contact->n_bodies] = groups->position;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscReal         *sum  = &groups->found[groups->of[pair->body[0]]];

    if (!SchwarzPairMoves(contact, p)) continue;
    for (PetscInt i = pair->begin; i < pair->end; i++)
      for (PetscInt k = 0; k < schwarz->room[p] && contact->end.active[i]; k++)
        *sum += PetscSqr(SchwarzResidualScale(contact, i) * groups->residual[schwarz->offset[i] + k]);
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, groups->found, (PetscMPIInt)(contact->n_bodies + 1), MPIU_REAL, MPIU_SUM,
                               PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After a sweep, which has left its residual: groups that have converged rest, and bodies that nothing touches. Returns the squares of
   the change of position and of all positions, over all groups and ranks [m^2]. */
PetscErrorCode SchwarzSettleGroups(Contact contact, PetscReal sums[2])
{
  Schwarz  *schwarz = (Schwarz *)contact->data;
  Groups   *groups  = &schwarz->groups;
  PetscReal tolerance, most;
  PetscBool moves = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MeasureGroups(contact));
  sums[0]   = 0;
  sums[1]   = groups->found[contact->n_bodies];
  tolerance = PetscMax(schwarz->atol, schwarz->rtol * PetscSqrtReal(sums[1]));
  most      = PetscSqr(PART_OF_TOLERANCE * tolerance) / PetscMax(groups->n, 1);
  for (PetscInt g = 0; g < contact->n_bodies; g++) {
    if (groups->state[g] == GROUP_MOVES) groups->mismatch[g] = groups->found[g];
    if (groups->of[g] != g || groups->state[g] == GROUP_FREE || groups->state[g] == GROUP_LEFT) continue;
    groups->state[g] = groups->mismatch[g] <= most ? GROUP_RESTS : GROUP_MOVES;
  }
  PetscCall(SchwarzLeaveGroups(contact));
  for (PetscInt g = 0; g < contact->n_bodies; g++) {
    if (groups->of[g] != g || groups->state[g] == GROUP_FREE || groups->state[g] == GROUP_LEFT) continue;
    sums[0] += groups->mismatch[g];
    moves = (PetscBool)(moves || groups->state[g] == GROUP_MOVES);
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) groups->rests[b] = (PetscBool)(groups->state[groups->of[b]] != GROUP_MOVES);
  /* what rests from rounds with fewer groups may be too much together */
  if (moves || sums[0] <= PetscSqr(tolerance)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    if (groups->state[b] == GROUP_RESTS) groups->state[b] = GROUP_MOVES;
    groups->rests[b] = (PetscBool)(groups->state[groups->of[b]] == GROUP_FREE);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
