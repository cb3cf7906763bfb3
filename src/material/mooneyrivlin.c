/* Mooney-Rivlin with volumetric and isochoric parts: W = c10 (I1' - 3) + c01 (I2' - 3) + kappa/4 (J^2 - 1 - 2 ln J), I1' = J^(-2/3) I1,
   I2' = J^(-4/3) I2 (Holzapfel, Nonlinear Solid Mechanics, 2000, sections 6.4 and 6.5; the volumetric part: Simo, Taylor, Pister 1985).
   2 (c10 + c01) = mu, so that it agrees with linear elasticity at small strain; c01 = 0 is the isochoric neo-Hookean model.

   Everything is written in H = F - I and y = J^(-1/3) - 1, so that small strains keep their digits. With C = cof H, q = tr C + det H,
   j = J - 1, E = F^T F - I with the invariants e1, e2 and K = J (F - F^-T) = H + H^T + q I + j H - C:
   J dI1'/dF = 2 (1 + y)^2 (K - e1/3 cof F), J dI2'/dF = 2 (1 + y)^4 (2 K + J F (e1 I - E) - (4 e1 + 2 e2)/3 cof F). */
#include <impakt/private/isotropic.h>
#include <impakt/private/tensor.h>
#include <sys/units.h>

/* Up to this |J - 1| Newton's method below reaches round-off in its 4 iterations: from an error of 3e-4 in parts it squares it each time */
#define SERIES_LIMIT 0.2

typedef struct {
  Isotropic constants; /* the first, for the methods that isotropic models share */
  PetscReal share;     /* of c01 in c10 + c01 */
} MooneyRivlin;

/* (1 + j)^(-1/3) - 1 by Newton's method for J (1 + y)^3 = 1, whose residual is written without the 1 */
SIMD_INLINE PetscReal RootSeries(PetscReal j)
{
  PetscReal y = -j * (1. / 3 - j * (2. / 9 - j * (14. / 81)));

  for (int i = 0; i < 4; i++) y -= (1 + y) * (j + (1 + j) * y * (3 + y * (3 + y))) / 3;
  return y;
}

/* J - 1 of each point, and the y of it; both NaN where it is inverted */
SIMD_INLINE void FindRoots(const PetscReal H[9][8], PetscReal change[8], PetscReal root[8])
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h = TensorLoad(H, p);
    const PetscReal j = TensorTrace(h) + TensorVolumeRemainder(h, TensorCofactor(h));

    change[p] = TensorDefined(1 + j) * j;
    root[p]   = RootSeries(change[p]);
  }
  for (int p = 0; p < SIMD_WIDTH; p++) /* rare: not worth a vector root */
    if (PetscAbsReal(change[p]) > SERIES_LIMIT) root[p] = 1 / cbrt(1 + change[p]) - 1;
}

/* F^T F - I */
SIMD_INLINE Tensor TwiceGreen(Tensor h)
{
  const PetscReal xy = h.xy + h.yx + h.xx * h.xy + h.yx * h.yy + h.zx * h.zy, xz = h.xz + h.zx + h.xx * h.xz + h.yx * h.yz + h.zx * h.zz;
  const PetscReal yz = h.yz + h.zy + h.xy * h.xz + h.yy * h.yz + h.zy * h.zz;

  return (Tensor){2 * h.xx + h.xx * h.xx + h.yx * h.yx + h.zx * h.zx, xy, xz, xy,
                  2 * h.yy + h.xy * h.xy + h.yy * h.yy + h.zy * h.zy, yz, xz, yz,
                  2 * h.zz + h.xz * h.xz + h.yz * h.yz + h.zz * h.zz};
}

/* The sum of the principal minors of a symmetric tensor */
SIMD_INLINE PetscReal SecondInvariant(Tensor e)
{
  return e.xx * e.yy + e.yy * e.zz + e.zz * e.xx - e.xy * e.xy - e.xz * e.xz - e.yz * e.yz;
}

