/* Solid elements in two and three dimensions: what tri3, quad4, tet4 and hex8 share. Total Lagrangian: everything is integrated over the
   undeformed element. */
#pragma once
#include <impakt/private/elementimpl.h>
#include <impakt/private/simd.h>

#define SOLID_MAX_NODES   8
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

typedef struct {
  const SolidShape     *shape;
  const PetscReal      *coordinates; /* of the rank's nodes; owned by the body */
  const ElementHistory *history;     /* of the element */
  MaterialKernels       kernels;
  MaterialKernels       unconstrained; /* of the same material when not in plane stress */
  PetscBool             plane_stress, linear;
  PetscReal             load_shape[SOLID_MAX_POINTS * SOLID_MAX_NODES];
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

/* And for the stored energy, with the plastic work of materials with history */
SIMD_INLINE void SolidEnergy(const Solid *solid, PetscInt first, PetscInt g, const SimdReal H[9], SimdReal W, SimdReal work)
{
  const ElementHistory *history = solid->history;

  if (history->start) {
    const PetscReal *now = history->start + SolidHistoryOffset(history, first, g);

    (*solid->kernels.hold)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])H, (const PetscReal(*)[SIMD_WIDTH])now, W, NULL);
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) work[p] = now[solid->kernels.plastic_work * SIMD_WIDTH + p];
  } else {
    (*solid->kernels.energy)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])H, W);
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) work[p] = 0;
  }
}

PETSC_EXTERN PetscErrorCode ElementCreate_Solid(Element, const SolidShape *);
PETSC_EXTERN void           SolidStretchThickness(const Solid *, PetscReal H[9][SIMD_WIDTH]);
