/* What a mean dilatation does at the points of a batch. A template: DIM, POINTS, and then this.

   J. C. Simo, R. L. Taylor, K. S. Pister, Computer Methods in Applied Mechanics and Engineering 51 (1985): in an element the ratio of
   volumes is constant, theta, the deformed volume over the undeformed one. Materials are given F' = (theta / J)^(1/3) F in place of the
   deformation gradient F with J = det F, and the force is the derivative of the energy that they return. With P' = P(F'), r = (theta /
   J)^(1/3) and pi = P' : F', and with F^-T for the inverse of the transpose, the stress at a point is

     r P' - (pi / 3) F^-T + p J F^-T  with p = sum over the points of w pi / 3, over theta V.

   Of linear materials, for small displacements: the trace of H is replaced by its mean (T. J. R. Hughes, International Journal for
   Numerical Methods in Engineering 15, 1980: B-bar). Where points keep a part of their own volume the share s of the mean, which is less
   than 1, stands with each third (composite.c). */
#include <impakt/private/simd.h>
#include <petscmath.h>

/* Where |theta / J - 1| is larger, the library takes powers; the cube root's series errs by 3e-7 there, Halley's step after it by 1e-20 */
#define SERIES_LIMIT 0.1

/* The components that do not vanish */
#define IN_SPACE(i) (DIM == 3 || (i) == 8 || ((i) < 5 && (i) != 2))

/* What changes F into F' at a point of a batch, and back. In whole, not by parts: compilers can take wider registers for it. */
typedef struct {
  SimdReal j;              /* J - 1 with F as it is; of linear materials the trace of H */
  SimdReal ratio, inverse; /* r, 1 / J */
  SimdReal cofactor[9];    /* J F^-T */
} Dilated;

typedef struct {
  SimdReal volume, change, inverse; /* of all points: undeformed, theta - 1, 1 / theta, which is NaN where the element is inverted */
} Means;

/* J - 1, or of linear materials the trace of H, and the cofactors */
SIMD_INLINE void GetVolume(PetscBool linear, const SimdReal H[9], Dilated *at)
{
  PetscReal(*cofactor)[SIMD_WIDTH] = at->cofactor;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal xx = H[0][p], xy = H[1][p], yx = H[3][p], yy = H[4][p], zz = H[8][p], trace = xx + yy + zz;
    const PetscReal plane = xx * yy - xy * yx;

    if (linear) at->j[p] = trace;
    else if (DIM == 2) {
      at->j[p]       = (xx + yy + plane) * (1 + zz) + zz;
      cofactor[0][p] = (1 + yy) * (1 + zz);
      cofactor[1][p] = -yx * (1 + zz);
      cofactor[3][p] = -xy * (1 + zz);
      cofactor[4][p] = (1 + xx) * (1 + zz);
      cofactor[8][p] = 1 + xx + yy + plane;
    } else {
      const PetscReal xz = H[2][p], yz = H[5][p], zx = H[6][p], zy = H[7][p];
      const PetscReal cxx = yy * zz - yz * zy, cxy = yz * zx - yx * zz, cxz = yx * zy - yy * zx;
      const PetscReal cyy = xx * zz - xz * zx;

      /* from the invariants, which keep the digits of small H */
      at->j[p]       = trace + (cxx + cyy + plane) + (xx * cxx + xy * cxy + xz * cxz);
      cofactor[0][p] = cxx - xx + (1 + trace);
      cofactor[1][p] = cxy - yx;
      cofactor[2][p] = cxz - zx;
      cofactor[3][p] = xz * zy - xy * zz - xy;
      cofactor[4][p] = cyy - yy + (1 + trace);
      cofactor[5][p] = xy * zx - xx * zy - zy;
      cofactor[6][p] = xy * yz - xz * yy - xz;
      cofactor[7][p] = xz * yx - xx * yz - yz;
      cofactor[8][p] = plane - zz + (1 + trace);
    }
  }
}

SIMD_INLINE void GetMeans(PetscBool linear, const SimdReal weights[POINTS], const Dilated at[POINTS], Means *means)
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    PetscReal volume = 0, change = 0;

    for (PetscInt g = 0; g < POINTS; g++) {
      volume += weights[g][p];
      change += weights[g][p] * at[g].j[p];
    }
    means->volume[p]  = volume;
    means->change[p]  = change / volume;
    means->inverse[p] = linear ? 1 : 1 + means->change[p] > 0 ? 1 / (1 + means->change[p]) : NAN;
  }
}

/* (1 + s)^power - 1 where the series is not exact; NaN where 1 + s is not positive. Rare. */
static __attribute__((noinline)) void TakePowers(const SimdReal s, PetscReal power, SimdReal y)
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++)
    if (!(PetscAbsReal(s[p]) <= SERIES_LIMIT)) y[p] = 1 + s[p] > 0 ? expm1(power * log1p(s[p])) : NAN;
}

