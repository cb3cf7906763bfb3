/* Two-node bar along a line: linear displacement, uniaxial stress. */
#include "element.h"

typedef struct {
  PetscReal  cross_section;  /* m^2 */
  PetscReal *inverse_length; /* of the coordinate of the second node less that of the first, so it may be negative [1/m] */
  PetscReal *pull_area;      /* cross-section, with the sign of the length: an element may run against the axis [m^2] */
  PetscReal *strain, *stress;
} Bar2;

static PetscErrorCode ElementSetFromOptions_Bar2(Element element, MPI_Comm comm, const char prefix[])
{
  Bar2 *bar = (Bar2 *)element->data;

  PetscFunctionBegin;
  PetscOptionsBegin(comm, prefix, "Bar element", "Element");
  PetscCall(PetscOptionsReal("-cross_section", "Cross-sectional area [m^2]", "", bar->cross_section, &bar->cross_section, NULL));
  PetscOptionsEnd();
  PetscCheck(bar->cross_section > 0, comm, PETSC_ERR_USER_INPUT, "-%scross_section is %g m^2; it must be positive", prefix, (double)bar->cross_section);
  element->cross_section = bar->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementSetUp_Bar2(Element element, const PetscReal coordinates[])
{
  Bar2 *bar = (Bar2 *)element->data;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(element->count, &bar->inverse_length, element->count, &bar->pull_area, element->count, &bar->strain, element->count, &bar->stress));
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscInt *node   = element->connectivity + 2 * e;
    const PetscReal length = coordinates[node[1]] - coordinates[node[0]];

    bar->inverse_length[e] = 1 / length;
    bar->pull_area[e]      = length > 0 ? bar->cross_section : -bar->cross_section;
    PetscCheck(length != 0, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "A bar element at x = %g has no length", (double)coordinates[node[0]]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementInternalForce_Bar2(Element element, const PetscScalar u[], PetscScalar f[])
{
  Bar2           *bar    = (Bar2 *)element->data;
  const PetscInt *nodes  = element->connectivity;
  const PetscInt  count  = element->count;
  PetscReal      *strain = bar->strain, *stress = bar->stress;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < count; e++) strain[e] = (u[nodes[2 * e + 1]] - u[nodes[2 * e]]) * bar->inverse_length[e];
  PetscCall(MaterialComputeUniaxial(element->material, count, strain, stress));
  for (PetscInt e = 0; e < count; e++) {
    const PetscReal pull = bar->pull_area[e] * stress[e];

    f[nodes[2 * e]] -= pull;
    f[nodes[2 * e + 1]] += pull;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementStiffness_Bar2(Element element, PetscInt e, const PetscScalar u[], PetscScalar K[])
{
  const Bar2 *bar = (const Bar2 *)element->data;
  PetscReal   modulus, k;

  PetscFunctionBegin;
  (void)u; /* the strain does not matter while all materials are linear at zero strain */
  PetscCall(MaterialGetUniaxialModulus(element->material, &modulus));
  k    = modulus * bar->cross_section * PetscAbsReal(bar->inverse_length[e]);
  K[0] = K[3] = k;
  K[1] = K[2] = -k;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementMass_Bar2(Element element, PetscInt e, PetscScalar M[])
{
  const Bar2 *bar = (const Bar2 *)element->data;
  PetscReal   density, mass;

  PetscFunctionBegin;
  PetscCall(MaterialGetDensity(element->material, &density));
  mass = density * bar->cross_section / PetscAbsReal(bar->inverse_length[e]);
  M[0] = M[3] = mass / 3;
  M[1] = M[2] = mass / 6;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementDestroy_Bar2(Element element)
{
  Bar2 *bar = (Bar2 *)element->data;

  PetscFunctionBegin;
  PetscCall(PetscFree4(bar->inverse_length, bar->pull_area, bar->strain, bar->stress));
  PetscCall(PetscFree(element->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementCreate_Bar2(Element element)
{
  Bar2 *bar;

  PetscFunctionBegin;
  PetscCall(PetscNew(&bar));
  bar->cross_section          = 1;
  element->data               = bar;
  element->dim                = 1;
  element->nodes              = 2;
  element->ops.setfromoptions = ElementSetFromOptions_Bar2;
  element->ops.setup          = ElementSetUp_Bar2;
  element->ops.internalforce  = ElementInternalForce_Bar2;
  element->ops.stiffness      = ElementStiffness_Bar2;
  element->ops.mass           = ElementMass_Bar2;
  element->ops.destroy        = ElementDestroy_Bar2;
  PetscFunctionReturn(PETSC_SUCCESS);
}
