/* long: 3 */
/* Robin rows of a body, transmission conditions, predictors, and sides that swap: other ways to the same solution. */
#include "simulation.h"

/* E A = 2 N, c = 2 m/s, rho A = 0.5 kg/m, z = sqrt(E rho) A = 1 N s/m; two metres in 8 elements: E A / h = 8 N/m */
#define BAR "-dm_plex_box_faces 8 -dm_plex_box_upper 2 -density 1 -youngs_modulus 4 -cross_section 0.5 "
static const PetscReal   ends[]        = {2, 0};
static const char *const integrators[] = {TSALPHA2, TSCENTRALDIFFERENCE};

static PetscOptions create_body(Body *body, Rows *rows, BodyTraces *traces, const char integrator[], PetscInt moved, PetscInt substeps)
{
  PetscOptions options = bar_create(body, BAR "-ts_type %s -ts_time_step 0.05 -mass_redistribute %d", integrator, (int)moved);

  set_rows(*body, 2, ends, rows);
  ok(BodySetControllerStep(*body, 0, 0.05 * substeps));
  ok(BodySetUp(*body));
  ok(BodyGetTraces(*body, traces));
  return options;
}

/*
   A Robin row answers with a force f along it and a displacement w, f + k w = r at the end of each substep. The same force put on it as a
   load brings about the same state.
*/
static void robin_rows(void **state)
{
  const BodyCondition robin[] = {BODY_ROBIN, BODY_FREE}, forced[] = {BODY_FORCED, BODY_FREE};
  const PetscReal     stiffness[] = {3, 5};

  (void)state;
  for (PetscInt i = 0; i < 2; i++)
    for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
      Body         body;
      BodyTraces   traces;
      Rows         rows;
      PetscOptions options  = create_body(&body, &rows, &traces, integrators[i], 1, substeps);
      PetscReal    force[5] = {0}, displacement[5];

      set_robin(body, &rows, stiffness);
      set_conditions(body, &rows, robin);
      for (PetscInt level = 1; level <= substeps; level++) set_level(&rows, traces.force_in, level, 0, 0.2 * PetscSinReal(level));
      ok(BodyIntegrate(body));
      for (PetscInt level = 1; level <= substeps; level++) {
        force[level]        = get_level(&rows, traces.reaction, level, 0);
        displacement[level] = get_level(&rows, traces.displacement, level, 0);
        /* numbers of 0.1 */
        near(force[level] + stiffness[0] * displacement[level], 0.2 * PetscSinReal(level), 1e-15);
        assert_true(PetscAbsReal(force[level]) > 1e-3);
      }
      ok(BodyRestore(body));
      set_conditions(body, &rows, forced);
      for (PetscInt level = 0; level <= substeps; level++) set_level(&rows, traces.force_in, level, 0, force[level]);
      ok(BodyIntegrate(body));
      for (PetscInt level = 1; level <= substeps; level++)
        near(get_level(&rows, traces.displacement, level, 0), displacement[level], 1e-15);
      bar_destroy(&body, options);
    }
}

/* E A / h, sqrt(E rho) A */
static void stiffness_and_impedance(void **state)
{
  Body         body;
  BodyTraces   traces;
  Rows         rows;
  PetscOptions options = create_body(&body, &rows, &traces, TSALPHA2, 1, 1);
  PetscReal    stiffness[4], impedance;

  (void)state;
  ok(BodyComputeRowStiffness(body, stiffness));
  for (PetscInt i = 0; i < rows.local; i++) near(stiffness[i], 8, 1e-14);
  ok(BodyGetImpedance(body, &impedance));
  near(impedance, 1, 1e-15);
  bar_destroy(&body, options);
}

static void robin_rows_come_after_set_up(void **state)
{
  const PetscReal none[4] = {0};
  Body            body;
  Rows            rows;
  PetscOptions    options = bar_create(&body, BAR);

  (void)state;
  set_rows(body, 2, ends, &rows);
  ok(BodySetControllerStep(body, 0, 0.1));
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetUp()", BodySetRobin(body, none));
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetUp()", BodyComputeRowStiffness(body, NULL));
  bar_destroy(&body, options);
}

typedef struct {
  PetscReal force, momentum[2], energy;
} Outcome;

/* Six steps after the first contact */
static Outcome RunSteps(Simulation *simulation, PetscInt *sweeps)
{
  ContactPairState pair = {0};
  ContactCounts    counts;
  Outcome          outcome;

  for (PetscInt step = 0; step < 6; step++) {
    pair = Step(simulation);
    assert_int_equal(pair.active, 1);
    near(pair.gap, 0, 1e-11);
  }
  ok(ContactGetCounts(simulation->contact, &counts));
  assert_int_equal(counts.unconverged_steps, 0);
  if (sweeps) *sweeps = (PetscInt)counts.total_sweeps;
  outcome.force       = pair.force;
  outcome.momentum[0] = Momentum(simulation, 0);
  outcome.momentum[1] = Momentum(simulation, 1);
  outcome.energy      = TotalEnergy(simulation);
  return outcome;
}

/* The tolerance of the outer iteration is 1e-12 m; what six steps make of it in forces of 0.1 N by springs of about 10 N/m,
   accelerations by 4/dt^2 = 1e4, is below 1e-8 of them */
static void CheckOutcome(Outcome a, Outcome b)
{
  near(a.force, b.force, 1e-8 * PetscAbsReal(b.force));
  for (PetscInt i = 0; i < 2; i++) near(a.momentum[i], b.momentum[i], 1e-9);
  near(a.energy, b.energy, 1e-9);
}

