/* Composite triangle of six nodes: the corners counterclockwise, then the middles of the edges 01, 12, 02. */
#define DIM    2
#define NODES  6
#define POINTS 3
#define WEIGHT 1
#include "compositepoints.h"

static const PetscInt parts[4][DIM + 1] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

/* points at 2/3, 1/6, 1/6 (Hammer and Stroud 1956) */
static const CompositeShape shape = {{DIM, NODES, POINTS, 12, 1, NULL, NULL, NULL, NULL}, 4, &parts[0][0], 2. / 3, 1. / 6};

PetscErrorCode ElementCreate_Tri6(Element element)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate_Composite(element, &shape));
  SetLoops(element);
  PetscFunctionReturn(PETSC_SUCCESS);
}
