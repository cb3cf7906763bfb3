/* Formulas, tables and lists that users write in options. */
#include "support.h"
#include <impakt/expression.h>

static PetscReal value_of(const char text[], PetscReal x, PetscReal y, PetscReal t)
{
  const ExpressionPoint point = {{x, y, 0.25}, {0.6, -0.8, 0}, t};
  Expression            expression;
  PetscReal             value;

  ok(ExpressionCreate(PETSC_COMM_WORLD, "bar_load", text, &expression));
  ok(ExpressionEvaluate(expression, &point, &value));
  ok(ExpressionDestroy(&expression));
  assert_null(expression);
  return value;
}

/* Tolerances: a few units in the last place of values of order 1 */
static void evaluates_formulas(void **state)
{
  (void)state;
  near(value_of("1.5e-3", 0, 0, 0), 1.5e-3, 0);
  near(value_of("-4", 0, 0, 0), -4, 0);
  near(value_of("x + 10*y + 100*z + 1000*t", 1, 2, 3), 1 + 20 + 25 + 3000, 0);
  near(value_of("nx - ny + nz", 0, 0, 0), 1.4, 1e-15);
  near(value_of("2*sin(pi*t)*x^2", 3, 0, 0.5), 18, 1e-14);
  near(value_of("ln(e)", 0, 0, 0), 1, 1e-15);
  near(value_of("t < 1 ? t : 1", 0, 0, 0.25), 0.25, 0);
  near(value_of("t < 1 ? t : 1", 0, 0, 2), 1, 0);
  near(value_of("x <= 1 && x >= 1 && x == 1 && y != 1 ? 7 : 8", 1, 2, 0), 7, 0);
  near(value_of("min(x, y, t)", 3, 2, 1), 1, 0);
}

typedef struct {
  const char *text;
  PetscBool   constant, steady, uniform, normal;
} Nature;

static void tells_what_a_formula_depends_on(void **state)
{
  const Nature natures[] = {
      {"2*pi - 1", PETSC_TRUE, PETSC_TRUE, PETSC_TRUE, PETSC_FALSE}, {"x + z", PETSC_FALSE, PETSC_TRUE, PETSC_FALSE, PETSC_FALSE},
      {"0*y", PETSC_FALSE, PETSC_TRUE, PETSC_FALSE, PETSC_FALSE},    {"nx", PETSC_FALSE, PETSC_TRUE, PETSC_FALSE, PETSC_TRUE},
      {"sin(t)", PETSC_FALSE, PETSC_FALSE, PETSC_TRUE, PETSC_FALSE}, {"t*x*nz", PETSC_FALSE, PETSC_FALSE, PETSC_FALSE, PETSC_TRUE},
  };

  (void)state;
  for (size_t i = 0; i < sizeof(natures) / sizeof(natures[0]); i++) {
    Expression expression;
    PetscBool  constant, steady, uniform, normal;
    PetscReal  value = -1;

    ok(ExpressionCreate(PETSC_COMM_WORLD, "o", natures[i].text, &expression));
    ok(ExpressionIsConstant(expression, &constant, &value));
    ok(ExpressionGetNature(expression, &steady, &uniform, &normal));
    assert_int_equal(constant, natures[i].constant);
    assert_int_equal(steady, natures[i].steady);
    assert_int_equal(uniform, natures[i].uniform);
    assert_int_equal(normal, natures[i].normal);
    near(value, constant ? 2 * PETSC_PI - 1 : -1, 1e-15);
    ok(ExpressionDestroy(&expression));
  }
}

static void refuses_formulas(void **state)
{
  const struct {
    const char *text, *words;
  } cases[] = {
      {"2*foo + 1", "-bar_load|'2*foo + 1'|character 3|\"foo\"|x, y, z, t|nx, ny, nz|pi, e"},
      {"1 +", "-bar_load|'1 +'|character|end of expression"},
      {"sin(x", "-bar_load|'sin(x'|parenthesis"},
      {"x 3", "-bar_load|'x 3'|character 3|\"3\""},
      {"2x", "-bar_load|'2x'|character 2|\"x\""},
      {"x ? 1", "-bar_load|else clause"},
      {"pow(x,2)", "-bar_load|'pow(x,2)'|pow"},
      {"x, y", "-bar_load|'x, y'|2 values"},
      {"t = 3", "-bar_load|'t = 3'|=="},
      {"x=3", "-bar_load|'x=3'|=="},
      {"", "-bar_load|''|empty"},
      {"1/0", "-bar_load|'1/0'|inf|finite"},
      {"sqrt(-1)", "-bar_load|'sqrt(-1)'|finite"},
      {"free", "-bar_load|'free'|prescribed displacement"},
  };

  (void)state;
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    Expression expression;

    refused(PETSC_ERR_USER_INPUT, cases[i].words, ExpressionCreate(PETSC_COMM_WORLD, "bar_load", cases[i].text, &expression));
    assert_null(expression);
  }
}

