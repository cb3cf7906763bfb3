/* Plasticity of metals at finite strain: F = Fe Fp, elasticity by Hencky's energy of the logarithmic strain E = 1/2 ln(Fe^T Fe),
   W = lambda/2 (tr E)^2 + mu E : E, von Mises' yield condition for the stress M = lambda tr(E) 1 + 2 mu E that works on it, and the
   exponential map, by which the step is a radial return in logarithmic strains (A. L. Eterovic, K.-J. Bathe, 1990; J. C. Simo, 1992; M.
   Ortiz, L. Stainier, 1999). With the plastic deformation at the start of the step, Fe = F Fp^-1 and C = Fe^T Fe,

     P = Fe S Fp^-T,  S = D ln(C)[M],

   which is C^-1 M where M has the axes of C, as without kinematic hardening. Plastic flow by the increment D turns Fp^-1 into Fp^-1
   exp(-D).

   E comes from C - 1 = A, which has the digits of small strains, by the series of the logarithm, a polynomial in A that becomes one of
   degree 2 by Cayley and Hamilton's A^3 = I A^2 - II A + III. Where strains are too large for the series it comes from eigenvalues. */
#include "j2trial.h"

/* Largest norm of a plastic increment for the series of the exponential; beyond, that of a half of it, or a quarter, is squared */
#define EXPONENT_LIMIT 0.1
#define EXPONENT_TERMS 9
#define MAX_HALVES     40

/* exp(-D) - 1 of a batch: the series of a small part of D, squared as often as it takes */
SIMD_INLINE Symmetric ExponentialLess1(Symmetric d, PetscInt halves)
{
  const PetscReal  scale  = -1 / PetscPowRealInt(2, (int)halves);
  const Symmetric  x      = {scale * d.xx, scale * d.yy, scale * d.zz, scale * d.xy, scale * d.yz, scale * d.zx};
  const Symmetric  square = SymmetricProduct(x, x);
  const SimdVector second = -0.5 * (square.xx + square.yy + square.zz), third = SymmetricDeterminant(x); /* x has no trace */
  SimdVector       a = 0 * second, b = a, c = a;
  PetscReal        factorial = 1;
  Symmetric        sum;

  for (PetscInt n = 2; n <= EXPONENT_TERMS; n++) factorial *= (PetscReal)n;
  for (PetscInt n = EXPONENT_TERMS; n > 0; n--) {
    const SimdVector last = c;

    c = b;
    b = a - second * last;
    a = third * last + 1 / factorial;
    factorial /= (PetscReal)n;
  }
  sum = SymmetricPolynomial(third * c, a - second * c, b, x, square);
  for (PetscInt k = 0; k < halves; k++) {
    const Symmetric once = sum;

    sum = SymmetricAdd(SymmetricProduct(once, once), SymmetricAll(2), once);
  }
  return sum;
}

/* Fp^-1 exp(-D), works, stress and centre at the end of the step; `ratio`: of D to the stress relative to the centre; m: that stress */
SIMD_INLINE void Flow(const Plastic *plastic, PetscInt part, PetscInt halves, Symmetric m, Symmetric relative, SimdVector ratio,
                      SimdVector work, const PetscReal start[][8], PetscReal end[][8])
{
  const Symmetric d = {ratio * relative.xx, ratio * relative.yy, ratio * relative.zz,
                       ratio * relative.xy, ratio * relative.yz, ratio * relative.zx};
  const Symmetric x = ExponentialLess1(d, halves);
  SimdVector      g[9];

  for (PetscInt i = 0; i < 9; i++) g[i] = SymmetricLoad(start[PLASTIC_DEFORMATION + i], part);
#pragma GCC unroll 3
  for (PetscInt i = 0; i < 3; i++) {
    SimdVector *row = &g[3 * i], a = row[0] + (i == 0 ? 1 : 0), b = row[1] + (i == 1 ? 1 : 0), c = row[2] + (i == 2 ? 1 : 0);

    SimdGetParts(end[PLASTIC_DEFORMATION + 3 * i])[part]     = row[0] + a * x.xx + b * x.xy + c * x.zx;
    SimdGetParts(end[PLASTIC_DEFORMATION + 3 * i + 1])[part] = row[1] + a * x.xy + b * x.yy + c * x.yz;
    SimdGetParts(end[PLASTIC_DEFORMATION + 3 * i + 2])[part] = row[2] + a * x.zx + b * x.yz + c * x.zz;
  }
  if (plastic->kinematic > 0) {
    const PetscReal modulus = 2 * plastic->kinematic / 3;
    const Symmetric centre  = SymmetricGet(start + PLASTIC_CENTRE, part);

    SymmetricStore(SymmetricAdd(centre, SymmetricAll(modulus), d), end + PLASTIC_CENTRE, part);
    work += SymmetricContract(SymmetricAdd(centre, SymmetricAll(0.5 * modulus), d), d);
  }
  SimdGetParts(end[PLASTIC_WORK])[part] = SymmetricLoad(start[PLASTIC_WORK], part) + work;
  PlasticStoreStress(m, relative, ratio, start, end, part);
}

