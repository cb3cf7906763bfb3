/* The coefficients of the factor on a body's masses that satisfies conditions on their moments: see massmoments.c. */
#include "massmoments.h"
#include <petscblaslapack.h>

/* Newton's method has converged with moments right to this, in units of the total mass and of the radii of gyration; sums over 10^5 nodes
   lose some 1e-15. It ends where no step makes what is missing smaller by 1 %, or after so many iterations and halvings of a step. */
#define TOLERANCE  1e-13
#define ITERATIONS 60
#define HALVINGS   6
#define PROGRESS   0.99
/* Coefficients of soft conditions are what is missing over the softness, of the centre up to 1e6 times that: so much of them is round-off
   in what is missing, up to a bound. Else it would be a matter of chance, of the number of ranks too, whether conditions are satisfied. */
#define ROUND_OFF      (4 * PETSC_MACHINE_EPSILON)
#define MOST_TOLERANCE 1e-11
/* Where that fails, stiffnesses of the springs that hold the coefficients near those before, from 1 down */
#define LEAST_HOLD     1e-4
#define HOLD_REDUCTION 0.3
/* 1, and the coordinates along the axes, at a node */
void MomentsGetFields(const MomentsProblem *problem, PetscInt node, PetscReal phi[4])
{
  const PetscInt dim = problem->body->mesh.dim;

  phi[0] = 1;
  for (PetscInt a = 0; a < dim; a++) {
    phi[1 + a] = 0;
    for (PetscInt d = 0; d < dim; d++)
      phi[1 + a] += problem->axes[a][d] * (problem->body->mesh.coordinates[node * dim + d] - problem->centre[d]) / problem->size[a];
  }
}

/* The polynomials that the conditions come with, at a node */
void MomentsGetPolynomials(const MomentsProblem *problem, PetscInt node, PetscReal psi[MAX_MOMENTS])
{
  PetscReal phi[4];

  MomentsGetFields(problem, node, phi);
  for (PetscInt k = 0; k < problem->n; k++) {
    psi[k] = 0;
    for (PetscInt m = 0; m < problem->n_moments; m++)
      psi[k] += problem->condition[k][m] * phi[problem->pair[m][0]] * phi[problem->pair[m][1]];
  }
}

/* 1 + p; the factor is this or its bound, whichever is larger */
PetscReal MomentsGetPolynomial(const MomentsProblem *problem, const PetscReal coefficients[], const PetscReal psi[])
{
  PetscReal value = 1;

  for (PetscInt k = 0; k < problem->n; k++) value += coefficients[k] * psi[k];
  return value;
}

