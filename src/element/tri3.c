/* Three-node triangle, linear, one point. Vertices counterclockwise. */
#include <element/tri3.h>
#include <impakt/private/solidloops.h>

/* exact for quadratic functions (Hammer and Stroud 1956) */
static const PetscReal load_points[3][DIM] = {{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}};
static const PetscReal corners[NODES][DIM] = {{0, 0}, {1, 0}, {0, 1}};

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
