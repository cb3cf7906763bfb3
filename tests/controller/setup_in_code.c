/* ranks: 1 2 */
/* A simulation that a program sets up is the one that options describe; what comes too late, or does not fit, is refused. What observers
   are told beside energies and contact: what holds the bodies, and points of them. */
#include "simulation.h"
#include <impakt/private/bodystep.h>

#define BODIES 2

/* What a run ends with */
typedef struct {
  BodyMeasures     bodies[BODIES];
  ContactPairState pairs[2];
  PetscInt         n_bodies, n_pairs, substeps[BODIES];
  PetscReal        mass[BODIES];
} End;

static void run(Controller controller, End *end)
{
  const Body *bodies;
  Contact     contact;

  ok(ControllerSolve(controller));
  ok(ControllerGetBodies(controller, &end->n_bodies, &bodies));
  ok(ControllerGetContact(controller, &contact));
  ok(ContactGetNumPairs(contact, &end->n_pairs));
  for (PetscInt b = 0; b < end->n_bodies; b++) {
    ok(BodyGetMeasures(bodies[b], &end->bodies[b]));
    ok(BodyGetSubsteps(bodies[b], &end->substeps[b]));
    ok(BodyGetMass(bodies[b], &end->mass[b]));
  }
  ok(ContactGetPairStates(contact, end->pairs));
  ok(ControllerDestroy(&controller));
}

static void run_options(End *end)
{
  Controller controller;

  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  ok(ControllerSetFromOptions(controller));
  ok(ControllerSetUp(controller));
  run(controller, end);
}

/* Bit for bit on one rank. On several, the mesh of the program may be distributed in another way, so that sums are rounded in another way:
   a few units of round-off in numbers that are below 100. */
static void expect_equal(const End *a, const End *b)
{
  PetscMPIInt size;
  PetscReal   round_off;

  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  round_off = size == 1 ? 0 : 1e-13;
  assert_int_equal(a->n_bodies, b->n_bodies);
  assert_int_equal(a->n_pairs, b->n_pairs);
  for (PetscInt i = 0; i < a->n_bodies; i++) {
    near(a->bodies[i].kinetic, b->bodies[i].kinetic, round_off);
    near(a->bodies[i].potential, b->bodies[i].potential, round_off);
    near(a->bodies[i].external_work, b->bodies[i].external_work, round_off);
    near(a->bodies[i].damping_work, b->bodies[i].damping_work, round_off);
    for (PetscInt d = 0; d < 3; d++) near(a->bodies[i].momentum[d], b->bodies[i].momentum[d], round_off);
    near(a->mass[i], b->mass[i], round_off);
    assert_int_equal(a->substeps[i], b->substeps[i]);
  }
  for (PetscInt p = 0; p < a->n_pairs; p++) {
    near(a->pairs[p].force, b->pairs[p].force, 10 * round_off);
    near(a->pairs[p].gap, b->pairs[p].gap, round_off);
    for (PetscInt d = 0; d < 3; d++) near(a->pairs[p].impulse[d], b->pairs[p].impulse[d], round_off);
    assert_int_equal(a->pairs[p].active, b->pairs[p].active);
  }
  assert_true(a->pairs[0].impulse[0] != 0 || a->pairs[0].impulse[1] != 0); /* they have touched */
}

static DM box(PetscInt dim, const PetscInt faces[], const PetscReal lower[], const PetscReal upper[])
{
  DM dm;

  ok(DMPlexCreateBoxMesh(PETSC_COMM_WORLD, dim, PETSC_FALSE, faces, lower, upper, NULL, PETSC_TRUE, 0, PETSC_FALSE, &dm));
  ok(DMSetFromOptions(dm)); /* distributes it */
  return dm;
}

static Material material(const char type[], PetscReal density, PetscReal modulus, PetscReal ratio)
{
  Material m;

  ok(MaterialCreate(PETSC_COMM_WORLD, &m));
  ok(MaterialSetType(m, type));
  ok(MaterialSetDensity(m, density));
  ok(MaterialSetYoungsModulus(m, modulus));
  ok(MaterialSetPoissonsRatio(m, ratio));
  return m;
}

static Body body(const char name[], DM dm, Material m)
{
  Body b;

  ok(BodyCreate(PETSC_COMM_WORLD, name, &b));
  ok(BodySetMaterial(b, m));
  ok(BodySetDM(b, dm));
  ok(DMDestroy(&dm));
  ok(MaterialDestroy(&m));
  return b;
}

