/* The corners of elements, and the edges that meet there. */
#pragma once
#include <body/layout/bodyimpl.h>
#include <impakt/private/simd.h>

enum { MOST_CORNERS = 8 };

/* The ends of the edges of each corner, in an order that makes their Jacobian positive */
typedef struct {
  DMPolytopeType shape;
  PetscInt       corners;
  PetscInt       ends[MOST_CORNERS][3];
  PetscReal      part; /* c in the head of inverted.c */
} Corners;

static const Corners corners_of_shapes[] = {
    {DM_POLYTOPE_SEGMENT, 1, {{1}}, 1},
    {DM_POLYTOPE_TRIANGLE, 1, {{1, 2}}, 1},
    {DM_POLYTOPE_QUADRILATERAL, 4, {{1, 3}, {2, 0}, {3, 1}, {0, 2}}, 1. / 16},
    {DM_POLYTOPE_TETRAHEDRON, 1, {{1, 2, 3}}, 1},
    {DM_POLYTOPE_HEXAHEDRON, 8, {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}}, 1. / 64},
};

static inline const Corners *BodyFindCorners(Body body)
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(corners_of_shapes); i++)
    if (corners_of_shapes[i].shape == body->mesh.cell_shape) return &corners_of_shapes[i];
  return NULL;
}

/* Where the nodes of a cell are, as moved by u; NULL: undeformed. dim is to be known where this is compiled. */
SIMD_INLINE void CornersGetPlaces(PetscInt dim, PetscInt n, const PetscInt nodes[], const PetscReal x[], const PetscScalar u[],
                                  PetscReal place[MOST_CORNERS][3])
{
  for (PetscInt a = 0; a < n; a++)
    for (PetscInt d = 0; d < dim; d++) place[a][d] = x[nodes[a] * dim + d] + (u ? PetscRealPart(u[nodes[a] * dim + d]) : 0);
}
