/* The class: creation, shape, material, options, set-up, view, destruction. */
#include <impakt/private/elementimpl.h>
#include <impakt/private/simd.h>
#include <sys/names.h>
#include <sys/units.h>

/* Creates elements without a shape. Collective */
PetscErrorCode ElementCreate(MPI_Comm comm, Element *element)
{
  PetscFunctionBegin;
  PetscAssertPointer(element, 2);
  PetscCall(ElementInitializePackage());
  PetscCall(PetscHeaderCreate(*element, ELEMENT_CLASSID, "Element", "Finite elements", "Element", comm, ElementDestroy, ElementView));
  (*element)->cell_type     = DM_POLYTOPE_UNKNOWN;
  (*element)->cross_section = 1;
  (*element)->inverted      = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char *Prefix(Element element)
{
  return ((PetscObject)element)->prefix ? ((PetscObject)element)->prefix : "";
}

/* Chooses the element by the shape of the mesh cells. Collective */
PetscErrorCode ElementSetCellType(Element element, DMPolytopeType cell_type)
{
  PetscErrorCode (*create)(Element);

  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidLogicalCollectiveEnum(element, cell_type, 2);
  PetscCheck(!element->setup, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE, "Call before ElementSetUp()");
  if (element->cell_type == cell_type) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFunctionListFind(ElementList, DMPolytopeTypes[cell_type], &create));
  if (!create) {
    char known[1024];

    PetscCall(NamesOfRegistry(ElementList, sizeof(known), known));
    SETERRQ(PetscObjectComm((PetscObject)element), PETSC_ERR_SUP,
            "The mesh of body -%s has cells of shape '%s', for which there is no element yet; known: %s", Prefix(element),
            DMPolytopeTypes[cell_type], known);
  }
  PetscTryTypeMethod(element, destroy);
  PetscCall(PetscMemzero(element->ops, sizeof(*element->ops)));
  element->data      = NULL;
  element->cell_type = cell_type;
  PetscCall((*create)(element));
  PetscCall(PetscObjectChangeTypeName((PetscObject)element, DMPolytopeTypes[cell_type]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the material of all elements */
PetscErrorCode ElementSetMaterial(Element element, Material material)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 2);
  PetscCheck(!element->setup, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE, "Call before ElementSetUp()");
  PetscCall(PetscObjectReference((PetscObject)material));
  PetscCall(MaterialDestroy(&element->material));
  element->material = material;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error where rings are asked for that there are not */
static PetscErrorCode CheckAxisymmetric(Element element)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)element);

  PetscFunctionBegin;
  if (!element->axisymmetric) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(element->dim == 2, comm, PETSC_ERR_USER_INPUT,
             "-%saxisymmetric true: the mesh has %" PetscInt_FMT
             " dimensions; rings are made of plane meshes, whose first coordinate is the "
             "distance from the axis",
             Prefix(element), element->dim);
  PetscCheck(!element->plane_stress, comm, PETSC_ERR_USER_INPUT,
             "-%splane_stress true and -%saxisymmetric true: rings have a stress along them; leave one out", Prefix(element),
             Prefix(element));
  PetscCheck(!element->cross_section_dim, comm, PETSC_ERR_USER_INPUT,
             "-%sthickness %g and -%saxisymmetric true: rings have no thickness, they go all around; leave one out", Prefix(element),
             (double)element->cross_section, Prefix(element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads what the elements of a shape take from the options. Collective */
PetscErrorCode ElementSetFromOptions(Element element)
{
  char      formulation[128];
  PetscBool axisymmetric = element->axisymmetric, set;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscCheck(element->cell_type != DM_POLYTOPE_UNKNOWN, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE,
             "Call ElementSetCellType() first");
  PetscCall(PetscStrncpy(formulation, element->formulation ? element->formulation : "", sizeof(formulation)));
  PetscObjectOptionsBegin((PetscObject)element);
  PetscCall(PetscOptionsString("-element_formulation", "What elements do against locking", "ElementSetFormulation", formulation,
                               formulation, sizeof(formulation), &set));
  PetscCall(PetscOptionsBool("-axisymmetric", "Rings about x = 0", "ElementSetAxisymmetric", axisymmetric, &axisymmetric, NULL));
  PetscOptionsEnd();
  if (set) PetscCall(ElementSetFormulation(element, formulation));
  PetscCall(ElementSetAxisymmetric(element, axisymmetric));
  PetscTryTypeMethod(element, setfromoptions);
  PetscCall(CheckAxisymmetric(element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the elements their cells. `connectivity`: `count` times the nodes of one cell, numbers among the rank's, in VTK's order;
   `coordinates`: of the rank's nodes [m]; both kept by reference */
PetscErrorCode ElementSetUp(Element element, PetscInt count, const PetscInt connectivity[], const PetscReal coordinates[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscCheck(!element->setup, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE, "The elements have their cells already");
  PetscCheck(element->cell_type != DM_POLYTOPE_UNKNOWN && element->material, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE,
             "Call ElementSetCellType() and ElementSetMaterial() first");
  PetscCheck(!element->cross_section_dim || element->cross_section_dim == element->dim, PETSC_COMM_SELF, PETSC_ERR_ARG_INCOMP,
             "Elements in %" PetscInt_FMT " dimensions have no %s, which has been set to %g", element->dim,
             element->cross_section_dim == 1 ? "cross-section" : "thickness", (double)element->cross_section);
  PetscCheck(!element->plane_stress || element->dim == 2, PETSC_COMM_SELF, PETSC_ERR_ARG_INCOMP,
             "Elements in %" PetscInt_FMT " dimensions are not in plane stress", element->dim);
  PetscCall(CheckAxisymmetric(element));
  PetscCheck(!element->blocks || element->count == count, PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ,
             "Blocks have been given for %" PetscInt_FMT " elements, not for %" PetscInt_FMT, element->count, count);
  element->count        = count;
  element->connectivity = connectivity;
  if (element->blocks) PetscCall((*element->blocks_ops->setup)(element, coordinates));
  else {
    PetscCall(ElementApplyFormulation(element));
    PetscUseTypeMethod(element, setup, coordinates);
  }
  element->setup = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ElementDuplicateOn - elements of the same shape and with the same settings, on some ranks, with one material */
PetscErrorCode ElementDuplicateOn(Element element, MPI_Comm comm, Material material, Element *duplicate)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate(comm, duplicate));
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)*duplicate, ((PetscObject)element)->prefix));
  PetscCall(ElementSetCellType(*duplicate, element->cell_type));
  PetscCall(ElementSetMaterial(*duplicate, material));
  (*duplicate)->cross_section     = element->cross_section;
  (*duplicate)->cross_section_dim = element->cross_section_dim;
  (*duplicate)->plane_stress      = element->plane_stress;
  (*duplicate)->axisymmetric      = element->axisymmetric;
  if (element->composite) PetscCall(ElementSetComposite(*duplicate));
  PetscCall(ElementSetFormulation(*duplicate, element->formulation));
  PetscTryTypeMethod(element, copy, *duplicate);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prints the elements. `viewer`: an ASCII viewer, `NULL` for standard output. Collective */
PetscErrorCode ElementView(Element element, PetscViewer viewer)
{
  const char *unit;
  PetscBool   ascii;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)element), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectPrintClassNamePrefixType((PetscObject)element, viewer));
  unit = UnitsOf((PetscObject)element, element->dim == 1 ? UNIT_AREA : UNIT_LENGTH);
  if (element->dim == 1) PetscCall(PetscViewerASCIIPrintf(viewer, "  cross-section %g%s\n", (double)element->cross_section, unit));
  if (element->dim == 2)
    PetscCall(element->axisymmetric ? PetscViewerASCIIPrintf(viewer, "  rings about x = 0\n")
                                    : PetscViewerASCIIPrintf(viewer, "  thickness %g%s, %s\n", (double)element->cross_section, unit,
                                                             element->plane_stress ? "plane stress" : "plane strain"));
  if (element->formulation) PetscCall(PetscViewerASCIIPrintf(viewer, "  formulation %s\n", element->formulation));
  PetscTryTypeMethod(element, view, viewer);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Frees the elements. Collective */
PetscErrorCode ElementDestroy(Element *element)
{
  PetscFunctionBegin;
  if (!*element) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*element, ELEMENT_CLASSID, 1);
  if (--((PetscObject)*element)->refct > 0) {
    *element = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscTryTypeMethod(*element, destroy);
  if ((*element)->blocks) PetscCall((*(*element)->blocks_ops->destroy)(&(*element)->blocks));
  PetscCall(PetscFree((*element)->formulation));
  PetscCall(MaterialDestroy(&(*element)->material));
  PetscCall(PetscHeaderDestroy(element));
  PetscFunctionReturn(PETSC_SUCCESS);
}
