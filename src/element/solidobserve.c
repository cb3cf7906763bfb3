/* What is observed of all solid elements, whatever their formulation: energy, stress, plastic flow. */
#include <impakt/private/materialimpl.h>
#include <impakt/private/solid.h>

/* With the plastic work of materials with history, and the first element without an energy */
PetscErrorCode ElementEnergy_Solid(Element element, const PetscScalar u[], PetscReal *energy)
{
  const Solid    *solid                  = (const Solid *)element->data;
  const PetscReal scale                  = solid->scale * element->cross_section;
  SimdReal        H[SOLID_MAX_POINTS][9] = {{{0}}}, weights[SOLID_MAX_POINTS];

  PetscFunctionBegin;
  *energy               = 0;
  element->plastic_work = 0;
  element->inverted     = -1;
  for (PetscInt first = 0; first < element->count; first += SIMD_WIDTH) {
    SimdReal W, work, stored = {0}, flowed = {0};

    PetscCall((*solid->observe)(element, first, u, H, weights));
    for (PetscInt g = 0; g < solid->shape->n_points; g++) {
      SolidEnergy(solid, first, g, (const SimdReal *)H[g], W, work);
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) stored[p] += weights[g][p] * W[p];
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) flowed[p] += weights[g][p] * work[p];
    }
    for (PetscInt p = 0; p < PetscMin(SIMD_WIDTH, element->count - first); p++) {
      *energy += stored[p];
      element->plastic_work += flowed[p];
      if (element->inverted < 0 && isnan(stored[p])) element->inverted = first + p;
    }
  }
  *energy *= scale;
  element->plastic_work *= scale;
  if (element->ops->hourglass) {
    PetscReal more;

    PetscUseTypeMethod(element, hourglass, u, &more);
    *energy += more;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementStress_Solid(Element element, const PetscScalar u[], PetscReal stress[])
{
  const Solid *solid                  = (const Solid *)element->data;
  SimdReal     H[SOLID_MAX_POINTS][9] = {{{0}}}, weights[SOLID_MAX_POINTS];

  PetscFunctionBegin;
  for (PetscInt first = 0; first < element->count; first += SIMD_WIDTH) {
    SimdReal P[9], sum[6] = {{0}}, volume = {0};

    PetscCall((*solid->observe)(element, first, u, H, weights));
    for (PetscInt g = 0; g < solid->shape->n_points; g++) {
      SolidStress(solid, first, g, (const SimdReal *)H[g], P);
      if (solid->plane_stress && !solid->linear) MaterialFindThickness(&solid->unconstrained, H[g]);
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
        PetscReal sigma[6];

        SolidCauchy(H[g], P, solid->linear, p, sigma);
        for (PetscInt k = 0; k < 6; k++) sum[k][p] += weights[g][p] * sigma[k];
        volume[p] += weights[g][p];
      }
    }
    for (PetscInt p = 0; p < PetscMin(SIMD_WIDTH, element->count - first); p++)
      for (PetscInt k = 0; k < 6; k++) stress[6 * (first + p) + k] = sum[k][p] / volume[p];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementPlastic_Solid(Element element, PetscReal *work, PetscReal strain[])
{
  const Solid          *solid   = (const Solid *)element->data;
  const ElementHistory *history = solid->history;

  PetscFunctionBegin;
  *work = 0;
  for (PetscInt e = 0; e < element->count; e++) {
    PetscReal sum = 0, volume = 0, gradient[SOLID_MAX_NODES * 3], hoop[SOLID_MAX_NODES];

    for (PetscInt g = 0; g < history->points; g++) {
      const PetscReal *point  = history->start + SolidHistoryOffset(history, e, g) + e % SIMD_WIDTH;
      const PetscReal  weight = (*solid->point)(element, e, g, gradient, hoop);

      *work += weight * point[SIMD_WIDTH * SolidPlasticWork(solid)];
      sum += weight * point[SIMD_WIDTH * solid->kernels.plastic_strain];
      volume += weight;
    }
    if (strain) strain[e] = sum / volume;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
