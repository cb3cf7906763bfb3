/* Glue that breaks, by the answer of one node to a gap: what the law says of loading, unloading, failure, and compression, and what
   breaking takes. Numbers of the law: k = 100 N/m^3, s = 2 Pa, G = 1 J/m^2, so that damage begins at 0.02 m and nothing is left at 1 m. */
#include "support.h"
#include <contact/laws/rowlaw.h>
#include <contact/solve/lawimpl.h>
#include <impakt/contact.h>

#define K     100.0
#define S     2.0
#define G     1.0
#define BEGIN (S / K)
#define FAILS (2 * G / S)
#define AREA  0.5
#define CLOSE 1e-12
#define STEP  1e-7 /* of differences of numbers of size 1 to 100: cuts 1e-12, and divides round-off of 1e-14 to 1e-7 */

static const PetscReal parameters[] = {K, S, G};

/* A node whose first row is along the normal; r is beyond the slope of the law, as LawProblem has it */
static RowLawGlue Node(PetscReal r, PetscReal damage, PetscReal least)
{
  const RowLawGlue node = {
      .times = 1, .r = r * AREA, .area = AREA, .normal = {1}, .least = least, .history = {damage}, .parameters = parameters};

  return node;
}

/* The traction of a gap by the law's own words, from the damage that it leaves; what is held by contact has none along the normal here */
static PetscReal Traction(PetscReal damage, PetscReal gap)
{
  return (1 - damage) * K * gap;
}

static PetscReal Envelope(PetscReal opening)
{
  return opening < BEGIN ? K * opening : opening < FAILS ? S * (FAILS - opening) / (FAILS - BEGIN) : 0;
}

static PetscReal Damage(PetscReal damage, PetscInt n, const PetscReal gap[])
{
  const RowLawGlue node  = Node(1, damage, 0);
  PetscReal        grown = damage;

  RowLawCohesive.grow(n, &node, gap, &grown);
  return grown;
}

/* The force that goes with a gap is found from its trial force, with any r */
static void CheckForce(PetscReal damage, PetscInt n, const PetscReal gap[])
{
  const PetscReal weights[] = {3, 50, 1e5}, grown = Damage(damage, n, gap);

  for (size_t w = 0; w < PETSC_STATIC_ARRAY_LENGTH(weights); w++) {
    const RowLawGlue node = Node(weights[w], damage, -10);
    PetscReal        p[ROW_LAW_ROWS], force[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];

    for (PetscInt i = 0; i < n; i++) p[i] = -AREA * (Traction(grown, gap[i]) + weights[w] * gap[i]);
    RowLawCohesive.project(n, NULL, &node, p, force, derivative);
    for (PetscInt i = 0; i < n; i++) near(force[i], -AREA * Traction(grown, gap[i]), CLOSE * (1 + weights[w]));
  }
}

static void loading_follows_the_two_lines(void **state)
{
  (void)state;
  for (PetscInt k = 1; k < 150; k++) {
    const PetscReal gap[] = {0.01 * k, 0, 0}, damage = Damage(0, 1, gap);

    near(Traction(damage, gap[0]), Envelope(gap[0]), CLOSE);
    for (PetscInt n = 1; n <= 3; n++) CheckForce(0, n, gap);
  }
  near(RowLawCohesive.stiffness(parameters, (PetscReal[]){0.25}), 75, CLOSE);
  near(RowLawCohesive.softening(parameters), S / (FAILS - BEGIN), CLOSE);
}

/* Below the largest opening the traction goes to the origin and back, and damage stays to the last bit */
static void unloading_goes_to_the_origin(void **state)
{
  const PetscReal largest[] = {0.4, 0, 0}, damage = Damage(0, 1, largest);

  (void)state;
  near(Traction(damage, 0.4), Envelope(0.4), CLOSE);
  for (PetscInt k = 0; k < 40; k++) {
    const PetscReal gap[] = {0.01 * k, 0, 0};

    assert_true(Damage(damage, 3, gap) == damage);
    CheckForce(damage, 3, gap);
  }
  for (PetscInt k = 41; k < 120; k++) { /* beyond, it goes on as if it had not been unloaded */
    const PetscReal gap[] = {0.01 * k, 0, 0};

    near(Traction(Damage(damage, 1, gap), gap[0]), Envelope(gap[0]), CLOSE);
    CheckForce(damage, 1, gap);
  }
}

