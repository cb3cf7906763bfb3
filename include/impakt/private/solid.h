/* Solid elements in two and three dimensions: what tri3, quad4, tet4 and hex8 share. Total Lagrangian: everything is integrated over the
   undeformed element. */
#pragma once
#include <impakt/private/elementimpl.h>
#include <impakt/private/simd.h>

#define SOLID_MAX_NODES  8
#define SOLID_MAX_POINTS 8

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
  const SolidShape *shape;
  const PetscReal  *coordinates; /* of the rank's nodes; owned by the body */
  MaterialKernels   kernels;
  MaterialKernels   unconstrained; /* of the same material when not in plane stress */
  PetscBool         plane_stress, linear;
  PetscReal         load_shape[SOLID_MAX_POINTS * SOLID_MAX_NODES];
} Solid;

PETSC_EXTERN PetscErrorCode ElementCreate_Solid(Element, const SolidShape *);
PETSC_EXTERN void           SolidStretchThickness(const Solid *, PetscReal H[9][SIMD_WIDTH]);
