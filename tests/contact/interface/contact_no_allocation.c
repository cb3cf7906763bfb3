/* ranks: 1 2 */
/* long: 2 */
/* Bodies in two and three dimensions that fly and touch allocate nothing in a controller step in which no rows are built again; they may
   follow the surfaces. PETSc's allocator is replaced by one that counts, and on one rank the C library's too: on several, MPI takes memory
   for messages. */
#include "simulation.h"
#include "count_allocations.h"
#include <impakt/private/contactimpl.h>

/* On one rank each of PETSc's allocations is one of the C library's */
static long all_allocations(void)
{
  PetscMPIInt size;

  (void)MPI_Comm_size(PETSC_COMM_WORLD, &size);
#if defined(__SANITIZE_ADDRESS__)
  size = 2; /* the C library's are not counted */
#endif
  return size == 1 ? allocations : petsc_allocations;
}

/* Where factors are made anew, PETSc takes memory for itself */
static PetscLogEvent set_up;
static long          set_ups;

static PetscErrorCode event_begins(PetscLogEvent event, int unused, PetscObject a, PetscObject b, PetscObject c, PetscObject d)
{
  (void)unused, (void)a, (void)b, (void)c, (void)d;
  set_ups += event == set_up;
  return PETSC_SUCCESS;
}

static PetscErrorCode event_ends(PetscLogEvent event, int unused, PetscObject a, PetscObject b, PetscObject c, PetscObject d)
{
  (void)event, (void)unused, (void)a, (void)b, (void)c, (void)d;
  return PETSC_SUCCESS;
}

/* Two blocks with other elements each, 4 mm apart; the waves of an impact at 0.2 m/s run at 1.1 m/s, and come back to the faces after 1.8 s
 */
#define BLOCK "-dm_plex_simplex 0 -density 1 -youngs_modulus 1 -poissons_ratio 0.25 "
static const char *const blocks[] = {
    "-prefix_push a_ -dm_plex_dim 2 " BLOCK
    "-dm_plex_box_faces 10,4 -dm_plex_box_lower -1.004,0 -dm_plex_box_upper -0.004,0.4 -initial_velocity 0.1,0 -prefix_pop "
    "-prefix_push b_ -dm_plex_dim 2 " BLOCK
    "-dm_plex_box_faces 8,3 -dm_plex_box_lower 0.004,0 -dm_plex_box_upper 1.004,0.4 -initial_velocity -0.1,0 -prefix_pop ",
    "-prefix_push a_ -dm_plex_dim 3 " BLOCK
    "-dm_plex_box_faces 8,3,3 -dm_plex_box_lower -1.004,0,0 -dm_plex_box_upper -0.004,0.4,0.4 -initial_velocity 0.1,0,0 -prefix_pop "
    "-prefix_push b_ -dm_plex_dim 3 " BLOCK
    "-dm_plex_box_faces 6,2,2 -dm_plex_box_lower 0.004,0,0 -dm_plex_box_upper 1.004,0.4,0.4 -initial_velocity -0.1,0,0 -prefix_pop "};

#define IMPLICIT "-a_ts_type alpha2 -b_ts_type alpha2 -b_ts_time_step 0.01 "
#define EXPLICIT "-a_ts_type centraldifference -b_ts_type centraldifference -b_ts_time_step 0.01 "
#define MIXED    "-a_ts_type alpha2 -b_ts_type centraldifference -b_ts_time_step 0.005 "

/* The blocks touch in the fifth step; rows are built again before. In the first step PETSc's solvers make their work vectors, and again in
 * the first ones in contact. */
#define FREE_STEP 2
#define SETTLED   15
#define STEPS     22

typedef struct {
  long     free, touching; /* allocations in free flight, and in contact */
  long     factors;        /* preconditioners that were set up in the steps in contact */
  PetscInt steps, follow;  /* those steps, and the ones of them in which rows have followed the surfaces */
} Counted;

static PetscBool any_follows(Contact contact)
{
  PetscBool any = PETSC_FALSE;

  for (PetscInt i = 0; i < contact->rows.n; i++) any = (PetscBool)(any || contact->rows.followed[i]);
  ok(ContactOr(contact, &any));
  return any;
}

static void count_step(Simulation *simulation, PetscReal *values[], ContactPairState *state)
{
  *state = Step(simulation);
  for (PetscInt b = 0; b < simulation->n_bodies; b++) {
    BodyMeasures measures;

    ok(BodyGetMeasures(simulation->bodies[b], &measures));
    ok(ContactGetFields(simulation->contact, b, values[b]));
  }
}

