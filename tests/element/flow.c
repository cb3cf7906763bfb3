/* Enhanced elements of a material that flows: force against tangent, patches, work, moments of beams that bend. */
#include "solid_mesh.h"

static const DMPolytopeType of_shape[] = {DM_POLYTOPE_QUADRILATERAL, DM_POLYTOPE_HEXAHEDRON};
#define SHAPE_COUNT 2

static const PetscInt one[3] = {1, 1, 1}, three[3] = {3, 3, 3};

#define ENHANCED  "-element_formulation enhanced "
#define MAX_BATCH 32 /* elements of which there is a history, a multiple of 8 */

/* History at the start and at the end of a step of elements that are virgin */
typedef struct {
  PetscReal *start, *end;
  PetscInt   size;
} History;

static void begin(Solid *solid, History *history)
{
  ElementHistory *of_element = &solid->element->history;

  history->size = MAX_BATCH * of_element->n * of_element->points;
  assert_true(history->size > 0 && solid->element->count <= MAX_BATCH);
  history->start = aligned_alloc(64, sizeof(PetscReal) * (size_t)history->size); /* as kernels of materials want it */
  history->end   = aligned_alloc(64, sizeof(PetscReal) * (size_t)history->size);
  assert_true(history->start && history->end);
  memset(history->start, 0, sizeof(PetscReal) * (size_t)history->size);
  memset(history->end, 0, sizeof(PetscReal) * (size_t)history->size);
  of_element->start = history->start;
  of_element->end   = history->end;
  of_element->step  = 1e-3;
}

static void finish(Solid *solid, History *history)
{
  free(history->start);
  free(history->end);
  solid_destroy(solid);
}

/* The end of the last force becomes the start of the next step */
static void accept(const History *history)
{
  memcpy(history->start, history->end, sizeof(PetscReal) * (size_t)history->size);
}

/* Energy and plastic work of the state at the start of the step */
static PetscReal get_work(const Solid *solid, const PetscReal u[])
{
  ElementHistory *history = &solid->element->history;
  PetscReal      *end     = history->end, stored;

  history->end  = NULL;
  history->step = -1;
  stored        = get_energy(solid, u) + solid->element->plastic_work;
  history->end  = end;
  history->step = 1e-3;
  return stored;
}

static PetscReal product(const Mesh *mesh, const PetscReal f[], const PetscReal du[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < mesh->dim * mesh->n_nodes; i++) sum += f[i] * du[i];
  return sum;
}

/* As of elastic elements, in formulations.c. All points flow, in a second step that goes another way than the first, and back at last. */
static void tangent_is_derivative(void **state)
{
  static const char *const laws[] = {"-yield_stress 1 -hardening_modulus 20",
                                     "-yield_stress 1 -hardening_modulus 10 -kinematic_modulus 10"};

  (void)state;
  for (PetscInt s = 0; s < SHAPE_COUNT; s++)
    for (size_t law = 0; law < PETSC_STATIC_ARRAY_LENGTH(laws); law++) {
      char      options[256];
      PetscReal u[MAX_DOFS], f[MAX_DOFS], strain[MAX_BATCH], work;
      Mesh      mesh;
      Solid     solid;
      History   history;

      ok(PetscSNPrintf(options, sizeof(options), ENHANCED "%s", laws[law]));
      mesh_box(&mesh, of_shape[s], one, 0.15);
      solid_create(&solid, &mesh, MATERIAL_J2, options);
      begin(&solid, &history);
      set_scattered(&mesh, 0.05, u);
      get_force(&solid, &mesh, u, f);
      accept(&history);
      for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) u[i] += 0.05 * scatter(2000 + i);
      check_tangent(&solid, &mesh, u, 1e-6 * LAME);
      get_force(&solid, &mesh, u, f);
      accept(&history);
      ok((*solid.element->ops->plastic)(solid.element, &work, strain));
      assert_true(work > 0 && strain[0] > 0.02);
      for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) u[i] *= 0.9; /* elastic */
      check_tangent(&solid, &mesh, u, 1e-6 * LAME);
      finish(&solid, &history);
    }
}

/* A patch of uniform deformation that flows is in equilibrium, and flows everywhere alike; then it springs back, and is free of stress
   elsewhere than where it began */