static void add(Controller controller, Body b)
{
  ok(ControllerAddBody(controller, b));
  ok(BodyDestroy(&b));
}

/* Bars of different integrators, steps, masses and cross-sections, by the penalty method */
static void bars(void **state)
{
  const PetscInt  faces[2] = {8, 5};
  const PetscReal lower[2] = {-1, 0.002}, upper[2] = {0, 1}, velocity[2] = {0.5, -0.5};
  Controller      controller;
  Contact         contact;
  PetscBool       redistributed;
  BodyMassType    mass;
  TS              ts;
  End             options, code;
  Body            left, right;

  (void)state;
  AddOptions("-bodies left,right -time_start 1 -time_end 1.2 -time_step 0.02 -contact_pairs left:right -contact_type penalty "
             "-contact_tolerance 1e-9");
  AddOptions("-left_dm_plex_dim 1 -left_dm_plex_box_lower -1 -left_dm_plex_box_upper 0 -left_dm_plex_box_faces 8 -left_density 2 "
             "-left_youngs_modulus 3 -left_cross_section 0.5 -left_initial_velocity 0.5 -left_initial_displacement 0.001 "
             "-left_ts_type centraldifference -left_ts_time_step auto -left_mass_type lumped -left_damping_mass 0.3 "
             "-left_damping_stiffness 0.01");
  AddOptions("-right_dm_plex_dim 1 -right_dm_plex_box_lower 0.002 -right_dm_plex_box_upper 1 -right_dm_plex_box_faces 5 -right_density 1 "
             "-right_youngs_modulus 4 -right_initial_velocity -0.5 -right_ts_time_step 0.01 -right_ts_alpha_radius 0.9 "
             "-right_mass_redistribute false");
  run_options(&options);
  ok(PetscOptionsClear(NULL));

  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  left = body("left", box(1, &faces[0], &lower[0], &upper[0]), material(MATERIAL_LINEAR_ELASTIC, 2, 3, 0));
  ok(BodySetCrossSection(left, 0.5));
  ok(BodySetTSType(left, TSCENTRALDIFFERENCE));
  ok(BodySetTimeStep(left, PETSC_DETERMINE));
  ok(BodySetMassType(left, BODY_MASS_LUMPED));
  ok(BodySetDamping(left, 0.3, 0.01));
  ok(BodySetInitialVelocity(left, &velocity[0]));
  ok(BodySetInitialDisplacement(left, (const PetscReal[]){0.001}));
  ok(BodyGetMassType(left, &mass));
  assert_int_equal(mass, BODY_MASS_LUMPED);
  right = body("right", box(1, &faces[1], &lower[1], &upper[1]), material(MATERIAL_LINEAR_ELASTIC, 1, 4, 0));
  ok(BodySetTimeStep(right, 0.01));
  ok(BodyGetTS(right, &ts));
  ok(TSAlpha2SetRadius(ts, 0.9));
  ok(BodySetMassRedistribute(right, PETSC_FALSE));
  ok(BodySetInitialVelocity(right, &velocity[1]));
  ok(BodyIsRedistributed(right, &redistributed));
  assert_false(redistributed);
  ok(BodyGetMassType(right, &mass));
  assert_int_equal(mass, BODY_MASS_AVERAGED); /* of implicit bodies, where nobody has asked for another */
  add(controller, left);
  add(controller, right);
  ok(ControllerSetTimes(controller, 1, 1.2, 0.02));
  ok(ControllerGetContact(controller, &contact));
  ok(ContactAddPair(contact, "left:right"));
  ok(ContactSetType(contact, CONTACT_PENALTY));
  ok(PetscOptionsSetValue(NULL, "-contact_tolerance", "1e-9"));
  ok(ControllerSetFromOptions(controller)); /* the penalty method reads its defaults there */
  run(controller, &code);
  expect_equal(&options, &code);
}

