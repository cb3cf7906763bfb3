/* What programs set of elements beside their options. */
#include <impakt/private/elementimpl.h>

static PetscErrorCode SetCrossSection(Element element, PetscInt dim, PetscReal value)
{
  PetscFunctionBegin;
  PetscCheck(!element->setup, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE, "Call before ElementSetUp()");
  PetscCheck(value > 0, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_OUTOFRANGE, "%s %g must be positive",
             dim == 1 ? "A cross-section of" : "A thickness of", (double)value);
  element->cross_section     = value;
  element->cross_section_dim = dim;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ElementSetCrossSection - sets the cross-sectional area of bars

  Logically Collective

  Input Parameters:
+ element - the `Element`
- area    - [m^2], 1 by default

  Options Database Key:
. -<body>_cross_section A - the area

  Level: intermediate

.seealso: `Element`, `ElementSetThickness()`
@*/
PetscErrorCode ElementSetCrossSection(Element element, PetscReal area)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(element, area, 2);
  PetscCall(SetCrossSection(element, 1, area));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ElementSetThickness - sets the thickness of plane elements

  Logically Collective

  Input Parameters:
+ element   - the `Element`
- thickness - [m], 1 by default

  Options Database Key:
. -<body>_thickness h - the thickness

  Level: intermediate

.seealso: `Element`, `ElementSetCrossSection()`, `ElementSetPlaneStress()`
@*/
PetscErrorCode ElementSetThickness(Element element, PetscReal thickness)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(element, thickness, 2);
  PetscCall(SetCrossSection(element, 2, thickness));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ElementSetPlaneStress - whether plane elements are free of stress across their plane, or of strain

  Logically Collective

  Input Parameters:
+ element      - the `Element`
- plane_stress - `PETSC_TRUE` for plane stress, `PETSC_FALSE` (default) for plane strain

  Options Database Key:
. -<body>_plane_stress (true|false) - plane stress

  Level: intermediate

.seealso: `Element`, `ElementSetThickness()`, `MaterialSetPlaneStress()`
@*/
PetscErrorCode ElementSetPlaneStress(Element element, PetscBool plane_stress)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(element, plane_stress, 2);
  PetscCheck(!element->setup, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE, "Call before ElementSetUp()");
  element->plane_stress = plane_stress;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ElementSetAxisymmetric - whether plane elements are rings about the axis x = 0

  Logically Collective

  Input Parameters:
+ element      - the `Element`
- axisymmetric - `PETSC_TRUE` for rings: x is the distance from the axis, y goes along it; `PETSC_FALSE` by default

  Options Database Key:
. -<body>_axisymmetric (true|false) - rings

  Level: intermediate

  Notes:
  Forces, masses and energies are those of whole rings. Triangles have the formulation `ELEMENT_FULL`, quadrilaterals
`ELEMENT_MEAN_DILATATION` too. Rings have no thickness, and are not in plane stress.

  A single triangle has a motion without strain at its centroid that is not rigid; two that have an edge in common do not.

.seealso: `Element`, `BodySetAxisymmetric()`, `ElementGetAxisymmetric()`, `ElementSetFormulation()`
@*/
PetscErrorCode ElementSetAxisymmetric(Element element, PetscBool axisymmetric)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(element, axisymmetric, 2);
  PetscCheck(!element->setup, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE, "Call before ElementSetUp()");
  element->axisymmetric = axisymmetric;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ElementGetAxisymmetric - whether plane elements are rings about the axis x = 0

  Not Collective

  Input Parameter:
. element - the `Element`

  Output Parameter:
. axisymmetric - `PETSC_TRUE` if so

  Level: intermediate

.seealso: `Element`, `ElementSetAxisymmetric()`
@*/
PetscErrorCode ElementGetAxisymmetric(Element element, PetscBool *axisymmetric)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscAssertPointer(axisymmetric, 2);
  *axisymmetric = element->axisymmetric;
  PetscFunctionReturn(PETSC_SUCCESS);
}
