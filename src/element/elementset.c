/* What programs set of elements beside their options. */
#include <impakt/private/elementimpl.h>
#include <sys/units.h>

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

/* Reads -cross_section of bars, or -thickness of plane elements */
PetscErrorCode ElementReadSection(Element element)
{
  const PetscBool bar    = (PetscBool)(element->dim == 1);
  const char     *option = bar ? "-cross_section" : "-thickness", *unit = UnitsOf((PetscObject)element, bar ? UNIT_AREA : UNIT_LENGTH);
  PetscReal       value = element->cross_section;
  PetscBool       set;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)element);
  PetscCall(PetscOptionsReal(option, bar ? "Cross-sectional area [m^2]" : "Thickness of a plane body [m]", "ElementReadSection", value,
                             &value, &set));
  PetscOptionsEnd();
  PetscCheck(value >= SECTION_SMALLEST && value <= SECTION_LARGEST, PetscObjectComm((PetscObject)element), PETSC_ERR_USER_INPUT,
             "-%s%s is %g%s; it must be positive, between %g and %g%s",
             ((PetscObject)element)->prefix ? ((PetscObject)element)->prefix : "", option + 1, (double)value, unit, SECTION_SMALLEST,
             SECTION_LARGEST, unit);
  if (set) PetscCall(SetCrossSection(element, element->dim, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the cross-sectional area of bars. `area`: [m^2], 1 by default */
PetscErrorCode ElementSetCrossSection(Element element, PetscReal area)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(element, area, 2);
  PetscCall(SetCrossSection(element, 1, area));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the thickness of plane elements. `thickness`: [m], 1 by default */
PetscErrorCode ElementSetThickness(Element element, PetscReal thickness)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(element, thickness, 2);
  PetscCall(SetCrossSection(element, 2, thickness));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether plane elements are free of stress across their plane (`plane_stress`), or of strain (default) */
PetscErrorCode ElementSetPlaneStress(Element element, PetscBool plane_stress)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(element, plane_stress, 2);
  PetscCheck(!element->setup, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE, "Call before ElementSetUp()");
  element->plane_stress = plane_stress;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether plane elements are rings about the axis x = 0: x is the distance from it, y goes along it; forces, masses and energies are those
   of whole rings. Rings have no thickness, and are not in plane stress. */
PetscErrorCode ElementSetAxisymmetric(Element element, PetscBool axisymmetric)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(element, axisymmetric, 2);
  PetscCheck(!element->setup, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE, "Call before ElementSetUp()");
  element->axisymmetric = axisymmetric;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether plane elements are rings about the axis x = 0 */
PetscErrorCode ElementGetAxisymmetric(Element element, PetscBool *axisymmetric)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscAssertPointer(axisymmetric, 2);
  *axisymmetric = element->axisymmetric;
  PetscFunctionReturn(PETSC_SUCCESS);
}
