/* Laws of the rows of a node: each is a projection on the forces that the law allows, and its derivative is that of its values. */
#include "support.h"
#include <contact/laws/rowlaw.h>
#include <impakt/contact.h>

#define POINTS 2000
#define STEP   1e-6 /* of differences: cuts 1e-12 off smooth pieces of size 1, and divides round-off of 2e-16 to 1e-10 */
#define CLOSE  1e-8
#define KINK   1e-4 /* points nearer to a kink than this are left out: far more than a step */

/* Uniform in [-1, 1] */
static PetscReal Random(unsigned *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return 2 * ((*seed >> 8) / (PetscReal)(1u << 24)) - 1;
}

static PetscReal Across(PetscInt n, const PetscReal p[])
{
  PetscReal sum = 0;

  for (PetscInt i = 1; i < n; i++) sum += PetscSqr(p[i]);
  return PetscSqrtReal(sum);
}

/* A spring of 4 N/m^3 on 0.5 m^2; the trial force has r = 3 N/m */
static const PetscReal  stiffness[] = {4};
static const RowLawGlue glued       = {.times = 1, .r = 3, .area = 0.5, .normal = {1}, .parameters = stiffness};

/* Bounds: none, Coulomb's, one that does not depend on the normal force, both */
static const PetscReal limits[][2] = {{0, 0}, {0, 0.4}, {0.3, 0}, {0.2, 0.7}};

/* A trial force, and whether it lies away from the kinks: release, and the edge between stick and slip */
static PetscBool Draw(unsigned *seed, PetscInt n, const PetscReal limit[2], PetscReal p[])
{
  for (PetscInt i = 0; i < n; i++) p[i] = 2 * Random(seed);
  return (PetscBool)(PetscAbsReal(p[0]) > KINK && (p[0] < 0 || n == 1 || PetscAbsReal(Across(n, p) - limit[0] - limit[1] * p[0]) > KINK));
}

static void unilateral_is_in_the_cone(void **state)
{
  unsigned seed    = 1;
  PetscInt seen[3] = {0, 0, 0}; /* released, sticks, slips */

  (void)state;
  for (PetscInt n = 1; n <= ROW_LAW_ROWS; n++)
    for (size_t l = 0; l < PETSC_STATIC_ARRAY_LENGTH(limits); l++)
      for (PetscInt k = 0; k < POINTS; k++) {
        PetscReal p[ROW_LAW_ROWS], force[ROW_LAW_ROWS], again[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS], bound, work = 0;

        (void)Draw(&seed, n, limits[l], p);
        RowLawUnilateral.project(n, limits[l], NULL, p, force, derivative);
        RowLawUnilateral.project(n, limits[l], NULL, force, again, derivative);
        for (PetscInt i = 0; i < n; i++) near(again[i], force[i], 1e-15); /* a quotient of nearly equal numbers is off by its round-off */
        assert_true(force[0] == PetscMax(p[0], 0));
        if (p[0] <= 0) {
          assert_true(Across(n, force) == 0); /* an open node does not rub */
          seen[0]++;
          continue;
        }
        bound = limits[l][0] + limits[l][1] * force[0];
        assert_true(Across(n, force) <= bound + 1e-15);
        if (Across(n, p) <= bound) {
          for (PetscInt i = 0; i < n; i++) assert_true(force[i] == p[i]);
          seen[1]++;
          continue;
        }
        near(Across(n, force), bound, 1e-15); /* slips along the trial force, with all that there is */
        for (PetscInt i = 1; i < n; i++) work += force[i] * p[i];
        near(work, bound * Across(n, p), 1e-14);
        seen[2]++;
      }
  for (PetscInt k = 0; k < 3; k++) assert_true(seen[k] > POINTS);
}

/* The tangential part is the nearest point of the disc: no other allowed force with the same normal part is nearer */
static void unilateral_is_the_nearest_point(void **state)
{
  unsigned seed = 2;

  (void)state;
  for (PetscInt k = 0; k < POINTS; k++) {
    const PetscInt n = 2 + k % 2;
    PetscReal      p[ROW_LAW_ROWS], force[ROW_LAW_ROWS], other[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];
    PetscReal      bound, size, product = 0;

    (void)Draw(&seed, n, limits[3], p);
    (void)Draw(&seed, n, limits[3], other);
    RowLawUnilateral.project(n, limits[3], NULL, p, force, derivative);
    bound = p[0] > 0 ? limits[3][0] + limits[3][1] * p[0] : 0;
    size  = Across(n, other);
    for (PetscInt i = 1; i < n; i++) product += (p[i] - force[i]) * (other[i] * PetscMin(1, bound / size) - force[i]);
    assert_true(product <= 1e-14);
  }
}

