#include <impakt/private/elementimpl.h>

static PetscFunctionList ElementList = NULL;

/* Elements are found by the shape of a mesh cell. */
PetscErrorCode ElementRegister(DMPolytopeType cell, PetscErrorCode (*create)(Element))
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListAdd(&ElementList, DMPolytopeTypes[cell], create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementRegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(ElementRegister(DM_POLYTOPE_SEGMENT, ElementCreate_Bar2));
  PetscCall(ElementRegister(DM_POLYTOPE_TRIANGLE, ElementCreate_Tri3));
  PetscCall(ElementRegister(DM_POLYTOPE_QUADRILATERAL, ElementCreate_Quad4));
  PetscCall(ElementRegister(DM_POLYTOPE_TETRAHEDRON, ElementCreate_Tet4));
  PetscCall(ElementRegister(DM_POLYTOPE_HEXAHEDRON, ElementCreate_Hex8));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementFinalizePackage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&ElementList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(PetscErrorCode (*create)(Element), Material material, Element *element)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(element));
  (*element)->create        = create;
  (*element)->material      = material;
  (*element)->cross_section = 1;
  (*element)->inverted      = -1;
  PetscCall((*create)(*element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The element for a shape of cell, with its own options (prefix of the body) read. */
PetscErrorCode ElementCreate(MPI_Comm comm, const char prefix[], DMPolytopeType cell, Material material, Element *element)
{
  PetscErrorCode (*create)(Element);

  PetscFunctionBegin;
  PetscCall(PetscFunctionListFind(ElementList, DMPolytopeTypes[cell], &create));
  PetscCheck(create, comm, PETSC_ERR_SUP,
             "The mesh of body -%s has cells of shape '%s', for which there is no element yet; known: segment (2-node bar), triangle (3 "
             "nodes), quad (4 nodes), tetrahedron (4 nodes), hexahedron (8 nodes)",
             prefix, DMPolytopeTypes[cell]);
  PetscCall(Create(create, material, element));
  if ((*element)->ops.setfromoptions) PetscCall((*(*element)->ops.setfromoptions)(*element, comm, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One of the same shape with the same options, for other cells or another material; not set up */
PetscErrorCode ElementCreateLike(Element element, Material material, Element *other)
{
  PetscFunctionBegin;
  PetscCall(Create(element->create, material, other));
  (*other)->cross_section = element->cross_section;
  if (element->ops.copyoptions) PetscCall((*element->ops.copyoptions)(element, *other));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the element its cells (count x nodes local node numbers, in the usual order: VTK's) and the coordinates of the rank's nodes; both
   are kept by reference. */
PetscErrorCode ElementSetUp(Element element, PetscInt count, const PetscInt connectivity[], const PetscReal coordinates[])
{
  PetscFunctionBegin;
  element->count        = count;
  element->connectivity = connectivity;
  PetscCall((*element->ops.setup)(element, coordinates));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementDestroy(Element *element)
{
  PetscFunctionBegin;
  if (!*element) PetscFunctionReturn(PETSC_SUCCESS);
  if ((*element)->ops.destroy) PetscCall((*(*element)->ops.destroy)(*element));
  PetscCall(PetscFree(*element));
  PetscFunctionReturn(PETSC_SUCCESS);
}
