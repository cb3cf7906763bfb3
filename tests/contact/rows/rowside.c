/* ranks: 1 3 */
/* long: 3 */
/* Which body of a pair has the contact rows, and that nobody who reads names, forces and normals need know. */
#include "simulation.h"

#define STEPS 12

/* Two blocks that fly at each other aslant, in two or three dimensions; the second has the finer mesh */
static void AddBlocks(PetscInt dim)
{
  AddOptions(dim == 2
                 ? "-a_dm_plex_box_faces 3,3 -b_dm_plex_box_faces 4,5 -a_dm_plex_box_upper 1,1 -b_dm_plex_box_lower 1.01,0.2 "
                   "-b_dm_plex_box_upper 2.01,1.3 -a_initial_velocity 0.1,0.01"
                 : "-a_dm_plex_box_faces 2,2,2 -b_dm_plex_box_faces 2,3,3 -a_dm_plex_box_upper 1,1,1 -b_dm_plex_box_lower 1.01,0.2,0.1 "
                   "-b_dm_plex_box_upper 2.01,1.2,0.9 -a_initial_velocity 0.1,0.01,0.02");
  AddOptions(dim == 2 ? "-a_dm_plex_dim 2 -b_dm_plex_dim 2" : "-a_dm_plex_dim 3 -b_dm_plex_dim 3");
  AddOptions("-all_mass_redistribute true -a_dm_plex_simplex 0 -b_dm_plex_simplex 0 -a_density 1 -b_density 1 -a_youngs_modulus 1 "
             "-b_youngs_modulus 1 "
             "-a_poissons_ratio 0.3 -b_poissons_ratio 0.3 -bodies a,b -time_step 0.05 -time_end 1");
}

/* Names and normal of the pair, its state after some steps in contact, and the momentum of body b */
typedef struct {
  PetscInt         side;
  PetscReal        normal[3], momentum[3];
  ContactPairState pair;
} Answer;

static void Run(Simulation *simulation, const char options[], const char name[], Answer *answer)
{
  BodyMeasures measures;
  const char  *found;
  Body         first, second;
  PetscInt     swapped = name[0] == 'b';

  SimulationRepeat(simulation, options);
  ok(ContactGetPair(simulation->contact, 0, &found, &first, &second));
  assert_string_equal(found, name);
  assert_ptr_equal(first, simulation->bodies[swapped]);
  assert_ptr_equal(second, simulation->bodies[1 - swapped]);
  ok(ContactGetPairRowSide(simulation->contact, 0, &answer->side));
  ok(ContactGetPairTraits(simulation->contact, 0, NULL, NULL, answer->normal));
  for (PetscInt step = 0; step < STEPS; step++) answer->pair = Step(simulation);
  assert_true(answer->pair.active > 0 && answer->pair.force > 0);
  ok(BodyGetMeasures(simulation->bodies[1], &measures));
  ok(PetscArraycpy(answer->momentum, measures.momentum, 3));
}

/* To the last bit what the other order gives, or to round-off where ranks add in the order in which messages come; signs alone follow the
   names, which are not in the same order. */
