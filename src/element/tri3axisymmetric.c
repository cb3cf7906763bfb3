/* tri3 as a ring, with the strain along the ring of its centroid. */
#include <element/tri3.h>
#undef WEIGHT
#define WEIGHT PETSC_PI
#define RING
#include <element/boxpoints.h>

PetscErrorCode ElementCreate_Tri3_Axisymmetric(Element element)
{
  PetscFunctionBegin;
  SetLoops(element);
  PetscFunctionReturn(PETSC_SUCCESS);
}