SIMD_CLONES static void Stress(const void *data, const PetscReal H[9][8], PetscReal P[9][8])
{
  const MooneyRivlin *model = (const MooneyRivlin *)data;
  const PetscReal     mu = model->constants.mu, c = mu * model->share, b = mu - c; /* twice c01 and c10 */
  const PetscReal     half_kappa = 0.5 * model->constants.lambda + mu / 3;
  SimdReal            change, root;

  FindRoots(H, change, root);
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h = TensorLoad(H, p), C = TensorCofactor(h), E = TwiceGreen(h);
    const PetscReal trace = TensorTrace(h), q = TensorVolumeRemainder(h, C), j = change[p], J = 1 + j, inverse = 1 / J;
    const PetscReal e1 = TensorTrace(E), e2 = SecondInvariant(E), y2 = (1 + root[p]) * (1 + root[p]), y4 = y2 * y2;
    const PetscReal k = inverse * (b * y2 + 2 * c * y4); /* of K */
    const PetscReal m = c * y4;                          /* of F (e1 I - E) */
    /* of cof F = I + tr H I - H^T + C */
    const PetscReal g = inverse * (half_kappa * j * (2 + j) - b * y2 * e1 / 3 - c * y4 * (4 * e1 + 2 * e2) / 3);
    const PetscReal d = k * q + g * (1 + trace), a = k - g; /* of I, of H^T and -C */
    const Tensor    M = {e1 - E.xx, -E.xy, -E.xz, -E.yx, e1 - E.yy, -E.yz, -E.zx, -E.zy, e1 - E.zz};
    const PetscReal n = k * J; /* of H: K has H + j H */

    TensorStore((Tensor){n * h.xx + a * (h.xx - C.xx) + d + m * (M.xx + h.xx * M.xx + h.xy * M.yx + h.xz * M.zx),
                         n * h.xy + a * (h.yx - C.xy) + m * (M.xy + h.xx * M.xy + h.xy * M.yy + h.xz * M.zy),
                         n * h.xz + a * (h.zx - C.xz) + m * (M.xz + h.xx * M.xz + h.xy * M.yz + h.xz * M.zz),
                         n * h.yx + a * (h.xy - C.yx) + m * (M.yx + h.yx * M.xx + h.yy * M.yx + h.yz * M.zx),
                         n * h.yy + a * (h.yy - C.yy) + d + m * (M.yy + h.yx * M.xy + h.yy * M.yy + h.yz * M.zy),
                         n * h.yz + a * (h.zy - C.yz) + m * (M.yz + h.yx * M.xz + h.yy * M.yz + h.yz * M.zz),
                         n * h.zx + a * (h.xz - C.zx) + m * (M.zx + h.zx * M.xx + h.zy * M.yx + h.zz * M.zx),
                         n * h.zy + a * (h.yz - C.zy) + m * (M.zy + h.zx * M.xy + h.zy * M.yy + h.zz * M.zy),
                         n * h.zz + a * (h.zz - C.zz) + d + m * (M.zz + h.zx * M.xz + h.zy * M.yz + h.zz * M.zz)},
                P, p);
  }
}

/* j - ln(1 + j) without cancellation: ln(1 + j) = 2 artanh z with z = j / (2 + j) (Abramowitz and Stegun, 4.1.27), j - 2 z = z j */
SIMD_INLINE PetscReal LogRemainderSeries(PetscReal j)
{
  const PetscReal z = j / (2 + j), x = z * z;
  const PetscReal sum = 1. / 3 + x * (1. / 5 + x * (1. / 7 + x * (1. / 9 + x * (1. / 11 + x * (1. / 13 + x * (1. / 15 + x / 17))))));

  return z * j - 2 * z * x * sum;
}

/* I1' - 3 and I2' - 3 are sums of terms of second order: the first-order ones, 3 ((1 + y)^2 - 1) + 2 j and 3 ((1 + y)^4 - 1) + 4 j, are
   polynomials of y from y^2 on, times J, as j = J (1 - (1 + y)^3) */
