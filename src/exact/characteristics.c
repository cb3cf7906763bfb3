/* Impact of two linear elastic bars of any lengths, materials and cross-sections by the method of characteristics.

   In a bar of wave speed c = sqrt(E / rho) and impedance Z = sqrt(E rho) A, velocity and compressive force are v = o + i and
   f = +-Z (o - i). The wave o runs from the contact face inwards, the wave i runs towards the contact face, both with speed c and without
   changing. The other end is free and reflects: at the contact face i(t) = o(t - 2 L/c), which is half of the initial velocity at first.

   A contact force f >= 0 makes o = i -+ f / Z, with a minus on the Dirichlet side, whose contact normal points to the partner. While the
   gap is closed, both faces have the same velocity if f = 2 (i_0 - i_1) / (1/Z_0 + 1/Z_1). If this f is a pull, the force is zero instead,
   and the gap opens at the rate 2 (i_1 - i_0). So velocities and force at the contact faces are constant from one event to the next. An
   event is the return of a wave that went out in an earlier event, or the closing of an open gap. */
#include "exactimpl.h"
#include <math.h>

/* Times, velocities and positions are the same if they differ by less, relative to the duration, the speed of approach, and the length:
   some 10^4 times the round-off of one of them, since round-off adds up over reflections */
#define ROUND_OFF 1e-12
/* The limit of events, and so of memory and time, where bars are short beside the duration of the run */
#define MAX_EVENTS 20000
/* The mean force is that of the time from impact to release without this part at either end, as in the summary of a run */
#define FORCE_MARGIN 0.2

/* What holds from an event to the next one */
typedef struct {
  PetscReal time;        /* of the event [s] */
  PetscReal out[2];      /* o of each side [m/s] */
  PetscReal velocity[2]; /* of each contact face [m/s] */
  PetscReal force;       /* N */
  PetscReal position[2]; /* of each contact face at the event [m] */
} Event;

typedef struct {
  PetscReal impedance[2]; /* kg/s */
  PetscReal period[2];    /* 2 L/c [s] */
  PetscReal before[2];    /* o of each side before the run [m/s] */
  PetscReal end;          /* end of the run [s] */
  PetscReal time_scale, velocity_scale, length_scale;
  PetscInt  n, capacity;
  Event    *events; /* the first at the start of the run */
} Characteristics;

/* The state after the last event, from which the next one follows */
typedef struct {
  PetscReal in[2];   /* i of each side [m/s] */
  PetscInt  next[2]; /* the event whose o the free end of each side reflects next */
  PetscReal gap;     /* m */
  PetscBool closed;
} State;

