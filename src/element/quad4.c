/* Four-node quadrilateral, bilinear, 2 x 2 Gauss points. Vertices counterclockwise. */
#include <impakt/private/solid.h>

#define DIM    2
#define NODES  4
#define MODES  3 /* xi, eta, xi eta */
#define POINTS 4
#define WEIGHT 1
#define G      0.57735026918962576451

static const PetscReal points[POINTS][DIM] = {{-G, -G}, {G, -G}, {G, G}, {-G, G}};
static const PetscReal corners[NODES][DIM] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

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

#include <impakt/private/solidloops.h>

static void Shape(const PetscReal xi[], PetscReal N[], PetscReal dN[])
{
  for (PetscInt a = 0; a < NODES; a++) {
    const PetscReal *c = corners[a], x = 1 + c[0] * xi[0], y = 1 + c[1] * xi[1];

    N[a]          = 0.25 * x * y;
    dN[2 * a]     = 0.25 * c[0] * y;
    dN[2 * a + 1] = 0.25 * c[1] * x;
  }
}

static const SolidShape shape = {DIM, NODES, POINTS, POINTS, 4, &points[0][0], &points[0][0], &corners[0][0], Shape};

PetscErrorCode ElementCreate_Quad4(Element element)
{
  PetscFunctionBegin;
  PetscCall(Create(element, &shape));
  PetscFunctionReturn(PETSC_SUCCESS);
}
