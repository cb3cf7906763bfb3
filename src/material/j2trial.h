/* The elastic part of plasticity at finite strain, in batches of points: the logarithmic strain if nothing flows, and the stress that
   answers to it. Private to j2.c, which has the formulas. */
#pragma once
#include "logarithm.h"
#include "logarithmderivative.h"
#include "plasticpoint.h"
#include <impakt/private/simdmath.h>
#include <math.h>

/* Largest norm of A for the series; beyond, eigenvalues */
#define SERIES_LIMIT 0.2
/* Its terms: (-1)^n / (n + 1) */
#define MAX_TERMS 23
static const PetscReal terms_of_series[MAX_TERMS] = {1,       -1. / 2,  1. / 3,  -1. / 4,  1. / 5,  -1. / 6,  1. / 7,  -1. / 8,
                                                     1. / 9,  -1. / 10, 1. / 11, -1. / 12, 1. / 13, -1. / 14, 1. / 15, -1. / 16,
                                                     1. / 17, -1. / 18, 1. / 19, -1. / 20, 1. / 21, -1. / 22, 1. / 23};

/* The elastic strain of a batch if nothing flows, and what leads there */
typedef struct {
  SimdReal Fe[9];   /* less 1 */
  SimdReal A[6];    /* Fe^T Fe - 1 */
  SimdReal E[6];    /* logarithmic strain */
  SimdReal squares; /* A : A */
} Trial;

/* Fe - 1 = H + G + H G with G = Fp^-1 - 1, and A = Fe + Fe^T - 2 + (Fe - 1)^T (Fe - 1) */
SIMD_INLINE void GetElasticPart(PetscInt part, const PetscReal H[9][8], const PetscReal history[][8], Trial *trial)
{
  SimdVector h[9], g[9], f[9];

  for (PetscInt i = 0; i < 9; i++) {
    h[i] = SymmetricLoad(H[i], part);
    g[i] = SymmetricLoad(history[PLASTIC_DEFORMATION + i], part);
  }
#pragma GCC unroll 3
  for (PetscInt i = 0; i < 3; i++)
#pragma GCC unroll 3
    for (PetscInt j = 0; j < 3; j++) {
      f[3 * i + j] = h[3 * i + j] + g[3 * i + j] + h[3 * i] * g[j] + h[3 * i + 1] * g[3 + j] + h[3 * i + 2] * g[6 + j];
      SimdGetParts(trial->Fe[3 * i + j])[part] = f[3 * i + j];
    }
  {
    const Symmetric a = {2 * f[0] + f[0] * f[0] + f[3] * f[3] + f[6] * f[6],    2 * f[4] + f[1] * f[1] + f[4] * f[4] + f[7] * f[7],
                         2 * f[8] + f[2] * f[2] + f[5] * f[5] + f[8] * f[8],    f[1] + f[3] + f[0] * f[1] + f[3] * f[4] + f[6] * f[7],
                         f[5] + f[7] + f[1] * f[2] + f[4] * f[5] + f[7] * f[8], f[2] + f[6] + f[0] * f[2] + f[3] * f[5] + f[6] * f[8]};

    SymmetricStore(a, trial->A, part);
    SimdGetParts(trial->squares)[part] = SymmetricSquares(a);
  }
}

/* E = 1/2 ln(1 + A) = 1/2 A (1 - A/2 + A^2/3 - ...), so many terms */
SIMD_INLINE void TakeSeries(PetscInt part, PetscInt terms, Trial *trial)
{
  const Symmetric  a = SymmetricGet(trial->A, part), square = SymmetricProduct(a, a);
  const SimdVector first = a.xx + a.yy + a.zz, second = 0.5 * (first * first - (square.xx + square.yy + square.zz));
  const SimdVector third = SymmetricDeterminant(a);
  SimdVector       x = 0 * first, y = x, z = x;

  for (PetscInt n = terms - 1; n >= 0; n--) {
    const SimdVector last = z;

    z = y + first * last;
    y = x - second * last;
    x = third * last + terms_of_series[n];
  }
  SymmetricStore(SymmetricPolynomial(0.5 * third * z, 0.5 * (x - second * z), 0.5 * (y + first * z), a, square), trial->E, part);
}

static void ToMatrix(const PetscReal a[6], PetscReal m[3][3])
{
  m[0][0] = a[0];
  m[1][1] = a[1];
  m[2][2] = a[2];
  m[0][1] = m[1][0] = a[3];
  m[1][2] = m[2][1] = a[4];
  m[0][2] = m[2][0] = a[5];
}

