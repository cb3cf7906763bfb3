/* The derivative of the logarithm at C = 1 + A in the symmetric direction M, of half a batch of points at once:

     D ln(C)[M] = integral from 0 to 1 of (1 + s A)^-1 M (1 + s A)^-1 ds,

   the derivative of ln(1 + A) = integral of A (1 + s A)^-1, by Gauss and Legendre's rule. The integrand has its pole at s = -1 / a of an
   eigenvalue a of A: with |a| <= 0.2 seven points leave 3e-18 of it, with |a| <= 0.02 four leave 4e-19. */
#pragma once
#include "symmetric.h"

#define FEW_POINTS  4
#define MANY_POINTS 7
/* Largest norm of A for the few */
#define FEW_LIMIT 0.02

/* Points and weights from 0 to 1 (Abramowitz and Stegun, table 25.4) */
static const PetscReal few_points[FEW_POINTS][2]   = {{0.06943184420297371, 0.17392742256872693},
                                                      {0.33000947820757187, 0.32607257743127307},
                                                      {0.66999052179242813, 0.32607257743127307},
                                                      {0.93056815579702629, 0.17392742256872693}};
static const PetscReal many_points[MANY_POINTS][2] = {
    {0.02544604382862074, 0.06474248308443485}, {0.12923440720030278, 0.13985269574463833},
    {0.29707742431130142, 0.19091502525255947}, {0.5, 0.20897959183673469},
    {0.70292257568869858, 0.19091502525255947}, {0.87076559279969722, 0.13985269574463833},
    {0.97455395617137926, 0.06474248308443485}};

/* B M B of symmetric tensors */
SIMD_INLINE Symmetric SymmetricSandwich(Symmetric b, Symmetric m)
{
  const SimdVector xx = b.xx * m.xx + b.xy * m.xy + b.zx * m.zx, xy = b.xx * m.xy + b.xy * m.yy + b.zx * m.yz,
                   xz = b.xx * m.zx + b.xy * m.yz + b.zx * m.zz, yx = b.xy * m.xx + b.yy * m.xy + b.yz * m.zx,
                   yy = b.xy * m.xy + b.yy * m.yy + b.yz * m.yz, yz = b.xy * m.zx + b.yy * m.yz + b.yz * m.zz,
                   zx = b.zx * m.xx + b.yz * m.xy + b.zz * m.zx, zy = b.zx * m.xy + b.yz * m.yy + b.zz * m.yz,
                   zz = b.zx * m.zx + b.yz * m.yz + b.zz * m.zz;

  return (Symmetric){xx * b.xx + xy * b.xy + xz * b.zx, yx * b.xy + yy * b.yy + yz * b.yz, zx * b.zx + zy * b.yz + zz * b.zz,
                     xx * b.xy + xy * b.yy + xz * b.yz, yx * b.zx + yy * b.yz + yz * b.zz, xx * b.zx + xy * b.yz + xz * b.zz};
}

/* `norm`: at least the largest of A in the batch */
SIMD_INLINE Symmetric SymmetricLogDerivative(Symmetric a, Symmetric m, PetscReal norm)
{
  const PetscInt n            = norm <= FEW_LIMIT ? FEW_POINTS : MANY_POINTS;
  const PetscReal(*points)[2] = norm <= FEW_LIMIT ? few_points : many_points;
  Symmetric sum               = {SymmetricAll(0), SymmetricAll(0), SymmetricAll(0), SymmetricAll(0), SymmetricAll(0), SymmetricAll(0)};

  for (PetscInt k = 0; k < n; k++) {
    const PetscReal  s  = points[k][0];
    const SimdVector xx = 1 + s * a.xx, yy = 1 + s * a.yy, zz = 1 + s * a.zz, xy = s * a.xy, yz = s * a.yz, zx = s * a.zx;
    const Symmetric  c = {yy * zz - yz * yz, xx * zz - zx * zx, xx * yy - xy * xy, yz * zx - xy * zz, xy * zx - xx * yz, xy * yz - yy * zx};
    const SimdVector determinant = xx * c.xx + xy * c.xy + zx * c.zx;

    sum = SymmetricAdd(sum, points[k][1] / (determinant * determinant), SymmetricSandwich(c, m));
  }
  return sum;
}
