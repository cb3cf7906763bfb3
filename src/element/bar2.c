/* Two-node bar along a line: linear displacement, uniaxial stress. */
#include <impakt/private/elementimpl.h>
#include <impakt/private/materialimpl.h>
#include <impakt/private/simd.h>

typedef struct {
  PetscBool        linear;
  PetscBool        follow;         /* each element begins at the node at which the one before it ends, the next by number */
  PetscReal        modulus;        /* of uniaxial stress at zero strain [Pa] */
  const PetscReal *coordinates;    /* of the rank's nodes; owned by the body */
  PetscReal       *inverse_length; /* of the coordinate of the second node less that of the first, so it may be negative [1/m] */
  PetscReal       *pull_area;      /* cross-section, with the sign of the length: an element may run against the axis [m^2] */
  PetscReal       *strain, *stress;
} Bar2;

/* Shape functions at the two Gauss points, (1 +- 1 / sqrt 3) / 2 */
static const PetscReal shape[4] = {0.78867513459481288225, 0.21132486540518711775, 0.21132486540518711775, 0.78867513459481288225};

static PetscErrorCode ElementSetUp_Bar2(Element element, const PetscReal coordinates[])
{
  Bar2 *bar = (Bar2 *)element->data;

  PetscFunctionBegin;
  bar->coordinates = coordinates;
  PetscCheck(element->material->ops->uniaxial, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "Bars take no material of type %s, which has no uniaxial form: mesh the bar with solid elements, quad4 or hex8",
             ((PetscObject)element->material)->type_name);
  element->flops = 6; /* strain 2, stress 1 where it is linear, force 3 */
  PetscCall(MaterialIsLinear(element->material, &bar->linear));
  PetscCall(MaterialGetUniaxialModulus(element->material, &bar->modulus));
  bar->follow = (PetscBool)(element->count > 0);
  PetscCall(PetscMalloc4(element->count, &bar->inverse_length, element->count, &bar->pull_area, element->count, &bar->strain,
                         element->count, &bar->stress));
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscInt *node   = element->connectivity + 2 * e;
    const PetscReal length = coordinates[node[1]] - coordinates[node[0]];

    bar->inverse_length[e] = 1 / length;
    bar->follow            = (PetscBool)(bar->follow && node[0] == element->connectivity[0] + e && node[1] == node[0] + 1);
    bar->pull_area[e]      = length > 0 ? element->cross_section : -element->cross_section;
    PetscCheck(length != 0, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "A bar element at x = %g has no length", (double)coordinates[node[0]]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal GetStrain(const Bar2 *bar, const PetscInt nodes[], PetscInt e, const PetscScalar u[])
{
  return (u[nodes[2 * e + 1]] - u[nodes[2 * e]]) * bar->inverse_length[e];
}

static PetscErrorCode ComputeStress(Element element, const PetscScalar u[])
{
  const Bar2 *bar = (const Bar2 *)element->data;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < element->count; e++) bar->strain[e] = GetStrain(bar, element->connectivity, e, u);
  PetscCall(MaterialComputeUniaxial(element->material, element->count, bar->strain, bar->stress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes the first element that is turned over, which means nothing to linear materials, or whose stress is not a number */
static void NoteInverted(Element element, const PetscReal strain[], const PetscReal stress[])
{
  const PetscBool linear = ((const Bar2 *)element->data)->linear;
  PetscInt        bad    = 0;

  element->inverted = -1;
  for (PetscInt e = 0; e < element->count; e++) bad |= isnan(stress[e]) || (!linear && !(1 + strain[e] > 0));
  for (PetscInt e = 0; bad && element->inverted < 0; e++)
    if (isnan(stress[e]) || (!linear && !(1 + strain[e] > 0))) element->inverted = e;
}

/* f += what linear elements that follow each other pull with, with the bits of the general way; true where a pull is not a number */
SIMD_CLONES static PetscBool AddLinearPulls(PetscInt n, const Bar2 *bar, const PetscScalar u[], PetscReal pull[], PetscScalar f[])
{
  const PetscReal *inverse_length = bar->inverse_length, *area = bar->pull_area, modulus = bar->modulus;
  int              bad = 0;

  for (PetscInt e = 0; e < n; e++) pull[e] = area[e] * (modulus * ((u[e + 1] - u[e]) * inverse_length[e]));
  for (PetscInt e = 0; e < n; e++) bad |= pull[e] != pull[e]; /* NOLINT(misc-redundant-expression): the test that vectorises */
  f[0] -= pull[0];
#pragma omp simd
  for (PetscInt e = 1; e < n; e++) f[e] += pull[e - 1] - pull[e];
  f[n] += pull[n - 1];
  return (PetscBool)bad;
}

static PetscErrorCode ElementInternalForce_Bar2(Element element, const PetscScalar u[], PetscScalar f[])
{
  const Bar2     *bar   = (const Bar2 *)element->data;
  const PetscInt *nodes = element->connectivity;

  PetscFunctionBegin;
  if (bar->linear && bar->follow) {
    element->inverted = -1;
    if (AddLinearPulls(element->count, bar, u + nodes[0], bar->stress, f + nodes[0])) NoteInverted(element, bar->strain, bar->stress);
  } else {
    PetscCall(ComputeStress(element, u));
    for (PetscInt e = 0; e < element->count; e++) {
      const PetscReal pull = bar->pull_area[e] * bar->stress[e];

      f[nodes[2 * e]] -= pull;
      f[nodes[2 * e + 1]] += pull;
    }
    NoteInverted(element, bar->strain, bar->stress);
  }
  PetscCall(PetscLogFlops(element->flops * (PetscLogDouble)element->count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementEnergy_Bar2(Element element, const PetscScalar u[], PetscReal *energy)
{
  Bar2      *bar    = (Bar2 *)element->data;
  PetscReal *strain = bar->strain, *density = bar->stress;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < element->count; e++) strain[e] = GetStrain(bar, element->connectivity, e, u);
  PetscCall(MaterialComputeUniaxialEnergy(element->material, element->count, strain, density));
  *energy = 0;
  for (PetscInt e = 0; e < element->count; e++) *energy += element->cross_section / PetscAbsReal(bar->inverse_length[e]) * density[e];
  NoteInverted(element, strain, density);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementTangent_Bar2(Element element, PetscInt e, PetscBool viscous, const PetscScalar u[], PetscScalar K[])
{
  const Bar2     *bar    = (const Bar2 *)element->data;
  const PetscReal strain = GetStrain(bar, element->connectivity, e, u);
  PetscReal       modulus, k;

  PetscFunctionBegin;
  PetscCall(MaterialComputeUniaxialTangent(element->material, 1, &strain, &modulus));
  k    = modulus * element->cross_section * PetscAbsReal(bar->inverse_length[e]) * (viscous ? PetscSqr(1 + strain) : 1);
  K[0] = K[3] = k;
  K[1] = K[2] = -k;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* (1 + e)^2 E de/dt, with the elongation e: Green and Lagrange's strain grows by (1 + e) de/dt, and the force is that stress times 1 + e */
static PetscErrorCode ElementViscousForce_Bar2(Element element, const PetscScalar u[], const PetscScalar v[], PetscScalar f[])
{
  Bar2           *bar   = (Bar2 *)element->data;
  const PetscInt *nodes = element->connectivity;

  PetscFunctionBegin;
  PetscCall(ComputeStress(element, v));
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscReal pull = PetscSqr(1 + GetStrain(bar, nodes, e, u)) * bar->pull_area[e] * bar->stress[e];

    f[nodes[2 * e]] -= pull;
    f[nodes[2 * e + 1]] += pull;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Force over the cross-section, as it is then; of linear materials as it was */
static PetscErrorCode ElementStress_Bar2(Element element, const PetscScalar u[], PetscReal stress[])
{
  Bar2           *bar = (Bar2 *)element->data;
  MaterialKernels kernels;
  SimdReal        H[9], P[9];
  PetscReal       tangent[81];

  PetscFunctionBegin;
  PetscCall(ComputeStress(element, u));
  if (!bar->linear) {
    PetscCall(MaterialGetKernels(element->material, &kernels));
    for (PetscInt e = 0; e < element->count; e++)
      bar->stress[e] /= PetscSqr(1 + MaterialFindSides(&kernels, bar->strain[e], H, P, tangent));
  }
  for (PetscInt e = 0; e < element->count; e++)
    for (PetscInt k = 0; k < 6; k++) stress[6 * e + k] = k == 0 ? bar->stress[e] : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementPoints_Bar2(Element element, PetscInt e, PetscReal positions[], PetscReal weights[])
{
  const Bar2     *bar   = (const Bar2 *)element->data;
  const PetscInt *nodes = element->connectivity + 2 * e;

  PetscFunctionBegin;
  for (PetscInt g = 0; g < 2; g++) {
    positions[g] = shape[2 * g] * bar->coordinates[nodes[0]] + shape[2 * g + 1] * bar->coordinates[nodes[1]];
    weights[g]   = 0.5 * element->cross_section / PetscAbsReal(bar->inverse_length[e]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementNearest_Bar2(Element element, PetscInt e, const PetscReal x[], PetscReal N[], PetscReal *distance)
{
  const Bar2     *bar   = (const Bar2 *)element->data;
  const PetscReal start = bar->coordinates[element->connectivity[2 * e]], part = (x[0] - start) * bar->inverse_length[e];

  PetscFunctionBegin;
  N[1]      = PetscMin(1, PetscMax(0, part));
  N[0]      = 1 - N[1];
  *distance = PetscAbsReal((part - N[1]) / bar->inverse_length[e]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementMass_Bar2(Element element, PetscInt e, PetscScalar M[])
{
  const Bar2 *bar = (const Bar2 *)element->data;
  PetscReal   density, mass;

  PetscFunctionBegin;
  PetscCall(MaterialGetDensity(element->material, &density));
  mass = density * element->cross_section / PetscAbsReal(bar->inverse_length[e]);
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
  element->data                = bar;
  element->dim                 = 1;
  element->nodes               = 2;
  element->n_points            = 2;
  element->shape               = shape;
  element->ops->setfromoptions = ElementReadSection;
  element->ops->setup          = ElementSetUp_Bar2;
  element->ops->internalforce  = ElementInternalForce_Bar2;
  element->ops->energy         = ElementEnergy_Bar2;
  element->ops->stress         = ElementStress_Bar2;
  element->ops->points         = ElementPoints_Bar2;
  element->ops->tangent        = ElementTangent_Bar2;
  element->ops->nearest        = ElementNearest_Bar2;
  element->ops->viscousforce   = ElementViscousForce_Bar2;
  element->ops->mass           = ElementMass_Bar2;
  element->ops->destroy        = ElementDestroy_Bar2;
  PetscFunctionReturn(PETSC_SUCCESS);
}
