/* Controller steps in halves: what a run ends with whose steps fail and are made again is what one ends with that makes these steps at
   once, bit for bit. */
#include "simulation.h"

#define STEPS      12 /* whole controller steps */
#define MAX_VALUES 4096

/* How the steps are made */
typedef enum {
  HALVES,     /* with half the controller step from the start */
  CUT,        /* each whole step fails first */
  MIXED,      /* some whole, some in halves, some in halves and quarters */
  MIXED_FAILS /* the same, each cut after a step that has failed */
} Way;

/* Displacement, velocity and acceleration of all bodies, their energies and momenta, and the force, after each whole step */
typedef struct {
  PetscInt    n;
  PetscScalar values[STEPS][MAX_VALUES];
} Record;

static void NoteState(Body body, PetscScalar values[], PetscInt *n_values)
{
  Vec vecs[3];

  ok(BodyGetSolution(body, &vecs[0], &vecs[1], &vecs[2]));
  for (PetscInt k = 0; k < 3; k++) {
    const PetscScalar *array;
    PetscInt           n;

    ok(VecGetLocalSize(vecs[k], &n));
    assert_true(*n_values + n < MAX_VALUES);
    ok(VecGetArrayRead(vecs[k], &array));
    ok(PetscArraycpy(values + *n_values, array, n));
    ok(VecRestoreArrayRead(vecs[k], &array));
    *n_values += n;
  }
}

static void Note(Simulation *simulation, PetscInt step, Record *record)
{
  PetscScalar     *values = record->values[step];
  ContactPairState pair;

  record->n = 0;
  for (PetscInt b = 0; b < simulation->n_bodies; b++) {
    BodyMeasures measures;

    NoteState(simulation->bodies[b], values, &record->n);
    ok(BodyGetMeasures(simulation->bodies[b], &measures));
    values[record->n++] = measures.kinetic;
    values[record->n++] = measures.potential;
    values[record->n++] = measures.momentum[0];
    values[record->n++] = measures.damping_work;
  }
  ok(ContactGetPairStates(simulation->contact, &pair));
  values[record->n++] = pair.force;
}

static void Fail(Simulation *simulation, PetscInt level)
{
  StepConvergedReason reason;

  ok(ContactSetStepLevel(simulation->contact, level));
  ok(ContactTryStep(simulation->contact, PETSC_TRUE, PETSC_MAX_REAL, &reason));
  ok(ContactStepBack(simulation->contact));
}

static void Make(Simulation *simulation, PetscInt level)
{
  StepConvergedReason reason;

  ok(ContactSetStepLevel(simulation->contact, level));
  ok(ContactTryStep(simulation->contact, PETSC_TRUE, PETSC_MAX_REAL, &reason));
  assert_int_equal(reason, STEP_CONVERGED);
  ok(ContactAccept(simulation->contact));
}

/* A whole step, of which every third stays whole, and every third is cut twice in its first half */
static void MakeMixed(Simulation *simulation, PetscInt step, PetscBool fails)
{
  if (step % 3 == 0) {
    Make(simulation, 0);
    return;
  }
  if (fails) Fail(simulation, 0);
  if (step % 3 == 1) {
    if (fails) Fail(simulation, 1);
    Make(simulation, 2);
    Make(simulation, 2);
  } else Make(simulation, 1);
  Make(simulation, 1);
}

/* Parts of a controller step, at whose ends all bodies have a time in common, are cut each for itself */
static void Run(Simulation *simulation, Way way, Record *record)
{
  ContactTraits traits;

  ok(ContactGetTraits(simulation->contact, &traits));
  for (PetscInt step = 0; step < STEPS; step++) {
    for (PetscInt part = 0; part < traits.parts && way == CUT; part++) {
      Fail(simulation, 0);
      Make(simulation, 1);
      Make(simulation, 1);
    }
    for (PetscInt part = 0; part < traits.parts && (way == MIXED || way == MIXED_FAILS); part++)
      MakeMixed(simulation, traits.parts * step + part, (PetscBool)(way == MIXED_FAILS));
    for (PetscInt half = 0; half < 2 && way == HALVES; half++) Step(simulation);
    Note(simulation, step, record);
  }
}

