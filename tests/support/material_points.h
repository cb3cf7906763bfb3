/* What the tests of material kernels share: the models, points drawn at random, and answers at one point. */
#pragma once
#include "support.h"
#include <impakt/private/materialimpl.h>

static const char *const types[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN, MATERIAL_MOONEY_RIVLIN};
/* none, metal, rubber-like, auxetic */
static const PetscReal ratios[] = {0, 0.3, 0.45, -0.4};

#define LINEAR  0
#define N_TYPES 4
#define MODULUS 7.
#define SHARE   0.3 /* of c01, of Mooney-Rivlin models */

/* Where one of Lame's constants is meant */
static inline PetscReal lambda_of(PetscReal nu)
{
  return MODULUS * nu / ((1 + nu) * (1 - 2 * nu));
}

static inline PetscReal mu_of(PetscReal nu)
{
  return MODULUS / (2 * (1 + nu));
}

static inline Material create(const char type[], PetscReal nu, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscOptions options = options_begin("-density 1 -youngs_modulus %.17g -poissons_ratio %.17g -material_type %s %s", MODULUS, (double)nu,
                                       type, strcmp(type, MATERIAL_MOONEY_RIVLIN) ? "" : "-mooney_rivlin_share 0.3");
  Material     material;

  ok(MaterialCreate(PETSC_COMM_SELF, &material));
  ok(MaterialSetFromOptions(material));
  ok(MaterialSetPlaneStress(material, plane_stress));
  ok(MaterialGetKernels(material, kernels));
  options_end(options);
  return material;
}

/* for each model, Poisson's ratio, and solid or plane stress */
#define for_all_models(material, kernels, type, nu, plane)                                                                                 \
  for (int type = 0; type < N_TYPES; type++)                                                                                               \
    for (size_t nu = 0; nu < PETSC_STATIC_ARRAY_LENGTH(ratios); nu++)                                                                      \
      for (int plane = 0; plane < 2; plane++)                                                                                              \
        for (material = create(types[type], ratios[nu], plane, &kernels); material; ok(MaterialDestroy(&material)))

/* Numbers between -1 and 1, the same ones in every run (Numerical Recipes' quick generator) */
static inline PetscReal pseudo_random(uint32_t *seed)
{
  *seed = 1664525u * *seed + 1013904223u;
  return *seed / 2147483648. - 1;
}

static inline PetscReal determinant(const PetscReal H[9])
{
  const PetscReal F[9] = {1 + H[0], H[1], H[2], H[3], 1 + H[4], H[5], H[6], H[7], 1 + H[8]};

  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
}

/* A displacement gradient with entries up to `size`, not near an inverted one. In the plane, up to half of that: not near those
   at which a plate of Saint-Venant-Kirchhoff material has no thickness left (with nu = 0.45, tr E = 0.61). */
static inline void draw(uint32_t *seed, PetscReal size, PetscBool plane, PetscReal H[9])
{
  do {
    for (int i = 0; i < 9; i++) H[i] = size * pseudo_random(seed) * (!plane ? 1 : i == 2 || i > 4 ? 0 : 0.5);
  } while (determinant(H) < 0.3);
}

static inline void put(const PetscReal H[9], int p, PetscReal batch[9][8])
{
  for (int i = 0; i < 9; i++) batch[i][p] = H[i];
}

static inline void stress_at(const MaterialKernels *kernels, const PetscReal H[9], PetscReal P[9])
{
  PetscReal in[9][8], out[9][8];

  for (int p = 0; p < 8; p++) put(H, p, in);
  kernels->stress(kernels->data, in, out);
  for (int i = 0; i < 9; i++) P[i] = out[i][3];
}

static inline PetscReal energy_at(const MaterialKernels *kernels, const PetscReal H[9])
{
  PetscReal in[9][8], W[8];

  for (int p = 0; p < 8; p++) put(H, p, in);
  kernels->energy(kernels->data, in, W);
  return W[3];
}

static inline PetscReal largest(const PetscReal a[], int n)
{
  PetscReal size = 0;

  for (int i = 0; i < n; i++) size = PetscMax(size, PetscAbsReal(a[i]));
  return size;
}

/* A macro, so that failures name the line */
#define near_all(a, b, n, tolerance)                                                                                                       \
  for (int i_ = 0; i_ < (n); i_++) near((a)[i_], (b)[i_], tolerance)
