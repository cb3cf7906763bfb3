/* Accounts of what contact has lost, body by body: the room within which later steps may gain energy again.

   A body begins with an equal share of the excess that is allowed in all. What a pair loses is credited to its bodies in halves, or wholly
   to the body before an obstacle. Bodies that touch, directly or by others, are a group as long as they do; a group may gain what its
   bodies have room for, and takes it from them in proportion. So no room becomes negative, and bodies that part keep what they have lost.

   What central differences conserve depends on the step: a body has more energy from the start of a step that is shorter than the last one,
   by 1/8 (dt_0^2 - dt^2) a'Ma. Steps that are cut where the body shakes, and whole where it does not, would gain by that; so it is booked
   too, and a step is not cut for the sake of energy where there is no room for it. */
#include "energyimpl.h"
#include <impakt/private/bodymeasures.h>

#define ROUND_OFF_STRAIN PETSC_MACHINE_EPSILON /* what bodies at rest may have when their massless nodes have found their balance */

/* Which bodies have been in one group in this step, in the attempts so far: those whose pairs touch are joined to it */
void ContactFindGroups(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (energy->pair_sums[2 * p + 1] != 0 && !pair->obstacle) ContactJoinGroups(energy->group, pair->body[0], pair->body[1]);
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) energy->group[b] = ContactGroupOf(energy->group, b);
}

/* Groups in which a body has no inertia neither gain nor lose: static balance knows no force at the start of a step, so that the
   trapezoidal rule does not tell the work of contact, and no other force there changes the step. */
void ContactLeaveOutStatic(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (BodyDoes(contact->bodies[b], BodyIsStatic)) energy->group_work[energy->group[b]] = 0;
}

/* How far gaps may be from what they are said to be [m] */
static PetscReal Resolution(Contact contact)
{
  return contact->options.tolerance + CONTACT_POSITION_TOLERANCE * contact->scale.length;
}

static PetscReal SumForces(Contact contact)
{
  PetscReal sum = 0;

  for (PetscInt p = 0; p < contact->n_pairs; p++) sum += contact->energy.pair_sums[2 * p + 1];
  return sum;
}

/* What contact forces do over the distances to which gaps are known, the tolerance of penetration and that of the outer iteration [J], in
   the step in which their sum was largest so far; the same on every rank. Bodies that start at rest under slow loads have less energy than
   that at first. Where rows in contact hold the change of their gaps, not these, it is that of all steps so far. */
PetscErrorCode ContactGetUnresolvedEnergy(Contact contact, PetscReal *energy)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(energy, 2);
  *energy = contact->energy.known || contact->energy.takes
                ? Resolution(contact) * PetscMax(contact->energy.largest_force, SumForces(contact))
                : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much a body's room is larger in this step: its share of what is unresolved, as far as that is more than in all steps before. Only
   where all starts at rest without strain; elsewhere the excess is far larger. */
PetscReal ContactMoreRoom(Contact contact)
{
  const ContactEnergy *energy = &contact->energy;

  return energy->at_rest ? Resolution(contact) * PetscMax(SumForces(contact) - energy->largest_force, 0) / (PetscReal)contact->n_bodies : 0;
}

/* Whether halves of the present step would not begin with more energy than each group has room for. Collective. */
PetscErrorCode ContactCanAffordHalves(Contact contact, PetscBool *can)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  *can = PETSC_TRUE;
  if (!contact->options.energy_cap) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArrayzero(energy->energies, contact->n_bodies));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal change;

    PetscCall(BodyGetLevelEnergy(contact->bodies[b], contact->attempt.level + 1, &change));
    energy->energies[energy->group[b]] += energy->room[b] - change;
  }
  for (PetscInt g = 0; g < contact->n_bodies; g++)
    if (energy->energies[g] < 0) *can = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes changes of energies at the start of the step from the bodies' room; others of a group fill up in proportion to theirs. */
static PetscErrorCode BookLevel(Contact contact)
{
  ContactEnergy *energy = &contact->energy;
  PetscReal     *owed = energy->of_group, *has = owed + contact->n_bodies;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(owed, 2 * contact->n_bodies));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    energy->room[b] -= energy->change[b];
    (energy->room[b] < 0 ? owed : has)[energy->group[b]] += PetscAbsReal(energy->room[b]);
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const PetscInt g = energy->group[b];

    if (owed[g] > 0) energy->room[b] = energy->room[b] < 0 || has[g] <= owed[g] ? 0 : energy->room[b] * (1 - owed[g] / has[g]);
  }
  PetscCall(PetscArrayzero(energy->change, contact->n_bodies));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Kinetic and potential energy of all bodies, the same in every frame, see `BodyGetOwnKinetic()`. Collective. */
