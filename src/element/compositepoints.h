/* The loops over all composite elements of one shape. A template: DIM, NODES, POINTS, WEIGHT 1, and then this.

   What pointloops.h asks for. Gradients at the points are linear functions of the displacements of all nodes, see composite.c. */
#include "composite.h"

#define SHARE(solid) ((solid)->mean_share)

typedef struct {
  const SimdReal *gradients, *weights; /* of one batch: points x nodes x dim; points */
} Batch;

typedef struct {
  SimdReal nodal[DIM * NODES];
} Values;

typedef Values Forces;

SIMD_INLINE void GetBatch(const Solid *solid, const PetscInt connectivity[], PetscInt first, PetscInt count, Batch *batch)
{
  const Composite *composite = (const Composite *)solid->own;
  const size_t     at        = (size_t)(first / SIMD_WIDTH);

  (void)connectivity;
  (void)count;
  *batch = (Batch){(const SimdReal *)(const void *)(composite->gradients + at * (POINTS * NODES * DIM * SIMD_WIDTH)),
                   (const SimdReal *)(const void *)(composite->weights + at * (POINTS * SIMD_WIDTH))};
}

SIMD_INLINE void GetValues(const PetscInt connectivity[], PetscInt first, PetscInt count, const PetscReal values[], Values *v)
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscInt *nodes = connectivity + NODES * PetscMin(first + p, count - 1);

    for (PetscInt a = 0; a < NODES; a++) {
      const PetscReal *of_node = values + (size_t)(DIM * nodes[a]);

      for (PetscInt i = 0; i < DIM; i++) v->nodal[DIM * a + i][p] = of_node[i];
    }
  }
}

SIMD_INLINE void GetGradient(const Batch *batch, PetscInt g, Values *v, SimdReal H[9])
{
  const SimdReal *gradient = batch->gradients + (ptrdiff_t)(g * NODES * DIM);

  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    SimdVector h[DIM][DIM] = {{{0}}};

    for (PetscInt a = 0; a < NODES; a++) {
      const SimdVector *of_node = (const SimdVector *)gradient + a * DIM * SIMD_PARTS + part;

#pragma GCC unroll 3
      for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
        for (PetscInt k = 0; k < DIM; k++) h[i][k] += SimdGetParts(v->nodal[DIM * a + i])[part] * of_node[k * SIMD_PARTS];
    }
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++) SimdGetParts(H[3 * i + k])[part] = h[i][k];
    if (DIM == 2) SimdGetParts(H[8])[part] = (SimdVector){0};
  }
}

/* Adds the force of a point to those of the nodes */
SIMD_INLINE void AddForce(const Batch *batch, PetscInt g, SimdReal P[9], Forces *F)
{
  const SimdReal *gradient = batch->gradients + (ptrdiff_t)(g * NODES * DIM);

  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const SimdVector w = ((const SimdVector *)batch->weights[g])[part];
    SimdVector       q[DIM][DIM];

    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++) q[i][k] = w * SimdGetParts(P[3 * i + k])[part];
    for (PetscInt a = 0; a < NODES; a++) {
      const SimdVector *of_node = (const SimdVector *)gradient + a * DIM * SIMD_PARTS + part;

#pragma GCC unroll 3
      for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
        for (PetscInt k = 0; k < DIM; k++) SimdGetParts(F->nodal[DIM * a + i])[part] += q[i][k] * of_node[k * SIMD_PARTS];
    }
  }
}

SIMD_INLINE PetscInt AddToAll(PetscReal scale, const PetscInt connectivity[], PetscInt first, PetscInt in_batch, Forces *F, PetscReal f[])
{
  PetscInt bad = -1;

  for (PetscInt p = 0; p < in_batch; p++) {
    PetscReal check = 0;

    for (PetscInt a = 0; a < NODES; a++) {
      PetscReal *of_node = f + (size_t)(DIM * connectivity[NODES * (first + p) + a]);

      for (PetscInt i = 0; i < DIM; i++) {
        of_node[i] += scale * F->nodal[DIM * a + i][p];
        check += F->nodal[DIM * a + i][p];
      }
    }
    if (bad < 0 && check != check) bad = p; /* NOLINT(misc-redundant-expression): a NaN */
  }
  return bad;
}

#include <element/pointloops.h>
