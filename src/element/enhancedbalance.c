/* An enhanced element: gradients, forces and matrices of its nodes and modes, and the amplitudes of equilibrium. See enhanced.c. */
#include "enhanced.h"
#include <petscblaslapack.h>

#define MAX_ITERATIONS 40
#define STRAIN_STEP    1e-8 /* of differences: small against strains at which metals flow, large against round-off */
#define RELATIVE       1e-9 /* part of the strain that amplitudes change by at last */
/* Or the strain itself: stresses follow from 1 + H, whose round-off smaller strains are. Elements that fly freely have no others. */
#define ROUND_OFF (50 * PETSC_MACHINE_EPSILON)

void EnhancedPrepare(Element element, PetscInt e, const PetscScalar u[], Enhanced *enhanced)
{
  const Solid      *solid = (const Solid *)element->data;
  const SolidShape *shape = solid->shape;
  const PetscInt   *nodes = element->connectivity + e * element->nodes;
  const PetscInt    dim = element->dim, n = element->nodes;
  const PetscReal   middle[3] = {0};
  PetscReal         N[SOLID_MAX_NODES], gradient[SOLID_MAX_NODES * 3], of_xi[3][3] = {{0}}, middle_jacobian;

  enhanced->element  = e;
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

/* How many amplitudes lie behind the history of each point */
PetscInt EnhancedAmplitudesPerPoint(PetscInt n_modes, PetscInt n_points)
{
  return (n_modes + n_points - 1) / n_points;
}

/* The history at the start of the step, and the amplitudes of that time */
static void LoadHistory(const Solid *solid, Enhanced *enhanced)
{
  const ElementHistory *history = solid->history;
  const PetscInt        n = solid->kernels.n_history, e = enhanced->element,
                        per_point = EnhancedAmplitudesPerPoint(enhanced->n_modes, enhanced->n_points);

  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscInt   g     = p % enhanced->n_points; /* members that are left over repeat points */
    const PetscReal *point = history->start + SolidHistoryOffset(history, e, g) + e % SIMD_WIDTH;

    for (PetscInt c = 0; c < n; c++) enhanced->start[c][p] = point[SIMD_WIDTH * c];
    for (PetscInt c = 0; c < per_point && per_point * g + c < enhanced->n_modes; c++)
      enhanced->values[enhanced->fixed + per_point * g + c] = point[SIMD_WIDTH * (n + c)];
  }
}

static void StoreHistory(const Solid *solid, Enhanced *enhanced)
{
  const ElementHistory *history = solid->history;
  const PetscInt        n = solid->kernels.n_history, e = enhanced->element,
                        per_point = EnhancedAmplitudesPerPoint(enhanced->n_modes, enhanced->n_points);

  (*solid->kernels.advance)(solid->kernels.data, history->step, (const PetscReal(*)[SIMD_WIDTH])enhanced->H,
                            (const PetscReal(*)[SIMD_WIDTH])enhanced->start, enhanced->end, enhanced->P);
  for (PetscInt g = 0; g < enhanced->n_points; g++) {
    PetscReal *point = history->end + SolidHistoryOffset(history, e, g) + e % SIMD_WIDTH;

    for (PetscInt c = 0; c < n; c++) point[SIMD_WIDTH * c] = enhanced->end[c][g];
    for (PetscInt c = 0; c < per_point && per_point * g + c < enhanced->n_modes; c++)
      point[SIMD_WIDTH * (n + c)] = enhanced->values[enhanced->fixed + per_point * g + c];
  }
}

void EnhancedGetGradients(Enhanced *enhanced)
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

static void GetStress(const Solid *solid, Enhanced *enhanced)
{
  if (solid->history->start)
    (*solid->kernels.advance)(solid->kernels.data, solid->history->step, (const PetscReal(*)[SIMD_WIDTH])enhanced->H,
                              (const PetscReal(*)[SIMD_WIDTH])enhanced->start, NULL, enhanced->P);
  else (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])enhanced->H, enhanced->P);
}

