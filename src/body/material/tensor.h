/* Second-order tensors of one point of a batch, in registers: component by component, so that loops over the points vectorise. */
#pragma once
#include <sys/simd.h>

typedef struct {
  PetscReal xx, xy, xz, yx, yy, yz, zx, zy, zz;
} Tensor;

SIMD_INLINE Tensor TensorLoad(const PetscReal a[9][SIMD_WIDTH], int p)
{
  return (Tensor){a[0][p], a[1][p], a[2][p], a[3][p], a[4][p], a[5][p], a[6][p], a[7][p], a[8][p]};
}

SIMD_INLINE void TensorStore(Tensor t, PetscReal a[9][SIMD_WIDTH], int p)
{
  a[0][p] = t.xx;
  a[1][p] = t.xy;
  a[2][p] = t.xz;
  a[3][p] = t.yx;
  a[4][p] = t.yy;
  a[5][p] = t.yz;
  a[6][p] = t.zx;
  a[7][p] = t.zy;
  a[8][p] = t.zz;
}
