/* Compressible neo-Hookean: W = mu/2 (tr C - 3) - mu ln J + lambda/4 (J^2 - 1 - 2 ln J), and so
   P = mu (F - F^-T) + lambda/2 (J^2 - 1) F^-T (Ciarlet, Mathematical Elasticity I, 1988, section 4.10; Wriggers, Nonlinear Finite
   Element Methods, 2008, section 3.3.1; the energy as in the Ratel manual, "Neo-Hookean", eq. (34)).

   Everything is written in H = F - I, so that small strains keep their digits: with C = cof H and q = tr C + det H,
   J - 1 = tr H + q, cof F = (1 + tr H) I - H^T + C, and J (F - F^-T) = J H + H^T - C + q I. */
#include <impakt/private/isotropic.h>
#include <impakt/private/tensor.h>

SIMD_CLONES static void Stress(const void *data, const PetscReal H[9][8], PetscReal P[9][8])
{
  const PetscReal half_lambda = 0.5 * ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h = TensorLoad(H, p), c = TensorCofactor(h);
    const PetscReal trace = TensorTrace(h), q = TensorVolumeRemainder(h, c), j = trace + q, J = 1 + j;
    const PetscReal inverse = TensorDefined(J) / J, pressure = half_lambda * j * (J + 1);
    const PetscReal a = inverse * (mu - pressure), d = inverse * (mu * q + pressure * (1 + trace));

    TensorStore((Tensor){mu * h.xx + a * (h.xx - c.xx) + d, mu * h.xy + a * (h.yx - c.xy), mu * h.xz + a * (h.zx - c.xz),
                         mu * h.yx + a * (h.xy - c.yx), mu * h.yy + a * (h.yy - c.yy) + d, mu * h.yz + a * (h.zy - c.yz),
                         mu * h.zx + a * (h.xz - c.zx), mu * h.zy + a * (h.yz - c.zy), mu * h.zz + a * (h.zz - c.zz) + d},
                P, p);
  }
}

/* Up to this |J - 1| the series below is exact to round-off with its 8 terms: z^2 <= 1/81, the next is z^17 / 19 of the leading one */
#define SERIES_LIMIT 0.2

/* j - ln(1 + j) without cancellation: ln(1 + j) = 2 artanh z with z = j / (2 + j) (Abramowitz and Stegun, 4.1.27), and j - 2 z = z j */
SIMD_INLINE PetscReal LogRemainderSeries(PetscReal j)
{
  const PetscReal z = j / (2 + j), y = z * z;
  const PetscReal sum = 1. / 3 + y * (1. / 5 + y * (1. / 7 + y * (1. / 9 + y * (1. / 11 + y * (1. / 13 + y * (1. / 15 + y / 17))))));

  return z * j - 2 * z * y * sum;
}

SIMD_CLONES static void Energy(const void *data, const PetscReal H[9][8], PetscReal W[8])
{
  const PetscReal lambda = ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu;
  SimdReal        change, defined, remainder, rest;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h = TensorLoad(H, p);
    const PetscReal q = TensorVolumeRemainder(h, TensorCofactor(h)), j = TensorTrace(h) + q;
    const PetscReal squares = h.xx * h.xx + h.xy * h.xy + h.xz * h.xz + h.yx * h.yx + h.yy * h.yy + h.yz * h.yz + h.zx * h.zx +
                              h.zy * h.zy + h.zz * h.zz;

    change[p]    = j;
    defined[p]   = TensorDefined(1 + j);
    remainder[p] = LogRemainderSeries(j);
    rest[p]      = mu * (0.5 * squares - q) + 0.25 * lambda * j * j;
  }
  for (int p = 0; p < SIMD_WIDTH; p++) /* rare: not worth a vector logarithm */
    if (PetscAbsReal(change[p]) > SERIES_LIMIT && defined[p] == 1) remainder[p] = change[p] - log1p(change[p]);
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) W[p] = defined[p] * (rest[p] + (mu + 0.5 * lambda) * remainder[p]);
}

/* With G = F^-T: dP_ij / dF_kl = mu delta_ik delta_jl + (mu - lambda/2 (J^2 - 1)) G_il G_kj + lambda J^2 G_ij G_kl */
static void Tangent(const void *data, const PetscReal H[9], PetscReal tangent[81])
{
  const PetscReal lambda = ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu;
  const Tensor    f = {1 + H[0], H[1], H[2], H[3], 1 + H[4], H[5], H[6], H[7], 1 + H[8]}, c = TensorCofactor(f);
  const PetscReal J = f.xx * c.xx + f.xy * c.xy + f.xz * c.xz, inverse = TensorDefined(J) / J;
  const PetscReal a = mu - 0.5 * lambda * (J * J - 1), b = lambda * J * J;
  const PetscReal G[3][3] = {{inverse * c.xx, inverse * c.xy, inverse * c.xz},
                             {inverse * c.yx, inverse * c.yy, inverse * c.yz},
                             {inverse * c.zx, inverse * c.zy, inverse * c.zz}};

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
          tangent[9 * (3 * i + j) + 3 * k + l] = (i == k && j == l ? mu : 0) + a * G[i][l] * G[k][j] + b * G[i][j] * G[k][l];
}