/* y = r - 1 with theta / J = 1 + s. Cube roots by a series, and Halley's method without its division, of which two terms of a series do */
SIMD_INLINE void FindRatio(PetscReal share, const Means *means, Dilated *at, SimdReal y)
{
  SimdReal  s;
  PetscReal squares = 0;

#pragma omp simd reduction(+ : squares)
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal inverse = 1 / (1 + at->j[p]), of = (means->change[p] - at->j[p]) * inverse;

    if (share == 1) {
      const PetscReal first = of * (1. / 3 - of * (1. / 9 - of * (5. / 81 - of * (10. / 243))));
      const PetscReal rest  = (of - first * (3 + first * (3 + first))) * ((1 + at->j[p]) * means->inverse[p]) * (1. / 3);

      y[p] = first + (1 + first) * rest * (1 + 2 * rest);
    } else {
      PetscReal sum = 1;

      for (int k = 15; k > 1; k--) sum = 1 + sum * of * (share / 3 - (k - 1)) / k;
      y[p] = share / 3 * of * sum;
    }
    at->inverse[p] = inverse;
    s[p]           = of;
    squares += of * of;
  }
  if (!(squares <= SERIES_LIMIT * SERIES_LIMIT)) TakePowers(s, share / 3, y);
}

/* H' in place of H */
SIMD_INLINE void Dilate(PetscBool linear, PetscReal share, const Means *means, SimdReal H[9], Dilated *at)
{
  SimdReal y;

  if (linear) {
#pragma omp simd
    for (int p = 0; p < SIMD_WIDTH; p++)
      for (PetscInt i = 0; i < 9; i += 4) H[i][p] += share / 3 * (means->change[p] - at->j[p]);
    return;
  }
  FindRatio(share, means, at, y);
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    at->ratio[p] = 1 + y[p];
    for (PetscInt i = 0; i < 9; i++)
      if (IN_SPACE(i)) H[i][p] = (i % 4 ? 0 : y[p]) + (1 + y[p]) * H[i][p];
  }
}

/* r P' - (s pi / 3) F^-T in place of P'; s pi / 3 times the weight is added to the pressure */
SIMD_INLINE void Undilate(PetscBool linear, PetscReal share, const SimdReal H[9], const Dilated *at, const SimdReal weight, SimdReal P[9],
                          SimdReal pressure)
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    PetscReal third = P[0][p] + P[4][p] + P[8][p], over_J;

    for (PetscInt i = 0; i < 9 && !linear; i++)
      if (IN_SPACE(i)) third += P[i][p] * H[i][p];
    third *= share / 3;
    pressure[p] += weight[p] * third;
    over_J = linear ? third : third * at->inverse[p];
    for (PetscInt i = 0; i < 9; i++) {
      if (linear && i % 4 == 0) P[i][p] -= third;
      if (!linear && IN_SPACE(i)) P[i][p] = at->ratio[p] * P[i][p] - over_J * at->cofactor[i][p];
    }
  }
}

/* What the mean pressure adds to the stress of a point; `pressure`: times 1 / (theta V) */
SIMD_INLINE void AddPressure(PetscBool linear, const Dilated *at, const SimdReal pressure, SimdReal P[9])
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++)
    for (PetscInt i = 0; i < 9; i++) {
      if (linear && i % 4 == 0) P[i][p] += pressure[p];
      if (!linear && IN_SPACE(i)) P[i][p] += pressure[p] * at->cofactor[i][p];
    }
}

/* dF' = r (dF + s F (d theta / theta - F^-T : dF) / 3), which is how F' moves with the velocity, in place of dF; r F is F' */
SIMD_INLINE void DilateRates(PetscReal share, const SimdReal weights[POINTS], SimdReal H[POINTS][9], const Dilated at[POINTS],
                             const Means *means, SimdReal rate[POINTS][9])
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    PetscReal growth = 0, along[POINTS];

    for (PetscInt g = 0; g < POINTS; g++) {
      along[g] = 0;
      for (PetscInt i = 0; i < 9; i++)
        if (IN_SPACE(i)) along[g] += at[g].cofactor[i][p] * rate[g][i][p];
      growth += weights[g][p] * along[g];
    }
    growth *= means->inverse[p] / means->volume[p];
    for (PetscInt g = 0; g < POINTS; g++) {
      const PetscReal change = share / 3 * (growth - along[g] * at[g].inverse[p]);

      for (PetscInt i = 0; i < 9; i++)
        if (IN_SPACE(i)) rate[g][i][p] = at[g].ratio[p] * rate[g][i][p] + change * ((i % 4 ? 0 : 1) + H[g][i][p]);
    }
  }
}