static void what_has_failed_stays_so(void **state)
{
  const PetscReal failed[] = {1.0, 0, 0}, half[] = {0.5, 0, 0};

  (void)state;
  assert_true(Damage(0, 1, failed) == 1 && Damage(1, 1, half) == 1);
  CheckForce(1, 3, half);
}

/* All modes have the same opening, that of the vector; of its part along the normal only what is positive counts */
static void modes_are_mixed_by_the_opening(void **state)
{
  const PetscReal mixed[] = {0.3, 0, 0.4}, one[] = {0.5, 0, 0}, pressed[] = {-0.3, 0, 0.5}, shear[] = {0, 0.5, 0};

  (void)state;
  near(Damage(0, 3, mixed), Damage(0, 3, one), CLOSE);
  near(Damage(0, 3, shear), Damage(0, 3, one), CLOSE);
  near(Damage(0, 3, pressed), Damage(0, 3, one), CLOSE);
  CheckForce(0, 3, mixed);
  CheckForce(0, 3, pressed);
}

/* Glue without damage pushes as it pulls, and has no damage by it; with damage contact holds the node where it may be at least, with the
   force that the trial force has there, and shear goes on as it is */
static void compression(void **state)
{
  const PetscReal pushed[] = {-5, 0, 0}, r = 3, least = -0.001, damage = 0.9, p[] = {7, -AREA * (0.1 * K + r) * 0.01};
  RowLawGlue      node = Node(r, damage, least);
  PetscReal       force[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];

  (void)state;
  assert_true(Damage(0, 1, pushed) == 0);
  CheckForce(0, 1, pushed);
  RowLawCohesive.project(2, NULL, &node, p, force, derivative);
  near(force[0], 7 + AREA * r * least, CLOSE);
  near(force[1], -AREA * 0.1 * K * 0.01, CLOSE);
  near(derivative[0], 1, CLOSE);
  near(derivative[1], 0, CLOSE);
}

/* What is torn apart by small steps takes the toughness, whatever its way: by the work of the mean traction of each step */
static void breaking_takes_the_toughness(void **state)
{
  const PetscInt steps = 4000;

  (void)state;
  for (PetscInt way = 0; way < 3; way++) {
    PetscReal damage = 0, work = 0, last = 0;

    for (PetscInt k = 1; k <= steps; k++) {
      /* straight on; with a way back amid; across */
      const PetscReal t       = (PetscReal)k / steps;
      const PetscReal opening = way == 1 ? (t < 0.3 ? t : t < 0.5 ? 0.6 - t : t < 0.7 ? t - 0.4 : 1.2 * t - 0.54) / 0.66 * 1.01 : 1.01 * t;
      const PetscReal middle = 0.5 * (opening + last), gap[] = {way == 2 ? 0 : middle, way == 2 ? middle : 0};

      damage = Damage(damage, 2, gap);
      work += Traction(damage, middle) * (opening - last);
      last = opening;
    }
    assert_true(damage == 1);
    near(work, G, 1e-3); /* the kinks of the law lie inside a step each */
  }
}

/* Uniform in [-1, 1] */
static PetscReal Random(unsigned *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return 2 * ((*seed >> 8) / (PetscReal)(1u << 24)) - 1;
}

/* With a normal that is no axis; points that are nearer to a kink than the differences are left out by comparing both sides of these */
static void derivatives_are_those_of_differences(void **state)
{
  unsigned seed  = 1;
  PetscInt count = 0;

  (void)state;
  for (PetscInt k = 0; k < 6000; k++) {
    RowLawGlue node = Node(20, k % 3 ? 0.5 + 0.5 * Random(&seed) : 0, k % 2 ? -0.05 : -10);
    PetscReal  p[3], force[3], derivative[9], unused[9], sides[2][3];

    node.normal[0] = 0.6;
    node.normal[1] = 0;
    node.normal[2] = 0.8;
    for (PetscInt i = 0; i < 3; i++) p[i] = 12 * Random(&seed);
    RowLawCohesive.project(3, NULL, &node, p, force, derivative);
    for (PetscInt j = 0; j < 3; j++) {
      PetscBool smooth = PETSC_TRUE;

      for (PetscInt side = 0; side < 2; side++) {
        PetscReal moved[3] = {p[0], p[1], p[2]}, there[3];

        moved[j] += side ? STEP : -STEP;
        RowLawCohesive.project(3, NULL, &node, moved, there, unused);
        for (PetscInt i = 0; i < 3; i++) sides[side][i] = (there[i] - force[i]) / (side ? STEP : -STEP);
      }
      for (PetscInt i = 0; i < 3; i++) smooth = (PetscBool)(smooth && PetscAbsReal(sides[0][i] - sides[1][i]) < 1e-5);
      for (PetscInt i = 0; i < 3 && smooth; i++) near(derivative[3 * i + j], 0.5 * (sides[0][i] + sides[1][i]), 1e-5);
      count += smooth;
    }
  }
  assert_true(count > 17500); /* of 18000 */
}