/* Plane stress: P_zz = 0 gives the squared stretch across the plane, (2 mu + lambda) / (2 mu + lambda J_xy^2) with the ratio of areas
   in the plane, J_xy. With a negative lambda there is none for large ratios. */
SIMD_CLONES static void Thickness(const void *data, const PetscReal H[9][8], PetscReal Hzz[8])
{
  const PetscReal lambda = ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal xx = H[0][p], xy = H[1][p], yx = H[3][p], yy = H[4][p];
    const PetscReal j = xx + yy + xx * yy - xy * yx, denominator = 2 * mu + lambda * (1 + j) * (1 + j);
    const PetscReal change = -lambda * j * (2 + j) / denominator; /* of the squared stretch */

    Hzz[p] = change / (1 + PetscSqrtReal(TensorDefined(denominator) * (1 + change)));
  }
}

static PetscErrorCode MaterialKernels_NeoHookean(Material material, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  *kernels = (MaterialKernels){.data = material->data, .stress = Stress, .energy = Energy, .tangent = Tangent};
  if (plane_stress) PetscCall(MaterialCondenseKernels(material, Thickness, kernels));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A bar with free sides: with x the squared stretch of its sides, the stress across them vanishes for
   mu (x - 1) + lambda/2 (s^2 x^2 - 1) = 0 at the stretch s, and the stress along it is then mu (s^2 - x) / s. */
typedef struct {
  PetscReal stretch;
  PetscReal along, across; /* changes of the squared stretches along the bar, s^2 - 1, and across it, x - 1 */
  PetscReal root;          /* of the discriminant [Pa] */
} Bar;

/* NaN where it is inverted; with a negative lambda the sides have no equilibrium under large stretches: NaN as well */
SIMD_INLINE Bar BarAt(PetscReal lambda, PetscReal mu, PetscReal e)
{
  const PetscReal s = 1 + e, along = e * (2 + e), discriminant = mu * mu + lambda * s * s * (2 * mu + lambda);
  const PetscReal root = TensorDefined(s) * PetscSqrtReal(TensorDefined(discriminant) * discriminant);

  return (Bar){s, along, -lambda * along / (mu + lambda * s * s + root), root};
}

static PetscReal UniaxialEnergy(PetscReal lambda, PetscReal mu, PetscReal e)
{
  const Bar       bar = BarAt(lambda, mu, e);
  const PetscReal t   = bar.across / (1 + PetscSqrtReal(1 + bar.across)); /* strain across the bar */
  const PetscReal q = 2 * e * t + (1 + e) * t * t, j = e + 2 * t + q;
  const PetscReal remainder = PetscAbsReal(j) > SERIES_LIMIT ? j - log1p(j) : LogRemainderSeries(j);

  return mu * (0.5 * e * e + t * t - q) + 0.25 * lambda * j * j + (mu + 0.5 * lambda) * remainder;
}

/* The derivative of x follows from that of its equation, in which lambda s^2 x + mu is the root */
SIMD_CLONES static void Uniaxial(const Isotropic *constants, PetscInt n, const PetscReal strain[], PetscReal stress[], PetscReal tangent[],
                                 PetscReal energy[])
{
  const PetscReal lambda = constants->lambda, mu = constants->mu;

#pragma omp simd
  for (PetscInt i = 0; i < (stress ? n : 0); i++) {
    const Bar bar = BarAt(lambda, mu, strain[i]);

    stress[i] = mu * (bar.along - bar.across) / bar.stretch;
  }
#pragma omp simd
  for (PetscInt i = 0; i < (tangent ? n : 0); i++) {
    const Bar       bar = BarAt(lambda, mu, strain[i]);
    const PetscReal x = 1 + bar.across, s = bar.stretch;

    tangent[i] = mu * (2 + lambda * x * x / bar.root - (bar.along - bar.across) / (s * s));
  }
  for (PetscInt i = 0; i < n && energy; i++) energy[i] = UniaxialEnergy(lambda, mu, strain[i]);
}

static PetscErrorCode MaterialUniaxial_NeoHookean(Material material, PetscInt n, const PetscReal strain[], PetscReal stress[],
                                                  PetscReal tangent[], PetscReal energy[])
{
  PetscFunctionBegin;
  Uniaxial((const Isotropic *)material->data, n, strain, stress, tangent, energy);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_NeoHookean(Material material)
{
  PetscFunctionBegin;
  PetscCall(MaterialCreate_Isotropic(material));
  material->ops->kernels  = MaterialKernels_NeoHookean;
  material->ops->uniaxial = MaterialUniaxial_NeoHookean;
  PetscFunctionReturn(PETSC_SUCCESS);
}
