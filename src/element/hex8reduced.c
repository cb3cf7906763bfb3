/* hex8 with one point of integration. */
#include <element/hex8.h>
#include <element/reducedloops.h>

PetscErrorCode ElementCreate_Hex8_Reduced(Element element)
{
  PetscFunctionBegin;
  PetscCall(CreateReduced(element));
  PetscFunctionReturn(PETSC_SUCCESS);
}