/* Nodes of soft bodies, S = B B^T + 0.1 I [m/N] against a slope of 2 N/m: each alone would jump to failure, and others with it. There are
   several solutions. One is found for all, from unbroken nodes on, and for some of them by secants. */
static void secants_find_what_breaks_at_once(void **state)
{
  const PetscInt n          = 6;
  unsigned       seed       = 7;
  PetscInt       by_secants = 0;

  (void)state;
  for (PetscInt trial = 0; trial < 200; trial++) {
    PetscScalar *entries, copy[36];
    PetscReal    B[36];
    LawProblem   problem;
    Mat          matrix;

    ok(PetscMemzero(&problem, sizeof(problem)));
    ok(LawProblemResize(&problem, n));
    problem.n_nodes = n;
    for (PetscInt k = 0; k < n * n; k++) B[k] = Random(&seed);
    for (PetscInt node = 0; node <= n; node++) problem.begin[node] = node;
    for (PetscInt node = 0; node < n; node++) {
      problem.law[node]  = &RowLawCohesive;
      problem.glue[node] = Node(1, 0, -10);
      problem.base[node] = problem.force[node] = 0;
      problem.read[node]                       = 1.5 * (1 + Random(&seed));
      problem.limit[2 * node] = problem.limit[2 * node + 1] = 0;
    }
    ok(MatCreateSeqDense(PETSC_COMM_SELF, n, n, NULL, &matrix));
    ok(MatDenseGetArrayWrite(matrix, &entries));
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++) {
        entries[j * n + i] = i == j ? 0.1 : 0;
        for (PetscInt k = 0; k < n; k++) entries[j * n + i] += B[i * n + k] * B[j * n + k];
      }
    ok(PetscArraycpy(copy, entries, n * n));
    ok(MatDenseRestoreArrayWrite(matrix, &entries));
    ok(LawProblemTakeS(&problem, &matrix, NULL));
    ok(LawProblemSolve(&problem));
    assert_true(problem.solved);
    by_secants += problem.by_nodes;
    for (PetscInt i = 0; i < n; i++) { /* the force is that of the gap */
      PetscReal gap[] = {PetscRealPart(problem.read[i])};

      for (PetscInt j = 0; j < n; j++) gap[0] += PetscRealPart(copy[j * n + i] * problem.force[j]);
      near(PetscRealPart(problem.force[i]), -AREA * Traction(Damage(0, 1, gap), gap[0]), 1e-9);
    }
    ok(LawProblemDestroy(&problem));
  }
  assert_true(by_secants > 0);
}

static void parameters_go_together(void **state)
{
  (void)state;
  assert_null(RowLawCohesive.check(parameters));
  assert_non_null(RowLawCohesive.check((PetscReal[]){1.9, 2, 1})); /* k below s^2/2G = 2 */
  assert_int_equal(RowLawCohesive.n_parameters, 3);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(loading_follows_the_two_lines),
      cmocka_unit_test(unloading_goes_to_the_origin),
      cmocka_unit_test(what_has_failed_stays_so),
      cmocka_unit_test(modes_are_mixed_by_the_opening),
      cmocka_unit_test(compression),
      cmocka_unit_test(breaking_takes_the_toughness),
      cmocka_unit_test(derivatives_are_those_of_differences),
      cmocka_unit_test(secants_find_what_breaks_at_once),
      cmocka_unit_test(parameters_go_together),
  };

  return impakt_main(argc, argv, tests);
}