static void refuses_values_that_are_not_finite(void **state)
{
  const ExpressionPoint good = {{4, 0, 0}, {0}, 1}, bad = {{-4, 2, 0}, {0}, 1};
  Expression            expression;
  PetscReal             value;

  (void)state;
  ok(ExpressionCreate(PETSC_COMM_WORLD, "bar_load", "sqrt(x)", &expression));
  ok(ExpressionEvaluate(expression, &good, &value));
  near(value, 2, 0);
  refused(PETSC_ERR_USER_INPUT, "-bar_load|'sqrt(x)'|x = -4|y = 2|t = 1|finite", ExpressionEvaluate(expression, &bad, &value));
  /* and can be used afterwards */
  ok(ExpressionEvaluate(expression, &good, &value));
  near(value, 2, 0);
  ok(ExpressionDestroy(&expression));
}

/* The file is one that the first rank alone sees, as on a machine whose ranks do not share a file system */
static void write_file(const char name[], const char text[], size_t length)
{
  PetscMPIInt rank;

  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  if (rank == 0) {
    FILE *file = fopen(name, "wb");

    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
  }
  assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0);
}

static void evaluates_tables(void **state)
{
  static const char text[] = "# time [s], pressure [Pa]\r\n\n0 10\n  1e-3,2e1 # ramp\n\t2e-3 , 40\n3e-3\t-0.5";
  PetscBool         steady, uniform, constant;
  Expression        expression;

  (void)state;
  write_file("ramp.txt", text, sizeof(text) - 1);
  near(value_of("table:ramp.txt", 0, 0, -1), 10, 0);
  near(value_of("table:ramp.txt", 0, 0, 0), 10, 0);
  near(value_of("table:ramp.txt", 0, 0, 2.5e-4), 12.5, 1e-14); /* a quarter of the way: 12.5 to round-off of 10 */
  near(value_of("table:ramp.txt", 0, 0, 1e-3), 20, 1e-14);
  near(value_of("table:ramp.txt", 0, 0, 1.5e-3), 30, 1e-14);
  near(value_of("table:ramp.txt", 0, 0, 3e-3), -0.5, 0);
  near(value_of("table:ramp.txt", 0, 0, 1), -0.5, 0);
  ok(ExpressionCreate(PETSC_COMM_WORLD, "o", "table:ramp.txt", &expression));
  ok(ExpressionGetNature(expression, &steady, &uniform, NULL));
  ok(ExpressionIsConstant(expression, &constant, NULL));
  assert_false(steady || constant);
  assert_true(uniform);
  ok(ExpressionDestroy(&expression));

  write_file("one.txt", "5 3\n", 4);
  ok(ExpressionCreate(PETSC_COMM_WORLD, "o", "table:one.txt", &expression));
  ok(ExpressionIsConstant(expression, &constant, NULL));
  assert_true(constant);
  ok(ExpressionDestroy(&expression));
  near(value_of("table:one.txt", 0, 0, 0), 3, 0);
}

/* 1000 rows, beyond the room that is made at first, of a line: linear interpolation has it exactly, to round-off of 3000 */
static void evaluates_long_tables(void **state)
{
  Expression expression;
  char       text[20000];
  size_t     length = 0;

  (void)state;
  for (int i = 0; i < 1000; i++) length += (size_t)snprintf(text + length, sizeof(text) - length, "%d %d\n", i, 3 * i);
  write_file("long.txt", text, length);
  ok(ExpressionCreate(PETSC_COMM_WORLD, "o", "table:long.txt", &expression));
  for (int i = 0; i < 1998; i++) {
    const ExpressionPoint point = {{0}, {0}, 0.5 * i + 0.1};
    PetscReal             value;

    ok(ExpressionEvaluate(expression, &point, &value));
    near(value, 1.5 * i + 0.3, 1e-12);
  }
  ok(ExpressionDestroy(&expression));
}

