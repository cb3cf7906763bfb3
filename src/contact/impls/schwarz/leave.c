/*
   Groups whose active set will be another, and those that go on from the round before.

   The outer iteration takes three or four sweeps to find the forces of an active set to the last digit, and most sets of a step in which
   many bodies press on each other are not the one that it ends with: a row far from the others is pulled, or penetrates. That shows much
   earlier. After Newton's step the residual of a group tells what its gaps may still change by; and as the residual has become smaller by
   some factor, so will the next change of its forces be. A row that is wrong by more than this is not going to be right: its group is left,
   and rests until the iteration of the others has ended as well. Such rows change then, and no others of the group.

   The next round starts where the last one ended: rows that have joined without a force, those that have left without theirs, all others
   with what they had. Groups that have been left lose nothing by it, and the last round of a step needs a sweep or two.

   Neither is for controller steps in which a body makes substeps, where forces in the course of the step depend on what they were in the
   round before.
*/
#include "schwarzimpl.h"

/* What is left of residual and change of force, times this, is no bound: a row has several neighbours */
#define SAFETY 2
/* An iteration whose residual falls by less in a sweep tells nothing of what comes */
#define FALLS 0.25

/* The group of a pair's body on one side; of an obstacle that of the other */
static PetscInt GroupOfPair(Contact contact, PetscInt p, PetscInt side)
{
  const ContactPair *pair = &contact->pairs[p];

  return ((const Schwarz *)contact->data)->groups.of[pair->body[pair->obstacle ? 0 : side]];
}

/* The largest residual of a row in each group, and the largest change of a force since the last time */
static PetscErrorCode MeasureLargest(Contact contact)
{
  Schwarz   *schwarz = (Schwarz *)contact->data;
  Groups    *groups  = &schwarz->groups;
  PetscReal *gap = groups->largest, *force = gap + contact->n_bodies, *last = schwarz->kept_force;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) groups->before[b] = gap[b];
  PetscCall(PetscArrayzero(groups->largest, 2 * contact->n_bodies));
  PetscCall(PetscArraycpy(last, contact->end.force, contact->rows.n));
  PetscCall(SchwarzComputeEnd(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const PetscInt g = GroupOfPair(contact, p, 0);

    if (!SchwarzPairMoves(contact, p)) continue;
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++) {
      if (!contact->end.active[i]) continue;
      force[g] = PetscMax(force[g], PetscAbsReal(contact->end.force[i] - last[i]));
      gap[g]   = PetscMax(gap[g], PetscAbsScalar(SchwarzResidualScale(contact, i) * groups->residual[schwarz->offset[i]]));
    }
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, groups->largest, (PetscMPIInt)(2 * contact->n_bodies), MPIU_REAL, MPIU_MAX,
                               PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which groups have rows that are wrong by more than their margins */
static PetscErrorCode FindWrong(Contact contact)
{
  Schwarz         *schwarz = (Schwarz *)contact->data;
  Groups          *groups  = &schwarz->groups;
  const PetscReal *force = groups->margin, *gap = force + contact->n_bodies;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(groups->wrong, contact->n_bodies));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const PetscInt g = GroupOfPair(contact, p, 0), h = GroupOfPair(contact, p, 1);

    if (SchwarzPairRests(contact, p)) continue;
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++)
      if (RoundsRowIsWrong(&schwarz->rounds, i, force[g], PetscMax(gap[g], gap[h]))) groups->wrong[g] = groups->wrong[h] = 1;
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, groups->wrong, (PetscMPIInt)contact->n_bodies, MPI_INT, MPI_MAX,
                               PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After a sweep: groups that move, and have rows that will not be right, are left */
PetscErrorCode SchwarzLeaveGroups(Contact contact)
{
  Schwarz   *schwarz = (Schwarz *)contact->data;
  Groups    *groups  = &schwarz->groups;
  PetscReal *force = groups->margin, *gap = force + contact->n_bodies;
  PetscBool  any = PETSC_FALSE;

  PetscFunctionBegin;
  if (!schwarz->full_steps || schwarz->substeps || !RoundsMayLeave(&schwarz->rounds)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MeasureLargest(contact));
  for (PetscInt g = 0; g < contact->n_bodies; g++) {
    const PetscReal left = groups->largest[g], part = groups->before[g] > 0 ? left / groups->before[g] : PETSC_INFINITY;

    if (groups->state[g] == GROUP_LEFT) continue;
    force[g] = gap[g] = 0;
    if (groups->state[g] != GROUP_MOVES) continue;
    /* nothing is known after the first sweep */
    force[g] = schwarz->swept && part <= FALLS ? SAFETY * part * groups->largest[contact->n_bodies + g] : PETSC_INFINITY;
    gap[g]   = schwarz->swept && part <= FALLS ? SAFETY * left : PETSC_INFINITY;
    any      = PETSC_TRUE;
  }
  if (!any || !schwarz->swept) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FindWrong(contact));
  for (PetscInt g = 0; g < contact->n_bodies; g++) {
    if (groups->of[g] != g || groups->state[g] != GROUP_MOVES) continue;
    if (groups->wrong[g] && !PetscIsInfReal(gap[g])) {
      groups->state[g] = GROUP_LEFT;
      RoundsLeaveEarly(&schwarz->rounds);
    } else force[g] = gap[g] = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much each row is to be wrong for it to change, after a round in which groups were left */
PetscErrorCode SchwarzTakeMargins(Contact contact)
{
  Schwarz         *schwarz = (Schwarz *)contact->data;
  Groups          *groups  = &schwarz->groups;
  const PetscReal *force = groups->margin, *gap = force + contact->n_bodies;
  PetscReal       *beyond[2] = {groups->beyond, groups->beyond + contact->rows.n};

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const PetscInt g = GroupOfPair(contact, p, 0), h = GroupOfPair(contact, p, 1);

    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++) {
      beyond[0][i] = force[g];
      beyond[1][i] = PetscMax(gap[g], gap[h]);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
