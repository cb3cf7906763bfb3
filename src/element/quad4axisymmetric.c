/* quad4 as a ring, fully integrated or with a mean dilatation. */
#include <element/quad4.h>
#undef WEIGHT
#define WEIGHT (2 * PETSC_PI)
#define RING
#include <element/boxpoints.h>

PetscErrorCode ElementCreate_Quad4_Axisymmetric(Element element)
{
  PetscFunctionBegin;
  SetLoops(element);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementCreate_Quad4_AxisymmetricMeanDilatation(Element element)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate_Solid_MeanDilatation(element));
  SetLoops(element);
  PetscFunctionReturn(PETSC_SUCCESS);
}