static void check_same(const Answer *a, const Answer *b)
{
  const PetscReal sign = -1;
  PetscMPIInt     ranks;
  PetscReal       off;

  ok(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  off = ranks > 1 ? 1e-12 : 0;
  near(a->pair.force, b->pair.force, off);
  near(a->pair.gap, b->pair.gap, off);
  near(a->pair.area, b->pair.area, off);
  near(a->pair.normal_impulse, b->pair.normal_impulse, off);
  assert_int_equal(a->pair.active, b->pair.active);
  for (PetscInt d = 0; d < 3; d++) {
    near(a->normal[d], sign * b->normal[d], off);
    near(a->pair.force_vector[d], sign * b->pair.force_vector[d], off);
    near(a->pair.moment[d], sign * b->pair.moment[d], off);
    near(a->pair.impulse[d], sign * b->pair.impulse[d], off);
    near(a->momentum[d], b->momentum[d], off);
  }
}

static void check_sides(Simulation *simulation, PetscInt dim, const char more[])
{
  Answer first, second, other, coarser;

  AddBlocks(dim);
  AddOptions(more);
  Run(simulation, "-contact_pairs a:b -contact_rows first", "a:b", &first);
  Run(simulation, "-contact_rows second", "a:b", &second);
  Run(simulation, "-contact_pairs b:a -contact_rows first", "b:a", &other);
  Run(simulation, "-contact_rows second", "b:a", &coarser);
  assert_int_equal(first.side, 0);
  assert_int_equal(second.side, 1);
  assert_int_equal(other.side, 0);
  assert_int_equal(coarser.side, 1);
  check_same(&second, &other);
  check_same(&first, &coarser);
  between(first.normal[0], 0.9, 1); /* outward of a */
  between(second.normal[0], 0.9, 1);
  assert_true(first.pair.force_vector[0] > 0 && second.pair.force_vector[0] > 0);             /* on b */
  for (PetscInt d = 0; d < dim; d++) near(second.pair.impulse[d], second.momentum[d], 1e-12); /* b was at rest */
  assert_true(first.pair.force != second.pair.force);
  ok(ControllerDestroy(&simulation->controller));
  options_drop(simulation->options);
  simulation->options = options_begin("");
}

static void names_hold_whoever_has_the_rows(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  check_sides(simulation, 2, "-b_ts_type centraldifference -b_ts_time_step 0.0125");
  check_sides(simulation, 2, "-contact_type penalty");
  check_sides(simulation, 3, "-a_ts_type centraldifference -b_ts_type centraldifference");
}

static void AddBox(const char name[], const char faces[], const char lower[], const char upper[])
{
  char options[512];

  ok(PetscSNPrintf(options, sizeof(options),
                   "-prefix_push %s_ -dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces %s -dm_plex_box_lower %s -dm_plex_box_upper %s "
                   "-density 1 -youngs_modulus 1 -mass_redistribute true -prefix_pop",
                   name, faces, lower, upper));
  AddOptions(options);
}

static void check_rows(Simulation *simulation, PetscInt n, const PetscInt rows[])
{
  for (PetscInt p = 0; p < n; p++) {
    PetscInt found;

    ok(ContactGetPairRowSide(simulation->contact, p, &found));
    assert_int_equal(found, rows[p]);
  }
}

/* Each pair has a side of its own, and circles that come of that are refused where bodies wait for each other */
static void pairs_have_sides_of_their_own(void **state)
{
  static const PetscInt rows[]     = {0, 1, 1};
  Simulation           *simulation = (Simulation *)*state;

  AddBox("a", "1,4", "0,0", "1,1"); /* fine at x = 1, coarse at y = 1 */
  AddBox("b", "3,2", "1.01,0", "2.01,1");
  AddBox("c", "3,2", "0,1.01", "2.01,2.01");
  AddOptions("-bodies a,b,c -time_step 0.01 -time_end 0.1 -contact_pairs a.ymax:c.ymin,b.ymax:c.ymin,b.xmin:a.xmax -contact_rows "
             "first,second,second -contact_type alternation");
  ok(SimulationCreate(simulation));
  check_rows(simulation, 3, rows);
  ok(ContactStep(simulation->contact));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_pairs a.ymax:c.ymin,a.xmax:b.xmin,b.ymax:c.ymin -contact_rows second,first,first");
  refused(PETSC_ERR_USER_INPUT, "circle|-contact_rows", SimulationCreate(simulation));
}

static void bad_sides_are_refused(void **state)
{
  static const struct {
    const char *options, *words;
  } cases[] = {
      {"-contact_rows third", "third|first, second"},
      {"-contact_rows first,second", "2 values for 1 pair"},
      {"-obstacles floor -floor_obstacle_type plane -floor_point 0,-1 -floor_normal 0,1 -contact_pairs a:b,a:floor -contact_rows "
       "first,second",
       "a:floor|obstacle"},
      {"-contact_rows second -contact_swap_sides", "swap_sides|a:b|contact_rows"},
      {"-contact_type alternation -contact_rows second -b_boundary_displacement xmin -b_boundary_displacement_xmin 0,0",
       "a:b|body 'b'|contact_rows first"},
  };
  Simulation *simulation = (Simulation *)*state;

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    AddBox("a", "3,3", "0,0", "1,1");
    AddBox("b", "3,3", "2,0", "3,1");
    AddOptions("-bodies a,b -contact_pairs a:b -time_step 0.01 -time_end 0.1");
    AddOptions(cases[i].options);
    refused(PETSC_ERR_USER_INPUT, cases[i].words, SimulationCreate(simulation));
    ok(ControllerDestroy(&simulation->controller));
    options_drop(simulation->options);
    simulation->options = options_begin("");
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(names_hold_whoever_has_the_rows),
      simulation_test(pairs_have_sides_of_their_own),
      simulation_test(bad_sides_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
