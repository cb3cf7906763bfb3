/* Eight-node hexahedron, trilinear, 2 x 2 x 2 Gauss points. Vertices: the lower four counterclockwise seen from above, then the upper.
   A part of the files of its formulations: its monomials, as solidbatch.h asks for them. */
#pragma once
#include <impakt/private/solid.h>

#define DIM    3
#define NODES  8
#define MODES  7 /* xi, eta, zeta, xi eta, eta zeta, zeta xi, xi eta zeta */
#define POINTS 8
#define WEIGHT 1
#define G      0.57735026918962576451

static const PetscReal points[POINTS][DIM] = {{-G, -G, -G}, {G, -G, -G}, {G, G, -G}, {-G, G, -G},
                                              {-G, -G, G},  {G, -G, G},  {G, G, G},  {-G, G, G}};

/* Gradients of monomials by powers of the coordinates: 1, xi, eta, zeta, eta zeta, zeta xi, xi eta */
#define TERMS 7
static const SolidTerm terms[TERMS] = {{8, 3, {0, 1, 2}, {0, 1, 2}}, {8. / 3, 2, {1, 2}, {3, 5}}, {8. / 3, 2, {0, 2}, {3, 4}},
                                       {8. / 3, 2, {0, 1}, {5, 4}},  {8. / 9, 1, {0}, {6}},       {8. / 9, 1, {1}, {6}},
                                       {8. / 9, 1, {2}, {6}}};

SIMD_INLINE void ModesOfNodes(const SimdVector n[NODES], SimdVector m[MODES])
{
  /* sums and differences along xi, then along eta, below and above */
  const SimdVector s0 = n[1] + n[0], d0 = n[1] - n[0], s1 = n[2] + n[3], d1 = n[2] - n[3];
  const SimdVector s2 = n[5] + n[4], d2 = n[5] - n[4], s3 = n[6] + n[7], d3 = n[6] - n[7];
  const SimdVector ss0 = s1 + s0, ds0 = s1 - s0, sd0 = d1 + d0, dd0 = d1 - d0;
  const SimdVector ss1 = s3 + s2, ds1 = s3 - s2, sd1 = d3 + d2, dd1 = d3 - d2;

  m[0] = 0.125 * (sd1 + sd0);
  m[1] = 0.125 * (ds1 + ds0);
  m[2] = 0.125 * (ss1 - ss0);
  m[3] = 0.125 * (dd1 + dd0);
  m[4] = 0.125 * (ds1 - ds0);
  m[5] = 0.125 * (sd1 - sd0);
  m[6] = 0.125 * (dd1 - dd0);
}

SIMD_INLINE void NodesOfModes(const SimdVector m[MODES], SimdVector n[NODES])
{
  const SimdVector sd0 = 0.125 * (m[0] - m[5]), sd1 = 0.125 * (m[0] + m[5]), ds0 = 0.125 * (m[1] - m[4]), ds1 = 0.125 * (m[1] + m[4]);
  const SimdVector dd0 = 0.125 * (m[3] - m[6]), dd1 = 0.125 * (m[3] + m[6]), ss = 0.125 * m[2];
  const SimdVector s0 = -ss - ds0, s1 = -ss + ds0, d0 = sd0 - dd0, d1 = sd0 + dd0;
  const SimdVector s2 = ss - ds1, s3 = ss + ds1, d2 = sd1 - dd1, d3 = sd1 + dd1;

  n[0] = s0 - d0;
  n[1] = s0 + d0;
  n[2] = s1 + d1;
  n[3] = s1 - d1;
  n[4] = s2 - d2;
  n[5] = s2 + d2;
  n[6] = s3 + d3;
  n[7] = s3 - d3;
}

SIMD_INLINE void GradientOfModes(const SimdVector m[MODES], const PetscReal xi[DIM], SimdVector d[DIM])
{
  d[0] = m[0] + xi[1] * m[3] + xi[2] * (m[5] + xi[1] * m[6]);
  d[1] = m[1] + xi[2] * m[4] + xi[0] * (m[3] + xi[2] * m[6]);
  d[2] = m[2] + xi[0] * m[5] + xi[1] * (m[4] + xi[0] * m[6]);
}

SIMD_INLINE void ModesOfGradient(const SimdVector d[DIM], const PetscReal xi[DIM], SimdVector m[MODES])
{
  m[0] += d[0];
  m[1] += d[1];
  m[2] += d[2];
  m[3] += xi[1] * d[0] + xi[0] * d[1];
  m[4] += xi[2] * d[1] + xi[1] * d[2];
  m[5] += xi[2] * d[0] + xi[0] * d[2];
  m[6] += xi[1] * xi[2] * d[0] + xi[2] * xi[0] * d[1] + xi[0] * xi[1] * d[2];
}

/* The gradient of an element's volume by the coefficients of component i of its positions, exact: the determinant of the positions'
   gradient integrated over the reference element. The coefficient of xi eta zeta does not matter. */
SIMD_INLINE void VolumeGradient(SimdVector x[DIM][MODES], PetscInt i, SimdVector d[MODES])
{
  const SimdVector *v = x[(i + 1) % 3], *w = x[(i + 2) % 3];
  const SimdVector  bv[3] = {v[4], v[5], v[3]}, bw[3] = {w[4], w[5], w[3]}; /* of the products without xi, eta, zeta */
  SimdVector        b[3];

#pragma GCC unroll 3
  for (PetscInt k = 0; k < 3; k++) {
    const PetscInt l = (k + 1) % 3, m = (k + 2) % 3;

    d[k] = 8 * (v[l] * w[m] - v[m] * w[l] - (1. / 3) * (bv[l] * bw[m] - bv[m] * bw[l]));
    b[k] = -8. / 3 * (v[l] * bw[m] - v[m] * bw[l] + bv[l] * w[m] - bv[m] * w[l]);
  }
  d[3] = b[2];
  d[4] = b[0];
  d[5] = b[1];
  d[6] = 0 * d[0];
}
