/* The stable step of distorted solids, which comes from their elements, against the largest eigenvalue of the whole body. */
#include "solid_mesh.h"
#include <petscblaslapack.h>
#include <body/layout/bodyimpl.h>

/* A Gmsh file, version 2.2, in the working directory */
static void write_mesh(const Mesh *mesh, const char path[])
{
  const int type = mesh->shape == DM_POLYTOPE_TRIANGLE        ? 2
                   : mesh->shape == DM_POLYTOPE_QUADRILATERAL ? 3
                   : mesh->shape == DM_POLYTOPE_TETRAHEDRON   ? 4
                                                              : 5;
  FILE     *file = fopen(path, "w");

  assert_non_null(file);
  fprintf(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n", (int)mesh->n_nodes);
  for (PetscInt node = 0; node < mesh->n_nodes; node++)
    fprintf(file, "%d %.17g %.17g %.17g\n", (int)node + 1, (double)mesh->x[mesh->dim * node], (double)mesh->x[mesh->dim * node + 1],
            mesh->dim == 3 ? (double)mesh->x[mesh->dim * node + 2] : 0.);
  fprintf(file, "$EndNodes\n$Elements\n%d\n", (int)mesh->count);
  for (PetscInt e = 0; e < mesh->count; e++) {
    fprintf(file, "%d %d 2 1 1", (int)e + 1, type);
    for (PetscInt a = 0; a < mesh->nodes; a++) fprintf(file, " %d", (int)mesh->connectivity[mesh->nodes * e + a] + 1);
    fprintf(file, "\n");
  }
  fprintf(file, "$EndElements\n");
  assert_int_equal(fclose(file), 0);
}

/* 2 / sqrt of the largest eigenvalue of M^{-1/2} K M^{-1/2}, M being diagonal */
static PetscReal compute_stable_step(Body body)
{
  PetscReal          K[MAX_DOFS * MAX_DOFS];
  PetscReal          eigenvalues[MAX_DOFS], work[8 * MAX_DOFS];
  PetscBLASInt       size, lwork = 8 * MAX_DOFS, info;
  PetscInt           n;
  const PetscScalar *product, *mass;
  Vec                e, Ke;
  Mat                stiffness;

  ok(BodyGetStiffness(body, &stiffness));
  ok(VecDuplicate(body->mesh.positions, &e));
  ok(VecDuplicate(body->mesh.positions, &Ke));
  ok(VecGetLocalSize(e, &n));
  assert_true(n <= MAX_DOFS);
  assert_non_null(body->mass.diagonal);
  ok(VecGetArrayRead(body->mass.diagonal, &mass));
  for (PetscInt j = 0; j < n; j++) {
    ok(VecZeroEntries(e));
    ok(VecSetValue(e, j, 1 / PetscSqrtReal(mass[j]), INSERT_VALUES));
    ok(VecAssemblyBegin(e));
    ok(VecAssemblyEnd(e));
    ok(MatMult(stiffness, e, Ke));
    ok(VecGetArrayRead(Ke, &product));
    for (PetscInt i = 0; i < n; i++) K[j * n + i] = product[i] / PetscSqrtReal(mass[i]);
    ok(VecRestoreArrayRead(Ke, &product));
  }
  ok(VecRestoreArrayRead(body->mass.diagonal, &mass));
  ok(VecDestroy(&e));
  ok(VecDestroy(&Ke));
  ok(PetscBLASIntCast(n, &size));
  LAPACKsyev_("N", "L", &size, K, &size, eigenvalues, work, &lwork, &info);
  assert_int_equal(info, 0);
  return 2 / PetscSqrtReal(eigenvalues[n - 1]);
}

/* The same of the worst element on its own */
static PetscReal compute_stable_step_of_elements(Body body)
{
  const PetscInt nodes = body->model.element->nodes, dim = body->mesh.dim, n = nodes * dim;
  PetscReal      zero[3 * MAX_NODES] = {0}, largest = 0;

  for (PetscInt e = 0; e < body->model.element->count; e++) {
    PetscScalar  K[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], work[8 * ELEMENT_MAX_DOFS];
    PetscScalar  of_nodes[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES];
    PetscReal    eigenvalues[ELEMENT_MAX_DOFS];
    PetscBLASInt one = 1, size, lwork = 8 * ELEMENT_MAX_DOFS, info;

    ok((*body->model.element->ops->tangent)(body->model.element, e, PETSC_FALSE, zero, K));
    ok(BodyGetElementMass(body, e, of_nodes));
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++) M[i * n + j] = i % dim == j % dim ? of_nodes[i / dim * nodes + j / dim] : 0;
    ok(PetscBLASIntCast(n, &size));
    LAPACKsygv_(&one, "N", "L", &size, K, &size, M, &size, eigenvalues, work, &lwork, &info);
    assert_int_equal(info, 0);
    largest = PetscMax(largest, eigenvalues[n - 1]);
  }
  return 2 / PetscSqrtReal(largest);
}

static const char *const kinds[] = {"",
                                    "-plane_stress",
                                    "-poissons_ratio 0.49",
                                    "-material_type neo_hookean",
                                    "-element_formulation enhanced",
                                    "-element_formulation reduced"};

