/* When contact begins and ends, by linear interpolation inside the controller step. A step that ends in contact has no gap, whenever in the
   step it closed, and one that ends without contact has no force, whenever in the step that went. So the rates are those of the
   neighbouring step. Contact that begins and ends inside a step that was made in parts is known by its impulse. */
#include "contacttimes.h"
#include <math.h>

/* Gaps beyond this one say that nothing lies opposite [m] */
#define NO_GAP 1e30

/* What a pair does at the end of a controller step */
typedef struct {
  PetscReal time, gap, force, impulse; /* s, m, N, N s */
  PetscBool touches;
  PetscBool inside; /* it touches at neither end of the step, but inside */
} Record;

typedef struct {
  PetscInt            side[2]; /* numbers of its bodies; -1: an obstacle */
  PetscInt            n;
  Record              last[2]; /* the ends of the last steps, the latest first */
  ContactTimesResults results;
} PairTimes;

struct _n_ContactTimes {
  PetscInt   n_pairs, n_bodies;
  PairTimes *pairs;
  PetscReal *start_velocity; /* of the contact nodes of each body, their mean: 3 numbers [m/s] */
};

/* ContactTimesCreate - the times of contact of the pairs of a controller, which is set up */
PetscErrorCode ContactTimesCreate(Controller controller, ContactTimes *times)
{
  const Body  *bodies;
  Contact      contact;
  ContactTimes t;

  PetscFunctionBegin;
  PetscCall(PetscNew(&t));
  PetscCall(ControllerGetBodies(controller, &t->n_bodies, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ContactGetNumPairs(contact, &t->n_pairs));
  PetscCall(PetscCalloc2(t->n_pairs, &t->pairs, 3 * t->n_bodies, &t->start_velocity));
  for (PetscInt p = 0; p < t->n_pairs; p++) {
    PairTimes *pair = &t->pairs[p];
    Body       sides[2];

    PetscCall(ContactGetPair(contact, p, NULL, &sides[0], &sides[1]));
    pair->results = (ContactTimesResults){.onset = NAN, .separation = NAN};
    for (PetscInt k = 0; k < 2; k++) {
      pair->side[k] = -1;
      for (PetscInt b = 0; b < t->n_bodies; b++)
        if (bodies[b] == sides[k]) pair->side[k] = b;
    }
  }
  *times = t;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rate at which the gap of a pair changes at the start, along the force between its bodies; not-a-number without a force [m/s] */
static PetscReal StartRate(ContactTimes times, const PairTimes *pair, const PetscReal force[3])
{
  PetscReal rate = 0, squares = 0;

  for (PetscInt d = 0; d < 3; d++) {
    squares += PetscSqr(force[d]);
    for (PetscInt k = 0; k < 2; k++)
      if (pair->side[k] >= 0) rate += (k ? 1 : -1) * times->start_velocity[3 * pair->side[k] + d] * force[d];
  }
  return rate / PetscSqrtReal(squares);
}

/* The gap of the last step goes on closing at the rate that it had until then, or, in the first step, at that of the bodies at the start */
static PetscReal FindOnset(const PairTimes *pair, PetscReal end, PetscReal start_rate)
{
  const Record *last = pair->last;
  PetscReal     rate = start_rate;

  if (!pair->n) return end;
  if (last[0].gap <= 0) return last[0].time;
  if (last[0].gap >= NO_GAP) return end;
  if (pair->n > 1) rate = last[1].gap < NO_GAP && !last[1].touches ? (last[0].gap - last[1].gap) / (last[0].time - last[1].time) : NAN;
  return rate < 0 ? PetscMin(end, last[0].time - last[0].gap / rate) : end;
}

/* The force goes on falling at the rate that it had until then: for want of the gap's rate after release */
static PetscReal SeparationByForce(const PairTimes *pair, PetscReal end)
{
  const Record   *last = pair->last;
  const PetscReal rate = pair->n > 1 ? (last[0].force - last[1].force) / (last[0].time - last[1].time) : 0;

  return rate < 0 ? PetscClipInterval(last[0].time - last[0].force / rate, last[0].time, end) : end;
}

/* The gap has been opening since release at the rate that it has in the step after */
static PetscReal SeparationByGap(const PairTimes *pair, const Record *now)
{
  const Record   *last = pair->last;
  const PetscReal rate = (now->gap - last[0].gap) / (now->time - last[0].time);

  if (!(rate > 0) || now->gap >= NO_GAP) return pair->results.separation;
  return PetscClipInterval(last[0].time - last[0].gap / rate, PetscMax(last[1].time, pair->results.onset), last[0].time);
}

/* ContactTimesAdd - takes note of the start (step 0) or the end of a controller step */
PetscErrorCode ContactTimesAdd(ContactTimes times, const ControllerFrame *frame)
{
  PetscFunctionBegin;
  if (frame->step == 0) PetscCall(PetscArraycpy(times->start_velocity, frame->contact_velocities, 3 * times->n_bodies));
  for (PetscInt p = 0; p < times->n_pairs; p++) {
    const ContactPairState *state   = &frame->pairs[p];
    PairTimes              *pair    = &times->pairs[p];
    ContactTimesResults    *results = &pair->results;
    Record                  now     = {.time = frame->time, .gap = state->gap, .force = state->force, .impulse = state->normal_impulse};

    now.touches = (PetscBool)(frame->step > 0 && state->active > 0);
    now.inside  = (PetscBool)(pair->n && !now.touches && !pair->last[0].touches && now.impulse > pair->last[0].impulse);
    if ((now.touches || now.inside) && PetscIsNanReal(results->onset))
      results->onset = FindOnset(pair, now.time, StartRate(times, pair, state->force_vector));
    if (now.touches) results->separation = NAN;
    else if (now.inside) results->separation = now.time;
    else if (pair->n && pair->last[0].touches) results->separation = SeparationByForce(pair, now.time);
    else if (pair->n > 1 && (pair->last[1].touches || pair->last[0].inside)) results->separation = SeparationByGap(pair, &now);
    results->in_contact_at_end = now.touches;
    pair->last[1]              = pair->last[0];
    pair->last[0]              = now;
    pair->n                    = PetscMin(2, pair->n + 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactTimesGetResults - the times of a pair, or, of pair -1, of all together, which touch first and part last when one of them does */
PetscErrorCode ContactTimesGetResults(ContactTimes times, PetscInt pair, ContactTimesResults *results)
{
  PetscFunctionBegin;
  *results = (ContactTimesResults){.onset = NAN, .separation = NAN};
  for (PetscInt p = pair < 0 ? 0 : pair; p < (pair < 0 ? times->n_pairs : pair + 1); p++) {
    const ContactTimesResults *one = &times->pairs[p].results;

    results->onset             = fmin(results->onset, one->onset); /* the other one if one of them is not-a-number */
    results->separation        = fmax(results->separation, one->separation);
    results->in_contact_at_end = (PetscBool)(results->in_contact_at_end || one->in_contact_at_end);
  }
  if (results->in_contact_at_end) results->separation = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactTimesVisit - the times so far, to or from a checkpoint */
PetscErrorCode ContactTimesVisit(ContactTimes times, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointVisitBytes(checkpoint, "contact times", (size_t)times->n_pairs * sizeof(*times->pairs), times->pairs));
  PetscCall(CheckpointVisitReals(checkpoint, "start velocity", 3 * times->n_bodies, times->start_velocity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactTimesDestroy(ContactTimes *times)
{
  PetscFunctionBegin;
  if (!*times) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree2((*times)->pairs, (*times)->start_velocity));
  PetscCall(PetscFree(*times));
  PetscFunctionReturn(PETSC_SUCCESS);
}
