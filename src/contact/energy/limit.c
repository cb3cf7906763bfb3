/* Steps that would gain energy at contact are made again with other contact forces at their start.

   The trapezoidal rule lets the force on a row do the work 1/2 (l0 + l1) dg: nothing while the row stays closed, -1/2 l1 g0 where it
   closes, and 1/2 l0 g1 where it opens, which is energy out of nothing. With the force x in place of l0 at the start, on both bodies,

     dE = 1/2 (x + l1) dg - 1/2 (x - l0) C (l1 - l0),

   C the compliance of the massless layers: exact for linear bodies under Newmark's rule. Where a group would gain more than its room
   (room.c),

   1. rows that leave start with x = s l0, the largest s in [0, 1] that keeps the energy within the room;
   2. where s = 0 does not, x of all rows goes to l1, where dE = l1 dg - 1/2 (l1 - l0) C (l1 - l0) <= 0. As l1 answers to x, by minus a part
      of it between 0 and 1, x goes by halves: what is missing at least halves each time;
   3. the last half may take too much. So x goes back towards the half before until the step takes nothing, and leaves the room to later
      steps: with all of it used up at once more of them were limited, and for some there was no start.

   Gaps at the end, and momentum, hold for any x, so the first attempt within the room is as good as the limit. Attempts are compared by
   energies themselves, in which the errors of the bodies' own integrators cancel. */
#include "energyimpl.h"

/* Attempts that look for s, beside s = 0, and for x */
#define MAX_PARTS  6
#define MAX_HALVES 40
/* Attempts by halves in succession each of which brings less than this part, inversely, of what is still too much: the last ones */
#define IN_VAIN     4
#define MAX_IN_VAIN 3
/* s is good where what is left of the room is below this part of what has been too much */
#define PART_LEFT 0.05
/* Energy that is round-off of the step's energies, in parts of the energy of the run */
#define ROUND_OFF 1e-11
/* Energy that friction may bring on a row in a step, in parts of the same; and attempts that look for a step with less */
#define FRICTION_BRINGS 1e-12
#define MAX_RUBS        20
/* Those among them, at first, that start with the force that the last one ended with */
#define WHOLE_WAYS 2
/* How often the two kinds of attempts take turns */
#define MAX_TURNS 4

/* What each group may gain in this step [J] */
static void FindRooms(Contact contact)
{
  const ContactEnergy *energy = &contact->energy;
  const PetscReal      more   = ContactMoreRoom(contact);

  for (PetscInt g = 0; g < contact->n_bodies; g++) energy->of_group[g] = 0;
  for (PetscInt b = 0; b < contact->n_bodies; b++) energy->of_group[energy->group[b]] += energy->room[b] - energy->change[b] + more;
  for (PetscInt g = 0; g < contact->n_bodies; g++) energy->of_group[g] = PetscMax(energy->of_group[g], 0);
}

/* Whether a group has gained more than it has room for */
static PetscBool GainsTooMuch(Contact contact, PetscInt g)
{
  const ContactEnergy *energy = &contact->energy;

  return (PetscBool)(energy->group_work[g] > energy->of_group[g] + ROUND_OFF * energy->scale);
}

/* Unmarked rows of a group that have left in the step, on all ranks. Those that end without force, not open, gain nothing. */
static PetscErrorCode MarkLeaving(Contact contact, PetscInt g, PetscBool *any)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  *any = PETSC_FALSE;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (ContactRowRubs(contact, i)) { /* with the row along the normal */
      energy->leaves[i] = energy->leaves[i - 1];
      continue;
    }
    if (energy->leaves[i] || energy->group[contact->pairs[contact->rows.pair[i]].body[0]] != g) continue;
    if (!contact->options.separation && contact->rows.tied[i]) continue; /* pulled, it does not leave */
    if ((energy->last_force[i] > 0 || energy->accepted_force[i] > 0) && contact->end.force[i] <= 0) {
      energy->leaves[i] = PETSC_TRUE;
      *any              = PETSC_TRUE;
    }
  }
  PetscCall(ContactOr(contact, any));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Leaving rows of a group start with a part of their force */
static void StartWithPart(Contact contact, PetscInt g, PetscReal part)
{
  ContactEnergy *energy = &contact->energy;

  energy->search[g].part = part;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (energy->leaves[i] && energy->group[contact->pairs[contact->rows.pair[i]].body[0]] == g) {
      energy->start_force[i] = part * energy->last_force[i];
      energy->rest[i]        = part;
    }
}