/* A bound from below, as the largest eigenvalue of the elements is one from above (Irons and Treharne 1971), to rounding; that of the worst
   element, which power iteration must not miss; and not needlessly small. The nodes of a grid of 1 m, also those on the boundary, are moved
   by up to 0.2 m along each axis. Measured: 0.60 of it at least; of tetrahedra, which that leaves as slivers, 0.40. */
static void is_a_close_bound(void **state)
{
  static const PetscReal distortions[] = {0, 0.1, 0.2};
  static const PetscInt  n[]           = {3, 3, 3};
  const char             path[]        = "stable-step.msh";

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++)
    for (PetscInt d = 0; d < 3; d++) {
      Mesh mesh;

      mesh_box(&mesh, shapes[s], n, distortions[d]);
      write_mesh(&mesh, path);
      for (PetscInt k = 0; k < 6; k++) {
        PetscOptions options;
        PetscReal    step, exact;
        Body         body;

        if ((k == 1 && mesh.dim == 3) || (k >= 4 && mesh.nodes == mesh.dim + 1)) continue;
        options = options_begin(
            "-prefix_push s_ -dm_plex_filename %s -density 3 -youngs_modulus 200 -mass_type lumped -poissons_ratio 0.3 %s -prefix_pop",
            path, kinds[k]);
        ok(BodyCreate(PETSC_COMM_WORLD, "s", &body));
        ok(BodySetFromOptions(body));
        ok(BodySetControllerStep(body, 0, 0.1));
        ok(BodySetUp(body));
        ok(BodyGetStableStep(body, &step));
        exact = compute_stable_step(body);
        near(step / compute_stable_step_of_elements(body), 1, 1e-12);
        between(step, (mesh.shape == DM_POLYTOPE_TETRAHEDRON ? 0.35 : 0.6) * exact, exact * (1 + 1e-12));
        ok(BodyDestroy(&body));
        options_end(options);
      }
    }
  assert_int_equal(remove(path), 0);
}

/* Moves the nodes of a bar of 1 m x 1 m along x: one in the middle of an edge at the far end by `aside` along y, and the first metre is
   pressed to `pressed` of its length */
static void deform(Body body, PetscReal length, PetscReal aside, PetscReal pressed)
{
  const PetscScalar *x;
  PetscScalar       *u;
  PetscInt           n, moved = 0;

  ok(VecGetLocalSize(body->state.u, &n));
  ok(VecGetArrayRead(body->mesh.positions, &x));
  ok(VecGetArray(body->state.u, &u));
  for (PetscInt i = 0; i < n; i += 3) {
    const PetscReal at[3]  = {PetscRealPart(x[i]), PetscRealPart(x[i + 1]), PetscRealPart(x[i + 2])};
    const PetscBool middle = (PetscBool)(PetscAbsReal(at[0] - length) + PetscAbsReal(at[1] - 0.5) + PetscAbsReal(at[2]) < 1e-9);

    u[i]     = (pressed - 1) * PetscMin(at[0], 1);
    u[i + 1] = middle ? aside : 0;
    u[i + 2] = 0;
    moved += middle;
  }
  ok(VecRestoreArray(body->state.u, &u));
  ok(VecRestoreArrayRead(body->mesh.positions, &x));
  assert_int_equal(moved, 1);
}

/* The stable step of a body that is being deformed, which is found anew only now and then, is not above the true one, but for what it is
   trusted to anyway (a quarter), whatever became thin before: here first a part of one composite element far away, which is no less stable
   for it, and then others as a whole. Measured: 1.006 of the true one at most, and 1.88 where the thinnest part was taken for its element.
 */
static void what_was_thin_before_hides_nothing(void **state)
{
  PetscOptions options = options_begin(
      "-prefix_push s_ -dm_plex_dim 3 -dm_plex_simplex 1 -dm_plex_box_faces 3,1,1 -dm_plex_box_upper 3,1,1 "
      "-element_formulation composite -density 3 -youngs_modulus 200 -poissons_ratio 0.3 -material_type "
      "neo_hookean -mass_type lumped -ts_type centraldifference -prefix_pop");
  PetscReal undeformed, exact;
  Body      body;

  (void)state;
  ok(BodyCreate(PETSC_COMM_WORLD, "s", &body));
  ok(BodySetFromOptions(body));
  ok(BodySetControllerStep(body, 0, 1e-3));
  ok(BodySetUp(body));
  ok(BodyGetStableStep(body, &undeformed));
  body->time.whole_step = 0.45 * undeformed * body->time.substeps;
  deform(body, 3, 0.4, 1);
  ok(BodyUpdateStableStep(body));
  between(body->time.stable_now, 0.25 * undeformed, undeformed);
  for (PetscReal pressed = 0.9; pressed > 0.2; pressed -= 0.1) {
    const PetscScalar *u;
    Vec                local;

    deform(body, 3, 0, pressed);
    ok(BodyUpdateStableStep(body));
    ok(BodyGetLocalRead(body, body->state.u, &local, &u));
    ok(BodyComputeStableStepAt(body, u, PETSC_FALSE, &exact));
    ok(BodyRestoreLocalRead(body, body->state.u, &local, &u));
    if (exact < 1.25 * 0.45 * undeformed) between(body->time.stable_now, 0, 1.25 * exact);
  }
  ok(BodyDestroy(&body));
  options_end(options);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_a_close_bound),
      cmocka_unit_test(what_was_thin_before_hides_nothing),
  };

  return impakt_main(argc, argv, tests);
}