/* Moments of the mass under the factor, over the mass; `slopes` (or NULL): derivatives of the conditions, a column per coefficient */
PetscErrorCode MomentsCompute(const MomentsProblem *problem, const PetscReal coefficients[], PetscReal moments[], PetscReal slopes[])
{
  const PetscInt n = problem->n, n_moments = problem->n_moments;
  PetscReal      sums[MAX_MOMENTS + MAX_MOMENTS * MAX_MOMENTS] = {0}, *slope = sums + n_moments;

  PetscFunctionBegin;
  for (PetscInt node = 0; node < problem->body->mesh.local_nodes; node++) {
    const PetscReal *weights = problem->weights + node * n_moments;
    PetscReal        psi[MAX_MOMENTS], polynomial, factor;

    MomentsGetPolynomials(problem, node, psi);
    polynomial = MomentsGetPolynomial(problem, coefficients, psi);
    factor     = PetscClipInterval(polynomial, LEAST_FACTOR, problem->most);
    for (PetscInt m = 0; m < n_moments; m++) sums[m] += factor * weights[m];
    if (!slopes || factor != polynomial) continue;
    for (PetscInt k = 0; k < n; k++) {
      PetscReal weight = 0;

      for (PetscInt m = 0; m < n_moments; m++) weight += problem->condition[k][m] * weights[m];
      for (PetscInt l = 0; l < n; l++) slope[l * n + k] += weight * psi[l];
    }
  }
  if (!problem->alone)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, (PetscMPIInt)(n_moments + (slopes ? n * n : 0)), MPIU_REAL, MPIU_SUM,
                               PetscObjectComm((PetscObject)problem->body)));
  PetscCall(PetscArraycpy(moments, sums, n_moments));
  if (slopes) PetscCall(PetscArraycpy(slopes, slope, n * n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is missing in the conditions, with springs where they are soft, and its norm */
static void ComputeResidual(const MomentsProblem *problem, PetscReal hold, const PetscReal start[], const PetscReal coefficients[],
                            const PetscReal moments[], PetscReal residual[], PetscReal *norm)
{
  *norm = 0;
  for (PetscInt k = 0; k < problem->n; k++) {
    residual[k] = problem->softness[k] * coefficients[k] + hold * (coefficients[k] - start[k]);
    for (PetscInt m = 0; m < problem->n_moments; m++) residual[k] += problem->condition[k][m] * (moments[m] - problem->target[m]);
    *norm += PetscSqr(residual[k]);
  }
  *norm = PetscSqrtReal(*norm);
}

/* What may be missing in the conditions with these coefficients */
static PetscReal GetTolerance(const MomentsProblem *problem, const PetscReal coefficients[])
{
  PetscReal largest = 0;

  for (PetscInt k = 0; k < problem->n; k++) largest = PetscMax(largest, PetscAbsReal(coefficients[k]));
  return PetscMin(TOLERANCE + ROUND_OFF * largest, MOST_TOLERANCE);
}

/* x becomes A^-1 x; what A leaves undetermined is zero */
static PetscErrorCode SolveSmall(PetscInt n, PetscReal A[], PetscReal x[])
{
  PetscReal    singular[MAX_MOMENTS], work[20 * MAX_MOMENTS], least = 1e-12;
  PetscBLASInt order = (PetscBLASInt)n, one = 1, rank, lwork = 20 * MAX_MOMENTS, info;

  PetscFunctionBegin;
  PetscCallBLAS("LAPACKgelss", LAPACKgelss_(&order, &order, &one, A, &order, x, &order, singular, &least, &rank, work, &lwork, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK gelss info %d", (int)info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newton's method with halved steps, from the coefficients as they are. `hold` is the stiffness of further springs that hold them there. */
static PetscErrorCode Iterate(MomentsProblem *problem, PetscReal hold, PetscReal coefficients[], PetscBool *converged)
{
  const PetscInt n = problem->n;
  PetscReal      moments[MAX_MOMENTS], residual[MAX_MOMENTS], slopes[MAX_MOMENTS * MAX_MOMENTS], start[MAX_MOMENTS], norm;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(start, coefficients, n));
  PetscCall(MomentsCompute(problem, coefficients, moments, slopes));
  ComputeResidual(problem, hold, start, coefficients, moments, residual, &norm);
  for (PetscInt iteration = 0; iteration < ITERATIONS; iteration++) {
    /* what is round-off already, no half of a step makes smaller */
    const PetscInt halvings = norm <= GetTolerance(problem, coefficients) ? 1 : HALVINGS;
    PetscReal      next[MAX_MOMENTS], next_residual[MAX_MOMENTS], next_norm = PETSC_MAX_REAL, part = 1;

    for (PetscInt k = 0; k < n; k++) slopes[k * n + k] += problem->softness[k] + hold;
    PetscCall(SolveSmall(n, slopes, residual));
    for (PetscInt halving = 0; halving < halvings && !(next_norm < PROGRESS * norm); halving++, part /= 2) {
      for (PetscInt k = 0; k < n; k++) next[k] = coefficients[k] - part * residual[k];
      PetscCall(MomentsCompute(problem, next, moments, slopes));
      ComputeResidual(problem, hold, start, next, moments, next_residual, &next_norm);
    }
    if (!(next_norm < PROGRESS * norm)) break;
    norm = next_norm;
    PetscCall(PetscArraycpy(coefficients, next, n));
    PetscCall(PetscArraycpy(residual, next_residual, n));
  }
  *converged = (PetscBool)(norm <= GetTolerance(problem, coefficients));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The coefficients that satisfy the conditions: by Newton's method from a factor of 1, or, if that fails because too many nodes are at the
   bounds, by the proximal point method: solutions held near the one before, less and less */
PetscErrorCode MomentsSolve(MomentsProblem *problem, PetscReal coefficients[], PetscBool *converged)
{
  PetscReal hold = 1;
  PetscBool held;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(coefficients, MAX_MOMENTS));
  PetscCall(Iterate(problem, 0, coefficients, converged));
  if (*converged) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArrayzero(coefficients, MAX_MOMENTS));
  while (hold > LEAST_HOLD) {
    PetscCall(Iterate(problem, hold, coefficients, &held));
    hold *= HOLD_REDUCTION;
  }
  PetscCall(Iterate(problem, 0, coefficients, converged));
  PetscFunctionReturn(PETSC_SUCCESS);
}
