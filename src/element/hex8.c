/* Eight-node hexahedron, trilinear, fully integrated (8 points). Vertices: lower four counterclockwise seen from above, then the upper. */
#include <element/hex8.h>
#include <impakt/private/solidloops.h>

static const PetscReal corners[NODES][DIM] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                              {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};

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
