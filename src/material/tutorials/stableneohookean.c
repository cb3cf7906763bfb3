/*
   A material of one's own: the stable neo-Hookean solid of Smith, de Goes and Kim (2018), without its logarithm,
     W = mu/2 (F:F - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2,   P = mu F + q cof F,   q = (lambda + mu) (J - 1) - mu,
   which is defined for inverted elements too. Stress, energy and tangent at given displacement gradients H = F - I are all that elements
   ask for; the constants with their options, Young's modulus and Poisson's ratio, are those that isotropic models share.

   A block with free sides that is pulled to the stretch s has J = 1 + mu / (lambda + mu) (1 - 1/s) and the stress mu (s^2 / J - 1 / s).
   Made with the installed library by: cc stableneohookean.c -o stableneohookean $(pkg-config --cflags --libs impakt)
*/
#include <impakt.h>
#include <impakt/private/isotropic.h>

/* F and its cofactor at point p of a batch, in which H[3 i + j][p] = dui/dXj; returns J - 1 */
static PetscReal Deform(const PetscReal H[9][8], int p, PetscReal F[9], PetscReal cof[9])
{
  for (int i = 0; i < 9; i++) F[i] = H[i][p] + (i % 4 == 0);
  for (int i = 0; i < 9; i++) {
    const int a = 3 * ((i / 3 + 1) % 3), b = 3 * ((i / 3 + 2) % 3), c = (i + 1) % 3, d = (i + 2) % 3;

    cof[i] = F[a + c] * F[b + d] - F[a + d] * F[b + c];
  }
  return F[0] * cof[0] + F[1] * cof[1] + F[2] * cof[2] - 1;
}

static void Stress(const void *data, const PetscReal H[9][8], PetscReal P[9][8])
{
  const PetscReal mu = ((const Isotropic *)data)->mu, bulk = ((const Isotropic *)data)->lambda + mu;

  for (int p = 0; p < 8; p++) {
    PetscReal       F[9], cof[9];
    const PetscReal q = bulk * Deform(H, p, F, cof) - mu;

    for (int i = 0; i < 9; i++) P[i][p] = mu * F[i] + q * cof[i];
  }
}

static void Energy(const void *data, const PetscReal H[9][8], PetscReal W[8])
{
  const PetscReal mu = ((const Isotropic *)data)->mu, bulk = ((const Isotropic *)data)->lambda + mu;

  for (int p = 0; p < 8; p++) {
    PetscReal       F[9], cof[9];
    const PetscReal growth = Deform(H, p, F, cof);

    W[p] = (0.5 * bulk * growth - mu) * growth - 1.5 * mu;
    for (int i = 0; i < 9; i++) W[p] += 0.5 * mu * F[i] * F[i];
  }
}

/* dP_ij / dF_kl, of which the last part is q d(cof F)_ij / dF_kl */
static void Tangent(const void *data, const PetscReal H[9], PetscReal tangent[81])
{
  const PetscReal mu = ((const Isotropic *)data)->mu, bulk = ((const Isotropic *)data)->lambda + mu;
  PetscReal       batch[9][8] = {{0}}, F[9], cof[9], q;

  for (int i = 0; i < 9; i++) batch[i][0] = H[i];
  q = bulk * Deform((const PetscReal(*)[8])batch, 0, F, cof) - mu;
  for (int n = 0; n < 81; n++) {
    const int i = n / 27, j = n / 9 % 3, k = n / 3 % 3, l = n % 3;

    tangent[n] = (n / 9 == n % 9 ? mu : 0) + bulk * cof[n / 9] * cof[n % 9];
    if (i != k && j != l) tangent[n] += ((k - i + 3) % 3 == (l - j + 3) % 3 ? q : -q) * F[3 * (3 - i - k) + 3 - j - l];
  }
}

static PetscErrorCode MaterialKernels_Stable(Material material, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  *kernels = (MaterialKernels){.data = material->data, .stress = Stress, .energy = Energy, .tangent = Tangent};
  if (plane_stress) PetscCall(MaterialCondenseKernels(material, NULL, kernels)); /* the thickness by Newton's method */
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialCreate_Stable(Material material)
{
  PetscFunctionBegin;
  PetscCall(MaterialCreate_Isotropic(material));
  material->ops->kernels = MaterialKernels_Stable;
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  const Body *block;
  PetscReal   stress[6];
  Controller  controller;

  PetscCall(ImpaktInitialize(&argc, &argv));
  PetscCall(MaterialRegister("stable_neo_hookean", MaterialCreate_Stable));
  PetscCall(ControllerCreate(PETSC_COMM_WORLD, &controller));
  PetscCall(ControllerSetFromOptions(controller)); /* -options_file stableneohookean.opts, beside this file */
  PetscCall(ControllerSolve(controller));
  PetscCall(ControllerGetBodies(controller, NULL, &block));
  PetscCall(BodyComputeStress(block[0], stress)); /* of its one element: xx yy zz xy yz xz */
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "stress %.12g Pa along, %.3g Pa across\n", (double)stress[0], (double)stress[1]));
  PetscCall(ControllerDestroy(&controller));
  PetscCall(ImpaktFinalize());
  return 0;
}
