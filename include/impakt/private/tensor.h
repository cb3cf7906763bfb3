/* Second-order tensors of one point of a batch, in registers: component by component, so that loops over the points vectorise. */
#pragma once
#include <math.h>
#include <impakt/private/simd.h>

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

SIMD_INLINE PetscReal TensorTrace(Tensor t)
{
  return t.xx + t.yy + t.zz;
}

/* det(T) T^-T, by which also det(T) = T_xx C_xx + T_xy C_xy + T_xz C_xz */
SIMD_INLINE Tensor TensorCofactor(Tensor t)
{
  return (Tensor){t.yy * t.zz - t.yz * t.zy, t.yz * t.zx - t.yx * t.zz, t.yx * t.zy - t.yy * t.zx,
                  t.xz * t.zy - t.xy * t.zz, t.xx * t.zz - t.xz * t.zx, t.xy * t.zx - t.xx * t.zy,
                  t.xy * t.yz - t.xz * t.yy, t.xz * t.yx - t.xx * t.yz, t.xx * t.yy - t.xy * t.yx};
}

/* det(I + T) - 1 - tr T, of second order: from the invariants, so that it keeps its digits however small T is */
SIMD_INLINE PetscReal TensorVolumeRemainder(Tensor t, Tensor cofactor)
{
  return TensorTrace(cofactor) + t.xx * cofactor.xx + t.xy * cofactor.xy + t.xz * cofactor.xz;
}

/* 1 where the volume ratio is positive, NaN where the point is inverted: a factor, for loops without branches */
SIMD_INLINE PetscReal TensorDefined(PetscReal volume_ratio)
{
  return volume_ratio > 0 ? 1 : NAN;
}
