/* ranks: 1 3 */
/* A body from its options, and of several materials as a program makes it: what it takes, what it refuses, where it loses a number. */
#include "support.h"
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodyrows.h>
#include <impakt/private/bodystep.h>

#define MESH     "-dm_plex_box_faces 10 -dm_plex_box_lower 1 -dm_plex_box_upper 3 "
#define MATERIAL "-density 4 -youngs_modulus 16 -cross_section 0.5 "

/* c = 2 m/s, h = 0.2 m: a lumped explicit body is stable up to 0.1 s */

static void is_made_from_options_alone(void **state)
{
  Body         body;
  PetscOptions options = bar_create(
      &body,
      MESH MATERIAL "-mass_type lumped -ts_type centraldifference -ts_time_step 0.05 -initial_velocity 3 -initial_displacement -0.25");
  PetscReal mass, density;
  PetscInt  substeps, dofs, dim;
  PetscBool is_explicit;
  Material  material;
  Vec       u, v, a, positions;
  DM        dm;

  (void)state;
  ok(BodySetControllerStep(body, 0.5, 0.15));
  ok(BodySetUp(body));
  ok(BodySetUp(body)); /* a second time changes nothing */
  ok(BodyGetMass(body, &mass));
  near(mass, 4, 1e-14); /* 4 kg/m^3 * 0.5 m^2 * 2 m */
  ok(BodyGetMaterial(body, &material));
  ok(MaterialGetDensity(material, &density));
  assert_true(density == 4);
  ok(BodyIsExplicit(body, &is_explicit));
  assert_true(is_explicit);
  ok(BodyGetSubsteps(body, &substeps));
  assert_int_equal(substeps, 3);
  ok(BodyGetDM(body, &dm));
  ok(DMGetDimension(dm, &dim));
  assert_int_equal(dim, 1);
  ok(BodyGetReferencePositions(body, &positions));
  ok(VecGetSize(positions, &dofs));
  assert_int_equal(dofs, 11);
  ok(BodyGetSolution(body, &u, &v, &a));
  for (PetscInt i = 0; i <= 10; i++) {
    near(value_at(body, positions, 1 + 0.2 * i), 1 + 0.2 * i, 1e-15); /* one rounding */
    assert_true(value_at(body, u, 1 + 0.2 * i) == -0.25);
    assert_true(value_at(body, v, 1 + 0.2 * i) == 3);
  }
  ok(VecNorm(a, NORM_INFINITY, &mass));
  near(mass, 0, 1e-12); /* a constant displacement; round-off of differences of 0.25, times E A / h / m */
  bar_destroy(&body, options);
}

/* The largest whole fraction of the controller step below 0.9 of the stable step */
static void chooses_its_own_step(void **state)
{
  const PetscReal steps[] = {0.05, 0.09, 0.091, 0.5, 1, 7.3};

  (void)state;
  for (size_t k = 0; k < sizeof(steps) / sizeof(steps[0]); k++) {
    Body         body;
    PetscOptions options = bar_create(&body, MESH MATERIAL "-mass_type lumped -ts_type centraldifference -ts_time_step auto");
    PetscReal    stable, step;
    PetscInt     n;
    TS           ts;

    ok(BodySetControllerStep(body, 0, steps[k]));
    ok(BodySetUp(body));
    ok(BodyGetStableStep(body, &stable));
    ok(BodyGetSubsteps(body, &n));
    ok(BodyGetTS(body, &ts));
    ok(TSGetTimeStep(ts, &step));
    near(stable, 0.1, 1e-15);                   /* h / c */
    near(n * step, steps[k], 1e-15 * steps[k]); /* divides, to the last place */
    assert_true(step <= 0.9 * stable * (1 + 1e-11));
    if (n > 1) assert_true(steps[k] / (n - 1) > 0.9 * stable); /* one less would be too large */
    bar_destroy(&body, options);
  }
}

