/* ranks: 1 3 */
/* Energies, momentum and angular momentum of bodies in two and three dimensions, against integrals over boxes in affine motion. */
#include "solid_bodies.h"

static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};

/* A box of 2 x 1.5 (x 1) m; rho = 3 kg/m^3, E = 200 Pa and nu = 0.25, so lambda = mu = 80 Pa */
#define DENSITY 3.
#define LAME    80.
static const PetscReal lower[] = {0.5, -1, 0.25}, size[] = {2, 1.5, 1};

/* u = c + G x, v = b + L x */
static const PetscReal c[3] = {0.3, -0.2, 0.1}, b[3] = {1, -2, 0.5};
static const PetscReal G[3][3] = {{0.11, 0.05, -0.07}, {-0.02, -0.08, 0.03}, {0.04, 0.06, 0.09}};
static const PetscReal L[3][3] = {{0.3, -1, 0.5}, {1, 0.2, 0.7}, {-.5, 0.1, -.4}};

static PetscErrorCode Affine(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)ctx;
  for (PetscInt i = 0; i < dim; i++) {
    u[i] = c[i];
    v[i] = b[i];
    for (PetscInt j = 0; j < dim; j++) {
      u[i] += G[i][j] * x[j];
      v[i] += L[i][j] * x[j];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscOptions create(Body *body, PetscInt kind, const char more[])
{
  PetscOptions options = solid_body_create(body, "%s %s -density 3 -youngs_modulus 200 -poissons_ratio 0.25 %s", kind_options(kind),
                                           kind_dim[kind] == 2
                                               ? "-dm_plex_box_faces 4,3 -dm_plex_box_lower 0.5,-1 -dm_plex_box_upper 2.5,0.5"
                                               : "-dm_plex_box_faces 3,2,3 -dm_plex_box_lower 0.5,-1,0.25 -dm_plex_box_upper 2.5,0.5,1.25",
                                           more);

  ok(BodySetControllerStep(*body, 0, 1e-3));
  return options;
}

/* Stored energy for each volume. Linear: lambda/2 tr(e)^2 + mu e:e; Saint-Venant-Kirchhoff the same with Green's strain; neo-Hookean:
   mu/2 (tr(F^T F) - 3 - 2 ln J) + lambda/4 (J^2 - 1 - 2 ln J) (Wriggers 2008). Plane: plane strain. */
static PetscReal energy_density(PetscInt dim, PetscInt material)
{
  PetscReal F[3][3], trace = 0, square = 0, stretch = 0, J;

  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) F[i][j] = (i == j) + (i < dim && j < dim ? G[i][j] : 0);
  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) {
      PetscReal e = 0.5 * (F[i][j] + F[j][i]) - (i == j);

      if (material) {
        e = -0.5 * (i == j);
        for (PetscInt k = 0; k < 3; k++) e += 0.5 * F[k][i] * F[k][j];
      }
      if (i == j) trace += e;
      square += e * e;
      stretch += F[i][j] * F[i][j];
    }
  J = F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1]) - F[0][1] * (F[1][0] * F[2][2] - F[1][2] * F[2][0]) +
      F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0]);
  if (material == 2) return LAME * (0.5 * (stretch - 3) - PetscLogReal(J) + 0.25 * (J * J - 1) - 0.5 * PetscLogReal(J));
  return LAME * (0.5 * trace * trace + square);
}

/* Means over the box of x_i and x_i x_j */
static PetscReal mean(PetscInt i)
{
  return lower[i] + 0.5 * size[i];
}

static PetscReal mean_square(PetscInt i, PetscInt j)
{
  return mean(i) * mean(j) + (i == j ? size[i] * size[i] / 12 : 0);
}

/* Mean over the box of (p + A x)_k (q + B x)_l */
static PetscReal mean_product(PetscInt dim, const PetscReal p[3], const PetscReal A[3][3], PetscInt k, const PetscReal q[3],
                              const PetscReal B[3][3], PetscInt l)
{
  PetscReal sum;

  if (k >= dim || l >= dim) return 0;
  sum = p[k] * q[l];
  for (PetscInt i = 0; i < dim; i++) {
    sum += (p[k] * B[l][i] + A[k][i] * q[l]) * mean(i);
    for (PetscInt j = 0; j < dim; j++) sum += A[k][i] * B[l][j] * mean_square(i, j);
  }
  return sum;
}

/* With the consistent mass matrix, affine motion gives the integrals over the box; round-off of 30 J, 30 kg m/s, 1e2 kg m^2/s */
static void of_affine_motion_are_integrals(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt k = 0; k < 2; k++) {
      const PetscInt  material = (kind + k) % 3;
      const PetscInt  dim      = kind_dim[kind];
      const PetscReal volume = dim == 2 ? 3 : 3 * size[2], mass = DENSITY * volume;
      PetscReal       F[3][3], kinetic                          = 0;
      char            more[256];
      BodyMeasures    measures;
      Body            body;
      PetscOptions    options;

      (void)snprintf(more, sizeof(more), "-mass_type consistent -material_type %s", materials[material]);
      options = create(&body, kind, more);
      ok(BodySetUp(body));
      ok(BodySetInitialState(body, Affine, NULL));
      ok(BodyGetMeasures(body, &measures));
      for (PetscInt i = 0; i < 3; i++)
        for (PetscInt j = 0; j < 3; j++) F[i][j] = (i == j) + G[i][j];
      for (PetscInt k = 0; k < dim; k++) {
        PetscReal velocity = b[k];

        for (PetscInt j = 0; j < dim; j++) velocity += L[k][j] * mean(j);
        near(measures.momentum[k], mass * velocity, 1e-12);
        near(measures.mean_velocity[k], velocity, 1e-13);
        kinetic += 0.5 * mass * mean_product(dim, b, L, k, b, L, k);
      }
      for (PetscInt k = 0; k < 3; k++) {
        const PetscInt p = (k + 1) % 3, q = (k + 2) % 3;

        near(measures.angular_momentum[k], mass * (mean_product(dim, c, F, p, b, L, q) - mean_product(dim, c, F, q, b, L, p)), 1e-11);
      }
      near(measures.kinetic, kinetic, 1e-12);
      near(measures.potential, volume * energy_density(dim, material), 1e-12);
      assert_true(!measures.loaded && measures.external_work == 0);
      bar_destroy(&body, options);
    }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(of_affine_motion_are_integrals),
  };

  return impakt_main(argc, argv, tests);
}