static void Compare(const Record *a, const Record *b, PetscReal tolerance)
{
  PetscBool touched = PETSC_FALSE;

  assert_int_equal(a->n, b->n);
  for (PetscInt step = 0; step < STEPS; step++) {
    for (PetscInt i = 0; i < a->n; i++) near(a->values[step][i], b->values[step][i], tolerance);
    touched = (PetscBool)(touched || PetscRealPart(a->values[step][a->n - 1]) > 0);
  }
  assert_true(touched);
}

/* `whole` and `half`: the options that have times in them, of a controller step and of half of it */
static void CompareWaysTo(Simulation *simulation, const char whole[], const char half[], const char options[], PetscReal tolerance)
{
  Record *records;

  ok(PetscMalloc1(2, &records));
  AddOptions(options);
  SimulationRepeat(simulation, half);
  Run(simulation, HALVES, &records[0]);
  SimulationRepeat(simulation, whole);
  Run(simulation, CUT, &records[1]);
  Compare(&records[0], &records[1], tolerance);
  SimulationRepeat(simulation, whole);
  Run(simulation, MIXED, &records[0]);
  SimulationRepeat(simulation, whole);
  Run(simulation, MIXED_FAILS, &records[1]);
  Compare(&records[0], &records[1], tolerance);
  ok(PetscFree(records));
}

static void CompareWays(Simulation *simulation, const char whole[], const char half[], const char options[])
{
  CompareWaysTo(simulation, whole, half, options, 0);
}

#define STABLE "-left_ts_time_step 0.02 -right_ts_time_step 0.02 -time_step 0.02"
#define HALF   "-left_ts_time_step 0.01 -right_ts_time_step 0.01 -time_step 0.01"

static void bars(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const variants[] = {
      "-left_ts_type alpha2 -right_ts_type alpha2 -left_material_type neo_hookean",
      "-left_material_type linear_elastic -right_ts_type centraldifference -schwarz_transmission impedance",
      "-left_ts_type centraldifference -right_material_type neo_hookean -schwarz_transmission dirichlet_neumann -contact_swap_sides",
      "-contact_swap_sides 0 -left_ts_type alpha2 -right_ts_type alpha2 -left_mass_redistribute 0 -right_mass_redistribute 0",
      "-left_mass_redistribute 1 -right_mass_redistribute 1 -left_mass_type consistent -left_damping_mass 0.5 "
      "-right_damping_stiffness 0.003 -right_material_type linear_elastic",
      "-left_ts_type centraldifference -left_material_type neo_hookean -left_damping_stiffness 0.002",
  };

  AddCollision(8, 13, 0);
  for (size_t i = 0; i < sizeof(variants) / sizeof(variants[0]); i++) CompareWays(simulation, STABLE, HALF, variants[i]);
}

static void substeps(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const variants[] = {
      "-right_ts_type centraldifference", "-left_ts_type centraldifference -left_material_type neo_hookean",
      "-left_ts_type alpha2 -left_damping_mass 0.5 -left_damping_stiffness 0.001 -right_damping_stiffness 0.001"};

  AddCollision(8, 13, 0);
  for (PetscInt shared = 0; shared < 2; shared++) {
    AddOptions(shared ? "-contact_shared_times true" : "-contact_shared_times false");
    for (size_t i = 0; i < sizeof(variants) / sizeof(variants[0]); i++)
      CompareWays(simulation, "-left_ts_time_step 0.005 -right_ts_time_step 0.01 -time_step 0.02",
                  "-left_ts_time_step 0.0025 -right_ts_time_step 0.005 -time_step 0.01", variants[i]);
  }
}

static void other_methods(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const variants[] = {
      "-contact_type penalty -contact_penalty_damping 0.1 -contact_constraint both -right_ts_type centraldifference",
      "-contact_constraint gap -contact_type augmented_lagrangian", "-contact_type lagrange -right_ts_type alpha2"};

  AddCollision(8, 13, 0);
  for (size_t i = 0; i < sizeof(variants) / sizeof(variants[0]); i++) CompareWays(simulation, STABLE, HALF, variants[i]);
}

#define KEPT "-left_mass_redistribute 0 -right_mass_redistribute 0 "

