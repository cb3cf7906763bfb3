/*
   Batches of elements of one shape: displacement gradients at a point of integration, and the way back to forces. A template: a shape's
   file defines

     DIM, NODES, POINTS            space dimension, nodes, points of integration
     MODES                         monomials beyond 1 that its shape functions span, of which the first DIM are the coordinates
     points[POINTS][DIM], WEIGHT   where in the reference element, and the weight of each
     ModesOfNodes(n, m)            coefficients of those monomials in the function with values n at the nodes
     NodesOfModes(m, n)            the transpose
     GradientOfModes(m, xi, d)     gradient in the reference element of the function with coefficients m
     ModesOfGradient(d, xi, m)     adds the transpose to m

   and includes this. Everything of an element but its nodes is found anew from the coordinates each time: it costs less than fetching it
   from memory. By monomials, gradients at a point of a hexahedron take 27 multiplications where nodes would take 72.
*/
#include <impakt/private/solid.h>

/* Gradients of a batch at a point of integration */
typedef struct {
  SimdReal   H[9];                           /* du_i/dX_j; third row and column zero in two dimensions */
  SimdVector cofactor[SIMD_PARTS][DIM][DIM]; /* of dX_i/dxi_j: its inverse is their transpose over the determinant */
  SimdReal   determinant;
} Gradients;

/* Numbers that lie apart, straight into a register: written one by one and read as one they would have to go through the cache */
SIMD_INLINE SimdVector Gather(const PetscReal values[], const size_t at[SIMD_WIDTH / SIMD_PARTS])
{
  return (SimdVector){values[at[0]], values[at[1]], values[at[2]], values[at[3]]};
}

/* Zeros, number by number: an initialiser of the whole array is a loop over its bytes, and took a tenth of the internal force */
SIMD_INLINE void ZeroModes(SimdVector modes[SIMD_PARTS][DIM][MODES])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 8
      for (PetscInt k = 0; k < MODES; k++) modes[part][i][k] = (SimdVector){0};
}

/* What a gradient in the plane has across it */
SIMD_INLINE void ZeroAcross(SimdReal H[9])
{
  for (PetscInt part = 0; part < SIMD_PARTS && DIM == 2; part++)
#pragma GCC unroll 9
    for (PetscInt k = 0; k < 9; k++)
      if (k % 3 == 2 || k / 3 == 2) SimdGetParts(H[k])[part] = (SimdVector){0};
}

/* Values at the nodes of a batch of elements, as coefficients of monomials; past the last element, it is taken again */
SIMD_INLINE void GetModes(const PetscInt connectivity[], PetscInt first, PetscInt count, const PetscReal values[],
                          SimdVector modes[SIMD_PARTS][DIM][MODES])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const PetscInt *element[SIMD_WIDTH / SIMD_PARTS];
    SimdVector      nodal[DIM][NODES];

    for (PetscInt p = 0; p < SIMD_WIDTH / SIMD_PARTS; p++)
      element[p] = connectivity + NODES * PetscMin(first + SIMD_WIDTH / SIMD_PARTS * part + p, count - 1);
#pragma GCC unroll 8
    for (PetscInt a = 0; a < NODES; a++) {
      size_t at[SIMD_WIDTH / SIMD_PARTS];

      for (PetscInt p = 0; p < SIMD_WIDTH / SIMD_PARTS; p++) at[p] = DIM * (size_t)element[p][a];
#pragma GCC unroll 3
      for (PetscInt i = 0; i < DIM; i++) nodal[i][a] = Gather(values + i, at);
    }
#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++) ModesOfNodes(nodal[i], modes[part][i]);
  }
}

/* Cofactors of a matrix, and its determinant */
SIMD_INLINE void Cofactors(SimdVector a[DIM][DIM], SimdVector c[DIM][DIM], SimdVector *determinant)
{
#if DIM == 2
  c[0][0]      = a[1][1];
  c[0][1]      = -a[1][0];
  c[1][0]      = -a[0][1];
  c[1][1]      = a[0][0];
  *determinant = a[0][0] * c[0][0] + a[0][1] * c[0][1];
#else
  c[0][0]      = a[1][1] * a[2][2] - a[1][2] * a[2][1];
  c[0][1]      = a[1][2] * a[2][0] - a[1][0] * a[2][2];
  c[0][2]      = a[1][0] * a[2][1] - a[1][1] * a[2][0];
  c[1][0]      = a[2][1] * a[0][2] - a[2][2] * a[0][1];
  c[1][1]      = a[2][2] * a[0][0] - a[2][0] * a[0][2];
  c[1][2]      = a[2][0] * a[0][1] - a[2][1] * a[0][0];
  c[2][0]      = a[0][1] * a[1][2] - a[0][2] * a[1][1];
  c[2][1]      = a[0][2] * a[1][0] - a[0][0] * a[1][2];
  c[2][2]      = a[0][0] * a[1][1] - a[0][1] * a[1][0];
  *determinant = a[0][0] * c[0][0] + a[0][1] * c[0][1] + a[0][2] * c[0][2];
#endif
}

