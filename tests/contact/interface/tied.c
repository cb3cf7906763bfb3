/* Tied surfaces: two blocks as one, and tension; massless nodes that start in balance. */
#include "simulation.h"

#define MATERIAL "-dm_plex_dim 2 -dm_plex_simplex 0 -density 1 -youngs_modulus 3 -poissons_ratio 0.3 -ts_type static "

/* Sum over nodes of u_d times a function of the position: bodies that are dealt out in another way, or cut in two, can be compared by it.
   Nodes of the seam at x = 1 count half in each of the two. */
static void add_moments(Body body, PetscBool parts, PetscReal sums[4])
{
  const PetscScalar *x, *u;
  PetscReal          mine[4] = {0};
  Vec                positions, displacements;
  PetscInt           n;

  ok(BodyGetReferencePositions(body, &positions));
  ok(BodyGetSolution(body, &displacements, NULL, NULL));
  ok(VecGetLocalSize(positions, &n));
  ok(VecGetArrayRead(positions, &x));
  ok(VecGetArrayRead(displacements, &u));
  for (PetscInt i = 0; i < n; i += 2) {
    const PetscReal weight = parts && PetscAbsReal(x[i] - 1) < 1e-9 ? 0.5 : 1;

    mine[0] += weight * u[i];
    mine[1] += weight * u[i + 1];
    mine[2] += weight * u[i] * PetscSinReal(3 * x[i] + x[i + 1]);
    mine[3] += weight * u[i + 1] * PetscCosReal(x[i] + 2 * x[i + 1]);
  }
  ok(VecRestoreArrayRead(displacements, &u));
  ok(VecRestoreArrayRead(positions, &x));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, mine, 4, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  for (PetscInt k = 0; k < 4; k++) sums[k] += mine[k];
}

/* Held at x = 0, moved by 0.1 m and 0.05 m at x = 2 */
static void two_blocks_are_as_one(void **state)
{
  static const char *const ways[]     = {"-contact_type schwarz", "-schwarz_condense 0"};
  Simulation              *simulation = (Simulation *)*state;
  PetscReal                whole[4]   = {0};

  AddOptions("-prefix_push a_ " MATERIAL
             "-dm_plex_box_faces 8,4 -dm_plex_box_lower 0,0 -dm_plex_box_upper 2,1 -boundary_displacement xmin,xmax "
             "-boundary_displacement_xmin 0,0 -boundary_displacement_xmax 0.1,0.05 -prefix_pop -bodies a -time_step 1 -time_end 1");
  ok(SimulationCreate(simulation));
  ok(ContactStep(simulation->contact));
  add_moments(simulation->bodies[0], PETSC_FALSE, whole);
  assert_true(whole[0] > 0.1 && whole[1] > 0.1);
  for (size_t way = 0; way < sizeof(ways) / sizeof(ways[0]); way++) {
    PetscReal        parts[4] = {0};
    ContactPairState pair;

    ok(ControllerDestroy(&simulation->controller));
    options_drop(simulation->options);
    simulation->options = options_begin("");
    /* the one that would float without its partner takes displacements */
    AddOptions("-prefix_push a_ " MATERIAL "-dm_plex_box_faces 4,4 -dm_plex_box_lower 0,0 -dm_plex_box_upper 1,1 -boundary_displacement "
               "xmin -boundary_displacement_xmin 0,0 -prefix_pop "
               "-prefix_push b_ " MATERIAL "-dm_plex_box_faces 4,4 -dm_plex_box_lower 1,0 -dm_plex_box_upper 2,1 -boundary_displacement "
               "xmax -boundary_displacement_xmax 0.1,0.05 -prefix_pop "
               "-bodies a,b -contact_pairs b:a -contact_law tied -time_step 1 -time_end 1");
    SimulationRepeat(simulation, ways[way]);
    ok(ContactStep(simulation->contact));
    ok(ContactGetPairState(simulation->contact, 0, &pair));
    assert_int_equal(pair.active, 5);
    /* tension: about 3 Pa / (1 - 0.3^2) by 0.05, on a section of 1 m^2, and some 3 % by the ends, which cannot get thinner */
    between(pair.force_vector[0], 0.165, 0.175);
    near(pair.force, -pair.force_vector[0], 1e-14);
    for (PetscInt b = 0; b < 2; b++) add_moments(simulation->bodies[b], PETSC_TRUE, parts);
    for (PetscInt k = 0; k < 4; k++) near(parts[k], whole[k], 1e-10); /* some 10 sweeps of round-off of numbers of about 1 */
  }
}

#define STRETCHED                                                                                                                          \
  "-dm_plex_dim 2 -density 1 -youngs_modulus 3 -poissons_ratio 0.3 -mass_redistribute true -initial_displacement 0.01*x*x,0.02*x*y "

/* The program's own choice; the force of the first state is that which the first step goes on from, or there is none */
static void start_in_balance(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddOptions("-prefix_push a_ " STRETCHED "-dm_plex_box_faces 4,4 -dm_plex_box_lower 0,0 -dm_plex_box_upper 1,1 -prefix_pop "
             "-prefix_push b_ " STRETCHED "-dm_plex_box_faces 5,5 -dm_plex_box_lower 1,0 -dm_plex_box_upper 2,1 -prefix_pop "
             "-bodies a,b -contact_pairs b:a -contact_law tied -time_step 1e-3 -time_end 1e-2 -petscpartitioner_type simple");
  for (PetscInt balanced = 0; balanced < 2; balanced++) {
    ContactPairState start, end;
    PetscReal        before = 0, after = 0;
    PetscBool        is;
    PetscInt         n;
    const Body      *bodies;

    ok(ControllerDestroy(&simulation->controller));
    ok(ControllerCreate(PETSC_COMM_WORLD, &simulation->controller));
    ok(ControllerSetFromOptions(simulation->controller));
    ok(ControllerGetContact(simulation->controller, &simulation->contact));
    ok(ContactGetBalancedStart(simulation->contact, &is));
    assert_true(is);
    if (!balanced) ok(ContactSetBalancedStart(simulation->contact, PETSC_FALSE));
    ok(ControllerSetUp(simulation->controller));
    ok(ContactGetBalancedStart(simulation->contact, &is));
    assert_int_equal(is, balanced);
    refused(PETSC_ERR_ARG_WRONGSTATE, "before ContactSetUp()", ContactSetBalancedStart(simulation->contact, PETSC_TRUE));
    ok(ContactGetPairState(simulation->contact, 0, &start));
    ok(ControllerGetBodies(simulation->controller, &n, &bodies));
    for (PetscInt b = 0; b < n; b++) {
      PetscReal energy;

      ok(BodyComputeEnergy(bodies[b], &energy));
      before += energy;
    }
    ok(ContactStep(simulation->contact));
    ok(ContactGetPairState(simulation->contact, 0, &end));
    for (PetscInt b = 0; b < n; b++) {
      PetscReal energy;

      ok(BodyComputeEnergy(bodies[b], &energy));
      after += energy;
    }
    if (balanced) {
      near(start.force_vector[0], end.force_vector[0], 1e-3 * PetscAbsReal(end.force_vector[0])); /* a step of 1/140 of a transit */
      near(after, before, 1e-12 * before);
      assert_int_equal(start.active, end.active);
    } else {
      near(start.force_vector[0], 0, 0);
      assert_true(after < before * (1 - 1e-4));
    }
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {simulation_test(two_blocks_are_as_one), simulation_test(start_in_balance)};

  return impakt_main(argc, argv, tests);
}