static Counted count(Simulation *simulation, PetscInt dim, const char integrators[], const char method[])
{
  Counted    counted = {0};
  PetscReal *values[2];

  AddOptions("-bodies a,b -contact_pairs a.xmax:b.xmin -time_step 0.01 -time_end 1 -progress false");
  AddOptions(blocks[dim - 2]);
  AddOptions(integrators);
  SimulationRepeat(simulation, method);
  for (PetscInt b = 0; b < 2; b++) {
    PetscInt n;
    Vec      positions;

    ok(BodyGetReferencePositions(simulation->bodies[b], &positions));
    ok(VecGetLocalSize(positions, &n));
    ok(PetscMalloc1(CONTACT_FIELDS_SIZE * (n / dim), &values[b]));
  }
  for (PetscInt step = 1; step <= STEPS; step++) {
    const long       before = all_allocations(), set_ups_before = set_ups;
    ContactPairState state;
    ContactCounts    counts[2];

    ok(ContactGetCounts(simulation->contact, &counts[0]));
    count_step(simulation, values, &state);
    ok(ContactGetCounts(simulation->contact, &counts[1]));
    if (step == FREE_STEP) {
      assert_int_equal(state.active, 0);
      counted.free = all_allocations() - before;
    }
    if (step < SETTLED) continue;
    assert_true(state.active > 0 && state.force > 0);
    assert_int_equal(counts[1].rebuilds, counts[0].rebuilds);
    assert_int_equal(counts[1].set_changes, counts[0].set_changes);
    counted.touching += all_allocations() - before;
    counted.factors += set_ups - set_ups_before;
    counted.follow += any_follows(simulation->contact);
    counted.steps++;
  }
  for (PetscInt b = 0; b < 2; b++) ok(PetscFree(values[b]));
  assert_true(allocations + petsc_allocations > 1000); /* both are counted */
  return counted;
}

/* Every pairing of integrators in the plane or in space */
static const struct {
  PetscInt    dim;
  const char *integrators;
} cases[] = {{2, IMPLICIT}, {3, EXPLICIT}, {2, MIXED}, {3, IMPLICIT}, {2, EXPLICIT}, {3, MIXED}};

static void expect_nothing_in(Simulation *simulation, PetscInt dim, const char integrators[], const char method[])
{
  const Counted counted = count(simulation, dim, integrators, method);

  if (counted.free || counted.touching)
    print_error("%d dimensions, %s%s: %ld allocations in free flight, %ld in contact\n", (int)dim, integrators, method, counted.free,
                counted.touching);
  assert_int_equal(counted.free, 0);
  assert_int_equal(counted.touching, 0);
}

/* In the first `n` cases */
static void expect_nothing(Simulation *simulation, int n, const char method[])
{
  for (int i = 0; i < n; i++) expect_nothing_in(simulation, cases[i].dim, cases[i].integrators, method);
}

static void schwarz(void **state)
{
  expect_nothing((Simulation *)*state, 6, "");
}

static void gap_rate(void **state)
{
  expect_nothing((Simulation *)*state, 3, "-contact_constraint gap_rate");
}

static void penalty(void **state)
{
  expect_nothing((Simulation *)*state, 6, "-contact_type penalty");
}

static void augmented_lagrangian(void **state)
{
  expect_nothing((Simulation *)*state, 3, "-contact_type augmented_lagrangian");
}

/* Forward increments need mass on the contact nodes */
static void forward_lagrange(void **state)
{
  for (PetscInt dim = 2; dim <= 3; dim++)
    expect_nothing_in((Simulation *)*state, dim, EXPLICIT, "-contact_type lagrange -a_mass_redistribute 0 -b_mass_redistribute 0");
}

/* Without lateral contraction blocks that meet head on do not slip, and their rows stay as they are */
#define NONLINEAR "-a_material_type neo_hookean -b_material_type neo_hookean -a_poissons_ratio 0 -b_poissons_ratio 0"

/* What PETSc may allocate where factors are made anew: MatLUFactorNumeric() takes four work arrays for that, and
   MatSetOptionsPrefixFactor() one for a name. On several ranks, where PCREDUNDANT is set up around the factors, PETSc's assembly and the
   collection of the matrix take more: 15 to 22. */