/* The force of the stress on each shape from `first` on */
static void SumForces(const Enhanced *enhanced, PetscInt first, PetscReal f[])
{
  const PetscInt dim = enhanced->dim;

  for (PetscInt a = first; a < enhanced->shapes; a++)
    for (PetscInt i = 0; i < dim; i++) {
      f[dim * a + i] = 0;
      for (PetscInt p = 0; p < enhanced->n_points; p++)
        for (PetscInt j = 0; j < dim; j++)
          f[dim * a + i] += enhanced->weight[p] * enhanced->P[3 * i + j][p] * enhanced->gradient[p][dim * a + j];
    }
}

static void GetForces(const Solid *solid, Enhanced *enhanced, PetscReal f[])
{
  EnhancedGetGradients(enhanced);
  GetStress(solid, enhanced);
  SumForces(enhanced, 0, f);
}

/* The matrix of shapes from `first` on, row by row; `viscous`: of the stress F C : dE/dt */
void EnhancedGetMatrix(const Solid *solid, const Enhanced *enhanced, PetscBool viscous, PetscInt first, PetscReal K[])
{
  const PetscInt dim = enhanced->dim, n = (enhanced->shapes - first) * dim;

  for (PetscInt i = 0; i < n * n; i++) K[i] = 0;
  for (PetscInt p = 0; p < enhanced->n_points; p++) {
    const PetscReal *gradient = enhanced->gradient[p] + dim * first;
    PetscReal        H[9], tangent[81];

    for (PetscInt k = 0; k < 9; k++) H[k] = enhanced->H[k][p];
    SolidTangent(solid, enhanced->element, p, H, tangent);
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
PetscErrorCode EnhancedSolve(PetscInt n, PetscInt n_rhs, PetscReal K[], PetscReal x[])
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

/* The matrix of the modes at amplitudes of which `f` are the forces. With history by differences, as stresses of eight points take a small
   part of the time of one tangent; their error of 1e-5 slows Newton's method, no more. */
static void GetMatrixOfModes(const Solid *solid, Enhanced *enhanced, const PetscReal f[], PetscReal K[])
{
  const PetscInt dim = enhanced->dim, n = enhanced->n_modes, first = enhanced->shapes - dim;
  PetscReal      moved[MAX_UNKNOWNS];

  if (!solid->history->start) {
    EnhancedGetMatrix(solid, enhanced, PETSC_FALSE, first, K);
    return;
  }
  for (PetscInt column = 0; column < n; column++) {
    const PetscInt shape = dim * (first + column / dim), row_of_H = 3 * (column % dim);
    PetscReal      gradient = 0, step;
    SimdReal       kept[3];

    for (PetscInt p = 0; p < enhanced->n_points; p++)
      for (PetscInt j = 0; j < dim; j++) gradient = PetscMax(gradient, PetscAbsReal(enhanced->gradient[p][shape + j]));
    step = STRAIN_STEP / gradient;
    for (PetscInt j = 0; j < dim; j++)
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
        kept[j][p] = enhanced->H[row_of_H + j][p];
        enhanced->H[row_of_H + j][p] += step * enhanced->gradient[p % enhanced->n_points][shape + j];
      }
    GetStress(solid, enhanced);
    SumForces(enhanced, first, moved);
    for (PetscInt row = 0; row < n; row++) K[row * n + column] = (moved[enhanced->fixed + row] - f[enhanced->fixed + row]) / step;
    for (PetscInt j = 0; j < dim; j++)
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) enhanced->H[row_of_H + j][p] = kept[j][p];
  }
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < i; j++) K[i * n + j] = K[j * n + i] = 0.5 * (K[i * n + j] + K[j * n + i]);
}

/* The largest change of strain at a point that a change of the amplitudes makes */
static PetscReal LargestStrain(const Enhanced *enhanced, const PetscReal change[])
{
  PetscReal largest = 0;

  for (PetscInt p = 0; p < enhanced->n_points; p++)
    for (PetscInt i = 0; i < enhanced->n_modes; i++)
      for (PetscInt j = 0; j < enhanced->dim; j++) {
        const PetscInt shape = enhanced->shapes - enhanced->dim + i / enhanced->dim;

        largest = PetscMax(largest, PetscAbsReal(change[i] * enhanced->gradient[p][enhanced->dim * shape + j]));
      }
  return largest;
}

