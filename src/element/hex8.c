/* Eight-node hexahedron, trilinear, 2 x 2 x 2 Gauss points. Vertices: the lower four counterclockwise seen from above, then the upper. */
#include <impakt/private/solid.h>

#define DIM    3
#define NODES  8
#define MODES  7 /* xi, eta, zeta, xi eta, eta zeta, zeta xi, xi eta zeta */
#define POINTS 8
#define WEIGHT 1
#define G      0.57735026918962576451

static const PetscReal points[POINTS][DIM] = {{-G, -G, -G}, {G, -G, -G}, {G, G, -G}, {-G, G, -G},
                                              {-G, -G, G},  {G, -G, G},  {G, G, G},  {-G, G, G}};
static const PetscReal corners[NODES][DIM] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                              {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};

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

#include <impakt/private/solidloops.h>

static void Shape(const PetscReal xi[], PetscReal N[], PetscReal dN[])
{
  for (PetscInt a = 0; a < NODES; a++) {
    const PetscReal *c = corners[a], x = 1 + c[0] * xi[0], y = 1 + c[1] * xi[1], z = 1 + c[2] * xi[2];

    N[a]          = 0.125 * x * y * z;
    dN[3 * a]     = 0.125 * c[0] * y * z;
    dN[3 * a + 1] = 0.125 * c[1] * z * x;
    dN[3 * a + 2] = 0.125 * c[2] * x * y;
  }
}

static const SolidShape shape = {DIM, NODES, POINTS, POINTS, 8, &points[0][0], &points[0][0], &corners[0][0], Shape};

PetscErrorCode ElementCreate_Hex8(Element element)
{
  PetscFunctionBegin;
  PetscCall(Create(element, &shape));
  PetscFunctionReturn(PETSC_SUCCESS);
}
