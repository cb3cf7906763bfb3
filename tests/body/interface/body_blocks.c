/* A body of several materials, as a program makes it: what it tells of its blocks, and what it refuses. */
#include "support.h"

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
  ok(BodyGetImpedance(body, &impedance));
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
  const struct CMUnitTest tests[] = {cmocka_unit_test(tells_of_its_blocks), cmocka_unit_test(does_without_its_own),
                                     cmocka_unit_test(refuses_bad_blocks)};

  return impakt_main(argc, argv, tests);
}
