/* Four-node quadrilateral, bilinear, 2 x 2 Gauss points. Vertices counterclockwise.
   A part of the files of its formulations: its monomials, as solidbatch.h asks for them. */
#pragma once
#include <impakt/private/solid.h>

#define DIM    2
#define NODES  4
#define MODES  3 /* xi, eta, xi eta */
#define POINTS 4
#define WEIGHT 1
#define G      0.57735026918962576451

static const PetscReal points[POINTS][DIM] = {{-G, -G}, {G, -G}, {G, G}, {-G, G}};

/* Gradients of monomials by powers of the coordinates: 1, xi, eta */
#define TERMS 3
static const SolidTerm terms[TERMS] = {{4, 2, {0, 1}, {0, 1}}, {4. / 3, 1, {1}, {2}}, {4. / 3, 1, {0}, {2}}};

SIMD_INLINE void ModesOfNodes(const SimdVector n[NODES], SimdVector m[MODES])
{
  const SimdVector s0 = n[1] + n[0], d0 = n[1] - n[0], s1 = n[2] + n[3], d1 = n[2] - n[3];

  m[0] = 0.25 * (d1 + d0);
  m[1] = 0.25 * (s1 - s0);
  m[2] = 0.25 * (d1 - d0);
}

SIMD_INLINE void NodesOfModes(const SimdVector m[MODES], SimdVector n[NODES])
{
  const SimdVector s = 0.25 * m[1], d0 = 0.25 * (m[0] - m[2]), d1 = 0.25 * (m[0] + m[2]);

  n[0] = -s - d0;
  n[1] = -s + d0;
  n[2] = s + d1;
  n[3] = s - d1;
}

SIMD_INLINE void GradientOfModes(const SimdVector m[MODES], const PetscReal xi[DIM], SimdVector d[DIM])
{
  d[0] = m[0] + xi[1] * m[2];
  d[1] = m[1] + xi[0] * m[2];
}

SIMD_INLINE void ModesOfGradient(const SimdVector d[DIM], const PetscReal xi[DIM], SimdVector m[MODES])
{
  m[0] += d[0];
  m[1] += d[1];
  m[2] += xi[1] * d[0] + xi[0] * d[1];
}

/* The gradient of an element's area by the coefficients of component i of its positions, exact. That of xi eta does not matter. */
SIMD_INLINE void VolumeGradient(SimdVector x[DIM][MODES], PetscInt i, SimdVector d[MODES])
{
  const PetscReal sign = i == 0 ? 4 : -4;

  d[0] = sign * x[1 - i][1];
  d[1] = -sign * x[1 - i][0];
  d[2] = 0 * d[0];
}

/* What the monomials leave of the function with values n at the nodes: its value in the middle */
SIMD_INLINE void ConstantOfNodes(const SimdVector n[NODES], SimdVector *c)
{
  *c = 0.25 * ((n[0] + n[1]) + (n[2] + n[3]));
}

/* Adds the transpose to n */
SIMD_INLINE void NodesOfConstant(const SimdVector *c, SimdVector n[NODES])
{
  for (PetscInt a = 0; a < NODES; a++) n[a] += 0.25 * *c;
}

/* The function with such a constant and coefficients m at a point */
SIMD_INLINE void ValueOfModes(const SimdVector *c, const SimdVector m[MODES], const PetscReal xi[DIM], SimdVector *value)
{
  *value = *c + xi[0] * m[0] + xi[1] * m[1] + xi[0] * xi[1] * m[2];
}

/* Adds the transpose to c and m */
SIMD_INLINE void ModesOfValue(const SimdVector *q, const PetscReal xi[DIM], SimdVector *c, SimdVector m[MODES])
{
  *c += *q;
  m[0] += xi[0] * *q;
  m[1] += xi[1] * *q;
  m[2] += xi[0] * xi[1] * *q;
}