/* Without a substep of its own, an explicit body makes one to a controller step that is stable, and chooses beyond: h / c = 0.1 s */
static void substeps_by_default(void **state)
{
  static const struct {
    PetscReal step;
    PetscInt  substeps;
  } cases[] = {{0.05, 1}, {0.0999, 1}, {0.1, 1}, {0.1001, 2}, {0.5, 6}, {7.3, 82}};

  (void)state;
  for (size_t k = 0; k < sizeof(cases) / sizeof(cases[0]); k++)
    for (PetscInt is_explicit = 0; is_explicit < 2; is_explicit++) {
      Body         body;
      PetscOptions options = bar_create(&body, MESH MATERIAL "-mass_type lumped -ts_type %s", is_explicit ? "centraldifference" : "alpha2");
      PetscInt     n;

      ok(BodySetControllerStep(body, 0, cases[k].step));
      ok(BodySetUp(body));
      ok(BodyGetSubsteps(body, &n));
      assert_int_equal(n, is_explicit ? cases[k].substeps : 1);
      bar_destroy(&body, options);
    }
}

/* Each is refused when options are read, or when the body is set up with a controller step of 0.3 s */
static void refuses_bad_input(void **state)
{
  const struct {
    const char    *options, *words;
    PetscErrorCode code;
    PetscBool      at_setup;
  } cases[] = {
      {MATERIAL, "'bar'|no mesh|-bar_dm_plex_box_faces|-bar_dm_plex_filename", PETSC_ERR_USER_INPUT, PETSC_FALSE},
      {MESH "-youngs_modulus 16 -density -4", "-bar_density|-4|positive", PETSC_ERR_USER_INPUT, PETSC_FALSE},
      {MESH "-youngs_modulus 16 -density 4 -cross_section -1", "-bar_cross_section|-1|positive", PETSC_ERR_USER_INPUT, PETSC_FALSE},
      {MESH MATERIAL "-ts_type runge_kutta", "-bar_ts_type|runge_kutta|alpha2|centraldifference", PETSC_ERR_ARG_UNKNOWN_TYPE, PETSC_FALSE},
      {MESH MATERIAL "-ts_type rk", "-bar_ts_type|'rk'", PETSC_ERR_ARG_UNKNOWN_TYPE, PETSC_FALSE}, /* PETSc's, but of first order */
      {MESH MATERIAL "-ts_time_step -0.1", "-bar_ts_time_step|-0.1|positive", PETSC_ERR_USER_INPUT, PETSC_FALSE},
      {MESH MATERIAL "-ts_alpha_beta 0", "-bar_ts_alpha|beta 0|centraldifference", PETSC_ERR_USER_INPUT, PETSC_FALSE},
      {MESH MATERIAL "-initial_velocity 1,2", "-bar_initial_velocity|2 components|'bar'|1-dimensional", PETSC_ERR_USER_INPUT, PETSC_FALSE},
      {MESH MATERIAL "-initial_displacement 1,2,3", "-bar_initial_displacement|3 components|'bar'", PETSC_ERR_USER_INPUT, PETSC_FALSE},
      {MESH MATERIAL "-ts_time_step 0.07", "-bar_ts_time_step|0.07|does not divide|0.3|auto", PETSC_ERR_USER_INPUT, PETSC_TRUE},
      {MESH MATERIAL "-ts_time_step 0.6", "-bar_ts_time_step|0.6|does not divide|0.3", PETSC_ERR_USER_INPUT, PETSC_TRUE}, /* twice it */
      {MESH MATERIAL "-ts_time_step 1e-12", "-bar_ts_time_step|1e-12|too small", PETSC_ERR_USER_INPUT, PETSC_TRUE},
      {MESH MATERIAL "-ts_type centraldifference -mass_type lumped -ts_time_step 0.3",
       "-bar_ts_time_step|0.3 s|'bar'|stable step, 0.1 s|auto", PETSC_ERR_USER_INPUT, PETSC_TRUE},
      {MESH MATERIAL "-ts_type centraldifference -mass_type consistent -ts_time_step 0.06", "-bar_ts_time_step 0.06|0.057735",
       PETSC_ERR_USER_INPUT, PETSC_TRUE}, /* 0.1 / sqrt(3) */
      {MESH MATERIAL "-ts_adapt_type basic", "-bar_ts_adapt_type|not supported|none", PETSC_ERR_USER_INPUT, PETSC_TRUE},
      {MESH MATERIAL "-ts_type centraldifference -ts_time_step auto -ts_adapt_type basic", "-bar_ts_adapt_type|none", PETSC_ERR_USER_INPUT,
       PETSC_TRUE},
  };

  (void)state;
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscOptions options = options_begin("-prefix_push bar_ -dm_plex_dim 1 %s -prefix_pop", cases[i].options);
    Body         body;

    if (i == 0) ok(PetscOptionsClearValue(options, "-bar_dm_plex_dim"));
    ok(BodyCreate(PETSC_COMM_WORLD, "bar", &body));
    if (cases[i].at_setup) {
      ok(BodySetFromOptions(body));
      ok(BodySetControllerStep(body, 0, 0.3));
      refused(cases[i].code, cases[i].words, BodySetUp(body));
    } else refused(cases[i].code, cases[i].words, BodySetFromOptions(body));
    ok(BodyDestroy(&body));
    assert_null(body);
    options_drop(options);
  }
}