SIMD_CLONES static void Energy(const void *data, const PetscReal H[9][8], PetscReal W[8])
{
  const MooneyRivlin *model = (const MooneyRivlin *)data;
  const PetscReal     c01 = 0.5 * model->constants.mu * model->share, c10 = 0.5 * model->constants.mu - c01;
  const PetscReal     kappa = model->constants.lambda + model->constants.mu * 2 / 3;
  SimdReal            change, root, remainder;

  FindRoots(H, change, root);
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) remainder[p] = LogRemainderSeries(change[p]);
  for (int p = 0; p < SIMD_WIDTH; p++)
    if (PetscAbsReal(change[p]) > SERIES_LIMIT) remainder[p] = change[p] - log1p(change[p]);
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h = TensorLoad(H, p), E = TwiceGreen(h);
    const PetscReal q = TensorVolumeRemainder(h, TensorCofactor(h)), j = change[p], J = 1 + j, y = root[p];
    const PetscReal squares = h.xx * h.xx + h.xy * h.xy + h.xz * h.xz + h.yx * h.yx + h.yy * h.yy + h.yz * h.yz + h.zx * h.zx +
                              h.zy * h.zy + h.zz * h.zz;
    const PetscReal e1 = TensorTrace(E), e2 = SecondInvariant(E), s = squares - 2 * q; /* e1 = 2 j + s */
    const PetscReal f = y * (2 + y), g = f * (2 + f);                                  /* (1 + y)^2 - 1, (1 + y)^4 - 1 */
    const PetscReal first  = J * y * y * (15 + y * (25 + y * (15 + 3 * y))) + s + f * e1;
    const PetscReal second = J * y * y * (42 + y * (98 + y * (105 + y * (63 + y * (21 + 3 * y))))) + 2 * s + e2 + g * (2 * e1 + e2);

    W[p] = c10 * first + c01 * second + kappa * (0.25 * j * j + 0.5 * remainder[p]);
  }
}

/* The derivative of the stress in the form 2 b (F - I1/3 G) and so on, with G = F^-T, dG_ij/dF_kl = -G_il G_kj, S = dI2/dF */
static void Tangent(const void *data, const PetscReal H[9], PetscReal tangent[81])
{
  const MooneyRivlin *model = (const MooneyRivlin *)data;
  const PetscReal     c01 = 0.5 * model->constants.mu * model->share, c10 = 0.5 * model->constants.mu - c01;
  const PetscReal     kappa = model->constants.lambda + model->constants.mu * 2 / 3;
  const Tensor        f = {1 + H[0], H[1], H[2], H[3], 1 + H[4], H[5], H[6], H[7], 1 + H[8]}, c = TensorCofactor(f);
  const PetscReal     J = f.xx * c.xx + f.xy * c.xy + f.xz * c.xz, inverse = TensorDefined(J) / J;
  const PetscReal     a = c10 / (cbrt(J) * cbrt(J)), b = c01 / (J * cbrt(J));
  const PetscReal     F[3][3]     = {{f.xx, f.xy, f.xz}, {f.yx, f.yy, f.yz}, {f.zx, f.zy, f.zz}};
  const PetscReal     G[3][3]     = {{inverse * c.xx, inverse * c.xy, inverse * c.xz},
                                     {inverse * c.yx, inverse * c.yy, inverse * c.yz},
                                     {inverse * c.zx, inverse * c.zy, inverse * c.zz}};
  PetscReal           right[3][3] = {{0}}, left[3][3] = {{0}}, S[3][3], I1, I2, squares = 0, GG, across;

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++) {
        right[i][j] += F[k][i] * F[k][j];
        left[i][j] += F[i][k] * F[j][k];
      }
  I1 = right[0][0] + right[1][1] + right[2][2];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      squares += right[i][j] * right[i][j];
      S[i][j] = 2 * I1 * F[i][j];
      for (int k = 0; k < 3; k++) S[i][j] -= 2 * F[i][k] * right[k][j];
    }
  I2     = 0.5 * (I1 * I1 - squares);
  GG     = 4. / 9 * a * I1 + 16. / 9 * b * I2 + kappa * J * J;            /* of G_ij G_kl */
  across = 2. / 3 * a * I1 + 4. / 3 * b * I2 - 0.5 * kappa * (J * J - 1); /* of G_il G_kj */
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) {
          const PetscReal dS = 2 * (2 * F[k][l] * F[i][j] + (i == k && j == l ? I1 : 0) - (i == k ? right[l][j] : 0) - F[i][l] * F[k][j] -
                                    (j == l ? left[i][k] : 0));

          tangent[9 * (3 * i + j) + 3 * k + l] = (i == k && j == l ? 2 * a : 0) - 4. / 3 * a * (F[i][j] * G[k][l] + G[i][j] * F[k][l]) +
                                                 b * dS - 4. / 3 * b * (S[i][j] * G[k][l] + G[i][j] * S[k][l]) + GG * G[i][j] * G[k][l] +
                                                 across * G[i][l] * G[k][j];
        }
}

