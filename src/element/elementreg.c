/* The registry of elements, by the shape of a mesh cell, and the package of the class. */
#include <impakt/private/elementimpl.h>
#include <sys/package.h>

PetscClassId ELEMENT_CLASSID = 0;

PetscFunctionList ElementList = NULL, ElementFormulationList = NULL;

/*@C
  ElementRegister - adds the element for a shape of mesh cell to the registry

  Not Collective

  Input Parameters:
+ cell_type - shape of the cell
- create    - function that sets up the shape-specific part of an `Element`

  Level: developer

  Note:
  An element that is registered later takes the place of an earlier one of the same shape.

.seealso: `Element`, `MaterialRegister()`
@*/
PetscErrorCode ElementRegister(DMPolytopeType cell_type, PetscErrorCode (*create)(Element))
{
  PetscFunctionBegin;
  PetscCall(ElementInitializePackage());
  PetscCall(PetscFunctionListAdd(&ElementList, DMPolytopeTypes[cell_type], create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name in the registry: of the shape and of the formulation */
PetscErrorCode ElementFormulationKey(DMPolytopeType cell_type, PetscBool axisymmetric, const char formulation[], size_t size, char key[])
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(key, size, "%s%s/%s", axisymmetric ? "axisymmetric " : "", DMPolytopeTypes[cell_type], formulation));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a formulation of the elements of one shape to the registry. `create` is given an Element as the function of ElementRegister() has
   made it, with its material, before its set-up, and replaces those operations that differ. Elements that are rings about an axis have
   their formulations, the full one among them, for themselves. Not collective. */
PetscErrorCode ElementRegisterFormulation(DMPolytopeType cell_type, PetscBool axisymmetric, const char formulation[],
                                          PetscErrorCode (*create)(Element))
{
  char key[128];

  PetscFunctionBegin;
  PetscAssertPointer(formulation, 3);
  PetscCall(ElementInitializePackage());
  PetscCall(ElementFormulationKey(cell_type, axisymmetric, formulation, sizeof(key), key));
  PetscCall(PetscFunctionListAdd(&ElementFormulationList, key, create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(ElementRegister(DM_POLYTOPE_SEGMENT, ElementCreate_Bar2));
  PetscCall(ElementRegister(DM_POLYTOPE_TRIANGLE, ElementCreate_Tri3));
  PetscCall(ElementRegister(DM_POLYTOPE_QUADRILATERAL, ElementCreate_Quad4));
  PetscCall(ElementRegister(DM_POLYTOPE_TETRAHEDRON, ElementCreate_Tet4));
  PetscCall(ElementRegister(DM_POLYTOPE_HEXAHEDRON, ElementCreate_Hex8));
  PetscCall(
      ElementRegisterFormulation(DM_POLYTOPE_QUADRILATERAL, PETSC_FALSE, ELEMENT_MEAN_DILATATION, ElementCreate_Quad4_MeanDilatation));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_HEXAHEDRON, PETSC_FALSE, ELEMENT_MEAN_DILATATION, ElementCreate_Hex8_MeanDilatation));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_QUADRILATERAL, PETSC_FALSE, ELEMENT_ENHANCED, ElementCreate_Enhanced));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_HEXAHEDRON, PETSC_FALSE, ELEMENT_ENHANCED, ElementCreate_Enhanced));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_QUADRILATERAL, PETSC_FALSE, ELEMENT_REDUCED, ElementCreate_Quad4_Reduced));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_HEXAHEDRON, PETSC_FALSE, ELEMENT_REDUCED, ElementCreate_Hex8_Reduced));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_TRIANGLE, PETSC_FALSE, ELEMENT_COMPOSITE, ElementCreate_Tri6));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_TETRAHEDRON, PETSC_FALSE, ELEMENT_COMPOSITE, ElementCreate_Tet10));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_TRIANGLE, PETSC_TRUE, ELEMENT_FULL, ElementCreate_Tri3_Axisymmetric));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_QUADRILATERAL, PETSC_TRUE, ELEMENT_FULL, ElementCreate_Quad4_Axisymmetric));
  PetscCall(ElementRegisterFormulation(DM_POLYTOPE_QUADRILATERAL, PETSC_TRUE, ELEMENT_MEAN_DILATATION,
                                       ElementCreate_Quad4_AxisymmetricMeanDilatation));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Empty(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&ElementList));
  PetscCall(PetscFunctionListDestroy(&ElementFormulationList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Element", &ELEMENT_CLASSID, RegisterAll, Empty));
  PetscFunctionReturn(PETSC_SUCCESS);
}
