/* Composite elements: triangles of six nodes and tetrahedra of ten, made of linear ones. Private to src/element. */
#pragma once
#include <impakt/private/solid.h>

enum { COMPOSITE_MAX_PARTS = 12, COMPOSITE_MAX_NODES = 10 };

/* How an element is made of linear ones. Nodes: corners, then mid-edges in VTK's order; one after the last is the mean of these. */
typedef struct {
  SolidShape      solid;
  PetscInt        n_parts;
  const PetscInt *parts; /* nodes of each linear element, dim + 1 */
  /* barycentric coordinates of point g, near corner g: that of corner g, and those of others. Exact for quadratic functions. */
  PetscReal near, far;
} CompositeShape;

typedef struct {
  const CompositeShape *shape;
  void                 *memory;
  PetscReal            *gradients; /* batch by batch: points x nodes x dim x SIMD_WIDTH [1/m] */
  PetscReal            *weights;   /* points x SIMD_WIDTH [m^dim] */
  PetscReal             load_shape[COMPOSITE_MAX_PARTS * 4 * COMPOSITE_MAX_NODES];
} Composite;

PETSC_INTERN PetscErrorCode ElementCreate_Composite(Element, const CompositeShape *);