static void expect_little(const Counted *counted, long more)
{
  PetscMPIInt size;

  ok(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  between(counted->touching, 0, size == 1 ? 5 * counted->factors : more + 24 * counted->factors);
}

/* Layers of nonlinear bodies have new factors where a balance is slow */
static void nonlinear_explicit_bodies(void **state)
{
  for (PetscInt dim = 2; dim <= 3; dim++) {
    const Counted counted = count((Simulation *)*state, dim, EXPLICIT, NONLINEAR);

    assert_int_equal(counted.free, 0);
    expect_little(&counted, 0);
  }
}

/* Of the blocks one slides along the other: rows of nonlinear bodies follow it in each step, and have new values. It slides by 1/100 of a
   face in all, after which no rows are built again. */
#define SLIDING "-a_material_type neo_hookean -b_material_type neo_hookean -a_poissons_ratio 0.25 -b_poissons_ratio 0.25 "

static void rows_that_follow(void **state)
{
  const char *const slides[]  = {"-a_initial_velocity 0.05,0.005 -b_initial_velocity -0.05,0 ",
                                 "-a_initial_velocity 0.05,0.005,0.002 -b_initial_velocity -0.05,0,0 "};
  const char *const methods[] = {"", "-contact_type penalty", "-contact_energy_cap 0"};

  for (int i = 0; i < 3; i++) {
    char    text[512];
    Counted counted;

    ok(PetscSNPrintf(text, sizeof(text), SLIDING "%s%s", slides[i % 2], methods[i]));
    counted = count((Simulation *)*state, 2 + i % 2, EXPLICIT, text);
    assert_int_equal(counted.follow, counted.steps);
    /* after each assembly of a matrix on several ranks MatGetRow() takes room for a row, two arrays: of the rows of both bodies, and of
       their layers */
    expect_little(&counted, 4 * counted.steps);
  }
}

/* The one contact step, of nodes with mass. Each step has another dense matrix, for whose factors PETSc takes new memory and two names, and
   PetscFPTrapPush() takes some in the factorization and in each solution.
   Many rows of explicit bodies have a sparse S, which takes none, but for the norms of the vectors of GMRES that are used for the first
   time. */
#define KEPT    "-contact_type force -a_mass_redistribute 0 -b_mass_redistribute 0 "
#define MANY    "-a_dm_plex_box_faces 8,8,8 -b_dm_plex_box_faces 6,7,6 "
#define FACTORS 4 /* for the factors in a step */
#define SOLVES  2 /* with them, the second of which finds that the term of dependent rows is nothing */
#define VECTORS 5

static void contact_step(void **state)
{
  const char *const laws[] = {"", "-contact_law coulomb -contact_friction 0.3"};

  for (int i = 0; i < 6; i++) {
    const Counted counted = count((Simulation *)*state, cases[i].dim, cases[i].integrators, KEPT);

    assert_int_equal(counted.free, 0);
    between(counted.touching, 0, (FACTORS + SOLVES) * counted.steps);
  }
  for (int i = 0; i < 2; i++) {
    char    text[512];
    Counted counted;

    ok(PetscSNPrintf(text, sizeof(text), KEPT MANY "%s", laws[i]));
    counted = count((Simulation *)*state, 3, EXPLICIT, text);
    assert_int_equal(counted.free, 0);
    between(counted.touching, 0, VECTORS);
  }
}

static int begin(void **state)
{
  (void)state;
  count_petsc_allocations(PETSC_TRUE);
  ok(PCInitializePackage());
  ok(PetscLogEventGetId("PCSetUp", &set_up));
  assert_true(set_up >= 0);
  ok(PetscLogLegacyCallbacksBegin(event_begins, event_ends, NULL, NULL));
  return 0;
}

static int end(void **state)
{
  (void)state;
  count_petsc_allocations(PETSC_FALSE);
  return 0;
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(schwarz),          simulation_test(gap_rate),
      simulation_test(penalty),          simulation_test(augmented_lagrangian),
      simulation_test(forward_lagrange), simulation_test(nonlinear_explicit_bodies),
      simulation_test(rows_that_follow), simulation_test(contact_step),
  };
  int failed;

  if (ImpaktInitialize(&argc, &argv)) return 1;
  failed = _cmocka_run_group_tests("no_allocation_in_contact", tests, sizeof(tests) / sizeof(tests[0]), begin, end);
  if (ImpaktFinalize()) return 1;
  return failed;
}
