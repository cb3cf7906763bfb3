/* The figures of contact, of each pair and of all together, step by step. Contact forces are kept as series, from the first contact on. */
#include "statisticsimpl.h"
#include <math.h>

/* Mean, scatter and minimum of a force are those of the time from first contact to release without this part at either end, where the force
   rises and falls. Steps at the ends of what remains belong to it, within round-off of the time. */
#define FORCE_MARGIN   0.2
#define TIME_ROUND_OFF 1e-9

static void Initialize(ContactStatistics *contact)
{
  contact->first_contact_time = NAN;
  contact->release_time       = NAN;
  contact->force_mean         = NAN;
  contact->force_std          = NAN;
  contact->force_min          = NAN;
  contact->resultant_mean     = NAN;
  contact->gap_final          = NAN;
  contact->gap_min            = PETSC_INFINITY;
}

/* Of what there is without contact: not-a-number */
void StatisticsInitializeContact(Statistics s)
{
  Initialize(&s->results.contact);
  for (PetscInt i = 0; i < s->results.n_pairs; i++) Initialize(&s->results.pairs[i]);
}

/* Adds a step of one pair, or of all pairs together */
static void AddContact(ContactStatistics *contact, ContactMemory *memory, const ContactPairState *state, PetscReal time)
{
  const PetscBool touches = state->active > 0 ? PETSC_TRUE : PETSC_FALSE;
  /* contact that begins and ends inside a step made in parts leaves its impulse alone */
  const PetscBool inside = (PetscBool)(!touches && !memory->touches && state->normal_impulse > memory->impulse);

  if (touches || inside) {
    if (!contact->steps_in_contact++) contact->first_contact_time = time;
    if (!memory->touches) contact->onsets++;
    contact->release_time = time;
  }
  /* the forces at both ends of a step do not tell what those inside have done, where it is cut or bodies have times in common there */
  contact->impulse += state->normal_impulse - memory->impulse;
  memory->impulse = state->normal_impulse;
  memory->steps   = touches ? memory->steps + 1 : 0;
  if (state->force > contact->force_peak) contact->peak_step = memory->steps;
  contact->force_peak     = PetscMax(contact->force_peak, state->force);
  contact->force_final    = state->force;
  contact->resultant_peak = PetscMax(contact->resultant_peak, StatisticsNorm(state->force_vector));
  contact->tension_max    = PetscMax(contact->tension_max, state->tension);
  contact->gap_min        = PetscMin(contact->gap_min, state->gap);
  contact->area_max       = PetscMax(contact->area_max, state->area);
  contact->active_max     = PetscMax(contact->active_max, state->active);
  contact->sliding_max    = PetscMax(contact->sliding_max, state->sliding);
  contact->friction_loss  = state->friction_loss;
  contact->obstacle_work  = state->obstacle_work;
  for (PetscInt d = 0; d < 3; d++) {
    contact->resultant[d]      = state->force_vector[d];
    contact->impulse_vector[d] = state->impulse[d];
  }
  contact->gap_final = state->gap;
  memory->touches    = touches;
}

/* Appends time, forces, resultants and nodes in contact of a step to the series */
static PetscErrorCode AddToSeries(Statistics s, const ControllerFrame *frame)
{
  const PetscInt width = 1 + STATISTICS_SERIES * frame->n_pairs;
  PetscReal     *next;

  PetscFunctionBegin;
  if (s->n_series == s->capacity) {
    s->capacity *= 2;
    PetscCall(PetscRealloc((size_t)s->capacity * (size_t)width * sizeof(PetscReal), &s->series));
  }
  next    = s->series + (size_t)s->n_series++ * (size_t)width;
  *next++ = frame->time;
  for (PetscInt i = 0; i < frame->n_pairs; i++) {
    *next++ = frame->pairs[i].force;
    *next++ = StatisticsNorm(frame->pairs[i].force_vector);
    *next++ = (PetscReal)frame->pairs[i].active;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the contact of a controller step, and the sweeps that were made for it */
PetscErrorCode StatisticsAddContact(Statistics s, const ControllerFrame *frame)
{
  StatisticsResults *r   = &s->results;
  ContactPairState   any = {.gap = PETSC_INFINITY};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < frame->n_pairs; i++) {
    AddContact(&r->pairs[i], &s->pair[i], &frame->pairs[i], frame->time);
    any.normal_impulse += frame->pairs[i].normal_impulse;
    any.force += frame->pairs[i].force;
    any.gap = PetscMin(any.gap, frame->pairs[i].gap);
    any.active += frame->pairs[i].active;
    any.area += frame->pairs[i].area;
    any.sliding += frame->pairs[i].sliding;
    any.friction_loss += frame->pairs[i].friction_loss;
    any.obstacle_work += frame->pairs[i].obstacle_work;
    any.tension = PetscMax(any.tension, frame->pairs[i].tension);
  }
  AddContact(&r->contact, &s->any, &any, frame->time);
  r->steps++;
  r->max_sweeps = PetscMax(r->max_sweeps, frame->sweeps);
  s->total_sweeps += frame->sweeps;
  if (any.active) s->contact_sweeps += frame->sweeps;
  if (r->contact.steps_in_contact) PetscCall(AddToSeries(s, frame));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mean, standard deviation and minimum of a pair's force, and the mean of its resultant, over the middle 3/5 of contact */
void StatisticsComputeForces(Statistics s, PetscInt pair)
{
  ContactStatistics *contact  = &s->results.pairs[pair];
  const size_t       width    = 1 + STATISTICS_SERIES * (size_t)s->results.n_pairs;
  const PetscReal    duration = contact->release_time - contact->first_contact_time;
  const PetscReal    begin    = contact->first_contact_time + FORCE_MARGIN * duration - TIME_ROUND_OFF * duration;
  const PetscReal    end      = contact->first_contact_time + (1 - FORCE_MARGIN) * duration + TIME_ROUND_OFF * duration;
  PetscInt           n        = 0;
  PetscReal          mean = 0, squares = 0, resultant = 0, minimum = NAN;

  for (PetscInt i = 0; i < s->n_series; i++) {
    const PetscReal *record = s->series + (size_t)i * width, *of_pair = record + 1 + STATISTICS_SERIES * pair;
    const PetscReal  force = of_pair[0], change = force - mean;

    if (!(record[0] >= begin && record[0] <= end)) continue;
    n++;
    mean += change / (PetscReal)n; /* Welford's recurrence, which does not cancel if the scatter is small */
    squares += change * (force - mean);
    resultant += (of_pair[1] - resultant) / (PetscReal)n;
    if (of_pair[2] > 0 && !(force >= minimum)) minimum = force;
  }
  if (!n) return;
  contact->force_mean     = mean;
  contact->force_std      = PetscSqrtReal(squares / (PetscReal)n);
  contact->force_min      = minimum;
  contact->resultant_mean = resultant;
}