static void refuses_tables(void **state)
{
  static const char binary[] = "\x89HDF\r\n\x1a\n\0\0\0\0";
  char              longline[3000];
  Expression        expression;
  const struct {
    const char *text, *words;
    size_t      length;
  } cases[] = {
      {"", "-bar_load|'bad.txt'|no line", 0},
      {"# nothing\n\n", "-bar_load|'bad.txt'|no line", 11},
      {"0 1\n1\n", "-bar_load|'bad.txt'|line 2|a time and a value", 6},
      {"0 1\n1 ", "-bar_load|'bad.txt'|line 2|a time and a value", 6},
      {"0 1 2\n", "-bar_load|'bad.txt'|line 1|a time and a value", 6},
      {"0 1x\n", "-bar_load|'bad.txt'|line 1|a time and a value", 5},
      {"0,,1\n", "-bar_load|'bad.txt'|line 1|a time and a value", 5},
      {"time value\n", "-bar_load|'bad.txt'|line 1|a time and a value", 11},
      {"0 1\n1 nan\n", "-bar_load|'bad.txt'|line 2|finite", 10},
      {"0 1\n1 1e999\n", "-bar_load|'bad.txt'|line 2|finite", 12},
      {"0 1\n2 1\n2 3\n", "-bar_load|'bad.txt'|line 3|ascend", 12},
      {"0 1\n2 1\n1 3\n", "-bar_load|'bad.txt'|line 3|time 1|2", 12},
      {binary, "-bar_load|'bad.txt'|line 1", sizeof(binary) - 1},
      {longline, "-bar_load|'bad.txt'|line 1", sizeof(longline)},
  };

  (void)state;
  memset(longline, '1', sizeof(longline));
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    write_file("bad.txt", cases[i].text, cases[i].length);
    refused(PETSC_ERR_USER_INPUT, cases[i].words, ExpressionCreate(PETSC_COMM_WORLD, "bar_load", "table:bad.txt", &expression));
    assert_null(expression);
    assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0);
  }
  refused(PETSC_ERR_USER_INPUT, "-bar_load|'nowhere.txt'|No such file",
          ExpressionCreate(PETSC_COMM_WORLD, "bar_load", "table:nowhere.txt", &expression));
  refused(PETSC_ERR_USER_INPUT, "-bar_load|'.'|directory", ExpressionCreate(PETSC_COMM_WORLD, "bar_load", "table:.", &expression));
}

static void splits_lists(void **state)
{
  const ExpressionPoint point = {{1, 2, 3}, {0}, 4};
  Expression            list[3];
  PetscReal             value;

  (void)state;
  ok(ExpressionListCreate(PETSC_COMM_WORLD, "o", " max(x, min(y,z)) ,free, t*(x+y) ", 3, PETSC_TRUE, list));
  ok(ExpressionEvaluate(list[0], &point, &value));
  near(value, 2, 0);
  assert_null(list[1]);
  ok(ExpressionEvaluate(list[2], &point, &value));
  near(value, 12, 0);
  for (int i = 0; i < 3; i++) ok(ExpressionDestroy(&list[i]));
  ok(ExpressionListCreate(PETSC_COMM_WORLD, "o", "7", 1, PETSC_FALSE, list));
  ok(ExpressionDestroy(&list[0]));

  refused(PETSC_ERR_USER_INPUT, "-bar_load|'1,2'|2 components|needs 3|free",
          ExpressionListCreate(PETSC_COMM_WORLD, "bar_load", "1,2", 3, PETSC_TRUE, list));
  refused(PETSC_ERR_USER_INPUT, "-bar_load|'max(1,2)'|1 component;|needs 2",
          ExpressionListCreate(PETSC_COMM_WORLD, "bar_load", "max(1,2)", 2, PETSC_FALSE, list));
  refused(PETSC_ERR_USER_INPUT, "-bar_load|4 components|needs 3",
          ExpressionListCreate(PETSC_COMM_WORLD, "bar_load", "1,2,3,", 3, PETSC_FALSE, list));
  refused(PETSC_ERR_USER_INPUT, "-bar_load|'free'", ExpressionListCreate(PETSC_COMM_WORLD, "bar_load", "1,free,2", 3, PETSC_FALSE, list));
  refused(PETSC_ERR_USER_INPUT, "-bar_load|''|empty", ExpressionListCreate(PETSC_COMM_WORLD, "bar_load", "1,,2", 3, PETSC_FALSE, list));
  refused(PETSC_ERR_USER_INPUT, "-bar_load|'2+'", ExpressionListCreate(PETSC_COMM_WORLD, "bar_load", "1,2,2+", 3, PETSC_FALSE, list));
  for (int i = 0; i < 3; i++) assert_null(list[i]);
}