static PetscErrorCode GetOwnEnergy(Contact contact, PetscReal *energy)
{
  BodyMeasures *measures = contact->energy.measures;

  PetscFunctionBegin;
  PetscCall(BodyGetAllMeasures(contact->n_bodies, contact->bodies, contact->energy.sums, measures));
  for (PetscInt b = 0; b < contact->n_bodies && contact->n_obstacles; b++) measures[b].loaded = PETSC_TRUE; /* obstacles do not move */
  PetscCall(BodyGetOwnKinetic(contact->n_bodies, contact->bodies, measures, energy));
  for (PetscInt b = 0; b < contact->n_bodies; b++) *energy += measures[b].potential;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The excess is a part of the energy at the start or, from rest without strain, of the largest of accepted steps. Collective. */
static PetscErrorCode GrowRoom(Contact contact)
{
  ContactEnergy *energy = &contact->energy;
  PetscReal      now    = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) energy->room[b] += ContactMoreRoom(contact);
  if (!energy->at_rest || contact->options.energy_excess == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GetOwnEnergy(contact, &now));
  if (now <= energy->scale) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    energy->room[b] += contact->options.energy_excess * (now - energy->scale) / contact->n_bodies;
  energy->scale = now;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Books the work of the accepted step, which is known for each group, and shares losses among pairs as they were first */
PetscErrorCode ContactBookWork(Contact contact)
{
  ContactEnergy *energy = &contact->energy;
  PetscReal     *room = energy->of_group, *members = room + contact->n_bodies, *lost = members + contact->n_bodies;

  PetscFunctionBegin;
  energy->rebuilt = PETSC_FALSE;
  if (contact->options.energy_cap && !energy->unlimited) PetscCall(GrowRoom(contact));
  if (!energy->known) PetscFunctionReturn(PETSC_SUCCESS);
  energy->largest_force = PetscMax(energy->largest_force, SumForces(contact));
  PetscCall(PetscArraycpy(energy->accepted_force, contact->end.force, contact->rows.n));
  PetscCall(BookLevel(contact));
  for (PetscInt i = 0; i < contact->rows.n && contact->ops->stored != ContactStoresNothing; i++)
    energy->last_stored[i] = (*contact->ops->stored)(contact, i, contact->end.gap[i]);
  PetscCall(PetscArrayzero(room, 2 * contact->n_bodies));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    room[energy->group[b]] += energy->room[b];
    members[energy->group[b]] += 1;
    if (energy->group[b] == b) energy->work += energy->group_work[b];
  }
  PetscCall(PetscArrayzero(lost, contact->n_bodies));
  for (PetscInt p = 0; p < contact->n_pairs; p++) lost[energy->group[contact->pairs[p].body[0]]] += PetscMax(-energy->pair_sums[2 * p], 0);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const PetscInt  g    = energy->group[b];
    const PetscReal work = energy->group_work[g];

    if (work > 0) energy->room[b] *= room[g] > 0 ? PetscMax(1 - work / room[g], 0) : 0;
    else if (work < 0 && lost[g] == 0) energy->room[b] -= work / members[g]; /* not by a pair: to all of the group alike */
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const PetscInt     g    = energy->group[pair->body[0]];
    PetscReal          share;

    if (!(energy->group_work[g] < 0) || !(lost[g] > 0)) continue;
    share = -energy->group_work[g] * PetscMax(-energy->pair_sums[2 * p], 0) / lost[g];
    energy->room[pair->body[0]] += pair->obstacle ? share : 0.5 * share;
    if (!pair->obstacle) energy->room[pair->body[1]] += 0.5 * share;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyRowEnergy(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  PetscCall(PetscFree5(energy->last_stored, energy->broken, energy->accepted_force, energy->last_force, energy->start_force));
  PetscCall(PetscFree4(energy->last, energy->now, energy->leaves, energy->rest));
  PetscCall(PetscFree3(energy->half_force, energy->half_rest, energy->gain_force));
  PetscCall(PetscFree2(energy->pair_sums, energy->springs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactSetUpRowEnergy(Contact contact)
{
  ContactEnergy *energy = &contact->energy;
  const PetscInt rows = contact->rows.n, pairs = contact->n_pairs;

  PetscFunctionBegin;
  PetscCall(DestroyRowEnergy(contact));
  PetscCall(PetscCalloc5(rows, &energy->last_stored, rows, &energy->broken, rows, &energy->accepted_force, rows, &energy->last_force, rows,
                         &energy->start_force));
  PetscCall(PetscCalloc4(rows, &energy->last, rows, &energy->now, rows, &energy->leaves, rows, &energy->rest));
  PetscCall(PetscCalloc3(rows, &energy->half_force, rows, &energy->half_rest, rows, &energy->gain_force));
  PetscCall(PetscCalloc2(2 * pairs, &energy->pair_sums, 2 * pairs, &energy->springs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactSetUpEnergy(Contact contact)
{
  ContactEnergy *energy = &contact->energy;
  const PetscInt n      = contact->n_bodies;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(BODY_MEASURE_SUMS * n, &energy->sums, n, &energy->measures));
  PetscCall(PetscCalloc5(n, &energy->change, n, &energy->start_energy, n, &energy->first_work, n, &energy->room, n, &energy->group));
  PetscCall(PetscCalloc4(n, &energy->group_work, n, &energy->energies, n, &energy->search, 3 * n, &energy->of_group));
  PetscCall(ContactSetUpRowEnergy(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the start of a step: by how much more energy bodies have, since it has another size than the last one; before the first one the room
   that they begin with, from the energies of their initial states. Collective. */
PetscErrorCode ContactBeginEnergy(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    PetscCall(BodyGetLevelEnergy(contact->bodies[b], contact->attempt.level, &energy->change[b]));
  if (energy->begun) PetscFunctionReturn(PETSC_SUCCESS);
  energy->begun = PETSC_TRUE;
  PetscCall(GetOwnEnergy(contact, &energy->scale));
  energy->at_rest = (PetscBool)(energy->scale <= PetscSqr(ROUND_OFF_STRAIN) * contact->scale.force * contact->scale.length);
  energy->scale   = PetscMax(energy->scale, 0);
  for (PetscInt b = 0; b < contact->n_bodies; b++) energy->room[b] = contact->options.energy_excess * energy->scale / contact->n_bodies;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyEnergy(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  PetscCall(DestroyRowEnergy(contact));
  PetscCall(PetscFree2(energy->sums, energy->measures));
  PetscCall(PetscFree5(energy->change, energy->start_energy, energy->first_work, energy->room, energy->group));
  PetscCall(PetscFree4(energy->group_work, energy->energies, energy->search, energy->of_group));
  PetscFunctionReturn(PETSC_SUCCESS);
}