/* A loaded plate in plane stress that falls on a floor, and touches a disc; by Schwarz */
static void plate(void **state)
{
  const PetscInt  faces[2] = {4, 3};
  const PetscReal lower[2] = {0, 0}, upper[2] = {1, 0.6}, gravity[2] = {0.1, -1};
  const PetscReal point[3] = {0, -0.01, 0}, normal[3] = {0, 2, 0}, centre[3] = {2.2, 0.3, 0};
  Controller      controller;
  Contact         contact;
  Obstacle        floor_plane, disc;
  ObstacleType    type;
  ContactLaw      law;
  End             options, code;
  Body            b;

  (void)state;
  AddOptions("-bodies plate -time_end 0.1 -time_step 5e-3 -obstacles floor,disc -contact_pairs plate:floor,plate.xmax:disc "
             "-contact_slip_bound 0.3 -contact_angle_bound 0.2 -contact_facing false");
  AddOptions("-floor_obstacle_type plane -floor_point 0,-0.01 -floor_normal 0,2 -disc_obstacle_type cylinder -disc_point 2.2,0.3 "
             "-disc_radius 1.15");
  AddOptions(
      "-plate_dm_plex_dim 2 -plate_dm_plex_box_lower 0,0 -plate_dm_plex_box_upper 1,0.6 -plate_dm_plex_box_faces 4,3 "
      "-plate_material_type neo_hookean -plate_density 10 -plate_youngs_modulus 1000 -plate_poissons_ratio 0.3 -plate_thickness 0.2 "
      "-plate_plane_stress -plate_gravity 0.1,-1 -plate_body_force 2*t,0 -plate_boundary_traction ymax,xmin "
      "-plate_boundary_traction_ymax 0,-3*x -plate_boundary_traction_xmin 5*nx,0 -plate_boundary_displacement xmin,xmax "
      "-plate_boundary_displacement_xmin free,-0.2*t -plate_boundary_displacement_xmax free,-0.21*t -plate_initial_velocity 0.1,-0.2");
  run_options(&options);
  ok(PetscOptionsClear(NULL));

  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  b = body("plate", box(2, faces, lower, upper), material(MATERIAL_NEO_HOOKEAN, 10, 1000, 0.3));
  ok(BodySetThickness(b, 0.2));
  ok(BodySetPlaneStress(b, PETSC_TRUE));
  ok(BodySetGravity(b, gravity));
  ok(BodyAddBodyForce(b, "2*t,0"));
  ok(BodyAddTraction(b, "ymax", "0,-3*x"));
  ok(BodyAddTraction(b, "xmin", "5*nx,0"));
  ok(BodyAddDisplacement(b, "xmin", "free,-0.2*t"));
  ok(BodyAddDisplacement(b, "xmax", "free,-0.21*t"));
  ok(BodySetInitialVelocity(b, (const PetscReal[]){0.1, -0.2}));
  add(controller, b);
  ok(ControllerSetTimes(controller, 0, 0.1, 5e-3));
  ok(ControllerGetContact(controller, &contact));
  ok(ObstacleCreate(PETSC_COMM_WORLD, "floor", &floor_plane));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'floor'|no shape", ContactAddObstacle(contact, floor_plane));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'floor'|no direction",
          ObstacleSetShape(floor_plane, OBSTACLE_PLANE, point, (const PetscReal[]){0, 0, 0}, 0));
  ok(ObstacleSetShape(floor_plane, OBSTACLE_PLANE, point, normal, 0));
  ok(ContactAddObstacle(contact, floor_plane));
  refused(PETSC_ERR_USER_INPUT, "'floor' is the name of an obstacle already", ContactAddObstacle(contact, floor_plane));
  ok(ObstacleDestroy(&floor_plane));
  ok(ObstacleCreate(PETSC_COMM_WORLD, "plate", &disc));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "radius of 0. m", ObstacleSetShape(disc, OBSTACLE_SPHERE, centre, NULL, 0));
  ok(ObstacleSetShape(disc, OBSTACLE_CYLINDER, centre, NULL, 1.15));
  ok(ObstacleGetShape(disc, &type, NULL, NULL));
  assert_int_equal(type, OBSTACLE_CYLINDER);
  refused(PETSC_ERR_USER_INPUT, "'plate' is the name of a body already", ContactAddObstacle(contact, disc));
  ok(PetscObjectSetName((PetscObject)disc, "disc"));
  ok(ContactAddObstacle(contact, disc));
  ok(ObstacleDestroy(&disc));
  ok(ContactAddPair(contact, "plate:floor"));
  ok(ContactAddPair(contact, "plate.xmax:disc"));
  ok(PetscOptionsInsertString(NULL, "-contact_slip_bound 0.3 -contact_angle_bound 0.2 -contact_facing false"));
  ok(ContactSetFromOptions(contact));
  ok(ContactGetPairLaw(contact, 0, &law));
  assert_int_equal(law, CONTACT_LAW_FRICTIONLESS);
  ok(ControllerSetUp(controller));
  run(controller, &code);
  expect_equal(&options, &code);
}

