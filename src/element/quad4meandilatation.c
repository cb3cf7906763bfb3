/* quad4 with a mean dilatation. */
#include <element/quad4.h>
#include <element/boxpoints.h>

PetscErrorCode ElementCreate_Quad4_MeanDilatation(Element element)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate_Solid_MeanDilatation(element));
  SetLoops(element);
  PetscFunctionReturn(PETSC_SUCCESS);
}