/* All rows of a group start a part of the way from the last attempt by halves to the one before */
static void StartOnWayBack(Contact contact, PetscInt g, PetscReal part)
{
  ContactEnergy *energy = &contact->energy;

  energy->search[g].part = part;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (energy->group[contact->pairs[contact->rows.pair[i]].body[0]] == g) {
      energy->start_force[i] = energy->half_force[i] + part * (energy->gain_force[i] - energy->half_force[i]);
      energy->rest[i]        = energy->half_rest[i] * (1 + part); /* the one before had twice as much */
    }
}

/* All rows of a group start half way from what they have started with to what they have ended with, but for a pull on rows that only push,
   and with half of what goes over from the rows as they were */
static void StartHalfWay(Contact contact, PetscInt g)
{
  ContactEnergy *energy = &contact->energy;

  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (energy->group[contact->pairs[contact->rows.pair[i]].body[0]] == g) {
      const PetscReal end = contact->rows.tied[i] || ContactRowRubs(contact, i) ? contact->end.force[i]
                                                                                : PetscMax(contact->end.force[i], 0);

      energy->gain_force[i] = energy->start_force[i];
      energy->start_force[i] += 0.5 * (end - energy->start_force[i]);
      energy->rest[i] *= 0.5;
      energy->half_force[i] = energy->start_force[i];
      energy->half_rest[i]  = energy->rest[i];
    }
}

/* Where to look next: energies are nearly a parabola, so that a secant finds its way; well inside the bracket */
static PetscReal NextPart(const ContactSearch *search, PetscReal aim)
{
  const PetscReal slope = (search->gain[1] - search->gain[0]) / (search->high - search->low);
  const PetscReal part = search->low + (aim - search->gain[0]) / slope * (1 - 0.5 * PART_LEFT), width = search->high - search->low;

  return PetscMin(PetscMax(part, search->low + 0.05 * width), search->high - 0.05 * width);
}