static void FromMatrix(PetscReal m[3][3], PetscReal a[6])
{
  a[0] = m[0][0];
  a[1] = m[1][1];
  a[2] = m[2][2];
  a[3] = m[0][1];
  a[4] = m[1][2];
  a[5] = m[0][2];
}

static void TakeEigenvalues(int p, Trial *trial)
{
  PetscReal    a[6], m[3][3];
  SymmetricLog log;

  for (int i = 0; i < 6; i++) a[i] = trial->A[i][p];
  ToMatrix(a, m);
  SymmetricLogCreate((const PetscReal(*)[3])m, PETSC_FALSE, &log);
  SymmetricLogGet(&log, m);
  FromMatrix(m, a);
  for (int i = 0; i < 6; i++) trial->E[i][p] = 0.5 * a[i];
}

/* Terms after which the series of the logarithm has all its digits */
SIMD_INLINE PetscInt CountTerms(PetscReal norm)
{
  return norm < 1e-3 ? 5 : norm < 0.02 ? 9 : norm < 0.08 ? 14 : MAX_TERMS;
}

SIMD_INLINE void GetTrial(const PetscReal H[9][8], const PetscReal history[][8], Trial *trial)
{
  PetscReal largest = 0;
  PetscInt  terms;

  for (PetscInt part = 0; part < SIMD_PARTS; part++) GetElasticPart(part, H, history, trial);
  for (int p = 0; p < SIMD_WIDTH; p++) largest = PetscMax(largest, trial->squares[p]);
  terms = CountTerms(PetscSqrtReal(PetscMin(largest, SERIES_LIMIT * SERIES_LIMIT)));
  for (PetscInt part = 0; part < SIMD_PARTS; part++) TakeSeries(part, terms, trial);
  if (largest > SERIES_LIMIT * SERIES_LIMIT)
    for (int p = 0; p < SIMD_WIDTH; p++)
      if (trial->squares[p] > SERIES_LIMIT * SERIES_LIMIT) TakeEigenvalues(p, trial);
}

/* Fe and Fp^-1 of one part of a batch */
SIMD_INLINE void LoadParts(PetscInt part, const Trial *trial, const PetscReal history[][8], SimdVector f[9], SimdVector g[9])
{
  for (PetscInt i = 0; i < 9; i++) {
    f[i] = SymmetricLoad(trial->Fe[i], part);
    g[i] = SymmetricLoad(history[PLASTIC_DEFORMATION + i], part);
  }
  for (PetscInt i = 0; i < 9; i += 4) {
    f[i] += 1;
    g[i] += 1;
  }
}

/* P = Fe S Fp^-T where M has the axes of C: Fe^-T M Fp^-T. Returns NaN times P where the point is inverted. */
SIMD_INLINE void StoreStress(PetscInt part, const Trial *trial, const PetscReal history[][8], Symmetric m, PetscReal P[9][8])
{
  SimdVector f[9], c[9], g[9], n[9], determinant, inverse;

  LoadParts(part, trial, history, f, g);
  c[0] = f[4] * f[8] - f[5] * f[7];
  c[1] = f[5] * f[6] - f[3] * f[8];
  c[2] = f[3] * f[7] - f[4] * f[6];
  c[3] = f[2] * f[7] - f[1] * f[8];
  c[4] = f[0] * f[8] - f[2] * f[6];
  c[5] = f[1] * f[6] - f[0] * f[7];
  c[6] = f[1] * f[5] - f[2] * f[4];
  c[7] = f[2] * f[3] - f[0] * f[5];
  c[8] = f[0] * f[4] - f[1] * f[3];

  determinant = f[0] * c[0] + f[1] * c[1] + f[2] * c[2];
  inverse     = SimdSelect((SimdBits)(determinant > 0), 1 / determinant, SimdAll(NAN));
#pragma GCC unroll 3
  for (PetscInt i = 0; i < 3; i++) {
    n[3 * i]     = inverse * (c[3 * i] * m.xx + c[3 * i + 1] * m.xy + c[3 * i + 2] * m.zx);
    n[3 * i + 1] = inverse * (c[3 * i] * m.xy + c[3 * i + 1] * m.yy + c[3 * i + 2] * m.yz);
    n[3 * i + 2] = inverse * (c[3 * i] * m.zx + c[3 * i + 1] * m.yz + c[3 * i + 2] * m.zz);
#pragma GCC unroll 3
    for (PetscInt j = 0; j < 3; j++)
      SimdGetParts(P[3 * i + j])[part] = n[3 * i] * g[3 * j] + n[3 * i + 1] * g[3 * j + 1] + n[3 * i + 2] * g[3 * j + 2];
  }
}

