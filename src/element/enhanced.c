/*
   Enhanced quadrilaterals and hexahedra: to the displacements of each element come modes that its neighbours do not see, (xi_m^2 - 1) / 2
   along each coordinate xi_m of the reference element, by which it bends without shear (R. L. Taylor, P. J. Beresford, E. L. Wilson,
   International Journal for Numerical Methods in Engineering 10, 1976; for finite deformations J. C. Simo, F. Armero, the same 33, 1992).
   With the Jacobian j and the matrix J_0 of derivatives of X by xi, at the middle of the element where j is j_0,

     F = 1 + du/dX + sum over m of alpha_m (j_0 / j) xi_m J_0^-T e_m,

   so that constant stress does no work on the modes. Their amplitudes alpha are those of equilibrium within the element. They are found
   from alpha = 0 by Newton's method each time, to round-off: force and energy are functions of the nodes' displacements alone, and there is
   nothing to be kept from one step to the next.
*/
#include <impakt/private/solid.h>
#include <petscblaslapack.h>

enum { MODES = 3, MAX_MODES = 9, MAX_SHAPES = SOLID_MAX_NODES + MODES, MAX_UNKNOWNS = MAX_SHAPES * 3 };

#define MAX_ITERATIONS 40

/* One element: its points are the members of a batch for the material */
typedef struct {
  PetscInt  n_points, dim, shapes, fixed, n_modes; /* shapes: nodes and modes; fixed: numbers of the nodes */
  PetscReal weight[SOLID_MAX_POINTS];
  PetscReal gradient[SOLID_MAX_POINTS][MAX_SHAPES * 3];
  PetscReal values[MAX_UNKNOWNS]; /* displacements of the nodes, then alpha */
  SimdReal  H[9], P[9];
} Enhanced;

static void Prepare(Element element, PetscInt e, const PetscScalar u[], Enhanced *enhanced)
{
  const Solid      *solid = (const Solid *)element->data;
  const SolidShape *shape = solid->shape;
  const PetscInt   *nodes = element->connectivity + e * element->nodes;
  const PetscInt    dim = element->dim, n = element->nodes;
  const PetscReal   middle[3] = {0};
  PetscReal         N[SOLID_MAX_NODES], gradient[SOLID_MAX_NODES * 3], of_xi[3][3] = {{0}}, middle_jacobian;

  enhanced->n_points = shape->n_points;
  enhanced->dim      = dim;
  enhanced->shapes   = n + dim;
  enhanced->fixed    = n * dim;
  enhanced->n_modes  = dim * dim;
  middle_jacobian    = SolidGetShape(element, e, middle, N, gradient);
  for (PetscInt m = 0; m < dim; m++)
    for (PetscInt i = 0; i < dim; i++)
      for (PetscInt a = 0; a < n; a++) of_xi[m][i] += shape->corners[dim * a + m] * gradient[dim * a + i];
  for (PetscInt g = 0; g < shape->n_points; g++) {
    const PetscReal *xi       = shape->points + dim * g;
    const PetscReal  jacobian = SolidGetShape(element, e, xi, N, enhanced->gradient[g]);

    enhanced->weight[g] = jacobian * element->cross_section * shape->volume / shape->n_points;
    for (PetscInt m = 0; m < dim; m++)
      for (PetscInt i = 0; i < dim; i++) enhanced->gradient[g][dim * (n + m) + i] = middle_jacobian / jacobian * xi[m] * of_xi[m][i];
  }
  for (PetscInt a = 0; a < n; a++)
    for (PetscInt i = 0; i < dim; i++) enhanced->values[dim * a + i] = u[dim * nodes[a] + i];
  for (PetscInt i = 0; i < enhanced->n_modes; i++) enhanced->values[enhanced->fixed + i] = 0;
}

static void GetGradients(Enhanced *enhanced)
{
  const PetscInt dim = enhanced->dim;

  for (PetscInt k = 0; k < 9; k++)
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) enhanced->H[k][p] = 0;
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal *gradient = enhanced->gradient[p % enhanced->n_points]; /* members that are left over repeat points */

    for (PetscInt a = 0; a < enhanced->shapes; a++)
      for (PetscInt i = 0; i < dim; i++)
        for (PetscInt j = 0; j < dim; j++) enhanced->H[3 * i + j][p] += enhanced->values[dim * a + i] * gradient[dim * a + j];
  }
}

/* The force on each node and mode */
static void GetForces(const Solid *solid, Enhanced *enhanced, PetscReal f[])
{
  const PetscInt dim = enhanced->dim;

  GetGradients(enhanced);
  (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])enhanced->H, enhanced->P);
  for (PetscInt a = 0; a < enhanced->shapes; a++)
    for (PetscInt i = 0; i < dim; i++) {
      f[dim * a + i] = 0;
      for (PetscInt p = 0; p < enhanced->n_points; p++)
        for (PetscInt j = 0; j < dim; j++)
          f[dim * a + i] += enhanced->weight[p] * enhanced->P[3 * i + j][p] * enhanced->gradient[p][dim * a + j];
    }
}

