/* The summary: one JSON object, whose members scripts rely on. Numbers that do not exist (no contact, no release) are null. */
#include "summary.h"
#include "outputfile.h"
#include "ranks.h"
#include <impakt.h>
#include <jansson.h>

static PetscErrorCode SetMember(json_t *object, const char name[], json_t *value)
{
  PetscFunctionBegin;
  PetscCheck(!json_object_set_new(object, name, value), PETSC_COMM_SELF, PETSC_ERR_LIB,
             "Jansson cannot store '%s' in the summary: out of memory, or not UTF-8", name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetReal(json_t *object, const char name[], PetscReal value)
{
  PetscFunctionBegin;
  PetscCall(SetMember(object, name, PetscIsInfOrNanReal(value) ? json_null() : json_real((double)value)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetInteger(json_t *object, const char name[], PetscInt64 value)
{
  PetscFunctionBegin;
  PetscCall(SetMember(object, name, json_integer((json_int_t)value)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetVector(json_t *object, const char name[], const PetscReal values[3])
{
  json_t *array = json_array();

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 3; d++)
    PetscCheck(!json_array_append_new(array, PetscIsInfOrNanReal(values[d]) ? json_null() : json_real((double)values[d])), PETSC_COMM_SELF,
               PETSC_ERR_LIB, "Jansson cannot store '%s' in the summary: out of memory", name);
  PetscCall(SetMember(object, name, array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a new object as a member; it belongs to its parent */
static PetscErrorCode SetObject(json_t *object, const char name[], json_t **member)
{
  PetscFunctionBegin;
  *member = json_object();
  PetscCall(SetMember(object, name, *member));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetContactStatistics(json_t *object, const ContactStatistics *contact, PetscBool friction)
{
  PetscFunctionBegin;
  PetscCall(SetReal(object, "first_contact_time", contact->first_contact_time));
  PetscCall(SetReal(object, "release_time", contact->release_time));
  PetscCall(SetReal(object, "onset_time", contact->times.onset));
  PetscCall(SetReal(object, "separation_time", contact->times.separation));
  PetscCall(SetMember(object, "in_contact_at_end", json_boolean(contact->times.in_contact_at_end)));
  PetscCall(SetInteger(object, "onsets", contact->onsets));
  PetscCall(SetInteger(object, "steps_in_contact", contact->steps_in_contact));
  PetscCall(SetReal(object, "force_mean", contact->force_mean));
  PetscCall(SetReal(object, "force_std", contact->force_std));
  PetscCall(SetReal(object, "force_min", contact->force_min));
  PetscCall(SetReal(object, "force_peak", contact->force_peak));
  PetscCall(SetReal(object, "tension_max", contact->tension_max));
  PetscCall(SetReal(object, "impulse", contact->impulse));
  PetscCall(SetReal(object, "max_penetration", contact->max_penetration));
  PetscCall(SetReal(object, "area_max", contact->area_max));
  PetscCall(SetInteger(object, "active_max", contact->active_max));
  PetscCall(SetReal(object, "gap_final", contact->gap_final));
  if (!friction) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SetReal(object, "friction_loss", contact->friction_loss));
  PetscCall(SetReal(object, "obstacle_work", contact->obstacle_work));
  PetscCall(SetInteger(object, "sliding_max", contact->sliding_max));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddContact(json_t *root, Contact contact, const StatisticsResults *results)
{
  json_t     *object, *pair;
  ContactType type;
  ContactLaw  law;
  PetscBool   friction;
  const char *name;

  PetscFunctionBegin;
  PetscCall(ContactGetType(contact, &type));
  PetscCall(ContactGetLaw(contact, &law));
  friction = (PetscBool)(law == CONTACT_LAW_FRICTION);
  PetscCall(SetObject(root, "contact", &object));
  PetscCall(SetMember(object, "type", json_string(type)));
  PetscCall(SetContactStatistics(object, &results->contact, friction));
  if (friction) {
    ContactCounts counts;

    PetscCall(ContactGetCounts(contact, &counts));
    PetscCall(SetReal(object, "friction_least", counts.friction_least));
    PetscCall(SetReal(object, "friction_residual", counts.friction_residual));
    PetscCall(SetInteger(object, "ambiguous_steps", counts.ambiguous_steps));
    PetscCall(SetReal(object, "friction_tilt", counts.friction_tilt));
  }
  PetscCall(SetObject(root, "pairs", &object));
  for (PetscInt i = 0; i < results->n_pairs; i++) {
    PetscCall(ContactGetPair(contact, i, &name, NULL, NULL));
    PetscCall(SetObject(object, name, &pair));
    PetscCall(SetContactStatistics(pair, &results->pairs[i], friction));
    PetscCall(SetVector(pair, "impulse_vector", results->pairs[i].impulse_vector));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddSchwarz(json_t *root, Contact contact, const StatisticsResults *results)
{
  json_t       *object;
  ContactCounts counts;

  PetscFunctionBegin;
  PetscCall(ContactGetCounts(contact, &counts));
  PetscCall(SetObject(root, "schwarz", &object));
  PetscCall(SetInteger(object, "max", results->max_sweeps));
  PetscCall(SetReal(object, "mean_all_steps", results->mean_sweeps));
  PetscCall(SetReal(object, "mean_contact_steps", results->mean_sweeps_contact));
  PetscCall(SetInteger(object, "unconverged_steps", counts.unconverged_steps));
  PetscCall(SetInteger(object, "set_changes", counts.set_changes));
  PetscCall(SetInteger(object, "set_cycles", counts.set_cycles));
  PetscCall(SetInteger(object, "limited_steps", counts.limited_steps));
  PetscCall(SetInteger(object, "unlimited_steps", counts.unlimited_steps));
  PetscCall(SetInteger(object, "energy_attempts", counts.energy_attempts));
  PetscCall(SetInteger(object, "inner_iterations", counts.inner_iterations));
  PetscCall(SetInteger(object, "rebuilds", counts.rebuilds));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Controller steps that were made again in halves */
static PetscErrorCode AddStepControl(json_t *root, Controller controller)
{
  ControllerCuts cuts;
  json_t        *object;

  PetscFunctionBegin;
  PetscCall(ControllerGetCuts(controller, &cuts));
  PetscCall(SetObject(root, "step_control", &object));
  PetscCall(SetInteger(object, "step_cuts", cuts.cuts));
  PetscCall(SetInteger(object, "steps_cut", cuts.steps));
  PetscCall(SetReal(object, "smallest_step", cuts.smallest_step));
  PetscCall(SetInteger(object, "lossy_steps", cuts.lossy_steps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mass of a body, and what its massless contact layer has changed */
static PetscErrorCode AddMass(json_t *object, Body body)
{
  PetscReal total, least, largest, shift[3] = {0}, inertia;
  json_t   *mass;

  PetscFunctionBegin;
  PetscCall(BodyGetMass(body, &total));
  PetscCall(BodyGetMassRedistribution(body, &least, &largest, shift, &inertia));
  PetscCall(SetObject(object, "mass", &mass));
  PetscCall(SetReal(mass, "total", total));
  PetscCall(SetReal(mass, "factor_min", least));
  PetscCall(SetReal(mass, "factor_max", largest));
  PetscCall(SetVector(mass, "centre_shift", shift));
  PetscCall(SetReal(mass, "inertia_error", inertia));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The reactions at the held surfaces of a body, or, with -1 for its number, at all obstacles */
static PetscErrorCode AddReactions(json_t *object, PetscInt body, const StatisticsResults *results)
{
  json_t *member;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < results->n_supports; i++) {
    const SupportStatistics *support = &results->supports[i];

    if (support->body != body) continue;
    PetscCall(SetObject(object, support->name, &member));
    PetscCall(SetVector(member, "force", support->force));
    PetscCall(SetVector(member, "moment", support->moment));
    PetscCall(SetReal(member, "force_peak", support->force_peak));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddObstacles(json_t *root, const StatisticsResults *results)
{
  json_t *object;

  PetscFunctionBegin;
  PetscCall(SetObject(root, "obstacles", &object));
  PetscCall(AddReactions(object, -1, results));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Model and mass of the blocks with materials of their own, and of the rest */
static PetscErrorCode AddBlocks(json_t *object, Body body)
{
  json_t            *blocks, *block;
  const char *const *names;
  const Material    *materials;
  const PetscReal   *mass;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(BodyGetBlocks(body, &n, &names, &materials));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetBlockMass(body, &mass));
  PetscCall(SetObject(object, "blocks", &blocks));
  for (PetscInt k = 0; k < n; k++) {
    MaterialType type;

    PetscCall(MaterialGetType(materials[k], &type));
    PetscCall(SetObject(blocks, names[k][0] ? names[k] : "(rest)", &block));
    PetscCall(SetMember(block, "material", json_string(type)));
    PetscCall(SetReal(block, "mass", mass[k]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddBodies(json_t *root, const Body bodies[], const StatisticsResults *results)
{
  json_t     *objects, *object, *reactions;
  const char *name;
  PetscInt    dofs;
  PetscInt64  substeps;
  Vec         u;

  PetscFunctionBegin;
  PetscCall(SetObject(root, "bodies", &objects));
  for (PetscInt i = 0; i < results->n_bodies; i++) {
    const BodyStatistics *body = &results->bodies[i];

    PetscCall(PetscObjectGetName((PetscObject)bodies[i], &name));
    PetscCall(BodyGetSolution(bodies[i], &u, NULL, NULL));
    PetscCall(VecGetSize(u, &dofs));
    PetscCall(BodyGetTotalSubsteps(bodies[i], &substeps, NULL));
    PetscCall(SetObject(objects, name, &object));
    PetscCall(SetInteger(object, "dofs", dofs));
    PetscCall(AddMass(object, bodies[i]));
    PetscCall(AddBlocks(object, bodies[i]));
    PetscCall(SetReal(object, "kinetic", body->kinetic));
    PetscCall(SetReal(object, "potential", body->potential));
    PetscCall(SetReal(object, "peak_potential", body->peak_potential));
    PetscCall(SetReal(object, "external_work", body->external_work));
    PetscCall(SetReal(object, "damping_work", body->damping_work));
    if (body->plastic) PetscCall(SetReal(object, "plastic_work", body->plastic_work));
    PetscCall(SetReal(object, "hourglass_energy", body->hourglass_energy));
    PetscCall(SetReal(object, "hourglass_energy_max", body->hourglass_energy_max));
    PetscCall(SetReal(object, "rotation_max", body->rotation_max));
    PetscCall(SetInteger(object, "inverted_max", body->inverted_max));
    if (!PetscIsNanReal(body->displacement_error)) PetscCall(SetReal(object, "displacement_error", body->displacement_error));
    PetscCall(SetReal(object, "total_energy_error_min", body->energy_error_min));
    PetscCall(SetReal(object, "total_energy_error_max", body->energy_error_max));
    PetscCall(SetInteger(object, "substeps", substeps));
    PetscCall(SetObject(object, "reactions", &reactions));
    PetscCall(AddReactions(reactions, i, results));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddSystem(json_t *root, const StatisticsResults *results)
{
  json_t *object;

  PetscFunctionBegin;
  PetscCall(SetObject(root, "system", &object));
  PetscCall(SetReal(object, "energy_error_min", results->energy_error_min));
  PetscCall(SetReal(object, "energy_error_max", results->energy_error_max));
  PetscCall(SetReal(object, "energy_error_final", results->energy_error_final));
  PetscCall(SetReal(object, "momentum_error_max", results->momentum_error_max));
  PetscCall(SetReal(object, "angular_momentum_error_max", results->angular_momentum_error_max));
  PetscCall(SetReal(object, "penalty_energy_max", results->penalty_energy_max));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a user should know before believing the figures */
static PetscErrorCode AddWarnings(json_t *root, const Verdict *verdict)
{
  json_t *array = json_array();

  PetscFunctionBegin;
  for (PetscInt i = 0; i < verdict->n; i++)
    PetscCheck(!json_array_append_new(array, json_string(verdict->text[i])), PETSC_COMM_SELF, PETSC_ERR_LIB,
               "Jansson cannot store the warnings in the summary: out of memory, or not UTF-8");
  PetscCall(SetMember(root, "warnings", array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddErrors(json_t *root, Exact exact)
{
  json_t     *object, *bodies;
  ExactErrors errors;
  const char *names[2];

  PetscFunctionBegin;
  PetscCall(ExactGetErrors(exact, &errors));
  PetscCall(SetObject(root, "errors", &object));
  PetscCall(SetReal(object, "contact_position", errors.contact_position));
  PetscCall(SetReal(object, "contact_velocity", errors.contact_velocity));
  PetscCall(SetReal(object, "contact_force", errors.contact_force));
  PetscCall(SetReal(object, "kinetic", errors.kinetic));
  PetscCall(SetReal(object, "potential", errors.potential));
  PetscCall(SetReal(object, "mean_velocity", errors.mean_velocity));
  PetscCall(SetReal(object, "peak_potential", errors.peak_potential));
  PetscCall(SetReal(object, "release_time", errors.release_time));
  PetscCall(ExactGetBodies(exact, names));
  PetscCall(SetObject(object, "bodies", &bodies));
  for (PetscInt side = 0; side < 2; side++) {
    const ExactBodyErrors *body = &errors.bodies[side];

    PetscCall(SetObject(bodies, names[side], &object));
    PetscCall(SetReal(object, "kinetic", body->kinetic));
    PetscCall(SetReal(object, "potential", body->potential));
    PetscCall(SetReal(object, "mean_velocity", body->mean_velocity));
    PetscCall(SetReal(object, "kinetic_max", body->kinetic_max));
    PetscCall(SetReal(object, "potential_max", body->potential_max));
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
  PetscCall(SetObject(timing, "per_phase", &phases));
  for (PetscInt i = 0; i < 2; i++) {
    if (!used[i]) continue;
    PetscCall(SetObject(phases, integrators[i], &object));
    PetscCall(SetReal(object, "seconds", (PetscReal)seconds[i]));
    PetscCall(SetInteger(object, "substeps", substeps[i]));
  }
  PetscCall(ContactGetCounts(contact, &counts));
  PetscCall(SetObject(phases, "sweeps", &object));
  PetscCall(SetReal(object, "seconds", (PetscReal)counts.seconds));
  PetscCall(SetInteger(object, "count", counts.total_sweeps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddRanks(json_t *timing, const RanksSummary *summary)
{
  json_t *object, *count;

  PetscFunctionBegin;
  PetscCall(SetObject(timing, "ranks", &object));
  PetscCall(SetInteger(object, "count", summary->size));
  for (PetscInt i = 0; i < RANKS_COUNTS; i++) {
    PetscCall(SetObject(object, RanksNames[i], &count));
    PetscCall(SetReal(count, "largest", summary->largest[i]));
    PetscCall(SetReal(count, "mean", summary->mean[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddTiming(json_t *root, Controller controller, Contact contact, PetscInt n, const Body bodies[],
                                const RanksSummary *ranks)
{
  json_t        *object;
  PetscLogDouble setup, wall, cpu;

  PetscFunctionBegin;
  PetscCall(ControllerGetTimings(controller, &setup, &wall, &cpu));
  PetscCall(SetObject(root, "timing", &object));
  PetscCall(SetReal(object, "wall", (PetscReal)wall));
  PetscCall(SetReal(object, "cpu", (PetscReal)cpu));
  PetscCall(SetReal(object, "wall_setup", (PetscReal)setup));
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

/*
  SummaryWrite - writes the summary of a run

  Collective; rank 0 writes

  Input Parameters:
+ controller - the `Controller`, at its end
. results    - figures of the run
. exact      - what it was compared with, or `NULL`
. verdict    - what is amiss with it
- path       - the file
*/
PetscErrorCode SummaryWrite(Controller controller, const StatisticsResults *results, Exact exact, const Verdict *verdict, const char path[])
{
  PetscErrorCode error;
  RanksSummary   ranks;
  json_t        *root;
  Contact        contact;
  const Body    *bodies;
  PetscInt       n;
  PetscMPIInt    rank;

  PetscFunctionBegin;
  PetscCall(RanksGather(controller, &ranks));
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)controller), &rank));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ControllerGetBodies(controller, &n, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  root = json_object();
  PetscCall(SetMember(root, "version", json_string(IMPAKT_VERSION)));
  PetscCall(AddContact(root, contact, results));
  PetscCall(AddSchwarz(root, contact, results));
  PetscCall(AddStepControl(root, controller));
  PetscCall(AddBodies(root, bodies, results));
  PetscCall(AddObstacles(root, results));
  PetscCall(AddSystem(root, results));
  if (exact) PetscCall(AddErrors(root, exact));
  PetscCall(AddWarnings(root, verdict));
  PetscCall(AddTiming(root, controller, contact, n, bodies, &ranks));
  error = OutputFileWrite(path, WriteObject, root, NULL);
  json_decref(root);
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}
