/* Composite tetrahedron of ten nodes: the corners, then the middles of the edges 01, 12, 02, 03, 13, 23. */
#define DIM    3
#define NODES  10
#define POINTS 4
#define WEIGHT 1
#include "compositepoints.h"

/* those at the corners; those of the faces between them and the octahedron that is left; those of its faces on the tetrahedron's */
static const PetscInt parts[12][DIM + 1] = {{0, 4, 6, 7},  {4, 1, 5, 8},  {6, 5, 2, 9},  {7, 8, 9, 3},  {4, 6, 7, 10}, {5, 4, 8, 10},
                                            {6, 5, 9, 10}, {8, 7, 9, 10}, {4, 5, 6, 10}, {4, 7, 8, 10}, {5, 8, 9, 10}, {7, 6, 9, 10}};

/* (5 - sqrt 5) / 20 and (5 + 3 sqrt 5) / 20 (Hammer and Stroud 1956) */
static const CompositeShape shape = {
    {DIM, NODES, POINTS, 48, 1, NULL, NULL, NULL, NULL}, 12, &parts[0][0], 0.58541019662496845446, 0.13819660112501051518};

PetscErrorCode ElementCreate_Tet10(Element element)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate_Composite(element, &shape));
  SetLoops(element);
  PetscFunctionReturn(PETSC_SUCCESS);
}