/* Two blocks that are glued to each other; the lower one falls on a floor with friction. Each pair has its law */
static void laws_of_pairs(void **state)
{
  const PetscInt  faces[2]     = {3, 3};
  const PetscReal corners[][2] = {{0, 0}, {1, 1}, {0, 1}, {1, 2}}, velocity[2] = {0.5, -1};
  const PetscReal point[3] = {0, -0.001, 0}, normal[3] = {0, 1, 0};
  Controller      controller;
  Contact         contact;
  Obstacle        floor_plane;
  ContactLaw      law;
  ContactTraits   traits;
  End             options, code;
  Body            low, high;

  (void)state;
  AddOptions("-bodies low,high -time_end 4e-3 -time_step 1e-4 -obstacles floor -floor_obstacle_type plane -floor_point 0,-0.001 "
             "-floor_normal 0,1 -contact_type force -contact_pairs low.ymax:high.ymin,low.ymin:floor "
             "-contact_law_low.ymax:high.ymin spring -contact_spring_stiffness 1 -contact_spring_stiffness_low.ymax:high.ymin 1e4 "
             "-contact_law_low.ymin:floor coulomb -contact_friction 0.3");
  AddOptions("-low_dm_plex_dim 2 -low_dm_plex_box_faces 3,3 -low_density 1 -low_youngs_modulus 1e4 -low_initial_velocity 0.5,-1 "
             "-high_dm_plex_dim 2 -high_dm_plex_box_lower 0,1 -high_dm_plex_box_upper 1,2 -high_dm_plex_box_faces 3,3 -high_density 1 "
             "-high_youngs_modulus 1e4 -high_initial_velocity 0.5,-1");
  run_options(&options);
  ok(PetscOptionsClear(NULL));

  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  low  = body("low", box(2, faces, corners[0], corners[1]), material(MATERIAL_LINEAR_ELASTIC, 1, 1e4, 0));
  high = body("high", box(2, faces, corners[2], corners[3]), material(MATERIAL_LINEAR_ELASTIC, 1, 1e4, 0));
  ok(BodySetInitialVelocity(low, velocity));
  ok(BodySetInitialVelocity(high, velocity));
  add(controller, low);
  add(controller, high);
  ok(ControllerSetTimes(controller, 0, 4e-3, 1e-4));
  ok(ControllerGetContact(controller, &contact));
  ok(ObstacleCreate(PETSC_COMM_WORLD, "floor", &floor_plane));
  ok(ObstacleSetShape(floor_plane, OBSTACLE_PLANE, point, normal, 0));
  ok(ContactAddObstacle(contact, floor_plane));
  ok(ObstacleDestroy(&floor_plane));
  ok(ContactSetType(contact, CONTACT_FORCE));
  ok(ContactAddPair(contact, "low.ymax:high.ymin"));
  ok(ContactAddPair(contact, "low.ymin:floor"));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "no pair 2", ContactSetLaw(contact, 2, "tied"));
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "'sand'|coulomb|spring", ContactSetLaw(contact, 1, "sand"));
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "'tie'|tied", ContactSetLaw(contact, 0, "tie"));
  refused(PETSC_ERR_ARG_WRONGSTATE, "low.ymax:high.ymin|ContactSetLaw", ContactSetLawParameter(contact, 0, "spring", "stiffness", 1));
  ok(ContactSetLaw(contact, 0, "spring"));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "stiffness_low.ymax:high.ymin -1|positive",
          ContactSetLawParameter(contact, 0, "spring", "stiffness", -1));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "stiffness 0|positive", ContactSetLawParameter(contact, -1, "spring", "stiffness", 0));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "spring|no parameter 'length'", ContactSetLawParameter(contact, -1, "spring", "length", 1));
  ok(ContactSetLawParameter(contact, -1, "spring", "stiffness", 1));
  ok(ContactSetLawParameter(contact, 0, "spring", "stiffness", 1e4));
  ok(ContactSetLaw(contact, 1, "coulomb"));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "friction_decay|all pairs", ContactSetLawParameter(contact, 1, "coulomb", "friction_decay", 1));
  ok(ContactSetLawParameter(contact, -1, "coulomb", "friction", 0.3));
  ok(ContactSetLaw(contact, -1, "tied")); /* of pairs that have none of their own: there are none */
  ok(ContactGetPairLaw(contact, 0, &law));
  assert_int_equal(law, CONTACT_LAW_GLUE);
  ok(ContactGetPairLaw(contact, 1, &law));
  assert_int_equal(law, CONTACT_LAW_FRICTION);
  ok(ContactGetTraits(contact, &traits));
  assert_true(traits.friction && traits.glue && traits.pulls && !traits.breaks);
  ok(ControllerSetUp(controller));
  run(controller, &code);
  expect_equal(&options, &code);
}

