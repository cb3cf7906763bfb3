/* Solid elements in two and three dimensions: what tri3, quad4, tet4, hex8 and those made of them share. Total Lagrangian: everything is
   integrated over the undeformed element. */
#pragma once
#include <impakt/private/elementimpl.h>
#include <impakt/private/simd.h>

#define SOLID_MAX_NODES   10
#define SOLID_MAX_POINTS  8
#define SOLID_MAX_HISTORY 32 /* numbers of a point */

/* A reference element, all of whose integration points of one rule have the same weight */
typedef struct {
  PetscInt         dim, nodes;
  PetscInt         n_points, n_load_points; /* of the internal force; of what loads and masses are integrated with */
  PetscReal        volume;                  /* of the reference element */
  const PetscReal *points, *load_points;    /* dim coordinates each */
  const PetscReal *corners;                 /* reference coordinates of the nodes */
  void (*shape)(const PetscReal xi[], PetscReal N[], PetscReal dN[]); /* shape functions and their gradients, nodes x dim */
} SolidShape;

/* A product of reference coordinates in the gradients of the monomials of a shape: the sum of its squares over the points, and the
   monomials that have it in their derivatives along which axes */
typedef struct {
  PetscReal weight;
  PetscInt  n, axis[3], mode[3];
} SolidTerm;

typedef struct {
  const SolidShape     *shape;
  const PetscReal      *coordinates; /* of the rank's nodes; owned by the body */
  const ElementHistory *history;     /* of the element */
  MaterialKernels       kernels;
  MaterialKernels       unconstrained; /* of the same material when not in plane stress */
  PetscInt              own_history; /* numbers of the formulation behind those of the material at each point, of materials with history */
  PetscBool             plane_stress, linear;
  PetscReal mean_share; /* of the mean of the element in the ratio of volumes at its points: 1 with a mean dilatation, 0 without */
  /* weight of a point of an element with the thickness, the gradients of the shape functions there, nodes x dim, and of rings what they
     add to F_33 for a displacement along r, else 0 */
  PetscReal (*point)(Element, PetscInt, PetscInt, PetscReal[], PetscReal[]);
  /* of a batch of elements from the first on: the displacement gradients that its points give the material, n_points, and their weights,
     times `scale` those of the points of a body without thickness */
  PetscErrorCode (*observe)(Element, PetscInt, const PetscScalar[], SimdReal[][9], SimdReal[]);
  PetscReal scale;
  /* shape functions at the points of loads and masses, and their gradients by reference coordinates, nodes x dim */
  PetscReal  load_shape[SOLID_MAX_POINTS * SOLID_MAX_NODES], load_gradients[SOLID_MAX_POINTS][SOLID_MAX_NODES * 3];
  SolidShape reduced; /* the shape with another rule, where a formulation has one */
  void      *own;     /* of the formulation */
} Solid;

/* The first number of the history of point g of a batch */
SIMD_INLINE size_t SolidHistoryOffset(const ElementHistory *history, PetscInt first, PetscInt g)
{
  return (size_t)(first / SIMD_WIDTH * history->points + g) * (size_t)history->n * SIMD_WIDTH;
}

/* What every loop over elements asks the material for: the stress of point g of the batch that begins with element `first` */
SIMD_INLINE void SolidStress(const Solid *solid, PetscInt first, PetscInt g, const SimdReal H[9], SimdReal P[9])
{
  const ElementHistory *history = solid->history;

  if (history->start) {
    const size_t at = SolidHistoryOffset(history, first, g);

    (*solid->kernels.advance)(solid->kernels.data, history->step, (const PetscReal(*)[SIMD_WIDTH])H,
                              (const PetscReal(*)[SIMD_WIDTH])(history->start + at),
                              history->end ? (PetscReal(*)[SIMD_WIDTH])(history->end + at) : NULL, P);
  } else (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])H, P);
}

/* Which number of the history of a point is plastic work */
SIMD_INLINE PetscInt SolidPlasticWork(const Solid *solid)
{
  return solid->history->by_ends && solid->kernels.taken ? solid->kernels.taken : solid->kernels.plastic_work;
}

/* And for the stored energy, with the plastic work of materials with history */
SIMD_INLINE void SolidEnergy(const Solid *solid, PetscInt first, PetscInt g, const SimdReal H[9], SimdReal W, SimdReal work)
{
  const ElementHistory *history = solid->history;

  if (history->start) {
    const PetscReal *now = history->start + SolidHistoryOffset(history, first, g);

    (*solid->kernels.hold)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])H, (const PetscReal(*)[SIMD_WIDTH])now, W, NULL);
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) work[p] = now[SolidPlasticWork(solid) * SIMD_WIDTH + p];
  } else {
    (*solid->kernels.energy)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])H, W);
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) work[p] = 0;
  }
}