static PetscReal LargestForce(const Enhanced *enhanced, const PetscReal f[])
{
  PetscReal largest = 0;

  for (PetscInt i = enhanced->fixed; i < enhanced->fixed + enhanced->n_modes; i++) largest = PetscMax(largest, PetscAbsReal(f[i]));
  return largest;
}

/* Where flow begins or ends within a change of the amplitudes, a whole step may go beyond equilibrium, and back again without end: the
   part of it is taken at which the force along the change is small against that at its begin. `f`: of the whole step, then of the part. */
static void Shorten(const Solid *solid, Enhanced *enhanced, const PetscReal change[], PetscReal before, PetscReal f[])
{
  PetscReal *alpha = enhanced->values + enhanced->fixed, low = 0, high = 1, at = 1;

  for (PetscInt cut = 0; cut < 10; cut++) {
    PetscReal along = 0, next;

    for (PetscInt i = 0; i < enhanced->n_modes; i++) along += change[i] * f[enhanced->fixed + i];
    if (PetscNot(along > 0.5 * before) && PetscNot(cut && along < -0.5 * before)) return;
    if (along > 0) high = at;
    else low = at;
    next = 0.5 * (low + high);
    for (PetscInt i = 0; i < enhanced->n_modes; i++) alpha[i] += (next - at) * change[i];
    at = next;
    GetForces(solid, enhanced, f);
  }
}

/* Amplitudes that leave the modes without force, and the forces of the nodes; NaN where they are not found */
PetscErrorCode EnhancedBalance(const Solid *solid, Enhanced *enhanced, PetscReal f[])
{
  const PetscInt  n       = enhanced->n_modes;
  const PetscBool history = (PetscBool)(solid->history->start != NULL);
  PetscReal *alpha = enhanced->values + enhanced->fixed, K[MAX_MODES * MAX_MODES], factors[MAX_MODES * MAX_MODES], change[MAX_MODES] = {0};
  PetscBool  last = PETSC_FALSE, keep = PETSC_FALSE;

  PetscFunctionBegin;
  if (history) LoadHistory(solid, enhanced);
  GetForces(solid, enhanced, f);
  for (PetscInt iteration = 0; iteration < MAX_ITERATIONS && !last; iteration++) {
    const PetscReal force  = LargestForce(enhanced, f);
    PetscReal       strain = 0, scale = 1, before = 0;

    for (PetscInt i = 0; i < n; i++) change[i] = -f[enhanced->fixed + i];
    for (PetscInt k = 0; k < 9; k++)
      for (PetscInt p = 0; p < enhanced->n_points; p++) strain = PetscMax(strain, PetscAbsReal(enhanced->H[k][p]));
    if (!keep) GetMatrixOfModes(solid, enhanced, f, K);
    PetscCall(PetscArraycpy(factors, K, n * n));
    PetscCall(EnhancedSolve(n, 1, factors, change));
    if (isnan(change[0])) break;
    /* what is left after a step is of the size of its square, relative to the strain where the material is not linear */
    last = (PetscBool)(solid->linear || LargestStrain(enhanced, change) <= PetscMax(RELATIVE * strain, ROUND_OFF));
    for (PetscInt i = 0; i < n; i++) {
      before -= change[i] * f[enhanced->fixed + i];
      alpha[i] += change[i];
    }
    GetForces(solid, enhanced, f);
    /* steps into inverted states are cut */
    for (PetscInt cut = 0; cut < 10 && isnan(f[enhanced->fixed]); cut++) {
      scale *= 0.5;
      for (PetscInt i = 0; i < n; i++) alpha[i] -= scale * change[i];
      GetForces(solid, enhanced, f);
    }
    if (!history || last) continue;
    if (scale == 1) Shorten(solid, enhanced, change, before, f);
    keep = (PetscBool)(LargestForce(enhanced, f) <= 1e-3 * force);
  }
  for (PetscInt i = 0; i < enhanced->fixed && !last; i++) f[i] = NAN;
  if (history && solid->history->end) StoreHistory(solid, enhanced);
  PetscFunctionReturn(PETSC_SUCCESS);
}
