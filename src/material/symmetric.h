/* Symmetric tensors of half a batch of points, in registers. */
#pragma once
#include <impakt/private/simd.h>

/* All of it is inlined: how vectors would be returned does not matter */
#if defined(__GNUC__) && !defined(__clang__)
#  pragma GCC diagnostic ignored "-Wpsabi"
#endif

typedef struct {
  SimdVector xx, yy, zz, xy, yz, zx;
} Symmetric;

SIMD_INLINE SimdVector SymmetricLoad(const PetscReal values[8], PetscInt part)
{
  return ((const SimdVector *)values)[part];
}

SIMD_INLINE Symmetric SymmetricGet(const PetscReal a[][8], PetscInt part)
{
  return (Symmetric){SymmetricLoad(a[0], part), SymmetricLoad(a[1], part), SymmetricLoad(a[2], part),
                     SymmetricLoad(a[3], part), SymmetricLoad(a[4], part), SymmetricLoad(a[5], part)};
}

SIMD_INLINE void SymmetricStore(Symmetric t, PetscReal a[][8], PetscInt part)
{
  SimdGetParts(a[0])[part] = t.xx;
  SimdGetParts(a[1])[part] = t.yy;
  SimdGetParts(a[2])[part] = t.zz;
  SimdGetParts(a[3])[part] = t.xy;
  SimdGetParts(a[4])[part] = t.yz;
  SimdGetParts(a[5])[part] = t.zx;
}

/* Of two that have the same axes, so that the product is symmetric too */
SIMD_INLINE Symmetric SymmetricProduct(Symmetric a, Symmetric b)
{
  return (Symmetric){a.xx * b.xx + a.xy * b.xy + a.zx * b.zx, a.xy * b.xy + a.yy * b.yy + a.yz * b.yz,
                     a.zx * b.zx + a.yz * b.yz + a.zz * b.zz, a.xx * b.xy + a.xy * b.yy + a.zx * b.yz,
                     a.xy * b.zx + a.yy * b.yz + a.yz * b.zz, a.xx * b.zx + a.xy * b.yz + a.zx * b.zz};
}

SIMD_INLINE SimdVector SymmetricDeterminant(Symmetric a)
{
  return a.xx * (a.yy * a.zz - a.yz * a.yz) + a.xy * (a.yz * a.zx - a.xy * a.zz) + a.zx * (a.xy * a.yz - a.yy * a.zx);
}

SIMD_INLINE SimdVector SymmetricContract(Symmetric a, Symmetric b)
{
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + 2 * (a.xy * b.xy + a.yz * b.yz + a.zx * b.zx);
}

SIMD_INLINE SimdVector SymmetricSquares(Symmetric a)
{
  return SymmetricContract(a, a);
}

/* a + factor b */
SIMD_INLINE Symmetric SymmetricAdd(Symmetric a, SimdVector factor, Symmetric b)
{
  return (Symmetric){a.xx + factor * b.xx, a.yy + factor * b.yy, a.zz + factor * b.zz,
                     a.xy + factor * b.xy, a.yz + factor * b.yz, a.zx + factor * b.zx};
}

/* The same number for all points */
SIMD_INLINE SimdVector SymmetricAll(PetscReal number)
{
  return (SimdVector){0} + number;
}

/* x 1 + y a + z b */
SIMD_INLINE Symmetric SymmetricPolynomial(SimdVector x, SimdVector y, SimdVector z, Symmetric a, Symmetric b)
{
  return (Symmetric){x + y * a.xx + z * b.xx, x + y * a.yy + z * b.yy, x + y * a.zz + z * b.zz,
                     y * a.xy + z * b.xy,     y * a.yz + z * b.yz,     y * a.zx + z * b.zx};
}