/* The contact step: what it remembers of who has carried a force, and of who has joined */
static void contact_step(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const variants[] = {"", "-left_material_type neo_hookean -right_ts_type centraldifference",
                                  KEPT "-left_material_type linear_elastic -right_ts_type alpha2",
                                  KEPT "-left_ts_type centraldifference -left_material_type neo_hookean"};

  AddCollision(8, 13, 0);
  for (size_t i = 0; i < sizeof(variants) / sizeof(variants[0]); i++) CompareWays(simulation, STABLE, HALF, variants[i]);
  CompareWays(simulation, "-left_ts_time_step 0.005 -right_ts_time_step 0.01 -time_step 0.02",
              "-left_ts_time_step 0.0025 -right_ts_time_step 0.005 -time_step 0.01", variants[3]);
}

#define BLOCKS                                                                                                                             \
  "-bodies left,right -contact_pairs left:right -time_end 1 -left_dm_plex_dim 2 -left_dm_plex_box_faces 3,18 -left_density 1 "             \
  "-left_youngs_modulus 1 -left_poissons_ratio 0.2 -left_initial_velocity 0.1,0 -right_dm_plex_dim 2 -right_dm_plex_box_faces 3,16 "       \
  "-right_density 1 -right_youngs_modulus 1 -right_poissons_ratio 0.2 -right_initial_velocity -0.1,0 -left_dm_plex_box_lower 0,0 "         \
  "-left_dm_plex_box_upper 0.5,1 -right_dm_plex_box_lower 0.53,0 -right_dm_plex_box_upper 1.03,1 -right_rotate 3 "                         \
  "-right_rotate_centre 0.53,0.5"

/* Of accelerations: where a step has failed, bodies find the same answer to several rows by other sums, and round-off grows with each step.
   Positions of size 1 are right to 2e-16, and accelerations, in steps of 0.005, to 2/dt^2 times as much, 2e-11. Measured: 1.5e-11. */
#define ROUND_OFF 5e-11
#define TIGHT     "-schwarz_snes_rtol 1e-13 "

/* Blocks of which one is turned by 3 degrees: more rows than are known from the start, which join and leave. Between nonlinear blocks rows
   follow the surfaces, ahead by the slip that is expected in a step. */
static void turned_blocks(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const variants[] = {TIGHT "-right_ts_type centraldifference",
                                  "-left_material_type neo_hookean -right_material_type neo_hookean",
                                  "-contact_type penalty -right_ts_type alpha2"};

  AddOptions(BLOCKS);
  for (size_t i = 0; i < sizeof(variants) / sizeof(variants[0]); i++) CompareWaysTo(simulation, STABLE, HALF, variants[i], ROUND_OFF);
}

static PetscInt Rebuilds(Simulation *simulation)
{
  ContactCounts counts;

  ok(ContactGetCounts(simulation->contact, &counts));
  return counts.rebuilds;
}

/* With friction: nodes join and leave, stick and slide */
static void rubbing_blocks(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const variants[] = {"-right_ts_type centraldifference", KEPT "-right_ts_type alpha2",
                                  KEPT "-right_ts_type centraldifference -left_material_type neo_hookean -right_material_type neo_hookean"};

  AddOptions(BLOCKS);
  AddOptions("-contact_law coulomb -contact_friction 0.3 -left_initial_velocity 0.2,-0.1");
  for (size_t i = 0; i < sizeof(variants) / sizeof(variants[0]); i++) CompareWaysTo(simulation, STABLE, HALF, variants[i], ROUND_OFF);
}

/* The left block slides down along the right one. Rows are built again after a thousandth of a face, which each of the steps that fail does
   too. */
static void sliding_blocks(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const variants[] = {TIGHT "-left_ts_type alpha2 -right_ts_type centraldifference",
                                  "-left_material_type neo_hookean -right_material_type neo_hookean",
                                  "-right_ts_type alpha2 -contact_type penalty", "-contact_type lagrange"};

  AddOptions(BLOCKS);
  AddOptions("-left_initial_velocity 0.2,-0.1 -contact_slip_bound 1e-3");
  for (size_t i = 0; i < sizeof(variants) / sizeof(variants[0]); i++) {
    PetscInt rebuilds;

    CompareWaysTo(simulation, STABLE, HALF, variants[i], ROUND_OFF);
    rebuilds = Rebuilds(simulation);
    assert_true(rebuilds > STEPS / 2);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {simulation_test(bars),          simulation_test(substeps),       simulation_test(other_methods),
                                     simulation_test(turned_blocks), simulation_test(sliding_blocks), simulation_test(contact_step),
                                     simulation_test(rubbing_blocks)};

  return impakt_main(argc, argv, tests);
}
