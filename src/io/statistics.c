/* Gathers the figures of the summary, step by step. */
#include "statisticsimpl.h"
#include <math.h>
#include "linearlimits.h"
#include <impakt/private/bodymeasures.h>
#include <impakt/private/contactsteps.h>

/* An energy of a body at the start that is smaller than this part of what the run comes to is round-off: errors are not compared with it.
   Neither is less of the kinetic energy than this part, where all bodies move alike. */
#define ROUND_OFF 1e-9
/* Room for series of forces at first */
#define SERIES_BYTES (1 << 16)
/* Controller steps from look to look at overlaps where no fields are written. A look takes less than a step. */
#define OVERLAP_STEPS 100

/* Radius of gyration of the box about a body's mesh, about its centre [m] */
static PetscErrorCode GetGyration(Body body, PetscReal *radius)
{
  PetscReal lower[3], upper[3], squares = 0;
  PetscInt  dim;
  DM        dm;

  PetscFunctionBegin;
  PetscCall(BodyGetDM(body, &dm));
  PetscCall(BodyGetDimension(body, &dim));
  PetscCall(DMGetBoundingBox(dm, lower, upper));
  for (PetscInt d = 0; d < dim; d++) squares += PetscSqr(upper[d] - lower[d]);
  *radius = PetscSqrtReal(squares / 12);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StatisticsCreate(Controller controller, Statistics *statistics)
{
  const Body              *bodies;
  Contact                  contact;
  Statistics               s;
  const ControllerSupport *supports;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  PetscCall(ControllerGetBodies(controller, &s->results.n_bodies, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ContactGetNumPairs(contact, &s->results.n_pairs));
  s->contact = contact;
  PetscCall(PetscMalloc1(s->results.n_bodies, &s->overlaps));
  s->frames = OVERLAP_STEPS;
  PetscCall(ContactTimesCreate(controller, &s->times));
  PetscCall(PetscCalloc2(s->results.n_pairs, &s->results.pairs, s->results.n_bodies, &s->results.bodies));
  PetscCall(ControllerGetSupports(controller, &s->results.n_supports, &supports));
  PetscCall(PetscCalloc1(s->results.n_supports, &s->results.supports));
  for (PetscInt i = 0; i < s->results.n_supports; i++) {
    s->results.supports[i].body = supports[i].body;
    s->results.supports[i].name = supports[i].name;
  }
  PetscCall(PetscCalloc5(s->results.n_pairs, &s->pair, s->results.n_bodies, &s->initial_energy, 2 * s->results.n_bodies, &s->body_change,
                         s->results.n_bodies, &s->mass, s->results.n_bodies, &s->gyration));
  for (PetscInt i = 0; i < s->results.n_bodies; i++) {
    s->results.bodies[i].displacement_error = NAN;
    s->results.bodies[i].overlap.other      = -1;
    PetscCall(BodyHasHistory(bodies[i], &s->results.bodies[i].plastic));
    PetscCall(BodyGetMass(bodies[i], &s->mass[i]));
    PetscCall(GetGyration(bodies[i], &s->gyration[i]));
  }
  StatisticsInitializeContact(s);
  s->capacity = PetscMax(16, SERIES_BYTES / (PetscInt)sizeof(PetscReal) / (1 + STATISTICS_SERIES * s->results.n_pairs));
  PetscCall(PetscMalloc1(s->capacity * (1 + STATISTICS_SERIES * s->results.n_pairs), &s->series));
  *statistics = s;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Momentum of a body below this part of (2 m T)^(1/2), which it cannot exceed, is round-off of its parts, as where it only spins */
#define NO_MOMENTUM 1e-9

/* Adds a x b times a factor to c */
static void AddProduct(PetscReal factor, const PetscReal a[3], const PetscReal b[3], PetscReal c[3])
{
  for (PetscInt d = 0; d < 3; d++) c[d] += factor * (a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3]);
}

/* Momentum of all bodies, their angular momentum about the centre of mass of all (the origin does not matter), and its velocity */
static void FindMomenta(Statistics s, const ControllerFrame *frame, PetscReal momentum[3], PetscReal angular[3], PetscReal velocity[3])
{
  PetscReal centre[3] = {0}, mass = 0;

  for (PetscInt d = 0; d < 3; d++) momentum[d] = angular[d] = 0;
  for (PetscInt i = 0; i < frame->n_bodies; i++) {
    mass += s->mass[i];
    for (PetscInt d = 0; d < 3; d++) {
      centre[d] += s->mass[i] * frame->bodies[i].place[d];
      momentum[d] += frame->bodies[i].momentum[d];
      angular[d] += frame->bodies[i].angular_momentum[d];
    }
  }
  for (PetscInt d = 0; d < 3; d++) {
    centre[d] /= mass;
    velocity[d] = momentum[d] / mass;
  }
  AddProduct(-1, centre, momentum, angular);
}

/* The largest angular momentum of any body about the centre of any, without the common motion of all bodies. It is that of the body's
   kinetic energy if all of it were spin, at least, with which bodies that meet head-on are compared. */
static PetscReal FindAngularScale(Statistics s, const ControllerFrame *frame, const PetscReal velocity[3])
{
  PetscReal largest = 0;

  for (PetscInt i = 0; i < frame->n_bodies; i++) {
    const BodyMeasures *body    = &frame->bodies[i];
    PetscReal           kinetic = body->kinetic_unstaggered;

    for (PetscInt d = 0; d < 3; d++) kinetic += velocity[d] * (0.5 * s->mass[i] * velocity[d] - body->momentum[d]);
    kinetic = PetscMax(kinetic, ROUND_OFF * body->kinetic_unstaggered);
    largest = PetscMax(largest, s->gyration[i] * PetscSqrtReal(2 * s->mass[i] * kinetic));
    for (PetscInt j = 0; j < frame->n_bodies; j++) {
      PetscReal arm[3], angular[3] = {body->angular_momentum[0], body->angular_momentum[1], body->angular_momentum[2]};

      for (PetscInt d = 0; d < 3; d++) arm[d] = body->place[d] - frame->bodies[j].place[d];
      AddProduct(-1, frame->bodies[j].place, body->momentum, angular);
      AddProduct(-s->mass[i], arm, velocity, angular);
      largest = PetscMax(largest, StatisticsNorm(angular));
    }
  }
  return largest;
}

/* Notes the initial energies and momenta, which later ones are compared with */
static void NoteInitialState(Statistics s, const ControllerFrame *frame)
{
  PetscReal velocity[3];

  for (PetscInt i = 0; i < frame->n_bodies; i++) {
    const PetscReal momentum = StatisticsNorm(frame->bodies[i].momentum), most = PetscSqrtReal(2 * s->mass[i] * frame->bodies[i].kinetic);

    s->initial_energy[i] = BodyMeasuresGetBalance(&frame->bodies[i]);
    s->momentum_scale += momentum > NO_MOMENTUM * most ? momentum : most;
    s->loaded = (PetscBool)(s->loaded || frame->bodies[i].loaded);
  }
  FindMomenta(s, frame, s->momentum, s->angular, velocity);
  if (!s->loaded) s->angular_scale = FindAngularScale(s, frame, velocity);
}

static PetscReal Relative(PetscReal value, PetscReal scale)
{
  return scale != 0 ? value / PetscAbsReal(scale) : value;
}

static void NoteChange(PetscReal change[2], PetscReal energy)
{
  change[0] = PetscMin(change[0], energy);
  change[1] = PetscMax(change[1], energy);
}

static void AddEnergies(Statistics s, const ControllerFrame *frame)
{
  StatisticsResults *r     = &s->results;
  const PetscReal    scale = frame->energy_scale;
  PetscReal          momentum[3], angular[3], velocity[3];

  for (PetscInt i = 0; i < frame->n_bodies; i++) {
    const BodyMeasures *measures = &frame->bodies[i];
    BodyStatistics     *body     = &r->bodies[i];
    const PetscReal     change   = BodyMeasuresGetBalance(measures) - s->initial_energy[i];
    const PetscReal     own      = s->initial_energy[i] > ROUND_OFF * scale ? s->initial_energy[i] : scale;

    body->kinetic              = measures->kinetic;
    body->potential            = measures->potential;
    body->external_work        = measures->external_work;
    body->damping_work         = measures->damping_work;
    body->plastic_work         = measures->plastic_work;
    body->hourglass_energy     = measures->hourglass_energy;
    body->hourglass_energy_max = PetscMax(body->hourglass_energy_max, measures->hourglass_energy);
    body->peak_potential       = PetscMax(body->peak_potential, measures->potential);
    NoteChange(s->body_change + 2 * i, change);
    body->energy_error_min = Relative(s->body_change[2 * i], own);
    body->energy_error_max = Relative(s->body_change[2 * i + 1], own);
  }
  NoteChange(s->system_change, frame->energy_change);
  r->energy_scale       = scale;
  r->energy_error_final = Relative(frame->energy_change, scale);
  r->energy_error_min   = Relative(s->system_change[0], scale);
  r->energy_error_max   = Relative(s->system_change[1], scale);
  FindMomenta(s, frame, momentum, angular, velocity);
  for (PetscInt d = 0; d < 3; d++) {
    momentum[d] -= s->momentum[d];
    angular[d] -= s->angular[d];
  }
  /* with loads momenta change, and there is nothing to compare them with */
  r->momentum_scale             = s->momentum_scale;
  r->momentum_error_max         = s->loaded ? NAN : PetscMax(r->momentum_error_max, Relative(StatisticsNorm(momentum), s->momentum_scale));
  r->angular_momentum_error_max = s->loaded ? NAN
                                            : PetscMax(r->angular_momentum_error_max, Relative(StatisticsNorm(angular), s->angular_scale));
  r->penalty_energy_max         = PetscMax(r->penalty_energy_max, frame->penalty_energy);
  r->uncounted_energy_max       = PetscMax(r->uncounted_energy_max, frame->uncounted_energy);
}

static void AddSupports(Statistics s, const ControllerFrame *frame)
{
  for (PetscInt i = 0; i < frame->n_supports; i++) {
    SupportStatistics *support = &s->results.supports[i];

    for (PetscInt d = 0; d < 3; d++) {
      support->force[d]  = frame->supports[i].force[d];
      support->moment[d] = frame->supports[i].moment[d];
    }
    support->force_peak = PetscMax(support->force_peak, StatisticsNorm(support->force));
  }
}

/* StatisticsSetFrames - overlaps are looked for every so many controller steps, as fields are written, and at the end; Not Collective */
PetscErrorCode StatisticsSetFrames(Statistics statistics, PetscInt interval)
{
  PetscFunctionBegin;
  statistics->frames = interval;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* StatisticsAddOverlaps - takes note of how deep bodies are inside each other now, unless that has been done; Collective */
PetscErrorCode StatisticsAddOverlaps(Statistics s)
{
  PetscFunctionBegin;
  if (s->looked) PetscFunctionReturn(PETSC_SUCCESS);
  s->looked = PETSC_TRUE;
  PetscCall(ContactGetOverlaps(s->contact, s->overlaps));
  for (PetscInt i = 0; i < s->results.n_bodies; i++) {
    BodyStatistics *body = &s->results.bodies[i];

    if (s->overlaps[i].part <= body->overlap.part) continue;
    body->overlap      = s->overlaps[i];
    body->overlap_time = s->time;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StatisticsMonitor(Controller controller, const ControllerFrame *frame, void *context)
{
  Statistics s = (Statistics)context;

  PetscFunctionBegin;
  if (frame->step == 0) NoteInitialState(s, frame);
  AddEnergies(s, frame);
  AddSupports(s, frame);
  PetscCall(ContactTimesAdd(s->times, frame));
  PetscCall(LinearLimitsCheck(controller, frame, s->results.bodies));
  if (frame->step > 0) PetscCall(StatisticsAddContact(s, frame));
  s->time   = frame->time;
  s->looked = PETSC_FALSE;
  if (frame->step % s->frames == 0) PetscCall(StatisticsAddOverlaps(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes note of the relative L2 errors of the bodies' displacements now, absolute [m] where the exact one is zero. `exact`: three
   components for each body, NULL if none is given. Collective */
PetscErrorCode StatisticsSetDeviation(Statistics statistics, const Body bodies[], const Expression exact[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < statistics->results.n_bodies; i++) {
    PetscReal difference, norm;

    if (!exact[3 * i]) continue;
    PetscCall(BodyComputeDeviation(bodies[i], exact + 3 * i, &difference, &norm));
    statistics->results.bodies[i].displacement_error = norm > 0 ? difference / norm : difference;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The figures of all steps so far. `results`: owned by the statistics */
PetscErrorCode StatisticsGetResults(Statistics statistics, const StatisticsResults **results)
{
  StatisticsResults *r = &statistics->results;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < r->n_pairs; i++) {
    StatisticsComputeForces(statistics, i);
    PetscCall(ContactTimesGetResults(statistics->times, i, &r->pairs[i].times));
  }
  PetscCall(ContactTimesGetResults(statistics->times, -1, &r->contact.times));
  if (r->n_pairs) {
    r->contact.force_mean     = r->pairs[0].force_mean;
    r->contact.force_std      = r->pairs[0].force_std;
    r->contact.force_min      = r->pairs[0].force_min;
    r->contact.force_peak     = r->pairs[0].force_peak;
    r->contact.force_final    = r->pairs[0].force_final;
    r->contact.resultant_mean = r->pairs[0].resultant_mean;
    r->contact.resultant_peak = r->pairs[0].resultant_peak;
  }
  r->mean_sweeps         = r->steps ? (PetscReal)statistics->total_sweeps / (PetscReal)r->steps : 0;
  r->mean_sweeps_contact = r->contact.steps_in_contact ? (PetscReal)statistics->contact_sweeps / (PetscReal)r->contact.steps_in_contact : 0;
  *results               = r;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All that is gathered, as it lies in the structs: pointers stay those of this run */
static PetscErrorCode VisitResults(StatisticsResults *results, Checkpoint checkpoint)
{
  StatisticsResults copy = *results;

  PetscFunctionBegin;
  copy.pairs    = NULL;
  copy.bodies   = NULL;
  copy.supports = NULL;
  PetscCall(CheckpointVisitBytes(checkpoint, "results", sizeof(copy), &copy));
  copy.pairs    = results->pairs;
  copy.bodies   = results->bodies;
  copy.supports = results->supports;
  *results      = copy;
  for (PetscInt i = 0; i < results->n_supports; i++) {
    SupportStatistics *support = &results->supports[i];

    PetscCall(CheckpointVisitReals(checkpoint, "reaction", 3, support->force));
    PetscCall(CheckpointVisitReals(checkpoint, "reaction moment", 3, support->moment));
    PetscCall(CheckpointVisitReals(checkpoint, "reaction peak", 1, &support->force_peak));
  }
  PetscCall(CheckpointVisitBytes(checkpoint, "pairs", (size_t)results->n_pairs * sizeof(*results->pairs), results->pairs));
  PetscCall(CheckpointVisitBytes(checkpoint, "bodies", (size_t)results->n_bodies * sizeof(*results->bodies), results->bodies));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* StatisticsVisit - the figures so far, to or from a checkpoint; Collective */
PetscErrorCode StatisticsVisit(Statistics s, Checkpoint checkpoint)
{
  const PetscInt sizes[] = {s->results.n_pairs, s->results.n_bodies, s->results.n_supports};
  const PetscInt width   = 1 + STATISTICS_SERIES * s->results.n_pairs;
  PetscReal     *reals[] = {&s->momentum_scale, &s->angular_scale};

  PetscFunctionBegin;
  PetscCall(CheckpointBegin(checkpoint, "summary"));
  PetscCall(CheckpointCheckInts(checkpoint, "pairs, bodies and supports", PETSC_STATIC_ARRAY_LENGTH(sizes), sizes));
  PetscCall(VisitResults(&s->results, checkpoint));
  PetscCall(CheckpointVisitBytes(checkpoint, "any", sizeof(s->any), &s->any));
  PetscCall(CheckpointVisitBytes(checkpoint, "memory", (size_t)sizes[0] * sizeof(*s->pair), s->pair));
  PetscCall(ContactTimesVisit(s->times, checkpoint));
  PetscCall(CheckpointVisitInts(checkpoint, "sweeps", 1, &s->total_sweeps));
  PetscCall(CheckpointVisitInts(checkpoint, "contact sweeps", 1, &s->contact_sweeps));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(reals); i++) PetscCall(CheckpointVisitReals(checkpoint, "figure", 1, reals[i]));
  PetscCall(CheckpointVisitReals(checkpoint, "initial energy", sizes[1], s->initial_energy));
  PetscCall(CheckpointVisitReals(checkpoint, "body change", 2 * sizes[1], s->body_change));
  PetscCall(CheckpointVisitReals(checkpoint, "system change", 2, s->system_change));
  PetscCall(CheckpointVisitReals(checkpoint, "momentum", 3, s->momentum));
  PetscCall(CheckpointVisitReals(checkpoint, "angular", 3, s->angular));
  PetscCall(CheckpointVisitBools(checkpoint, "loaded", 1, &s->loaded));
  PetscCall(CheckpointVisitInts(checkpoint, "series", 1, &s->n_series));
  while (s->capacity < s->n_series) s->capacity *= 2;
  PetscCall(PetscRealloc((size_t)s->capacity * (size_t)width * sizeof(PetscReal), &s->series));
  PetscCall(CheckpointVisitBytes(checkpoint, "forces", (size_t)s->n_series * (size_t)width * sizeof(PetscReal), s->series));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StatisticsDestroy(Statistics *statistics)
{
  PetscFunctionBegin;
  if (!*statistics) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactTimesDestroy(&(*statistics)->times));
  PetscCall(PetscFree((*statistics)->overlaps));
  PetscCall(PetscFree((*statistics)->results.supports));
  PetscCall(PetscFree2((*statistics)->results.pairs, (*statistics)->results.bodies));
  PetscCall(PetscFree5((*statistics)->pair, (*statistics)->initial_energy, (*statistics)->body_change, (*statistics)->mass,
                       (*statistics)->gyration));
  PetscCall(PetscFree((*statistics)->series));
  PetscCall(PetscFree(*statistics));
  PetscFunctionReturn(PETSC_SUCCESS);
}
