/* quad4 with one point of integration. */
#include <element/quad4.h>
#include <element/reducedloops.h>

PetscErrorCode ElementCreate_Quad4_Reduced(Element element)
{
  PetscFunctionBegin;
  PetscCall(CreateReduced(element));
  PetscFunctionReturn(PETSC_SUCCESS);
}
