/* ranks: 1 3 */
/* long: 3 */
/* The Schwarz alternating method: one controller step in which two bars hit each other, what ends contact, and what is refused. */
#include "simulation.h"

#define TOLERANCE "-schwarz_snes_atol 1e-12" /* [m] */

/* Two bars that hit each other, by the alternation */
static void AddAlternation(PetscInt left, PetscInt right, PetscReal damping)
{
  AddCollision(left, right, damping);
  AddOptions("-contact_type alternation");
}

/*
   The step that ends in contact: the gap is closed to the tolerance of the iteration, and what the force does to one bar it does
   to the other, reversed. Newmark's rule with gamma = 1/2 changes the momentum by dt/2 (F_0 + F_1), and there was no force before.
*/
static void CheckFirstStep(Simulation *simulation, PetscReal *force)
{
  const PetscReal  before[] = {Momentum(simulation, 0), Momentum(simulation, 1)};
  ContactPairState pair     = Step(simulation);

  assert_int_equal(pair.active, 1);
  assert_true(pair.force > 0);
  near(pair.gap, 0, 1e-12);
  near(pair.tension, 0, 0);
  /* the gap may be off by 1e-12 m, the layer of stiffness 8 N/m and more that it acts on carries that into the force */
  near(Momentum(simulation, 1) - before[1], 0.5 * COLLISION_STEP * pair.force, 1e-12);
  near(Momentum(simulation, 0) - before[0], -0.5 * COLLISION_STEP * pair.force, 1e-12);
  *force = pair.force;
}

static void all_pairings_of_integrators(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const types[]    = {"-left_ts_type alpha2 -right_ts_type alpha2", "-left_ts_type alpha2 -right_ts_type centraldifference",
                                  "-left_ts_type centraldifference -right_ts_type alpha2",
                                  "-left_ts_type centraldifference -right_ts_type centraldifference"};

  AddAlternation(8, 10, 0);
  AddOptions(TOLERANCE);
  for (PetscInt i = 0; i < 4; i++) {
    PetscReal force;

    SimulationRepeat(simulation, types[i]);
    CheckFirstStep(simulation, &force);
  }
}

/* One solution, however it is found */
static void all_types_of_outer_iteration(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const types[]    = {"-schwarz_snes_type anderson", "-schwarz_snes_type nrichardson -schwarz_snes_linesearch_damping 0.5",
                                  "-schwarz_snes_type nrichardson -schwarz_relaxation aitken",
                                  "-schwarz_snes_type ngmres -schwarz_relaxation fixed", "-schwarz_snes_type qn"};
  PetscReal         force[5];

  AddAlternation(8, 10, 0);
  AddOptions(TOLERANCE);
  for (PetscInt i = 0; i < 5; i++) {
    SimulationRepeat(simulation, types[i]);
    CheckFirstStep(simulation, &force[i]);
    near(force[i], force[0], 1e-9 * force[0]); /* 1e-12 m on layers of about 10 N/m, against some mN */
  }
}

static void unconverged_steps(void **state)
{
  Simulation   *simulation = (Simulation *)*state;
  ContactCounts counts;

  AddAlternation(8, 13, 50);
  AddOptions(TOLERANCE);
  AddOptions("-time_start 1 -time_end 1.2 -schwarz_snes_type nrichardson -schwarz_snes_linesearch_damping 0.5 -schwarz_snes_max_it 1");
  ok(SimulationCreate(simulation));
  /* one iteration is one sweep beyond the first, which found the residual that it began with */
  refused(PETSC_ERR_NOT_CONVERGED,
          "time 1.02 s|after 2 sweeps|change of position is |absolute tolerance 1e-12 m|DIVERGED_MAX_IT|-schwarz_unconverged accept",
          ContactStep(simulation->contact));
  SimulationRepeat(simulation, "-schwarz_unconverged accept");
  for (PetscInt step = 1; step <= 2; step++) {
    Step(simulation);
    ok(ContactGetCounts(simulation->contact, &counts));
    assert_int_equal(counts.unconverged_steps, step);
    assert_int_equal(counts.sweeps, 2);
    assert_int_equal(counts.total_sweeps, 2 * step);
  }
}

/*
   Bars of 0.1 m: the wave is back after 0.2 s, ten controller steps, and then pulls. A node that is pulled lets go in that
   step, and no force is ever tensile.
*/
static void pulled_pairs_let_go(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscInt    contact    = 0;
  PetscReal   gap        = 0;

  AddAlternation(4, 4, 0);
  AddOptions("-left_dm_plex_box_lower -0.101 -right_dm_plex_box_upper 0.101");
  ok(SimulationCreate(simulation));
  for (PetscInt step = 0; step < 20; step++) {
    ContactPairState pair = Step(simulation);

    if (pair.active) contact++;
    assert_false(pair.tension > 0);
    /* a contact that is held has no gap, and no step ends in penetration */
    if (pair.active) near(pair.gap, 0, 1e-12);
    else near(pair.force, 0, 0);
    assert_true(pair.gap > -1e-12);
    gap = pair.gap;
  }
  between(contact, 8, 13); /* 10, but for what four elements do to the wave front */
  /* at the end they fly apart as fast as they came, since 20 steps less 1/2 before impact and 10 in contact: 9 steps at least */
  assert_true(gap > 0.5 * 9 * COLLISION_STEP * 2 * COLLISION_SPEED);
}

