/* Three-node triangle, linear, one point. Vertices counterclockwise. Its monomials, as solidbatch.h asks for them. */
#pragma once
#include <impakt/private/solid.h>

#define DIM    2
#define NODES  3
#define MODES  2
#define POINTS 1
#define WEIGHT 0.5

static const PetscReal points[POINTS][DIM] = {{1.0 / 3, 1.0 / 3}};

/* Gradients of the monomials are constant */
#define TERMS 1
static const SolidTerm terms[TERMS] = {{1, 2, {0, 1}, {0, 1}}};

SIMD_INLINE void ModesOfNodes(const SimdVector n[NODES], SimdVector m[MODES])
{
  m[0] = n[1] - n[0];
  m[1] = n[2] - n[0];
}

SIMD_INLINE void NodesOfModes(const SimdVector m[MODES], SimdVector n[NODES])
{
  n[0] = -(m[0] + m[1]);
  n[1] = m[0];
  n[2] = m[1];
}

SIMD_INLINE void GradientOfModes(const SimdVector m[MODES], const PetscReal xi[DIM], SimdVector d[DIM])
{
  (void)xi;
  d[0] = m[0];
  d[1] = m[1];
}

SIMD_INLINE void ModesOfGradient(const SimdVector d[DIM], const PetscReal xi[DIM], SimdVector m[MODES])
{
  (void)xi;
  m[0] += d[0];
  m[1] += d[1];
}

/* What the monomials leave of the function with values n at the nodes: its value at the first one */
SIMD_INLINE void ConstantOfNodes(const SimdVector n[NODES], SimdVector *c)
{
  *c = n[0];
}

/* Adds the transpose to n */
SIMD_INLINE void NodesOfConstant(const SimdVector *c, SimdVector n[NODES])
{
  n[0] += *c;
}

/* The function with such a constant and coefficients m at a point */
SIMD_INLINE void ValueOfModes(const SimdVector *c, const SimdVector m[MODES], const PetscReal xi[DIM], SimdVector *value)
{
  *value = *c + xi[0] * m[0] + xi[1] * m[1];
}

/* Adds the transpose to c and m */
SIMD_INLINE void ModesOfValue(const SimdVector *q, const PetscReal xi[DIM], SimdVector *c, SimdVector m[MODES])
{
  *c += *q;
  m[0] += xi[0] * *q;
  m[1] += xi[1] * *q;
}
