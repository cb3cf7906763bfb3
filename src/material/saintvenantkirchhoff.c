/* Saint-Venant-Kirchhoff: W = lambda/2 (tr E)^2 + mu E : E, S = lambda tr(E) I + 2 mu E, P = F S, with the Green-Lagrange strain
   E = (H + H^T + H^T H) / 2 (Ciarlet, Mathematical Elasticity I, 1988, section 3.9). The energy is defined for inverted points too,
   and finite at det F = 0: they are refused all the same. */
#include <impakt/private/isotropic.h>
#include <impakt/private/tensor.h>

SIMD_INLINE Tensor GreenLagrange(Tensor h)
{
  const PetscReal xy = 0.5 * (h.xy + h.yx + h.xx * h.xy + h.yx * h.yy + h.zx * h.zy);
  const PetscReal xz = 0.5 * (h.xz + h.zx + h.xx * h.xz + h.yx * h.yz + h.zx * h.zz);
  const PetscReal yz = 0.5 * (h.yz + h.zy + h.xy * h.xz + h.yy * h.yz + h.zy * h.zz);

  return (Tensor){h.xx + 0.5 * (h.xx * h.xx + h.yx * h.yx + h.zx * h.zx), xy, xz, xy,
                  h.yy + 0.5 * (h.xy * h.xy + h.yy * h.yy + h.zy * h.zy), yz, xz, yz,
                  h.zz + 0.5 * (h.xz * h.xz + h.yz * h.yz + h.zz * h.zz)};
}

SIMD_INLINE PetscReal Defined(Tensor h)
{
  return TensorDefined(1 + TensorTrace(h) + TensorVolumeRemainder(h, TensorCofactor(h)));
}

/* Second Piola-Kirchhoff stress */
SIMD_INLINE Tensor SecondStress(Tensor h, PetscReal lambda, PetscReal mu)
{
  const Tensor    e = GreenLagrange(h);
  const PetscReal d = lambda * TensorTrace(e), xy = 2 * mu * e.xy, xz = 2 * mu * e.xz, yz = 2 * mu * e.yz;

  return (Tensor){d + 2 * mu * e.xx, xy, xz, xy, d + 2 * mu * e.yy, yz, xz, yz, d + 2 * mu * e.zz};
}

SIMD_CLONES static void Stress(const void *data, const PetscReal H[9][8], PetscReal P[9][8])
{
  const PetscReal lambda = ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h = TensorLoad(H, p);
    const PetscReal d = Defined(h);
    const Tensor    s = SecondStress(h, d * lambda, d * mu);

    TensorStore((Tensor){s.xx + h.xx * s.xx + h.xy * s.yx + h.xz * s.zx, s.xy + h.xx * s.xy + h.xy * s.yy + h.xz * s.zy,
                         s.xz + h.xx * s.xz + h.xy * s.yz + h.xz * s.zz, s.yx + h.yx * s.xx + h.yy * s.yx + h.yz * s.zx,
                         s.yy + h.yx * s.xy + h.yy * s.yy + h.yz * s.zy, s.yz + h.yx * s.xz + h.yy * s.yz + h.yz * s.zz,
                         s.zx + h.zx * s.xx + h.zy * s.yx + h.zz * s.zx, s.zy + h.zx * s.xy + h.zy * s.yy + h.zz * s.zy,
                         s.zz + h.zx * s.xz + h.zy * s.yz + h.zz * s.zz},
                P, p);
  }
}

SIMD_CLONES static void Energy(const void *data, const PetscReal H[9][8], PetscReal W[8])
{
  const PetscReal lambda = ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h = TensorLoad(H, p), e = GreenLagrange(h);
    const PetscReal trace = TensorTrace(e);

    W[p] = Defined(h) *
           (0.5 * lambda * trace * trace + mu * (e.xx * e.xx + e.yy * e.yy + e.zz * e.zz + 2 * (e.xy * e.xy + e.xz * e.xz + e.yz * e.yz)));
  }
}