/* What a program has set holds where the options are silent, and gives way where they speak */
static void options_come_over_the_program(void **state)
{
  const PetscInt  faces[1] = {4};
  const PetscReal lower[1] = {0}, upper[1] = {1};
  Controller      controller;
  Contact         contact;
  ContactType     type;
  BodyMassType    mass;
  PetscReal       start, step, density;
  PetscBool       is_explicit;
  PetscInt        n;
  Material        m;
  Body            b;

  (void)state;
  AddOptions("-bar_ts_type centraldifference -bar_density 5 -time_step 0.5 -contact_type lagrange");
  AddBar("other", 1, 2, 3, 0);
  AddOptions("-bodies other");
  m = material(MATERIAL_LINEAR_ELASTIC, 1, 1, 0);
  ok(PetscObjectSetOptionsPrefix((PetscObject)m, "bar_"));
  ok(MaterialSetFromOptions(m));
  ok(MaterialGetDensity(m, &density));
  near(density, 5, 0);
  ok(MaterialGetYoungsModulus(m, &density));
  near(density, 1, 0);
  b = body("bar", box(1, faces, lower, upper), m);
  ok(BodySetTSType(b, TSSTATIC));
  ok(BodySetMassType(b, BODY_MASS_CONSISTENT));
  ok(BodySetFromOptions(b));
  ok(BodyIsExplicit(b, &is_explicit));
  assert_true(is_explicit);
  ok(BodyGetMassType(b, &mass));
  assert_int_equal(mass, BODY_MASS_CONSISTENT);
  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  ok(ControllerAddBody(controller, b));
  ok(BodyDestroy(&b));
  ok(ControllerSetTimes(controller, 2, 3, 0.25));
  ok(ControllerSetFromOptions(controller));
  ok(ControllerGetTimes(controller, &start, &step, &n));
  near(start, 2, 0);
  near(step, 0.5, 0);
  assert_int_equal(n, 2);
  ok(ControllerGetBodies(controller, &n, NULL));
  assert_int_equal(n, 2);
  ok(ControllerGetContact(controller, &contact));
  ok(ContactGetType(contact, &type));
  assert_string_equal(type, CONTACT_LAGRANGE);
  ok(ContactGetNumPairs(contact, &n));
  assert_int_equal(n, 1); /* two bodies are a pair by themselves */
  ok(ControllerDestroy(&controller));
}

