/* What the tests of surfaces, contact, controller and output share: an options database for each test, bars, a controller, and
   errors that are kept to be looked at. */
#pragma once
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <impakt.h>

/* A PETSc error where none is expected fails the test */
#define CHECK(call) assert_int_equal((call), PETSC_SUCCESS)

#define assert_near(value, expected, tolerance) AssertNear((double)(value), (double)(expected), (double)(tolerance), #value, __FILE__, __LINE__)

static inline void AssertNear(double value, double expected, double tolerance, const char what[], const char file[], int line)
{
  if (value - expected <= tolerance && expected - value <= tolerance) return;
  print_error("%s is %.17g, not %.17g: off by %g, allowed is %g\n", what, value, expected, value - expected, tolerance);
  _fail(file, line);
}

typedef struct {
  PetscOptions options; /* of this test alone */
  Controller   controller;
  Contact      contact; /* the controller's, as are the bodies */
  PetscInt     n_bodies;
  const Body  *bodies;
  char         message[4096]; /* of the last error */
} Simulation;

/* Each test begins with an empty options database, and ends with its controller destroyed */
static inline int SimulationOpen(void **state)
{
  Simulation *simulation;

  if (PetscNew(&simulation) || PetscOptionsCreate(&simulation->options) || PetscOptionsPush(simulation->options)) return -1;
  *state = simulation;
  return 0;
}

static inline int SimulationClose(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  if (ControllerDestroy(&simulation->controller) || PetscOptionsPop() || PetscOptionsDestroy(&simulation->options) || PetscFree(simulation)) return -1;
  return 0;
}

#define simulation_test(function) cmocka_unit_test_setup_teardown(function, SimulationOpen, SimulationClose)

static inline void AddOptions(const char options[])
{
  CHECK(PetscOptionsInsertString(NULL, options));
}

/* A bar of cross-section 1 from `lower` to `upper` [m]; density 1 and Young's modulus 1: waves run at 1 m/s, and a bar of
   length l weighs l kg */
static inline void AddBar(const char name[], PetscReal lower, PetscReal upper, PetscInt elements, PetscReal velocity)
{
  char options[1024];

  CHECK(PetscSNPrintf(options, sizeof(options), "-%s_dm_plex_dim 1 -%s_dm_plex_box_lower %.17g -%s_dm_plex_box_upper %.17g -%s_dm_plex_box_faces %d -%s_density 1 -%s_youngs_modulus 1 -%s_initial_velocity %.17g", name, name, (double)lower, name, (double)upper, name, (int)elements, name, name, name, (double)velocity));
  AddOptions(options);
}

/* A box of boxes, or of triangles in two dimensions, with a block of displacements at each vertex, as a body's mesh has it */
static inline DM CreateBoxMesh(const char name[], PetscInt dim, const char faces[], const char lower[], const char upper[], PetscBool simplex)
{
  PetscSection section;
  PetscInt     start, end, vstart, vend;
  char         options[512];
  DM           dm;

  CHECK(PetscSNPrintf(options, sizeof(options), "-dm_plex_dim %d -dm_plex_box_faces %s -dm_plex_box_lower %s -dm_plex_box_upper %s -dm_plex_simplex 0", (int)dim, faces, lower, upper));
  AddOptions(options);
  /* each quadrilateral cut into two triangles: PETSc alone has no generator of triangles */
  if (simplex && dim > 1) AddOptions("-dm_plex_transform_type refine_tosimplex -dm_refine 1");
  CHECK(DMCreate(PETSC_COMM_WORLD, &dm));
  CHECK(PetscObjectSetName((PetscObject)dm, name));
  CHECK(DMSetType(dm, DMPLEX));
  CHECK(DMSetFromOptions(dm));
  CHECK(DMPlexGetChart(dm, &start, &end));
  CHECK(DMPlexGetDepthStratum(dm, 0, &vstart, &vend));
  CHECK(PetscSectionCreate(PetscObjectComm((PetscObject)dm), &section));
  CHECK(PetscSectionSetChart(section, start, end));
  for (PetscInt v = vstart; v < vend; v++) CHECK(PetscSectionSetDof(section, v, dim));
  CHECK(PetscSectionSetUp(section));
  CHECK(DMSetLocalSection(dm, section));
  CHECK(PetscSectionDestroy(&section));
  return dm;
}

