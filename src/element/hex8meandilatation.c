/* hex8 with a mean dilatation. */
#include <element/hex8.h>
#include <element/boxpoints.h>

PetscErrorCode ElementCreate_Hex8_MeanDilatation(Element element)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate_Solid_MeanDilatation(element));
  SetLoops(element);
  PetscFunctionReturn(PETSC_SUCCESS);
}