/* Nodes with mass, and the force that really holds them. In the step of the impact they take over the velocity of the partner,
   an impulse that no force shows; from then on momentum is conserved. */
static void reaction_of_nodes_with_mass(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscReal   momentum   = 0;

  AddAlternation(8, 10, 0);
  AddOptions("-left_mass_redistribute 0 -right_mass_redistribute 0 -schwarz_traction reaction");
  ok(SimulationCreate(simulation));
  for (PetscInt step = 0; step < 3; step++) {
    ContactPairState pair = Step(simulation);

    assert_int_equal(pair.active, 1);
    near(pair.gap, 0, 1e-12);
    if (step) near(TotalMomentum(simulation), momentum, 1e-11); /* 2e-12 m in a^n = 4 u/dt^2 on a node of 0.06 kg, times dt */
    momentum = TotalMomentum(simulation);
  }
}

static void reaction_needs_an_implicit_partner(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddAlternation(8, 10, 0);
  AddOptions("-left_mass_redistribute 0 -right_mass_redistribute 0 -schwarz_traction reaction -right_ts_type centraldifference");
  refused(PETSC_ERR_USER_INPUT, "-schwarz_traction reaction|'left' have mass|'right' must be implicit", SimulationCreate(simulation));
}

static void wrong_options_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddAlternation(8, 10, 0);
  AddOptions("-schwarz_relaxation aitken");
  refused(PETSC_ERR_USER_INPUT, "aitken|nrichardson only", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-schwarz_relaxation fixed -schwarz_snes_type newtontr");
  refused(PETSC_ERR_USER_INPUT, "-schwarz_snes_type newtontr|choose anderson, nrichardson, ngmres or qn", SimulationCreate(simulation));
}

static void transmission_wrong_options_are_refused(void **state)
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
    AddAlternation(8, 10, 0);
    AddOptions(cases[i].options);
    refused(cases[i].code, cases[i].words, SimulationCreate(simulation));
  }
}

/* Two blocks that do not match, 0.01 m apart at one end and 0.03 m at the other, 1 kg/m^3 and 1 Pa: waves run at some 1.1 m/s, and cross an
   element in 0.15 s. The corner of the first carries a traction beside its contact force: what its partner feels is the latter alone,
   however it is found. */
static void a_traction_on_a_contact_node_is_not_handed_on(void **state)
{
  static const char *const cases[]    = {"-a_ts_type alpha2 -b_ts_type alpha2 -b_ts_time_step 0.04",
                                         "-b_ts_type centraldifference -b_ts_time_step 0.01",
                                         "-a_ts_type centraldifference -a_ts_time_step 0.01 -b_ts_type alpha2 -b_ts_time_step 0.04",
                                         "-a_ts_time_step 0.02 -b_ts_type centraldifference -b_ts_time_step 0.01"};
  Simulation              *simulation = (Simulation *)*state;

  AddOptions("-contact_type alternation -prefix_push a_ -dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 4,5 -dm_plex_box_lower -1,0 "
             "-dm_plex_box_upper "
             "-0.01,1.1 -density 1 -youngs_modulus 1 -poissons_ratio 0.25 -initial_velocity 0.1,0.02*x -boundary_traction ymax "
             "-boundary_traction_ymax 0.05,0 -ts_time_step 0.04 -prefix_pop "
             "-prefix_push b_ -dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 3,4 -dm_plex_box_lower 0,0.1 -dm_plex_box_upper 1,1.2 "
             "-density 1 -youngs_modulus 1 -poissons_ratio 0.25 -initial_velocity -0.1,0 -prefix_pop "
             "-bodies a,b -contact_pairs a:b -time_step 0.04 -time_end 1 ");
  for (PetscInt k = 0; k < 4; k++) {
    ContactPairState pairs[25];
    PetscReal        energy[25];
    PetscInt         most = 0;

    AddOptions(cases[k]);
    for (PetscInt way = 0; way < 2; way++) {
      SimulationRepeat(simulation, way ? "-schwarz_traction reaction" : "-schwarz_traction internal");
      for (PetscInt step = 0; step < 25; step++) {
        const ContactPairState pair = Step(simulation);

        if (!way) {
          pairs[step]  = pair;
          energy[step] = TotalEnergy(simulation);
          most         = PetscMax(most, pair.active);
        }
        /* forces of some 0.1 N, lengths of some m, energies of some 0.01 J */
        assert_int_equal(pair.active, pairs[step].active);
        near(pair.force, pairs[step].force, 1e-10);
        near(pair.gap, pairs[step].gap, 1e-10);
        near(TotalEnergy(simulation), energy[step], 1e-10);
      }
    }
    assert_true(most >= 3);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(all_pairings_of_integrators),
      simulation_test(all_types_of_outer_iteration),
      simulation_test(unconverged_steps),
      simulation_test(pulled_pairs_let_go),
      simulation_test(reaction_of_nodes_with_mass),
      simulation_test(reaction_needs_an_implicit_partner),
      simulation_test(wrong_options_are_refused),
      simulation_test(transmission_wrong_options_are_refused),
      simulation_test(a_traction_on_a_contact_node_is_not_handed_on),
  };

  return impakt_main(argc, argv, tests);
}
