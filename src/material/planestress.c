/* Plane stress and bars from the kernels of a solid: the stretch that leaves a plane, or sides, free of stress is found first. */
#include <impakt/private/materialimpl.h>
#include <impakt/private/tensor.h>

#define MAX_ITERATIONS 50

/* H_zz at which P_zz of the kernels of a solid vanishes, by Newton's method from no strain across the plane; the rest of the third row and
   column becomes zero. P_zz may fall with the stretch in places, as where a plate of rubber is squeezed to less than about a third of its
   area: so the root is kept between stretches that push and that pull, and halved between. The step after which the next one could not be
   seen is the last; a point without a solution gets NaN. */
void MaterialFindThickness(const MaterialKernels *solid, PetscReal H[9][8])
{
  PetscReal tangent[81], low[8], high[8];
  SimdReal  P[9];
  PetscBool done[8] = {PETSC_FALSE};
  int       left    = 8;

  for (int p = 0; p < 8; p++) {
    H[2][p] = H[5][p] = H[6][p] = H[7][p] = H[8][p] = 0;
    low[p]                                          = -1;
    high[p]                                         = PETSC_INFINITY;
  }
  for (int iteration = 0; iteration < 2 * MAX_ITERATIONS && left; iteration++) {
    (*solid->stress)(solid->data, (const PetscReal(*)[8])H, P);
    for (int p = 0; p < 8; p++) {
      const PetscReal old = H[8][p];
      PetscReal       point[9], size = 0, next;

      if (done[p]) continue;
      for (int i = 0; i < 9; i++) {
        point[i] = H[i][p];
        size     = PetscMax(size, PetscAbsReal(point[i]));
      }
      (*solid->tangent)(solid->data, point, tangent);
      if (P[8][p] > 0) high[p] = old;
      else low[p] = old; /* NaN is no matter: it ends the search of the point */
      next = old - P[8][p] / tangent[80];
      if (PetscAbsReal(next - old) > 1e-9 * size && (next <= low[p] || next >= high[p]))
        next = PetscIsInfReal(high[p]) ? 1 + 2 * old : 0.5 * (low[p] + high[p]);
      /* convergence is quadratic: the error left is the square of this step, relative to the strain. NaN remains what it is. */
      done[p] = PetscNot(PetscAbsReal(next - old) > 1e-9 * size);
      H[8][p] = next;
      if (done[p]) left--;
    }
  }
  for (int p = 0; p < 8; p++)
    if (!done[p]) H[8][p] = NAN;
}

/* A bar with free sides: the strain of its sides at which there is no stress across them, by Newton's method from no strain; NaN where
   there is none. H, stress and tangent of a solid in that state, in all lanes of the former two. */
PetscReal MaterialFindSides(const MaterialKernels *solid, PetscReal strain, PetscReal H[9][8], PetscReal P[9][8], PetscReal tangent[81])
{
  PetscReal point[9] = {strain}, step = PETSC_MAX_REAL;

  for (int iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
    const PetscReal limit = -0.5 * (1 + point[4]); /* not beyond an inverted point */

    for (int i = 0; i < 9; i++)
      for (int p = 0; p < 8; p++) H[i][p] = point[i];
    (*solid->stress)(solid->data, (const PetscReal(*)[8])H, P);
    (*solid->tangent)(solid->data, point, tangent);
    /* convergence is quadratic: what is left is the square of this step, relative to the strain */
    if (PetscAbsReal(step) <= 1e-9 * PetscMax(PetscAbsReal(strain), PetscAbsReal(point[4]))) return point[4];
    step = -P[4][0] / (tangent[40] + tangent[44]);
    if (PetscIsNanReal(step)) return NAN;
    point[4] = point[8] = point[4] + (step < limit ? limit : step);
  }
  return NAN;
}

/* Displacement gradients with plane stress's third row and column. Vectors: narrower stores would hold up the solid kernels' loads. */
SIMD_CLONES static void Complete(const PlaneStressData *plane, const PetscReal H[9][8], PetscReal full[9][8])
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) TensorStore((Tensor){H[0][p], H[1][p], 0, H[3][p], H[4][p], 0, 0, 0, 0}, full, p);
  if (plane->thickness) (*plane->thickness)(plane->solid.data, full, full[8]);
  else MaterialFindThickness(&plane->solid, full);
}

SIMD_CLONES static void Stress(const void *data, const PetscReal H[9][8], PetscReal P[9][8])
{
  const PlaneStressData *plane = (const PlaneStressData *)data;
  SimdReal               full[9];

  Complete(plane, H, full);
  (*plane->solid.stress)(plane->solid.data, full, P);
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) P[8][p] *= 0; /* round-off; NaN stays */
}

static void Energy(const void *data, const PetscReal H[9][8], PetscReal W[8])
{
  const PlaneStressData *plane = (const PlaneStressData *)data;
  SimdReal               full[9];

  Complete(plane, H, full);
  (*plane->solid.energy)(plane->solid.data, full, W);
}

/* Of P_zz = 0: dH_zz = - A_zzkl dH_kl / A_zzzz, put into dP_ij = A_ijkl dH_kl + A_ijzz dH_zz */
static void Tangent(const void *data, const PetscReal H[9], PetscReal tangent[81])
{
  const PlaneStressData *plane       = (const PlaneStressData *)data;
  const int              in_plane[4] = {0, 1, 3, 4};
  PetscReal              full[9][8], point[9], solid[81];

  for (int i = 0; i < 9; i++)
    for (int p = 0; p < 8; p++) full[i][p] = H[i];
  Complete(plane, full, full);
  for (int i = 0; i < 9; i++) point[i] = full[i][0];
  (*plane->solid.tangent)(plane->solid.data, point, solid);
  for (int i = 0; i < 81; i++) tangent[i] = 0;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) {
      const int row = 9 * in_plane[i], column = in_plane[j];

      tangent[row + column] = solid[row + column] - solid[row + 8] * solid[72 + column] / solid[80];
    }
}

/* Makes the kernels of a solid those of plane stress; thickness, unless NULL, gives H_zz for displacement gradients in the plane */
PetscErrorCode MaterialCondenseKernels(Material         material, void (*thickness)(const void *, const PetscReal[9][8], PetscReal[8]),
                                       MaterialKernels *kernels)
{
  PetscFunctionBegin;
  material->plane = (PlaneStressData){*kernels, thickness};
  *kernels        = (MaterialKernels){.data = &material->plane, .stress = Stress, .energy = Energy, .tangent = Tangent};
  PetscFunctionReturn(PETSC_SUCCESS);
}