/* The matrix of shapes from `first` on, row by row; `viscous`: of the stress F C : dE/dt */
static void GetMatrix(const Solid *solid, const Enhanced *enhanced, PetscBool viscous, PetscInt first, PetscReal K[])
{
  const PetscInt dim = enhanced->dim, n = (enhanced->shapes - first) * dim;

  for (PetscInt i = 0; i < n * n; i++) K[i] = 0;
  for (PetscInt p = 0; p < enhanced->n_points; p++) {
    const PetscReal *gradient = enhanced->gradient[p] + dim * first;
    PetscReal        H[9], tangent[81];

    for (PetscInt k = 0; k < 9; k++) H[k] = enhanced->H[k][p];
    (*solid->kernels.tangent)(solid->kernels.data, H, tangent);
    if (viscous) SolidTurnTangent(H, tangent);
    for (PetscInt column = 0; column < n; column++) {
      PetscReal stress[3][3];

      for (PetscInt i = 0; i < dim; i++)
        for (PetscInt j = 0; j < dim; j++) {
          stress[i][j] = 0;
          for (PetscInt l = 0; l < dim; l++)
            stress[i][j] += enhanced->weight[p] * tangent[9 * (3 * i + j) + 3 * (column % dim) + l] * gradient[column / dim * dim + l];
        }
      for (PetscInt row = 0; row < n; row++)
        for (PetscInt j = 0; j < dim; j++) K[row * n + column] += stress[row % dim][j] * gradient[row / dim * dim + j];
    }
  }
}

/* x = K^-1 x for n_rhs columns, one after the other; NaN where there is none */
static PetscErrorCode Solve(PetscInt n, PetscInt n_rhs, PetscReal K[], PetscReal x[])
{
  PetscBLASInt size, columns, pivots[MAX_MODES], info;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &size));
  PetscCall(PetscBLASIntCast(n_rhs, &columns));
  for (PetscInt i = 0; i < n * n; i++)
    if (!(PetscAbsReal(K[i]) < PETSC_MAX_REAL)) K[0] = 0, x[0] = NAN; /* not for LAPACK */
  if (!isnan(x[0])) PetscCallBLAS("LAPACKgesv", LAPACKgesv_(&size, &columns, K, &size, pivots, x, &size, &info));
  else info = 1;
  for (PetscInt i = 0; i < n * n_rhs && info; i++) x[i] = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Amplitudes that leave the modes without force, and the forces of the nodes; NaN where they are not found */