static inline PetscErrorCode SimulationCreate(Simulation *simulation)
{
  PetscFunctionBegin;
  PetscCall(ControllerCreate(PETSC_COMM_WORLD, &simulation->controller));
  PetscCall(ControllerSetFromOptions(simulation->controller));
  PetscCall(ControllerSetUp(simulation->controller));
  PetscCall(ControllerGetContact(simulation->controller, &simulation->contact));
  PetscCall(ControllerGetBodies(simulation->controller, &simulation->n_bodies, &simulation->bodies));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For another run in the same test: the options stay, to be added to */
static inline void SimulationRepeat(Simulation *simulation, const char options[])
{
  CHECK(ControllerDestroy(&simulation->controller));
  AddOptions(options);
  CHECK(SimulationCreate(simulation));
}

/* One controller step, and the only pair at its end */
static inline ContactPairState Step(Simulation *simulation)
{
  ContactPairState pair;

  CHECK(ContactStep(simulation->contact));
  CHECK(ContactAccept(simulation->contact));
  CHECK(ContactGetPairState(simulation->contact, 0, &pair));
  return pair;
}

static inline PetscReal Momentum(Simulation *simulation, PetscInt body)
{
  BodyMeasures measures;

  CHECK(BodyGetMeasures(simulation->bodies[body], &measures));
  return measures.momentum[0];
}

static inline PetscReal TotalMomentum(Simulation *simulation)
{
  PetscReal sum = 0;

  for (PetscInt b = 0; b < simulation->n_bodies; b++) sum += Momentum(simulation, b);
  return sum;
}

static inline PetscReal TotalEnergy(Simulation *simulation)
{
  PetscReal    sum = 0;
  BodyMeasures measures;

  for (PetscInt b = 0; b < simulation->n_bodies; b++) {
    CHECK(BodyGetMeasures(simulation->bodies[b], &measures));
    sum += measures.kinetic + measures.potential;
  }
  return sum;
}

static inline PetscErrorCode KeepMessage(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code, PetscErrorType type, const char *message, void *ctx)
{
  Simulation *simulation = (Simulation *)ctx;

  (void)comm;
  (void)line;
  (void)function;
  (void)file;
  if (type == PETSC_ERROR_INITIAL) snprintf(simulation->message, sizeof(simulation->message), "%s", message ? message : "");
  return code;
}

static inline void AssertMessage(const Simulation *simulation, const char text[], const char file[], int line)
{
  if (strstr(simulation->message, text)) return;
  print_error("the message is \"%s\"; it should contain \"%s\"\n", simulation->message, text);
  _fail(file, line);
}

#define assert_message(simulation, text) AssertMessage(simulation, text, __FILE__, __LINE__)

/* The call must end with this error code, on every rank */
#define expect_error(simulation, call, code) \
  do { \
    PetscErrorCode error_; \
\
    (simulation)->message[0] = 0; \
    CHECK(PetscPushErrorHandler(KeepMessage, simulation)); \
    error_ = (call); \
    CHECK(PetscPopErrorHandler()); \
    assert_int_equal(error_, code); \
  } while (0)

/* main() of a test program */
#define SIMULATION_MAIN(tests) \
  int main(int argc, char **argv) \
  { \
    PetscErrorCode error = ImpaktInitialize(&argc, &argv); \
    int            failed; \
\
    if (error) return ImpaktExit(error); \
    failed = cmocka_run_group_tests(tests, NULL, NULL); \
    error  = ImpaktFinalize(); \
    return failed ? failed : (int)error; \
  }