/* dP_ij / dF_kl = delta_ik S_jl + lambda F_ij F_kl + mu (F_il F_kj + (F F^T)_ik delta_jl) */
static void Tangent(const void *data, const PetscReal H[9], PetscReal tangent[81])
{
  const PetscReal lambda = ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu;
  const Tensor    h       = {H[0], H[1], H[2], H[3], H[4], H[5], H[6], H[7], H[8]};
  const PetscReal d       = Defined(h);
  const Tensor    s       = SecondStress(h, lambda, mu);
  const PetscReal F[3][3] = {{1 + h.xx, h.xy, h.xz}, {h.yx, 1 + h.yy, h.yz}, {h.zx, h.zy, 1 + h.zz}};
  const PetscReal S[3][3] = {{s.xx, s.xy, s.xz}, {s.yx, s.yy, s.yz}, {s.zx, s.zy, s.zz}};

  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      const PetscReal left = F[i][0] * F[k][0] + F[i][1] * F[k][1] + F[i][2] * F[k][2];

      for (int j = 0; j < 3; j++)
        for (int l = 0; l < 3; l++)
          tangent[9 * (3 * i + j) + 3 * k + l] = d * ((i == k ? S[j][l] : 0) + lambda * F[i][j] * F[k][l] +
                                                      mu * (F[i][l] * F[k][j] + (j == l ? left : 0)));
    }
}

/* Plane stress: S_zz = 0 gives E_zz from the trace in the plane, and that the stretch across it */
SIMD_CLONES static void Thickness(const void *data, const PetscReal H[9][8], PetscReal Hzz[8])
{
  const PetscReal lambda = ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu, ratio = lambda / (lambda + 2 * mu);

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal xx = H[0][p], xy = H[1][p], yx = H[3][p], yy = H[4][p];
    const PetscReal change = -2 * ratio * (xx + yy + 0.5 * (xx * xx + yx * yx + xy * xy + yy * yy)); /* of the squared stretch */

    Hzz[p] = change / (1 + PetscSqrtReal(TensorDefined(1 + change) * (1 + change)));
  }
}

static PetscErrorCode MaterialKernels_SaintVenantKirchhoff(Material material, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  *kernels = (MaterialKernels){.data = material->data, .stress = Stress, .energy = Energy, .tangent = Tangent};
  if (plane_stress) PetscCall(MaterialCondenseKernels(material, Thickness, kernels));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Green-Lagrange strain along a bar; NaN where it, or the stretch of its sides, would be inverted */
SIMD_INLINE PetscReal UniaxialStrain(PetscReal poissons_ratio, PetscReal e)
{
  const PetscReal E = e + 0.5 * e * e;

  return TensorDefined(1 + e) * TensorDefined(1 - 2 * poissons_ratio * E) * E;
}

SIMD_CLONES static void Uniaxial(const Isotropic *constants, PetscInt n, const PetscReal strain[], PetscReal stress[], PetscReal tangent[],
                                 PetscReal energy[])
{
  const PetscReal modulus = constants->youngs_modulus, nu = constants->poissons_ratio;

#pragma omp simd
  for (PetscInt i = 0; i < (stress ? n : 0); i++) stress[i] = (1 + strain[i]) * modulus * UniaxialStrain(nu, strain[i]);
#pragma omp simd
  for (PetscInt i = 0; i < (tangent ? n : 0); i++)
    tangent[i] = modulus * (UniaxialStrain(nu, strain[i]) + (1 + strain[i]) * (1 + strain[i]));
#pragma omp simd
  for (PetscInt i = 0; i < (energy ? n : 0); i++) energy[i] = 0.5 * modulus * UniaxialStrain(nu, strain[i]) * UniaxialStrain(nu, strain[i]);
}

static PetscErrorCode MaterialUniaxial_SaintVenantKirchhoff(Material material, PetscInt n, const PetscReal strain[], PetscReal stress[],
                                                            PetscReal tangent[], PetscReal energy[])
{
  PetscFunctionBegin;
  Uniaxial((const Isotropic *)material->data, n, strain, stress, tangent, energy);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_SaintVenantKirchhoff(Material material)
{
  PetscFunctionBegin;
  PetscCall(MaterialCreate_Isotropic(material));
  material->ops->kernels  = MaterialKernels_SaintVenantKirchhoff;
  material->ops->uniaxial = MaterialUniaxial_SaintVenantKirchhoff;
  PetscFunctionReturn(PETSC_SUCCESS);
}
