/*
   Impact of two linear elastic bars of any lengths, materials and cross-sections by the method of characteristics.

   In a bar of wave speed c = sqrt(E / rho) and impedance Z = sqrt(E rho) A, velocity and compressive force are v = o + i and
   f = +-Z (o - i), where o runs from the contact face inwards and i towards it, both with speed c and unchanged on their way.
   The other end is free and sends back what comes: at the contact face i(t) = o(t - 2 L/c), half of the initial velocity at first.

   A contact force f >= 0 makes o = i -+ f / Z, minus on the Dirichlet side, whose contact normal points to the partner. While the
   gap is closed, equal velocities of both faces ask for f = 2 (i_0 - i_1) / (1/Z_0 + 1/Z_1); where that is a pull, the force is
   zero, and the gap opens at the rate 2 (i_1 - i_0). So everything at the contact faces is constant from event to event: what went
   out in an earlier event comes back from a free end, or an open gap closes.
*/
#include "exactimpl.h"
#include <math.h>

#define ROUND_OFF  1e-12 /* relative to the duration, the velocities, or the length: what counts as the same */
#define MAX_EVENTS 20000

/* What is true from one event to the next */
typedef struct {
  PetscReal time;                       /* of the event [s] */
  PetscReal out[2], velocity[2], force; /* of each side's wave from the contact face, of the face [m/s]; N */
  PetscReal position[2];                /* of the contact faces at the event [m] */
} Event;

typedef struct {
  PetscReal impedance[2]; /* kg/s */
  PetscReal period[2];    /* 2 L/c [s] */
  PetscReal before[2];    /* what went out before the run [m/s] */
  PetscReal end;          /* of the run [s] */
  PetscReal time_scale, velocity_scale, length_scale;
  PetscInt  n, capacity;
  Event    *events; /* the first at the start of the run */
} Characteristics;

/* What makes the events, as it is after the last of them */
typedef struct {
  PetscReal in[2];   /* m/s */
  PetscInt  next[2]; /* event that each side's free end sends back next */
  PetscReal gap;     /* m */
  PetscBool closed;
} State;

/* Adds an event with what follows from the waves that come in: contact force, waves that go out, whether the gap opens */
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
    /* a jump of round-off is none: it would come back as an event, and so for ever */
    if (PetscAbsReal(event->out[side] - before) <= small) event->out[side] = before;
    event->velocity[side] = state->in[side] + event->out[side];
    event->position[side] = position[side];
  }
  c->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The next jump that a free end sends back, infinite where there is none yet */
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
               "-exact characteristics: waves arrive at the contact more than %d times until %g s, and the run goes on to %g s; choose an "
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

/* The last event before a time, by more than round-off; -1 where there is none */
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

/*
   Integrals over a bar of o + i, (o + i)^2 and (o - i)^2, with the time s = x/c that a wave takes from the contact face to x for
   measure. At x, o is what went out s before, and i what went out 2 L/c - s before.
*/
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

static PetscErrorCode ExactEvaluate_Characteristics(Exact exact, PetscInt side, PetscReal time, ExactSolution *solution)
{
  const Characteristics *c     = (const Characteristics *)exact->data;
  const PetscReal        small = ROUND_OFF * c->time_scale;
  const Event           *event = &c->events[PetscMax(0, FindEvent(c, time - small))];
  PetscReal              integrals[3];

  PetscFunctionBegin;
  PetscCheck(time >= exact->start - small && time <= c->end + small, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "The solution is known from %g to %g s, not at %g s", (double)exact->start, (double)c->end, (double)time);
  Integrate(c, side, time, integrals);
  solution->contact_position = event->position[side] + event->velocity[side] * (time - event->time);
  solution->contact_velocity = event->velocity[side];
  solution->contact_force    = event->force;
  solution->mean_velocity    = 2 / c->period[side] * integrals[0];
  /* rho A / 2 v^2 dx = Z / 2 v^2 ds, and sigma^2 A / (2 E) dx the same with f / Z for v */
  solution->kinetic   = 0.5 * c->impedance[side] * integrals[1];
  solution->potential = 0.5 * c->impedance[side] * integrals[2];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Impulse between two times, not later than the end of the run */
static PetscReal Impulse(const Characteristics *c, PetscReal begin, PetscReal end)
{
  PetscReal sum = 0;

  for (PetscInt k = 0; k < c->n; k++) {
    const PetscReal next = k + 1 < c->n ? c->events[k + 1].time : c->end;

    sum += c->events[k].force * PetscMax(0, PetscMin(end, next) - PetscMax(begin, c->events[k].time));
  }
  return sum;
}

/* Times of contact, mean force and impulse; what the run does not reach is not a number */
static void SummariseContact(Exact exact, const Characteristics *c)
{
  PetscReal duration;

  exact->release = NAN;
  for (PetscInt k = 1; k < c->n; k++)
    if (c->events[k].force == 0 && c->events[k - 1].force > 0) exact->release = c->events[k].time;
  if (c->events[c->n - 1].force > 0) exact->release = NAN;
  duration       = exact->release - exact->impact;
  exact->force   = Impulse(c, exact->impact + 0.2 * duration, exact->release - 0.2 * duration) / (0.6 * duration);
  exact->impulse = PetscIsNanReal(exact->release) ? NAN : Impulse(c, exact->start, c->end);
}

static PetscErrorCode TryPeak(Exact exact, PetscReal time)
{
  ExactSolution solution;

  PetscFunctionBegin;
  if (time > ((const Characteristics *)exact->data)->end) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ExactEvaluate_Characteristics(exact, 0, time, &solution));
  if (solution.potential > exact->peak) {
    exact->peak = solution.potential;
    exact->turn = time;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The potential energy is linear between the times at which jumps enter or leave the bar, or meet in it: one that went out at t
   meets one that went out at t' <= t and has been reflected at L/c + (t + t') / 2 */
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

static PetscErrorCode ExactDestroy_Characteristics(Exact exact)
{
  Characteristics *c = (Characteristics *)exact->data;

  PetscFunctionBegin;
  PetscCall(PetscFree(c->events));
  PetscCall(PetscFree(exact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For any bars; refuses a run in which waves arrive too often */
PetscErrorCode ExactCreate_Characteristics(Controller controller, Exact exact)
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
  c->end               = exact->start + steps * step;
  c->time_scale        = PetscMax(PetscAbsReal(exact->start), c->end - exact->start);
  c->velocity_scale    = bars[0].velocity - bars[1].velocity;
  c->length_scale      = length + PetscMax(PetscAbsReal(bars[0].upper), PetscAbsReal(bars[1].lower));
  exact->data          = c;
  exact->ops->evaluate = ExactEvaluate_Characteristics;
  exact->ops->destroy  = ExactDestroy_Characteristics;
  PetscCall(FindEvents(comm, c, bars, exact->start));
  SummariseContact(exact, c);
  PetscCall(FindPeak(exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
