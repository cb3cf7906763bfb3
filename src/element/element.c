/* The class: creation, shape, material, options, set-up, view, destruction. */
#include <impakt/private/elementimpl.h>
#include <impakt/private/simd.h>
#include <sys/names.h>
#include <sys/units.h>

/*@
  ElementCreate - creates elements without a shape

  Collective

  Input Parameter:
. comm - communicator

  Output Parameter:
. element - the `Element`

  Level: developer

.seealso: `Element`, `ElementSetCellType()`, `ElementSetMaterial()`, `ElementSetFromOptions()`, `ElementSetUp()`
@*/
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

/*@
  ElementSetOptionsPrefix - sets the prefix of the elements' options

  Logically Collective

  Input Parameters:
+ element - the `Element`
- prefix  - the prefix, for example `left_`

  Level: developer

.seealso: `Element`, `ElementSetFromOptions()`
@*/
PetscErrorCode ElementSetOptionsPrefix(Element element, const char prefix[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)element, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char *Prefix(Element element)
{
  return ((PetscObject)element)->prefix ? ((PetscObject)element)->prefix : "";
}

/*@
  ElementSetCellType - chooses the element by the shape of the mesh cells

  Collective

  Input Parameters:
+ element   - the `Element`
- cell_type - shape of all cells

  Level: developer

.seealso: `Element`, `ElementRegister()`
@*/
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

/*@
  ElementSetMaterial - sets the material of all elements

  Logically Collective

  Input Parameters:
+ element  - the `Element`
- material - its `Material`, complete

  Level: developer

.seealso: `Element`, `Material`
@*/
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

/*@
  ElementSetFromOptions - reads what the elements of a shape take from the options

  Collective

  Input Parameter:
. element - the `Element`, after `ElementSetCellType()`

  Options Database Keys:
+ -<body>_cross_section A           - of bars [m^2], default 1
. -<body>_thickness h               - of plane elements [m], default 1
. -<body>_plane_stress (true|false) - of plane elements, default false
. -<body>_axisymmetric (true|false) - of plane elements, default false
- -<body>_element_formulation (full|mean_dilatation|enhanced|reduced|composite) - see `ElementSetFormulation()`

  Level: developer

.seealso: `Element`, `ElementSetCrossSection()`, `ElementSetThickness()`, `ElementSetPlaneStress()`
@*/
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

/*@
  ElementSetUp - gives the elements their cells

  Not Collective

  Input Parameters:
+ element      - the `Element`, with shape and material
. count        - number of cells of this rank
. connectivity - numbers of their nodes among the rank's, in the usual order (VTK's), `count` times the nodes of one cell; kept by
                 reference
- coordinates  - of the rank's nodes, as many for each as there are dimensions [m]; kept by reference

  Level: developer

.seealso: `Element`, `ElementSetCellType()`, `ElementSetMaterial()`
@*/
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
  if (element->blocks) PetscCall(ElementSetUpBlocks(element, coordinates));
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
  PetscCall(ElementSetOptionsPrefix(*duplicate, ((PetscObject)element)->prefix));
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

/*@
  ElementView - prints the elements

  Collective

  Input Parameters:
+ element - the `Element`
- viewer  - an ASCII viewer, `NULL` for standard output

  Level: developer

.seealso: `Element`, `ElementViewFromOptions()`
@*/
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

/*@
  ElementViewFromOptions - prints the elements where an option asks for it

  Collective

  Input Parameters:
+ element - the `Element`
. object  - has the prefix of the option, `NULL` for the element
- name    - the option

  Options Database Key:
. -<body>_element_view - print the elements of a body at its set-up

  Level: developer

.seealso: `Element`, `ElementView()`, `PetscObjectViewFromOptions()`
@*/
PetscErrorCode ElementViewFromOptions(Element element, PetscObject object, const char name[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscCall(PetscObjectViewFromOptions((PetscObject)element, object, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ElementCountWanted - the elements in batches that internalforce() does not leave out */
PetscInt ElementCountWanted(Element element)
{
  PetscInt wanted = element->count;

  for (PetscInt first = 0; first < element->count && element->skips; first += SIMD_WIDTH)
    if (element->skips[first / SIMD_WIDTH]) wanted -= PetscMin(SIMD_WIDTH, element->count - first);
  return wanted;
}

/*@
  ElementDestroy - frees the elements

  Collective

  Input Parameter:
. element - the `Element`, set to `NULL`

  Level: developer

.seealso: `Element`, `ElementCreate()`
@*/
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
  PetscCall(ElementBlocksDestroy(&(*element)->blocks));
  PetscCall(PetscFree((*element)->formulation));
  PetscCall(MaterialDestroy(&(*element)->material));
  PetscCall(PetscHeaderDestroy(element));
  PetscFunctionReturn(PETSC_SUCCESS);
}