static PetscErrorCode Balance(const Solid *solid, Enhanced *enhanced, PetscReal f[])
{
  const PetscInt n     = enhanced->n_modes;
  PetscReal     *alpha = enhanced->values + enhanced->fixed, K[MAX_MODES * MAX_MODES], change[MAX_MODES] = {0};
  PetscBool      last = PETSC_FALSE;

  PetscFunctionBegin;
  GetForces(solid, enhanced, f);
  for (PetscInt iteration = 0; iteration < MAX_ITERATIONS && !last; iteration++) {
    PetscReal strain = 0, largest = 0, scale = 1;

    for (PetscInt i = 0; i < n; i++) change[i] = -f[enhanced->fixed + i];
    GetMatrix(solid, enhanced, PETSC_FALSE, enhanced->shapes - enhanced->dim, K);
    PetscCall(Solve(n, 1, K, change));
    if (isnan(change[0])) break;
    for (PetscInt k = 0; k < 9; k++)
      for (PetscInt p = 0; p < enhanced->n_points; p++) strain = PetscMax(strain, PetscAbsReal(enhanced->H[k][p]));
    for (PetscInt p = 0; p < enhanced->n_points; p++)
      for (PetscInt i = 0; i < n; i++)
        for (PetscInt j = 0; j < enhanced->dim; j++) {
          const PetscInt shape = enhanced->shapes - enhanced->dim + i / enhanced->dim;

          largest = PetscMax(largest, PetscAbsReal(change[i] * enhanced->gradient[p][enhanced->dim * shape + j]));
        }
    /* what is left after a step is of the size of its square, relative to the strain where the material is not linear */
    last = (PetscBool)(solid->linear || largest <= 1e-9 * strain);
    for (PetscInt i = 0; i < n; i++) alpha[i] += change[i];
    GetForces(solid, enhanced, f);
    /* steps into inverted states are cut */
    for (PetscInt cut = 0; cut < 10 && isnan(f[enhanced->fixed]); cut++) {
      scale *= 0.5;
      for (PetscInt i = 0; i < n; i++) alpha[i] -= scale * change[i];
      GetForces(solid, enhanced, f);
    }
  }
  for (PetscInt i = 0; i < enhanced->fixed && !last; i++) f[i] = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementInternalForce_Enhanced(Element element, const PetscScalar u[], PetscScalar f[])
{
  const Solid *solid = (const Solid *)element->data;
  Enhanced     enhanced;
  PetscReal    forces[MAX_UNKNOWNS];

  PetscFunctionBegin;
  element->inverted = -1;
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscInt *nodes = element->connectivity + e * element->nodes;

    Prepare(element, e, u, &enhanced);
    PetscCall(Balance(solid, &enhanced, forces));
    for (PetscInt i = 0; i < enhanced.fixed; i++) f[enhanced.dim * nodes[i / enhanced.dim] + i % enhanced.dim] += forces[i];
    if (element->inverted < 0 && isnan(forces[0])) element->inverted = e;
  }
  PetscCall(PetscLogFlops(element->flops * (PetscLogDouble)element->count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementEnergy_Enhanced(Element element, const PetscScalar u[], PetscReal *energy)
{
  const Solid *solid = (const Solid *)element->data;
  Enhanced     enhanced;
  PetscReal    forces[MAX_UNKNOWNS];

  PetscFunctionBegin;
  element->inverted = -1;
  *energy           = 0;
  for (PetscInt e = 0; e < element->count; e++) {
    SimdReal W;

    Prepare(element, e, u, &enhanced);
    PetscCall(Balance(solid, &enhanced, forces));
    (*solid->kernels.energy)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])enhanced.H, W);
    for (PetscInt p = 0; p < enhanced.n_points; p++) *energy += enhanced.weight[p] * W[p];
    if (element->inverted < 0 && isnan(forces[0])) element->inverted = e;
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
  PetscCall(Solve(m, n, of_modes, x));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j <= i; j++) {
      PetscReal value = whole[i * all + j];

      for (PetscInt k = 0; k < m; k++) value -= whole[i * all + n + k] * x[j * m + k];
      K[i * n + j] = K[j * n + i] = value;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementStiffness_Enhanced(Element element, PetscInt e, const PetscScalar u[], PetscScalar K[])
{
  const Solid *solid = (const Solid *)element->data;
  Enhanced     enhanced;
  PetscReal    whole[MAX_UNKNOWNS * MAX_UNKNOWNS], forces[MAX_UNKNOWNS];

  PetscFunctionBegin;
  Prepare(element, e, u, &enhanced);
  PetscCall(Balance(solid, &enhanced, forces));
  GetMatrix(solid, &enhanced, PETSC_FALSE, 0, whole);
  PetscCall(Condense(&enhanced, whole, K));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With the displacement gradients of the nodes alone, and rates of the modes that leave them without viscous force: objective, and never
   negative */
static PetscErrorCode ElementViscosity_Enhanced(Element element, PetscInt e, const PetscScalar u[], PetscScalar C[])
{
  const Solid *solid = (const Solid *)element->data;
  Enhanced     enhanced;
  PetscReal    whole[MAX_UNKNOWNS * MAX_UNKNOWNS];

  PetscFunctionBegin;
  Prepare(element, e, u, &enhanced);
  GetGradients(&enhanced);
  GetMatrix(solid, &enhanced, PETSC_TRUE, 0, whole);
  PetscCall(Condense(&enhanced, whole, C));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementViscousForce_Enhanced(Element element, const PetscScalar u[], const PetscScalar v[], PetscScalar f[])
{
  const PetscInt dim = element->dim, n = element->nodes * dim;
  PetscScalar    C[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS] = {0};

  PetscFunctionBegin;
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscInt *nodes = element->connectivity + e * element->nodes;

    PetscCall(ElementViscosity_Enhanced(element, e, u, C));
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++) f[dim * nodes[i / dim] + i % dim] += C[i * n + j] * v[dim * nodes[j / dim] + j % dim];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementStress_Enhanced(Element element, const PetscScalar u[], PetscReal stress[])
{
  const Solid *solid = (const Solid *)element->data;
  Enhanced     enhanced;
  PetscReal    forces[MAX_UNKNOWNS];

  PetscFunctionBegin;
  for (PetscInt e = 0; e < element->count; e++) {
    PetscReal sigma[6], volume = 0;

    Prepare(element, e, u, &enhanced);
    PetscCall(Balance(solid, &enhanced, forces));
    if (solid->plane_stress && !solid->linear) SolidStretchThickness(solid, enhanced.H);
    for (PetscInt k = 0; k < 6; k++) stress[6 * e + k] = 0;
    for (PetscInt p = 0; p < enhanced.n_points; p++) {
      SolidCauchy(enhanced.H, enhanced.P, solid->linear, p, sigma);
      for (PetscInt k = 0; k < 6; k++) stress[6 * e + k] += enhanced.weight[p] * sigma[k];
      volume += enhanced.weight[p];
    }
    for (PetscInt k = 0; k < 6; k++) stress[6 * e + k] /= volume;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElementCreate_Enhanced(Element element)
{
  PetscFunctionBegin;
  element->ops->internalforce = ElementInternalForce_Enhanced;
  element->ops->energy        = ElementEnergy_Enhanced;
  element->ops->stiffness     = ElementStiffness_Enhanced;
  element->ops->viscousforce  = ElementViscousForce_Enhanced;
  element->ops->viscosity     = ElementViscosity_Enhanced;
  element->ops->stress        = ElementStress_Enhanced;
  PetscFunctionReturn(PETSC_SUCCESS);
}