static PetscErrorCode Nothing(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)dim;
  (void)x;
  (void)u;
  (void)v;
  (void)ctx;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Calls in the wrong order */
static void is_set_up_in_order(void **state)
{
  PetscOptions options = options_begin("-prefix_push bar_ -dm_plex_dim 1 " MESH MATERIAL "-prefix_pop");
  Body         body;

  (void)state;
  ok(BodyCreate(PETSC_COMM_WORLD, "bar", &body));
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetFromOptions()", BodySetUp(body));
  ok(BodySetFromOptions(body));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|already", BodySetFromOptions(body));
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetUp()", BodySetInitialState(body, Nothing, NULL));
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetUp()", BodyView(body, PETSC_VIEWER_STDOUT_WORLD));
  ok(BodySetControllerStep(body, 0, 0.1));
  ok(BodySetUp(body));
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetUp()", BodySetContactNodes(body, 0, NULL));
  ok(BodyIntegrate(body));
  ok(BodySave(body));
  refused(PETSC_ERR_ARG_WRONGSTATE, "first step", BodySetInitialState(body, Nothing, NULL));
  bar_destroy(&body, options);
}

static void needs_a_controller_step(void **state)
{
  Body         body;
  PetscOptions options = bar_create(&body, MESH MATERIAL);

  (void)state;
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetControllerStep()", BodySetUp(body));
  bar_destroy(&body, options);
}

static PetscErrorCode NotANumber(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)dim;
  (void)ctx;
  v[0] = x[0] > 1.9 && x[0] < 2.1 ? NAN : 0;
  u[0] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In its fourth controller step of two substeps, at 0.7 + 4 * 0.1 s, by a force; or at once, by its initial velocity */
static void tells_where_a_number_is_lost(void **state)
{
  const BodyCondition forced        = BODY_FORCED;
  const char *const   integrators[] = {TSALPHA2, TSCENTRALDIFFERENCE};
  const PetscReal     end           = 3;

  (void)state;
  for (PetscInt moved = 0; moved < 2; moved++)
    for (PetscInt i = 0; i < 2; i++) {
      Body         body;
      PetscOptions options = bar_create(&body, MESH MATERIAL "-mass_type lumped -ts_type %s -ts_time_step 0.05 -mass_redistribute %d",
                                        integrators[i], (int)moved);
      BodyTraces   traces;
      Rows         rows;

      set_rows(body, 1, &end, &rows);
      ok(BodySetControllerStep(body, 0.7, 0.1));
      ok(BodySetUp(body));
      ok(BodyGetTraces(body, &traces));
      set_conditions(body, &rows, &forced);
      for (PetscInt k = 0; k < 3; k++) {
        ok(BodyIntegrate(body));
        ok(BodySave(body));
      }
      for (PetscInt level = 0; level <= 2; level++) set_level(&rows, traces.force_in, level, 0, NAN);
      refused(PETSC_ERR_FP, "'bar'|not a number|time 1.|step ", BodyIntegrate(body));
      bar_destroy(&body, options);

      options = bar_create(&body, MESH MATERIAL "-mass_type lumped -ts_type %s -mass_redistribute %d", integrators[i], (int)moved);
      ok(BodySetControllerStep(body, 0, 0.05));
      ok(BodySetUp(body));
      ok(BodySetInitialState(body, NotANumber, NULL));
      refused(PETSC_ERR_FP, "'bar'|not a number|time 0.05|step 1", BodyIntegrate(body));
      bar_destroy(&body, options);
    }
}