static void what_comes_too_late_is_refused(void **state)
{
  const PetscInt  faces[1] = {4};
  const PetscReal lower[1] = {0}, upper[1] = {1}, zero[1] = {0};
  Material        m  = material(MATERIAL_LINEAR_ELASTIC, 1, 1, 0);
  DM              dm = box(1, faces, lower, upper);
  Controller      controller;
  Contact         contact;
  Body            b;
  Vec             positions;

  (void)state;
  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  refused(PETSC_ERR_ARG_WRONGSTATE, "no bodies|ControllerAddBody()", ControllerSetUp(controller));
  refused(PETSC_ERR_ARG_WRONGSTATE, "no bodies|ControllerAddBody()", ControllerGetContact(controller, &contact));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "must be positive", ControllerSetTimes(controller, 0, 1, 0));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "later than", ControllerSetTimes(controller, 1, 1, 0.1));
  ok(BodyCreate(PETSC_COMM_WORLD, "bar", &b));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar' has no mesh|BodySetDM()", BodySetUp(b));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar' has no mesh yet", BodyGetDimension(b, (PetscInt[]){0}));
  ok(BodySetDM(b, dm));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar' has no material|BodySetMaterial()", BodySetUp(b));
  ok(BodySetMaterial(b, m));
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "'euler'|alpha2", BodySetTSType(b, TSEULER));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|-2. s must not be negative", BodySetTimeStep(b, -2));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|no mass type 7", BodySetMassType(b, (BodyMassType)7));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "cross-section of 0.", BodySetCrossSection(b, 0));
  ok(BodyAddTraction(b, "xmax", "1"));
  refused(PETSC_ERR_USER_INPUT, "no surface 'ymin'", BodyAddDisplacement(b, "ymin", "0"));
  /* from here on the mesh is numbered */
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetDM()|'bar'|elements have been made", BodySetDM(b, dm));
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetMaterial()|'bar'", BodySetMaterial(b, m));
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetCrossSection()|'bar'", BodySetCrossSection(b, 1));
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetFromOptions()|'bar'", BodySetFromOptions(b));
  ok(ControllerAddBody(controller, b));
  refused(PETSC_ERR_USER_INPUT, "'bar' twice", ControllerAddBody(controller, b));
  refused(PETSC_ERR_ARG_WRONGSTATE, "no times|ControllerSetTimes()", ControllerSetUp(controller));
  ok(ControllerSetTimes(controller, 0, 1, 0.1));
  ok(ControllerSetUp(controller));
  refused(PETSC_ERR_ARG_WRONGSTATE, "before ControllerGetContact()", ControllerAddBody(controller, b));
  refused(PETSC_ERR_ARG_WRONGSTATE, "before ControllerSetUp()", ControllerSetTimes(controller, 0, 1, 0.1));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|before BodySetUp()", BodySetTSType(b, TSSTATIC));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|before BodySetUp()", BodySetTimeStep(b, 0.1));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|BodySetMassType()|before BodySetUp()", BodySetMassType(b, BODY_MASS_LUMPED));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|before BodySetUp()", BodyAddTraction(b, "xmax", "1"));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|before BodySetUp()", BodySetGravity(b, zero));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|BodySetInitialState()", BodySetInitialVelocity(b, zero));
  ok(ControllerGetContact(controller, &contact));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ContactSetLaw()|before ContactSetUp()", ContactSetLaw(contact, -1, "tied"));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "no pair 0; there are 0", ContactGetPair(contact, 0, NULL, NULL, NULL));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "interval of 0 steps must be positive", ControllerSetMonitorInterval(controller, 0));
  ok(BodyGetReferencePositions(b, &positions));
  ok(BodyDestroy(&b));
  ok(ControllerDestroy(&controller));
  ok(MaterialDestroy(&m));
  ok(DMDestroy(&dm));
}

/* One mesh and one material for several bodies, which they leave as they were */
static void mesh_and_material_are_shared(void **state)
{
  const PetscInt  faces[2] = {3, 2};
  const PetscReal lower[2] = {0, 0}, upper[2] = {1, 1};
  Material        m  = material(MATERIAL_LINEAR_ELASTIC, 1, 1, 0.3);
  DM              dm = box(2, faces, lower, upper), mine;
  PetscReal       mass;
  PetscInt        fields;

  (void)state;
  for (PetscInt i = 0; i < 2; i++) {
    Body b;

    ok(BodyCreate(PETSC_COMM_WORLD, i ? "second" : "first", &b));
    ok(BodySetDM(b, dm));
    ok(BodySetMaterial(b, m));
    ok(BodySetThickness(b, 2 + i));
    ok(BodySetControllerStep(b, 0, 0.1));
    ok(BodySetUp(b));
    ok(BodyGetMass(b, &mass));
    near(mass, 2 + i, 1e-14);
    ok(BodyGetDM(b, &mine));
    assert_ptr_not_equal(mine, dm);
    ok(BodyDestroy(&b));
  }
  ok(DMGetNumFields(dm, &fields));
  assert_int_equal(fields, 0);
  ok(DMDestroy(&dm));
  ok(MaterialDestroy(&m));
}