static PetscErrorCode MaterialKernels_MooneyRivlin(Material material, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  *kernels = (MaterialKernels){.data = material->data, .stress = Stress, .energy = Energy, .tangent = Tangent};
  if (plane_stress) PetscCall(MaterialCondenseKernels(material, NULL, kernels));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialUniaxial_MooneyRivlin(Material material, PetscInt n, const PetscReal strain[], PetscReal stress[],
                                                    PetscReal tangent[], PetscReal energy[])
{
  PetscReal       H[9][8], P[9][8], W[8], A[81];
  MaterialKernels kernels;

  PetscFunctionBegin;
  PetscCall(MaterialKernels_MooneyRivlin(material, PETSC_FALSE, &kernels));
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal defined = PetscIsNanReal(MaterialFindSides(&kernels, strain[i], H, P, A)) ? NAN : 1;

    if (energy) Energy(material->data, H, W);
    if (stress) stress[i] = defined * P[0][0];
    if (tangent) tangent[i] = defined * (A[0] - 2 * A[4] * A[36] / (A[40] + A[44]));
    if (energy) energy[i] = defined * W[0];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialSetFromOptions_MooneyRivlin(Material material)
{
  PetscReal *share = &((MooneyRivlin *)material->data)->share;

  PetscFunctionBegin;
  PetscCall(MaterialSetFromOptions_Isotropic(material));
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsReal("-mooney_rivlin_share", "Share of c01 in c10 + c01", "MaterialSetFromOptions", *share, share, NULL));
  PetscOptionsEnd();
  PetscCheck(*share >= 0 && *share <= 1, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%smooney_rivlin_share: the share of c01 in c10 + c01 is %g; it must lie between 0 and 1",
             ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "", (double)*share);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialView_MooneyRivlin(Material material, PetscViewer viewer)
{
  const MooneyRivlin *model = (const MooneyRivlin *)material->data;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  Young's modulus %g%s, Poisson's ratio %g, share of c01 %g\n",
                                   (double)model->constants.youngs_modulus, UnitsOf((PetscObject)material, UNIT_STRESS),
                                   (double)model->constants.poissons_ratio, (double)model->share));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_MooneyRivlin(Material material)
{
  MooneyRivlin *model;

  PetscFunctionBegin;
  PetscCall(PetscNew(&model));
  PetscCall(MaterialCreate_Isotropic(material));
  model->constants = *(const Isotropic *)material->data;
  PetscCall(PetscFree(material->data));
  material->data                = model;
  material->ops->setfromoptions = MaterialSetFromOptions_MooneyRivlin;
  material->ops->view           = MaterialView_MooneyRivlin;
  material->ops->kernels        = MaterialKernels_MooneyRivlin;
  material->ops->uniaxial       = MaterialUniaxial_MooneyRivlin;
  PetscFunctionReturn(PETSC_SUCCESS);
}