static void CheckDerivative(const RowLaw *law, PetscInt n, const PetscReal limit[2], const PetscReal p[])
{
  PetscReal force[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS], unused[ROW_LAW_ROWS * ROW_LAW_ROWS];

  law->project(n, limit, &glued, p, force, derivative);
  for (PetscInt j = 0; j < n; j++) {
    PetscReal moved[ROW_LAW_ROWS], ahead[ROW_LAW_ROWS], behind[ROW_LAW_ROWS];

    for (PetscInt i = 0; i < n; i++) moved[i] = p[i];
    moved[j] = p[j] + STEP;
    law->project(n, limit, &glued, moved, ahead, unused);
    moved[j] = p[j] - STEP;
    law->project(n, limit, &glued, moved, behind, unused);
    for (PetscInt i = 0; i < n; i++) near(derivative[i * n + j], (ahead[i] - behind[i]) / (2 * STEP), CLOSE);
  }
}

static void derivatives_are_those_of_differences(void **state)
{
  const RowLaw *const laws[] = {&RowLawUnilateral, &RowLawTie, &RowLawHold, &RowLawSpring};
  unsigned            seed   = 3;
  PetscInt            count  = 0;

  (void)state;
  for (size_t law = 0; law < PETSC_STATIC_ARRAY_LENGTH(laws); law++)
    for (PetscInt n = 1; n <= ROW_LAW_ROWS; n++)
      for (size_t l = 0; l < PETSC_STATIC_ARRAY_LENGTH(limits); l++)
        for (PetscInt k = 0; k < POINTS; k++) {
          PetscReal p[ROW_LAW_ROWS];

          if (!Draw(&seed, n, limits[l], p) || (n > 1 && Across(n, p) < 0.1)) continue; /* where the direction turns within a step */
          CheckDerivative(laws[law], n, limits[l], p);
          count++;
        }
  assert_true(count > 8 * POINTS);
}

static void tie_is_the_identity(void **state)
{
  const PetscReal p[] = {-3, 0.5, 2};

  (void)state;
  for (PetscInt n = 1; n <= ROW_LAW_ROWS; n++) {
    PetscReal force[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];

    RowLawTie.project(n, limits[1], NULL, p, force, derivative);
    for (PetscInt i = 0; i < n; i++) {
      assert_true(force[i] == p[i]);
      for (PetscInt j = 0; j < n; j++) assert_true(derivative[i * n + j] == (i == j));
    }
  }
}

/* Ties read the gap; contact reads how far a closed row is off, which with kept mass is no gap */
static void laws_read_what_they_hold(void **state)
{
  (void)state;
  assert_int_equal(RowLawTie.reads, ROW_LAW_READS_END);
  assert_int_equal(RowLawUnilateral.reads, ROW_LAW_READS_CLOSED);
  assert_int_equal(RowLawHold.reads, ROW_LAW_READS_CLOSED);
  assert_int_equal(RowLawSpring.reads, ROW_LAW_READS_MEAN);
  assert_true(!RowLawUnilateral.pulls && RowLawTie.pulls && RowLawHold.pulls && RowLawSpring.pulls);
}

/* The force of a spring of 4 N/m^3 on 0.5 m^2 is -2 g, and the trial force from which it comes -2 g - 3 g; the others are rigid */
static void springs_give_way(void **state)
{
  const PetscReal gap[] = {0.75, -2, 0.1}, trial[] = {-5 * 0.75, 5 * 2, -5 * 0.1};
  PetscReal       force[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];

  (void)state;
  near(RowLawSpring.stiffness(stiffness, NULL), 4, 1e-15);
  RowLawSpring.project(3, limits[0], &glued, trial, force, derivative);
  for (PetscInt i = 0; i < 3; i++) near(force[i], -2 * gap[i], 1e-15);
  assert_true(!RowLawUnilateral.stiffness && !RowLawTie.stiffness && !RowLawHold.stiffness && !RowLawSpring.grow &&
              !RowLawSpring.softening);
}

/* Those that users name: glue has a stiffness, friction a bound, and none both */
static void named_laws_are_glue_or_friction(void **state)
{
  PetscInt n, glued_laws = 0;

  (void)state;
  for (n = 0; RowLaws[n]; n++) {
    const RowLaw law = *RowLaws[n];

    assert_true(law.name && law.n_parameters > 0 && !law.n_history == !law.grow && !law.stiffness != !law.bound);
    if (law.stiffness) assert_true(law.pulls && law.reads == ROW_LAW_READS_MEAN);
    glued_laws += law.stiffness != NULL;
  }
  assert_true(glued_laws >= 2 && n > glued_laws);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(unilateral_is_in_the_cone),
      cmocka_unit_test(unilateral_is_the_nearest_point),
      cmocka_unit_test(derivatives_are_those_of_differences),
      cmocka_unit_test(tie_is_the_identity),
      cmocka_unit_test(laws_read_what_they_hold),
      cmocka_unit_test(springs_give_way),
      cmocka_unit_test(named_laws_are_glue_or_friction),
  };

  return impakt_main(argc, argv, tests);
}