static void unsuitable_meshes_are_refused(void **state)
{
  const PetscReal vertices[8] = {0, 0, 1, 0, 1, 1, 0, 1};
  const PetscReal shell[12]   = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const PetscInt  cells[4] = {0, 1, 2, 3}, faces[2] = {2, 2};
  const PetscReal lower[2] = {0, 0}, upper[2] = {1, 1};
  PetscMPIInt     size;
  Material        m = material(MATERIAL_LINEAR_ELASTIC, 1, 1, 0);
  DM              dm;
  Body            b;

  (void)state;
  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  ok(BodyCreate(PETSC_COMM_WORLD, "bar", &b));
  ok(DMCreate(PETSC_COMM_WORLD, &dm));
  refused(PETSC_ERR_ARG_WRONG, "'bar'|must be a DMPLEX", BodySetDM(b, dm));
  ok(DMDestroy(&dm));
  if (size == 1) {
    ok(DMPlexCreateFromCellListPetsc(PETSC_COMM_WORLD, 2, 1, 4, 4, PETSC_FALSE, cells, 2, vertices, &dm));
    refused(PETSC_ERR_ARG_WRONG, "'bar'|DMPlexInterpolate()", BodySetDM(b, dm));
    ok(DMDestroy(&dm));
    ok(DMPlexCreateFromCellListPetsc(PETSC_COMM_WORLD, 2, 1, 4, 4, PETSC_TRUE, cells, 3, shell, &dm));
    refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|2 dimensions in a space of 3", BodySetDM(b, dm));
    ok(DMDestroy(&dm));
  } else {
    ok(DMPlexCreateBoxMesh(PETSC_COMM_SELF, 2, PETSC_FALSE, faces, lower, upper, NULL, PETSC_TRUE, 0, PETSC_FALSE, &dm));
    refused(PETSC_ERR_ARG_NOTSAMECOMM, "'bar'|other ranks", BodySetDM(b, dm));
    ok(DMDestroy(&dm));
  }
  /* a cross-section is nothing that a plate has */
  dm = box(2, faces, lower, upper);
  ok(BodySetDM(b, dm));
  ok(DMDestroy(&dm));
  ok(BodySetMaterial(b, m));
  ok(BodySetCrossSection(b, 3));
  refused(PETSC_ERR_ARG_INCOMP, "2 dimensions have no cross-section|3", BodySetUp(b));
  ok(BodyDestroy(&b));
  ok(MaterialDestroy(&m));
}

static void incomplete_materials_are_refused(void **state)
{
  const PetscInt  faces[1] = {2};
  const PetscReal lower[1] = {0}, upper[1] = {1};
  DM              dm = box(1, faces, lower, upper);
  Material        m;
  Body            b;
  PetscReal       value;

  (void)state;
  ok(MaterialCreate(PETSC_COMM_WORLD, &m));
  ok(BodyCreate(PETSC_COMM_WORLD, "bar", &b));
  ok(BodySetDM(b, dm));
  ok(BodySetMaterial(b, m));
  refused(PETSC_ERR_ARG_WRONGSTATE, "no type|MaterialSetType()", BodySetUp(b));
  refused(PETSC_ERR_SUP, "MaterialSetYoungsModulus", MaterialSetYoungsModulus(m, 1)); /* no model, no modulus */
  ok(MaterialSetType(m, MATERIAL_NEO_HOOKEAN));
  refused(PETSC_ERR_ARG_WRONGSTATE, "no density|MaterialSetDensity()", BodySetUp(b));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "density of -1.", MaterialSetDensity(m, -1));
  ok(MaterialSetDensity(m, 1));
  refused(PETSC_ERR_ARG_WRONGSTATE, "no Young's modulus|MaterialSetYoungsModulus()", BodySetUp(b));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "modulus is 0. Pa", MaterialSetYoungsModulus(m, 0));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "ratio is 0.5", MaterialSetPoissonsRatio(m, 0.5));
  ok(MaterialSetPoissonsRatio(m, 0.25)); /* in any order */
  ok(MaterialSetYoungsModulus(m, 8));
  ok(MaterialGetPoissonsRatio(m, &value));
  near(value, 0.25, 0);
  ok(MaterialGetWaveModulus(m, &value));
  near(value, 9.6, 1e-14); /* lambda + 2 mu, lambda = mu = 3.2 */
  ok(BodySetControllerStep(b, 0, 0.1));
  ok(BodySetUp(b));
  ok(BodyDestroy(&b));
  ok(MaterialDestroy(&m));
  ok(DMDestroy(&dm));
}

#define FORCE 0.02

static Simulation *simulation_of_a_held_bar(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  /* pulled away from its support into a wall, slowly: static */
  AddOptions(
      "-bodies bar -obstacles wall -wall_obstacle_type plane -wall_point 2.01 -wall_normal -1 -contact_pairs bar.xmax:wall -time_end 2 "
      "-time_step 1 -bar_dm_plex_dim 1 -bar_dm_plex_box_upper 2 -bar_dm_plex_box_faces 8 -bar_density 1 -bar_youngs_modulus 1 "
      "-bar_ts_type static -bar_boundary_displacement xmin -bar_boundary_displacement_xmin 0 -bar_body_force 0.02*t -bar_probe 0.6;2");
  ok(SimulationCreate(simulation));
  return simulation;
}

