/* ranks: 1 2 */
/* Output that a program asks for, without options. */
#include "simulation.h"

static PetscBool exists(const char path[])
{
  PetscBool there;

  assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0);
  ok(PetscTestFile(path, 'r', &there));
  return there;
}

static void drop(const char path[])
{
  PetscMPIInt rank;

  assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0);
  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  if (!rank) assert_int_equal(remove(path), 0);
}

static void files_are_written(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  ExactErrors errors;
  Exact       exact;
  Output      output;

  AddCollision(8, 8, 0);
  ok(SimulationCreate(simulation));
  ok(OutputCreate(simulation->controller, &output));
  ok(OutputSetHistory(output, "setters.h5"));
  ok(OutputSetSummary(output, "setters.json"));
  ok(OutputSetFields(output, "setters-fields.h5", 5, OUTPUT_DOUBLE));
  ok(OutputSetExact(output, EXACT_CHARACTERISTICS));
  ok(OutputSetExactDisplacement(output, simulation->bodies[0], "0.1*t"));
  ok(ControllerSolve(simulation->controller));
  ok(OutputReport(output));
  ok(OutputGetExact(output, &exact));
  ok(ExactGetErrors(exact, &errors));
  between(errors.mean_velocity, 1e-8, 0.1); /* of two coarse bars */
  ok(OutputDestroy(&output));
  assert_true(exists("setters.h5") && exists("setters.json") && exists("setters-fields.h5") && exists("setters-fields.xdmf"));
  drop("setters.h5");
  drop("setters.json");
  drop("setters-fields.h5");
  drop("setters-fields.xdmf");
}

static void each_file_has_a_path_of_its_own(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Output      output;
  Body        other;

  AddCollision(4, 4, 0);
  ok(SimulationCreate(simulation));
  ok(OutputCreate(simulation->controller, &output));
  ok(OutputSetHistory(output, "same.h5"));
  refused(PETSC_ERR_USER_INPUT, "same file, same.h5", OutputSetSummary(output, "same.h5"));
  refused(PETSC_ERR_USER_INPUT, "same file, same.h5", OutputSetFields(output, "same.h5", 0, OUTPUT_SINGLE));
  refused(PETSC_ERR_ARG_WRONGSTATE, "already|same.h5", OutputSetHistory(output, "other.h5"));
  refused(PETSC_ERR_USER_INPUT, "Unknown -exact 'none'|impact", OutputSetExact(output, "none"));
  ok(OutputSetExact(output, EXACT_IMPACT));
  refused(PETSC_ERR_ARG_WRONGSTATE, "already", OutputSetExact(output, EXACT_IMPACT));
  ok(BodyCreate(PETSC_COMM_WORLD, "stranger", &other));
  refused(PETSC_ERR_ARG_WRONG, "'stranger'|controller's", OutputSetExactDisplacement(output, other, "0"));
  ok(BodyDestroy(&other));
  ok(OutputDestroy(&output));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(files_are_written),
      simulation_test(each_file_has_a_path_of_its_own),
  };

  return impakt_main(argc, argv, tests);
}