SIMD_INLINE void GetGradientsOfPart(PetscInt part, SimdVector X[DIM][MODES], SimdVector U[DIM][MODES], const PetscReal xi[DIM],
                                    Gradients *at)
{
  SimdVector x[DIM][DIM], u[DIM][DIM], c[DIM][DIM], determinant, inverse;

#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++) {
    GradientOfModes(X[i], xi, x[i]);
    GradientOfModes(U[i], xi, u[i]);
  }
  Cofactors(x, c, &determinant);
  inverse                             = 1 / determinant;
  SimdGetParts(at->determinant)[part] = determinant;
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
    for (PetscInt j = 0; j < DIM; j++) {
      SimdVector h = u[i][0] * c[j][0];

#pragma GCC unroll 3
      for (PetscInt k = 1; k < DIM; k++) h += u[i][k] * c[j][k];
      SimdGetParts(at->H[3 * i + j])[part] = inverse * h;
      at->cofactor[part][i][j]             = c[i][j];
    }
}

SIMD_INLINE void GetGradients(SimdVector X[SIMD_PARTS][DIM][MODES], SimdVector U[SIMD_PARTS][DIM][MODES], const PetscReal xi[DIM],
                              Gradients *at)
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) GetGradientsOfPart(part, X[part], U[part], xi, at);
}

/* The same at the first point, with all that it takes */
SIMD_INLINE void GetFirstGradients(const Solid *solid, const PetscInt connectivity[], PetscInt first, PetscInt count, const PetscReal u[],
                                   Gradients *at)
{
  SimdVector X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES];

  GetModes(connectivity, first, count, solid->coordinates, X);
  GetModes(connectivity, first, count, u, U);
  GetGradients(X, U, points[0], at);
}

/* Adds the force of one point, by monomials: the stress against the axes of the reference element against their gradients */
SIMD_INLINE void AddPointOfPart(PetscInt part, SimdReal P[9], const SimdVector cofactor[DIM][DIM], const PetscReal xi[DIM],
                                SimdVector F[DIM][MODES])
{
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++) {
    SimdVector q[DIM];

#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++) {
      q[k] = SimdGetParts(P[3 * i])[part] * cofactor[0][k];
#pragma GCC unroll 3
      for (PetscInt j = 1; j < DIM; j++) q[k] += SimdGetParts(P[3 * i + j])[part] * cofactor[j][k];
    }
    ModesOfGradient(q, xi, F[i]);
  }
}

/* The forces of a batch times a scale, by monomials, at its nodes */
SIMD_INLINE void GetNodal(PetscReal scale, SimdVector F[SIMD_PARTS][DIM][MODES], SimdReal nodal[DIM][NODES])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
    for (PetscInt i = 0; i < DIM; i++) {
      SimdVector n[NODES];

      for (PetscInt k = 0; k < MODES; k++) F[part][i][k] *= scale;
      NodesOfModes(F[part][i], n);
#pragma GCC unroll 8
      for (PetscInt a = 0; a < NODES; a++) SimdGetParts(nodal[i][a])[part] = n[a];
    }
}

/* Adds them to those of all */
SIMD_INLINE void AddNodal(const PetscInt connectivity[], PetscInt first, PetscInt in_batch, const SimdReal nodal[DIM][NODES], PetscReal f[])
{
  for (PetscInt p = 0; p < in_batch; p++) {
    const PetscInt *nodes = connectivity + NODES * (first + p);

    for (PetscInt a = 0; a < NODES; a++) {
      PetscReal *of_node = f + (size_t)(DIM * nodes[a]);

      for (PetscInt i = 0; i < DIM; i++) of_node[i] += nodal[i][a][p];
    }
  }
}

SIMD_INLINE void AddBatchForces(PetscReal scale, const PetscInt connectivity[], PetscInt first, PetscInt in_batch,
                                SimdVector F[SIMD_PARTS][DIM][MODES], PetscReal f[])
{
  SimdReal nodal[DIM][NODES];

  GetNodal(scale, F, nodal);
  AddNodal(connectivity, first, in_batch, (const SimdReal(*)[NODES])nodal, f);
}

/* What is observed of a point: see Solid */
SIMD_INLINE void StorePoint(Gradients *at, SimdReal H[9], SimdReal weight)
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    for (PetscInt k = 0; k < 9; k++) SimdGetParts(H[k])[part] = SimdGetParts(at->H[k])[part];
    SimdGetParts(weight)[part] = SimdGetParts(at->determinant)[part];
  }
}

/* The first member of a batch whose number is not one; -1: none */
SIMD_INLINE PetscInt FindNaN(const SimdReal values)
{
  PetscInt any = 0;

  for (PetscInt p = 0; p < SIMD_WIDTH; p++) any |= values[p] != values[p]; /* NOLINT(misc-redundant-expression): the test that vectorises */
  if (any)
    for (PetscInt p = 0; p < SIMD_WIDTH; p++)
      if (isnan(values[p])) return p;
  return -1;
}