SIMD_CLONES static void Advance(const void *data, PetscReal dt, const PetscReal H[9][8], const PetscReal start[][8], PetscReal end[][8],
                                PetscReal P[9][8])
{
  const Plastic *plastic = (const Plastic *)data;
  const PetscInt size    = plastic->kinematic > 0 ? PLASTIC_SIZE_CENTRED : PLASTIC_SIZE;
  PetscReal      largest = 0;
  PetscInt       halves  = 0;
  Trial          trial;
  PlasticFlow    flow;
  SimdReal       M[6], relative[6], q, ratio;

  GetTrial(H, start, &trial);
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const Symmetric m = PlasticMandel(&plastic->elastic, SymmetricGet(trial.E, part)), s = PlasticRelative(plastic, m, start, part);

    SymmetricStore(m, M, part);
    SymmetricStore(s, relative, part);
    SimdGetParts(q)[part] = 1.5 * SymmetricSquares(s);
  }
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) q[p] = PetscSqrtReal(q[p]);
  PlasticFindFlow(plastic, dt, q, start, &flow);
  for (int p = 0; p < SIMD_WIDTH; p++) {
    ratio[p] = flow.strain[p] != 0 ? 1.5 * flow.strain[p] / q[p] : 0;
    largest  = PetscMax(largest, flow.strain[p]);
  }
  for (int p = 0; p < SIMD_WIDTH; p++) largest = isnan(flow.strain[p]) ? 1 : largest;
  while (1.25 * largest > EXPONENT_LIMIT * PetscPowRealInt(2, (int)halves) && halves < MAX_HALVES) halves++;
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const Symmetric s = SymmetricGet(relative, part);

    SymmetricStore(SymmetricAdd(SymmetricGet(M, part), -2 * plastic->elastic.mu * SimdGetParts(ratio)[part], s), M, part);
  }
  if (plastic->kinematic > 0) StoreCentredStress(&trial, start, M, P);
  else
    for (PetscInt part = 0; part < SIMD_PARTS; part++) StoreStress(part, &trial, start, SymmetricGet(M, part), P);
  if (!end) return;
  if (largest == 0) {
    for (PetscInt i = 0; i < size; i++)
      for (int p = 0; p < SIMD_WIDTH; p++) end[i][p] = start[i][p];
    for (PetscInt part = 0; part < SIMD_PARTS; part++) SymmetricStore(SymmetricGet(M, part), end + PLASTIC_STRESS, part);
    return;
  }
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
    Flow(plastic, part, halves, SymmetricGet(M, part), SymmetricGet(relative, part), SimdGetParts(ratio)[part],
         SimdGetParts(flow.work)[part], start, end);
  for (int p = 0; p < SIMD_WIDTH; p++) {
    end[PLASTIC_STRAIN][p]   = start[PLASTIC_STRAIN][p] + flow.strain[p];
    end[PLASTIC_STRENGTH][p] = flow.strength[p];
  }
}

/* Stress, unless it is not wanted, and stored energy while nothing flows */
SIMD_CLONES static void Hold(const void *data, const PetscReal H[9][8], const PetscReal now[][8], PetscReal W[8], PetscReal P[9][8])
{
  const Plastic *plastic = (const Plastic *)data;
  Trial          trial;

  GetTrial(H, now, &trial);
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const Symmetric  e     = SymmetricGet(trial.E, part);
    const SimdVector trace = e.xx + e.yy + e.zz;

    if (P) StoreStress(part, &trial, now, PlasticMandel(&plastic->elastic, e), P);
    SimdGetParts(W)[part] = 0.5 * plastic->elastic.lambda * trace * trace + plastic->elastic.mu * SymmetricSquares(e);
  }
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal xx = 1 + trial.Fe[0][p], yy = 1 + trial.Fe[4][p], zz = 1 + trial.Fe[8][p];

    W[p] *= xx * (yy * zz - trial.Fe[5][p] * trial.Fe[7][p]) + trial.Fe[1][p] * (trial.Fe[5][p] * trial.Fe[6][p] - trial.Fe[3][p] * zz) +
                        trial.Fe[2][p] * (trial.Fe[3][p] * trial.Fe[7][p] - yy * trial.Fe[6][p]) >
                    0
                ? 1
                : NAN;
  }
}