/* Where no force at the start of rows that leave is not enough: those that have left since do so too, or all start half way */
static PetscErrorCode TakeMoreAway(Contact contact, PetscInt g)
{
  ContactSearch *search = &contact->energy.search[g];
  PetscBool      any    = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MarkLeaving(contact, g, &any));
  if (any) StartWithPart(contact, g, 0);
  else {
    search->gain[1] = contact->energy.group_work[g];
    search->stage   = 2;
    search->tries   = 0;
    StartHalfWay(contact, g);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bisects between a start with a gain of at most `aim` and one with more, the last attempt's with `part` */
static void LookBetween(Contact contact, PetscInt g, PetscReal aim, void (*start)(Contact, PetscInt, PetscReal))
{
  ContactSearch  *search   = &contact->energy.search[g];
  const PetscReal gain     = contact->energy.group_work[g];
  const PetscBool too_much = (PetscBool)(gain > aim + ROUND_OFF * contact->energy.scale);
  const PetscReal excess   = search->gain[1] - aim;

  search->gain[too_much ? 1 : 0]             = gain;
  *(too_much ? &search->high : &search->low) = search->part;
  if (search->tries < MAX_PARTS && (too_much || aim - gain > PART_LEFT * excess)) (*start)(contact, g, NextPart(search, aim));
  else if (too_much && search->tries <= MAX_PARTS) (*start)(contact, g, search->low);
  else if (GainsTooMuch(contact, g)) { /* with other groups that have joined this one, `low` is no longer within the room */
    search->stage = 2;
    search->tries = 0;
    StartHalfWay(contact, g);
  } else search->done = PETSC_TRUE;
}

/* The next start of a group whose energy has to be kept, from how the last attempt went; done: it is the step. Stages: 0, not limited; 1,
   rows that leave start with a part of their force; 2, all rows start half way to what they end with; 3, on the way back. */
static PetscErrorCode SearchOn(Contact contact, PetscInt g)
{
  ContactEnergy  *energy   = &contact->energy;
  ContactSearch  *search   = &energy->search[g];
  const PetscReal gain     = energy->group_work[g];
  const PetscBool too_much = GainsTooMuch(contact, g);

  PetscFunctionBegin;
  search->tries++;
  if (search->stage == 0) {
    if (!too_much) PetscFunctionReturn(PETSC_SUCCESS);
    *search = (ContactSearch){.stage = 1, .low = -1, .high = 1, .gain = {0, gain}};
    PetscCall(TakeMoreAway(contact, g));
  } else if (search->stage == 1) {
    if (search->low < 0 && too_much) PetscCall(TakeMoreAway(contact, g));
    else LookBetween(contact, g, energy->of_group[g], StartWithPart);
  } else if (search->stage == 2 && too_much) {
    const PetscReal less = search->gain[1] - gain;

    /* what halves do is halved each time: this is far from enough, since the energy is not that of contact */
    search->in_vain = gain - energy->of_group[g] > IN_VAIN * PetscAbsReal(less) ? search->in_vain + 1 : 0;
    search->gain[1] = gain;
    if (search->tries < MAX_HALVES && search->in_vain < MAX_IN_VAIN) StartHalfWay(contact, g);
    else search->done = PETSC_TRUE;
  } else if (search->stage == 2 && !search->returned) {
    *search = (ContactSearch){.stage = 3, .high = 1, .gain = {gain, search->gain[1]}, .returned = PETSC_TRUE};
    LookBetween(contact, g, 0, StartOnWayBack);
  } else if (search->stage == 3) {
    LookBetween(contact, g, 0, StartOnWayBack);
  } else search->done = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool AnyGainsTooMuch(Contact contact)
{
  PetscBool any = PETSC_FALSE;

  FindRooms(contact);
  for (PetscInt g = 0; g < contact->n_bodies; g++) any = (PetscBool)(any || (contact->energy.group[g] == g && GainsTooMuch(contact, g)));
  return any;
}

/* Whether friction brings energy on a row by the forces at both ends. Slip of a sticking node is left residual, which no start lessens. */
static PetscBool Rubs(Contact contact, PetscInt i)
{
  const PetscReal start = contact->energy.changed ? contact->energy.start_force[i] : contact->energy.last_force[i];
  const PetscInt  first = ContactFirstRow(contact, i);

  if (!ContactRowRubs(contact, i) || (contact->end.active[first] && !contact->friction.slides[first])) return PETSC_FALSE;
  return (PetscBool)(0.5 * (start + contact->end.force[i]) * contact->friction.slip[i] > FRICTION_BRINGS * contact->energy.scale);
}

/* Nodes on which friction has brought energy, since the force at the start of the step pushes the way that they slide, start nearer to
   the force across their normal that they end with: with that one friction takes energy, whatever it is. It answers to the start, but
   seldom so much that it turns round; where it does, it is approached by halves. Collective. */
static PetscErrorCode LimitFriction(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  for (PetscInt tries = 0; tries < MAX_RUBS && contact->friction.slip; tries++) {
    const PetscReal way = tries < WHOLE_WAYS ? 1 : 0.5;
    PetscBool       any = PETSC_FALSE;

    for (PetscInt i = 0; i < contact->rows.n && !any; i++) any = Rubs(contact, i);
    PetscCall(ContactOr(contact, &any));
    if (!any) break;
    if (!energy->changed) PetscCall(ContactBeginAttempts(contact));
    for (PetscInt i = 0; i < contact->rows.n; i++)
      if (Rubs(contact, i)) energy->start_force[i] += way * (contact->end.force[i] - energy->start_force[i]);
    PetscCall(ContactMakeAttempt(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Attempt(Contact contact)
{
  ContactEnergy *energy = &contact->energy;
  PetscBool      going  = PETSC_TRUE;

  PetscFunctionBegin;
  if (!energy->changed) PetscCall(ContactBeginAttempts(contact));
  PetscCall(PetscArrayzero(energy->leaves, contact->rows.n));
  PetscCall(PetscArrayzero(energy->search, contact->n_bodies));
  while (going) {
    going = PETSC_FALSE;
    FindRooms(contact);
    for (PetscInt g = 0; g < contact->n_bodies; g++) {
      ContactSearch *search = &energy->search[g];
      const PetscInt before = search->stage;

      if (energy->group[g] != g || search->done) continue;
      PetscCall(SearchOn(contact, g));
      if ((search->stage || before) && !search->done) going = PETSC_TRUE;
    }
    if (!going) break;
    PetscCall(ContactMakeAttempt(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Attempts, by which friction may gain on rows with a changed start: in turn until neither does, gains of groups first. */
static PetscErrorCode AttemptWithFriction(Contact contact)
{
  PetscBool in_vain = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt turn = 0; turn < MAX_TURNS && !in_vain && AnyGainsTooMuch(contact); turn++) {
    PetscCall(Attempt(contact));
    for (PetscInt g = 0; g < contact->n_bodies; g++) in_vain = (PetscBool)(in_vain || contact->energy.search[g].in_vain == MAX_IN_VAIN);
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    if (turn < MAX_TURNS - 1) PetscCall(LimitFriction(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  }
  contact->counts.limited_steps++;
  if (AnyGainsTooMuch(contact)) contact->counts.unlimited_steps++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Work of contact on each group in a step for which rows have been built again, from the energies of bodies and springs: those of linear
   bodies change by nothing else. Of others the larger one of it and of what the rows tell counts. */
static PetscErrorCode MeasureGroupWork(Contact contact)
{
  ContactEnergy *energy = &contact->energy;
  PetscReal     *work = energy->of_group, *touches = work + contact->n_bodies, *inexact = touches + contact->n_bodies;

  PetscFunctionBegin;
  PetscCall(ContactComputeEnergies(contact, energy->energies, energy->springs));
  for (PetscInt g = 0; g < contact->n_bodies; g++) {
    work[g]    = 0;
    touches[g] = inexact[g] = 0;
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    BodyStepProperties properties;

    PetscCall(BodyGetStepProperties(contact->bodies[b], &properties));
    if (!properties.affine) inexact[energy->group[b]] = 1;
    work[energy->group[b]] += energy->energies[b] - energy->start_energy[b];
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const PetscInt g = energy->group[contact->pairs[p].body[0]];

    if (energy->pair_sums[2 * p + 1] == 0) continue;
    touches[g] = 1;
    work[g] += energy->springs[2 * p];
  }
  for (PetscInt g = 0; g < contact->n_bodies; g++)
    if (touches[g] > 0) energy->group_work[g] = inexact[g] > 0 ? PetscMax(work[g], energy->group_work[g]) : work[g];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After the step has been made: makes it again where it has gained energy at contact beyond what there is room for. Collective. */
PetscErrorCode ContactLimitEnergy(Contact contact)
{
  ContactEnergy *energy = &contact->energy;
  PetscBool      touch  = PETSC_FALSE;

  PetscFunctionBegin;
  energy->known       = (PetscBool)!energy->unlimited;
  energy->step_work   = 0;
  energy->stays_whole = PETSC_FALSE;
  if (energy->unlimited) PetscFunctionReturn(PETSC_SUCCESS);
  energy->changed = PETSC_FALSE;
  PetscCall(PetscArraycpy(energy->last_force, contact->start.force, contact->rows.n));
  PetscCall(ContactComputeFrictionLoss(contact, energy->last_force));
  PetscCall(ContactComputeWork(contact));
  PetscCall(PetscArrayzero(energy->group_work, contact->n_bodies));
  for (PetscInt b = 0; b < contact->n_bodies; b++) energy->group[b] = b;
  ContactFindGroups(contact);
  for (PetscInt p = 0; p < contact->n_pairs; p++) energy->group_work[energy->group[contact->pairs[p].body[0]]] += energy->pair_sums[2 * p];
  for (PetscInt p = 0; p < contact->n_pairs && !touch; p++) touch = (PetscBool)(energy->pair_sums[2 * p + 1] != 0);
  if (energy->rebuilt && touch) PetscCall(MeasureGroupWork(contact));
  ContactLeaveOutStatic(contact);
  if (contact->options.energy_cap) PetscCall(LimitFriction(contact));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt g = 0; g < contact->n_bodies; g++) energy->step_work += energy->group[g] == g ? energy->group_work[g] : 0;
  if (contact->attempt.may_cut) { /* what is cut in halves all the same need not be limited */
    PetscReal loss;
    PetscBool can;

    PetscCall(ContactGetEnergyLoss(contact, &loss));
    if (PetscAbsReal(loss) > contact->attempt.most_loss) {
      PetscCall(ContactCanAffordHalves(contact, &can));
      if (can) PetscFunctionReturn(PETSC_SUCCESS);
      energy->stays_whole = PETSC_TRUE;
    }
  }
  if (!contact->options.energy_cap || !AnyGainsTooMuch(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AttemptWithFriction(contact));
  energy->step_work = 0;
  for (PetscInt g = 0; g < contact->n_bodies; g++) energy->step_work += energy->group[g] == g ? energy->group_work[g] : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
