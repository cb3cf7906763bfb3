/* Four-node quadrilateral, bilinear, 2 x 2 Gauss points. Vertices counterclockwise. Fully integrated. */
#include <element/quad4.h>
#include <impakt/private/solidloops.h>

static const PetscReal corners[NODES][DIM] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

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
