/* What a mean dilatation takes at each point: r = (theta / J)^(1/3), see meandilatationloops.h. */
#pragma once
#include <impakt/private/simd.h>
#include <petscmath.h>

/* Where |theta / J - 1| is larger, the cube root is taken by the library; the series below has an error of 3e-7 there, and the step of
   Halley's method after that one of 1e-20 */
#define SERIES_LIMIT 0.1

/* What changes F into F' at a point of a batch, and back. In whole rather than by parts, as materials do it: compilers take registers twice
   as wide for it where there are some. */
typedef struct {
  SimdReal change, inverse_theta; /* of all points: theta - 1, 1 / theta; NaN where the element is inverted */
} Means;

typedef struct {
  SimdReal ratio, inverse; /* r, 1 / J */
  SimdReal cofactor[9];    /* J F^-T; in two dimensions without its third row and column */
} Dilated;

/* (1 + s)^(1/3) - 1 where the series is not exact; NaN where 1 + s is not positive. Rare. */
static __attribute__((noinline)) void TakeCubeRoots(const SimdReal s, SimdReal y)
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++)
    if (!(PetscAbsReal(s[p]) <= SERIES_LIMIT)) y[p] = 1 + s[p] > 0 ? cbrt(1 + s[p]) - 1 : NAN;
}

/* y = r - 1 for theta / J = 1 + s: by a series, and Halley's method without its division, for what is left is so small that two terms of a
   geometric series do */
SIMD_INLINE void FindRatio(const Means *means, const SimdReal j, Dilated *dilated, SimdReal y)
{
  SimdReal  s;
  PetscReal squares = 0;

#pragma omp simd reduction(+ : squares)
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal inverse = 1 / (1 + j[p]), of = (means->change[p] - j[p]) * inverse;
    const PetscReal first = of * (1. / 3 - of * (1. / 9 - of * (5. / 81 - of * (10. / 243))));
    const PetscReal rest  = (of - first * (3 + first * (3 + first))) * ((1 + j[p]) * means->inverse_theta[p]) * (1. / 3);

    dilated->inverse[p] = inverse;
    s[p]                = of;
    y[p]                = first + (1 + first) * rest * (1 + 2 * rest);
    squares += of * of;
  }
  if (!(squares <= SERIES_LIMIT * SERIES_LIMIT)) TakeCubeRoots(s, y);
}