/* Adds an event: contact force, waves that go out and opening of the gap follow from the waves that come in */
static PetscErrorCode AddEvent(Characteristics *c, State *state, PetscReal time, const PetscReal position[2])
{
  const PetscReal approach = 2 * (state->in[0] - state->in[1]), small = ROUND_OFF * c->velocity_scale;
  Event          *event;

  PetscFunctionBegin;
  if (c->n == c->capacity) {
    c->capacity = 2 * c->capacity + 16;
    PetscCall(PetscRealloc((size_t)c->capacity * sizeof(Event), &c->events));
  }
  event        = &c->events[c->n];
  event->time  = time;
  event->force = state->closed && approach > small ? approach / (1 / c->impedance[0] + 1 / c->impedance[1]) : 0;
  if (approach < -small) state->closed = PETSC_FALSE;
  for (PetscInt side = 0; side < 2; side++) {
    const PetscReal before = c->n ? event[-1].out[side] : c->before[side];

    event->out[side] = state->in[side] + (side ? 1 : -1) * event->force / c->impedance[side];
    /* a jump of round-off is ignored: it would come back as an event, again and again */
    if (PetscAbsReal(event->out[side] - before) <= small) event->out[side] = before;
    event->velocity[side] = state->in[side] + event->out[side];
    event->position[side] = position[side];
  }
  c->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* When the next jump that a free end reflects arrives at the contact face [s]; infinite if there is none */
static PetscReal NextArrival(const Characteristics *c, State *state, PetscInt side)
{
  const Event *events = c->events;
  PetscInt    *k      = &state->next[side];

  while (*k < c->n && events[*k].out[side] == (*k ? events[*k - 1].out[side] : c->before[side])) (*k)++;
  return *k < c->n ? events[*k].time + c->period[side] : PETSC_INFINITY;
}

static PetscErrorCode FindEvents(MPI_Comm comm, Characteristics *c, const ExactBar bars[2], PetscReal start)
{
  const PetscReal small       = ROUND_OFF * c->time_scale;
  PetscReal       position[2] = {bars[0].upper, bars[1].lower}, time = start;
  State           state = {.in = {c->before[0], c->before[1]}, .gap = PetscMax(0, position[1] - position[0])};

  PetscFunctionBegin;
  state.closed = (PetscBool)(state.gap <= ROUND_OFF * c->length_scale);
  PetscCall(AddEvent(c, &state, time, position));
  while (PETSC_TRUE) {
    const Event    *last        = &c->events[c->n - 1];
    const PetscReal rate        = last->velocity[1] - last->velocity[0];
    const PetscReal closing     = !state.closed && rate < -ROUND_OFF * c->velocity_scale ? last->time + state.gap / -rate : PETSC_INFINITY;
    const PetscReal arrivals[2] = {NextArrival(c, &state, 0), NextArrival(c, &state, 1)};

    time = PetscMin(closing, PetscMin(arrivals[0], arrivals[1]));
    if (time > c->end) break;
    PetscCheck(c->n < MAX_EVENTS, comm, PETSC_ERR_USER_INPUT,
               "-exact: waves arrive at the contact more than %d times until %g s, and the run goes on to %g s; choose an "
               "earlier -time_end, or leave -exact out",
               MAX_EVENTS, (double)time, (double)c->end);
    for (PetscInt side = 0; side < 2; side++) {
      position[side] = last->position[side] + last->velocity[side] * (time - last->time);
      if (arrivals[side] <= time + small) state.in[side] = c->events[state.next[side]++].out[side];
    }
    if (!state.closed) {
      state.gap += rate * (time - last->time);
      state.closed = (PetscBool)(closing <= time + small || (rate < 0 && state.gap <= ROUND_OFF * c->length_scale));
      if (state.closed) state.gap = 0;
    }
    PetscCall(AddEvent(c, &state, time, position));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The last event before a time; -1 if there is none */
static PetscInt FindEvent(const Characteristics *c, PetscReal time)
{
  PetscInt before = -1, after = c->n;

  while (after - before > 1) {
    const PetscInt middle = (before + after) / 2;

    if (c->events[middle].time < time) before = middle;
    else after = middle;
  }
  return before;
}

/* Integrals over a bar of o + i, (o + i)^2 and (o - i)^2 with respect to s = x/c, the time that a wave takes from the contact face to x. At
   x, o left the contact face a time s ago, and i a time 2 L/c - s ago. */
static void Integrate(const Characteristics *c, PetscInt side, PetscReal time, PetscReal integrals[3])
{
  const PetscReal period = c->period[side], before = c->before[side];
  PetscInt        o = FindEvent(c, time), i = FindEvent(c, time - period);
  PetscReal       s = 0;

  for (PetscInt k = 0; k < 3; k++) integrals[k] = 0;
  while (s < 0.5 * period) {
    const PetscReal out = o >= 0 ? c->events[o].out[side] : before, in = i >= 0 ? c->events[i].out[side] : before;
    const PetscReal out_until = o >= 0 ? time - c->events[o].time : PETSC_INFINITY;
    const PetscReal in_until  = i + 1 < c->n ? c->events[i + 1].time - (time - period) : PETSC_INFINITY;
    const PetscReal until = PetscMin(0.5 * period, PetscMin(out_until, in_until)), width = PetscMax(0, until - s);

    integrals[0] += width * (out + in);
    integrals[1] += width * PetscSqr(out + in);
    integrals[2] += width * PetscSqr(out - in);
    if (out_until <= until) o--;
    if (in_until <= until) i++;
    s = PetscMax(s, until);
  }
}

/* The exact solution at one time. `side`: 0 for the bar on the Dirichlet side, 1 for its partner; `time`: any time of the run [s]; at a
   jump, or within round-off of one, the value before it is given */
PetscErrorCode ExactEvaluate(Exact exact, PetscInt side, PetscReal time, ExactSolution *solution)
{
  const Characteristics *c     = (const Characteristics *)exact->data;
  const PetscReal        small = ROUND_OFF * c->time_scale;
  const Event           *event = &c->events[PetscMax(0, FindEvent(c, time - small))];
  PetscReal              integrals[3];

  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(solution, 4);
  PetscCheck(time >= exact->start - small && time <= c->end + small, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "The solution is known from %g to %g s, not at %g s", (double)exact->start, (double)c->end, (double)time);
  Integrate(c, side, time, integrals);
  solution->contact_position = event->position[side] + event->velocity[side] * (time - event->time);
  solution->contact_velocity = event->velocity[side];
  solution->contact_force    = event->force;
  solution->mean_velocity    = 2 / c->period[side] * integrals[0];
  /* rho A / 2 v^2 dx = Z / 2 v^2 ds, and sigma^2 A / (2 E) dx = Z / 2 (f / Z)^2 ds */
  solution->kinetic   = 0.5 * c->impedance[side] * integrals[1];
  solution->potential = 0.5 * c->impedance[side] * integrals[2];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Impulse between two times of the run [N s] */
static PetscReal Impulse(const Characteristics *c, PetscReal begin, PetscReal end)
{
  PetscReal sum = 0;

  for (PetscInt k = 0; k < c->n; k++) {
    const PetscReal next = k + 1 < c->n ? c->events[k + 1].time : c->end;

    sum += c->events[k].force * PetscMax(0, PetscMin(end, next) - PetscMax(begin, c->events[k].time));
  }
  return sum;
}

/* Times of contact, mean force and impulse; not-a-number if the run ends before them */
static void SummariseContact(Exact exact, const Characteristics *c)
{
  PetscReal duration;

  exact->release = NAN;
  for (PetscInt k = 1; k < c->n; k++)
    if (c->events[k].force == 0 && c->events[k - 1].force > 0) exact->release = c->events[k].time;
  if (c->events[c->n - 1].force > 0) exact->release = NAN;
  duration       = exact->release - exact->impact;
  exact->force   = Impulse(c, exact->impact + FORCE_MARGIN * duration, exact->release - FORCE_MARGIN * duration) /
                   ((1 - 2 * FORCE_MARGIN) * duration);
  exact->impulse = PetscIsNanReal(exact->release) ? NAN : Impulse(c, exact->start, c->end);
}

/* Notes the potential energy at a time if it is the largest so far */
static PetscErrorCode TryPeak(Exact exact, PetscReal time)
{
  ExactSolution solution;

  PetscFunctionBegin;
  if (time > ((const Characteristics *)exact->data)->end) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ExactEvaluate(exact, 0, time, &solution));
  if (solution.potential > exact->peak) {
    exact->peak = solution.potential;
    exact->turn = time;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the peak of the potential energy, which is linear in time between the times at which jumps enter the bar, leave it, or meet in it.
   A jump that went out at t meets one that went out at t' <= t, and has been reflected, at the time L/c + (t + t') / 2. */
static PetscErrorCode FindPeak(Exact exact)
{
  const Characteristics *c = (const Characteristics *)exact->data;

  PetscFunctionBegin;
  PetscCall(TryPeak(exact, c->end));
  for (PetscInt k = 0; k < c->n; k++) {
    PetscCall(TryPeak(exact, c->events[k].time));
    for (PetscInt j = k; j >= 0 && c->events[k].time - c->events[j].time <= c->period[0]; j--)
      PetscCall(TryPeak(exact, 0.5 * (c->period[0] + c->events[k].time + c->events[j].time)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ExactDestroyCharacteristics(Exact exact)
{
  PetscFunctionBegin;
  if (exact->data) PetscCall(PetscFree(((Characteristics *)exact->data)->events));
  PetscCall(PetscFree(exact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the solution. Ends with an error if waves arrive at the contact too often in the run. */
PetscErrorCode ExactSetUpCharacteristics(Exact exact, Controller controller)
{
  const ExactBar  *bars = exact->bars;
  MPI_Comm         comm = PetscObjectComm((PetscObject)controller);
  Characteristics *c;
  PetscReal        step, length = PetscMax(bars[0].length, bars[1].length);
  PetscInt         steps;

  PetscFunctionBegin;
  PetscCall(ControllerGetTimes(controller, NULL, &step, &steps));
  PetscCall(PetscNew(&c));
  for (PetscInt side = 0; side < 2; side++) {
    c->impedance[side] = PetscSqrtReal(bars[side].modulus * bars[side].density) * bars[side].mass /
                         (bars[side].density * bars[side].length);
    c->period[side]    = 2 * bars[side].length * PetscSqrtReal(bars[side].density / bars[side].modulus);
    c->before[side]    = 0.5 * bars[side].velocity;
  }
  c->end            = exact->start + steps * step;
  c->time_scale     = PetscMax(PetscAbsReal(exact->start), c->end - exact->start);
  c->velocity_scale = bars[0].velocity - bars[1].velocity;
  c->length_scale   = length + PetscMax(PetscAbsReal(bars[0].upper), PetscAbsReal(bars[1].lower));
  exact->data       = c;
  PetscCall(FindEvents(comm, c, bars, exact->start));
  SummariseContact(exact, c);
  PetscCall(FindPeak(exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