/* NaN where a point is inverted, else 1 */
static PetscReal Defined(PetscReal f[3][3])
{
  return f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) + f[0][1] * (f[1][2] * f[2][0] - f[1][0] * f[2][2]) +
                     f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]) >
                 0
             ? 1
             : NAN;
}

/* P = Fe S Fp^-T with S = D ln(C)[M] for one point */
static void GetStressOfPoint(const SymmetricLog *log, PetscReal f[3][3], PetscReal g[3][3], PetscReal m[3][3], PetscReal P[3][3])
{
  const PetscReal defined = Defined(f);
  PetscReal       S[3][3], half[3][3];

  SymmetricLogApply(log, (const PetscReal(*)[3])m, S);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) half[i][j] = f[i][0] * S[0][j] + f[i][1] * S[1][j] + f[i][2] * S[2][j];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) P[i][j] = defined * (half[i][0] * g[j][0] + half[i][1] * g[j][1] + half[i][2] * g[j][2]);
}

static void GetMatrices(const Trial *trial, const PetscReal history[][8], int p, PetscReal f[3][3], PetscReal g[3][3], PetscReal a[3][3])
{
  PetscReal packed[6];

  for (int i = 0; i < 9; i++) {
    f[i / 3][i % 3] = (i % 4 == 0) + trial->Fe[i][p];
    g[i / 3][i % 3] = (i % 4 == 0) + history[PLASTIC_DEFORMATION + i][p];
  }
  for (int i = 0; i < 6; i++) packed[i] = trial->A[i][p];
  ToMatrix(packed, a);
}

/* P = Fe S Fp^-T with S = D ln(C)[M] where M has axes of its own, as with kinematic hardening */
SIMD_INLINE void StoreTurnedStress(PetscInt part, const Trial *trial, const PetscReal history[][8], Symmetric m, PetscReal norm,
                                   PetscReal P[9][8])
{
  const Symmetric S = SymmetricLogDerivative(SymmetricGet(trial->A, part), m, norm);
  SimdVector      f[9], g[9], n[9], determinant, defined;

  LoadParts(part, trial, history, f, g);
  determinant = f[0] * (f[4] * f[8] - f[5] * f[7]) + f[1] * (f[5] * f[6] - f[3] * f[8]) + f[2] * (f[3] * f[7] - f[4] * f[6]);
  defined     = SimdSelect((SimdBits)(determinant > 0), SimdAll(1), SimdAll(NAN));
#pragma GCC unroll 3
  for (PetscInt i = 0; i < 3; i++) {
    n[3 * i]     = defined * (f[3 * i] * S.xx + f[3 * i + 1] * S.xy + f[3 * i + 2] * S.zx);
    n[3 * i + 1] = defined * (f[3 * i] * S.xy + f[3 * i + 1] * S.yy + f[3 * i + 2] * S.yz);
    n[3 * i + 2] = defined * (f[3 * i] * S.zx + f[3 * i + 1] * S.yz + f[3 * i + 2] * S.zz);
#pragma GCC unroll 3
    for (PetscInt j = 0; j < 3; j++)
      SimdGetParts(P[3 * i + j])[part] = n[3 * i] * g[3 * j] + n[3 * i + 1] * g[3 * j + 1] + n[3 * i + 2] * g[3 * j + 2];
  }
}

/* The same by eigenvalues, of points with too large strains */
static void TurnStressOfPoint(int p, const Trial *trial, const PetscReal history[][8], PetscReal M[6][8], PetscReal P[9][8])
{
  PetscReal    f[3][3], g[3][3], a[3][3], m[3][3], stress[3][3], packed[6];
  SymmetricLog log;

  GetMatrices(trial, history, p, f, g, a);
  for (int i = 0; i < 6; i++) packed[i] = M[i][p];
  ToMatrix(packed, m);
  SymmetricLogCreate((const PetscReal(*)[3])a, PETSC_FALSE, &log);
  GetStressOfPoint(&log, f, g, m, stress);
  for (int i = 0; i < 9; i++) P[i][p] = stress[i / 3][i % 3];
}

SIMD_INLINE void StoreCentredStress(const Trial *trial, const PetscReal history[][8], PetscReal M[6][8], PetscReal P[9][8])
{
  PetscReal largest = 0;

  for (int p = 0; p < SIMD_WIDTH; p++) largest = PetscMax(largest, trial->squares[p]);
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
    StoreTurnedStress(part, trial, history, SymmetricGet(M, part), PetscSqrtReal(largest), P);
  if (largest <= SERIES_LIMIT * SERIES_LIMIT) return;
  for (int p = 0; p < SIMD_WIDTH; p++)
    if (trial->squares[p] > SERIES_LIMIT * SERIES_LIMIT) TurnStressOfPoint(p, trial, history, M, P);
}
