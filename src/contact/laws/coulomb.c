/* Coulomb's law: the force across the normal is at most the normal force times a coefficient, which may fall with the sliding speed. */
#include "rowlaw.h"
#include <petscmath.h>

enum { STATIC, KINETIC, DECAY };

static const char *Check(const PetscReal mu[])
{
  if ((mu[KINETIC] < 0) != (mu[DECAY] < 0))
    return "-contact_friction_kinetic and -contact_friction_decay go together: the coefficient is mu_k + (mu_s - mu_k) exp(-d |v|)";
  if (mu[KINETIC] > mu[STATIC]) return "-contact_friction_kinetic is above the coefficient with which nodes stick";
  return NULL;
}

static void Bound(const PetscReal mu[], PetscReal speed, PetscReal limit[2])
{
  limit[0] = 0;
  limit[1] = mu[KINETIC] < 0 ? mu[STATIC] : mu[KINETIC] + (mu[STATIC] - mu[KINETIC]) * PetscExpReal(-mu[DECAY] * speed);
}

const RowLaw RowLawCoulomb = {
    .name         = "coulomb",
    .n_parameters = 3,
    .parameters   = {[STATIC]  = {.name = "friction", .what = "coefficient of friction", .unit = UNIT_ONE, .may_be_zero = PETSC_TRUE},
                     [KINETIC] = {.name        = "friction_kinetic",
                                  .what        = "coefficient of fast sliding",
                                  .unit        = UNIT_ONE,
                                  .may_be_zero = PETSC_TRUE,
                                  .optional    = PETSC_TRUE},
                     [DECAY]   = {.name     = "friction_decay",
                                  .what     = "decay to that with the speed of sliding",
                                  .unit     = UNIT_SLOWNESS,
                                  .optional = PETSC_TRUE}},
    .check        = Check,
    .bound        = Bound};

/* By how much the forces on the n rows of a node, that along its normal first, miss the law where these open by `opened` [m]: de Saxce's
   residual. With the slip s, v = (g + mu |s|, s) and the compliance c of the normal row that is c |f - P(f - v/c)|, P being the projection
   onto the cone of forces that the law admits without cohesion. */
PetscReal CoulombGetResidual(PetscInt n, PetscReal mu, PetscReal c, const PetscScalar force[], const PetscScalar opened[])
{
  PetscReal slip = 0, f[ROW_LAW_ROWS] = {0}, t[ROW_LAW_ROWS] = {0}, size = 0, normal, bound, square;

  for (PetscInt k = 1; k < n; k++) slip += PetscSqr(PetscRealPart(opened[k]));
  slip = PetscSqrtReal(slip);
  for (PetscInt k = 0; k < n; k++) {
    f[k] = PetscRealPart(force[k]);
    t[k] = f[k] - (PetscRealPart(opened[k]) + (k ? 0 : mu * slip)) / c;
    if (k) size += PetscSqr(t[k]);
  }
  size   = PetscSqrtReal(size);
  normal = t[0];
  bound  = size;
  if (size > mu * t[0]) { /* outside the cone: onto its side, or its tip */
    normal = PetscMax((t[0] + mu * size) / (1 + mu * mu), 0);
    bound  = mu * normal;
  }
  square = PetscSqr(f[0] - normal);
  for (PetscInt k = 1; k < n; k++) square += PetscSqr(f[k] - (size > 0 ? bound / size * t[k] : 0));
  return c * PetscSqrtReal(square);
}
