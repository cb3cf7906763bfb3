/* Linear elasticity: P = lambda tr(H) I + mu (H + H^T), with no regard to rotations; defined for every H. */
#include <impakt/private/isotropic.h>
#include <impakt/private/tensor.h>

SIMD_CLONES static void Stress(const void *data, const PetscReal H[9][8], PetscReal P[9][8])
{
  const PetscReal lambda = ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h = TensorLoad(H, p);
    const PetscReal d = lambda * (h.xx + h.yy + h.zz), xy = mu * (h.xy + h.yx), xz = mu * (h.xz + h.zx), yz = mu * (h.yz + h.zy);

    TensorStore((Tensor){d + 2 * mu * h.xx, xy, xz, xy, d + 2 * mu * h.yy, yz, xz, yz, d + 2 * mu * h.zz}, P, p);
  }
}

SIMD_CLONES static void Energy(const void *data, const PetscReal H[9][8], PetscReal W[8])
{
  const PetscReal lambda = ((const Isotropic *)data)->lambda, mu = ((const Isotropic *)data)->mu;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h     = TensorLoad(H, p);
    const PetscReal trace = h.xx + h.yy + h.zz, xy = h.xy + h.yx, xz = h.xz + h.zx, yz = h.yz + h.zy;

    W[p] = 0.5 * lambda * trace * trace + mu * (h.xx * h.xx + h.yy * h.yy + h.zz * h.zz + 0.5 * (xy * xy + xz * xz + yz * yz));
  }
}

/* Of the first `dim` rows and columns; zero elsewhere */
static void FillTangent(PetscReal lambda, PetscReal mu, int dim, PetscReal tangent[81])
{
  for (int i = 0; i < 81; i++) tangent[i] = 0;
  for (int i = 0; i < dim; i++)
    for (int j = 0; j < dim; j++) {
      tangent[9 * (3 * i + i) + 3 * j + j] += lambda;
      tangent[9 * (3 * i + j) + 3 * i + j] += mu;
      tangent[9 * (3 * i + j) + 3 * j + i] += mu;
    }
}

static void Tangent(const void *data, const PetscReal H[9], PetscReal tangent[81])
{
  (void)H;
  FillTangent(((const Isotropic *)data)->lambda, ((const Isotropic *)data)->mu, 3, tangent);
}

SIMD_CLONES static void PlaneStress(const void *data, const PetscReal H[9][8], PetscReal P[9][8])
{
  const PetscReal lambda = ((const Isotropic *)data)->plane_lambda, mu = ((const Isotropic *)data)->mu;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h = TensorLoad(H, p);
    const PetscReal d = lambda * (h.xx + h.yy), xy = mu * (h.xy + h.yx);

    TensorStore((Tensor){d + 2 * mu * h.xx, xy, 0, xy, d + 2 * mu * h.yy, 0, 0, 0, 0}, P, p);
  }
}

SIMD_CLONES static void PlaneEnergy(const void *data, const PetscReal H[9][8], PetscReal W[8])
{
  const PetscReal lambda = ((const Isotropic *)data)->plane_lambda, mu = ((const Isotropic *)data)->mu;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const Tensor    h     = TensorLoad(H, p);
    const PetscReal trace = h.xx + h.yy, xy = h.xy + h.yx;

    W[p] = 0.5 * lambda * trace * trace + mu * (h.xx * h.xx + h.yy * h.yy + 0.5 * xy * xy);
  }
}

static void PlaneTangent(const void *data, const PetscReal H[9], PetscReal tangent[81])
{
  (void)H;
  FillTangent(((const Isotropic *)data)->plane_lambda, ((const Isotropic *)data)->mu, 2, tangent);
}

static PetscErrorCode MaterialKernels_LinearElastic(Material material, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  if (plane_stress)
    *kernels = (MaterialKernels){.data = material->data, .stress = PlaneStress, .energy = PlaneEnergy, .tangent = PlaneTangent};
  else *kernels = (MaterialKernels){.data = material->data, .stress = Stress, .energy = Energy, .tangent = Tangent};
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialUniaxial_LinearElastic(Material material, PetscInt n, const PetscReal strain[], PetscReal stress[],
                                                     PetscReal tangent[], PetscReal energy[])
{
  const PetscReal youngs_modulus = ((const Isotropic *)material->data)->youngs_modulus;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n && stress; i++) stress[i] = youngs_modulus * strain[i];
  for (PetscInt i = 0; i < n && tangent; i++) tangent[i] = youngs_modulus;
  for (PetscInt i = 0; i < n && energy; i++) energy[i] = 0.5 * youngs_modulus * strain[i] * strain[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_LinearElastic(Material material)
{
  PetscFunctionBegin;
  PetscCall(MaterialCreate_Isotropic(material));
  material->linear        = PETSC_TRUE;
  material->ops->kernels  = MaterialKernels_LinearElastic;
  material->ops->uniaxial = MaterialUniaxial_LinearElastic;
  PetscFunctionReturn(PETSC_SUCCESS);
}
