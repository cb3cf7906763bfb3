/* Enhanced quadrilaterals and hexahedra: to the displacements of each element come modes that its neighbours do not see, (xi_m^2 - 1) / 2
   along each coordinate xi_m of the reference element, by which it bends without shear (R. L. Taylor, P. J. Beresford, E. L. Wilson,
   International Journal for Numerical Methods in Engineering 10, 1976; for finite deformations J. C. Simo, F. Armero, the same 33, 1992).
   With the Jacobian j and the matrix J_0 of derivatives of X by xi, at the middle of the element where j is j_0,

     F = 1 + du/dX + sum over m of alpha_m (j_0 / j) xi_m J_0^-T e_m,

   so that constant stress does no work on the modes. Their amplitudes alpha are those of equilibrium within the element. They are found
   from alpha = 0 by Newton's method each time, to round-off: force and energy are functions of the nodes' displacements alone, and there is
   nothing to be kept from one step to the next.

   Of materials with history, force and energy depend on the history of the points at the start of the step too. Newton's method then begins
   with the amplitudes of that time, which lie behind the history of the points: a state far from those that flow would have other
   solutions. */
#include "enhanced.h"

static PetscErrorCode ElementInternalForce_Enhanced(Element element, const PetscScalar u[], PetscScalar f[])
{
  const Solid *solid = (const Solid *)element->data;
  Enhanced     enhanced;
  PetscReal    forces[MAX_UNKNOWNS];

  PetscFunctionBegin;
  element->inverted = -1;
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscInt *nodes = element->connectivity + e * element->nodes;

    EnhancedPrepare(element, e, u, &enhanced);
    PetscCall(EnhancedBalance(solid, &enhanced, forces));
    for (PetscInt i = 0; i < enhanced.fixed; i++) f[enhanced.dim * nodes[i / enhanced.dim] + i % enhanced.dim] += forces[i];
    if (element->inverted < 0 && isnan(forces[0])) element->inverted = e;
  }
  PetscCall(PetscLogFlops(element->flops * (PetscLogDouble)element->count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of a batch, one after the other; without equilibrium NaN */
static PetscErrorCode GetPoints(Element element, PetscInt first, const PetscScalar u[], SimdReal H[][9], SimdReal weights[])
{
  Enhanced  enhanced;
  PetscReal forces[MAX_UNKNOWNS];

  PetscFunctionBegin;
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    EnhancedPrepare(element, PetscMin(first + p, element->count - 1), u, &enhanced);
    PetscCall(EnhancedBalance((const Solid *)element->data, &enhanced, forces));
    for (PetscInt g = 0; g < enhanced.n_points; g++) {
      for (PetscInt k = 0; k < 9; k++) H[g][k][p] = isnan(forces[0]) ? forces[0] : enhanced.H[k][g];
      weights[g][p] = enhanced.weight[g] / element->cross_section;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K_uu - K_ua K_aa^-1 K_au of the matrix of all shapes, a being the modes */
static PetscErrorCode Condense(const Enhanced *enhanced, const PetscReal whole[], PetscScalar K[])
{
  const PetscInt n = enhanced->fixed, m = enhanced->n_modes, all = n + m;
  PetscReal      of_modes[MAX_MODES * MAX_MODES], x[MAX_MODES * SOLID_MAX_NODES * 3] = {0};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < m; i++)
    for (PetscInt j = 0; j < m; j++) of_modes[i * m + j] = whole[(n + i) * all + n + j];
  for (PetscInt column = 0; column < n; column++)
    for (PetscInt i = 0; i < m; i++) x[column * m + i] = whole[(n + i) * all + column];
  PetscCall(EnhancedSolve(m, n, of_modes, x));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j <= i; j++) {
      PetscReal value = whole[i * all + j];

      for (PetscInt k = 0; k < m; k++) value -= whole[i * all + n + k] * x[j * m + k];
      K[i * n + j] = K[j * n + i] = value;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `viscous`: by displacement gradients of nodes alone, and rates of modes without viscous force: objective, never negative */
static PetscErrorCode ElementTangent_Enhanced(Element element, PetscInt e, PetscBool viscous, const PetscScalar u[], PetscScalar K[])
{
  const Solid *solid = (const Solid *)element->data;
  Enhanced     enhanced;
  PetscReal    whole[MAX_UNKNOWNS * MAX_UNKNOWNS], forces[MAX_UNKNOWNS];

  PetscFunctionBegin;
  EnhancedPrepare(element, e, u, &enhanced);
  if (viscous) EnhancedGetGradients(&enhanced);
  else PetscCall(EnhancedBalance(solid, &enhanced, forces));
  EnhancedGetMatrix(solid, &enhanced, viscous, 0, whole);
  PetscCall(Condense(&enhanced, whole, K));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementCreate_Enhanced(Element element)
{
  Solid *solid = (Solid *)element->data;

  PetscFunctionBegin;
  solid->own_history          = EnhancedAmplitudesPerPoint(element->dim * element->dim, solid->shape->n_points);
  solid->scale                = 1;
  solid->observe              = GetPoints;
  element->ops->internalforce = ElementInternalForce_Enhanced;
  element->ops->tangent       = ElementTangent_Enhanced;
  element->ops->viscousforce  = SolidViscousForce;
  PetscFunctionReturn(PETSC_SUCCESS);
}