/* Of sin(t) with steps from 1e-3 to 0.5 rad: relative to the amplitude of the derivative, which is 1 */
static void differentiates_in_time(void **state)
{
  Expression      expression;
  PetscReal       first = 0, second = 0, first_at_start = 0, second_at_start = 0;
  const PetscReal steps[] = {1e-3, 1e-2, 0.1, 0.25, 0.5};

  (void)state;
  ok(ExpressionCreate(PETSC_COMM_WORLD, "o", "sin(t)", &expression));
  for (size_t s = 0; s < sizeof(steps) / sizeof(steps[0]); s++)
    for (int i = 0; i < 20; i++) {
      const PetscReal start = 0.3 * i;
      ExpressionPoint point = {{0}, {0}, start};
      PetscReal       values[3];

      ok(ExpressionEvaluateRates(expression, &point, -10, steps[s], values));
      near(values[0], sin(start), 1e-15);
      first  = PetscMax(first, PetscAbsReal(values[1] - cos(start)));
      second = PetscMax(second, PetscAbsReal(values[2] + sin(start)));
      for (int k = 0; k < 10; k++) {
        point.t = start + 0.1 * k * steps[s];
        ok(ExpressionEvaluateRates(expression, &point, start, steps[s], values));
        first_at_start  = PetscMax(first_at_start, PetscAbsReal(values[1] - cos(point.t)));
        second_at_start = PetscMax(second_at_start, PetscAbsReal(values[2] + sin(point.t)));
      }
    }
  ok(ExpressionDestroy(&expression));
  /* what the manual page of ExpressionEvaluateRates() says, measured: 2.7e-8, 1.7e-8, 5.4e-7, 2.1e-5 */
  near(first, 0, 3e-8);
  near(second, 0, 3e-8);
  near(first_at_start, 0, 6e-7);
  near(second_at_start, 0, 3e-5);
}

/* sqrt(t) is not defined before the start; a fifth-order polynomial is differentiated exactly */
static void does_not_look_before_the_start(void **state)
{
  const ExpressionPoint point = {{0}, {0}, 0};
  Expression            expression;
  PetscReal             values[3];

  (void)state;
  ok(ExpressionCreate(PETSC_COMM_WORLD, "o", "(t < 0 ? sqrt(t) : 0) + 3 + 2*t - 4*t^2 + t^5", &expression));
  ok(ExpressionEvaluateRates(expression, &point, 0, 0.1, values));
  near(values[0], 3, 0);
  near(values[1], 2, 1e-12);  /* round-off: 3 eps / h, h = 0.025, times the sum of the weights, 31: 8e-13 */
  near(values[2], -8, 1e-10); /* 3 eps / h^2 times 102: 1e-10 at the worst */
  ok(ExpressionDestroy(&expression));
}

/* The slope of a table, and no spikes where it changes */
static void differentiates_tables(void **state)
{
  ExpressionPoint point = {{0}, {0}, 0.5};
  Expression      expression;
  PetscReal       values[3];

  (void)state;
  write_file("kink.txt", "0 0\n1 2\n2 2\n", 12);
  ok(ExpressionCreate(PETSC_COMM_WORLD, "o", "table:kink.txt", &expression));
  ok(ExpressionEvaluateRates(expression, &point, 0, 0.1, values));
  near(values[1], 2, 1e-13);
  near(values[2], 0, 0);
  point.t = 1;
  ok(ExpressionEvaluateRates(expression, &point, 0, 0.1, values));
  near(values[0], 2, 0);
  near(values[1], 1, 1e-13); /* the mean of both sides */
  near(values[2], 0, 0);
  ok(ExpressionDestroy(&expression));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(evaluates_formulas),     cmocka_unit_test(tells_what_a_formula_depends_on),
      cmocka_unit_test(refuses_formulas),       cmocka_unit_test(refuses_values_that_are_not_finite),
      cmocka_unit_test(evaluates_tables),       cmocka_unit_test(evaluates_long_tables),
      cmocka_unit_test(refuses_tables),         cmocka_unit_test(splits_lists),
      cmocka_unit_test(differentiates_in_time), cmocka_unit_test(does_not_look_before_the_start),
      cmocka_unit_test(differentiates_tables),
  };

  return impakt_main(argc, argv, tests);
}
