/* What is plastic in elements whose points are those of their shape: GetPlastic() for the operations of solidops.h */
/* Plastic work of all elements but for the weight of a point, and the mean equivalent plastic strain of each */
SIMD_CLONES static void GetPlastic(const Solid *solid, PetscInt count, const PetscInt connectivity[], PetscReal *work, PetscReal strain[])
{
  const ElementHistory *history = solid->history;
  Gradients             at      = {0};

  *work = 0;
  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt n = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES];
    SimdReal       sum = {0}, volume = {0};

    GetModes(connectivity, first, count, solid->coordinates, X);
    for (PetscInt g = 0; g < POINTS; g++) {
      const PetscReal *point = history->start + SolidHistoryOffset(history, first, g);

      GetGradients(X, X, points[g], &at);
      for (PetscInt p = 0; p < n; p++) {
        *work += at.determinant[p] * point[solid->kernels.plastic_work * SIMD_WIDTH + p];
        sum[p] += at.determinant[p] * point[solid->kernels.plastic_strain * SIMD_WIDTH + p];
        volume[p] += at.determinant[p];
      }
    }
    for (PetscInt p = 0; p < n && strain; p++) strain[first + p] = sum[p] / volume[p];
  }
}