static const char *const pairings[] = {
    "-left_ts_type alpha2 -right_ts_type alpha2",
    "-left_ts_type alpha2 -right_ts_type centraldifference",
    "-left_ts_type centraldifference -right_ts_type alpha2",
    "-left_ts_type centraldifference -right_ts_type centraldifference",
    "-left_ts_type alpha2 -left_ts_time_step 0.005 -right_ts_type centraldifference -right_ts_time_step 0.005",
};

/* All transmission conditions and predictors, with sides as they are and swapped in every step, reach one solution. Unequal
   meshes and a moving frame leave nothing to symmetry. */
static void one_solution(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const ways[]     = {
      "-schwarz_transmission robin",     "-schwarz_transmission robin -schwarz_robin_parameter 3",
      "-schwarz_transmission impedance", "-schwarz_transmission robin -schwarz_snes_type nrichardson -schwarz_convergence mismatch",
      "-schwarz_predictor last",         "-schwarz_predictor trial",
      "-schwarz_predictor extrapolate",  "-schwarz_predictor inelastic"};
  const size_t n = sizeof(pairings) / sizeof(pairings[0]);
  PetscMPIInt  size;

  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  /* the last alone on several ranks, which is implicit on one side and explicit on the other */
  for (size_t p = size > 1 ? n - 1 : 0; p < n; p++) {
    Outcome reference = {0};

    for (PetscInt way = -1; way < (PetscInt)(sizeof(ways) / sizeof(ways[0])); way++)
      for (PetscInt swap = 0; swap < 2; swap++) {
        Outcome outcome;

        ok(ControllerDestroy(&simulation->controller));
        ok(PetscOptionsClear(NULL));
        AddCollision(8, 13, 50);
        AddOptions(pairings[p]);
        if (way >= 0) AddOptions(ways[way]);
        AddOptions(swap ? "-contact_swap_sides 1" : "-contact_swap_sides 0");
        ok(SimulationCreate(simulation));
        outcome = RunSteps(simulation, NULL);
        if (way < 0 && !swap) reference = outcome;
        else CheckOutcome(outcome, reference);
      }
  }
}

/* Its Jacobian is exact for linear bodies: two sweeps in each step under Robin conditions too, whatever the substeps and whoever
   takes displacements */
static void newton_needs_two_sweeps(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const ways[]     = {"-schwarz_transmission robin", "-schwarz_transmission impedance", "-contact_swap_sides"};
  const char *const steps[]    = {"", "-left_ts_time_step 0.01 -right_ts_time_step 0.005", "-left_ts_time_step 0.005",
                                  "-right_ts_time_step 0.005"};

  for (PetscInt way = 0; way < 3; way++)
    for (PetscInt i = 0; i < 4; i++) {
      ContactCounts counts;

      ok(ControllerDestroy(&simulation->controller));
      ok(PetscOptionsClear(NULL));
      AddCollision(8, 13, 50);
      AddOptions(ways[way]);
      AddOptions(steps[i]);
      AddOptions("-contact_allow_unstable true"); /* Robin conditions over unequal substeps */
      ok(SimulationCreate(simulation));
      for (PetscInt step = 0; step < 6; step++) {
        assert_int_equal(Step(simulation).active, 1);
        ok(ContactGetCounts(simulation->contact, &counts));
        between(counts.sweeps, 1, 2);
      }
    }
}

/* With springs as stiff as what is behind them, the plain alternation needs no acceleration: each sweep leaves a fraction of a
   hundredth, (k - k')^2 / (k + k')^2 with the stiffness k' = 1.1 k of a massless node that hangs on an element and its mass.
   Dirichlet and Neumann conditions need relaxation with massless nodes. */
static void plain_alternation_converges(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscInt    sweeps;

  AddCollision(8, 8, 50);
  AddOptions("-schwarz_snes_type nrichardson -schwarz_transmission robin");
  ok(SimulationCreate(simulation));
  RunSteps(simulation, &sweeps);
  between(sweeps, 12, 6 * 9); /* the change of position has to be below 1e-12 m: one sweep more than the mismatch */
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-schwarz_transmission dirichlet_neumann");
  ok(SimulationCreate(simulation));
  refused(PETSC_ERR_NOT_CONVERGED, "after 51 sweeps|DIVERGED_MAX_IT", ContactStep(simulation->contact));
}

static void wrong_options_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  const struct {
    const char    *options, *words;
    PetscErrorCode code;
  } cases[] = {
      {"-schwarz_transmission robin -schwarz_robin_parameter 0", "-schwarz_robin_parameter 0|must be positive", PETSC_ERR_USER_INPUT},
      {"-schwarz_transmission impedance -schwarz_impedance_parameter 0", "-schwarz_impedance_parameter 0|must be positive",
       PETSC_ERR_USER_INPUT},
      {"-schwarz_transmission robin -schwarz_robin_parameter -2", "-schwarz_robin_parameter -2|must be positive", PETSC_ERR_USER_INPUT},
      {"-schwarz_transmission robin -right_ts_type centraldifference -right_mass_redistribute 0",
       "'right' have mass|-right_mass_redistribute true|dirichlet_neumann", PETSC_ERR_USER_INPUT},
      {"-schwarz_transmission impedance -left_ts_type centraldifference -left_mass_redistribute 0",
       "'left' have mass|-left_mass_redistribute true", PETSC_ERR_USER_INPUT},
  };

  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    ok(ControllerDestroy(&simulation->controller));
    ok(PetscOptionsClear(NULL));
    AddCollision(8, 10, 0);
    AddOptions(cases[i].options);
    refused(cases[i].code, cases[i].words, SimulationCreate(simulation));
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(robin_rows),
      cmocka_unit_test(stiffness_and_impedance),
      cmocka_unit_test(robin_rows_come_after_set_up),
      simulation_test(one_solution),
      simulation_test(newton_needs_two_sweeps),
      simulation_test(plain_alternation_converges),
      simulation_test(wrong_options_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