static void patch_flows(void **state)
{
  const PetscReal gradient[3][3] = {{0.06, 0.03, 0.01}, {-0.02, -0.04, 0.02}, {0.02, -0.01, 0.03}};

  (void)state;
  for (PetscInt s = 0; s < SHAPE_COUNT; s++) {
    PetscReal u[MAX_DOFS], part[3][3], f[MAX_DOFS], strain[MAX_BATCH], work;
    Mesh      mesh;
    Solid     solid;
    History   history;

    mesh_box(&mesh, of_shape[s], three, 0.15);
    solid_create(&solid, &mesh, MATERIAL_J2, ENHANCED "-yield_stress 0.5 -hardening_modulus 10");
    begin(&solid, &history);
    for (PetscInt step = 1; step <= 4; step++) {
      for (PetscInt i = 0; i < 9; i++) part[i / 3][i % 3] = gradient[i / 3][i % 3] * step / 4;
      set_linear(&mesh, (const PetscReal(*)[3])part, u);
      get_force(&solid, &mesh, u, f);
      accept(&history);
    }
    for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++)
      if (mesh.inner[i / mesh.dim]) near(f[i], 0, 1e-12 * LAME);
    assert_true(largest_of(mesh.dim * mesh.n_nodes, f) > 0.1);
    ok((*solid.element->ops->plastic)(solid.element, &work, strain));
    assert_true(strain[0] > 0.02 && work > 0);
    for (PetscInt e = 1; e < mesh.count; e++) near(strain[e], strain[0], 1e-12);
    finish(&solid, &history);
  }
}

/* What forces do on the way is energy and plastic work, to the third power of the steps */
static void work_is_kept_or_flows(void **state)
{
  (void)state;
  for (PetscInt s = 0; s < SHAPE_COUNT; s++) {
    const PetscInt steps       = 400;
    PetscReal      u[MAX_DOFS] = {0}, du[MAX_DOFS], f[MAX_DOFS] = {0}, before[MAX_DOFS], work = 0;
    Mesh           mesh;
    Solid          solid;
    History        history;

    mesh_box(&mesh, of_shape[s], one, 0.15);
    solid_create(&solid, &mesh, MATERIAL_J2, ENHANCED "-yield_stress 1 -hardening_modulus 20");
    begin(&solid, &history);
    set_scattered(&mesh, 0.1 / steps, du);
    for (PetscInt step = 0; step < steps; step++) {
      for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) {
        before[i] = f[i];
        u[i] += du[i];
      }
      get_force(&solid, &mesh, u, f);
      accept(&history);
      work += 0.5 * (product(&mesh, f, du) + product(&mesh, before, du));
    }
    near(get_work(&solid, u) / work, 1, 1e-3);
    finish(&solid, &history);
  }
}

/* The moment of a beam of height `layers` that is bent in plane strain to 20 times the curvature at which it yields, u_x = c x y,
   u_y = -c (x^2 + y^2) / 2, which keeps volumes: the work of its forces by the turn of its ends, over that of a beam that flows everywhere,
   (2 / sqrt(3)) yield stress / 4 height^2. */
static PetscReal get_moment(DMPolytopeType shape, PetscInt layers)
{
  const PetscReal yield = 0.002, curvature = 40 * yield / 200 / (PetscReal)layers;
  const PetscInt  n[3] = {1, layers, 1}, steps = 20;
  PetscReal       u[MAX_DOFS], du[MAX_DOFS], f[MAX_DOFS], moment;
  Mesh            mesh;
  Solid           solid;
  History         history;

  mesh_box(&mesh, shape, n, 0);
  solid_create(&solid, &mesh, MATERIAL_J2, ENHANCED "-yield_stress 0.002");
  begin(&solid, &history);
  for (PetscInt node = 0; node < mesh.n_nodes; node++) {
    const PetscReal x = mesh.x[mesh.dim * node] - 0.5, y = mesh.x[mesh.dim * node + 1] - 0.5 * (PetscReal)layers;

    for (PetscInt i = 0; i < mesh.dim; i++) du[mesh.dim * node + i] = i == 0 ? x * y : i == 1 ? -(x * x + y * y) / 2 : 0;
  }
  for (PetscInt step = 1; step <= steps; step++) {
    for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) u[i] = curvature * step / steps * du[i];
    get_force(&solid, &mesh, u, f);
    accept(&history);
  }
  moment = product(&mesh, f, du);
  finish(&solid, &history);
  return moment / (yield / PetscSqrtReal(3.) * PetscSqr((PetscReal)layers) / 2);
}

/* Two points through the height have the lever 1 / sqrt(3) of it in place of 1/2, 15.5 % more; four, of two elements, that of a beam */
static void beams_flow(void **state)
{
  (void)state;
  for (PetscInt s = 0; s < SHAPE_COUNT; s++) {
    near(get_moment(of_shape[s], 1), 2 / PetscSqrtReal(3.), 0.01);
    near(get_moment(of_shape[s], 2), 1, 0.01);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tangent_is_derivative),
      cmocka_unit_test(patch_flows),
      cmocka_unit_test(work_is_kept_or_flows),
      cmocka_unit_test(beams_flow),
  };

  return impakt_main(argc, argv, tests);
}
