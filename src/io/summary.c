/* The summary: one JSON object, whose members scripts rely on. Numbers that do not exist (no contact, no release) are null. */
#include "summary.h"
#include "outputfile.h"
#include "ranks.h"
#include "summaryimpl.h"
#include <math.h>
#include <sys/units.h>
#include <impakt/private/contactsteps.h>

static PetscErrorCode SetContactStatistics(json_t *object, const ContactStatistics *contact, PetscBool friction)
{
  PetscFunctionBegin;
  PetscCall(SummarySetReal(object, "first_contact_time", contact->first_contact_time));
  PetscCall(SummarySetReal(object, "release_time", contact->release_time));
  PetscCall(SummarySetReal(object, "onset_time", contact->times.onset));
  PetscCall(SummarySetReal(object, "separation_time", contact->times.separation));
  PetscCall(SummarySetMember(object, "in_contact_at_end", json_boolean(contact->times.in_contact_at_end)));
  PetscCall(SummarySetInteger(object, "onsets", contact->onsets));
  PetscCall(SummarySetInteger(object, "steps_in_contact", contact->steps_in_contact));
  PetscCall(SummarySetReal(object, "force_mean", contact->force_mean));
  PetscCall(SummarySetReal(object, "force_std", contact->force_std));
  PetscCall(SummarySetReal(object, "force_min", contact->force_min));
  PetscCall(SummarySetReal(object, "force_peak", contact->force_peak));
  PetscCall(SummarySetReal(object, "force_final", contact->force_final));
  PetscCall(SummarySetReal(object, "resultant_mean", contact->resultant_mean));
  PetscCall(SummarySetReal(object, "resultant_peak", contact->resultant_peak));
  PetscCall(SummarySetReal(object, "tension_max", contact->tension_max));
  PetscCall(SummarySetReal(object, "impulse", contact->impulse));
  PetscCall(SummarySetReal(object, "max_penetration", PetscMax(0, -contact->gap_min)));
  PetscCall(SummarySetReal(object, "area_max", contact->area_max));
  PetscCall(SummarySetInteger(object, "active_max", contact->active_max));
  PetscCall(SummarySetReal(object, "gap_min", contact->gap_min));
  PetscCall(SummarySetReal(object, "gap_final", contact->gap_final));
  if (!friction) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SummarySetReal(object, "friction_loss", contact->friction_loss));
  PetscCall(SummarySetReal(object, "obstacle_work", contact->obstacle_work));
  PetscCall(SummarySetInteger(object, "sliding_max", contact->sliding_max));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddOverlap(json_t *root, Controller controller, Contact contact, const StatisticsResults *results)
{
  json_t               *object, *names = json_array();
  const Body           *bodies;
  const BodyStatistics *body    = results->bodies;
  const ContactOverlap *overlap = &body->overlap;
  const char           *name[2];

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, NULL, &bodies));
  for (PetscInt b = 1; b < results->n_bodies; b++)
    if (results->bodies[b].overlap.part > overlap->part) {
      body    = &results->bodies[b];
      overlap = &body->overlap;
    }
  PetscCall(PetscObjectGetName((PetscObject)bodies[body - results->bodies], &name[0]));
  PetscCall(ContactGetOverlapName(contact, overlap, &name[1]));
  PetscCall(SummarySetObject(root, "overlap", &object));
  for (PetscInt k = 0; k < 2 && name[1]; k++)
    PetscCheck(!json_array_append_new(names, json_string(name[k])), PETSC_COMM_SELF, PETSC_ERR_LIB,
               "Jansson cannot store 'bodies' in the summary: out of memory, or not UTF-8");
  PetscCall(SummarySetMember(object, "bodies", names));
  PetscCall(SummarySetReal(object, "depth", overlap->depth));
  PetscCall(SummarySetReal(object, "part", overlap->part));
  PetscCall(SummarySetReal(object, "time", name[1] ? body->overlap_time : NAN));
  PetscCall(SummarySetVector(object, "position", overlap->x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddContact(json_t *root, Controller controller, Contact contact, const StatisticsResults *results)
{
  json_t       *object, *pair;
  ContactType   type;
  ContactCounts counts;
  ContactTraits traits;
  const char   *name;

  PetscFunctionBegin;
  PetscCall(ContactGetType(contact, &type));
  PetscCall(ContactGetTraits(contact, &traits));
  PetscCall(SummarySetObject(root, "contact", &object));
  PetscCall(SummarySetMember(object, "type", json_string(type)));
  PetscCall(SetContactStatistics(object, &results->contact, traits.friction));
  PetscCall(AddOverlap(object, controller, contact, results));
  PetscCall(ContactGetCounts(contact, &counts));
  if (traits.breaks) PetscCall(SummarySetReal(object, "glue_loss", counts.glue_loss));
  if (traits.takes) PetscCall(SummarySetReal(object, "contact_loss", counts.contact_loss));
  if (traits.friction) {
    PetscCall(SummarySetReal(object, "friction_least", counts.friction_least));
    PetscCall(SummarySetReal(object, "friction_residual", counts.friction_residual));
    PetscCall(SummarySetInteger(object, "ambiguous_steps", counts.ambiguous_steps));
    PetscCall(SummarySetReal(object, "friction_tilt", counts.friction_tilt));
  }
  PetscCall(SummarySetObject(root, "pairs", &object));
  for (PetscInt i = 0; i < results->n_pairs; i++) {
    PetscCall(ContactGetPair(contact, i, &name, NULL, NULL));
    PetscCall(SummarySetObject(object, name, &pair));
    PetscCall(SetContactStatistics(pair, &results->pairs[i], traits.friction));
    PetscCall(SummarySetVector(pair, "resultant", results->pairs[i].resultant));
    PetscCall(SummarySetVector(pair, "impulse_vector", results->pairs[i].impulse_vector));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddSchwarz(json_t *root, Contact contact, const StatisticsResults *results)
{
  json_t       *object;
  ContactCounts counts;

  PetscFunctionBegin;
  PetscCall(ContactGetCounts(contact, &counts));
  PetscCall(SummarySetObject(root, "schwarz", &object));
  PetscCall(SummarySetInteger(object, "max", results->max_sweeps));
  PetscCall(SummarySetReal(object, "mean_all_steps", results->mean_sweeps));
  PetscCall(SummarySetReal(object, "mean_contact_steps", results->mean_sweeps_contact));
  PetscCall(SummarySetInteger(object, "unconverged_steps", counts.unconverged_steps));
  PetscCall(SummarySetInteger(object, "set_changes", counts.set_changes));
  PetscCall(SummarySetInteger(object, "set_cycles", counts.set_cycles));
  PetscCall(SummarySetInteger(object, "limited_steps", counts.limited_steps));
  PetscCall(SummarySetInteger(object, "unlimited_steps", counts.unlimited_steps));
  PetscCall(SummarySetInteger(object, "energy_attempts", counts.energy_attempts));
  PetscCall(SummarySetInteger(object, "inner_iterations", counts.inner_iterations));
  PetscCall(SummarySetInteger(object, "rebuilds", counts.rebuilds));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far the run came: a signal or -max_wall_time may have ended it, and its figures are those until then */
static PetscErrorCode AddRun(json_t *root, Controller controller)
{
  PetscReal start, time_step;
  PetscInt  step, steps;
  json_t   *object;

  PetscFunctionBegin;
  PetscCall(ControllerGetTimes(controller, &start, &time_step, &steps));
  PetscCall(ControllerGetStep(controller, &step));
  PetscCall(SummarySetObject(root, "run", &object));
  PetscCall(SummarySetMember(object, "complete", json_boolean(step == steps)));
  PetscCall(SummarySetInteger(object, "controller_steps", step));
  PetscCall(SummarySetReal(object, "time", start + (PetscReal)step * time_step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddStepControl(json_t *root, Controller controller)
{
  ControllerCuts cuts;
  json_t        *object;

  PetscFunctionBegin;
  PetscCall(ControllerGetCuts(controller, &cuts));
  PetscCall(SummarySetObject(root, "step_control", &object));
  PetscCall(SummarySetInteger(object, "step_cuts", cuts.cuts));
  PetscCall(SummarySetInteger(object, "steps_cut", cuts.steps));
  PetscCall(SummarySetReal(object, "smallest_step", cuts.smallest_step));
  PetscCall(SummarySetInteger(object, "lossy_steps", cuts.lossy_steps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddSystem(json_t *root, const StatisticsResults *results)
{
  json_t *object;

  PetscFunctionBegin;
  PetscCall(SummarySetObject(root, "system", &object));
  PetscCall(SummarySetReal(object, "energy_scale", results->energy_scale));
  PetscCall(SummarySetReal(object, "energy_error_min", results->energy_error_min));
  PetscCall(SummarySetReal(object, "energy_error_max", results->energy_error_max));
  PetscCall(SummarySetReal(object, "energy_error_final", results->energy_error_final));
  PetscCall(SummarySetReal(object, "momentum_error_max", results->momentum_error_max));
  PetscCall(SummarySetReal(object, "angular_momentum_error_max", results->angular_momentum_error_max));
  PetscCall(SummarySetReal(object, "penalty_energy_max", results->penalty_energy_max));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddWarnings(json_t *root, const Verdict *verdict)
{
  json_t *array = json_array();

  PetscFunctionBegin;
  for (PetscInt i = 0; i < verdict->n; i++)
    PetscCheck(!json_array_append_new(array, json_string(verdict->text[i])), PETSC_COMM_SELF, PETSC_ERR_LIB,
               "Jansson cannot store the warnings in the summary: out of memory, or not UTF-8");
  PetscCall(SummarySetMember(root, "warnings", array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddErrors(json_t *root, Exact exact)
{
  json_t     *object, *bodies;
  ExactErrors errors;
  const char *names[2];

  PetscFunctionBegin;
  PetscCall(ExactGetErrors(exact, &errors));
  PetscCall(SummarySetObject(root, "errors", &object));
  PetscCall(SummarySetReal(object, "contact_position", errors.contact_position));
  PetscCall(SummarySetReal(object, "contact_velocity", errors.contact_velocity));
  PetscCall(SummarySetReal(object, "contact_force", errors.contact_force));
  PetscCall(SummarySetReal(object, "kinetic", errors.kinetic));
  PetscCall(SummarySetReal(object, "potential", errors.potential));
  PetscCall(SummarySetReal(object, "mean_velocity", errors.mean_velocity));
  PetscCall(SummarySetReal(object, "peak_potential", errors.peak_potential));
  PetscCall(SummarySetReal(object, "release_time", errors.release_time));
  PetscCall(ExactGetBodies(exact, names));
  PetscCall(SummarySetObject(object, "bodies", &bodies));
  for (PetscInt side = 0; side < 2; side++) {
    const ExactBodyErrors *body = &errors.bodies[side];

    PetscCall(SummarySetObject(bodies, names[side], &object));
    PetscCall(SummarySetReal(object, "kinetic", body->kinetic));
    PetscCall(SummarySetReal(object, "potential", body->potential));
    PetscCall(SummarySetReal(object, "mean_velocity", body->mean_velocity));
    PetscCall(SummarySetReal(object, "kinetic_max", body->kinetic_max));
    PetscCall(SummarySetReal(object, "potential_max", body->potential_max));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Time spent in the integrators, by kind, and in sweeps, which call the integrators */
static PetscErrorCode AddPhases(json_t *timing, Contact contact, PetscInt n, const Body bodies[])
{
  const char *const integrators[] = {"alpha2", "centraldifference"};
  PetscInt          used[2]       = {0, 0};
  PetscInt64        substeps[2]   = {0, 0}, more_substeps;
  PetscLogDouble    seconds[2]    = {0, 0}, more_seconds;
  ContactCounts     counts;
  json_t           *phases, *object;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    PetscBool is_explicit;
    PetscInt  kind;

    PetscCall(BodyIsExplicit(bodies[i], &is_explicit));
    PetscCall(BodyGetTotalSubsteps(bodies[i], &more_substeps, &more_seconds));
    kind = is_explicit ? 1 : 0;
    used[kind]++;
    substeps[kind] += more_substeps;
    seconds[kind] += more_seconds;
  }
  PetscCall(SummarySetObject(timing, "per_phase", &phases));
  for (PetscInt i = 0; i < 2; i++) {
    if (!used[i]) continue;
    PetscCall(SummarySetObject(phases, integrators[i], &object));
    PetscCall(SummarySetReal(object, "seconds", (PetscReal)seconds[i]));
    PetscCall(SummarySetInteger(object, "substeps", substeps[i]));
  }
  PetscCall(ContactGetCounts(contact, &counts));
  PetscCall(SummarySetObject(phases, "sweeps", &object));
  PetscCall(SummarySetReal(object, "seconds", (PetscReal)counts.seconds));
  PetscCall(SummarySetInteger(object, "count", counts.total_sweeps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddRanks(json_t *timing, const RanksSummary *summary)
{
  json_t *object, *count;

  PetscFunctionBegin;
  PetscCall(SummarySetObject(timing, "ranks", &object));
  PetscCall(SummarySetInteger(object, "count", summary->size));
  for (PetscInt i = 0; i < RANKS_COUNTS; i++) {
    PetscCall(SummarySetObject(object, RanksNames[i], &count));
    PetscCall(SummarySetReal(count, "largest", summary->largest[i]));
    PetscCall(SummarySetReal(count, "mean", summary->mean[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddTiming(json_t *root, Controller controller, Contact contact, PetscInt n, const Body bodies[],
                                const RanksSummary *ranks)
{
  json_t        *object;
  ControllerCost cost;

  PetscFunctionBegin;
  PetscCall(ControllerGetCost(controller, &cost));
  PetscCall(SummarySetObject(root, "timing", &object));
  PetscCall(SummarySetReal(object, "wall", (PetscReal)cost.wall));
  PetscCall(SummarySetReal(object, "cpu", (PetscReal)cost.cpu));
  PetscCall(SummarySetReal(object, "wall_setup", (PetscReal)cost.setup));
  PetscCall(AddPhases(object, contact, n, bodies));
  PetscCall(AddRanks(object, ranks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the object, see OutputFileWrite() */
static PetscErrorCode WriteObject(const char part[], void *ctx)
{
  PetscFunctionBegin;
  PetscCheck(!json_dump_file((json_t *)ctx, part, JSON_INDENT(2) | JSON_REAL_PRECISION(17)), PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE,
             "The summary %s cannot be written; is the disk full?", part);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the summary of a run; `exact`: what it was compared with, or NULL. Collective; the first rank writes */
PetscErrorCode SummaryWrite(Controller controller, const StatisticsResults *results, Exact exact, const Verdict *verdict, const char path[])
{
  PetscErrorCode error;
  RanksSummary   ranks;
  json_t        *root;
  Contact        contact;
  const Body    *bodies;
  PetscInt       n;
  PetscMPIInt    rank;
  Units          units;

  PetscFunctionBegin;
  PetscCall(RanksGather(controller, &ranks));
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)controller), &rank));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ControllerGetBodies(controller, &n, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  root = json_object();
  PetscCall(UnitsGet((PetscObject)controller, &units));
  PetscCall(SummarySetMember(root, "version", json_string(IMPAKT_VERSION)));
  PetscCall(SummarySetMember(root, "units", json_string(UnitsNames[units])));
  PetscCall(AddRun(root, controller));
  PetscCall(AddContact(root, controller, contact, results));
  PetscCall(AddSchwarz(root, contact, results));
  PetscCall(AddStepControl(root, controller));
  PetscCall(SummaryAddBodies(root, bodies, results));
  PetscCall(SummaryAddObstacles(root, results));
  PetscCall(AddSystem(root, results));
  if (exact) PetscCall(AddErrors(root, exact));
  PetscCall(AddWarnings(root, verdict));
  PetscCall(AddTiming(root, controller, contact, n, bodies, &ranks));
  error = OutputFileWrite(path, WriteObject, root, NULL);
  json_decref(root);
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}