PETSC_EXTERN PetscErrorCode ElementCreate_Solid(Element, const SolidShape *);
PETSC_EXTERN PetscErrorCode ElementCreate_Solid_MeanDilatation(Element);
PETSC_INTERN PetscErrorCode SolidViscousForce(Element, const PetscScalar[], const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode SolidSetUpMaterial(Element, const PetscReal[]);
PETSC_EXTERN PetscReal      SolidGetShape(Element, PetscInt, const PetscReal xi[], PetscReal N[], PetscReal gradient[]);
PETSC_INTERN PetscErrorCode ElementTangent_Solid(Element, PetscInt, PetscBool, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode ElementEnergy_Solid(Element, const PetscScalar[], PetscReal *);
PETSC_INTERN PetscErrorCode ElementStress_Solid(Element, const PetscScalar[], PetscReal[]);
PETSC_INTERN PetscErrorCode ElementPlastic_Solid(Element, PetscReal *, PetscReal[]);
PETSC_INTERN PetscErrorCode ElementPoints_Solid(Element, PetscInt, PetscReal[], PetscReal[]);
PETSC_INTERN PetscErrorCode ElementNearest_Solid(Element, PetscInt, const PetscReal[], PetscReal[], PetscReal *);
PETSC_EXTERN void           SolidTangent(const Solid *, PetscInt, PetscInt, const PetscReal H[9], PetscReal tangent[81]);
PETSC_EXTERN void           SolidTurnTangent(const PetscReal H[9], PetscReal tangent[81]);

/* sigma = P F^T / det F; of linear materials P, for which they are the same */
SIMD_INLINE void SolidCauchy(SimdReal H[9], SimdReal P[9], PetscBool linear, PetscInt p, PetscReal sigma[6])
{
  const PetscReal xx = 1 + H[0][p], yy = 1 + H[4][p], zz = 1 + H[8][p], xy = H[1][p], xz = H[2][p], yx = H[3][p], yz = H[5][p],
                  zx = H[6][p], zy = H[7][p];
  const PetscReal s = 1 / (xx * (yy * zz - yz * zy) + xy * (yz * zx - yx * zz) + xz * (yx * zy - yy * zx));

  if (linear) {
    sigma[0] = P[0][p];
    sigma[1] = P[4][p];
    sigma[2] = P[8][p];
    sigma[3] = P[1][p];
    sigma[4] = P[5][p];
    sigma[5] = P[2][p];
  } else {
    sigma[0] = s * (P[0][p] * xx + P[1][p] * xy + P[2][p] * xz);
    sigma[1] = s * (P[3][p] * yx + P[4][p] * yy + P[5][p] * yz);
    sigma[2] = s * (P[6][p] * zx + P[7][p] * zy + P[8][p] * zz);
    sigma[3] = s * (P[0][p] * yx + P[1][p] * yy + P[2][p] * yz);
    sigma[4] = s * (P[3][p] * zx + P[4][p] * zy + P[5][p] * zz);
    sigma[5] = s * (P[0][p] * zx + P[1][p] * zy + P[2][p] * zz);
  }
}

/* rate = (F^T dH + dH^T F) / 2 with F = 1 + H */
SIMD_INLINE void SolidRateOfStrain(const SimdReal H[9], const SimdReal dH[9], SimdReal rate[9])
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++)
    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt j = 0; j < 3; j++) {
        PetscReal sum = dH[3 * i + j][p] + dH[3 * j + i][p];

        for (PetscInt k = 0; k < 3; k++) sum += H[3 * k + i][p] * dH[3 * k + j][p] + H[3 * k + j][p] * dH[3 * k + i][p];
        rate[3 * i + j][p] = 0.5 * sum;
      }
}

/* P = F S with F = 1 + H */
SIMD_INLINE void SolidPullBack(const SimdReal H[9], const SimdReal S[9], SimdReal P[9])
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++)
    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt j = 0; j < 3; j++) {
        PetscReal sum = S[3 * i + j][p];

        for (PetscInt k = 0; k < 3; k++) sum += H[3 * i + k][p] * S[3 * k + j][p];
        P[3 * i + j][p] = sum;
      }
}
