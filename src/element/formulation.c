/* Formulations: what the elements of one shape do with their displacements. Chosen by name, from a registry. */
#include <impakt/private/elementimpl.h>
#include <impakt/private/materialimpl.h>
#include <sys/names.h>

/* Above this ratio of Poisson, elements that can have a mean dilatation do so, unless another formulation is asked for */
#define LOCKING_RATIO 0.4
/* Above this one, an element that was asked to be fully integrated is worth a warning */
#define STRONG_RATIO 0.45

static const char *Prefix(Element element)
{
  return ((PetscObject)element)->prefix ? ((PetscObject)element)->prefix : "";
}

/* Formulation against locking, before set-up: a name of README.md or ElementRegisterFormulation(); NULL: the default */
PetscErrorCode ElementSetFormulation(Element element, const char formulation[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscCheck(!element->setup, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE, "Call before ElementSetUp()");
  PetscCall(PetscFree(element->formulation));
  PetscCall(PetscStrallocpy(formulation, &element->formulation));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The formulation of the elements. `formulation`: its name; `NULL` before the set-up, unless one has been set */
PetscErrorCode ElementGetFormulation(Element element, const char *formulation[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscAssertPointer(formulation, 2);
  *formulation = element->formulation;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ElementSetComposite - makes triangles and tetrahedra elements of six and ten nodes, before ElementSetUp() */
PetscErrorCode ElementSetComposite(Element element)
{
  PetscFunctionBegin;
  PetscCheck(element->cell_type == DM_POLYTOPE_TRIANGLE || element->cell_type == DM_POLYTOPE_TETRAHEDRON,
             PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_INCOMP,
             "-%selement_formulation composite: elements of shape '%s' have none", Prefix(element), DMPolytopeTypes[element->cell_type]);
  PetscCheck(!element->axisymmetric, PetscObjectComm((PetscObject)element), PETSC_ERR_SUP,
             "-%saxisymmetric true: rings of six-node triangles are not supported; use quadrilaterals, or -%selement_formulation full",
             Prefix(element), Prefix(element));
  element->composite = PETSC_TRUE;
  element->nodes     = element->dim == 2 ? 6 : 10;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of the registry's names those of one shape, and the one that all shapes have */
static PetscErrorCode GetNames(DMPolytopeType cell_type, PetscBool axisymmetric, size_t size, char names[])
{
  const char **known;
  char         shape[64];
  int          n;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(names, ELEMENT_FULL, size));
  PetscCall(ElementFormulationKey(cell_type, axisymmetric, "", sizeof(shape), shape));
  PetscCall(PetscFunctionListGet(ElementFormulationList, &known, &n));
  for (int i = 0; i < n; i++) {
    const size_t length = strlen(shape);
    PetscBool    same, full;

    PetscCall(PetscStrncmp(known[i], shape, length, &same));
    if (!same) continue;
    PetscCall(PetscStrcmp(known[i] + length, ELEMENT_FULL, &full));
    if (!full) PetscCall(NamesAppend(names, size, ", ", known[i] + length));
  }
  PetscCall(PetscFree(known));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GetPoissonsRatio(Element element, PetscReal *ratio)
{
  PetscFunctionBegin;
  *ratio = 0;
  if (element->material->isotropic) PetscCall(MaterialGetPoissonsRatio(element->material, ratio));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode HasHistory(Element element, PetscBool *has)
{
  MaterialKernels kernels;

  PetscFunctionBegin;
  *has = PETSC_FALSE;
  PetscCall(MaterialGetKernels(element->material, &kernels));
  *has = (PetscBool)(kernels.n_history > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ChooseFormulation(Element element)
{
  PetscErrorCode (*create)(Element);
  PetscReal ratio;
  PetscBool flows;
  char      key[128];

  PetscFunctionBegin;
  if (element->composite) {
    PetscCall(PetscStrallocpy(ELEMENT_COMPOSITE, &element->formulation));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(GetPoissonsRatio(element, &ratio));
  PetscCall(HasHistory(element, &flows));
  PetscCall(ElementFormulationKey(element->cell_type, element->axisymmetric, ELEMENT_MEAN_DILATATION, sizeof(key), key));
  PetscCall(PetscFunctionListFind(ElementFormulationList, key, &create));
  PetscCall(PetscStrallocpy(create && (ratio > LOCKING_RATIO || flows) && !element->plane_stress ? ELEMENT_MEAN_DILATATION : ELEMENT_FULL,
                            &element->formulation));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the element one of its formulation, the default where none has been chosen; at its set-up */
PetscErrorCode ElementApplyFormulation(Element element)
{
  PetscErrorCode (*create)(Element);
  PetscBool full, mean, composite, flows, enhanced, rubber;
  char      key[128];

  PetscFunctionBegin;
  if (!element->formulation) PetscCall(ChooseFormulation(element));
  PetscCall(PetscStrcmp(element->formulation, ELEMENT_FULL, &full));
  if (full && !element->axisymmetric) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ElementFormulationKey(element->cell_type, element->axisymmetric, element->formulation, sizeof(key), key));
  PetscCall(PetscFunctionListFind(ElementFormulationList, key, &create));
  if (!create) {
    char names[1024];

    PetscCall(GetNames(element->cell_type, element->axisymmetric, sizeof(names), names));
    SETERRQ(PetscObjectComm((PetscObject)element), PETSC_ERR_USER_INPUT,
            "-%selement_formulation %s: %selements of shape '%s' do not have it; they have %s", Prefix(element), element->formulation,
            element->axisymmetric ? "axisymmetric " : "", DMPolytopeTypes[element->cell_type], names);
  }
  PetscCall(PetscStrcmp(element->formulation, ELEMENT_MEAN_DILATATION, &mean));
  PetscCall(PetscStrcmp(element->formulation, ELEMENT_COMPOSITE, &composite));
  PetscCheck(composite == element->composite, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_INCOMP,
             "-%selement_formulation %s: the elements have %" PetscInt_FMT " nodes%s", Prefix(element), element->formulation,
             element->nodes, composite ? "; make the mesh by MeshCreate() or MeshCreateComposite()" : "");
  PetscCall(HasHistory(element, &flows));
  PetscCall(PetscStrcmp(element->formulation, ELEMENT_ENHANCED, &enhanced));
  PetscCheck(full || mean || composite || enhanced || !flows, PetscObjectComm((PetscObject)element), PETSC_ERR_SUP,
             "-%selement_formulation %s: it keeps no history of plastic flow; use enhanced, mean_dilatation or full", Prefix(element),
             element->formulation);
  PetscCall(PetscObjectTypeCompare((PetscObject)element->material, MATERIAL_MOONEY_RIVLIN, &rubber));
  PetscCheck(!enhanced || !rubber, PetscObjectComm((PetscObject)element), PETSC_ERR_SUP,
             "-%selement_formulation enhanced with mooney_rivlin has other states of equilibrium beside the one that is looked for, shaped "
             "like hourglasses, from stretches of some 15 %% on; use mean_dilatation",
             Prefix(element));
  PetscCall((*create)(element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A warning where the elements will be too stiff for their material; on the first rank of their communicator. Collective. */
PetscErrorCode ElementWarnOfLocking(Element element)
{
  PetscErrorCode (*create)(Element);
  PetscReal ratio;
  PetscBool full, flows;
  char      key[128], material[64];

  PetscFunctionBegin;
  if (element->blocks) {
    PetscCall((*element->blocks_ops->warnoflocking)(element));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscStrcmp(element->formulation, ELEMENT_FULL, &full));
  PetscCall(GetPoissonsRatio(element, &ratio));
  PetscCall(HasHistory(element, &flows));
  if (!full || element->dim == 1 || element->plane_stress || (ratio <= LOCKING_RATIO && !flows)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ElementFormulationKey(element->cell_type, element->axisymmetric, ELEMENT_MEAN_DILATATION, sizeof(key), key));
  PetscCall(PetscFunctionListFind(ElementFormulationList, key, &create));
  if (create && ratio <= STRONG_RATIO && !flows) PetscFunctionReturn(PETSC_SUCCESS);
  if (flows) PetscCall(PetscStrncpy(material, "a material that flows", sizeof(material)));
  else PetscCall(PetscSNPrintf(material, sizeof(material), "a Poisson's ratio of %g", (double)ratio));
  if (create)
    PetscCall(
        PetscFPrintf(PetscObjectComm((PetscObject)element), stderr,
                     "impakt: warning: -%selement_formulation full with %s: fully integrated elements lock, and are several times too "
                     "stiff; use mean_dilatation\n",
                     Prefix(element), material));
  else
    PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)element), stderr,
                           "impakt: warning: body '%s' with %s: elements of shape '%s' lock where materials flow or Poisson's ratio "
                           "is larger than %g, and are too stiff; use a mesh of quadrilaterals or hexahedra%s%s%s\n",
                           ((PetscObject)element)->name ? ((PetscObject)element)->name : "", material, DMPolytopeTypes[element->cell_type],
                           LOCKING_RATIO, element->axisymmetric ? "" : ", or -", element->axisymmetric ? "" : Prefix(element),
                           element->axisymmetric
                               ? ""
                               : "element_formulation composite, which files of 6-node triangles and 10-node tetrahedra have by default"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A warning, on all ranks, where a body that flows has one element through its thickness. Bars do not bend; locking has its own. */
PetscErrorCode ElementWarnOfOneLayer(Element element)
{
  PetscErrorCode (*create)(Element) = NULL;
  const char *const formulation     = element->formulation;
  PetscBool         full, enhanced;
  char              key[128], other[256] = "";

  PetscFunctionBegin;
  PetscCall(PetscStrcmp(formulation, ELEMENT_FULL, &full));
  if (!element->history.n || element->dim == 1 || full) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrcmp(formulation, ELEMENT_ENHANCED, &enhanced));
  PetscCall(ElementFormulationKey(element->cell_type, element->axisymmetric, ELEMENT_ENHANCED, sizeof(key), key));
  PetscCall(PetscFunctionListFind(ElementFormulationList, key, &create));
  if (create && !enhanced) PetscCall(PetscSNPrintf(other, sizeof(other), ", or -%selement_formulation enhanced", Prefix(element)));
  PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)element), stderr,
                         "impakt: warning: body '%s' has one element through its thickness, of a material that flows: where it bends, %s; "
                         "use two elements%s\n",
                         ((PetscObject)element)->name ? ((PetscObject)element)->name : "",
                         enhanced ? "the two points of each through the thickness bear 15 % too much moment"
                                  : "moments are off by 30 % and more, to either side",
                         other));
  PetscFunctionReturn(PETSC_SUCCESS);
}