/* The bar gets as far as the wall under half of the first load, 0.02 N/m: u(2) = f L^2 / 2 E A = 0.04 without it. With it, at the load
   f, the wall has R = f L / 2 - E A d / L, and the support the rest. */
static void supports_and_probes(void **state)
{
  Simulation              *simulation = simulation_of_a_held_bar(state);
  const ControllerSupport *supports;
  const ControllerProbe   *probes;
  const char              *name;
  PetscReal                force[3], moment[3], position[6], displacement[6], velocity[6], stress[12], wall;
  PetscInt                 n, i;
  const Obstacle          *obstacles;

  ok(ControllerSolve(simulation->controller));
  ok(ControllerGetSupports(simulation->controller, &n, &supports));
  assert_int_equal(n, 2);
  assert_int_equal(supports[0].body, 0);
  assert_string_equal(supports[0].name, "xmin");
  assert_int_equal(supports[1].body, -1);
  assert_string_equal(supports[1].name, "wall");
  wall = 2 * FORCE * 2 / 2 - 0.01 / 2;
  near(supports[1].force[0], -wall, 1e-12);
  near(supports[0].force[0], -(2 * FORCE * 2 - wall), 1e-12);
  for (PetscInt d = 1; d < 3; d++) near(supports[0].force[d], 0, 0);
  ok(BodyGetNumReactions(simulation->bodies[0], &n));
  assert_int_equal(n, 1);
  ok(BodyGetReactionSurface(simulation->bodies[0], 0, &name));
  assert_string_equal(name, "xmin");
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|no surface 1", BodyGetReactionSurface(simulation->bodies[0], 1, &name));
  ok(BodyGetReactions(simulation->bodies[0], force, moment));
  near(force[0], supports[0].force[0], 0);
  ok(ContactGetObstacles(simulation->contact, &n, &obstacles));
  assert_int_equal(n, 1);
  ok(PetscObjectGetName((PetscObject)obstacles[0], &name));
  assert_string_equal(name, "wall");
  ok(ContactGetPairTraits(simulation->contact, 0, NULL, &i, NULL));
  assert_int_equal(i, 0);
  refused(PETSC_ERR_ARG_OUTOFRANGE, "no pair 1", ContactGetPairTraits(simulation->contact, 1, NULL, &i, NULL));

  ok(ControllerGetProbes(simulation->controller, &n, &probes));
  assert_int_equal(n, 2);
  assert_int_equal(probes[1].body, 0);
  assert_int_equal(probes[1].number, 1);
  near(probes[1].position[0], 2.01, 1e-14);
  near(probes[1].displacement[0], 0.01, 1e-14);
  ok(BodyGetNumProbes(simulation->bodies[0], &n));
  assert_int_equal(n, 2);
  ok(BodyGetProbes(simulation->bodies[0], position, displacement, velocity, stress));
  near(position[0], 0.6 + displacement[0], 1e-15);
  near(displacement[0], probes[0].displacement[0], 0);
  /* the mean of the element from 0.5 to 0.75: support less the load up to 0.625 */
  near(stress[0], -supports[0].force[0] - 2 * FORCE * 0.625, 1e-12);
}

static void what_comes_too_early_is_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Controller  controller;
  PetscInt    n;

  (void)simulation;
  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ControllerSetUp()", ControllerGetSupports(controller, &n, NULL));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ControllerSetUp()", ControllerGetProbes(controller, &n, NULL));
  ok(ControllerDestroy(&controller));
}

/* After the set-up there is no place for another one */
static void probes_come_before_the_set_up(void **state)
{
  Simulation     *simulation = simulation_of_a_held_bar(state);
  const PetscReal x[1]       = {0.5};

  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|BodyAddProbe()", BodyAddProbe(simulation->bodies[0], x));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|BodySetDamping()", BodySetDamping(simulation->bodies[0], 0, 0));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(bars),
      simulation_test(plate),
      simulation_test(laws_of_pairs),
      simulation_test(options_come_over_the_program),
      simulation_test(what_comes_too_late_is_refused),
      simulation_test(mesh_and_material_are_shared),
      simulation_test(unsuitable_meshes_are_refused),
      simulation_test(incomplete_materials_are_refused),
      simulation_test(supports_and_probes),
      simulation_test(what_comes_too_early_is_refused),
      simulation_test(probes_come_before_the_set_up),
  };

  return impakt_main(argc, argv, tests);
}
