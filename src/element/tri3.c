/* Three-node triangle, linear, one point. Vertices counterclockwise. */
#include <impakt/private/solid.h>

#define DIM    2
#define NODES  3
#define MODES  2
#define POINTS 1
#define WEIGHT 0.5

static const PetscReal points[POINTS][DIM] = {{1.0 / 3, 1.0 / 3}};
/* exact for quadratic functions (Hammer and Stroud 1956) */
static const PetscReal load_points[3][DIM] = {{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}};
static const PetscReal corners[NODES][DIM] = {{0, 0}, {1, 0}, {0, 1}};

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

#include <impakt/private/solidloops.h>

static void Shape(const PetscReal xi[], PetscReal N[], PetscReal dN[])
{
  N[0] = 1 - xi[0] - xi[1];
  for (PetscInt i = 0; i < DIM; i++) {
    N[1 + i] = xi[i];
    dN[i]    = -1;
    for (PetscInt a = 1; a < NODES; a++) dN[DIM * a + i] = a == 1 + i ? 1 : 0;
  }
}

static const SolidShape shape = {DIM, NODES, POINTS, 3, 0.5, &points[0][0], &load_points[0][0], &corners[0][0], Shape};

PetscErrorCode ElementCreate_Tri3(Element element)
{
  PetscFunctionBegin;
  PetscCall(Create(element, &shape));
  PetscFunctionReturn(PETSC_SUCCESS);
}