/* A plate of 8 x 2 squares of 0.25 m; "left" has the cells with x < 1 m, "both" all of them, "faces" no cell */
static DM create_plate(void)
{
  const PetscInt  faces[2] = {8, 2};
  const PetscReal lower[2] = {0, 0}, upper[2] = {2, 0.5};
  DMLabel         left, both;
  PetscInt        cstart, cend;
  DM              dm, distributed;

  ok(DMPlexCreateBoxMesh(PETSC_COMM_WORLD, 2, PETSC_FALSE, faces, lower, upper, NULL, PETSC_TRUE, 0, PETSC_FALSE, &dm));
  ok(DMPlexDistribute(dm, 0, NULL, &distributed));
  if (distributed) {
    ok(DMDestroy(&dm));
    dm = distributed;
  }
  ok(DMCreateLabel(dm, "left"));
  ok(DMCreateLabel(dm, "both"));
  ok(DMCreateLabel(dm, "faces"));
  ok(DMGetLabel(dm, "left", &left));
  ok(DMGetLabel(dm, "both", &both));
  ok(DMPlexGetHeightStratum(dm, 0, &cstart, &cend));
  for (PetscInt cell = cstart; cell < cend; cell++) {
    PetscReal centre[3];

    ok(DMPlexComputeCellGeometryFVM(dm, cell, NULL, centre, NULL));
    if (centre[0] < 1) ok(DMLabelSetValue(left, cell, 1));
    ok(DMLabelSetValue(both, cell, 1));
  }
  return dm;
}

static Material create_material(MaterialType type, PetscReal density, PetscReal modulus)
{
  Material material;

  ok(MaterialCreate(PETSC_COMM_WORLD, &material));
  ok(MaterialSetType(material, type));
  ok(MaterialSetDensity(material, density));
  ok(MaterialSetYoungsModulus(material, modulus));
  return material;
}

static Body create_body(Material own)
{
  Body body;
  DM   dm = create_plate();

  ok(BodyCreate(PETSC_COMM_WORLD, "plate", &body));
  ok(BodySetDM(body, dm));
  ok(DMDestroy(&dm));
  if (own) ok(BodySetMaterial(body, own));
  return body;
}

static void tells_of_its_blocks(void **state)
{
  Material           light = create_material(MATERIAL_LINEAR_ELASTIC, 2, 100), heavy = create_material(MATERIAL_NEO_HOOKEAN, 6, 400), found;
  Body               body = create_body(light);
  const char *const *names;
  const Material    *materials;
  const PetscReal   *masses;
  const PetscInt    *blocks;
  PetscInt           n;
  PetscReal          mass, impedance;
  PetscBool          linear;

  (void)state;
  ok(BodyGetBlocks(body, &n, NULL, NULL));
  assert_int_equal(n, 0);
  ok(BodyIsLinear(body, &linear));
  assert_true(linear);
  ok(BodySetBlockMaterial(body, "left", light));
  ok(BodySetBlockMaterial(body, "left", heavy)); /* takes its place */
  ok(BodySetControllerStep(body, 0, 0.001));
  ok(BodySetUp(body));
  ok(BodyGetBlocks(body, &n, &names, &materials));
  assert_int_equal(n, 2);
  assert_string_equal(names[0], "left");
  assert_string_equal(names[1], "");
  assert_ptr_equal(materials[0], heavy);
  assert_ptr_equal(materials[1], light);
  ok(BodyGetBlockMass(body, &masses));
  near(masses[0], 3, 1e-13); /* 0.5 m^2 of each */
  near(masses[1], 1, 1e-13);
  ok(BodyGetMass(body, &mass));
  near(mass, 4, 1e-13);
  ok(BodyIsLinear(body, &linear));
  assert_false(linear);
  ok(BodyGetSurfaceMaterial(body, &found)); /* the stiffest */
  assert_ptr_equal(found, heavy);
  ok(BodyGetScale(body, BODY_IMPEDANCE, &impedance));
  near(impedance, PetscSqrtReal(6 * 400), 1e-10); /* sqrt(rho E), Poisson's ratio being 0 */
  ok(BodyGetCellBlocks(body, &blocks));
  assert_non_null(blocks);
  refused(PETSC_ERR_ARG_WRONGSTATE, "'plate'|BodySetBlockMaterial()", BodySetBlockMaterial(body, "left", light));
  ok(BodyDestroy(&body));
  ok(MaterialDestroy(&light));
  ok(MaterialDestroy(&heavy));
}