/* dM / dE of the step: q and the slope are those of PlasticFindFlow() */
static void ReturnTangent(const Plastic *plastic, const PetscReal relative[6], PetscReal q, PetscReal growth, PetscReal slope,
                          PetscReal dE[3][3], PetscReal dM[3][3])
{
  const PetscReal lambda = plastic->elastic.lambda, mu = plastic->elastic.mu, trace = dE[0][0] + dE[1][1] + dE[2][2];
  const PetscReal keep = growth != 0 ? 1 - 3 * mu * growth / q : 1;
  PetscReal       s[3][3], along = 0;

  ToMatrix(relative, s);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) along += s[i][j] * dE[i][j];
  /* the direction of flow is s / sqrt(s : s), and 3/2 s : s = q^2 */
  along *= growth != 0 ? 9 * mu * mu * (growth / q - 1 / (3 * mu + plastic->kinematic + slope)) / (q * q) : 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      dM[i][j] = (i == j ? (lambda + 2 * mu / 3) * trace : 0) + 2 * mu * keep * (dE[i][j] - (i == j ? trace / 3 : 0)) + along * s[i][j];
}

/* dP = dFe S Fp^-T + Fe dS Fp^-T for a unit change of each entry of H */
static void AdvanceTangent(const void *data, PetscReal dt, const PetscReal H[9], const PetscReal start[], PetscReal tangent[81])
{
  const Plastic *plastic = (const Plastic *)data;
  const PetscInt size    = PlasticGetSize(plastic);
  SimdReal       batch[9], history[PLASTIC_SIZE_CENTRED], M[6], rel[6], q;
  PetscReal      f[3][3], g[3][3], a[3][3], m[3][3], S[3][3], relative[6], packed[6], defined;
  Trial          trial;
  PlasticFlow    flow;
  SymmetricLog   log;

  for (int p = 0; p < SIMD_WIDTH; p++) {
    for (int i = 0; i < 9; i++) batch[i][p] = H[i];
    for (PetscInt i = 0; i < size; i++) history[i][p] = start ? start[i] : 0;
  }
  GetTrial((const PetscReal(*)[8])batch, (const PetscReal(*)[8])history, &trial);
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const Symmetric mandel = PlasticMandel(&plastic->elastic, SymmetricGet(trial.E, part)),
                    s      = PlasticRelative(plastic, mandel, (const PetscReal(*)[8])history, part);

    SymmetricStore(mandel, M, part);
    SymmetricStore(s, rel, part);
    SimdGetParts(q)[part] = 1.5 * SymmetricSquares(s);
  }
  for (int p = 0; p < SIMD_WIDTH; p++) q[p] = PetscSqrtReal(q[p]);
  if (start) PlasticFindFlow(plastic, dt, q, (const PetscReal(*)[8])history, &flow);
  else flow.strain[0] = flow.slope[0] = 0;
  for (int i = 0; i < 6; i++) {
    relative[i] = rel[i][0];
    packed[i]   = M[i][0] - (flow.strain[0] != 0 ? 3 * plastic->elastic.mu * flow.strain[0] / q[0] * relative[i] : 0);
  }
  GetMatrices(&trial, (const PetscReal(*)[8])history, 0, f, g, a);
  ToMatrix(packed, m);
  SymmetricLogCreate((const PetscReal(*)[3])a, PETSC_TRUE, &log);
  SymmetricLogApply(&log, (const PetscReal(*)[3])m, S);
  defined = Defined(f);
  for (int kl = 0; kl < 9; kl++) {
    const int k = kl / 3, l = kl % 3;
    PetscReal dC[3][3], dE[3][3], dM[3][3], dS[3][3], more[3][3], half[3][3];

    /* dFe is zero but in row k, where it is row l of Fp^-1 */
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) dC[i][j] = f[k][i] * g[l][j] + f[k][j] * g[l][i];
    SymmetricLogApply(&log, (const PetscReal(*)[3])dC, dE);
    for (int i = 0; i < 9; i++) dE[i / 3][i % 3] *= 0.5;
    ReturnTangent(plastic, relative, q[0], flow.strain[0], flow.slope[0], dE, dM);
    SymmetricLogApply(&log, (const PetscReal(*)[3])dM, dS);
    SymmetricLogApplySecond(&log, (const PetscReal(*)[3])m, (const PetscReal(*)[3])dC, more);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        half[i][j] = i == k ? g[l][0] * S[0][j] + g[l][1] * S[1][j] + g[l][2] * S[2][j] : 0;
        for (int n = 0; n < 3; n++) half[i][j] += f[i][n] * (dS[n][j] + more[n][j]);
      }
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        tangent[9 * (3 * i + j) + kl] = defined * (half[i][0] * g[j][0] + half[i][1] * g[j][1] + half[i][2] * g[j][2]);
  }
}

/* PlasticKernels_Finite - the kernels of finite strain */
PetscErrorCode PlasticKernels_Finite(Material material, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  *kernels = (MaterialKernels){.advance = Advance, .hold = Hold, .advancetangent = AdvanceTangent};
  PetscCall(PlasticCompleteKernels(material, plane_stress, kernels));
  PetscFunctionReturn(PETSC_SUCCESS);
}
