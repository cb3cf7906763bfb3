/* What the tests of surfaces, contact, controller and output share: meshes, bars, a controller. */
#pragma once
#include "support.h"
#include <impakt/private/contactsteps.h>

typedef struct {
  PetscOptions options; /* of this test alone */
  Controller   controller;
  Contact      contact; /* the controller's, as are the bodies */
  PetscInt     n_bodies;
  const Body  *bodies;
} Simulation;

/* Each test begins with an empty options database, and ends with its controller destroyed */
static inline int SimulationOpen(void **state)
{
  Simulation *simulation;

  ok(PetscNew(&simulation));
  simulation->options = options_begin("");
  *state              = simulation;
  return 0;
}

static inline int SimulationClose(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  ok(ControllerDestroy(&simulation->controller));
  options_drop(simulation->options);
  ok(PetscFree(simulation));
  return 0;
}

#define simulation_test(function) cmocka_unit_test_setup_teardown(function, SimulationOpen, SimulationClose)

static inline void AddOptions(const char options[])
{
  ok(PetscOptionsInsertString(NULL, options));
}

/* A bar of cross-section 1 from `lower` to `upper` [m]; density 1 and Young's modulus 1: waves run at 1 m/s, and a bar of
   length l weighs l kg */
static inline void AddBar(const char name[], PetscReal lower, PetscReal upper, PetscInt elements, PetscReal velocity)
{
  char options[1024];

  ok(PetscSNPrintf(options, sizeof(options),
                   "-%s_dm_plex_dim 1 -%s_dm_plex_box_lower %.17g -%s_dm_plex_box_upper %.17g -%s_dm_plex_box_faces %d -%s_density 1 "
                   "-%s_youngs_modulus 1 -%s_initial_velocity %.17g",
                   name, name, (double)lower, name, (double)upper, name, (int)elements, name, name, name, (double)velocity));
  AddOptions(options);
}

/* A box of boxes, or of triangles in two dimensions, with a block of displacements at each vertex, as a body's mesh has it */
static inline DM CreateBoxMesh(const char name[], PetscInt dim, const char faces[], const char lower[], const char upper[],
                               PetscBool simplex)
{
  PetscSection section;
  PetscInt     start, end, vstart, vend;
  char         options[512];
  DM           dm;

  ok(PetscSNPrintf(options, sizeof(options),
                   "-dm_plex_dim %d -dm_plex_box_faces %s -dm_plex_box_lower %s -dm_plex_box_upper %s -dm_plex_simplex 0", (int)dim, faces,
                   lower, upper));
  AddOptions(options);
  /* each quadrilateral cut into two triangles: PETSc alone has no generator of triangles */
  if (simplex && dim > 1) AddOptions("-dm_plex_transform_type refine_tosimplex -dm_refine 1");
  ok(DMCreate(PETSC_COMM_WORLD, &dm));
  ok(PetscObjectSetName((PetscObject)dm, name));
  ok(DMSetType(dm, DMPLEX));
  ok(DMSetFromOptions(dm));
  ok(DMPlexGetChart(dm, &start, &end));
  ok(DMPlexGetDepthStratum(dm, 0, &vstart, &vend));
  ok(PetscSectionCreate(PetscObjectComm((PetscObject)dm), &section));
  ok(PetscSectionSetChart(section, start, end));
  for (PetscInt v = vstart; v < vend; v++) ok(PetscSectionSetDof(section, v, dim));
  ok(PetscSectionSetUp(section));
  ok(DMSetLocalSection(dm, section));
  ok(PetscSectionDestroy(&section));
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
  ok(ControllerDestroy(&simulation->controller));
  AddOptions(options);
  ok(SimulationCreate(simulation));
}

/* One controller step with all its parts, see ContactTraits, and the only pair at its end */
static inline ContactPairState Step(Simulation *simulation)
{
  ContactPairState pairs[16];
  ContactTraits    traits;
  PetscInt         n;

  ok(ContactGetNumPairs(simulation->contact, &n));
  assert_in_range(n, 1, 16);
  ok(ContactGetTraits(simulation->contact, &traits));
  for (PetscInt part = 0; part < traits.parts; part++) {
    ok(ContactStep(simulation->contact));
    ok(ContactAccept(simulation->contact));
  }
  ok(ContactGetPairStates(simulation->contact, pairs));
  return pairs[0];
}

static inline PetscReal Momentum(Simulation *simulation, PetscInt body)
{
  BodyMeasures measures;

  ok(BodyGetMeasures(simulation->bodies[body], &measures));
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
    ok(BodyGetMeasures(simulation->bodies[b], &measures));
    sum += measures.kinetic + measures.potential;
  }
  return sum;
}

/* Two bars that lie 2 mm apart and fly towards each other at 0.2 m/s, both also along with the frame [m/s]; with controller
   steps of 0.02 s the first one would end in 2 mm of penetration */
#define COLLISION_GAP   2e-3
#define COLLISION_SPEED 0.1
#define COLLISION_STEP  0.02
static inline void AddCollision(PetscInt left_elements, PetscInt right_elements, PetscReal frame)
{
  AddBar("left", -1, -COLLISION_GAP / 2, left_elements, frame + COLLISION_SPEED);
  AddBar("right", COLLISION_GAP / 2, 1, right_elements, frame - COLLISION_SPEED);
  AddOptions("-bodies left,right -contact_pairs left:right -time_step 0.02 -time_end 0.2");
}
