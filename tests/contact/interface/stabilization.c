/* -contact_stabilization: naive, and contact-stabilised Newmark. */
#include "simulation.h"

static const char lumped[] = "-left_mass_redistribute 0 -right_mass_redistribute 0 -left_mass_type lumped -right_mass_type lumped";

/* Acceleration of the contact node of a body */
static PetscReal ContactAcceleration(Simulation *simulation, PetscInt b)
{
  PetscScalar *values;
  PetscReal    sum = 0;
  PetscInt     size, levels;
  BodyTraces   traces;

  ok(BodyGetTraces(simulation->bodies[b], &traces));
  ok(TraceGetSizes(traces.acceleration, &size, &levels));
  ok(TraceGetLevel(traces.acceleration, levels, &values));
  for (PetscInt i = 0; i < size; i++) sum += values[i];
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  return sum;
}

/* After a step in contact its nodes have no acceleration, also in the state from which the next step starts */
static void naive(void **state)
{
  static const char *const methods[]  = {"-contact_type schwarz", "-contact_type penalty", "-contact_type lagrange",
                                         "-contact_type augmented_lagrangian"};
  Simulation              *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions(lumped);
  AddOptions("-contact_penalty 500 -contact_augmentation_max_it 10000");
  /* multipliers at the end of the step gain energy where both sides have mass; here only accelerations count */
  AddOptions("-contact_allow_unstable true");
  for (PetscInt k = 0; k < 4; k++) {
    SimulationRepeat(simulation, methods[k]);
    AddOptions("-contact_stabilization none");
    SimulationRepeat(simulation, methods[k]);
    assert_true(Step(simulation).active > 0);
    assert_true(PetscAbsReal(ContactAcceleration(simulation, 1)) > 1e-3);
    AddOptions("-contact_stabilization naive");
    SimulationRepeat(simulation, methods[k]);
    for (PetscInt step = 0; step < 3; step++) {
      const PetscBool active = (PetscBool)(Step(simulation).active > 0);

      for (PetscInt b = 0; b < 2 && active; b++) {
        PetscReal end = b ? 1 : -1;
        Vec       a;

        near(ContactAcceleration(simulation, b), 0, 0);
        ok(BodyRestore(simulation->bodies[b]));
        ok(BodyGetSolution(simulation->bodies[b], NULL, NULL, &a));
        near(value_at(simulation->bodies[b], a, end * COLLISION_GAP / 2), 0, 0);
      }
    }
  }
}

/* The whole contact force of the end of the step acts over all of it: dt F_1, not dt/2 (F_0 + F_1). Gap closed, no energy gained. */
static void contact_stabilized(void **state)
{
  static const char *const masses[]   = {"-left_mass_type lumped -right_mass_type lumped",
                                         "-left_mass_type averaged -right_mass_type consistent"};
  Simulation              *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0.5);
  AddOptions("-contact_type lagrange -contact_stabilization contact_stabilized");
  AddOptions(lumped);
  for (PetscInt k = 0; k < 2; k++) {
    PetscReal energy;

    SimulationRepeat(simulation, masses[k]);
    energy = TotalEnergy(simulation);
    for (PetscInt step = 0; step < 8; step++) {
      const PetscReal  before[] = {Momentum(simulation, 0), Momentum(simulation, 1)};
      ContactPairState pair     = Step(simulation);

      assert_true(pair.gap > -1e-12);
      assert_true(pair.force >= 0);
      near(Momentum(simulation, 1) - before[1], COLLISION_STEP * pair.force, 1e-14);
      near(Momentum(simulation, 0) - before[0], -COLLISION_STEP * pair.force, 1e-14);
      assert_true(TotalEnergy(simulation) <= energy * (1 + 1e-12));
      energy = TotalEnergy(simulation);
    }
    assert_true(energy > 0);
  }
}

/*
   The first step by hand. Nodes of mass m, half an element h each, fly at v; the prediction penetrates by p = 2 v dt - gap, and is put
   back in the norm of the mass: by p m_2 / (m_1 + m_2) and p m_1 / (m_1 + m_2). The contact force then balances the mean internal
   force: nothing else moves the nodes that touch. With one element in each bar and equal bars the projected shift is p / 2, and the
   node would have strain p / (4 h) on average over the step, if the far node did not move: force p / (4 h), less O(dt^2 / h^2).
*/
static void first_step_by_hand(void **state)
{
  Simulation     *simulation = (Simulation *)*state;
  const PetscReal p = 2 * COLLISION_SPEED * COLLISION_STEP - COLLISION_GAP, h = 1 - COLLISION_GAP / 2, mass = h / 2;
  /* elongation over the step: from 0 to u_1 - w_1, contact node at gap/2, far node w_1 = v dt + dt^2/2 / mass * mean strain */
  const PetscReal moved = COLLISION_GAP / 2, free = COLLISION_SPEED * COLLISION_STEP, k = 0.5 * PetscSqr(COLLISION_STEP) / mass / h / 2;
  const PetscReal squeeze = (free - moved) / (1 + k); /* (w_1 - u_1) = free - moved - k (w_1 - u_1) */

  skip_beyond_ranks(1);
  AddCollision(1, 1, 0);
  AddOptions("-contact_type lagrange -contact_stabilization contact_stabilized");
  AddOptions(lumped);
  ok(SimulationCreate(simulation));
  near(p / 2, free - moved, 1e-15);
  near(Step(simulation).force, squeeze / h / 2,
       1e-11); /* mean of 0 and squeeze / h; 1e-12 m over dt^2 / (2 m), 4e-4 m/N, is 2e-9 at most */
}

static void wrong_options_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_stabilization naive");
  refused(PETSC_ERR_USER_INPUT, "-contact_stabilization naive|massless|-<body>_mass_redistribute false", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_stabilization contact_stabilized -right_mass_redistribute 0");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|-contact_type lagrange|schwarz", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_type lagrange");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|'left'|-left_mass_redistribute false", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions(lumped);
  AddOptions("-left_ts_time_step 0.01");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|'left' makes 2 substeps|-left_ts_time_step", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-left_ts_time_step 0.02 -left_ts_alpha_radius 0.8");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|trapezoidal|'left'|-left_ts_alpha_", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-left_ts_alpha_radius 1 -left_ts_type centraldifference");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|'left' is explicit|-left_ts_type alpha2", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-right_ts_type centraldifference");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|explicit|-<body>_ts_type alpha2", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_stabilization naive");
  refused(PETSC_ERR_USER_INPUT, "naive|forward-increment|-contact_type schwarz", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_stabilization contact_stabilized -left_ts_type alpha2 -right_ts_type alpha2 -contact_constraint both");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|-contact_constraint at gap", SimulationCreate(simulation));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(naive),
      simulation_test(contact_stabilized),
      simulation_test(first_step_by_hand),
      simulation_test(wrong_options_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