/* Where all cells are in blocks, the body needs no material */
static void does_without_its_own(void **state)
{
  Material  material = create_material(MATERIAL_LINEAR_ELASTIC, 2, 100), own;
  Body      body     = create_body(NULL);
  PetscInt  n;
  PetscReal mass;

  (void)state;
  ok(BodySetBlockMaterial(body, "both", material));
  ok(BodySetControllerStep(body, 0, 0.001));
  ok(BodySetUp(body));
  ok(BodyGetBlocks(body, &n, NULL, NULL));
  assert_int_equal(n, 1);
  ok(BodyGetMaterial(body, &own));
  assert_ptr_equal(own, material);
  ok(BodyGetMass(body, &mass));
  near(mass, 2, 1e-13);
  ok(BodyDestroy(&body));
  ok(MaterialDestroy(&material));
}

static void refuses_bad_blocks(void **state)
{
  Material material = create_material(MATERIAL_LINEAR_ELASTIC, 2, 100);
  Body     body     = create_body(material);

  (void)state;
  ok(BodySetBlockMaterial(body, "right", material));
  ok(BodySetControllerStep(body, 0, 0.001));
  refused(PETSC_ERR_USER_INPUT, "'plate'|no block 'right'|it has: left, both", BodySetUp(body));
  ok(BodyDestroy(&body));
  body = create_body(material);
  ok(BodySetBlockMaterial(body, "faces", material));
  ok(BodySetControllerStep(body, 0, 0.001));
  refused(PETSC_ERR_USER_INPUT, "no block 'faces'", BodySetUp(body));
  ok(BodyDestroy(&body));
  body = create_body(material);
  ok(BodySetBlockMaterial(body, "left", material));
  ok(BodySetBlockMaterial(body, "both", material));
  ok(BodySetControllerStep(body, 0, 0.001));
  refused(PETSC_ERR_USER_INPUT, "'left'|'both'|at once", BodySetUp(body));
  ok(BodyDestroy(&body));
  body = create_body(NULL);
  ok(BodySetBlockMaterial(body, "left", material));
  ok(BodySetControllerStep(body, 0, 0.001));
  refused(PETSC_ERR_ARG_WRONGSTATE, "cells in no block|BodySetMaterial()", BodySetUp(body));
  ok(BodyDestroy(&body));
  ok(MaterialDestroy(&material));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_made_from_options_alone),   cmocka_unit_test(chooses_its_own_step), cmocka_unit_test(refuses_bad_input),
      cmocka_unit_test(substeps_by_default),          cmocka_unit_test(is_set_up_in_order),   cmocka_unit_test(needs_a_controller_step),
      cmocka_unit_test(tells_where_a_number_is_lost), cmocka_unit_test(tells_of_its_blocks),  cmocka_unit_test(does_without_its_own),
      cmocka_unit_test(refuses_bad_blocks),
  };

  return impakt_main(argc, argv, tests);
}
