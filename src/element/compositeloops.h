/*
   The loops over all composite elements of one shape. A template: DIM, NODES, POINTS, WEIGHT 1, and then this.

   Gradients at the points are linear functions of the displacements of all nodes, see composite.c. The ratio of volumes is that of
   meandilatationloops.h, but that F' = (theta / J)^(s / 3) F with the share s of the mean; plane stress has none.
*/
#include "composite.h"
#include <element/dilatationratio.h>

/* A point of integration of a batch */
typedef struct {
  SimdReal H[9];        /* du_i/dX_j; with a mean dilatation it becomes H' */
  SimdReal j;           /* J - 1 with F as it is; of linear materials the trace of H */
  SimdReal cofactor[9]; /* J F^-T; in two dimensions without its third row and column */
  SimdReal ratio;       /* (theta / J)^(s / 3) */
} CompositePoint;

typedef struct {
  SimdReal volume, change, inverse; /* of all points: undeformed, theta - 1, 1 / theta */
} CompositeMeans;

typedef struct {
  const SimdReal *gradients, *weights; /* of one batch: points x nodes x dim; points */
} CompositeBatch;

#define IN_SPACE(i) (DIM == 3 || ((i) < 5 && (i) != 2))

static CompositeBatch GetBatch(const Solid *solid, PetscInt first)
{
  const Composite *composite = (const Composite *)solid->own;
  const size_t     batch     = (size_t)(first / SIMD_WIDTH);

  return (CompositeBatch){(const SimdReal *)(const void *)(composite->gradients + batch * (POINTS * NODES * DIM * SIMD_WIDTH)),
                          (const SimdReal *)(const void *)(composite->weights + batch * (POINTS * SIMD_WIDTH))};
}

SIMD_INLINE void GetNodal(const PetscInt connectivity[], PetscInt first, PetscInt count, const PetscReal values[],
                          SimdReal nodal[DIM * NODES])
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscInt *nodes = connectivity + NODES * PetscMin(first + p, count - 1);

    for (PetscInt a = 0; a < NODES; a++) {
      const PetscReal *of_node = values + (size_t)(DIM * nodes[a]);

      for (PetscInt i = 0; i < DIM; i++) nodal[DIM * a + i][p] = of_node[i];
    }
  }
}

SIMD_INLINE void GetGradient(SimdReal nodal[DIM * NODES], const SimdReal gradient[NODES * DIM], SimdReal H[9])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    SimdVector h[DIM][DIM] = {{{0}}};

    for (PetscInt a = 0; a < NODES; a++) {
      const SimdVector *g = (const SimdVector *)gradient + a * DIM * SIMD_PARTS + part;

#pragma GCC unroll 3
      for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
        for (PetscInt k = 0; k < DIM; k++) h[i][k] += SimdGetParts(nodal[DIM * a + i])[part] * g[k * SIMD_PARTS];
    }
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++) SimdGetParts(H[3 * i + k])[part] = h[i][k];
  }
}

/* Adds the force of a point to those of the nodes */
SIMD_INLINE void AddForce(SimdReal P[9], const SimdReal weight, const SimdReal gradient[NODES * DIM], SimdReal force[DIM * NODES])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const SimdVector w = ((const SimdVector *)weight)[part];
    SimdVector       q[DIM][DIM];

    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++) q[i][k] = w * SimdGetParts(P[3 * i + k])[part];
    for (PetscInt a = 0; a < NODES; a++) {
      const SimdVector *g = (const SimdVector *)gradient + a * DIM * SIMD_PARTS + part;

#pragma GCC unroll 3
      for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
        for (PetscInt k = 0; k < DIM; k++) SimdGetParts(force[DIM * a + i])[part] += q[i][k] * g[k * SIMD_PARTS];
    }
  }
}

/* J - 1, or of linear materials the trace of H, and the cofactors */
SIMD_INLINE void GetVolume(PetscBool linear, CompositePoint *at)
{
  SimdReal *H = at->H;

  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    PetscReal F[9], c[9], trace = H[0][p] + H[4][p] + (DIM == 3 ? H[8][p] : 0);

    for (PetscInt i = 0; i < 9; i++) F[i] = IN_SPACE(i) ? H[i][p] : 0;
    if (linear) {
      at->j[p] = trace;
      continue;
    }
    if (DIM == 2) {
      at->j[p]           = trace + (F[0] * F[4] - F[1] * F[3]);
      at->cofactor[0][p] = 1 + F[4];
      at->cofactor[1][p] = -F[3];
      at->cofactor[3][p] = -F[1];
      at->cofactor[4][p] = 1 + F[0];
      continue;
    }
    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt k = 0; k < 3; k++)
        c[3 * i + k] = F[3 * ((i + 1) % 3) + (k + 1) % 3] * F[3 * ((i + 2) % 3) + (k + 2) % 3] -
                       F[3 * ((i + 1) % 3) + (k + 2) % 3] * F[3 * ((i + 2) % 3) + (k + 1) % 3];
    /* from the invariants, which keep the digits of small H */
    at->j[p] = trace + (c[0] + c[4] + c[8]) + (F[0] * c[0] + F[1] * c[1] + F[2] * c[2]);
    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt k = 0; k < 3; k++) at->cofactor[3 * i + k][p] = c[3 * i + k] - F[3 * k + i] + (i == k ? 1 + trace : 0);
  }
}

SIMD_INLINE void GetMeans(PetscBool linear, const CompositeBatch *batch, const CompositePoint at[POINTS], CompositeMeans *means)
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    PetscReal volume = 0, change = 0;

    for (PetscInt g = 0; g < POINTS; g++) {
      volume += batch->weights[g][p];
      change += batch->weights[g][p] * at[g].j[p];
    }
    means->volume[p]  = volume;
    means->change[p]  = change / volume;
    means->inverse[p] = linear ? 1 : 1 + means->change[p] > 0 ? 1 / (1 + means->change[p]) : NAN;
  }
}

/* (1 + s)^power - 1: a series where it is exact to round-off */
SIMD_INLINE void GetPower(const SimdReal s, PetscReal power, SimdReal y)
{
  PetscReal largest = 0;

  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal square = s[p] * s[p];
    PetscReal       sum    = 1;

    for (PetscInt k = 15; k > 1; k--) sum = 1 + sum * s[p] * (power - (PetscReal)(k - 1)) / (PetscReal)k;
    y[p]    = power * s[p] * sum;
    largest = square > largest ? square : square == square ? largest : PETSC_MAX_REAL; /* NOLINT(misc-redundant-expression): a NaN */
  }
  if (largest > SERIES_LIMIT * SERIES_LIMIT)
    for (PetscInt p = 0; p < SIMD_WIDTH; p++)
      if (!(PetscAbsReal(s[p]) <= SERIES_LIMIT)) y[p] = 1 + s[p] > 0 ? expm1(power * log1p(s[p])) : NAN;
}

/* H' in place of H */
SIMD_INLINE void Dilate(PetscBool linear, PetscReal share, const CompositeMeans *means, CompositePoint *at)
{
  SimdReal s, y;

  if (linear) {
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
      const PetscReal third = share / 3 * (means->change[p] - at->j[p]);

      at->H[0][p] += third;
      at->H[4][p] += third;
      at->H[8][p] = third + (DIM == 3 ? at->H[8][p] : 0);
    }
    return;
  }
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) s[p] = 1 + at->j[p] > 0 ? (means->change[p] - at->j[p]) / (1 + at->j[p]) : NAN;
  GetPower(s, share / 3, y);
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    at->ratio[p] = 1 + y[p];
    for (PetscInt i = 0; i < 9; i++)
      if (IN_SPACE(i)) at->H[i][p] = (i % 4 ? 0 : y[p]) + (1 + y[p]) * at->H[i][p];
    if (DIM == 2) at->H[8][p] = y[p];
  }
}

/* r P' - (s pi / 3) F^-T in place of P'; s pi / 3 times the weight is added to the pressure */
SIMD_INLINE void Undilate(PetscBool linear, PetscReal share, const CompositePoint *at, const SimdReal weight, SimdReal P[9],
                          SimdReal pressure)
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    PetscReal third = P[0][p] + P[4][p] + P[8][p], over_J;

    for (PetscInt i = 0; i < 9 && !linear; i++)
      if (IN_SPACE(i)) third += P[i][p] * at->H[i][p];
    if (DIM == 2 && !linear) third += P[8][p] * at->H[8][p];
    third *= share / 3;
    pressure[p] += weight[p] * third;
    over_J = third / (1 + at->j[p]);
    for (PetscInt i = 0; i < 9; i++) {
      if (!IN_SPACE(i)) continue;
      if (linear) P[i][p] -= i % 4 ? 0 : third;
      else P[i][p] = at->ratio[p] * P[i][p] - over_J * at->cofactor[i][p];
    }
  }
}

/* What the mean pressure adds to the stress of a point */
SIMD_INLINE void AddPressure(PetscBool linear, const CompositeMeans *means, const CompositePoint *at, const SimdReal pressure,
                             SimdReal P[9])
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal mean = pressure[p] * means->inverse[p] / means->volume[p];

    for (PetscInt i = 0; i < 9; i++)
      if (IN_SPACE(i) && (!linear || i % 4 == 0)) P[i][p] += mean * (linear ? 1 : at->cofactor[i][p]);
  }
}

/* All points of a batch, ready for the material */
SIMD_INLINE void FindPoints(const Solid *solid, PetscBool linear, const CompositeBatch *batch, SimdReal u[DIM * NODES],
                            CompositePoint at[POINTS], CompositeMeans *means)
{
  const PetscReal share = solid->mean_share;

  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    means->volume[p] = means->inverse[p] = 1;
    means->change[p]                     = 0;
  }
  for (PetscInt g = 0; g < POINTS; g++) {
    for (PetscInt i = 0; i < 9; i++)
      if (!IN_SPACE(i))
        for (PetscInt p = 0; p < SIMD_WIDTH; p++) at[g].H[i][p] = 0;
    GetGradient(u, batch->gradients + (ptrdiff_t)(g * NODES * DIM), at[g].H);
    if (share > 0) GetVolume(linear, &at[g]);
  }
  if (!(share > 0)) return;
  GetMeans(linear, batch, (const CompositePoint *)at, means);
  for (PetscInt g = 0; g < POINTS; g++) Dilate(linear, share, means, &at[g]);
}

/* Forces of the stresses P', which are overwritten, added to those of all nodes; returns the first member of the batch without one */
SIMD_INLINE PetscInt AddBatch(const Solid *solid, PetscBool linear, PetscReal scale, const CompositeBatch *batch,
                              const CompositePoint at[POINTS], const CompositeMeans *means, SimdReal P[POINTS][9], const PetscInt nodes[],
                              PetscInt in_batch, PetscReal f[])
{
  const PetscReal share              = solid->mean_share;
  SimdReal        force[DIM * NODES] = {{0}}, pressure = {0};
  PetscInt        bad = -1;

  for (PetscInt g = 0; g < POINTS && share > 0; g++) Undilate(linear, share, &at[g], batch->weights[g], P[g], pressure);
  for (PetscInt g = 0; g < POINTS; g++) {
    if (share > 0) AddPressure(linear, means, &at[g], pressure, P[g]);
    AddForce(P[g], batch->weights[g], batch->gradients + (ptrdiff_t)(g * NODES * DIM), force);
  }
  for (PetscInt p = 0; p < in_batch; p++) {
    PetscReal check = 0;

    for (PetscInt a = 0; a < NODES; a++) {
      PetscReal *of_node = f + (size_t)(DIM * nodes[NODES * p + a]);

      for (PetscInt i = 0; i < DIM; i++) {
        of_node[i] += scale * force[DIM * a + i][p];
        check += force[DIM * a + i][p];
      }
    }
    if (bad < 0 && check != check) bad = p; /* NOLINT(misc-redundant-expression): a NaN */
  }
  return bad;
}

/* Returns the first element with a stress that is no number; -1: none */
SIMD_CLONES static PetscInt AddForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                      const PetscReal u[], PetscReal f[])
{
  PetscInt inverted = -1;

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const CompositeBatch batch = GetBatch(solid, first);
    const PetscInt       n     = PetscMin(SIMD_WIDTH, count - first);
    SimdReal             nodal[DIM * NODES], P[POINTS][9];
    CompositePoint       at[POINTS];
    CompositeMeans       means;
    PetscInt             bad;

    if (SolidSkips(solid, first)) continue;
    GetNodal(connectivity, first, count, u, nodal);
    FindPoints(solid, solid->linear, &batch, nodal, at, &means);
    for (PetscInt g = 0; g < POINTS; g++) SolidStress(solid, first, g, (const SimdReal *)at[g].H, P[g]);
    bad = AddBatch(solid, solid->linear, scale, &batch, at, &means, P, connectivity + NODES * first, n, f);
    if (inverted < 0 && bad >= 0) inverted = first + bad;
  }
  return inverted;
}

/* dF' = r (dF + s F (d theta / theta - F^-T : dF) / 3), which is how F' moves with the velocity; r F is F' */
SIMD_INLINE void DilateRates(PetscReal share, const CompositeBatch *batch, const CompositePoint at[POINTS], const CompositeMeans *means,
                             SimdReal rate[POINTS][9])
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    PetscReal growth = 0, of_point[POINTS];

    for (PetscInt g = 0; g < POINTS; g++) {
      of_point[g] = 0;
      for (PetscInt i = 0; i < 9; i++)
        if (IN_SPACE(i)) of_point[g] += at[g].cofactor[i][p] * rate[g][i][p];
      growth += batch->weights[g][p] * of_point[g];
    }
    growth *= means->inverse[p] / means->volume[p];
    for (PetscInt g = 0; g < POINTS; g++) {
      const PetscReal change = share / 3 * (growth - of_point[g] / (1 + at[g].j[p]));

      for (PetscInt i = 0; i < 9; i++)
        if (IN_SPACE(i)) rate[g][i][p] = at[g].ratio[p] * rate[g][i][p] + change * ((i % 4 ? 0 : 1) + at[g].H[i][p]);
      if (DIM == 2) rate[g][8][p] = change * (1 + at[g].H[8][p]);
    }
  }
}

/* rate = (F^T dH + dH^T F) / 2 with F = 1 + H, in place of dH */
SIMD_INLINE void RateOfStrain(const SimdReal H[9], SimdReal dH[9])
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    PetscReal rate[9];

    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt j = 0; j < 3; j++) {
        rate[3 * i + j] = dH[3 * i + j][p] + dH[3 * j + i][p];
        for (PetscInt k = 0; k < 3; k++) rate[3 * i + j] += H[3 * k + i][p] * dH[3 * k + j][p] + H[3 * k + j][p] * dH[3 * k + i][p];
      }
    for (PetscInt i = 0; i < 9; i++) dH[i][p] = 0.5 * rate[i];
  }
}

/* P = F S with F = 1 + H, in place of S */
SIMD_INLINE void PullBack(const SimdReal H[9], SimdReal S[9])
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++)
    for (PetscInt j = 0; j < 3; j++) {
      const PetscReal column[3] = {S[j][p], S[3 + j][p], S[6 + j][p]};

      for (PetscInt i = 0; i < 3; i++)
        for (PetscInt k = 0; k < 3; k++) S[3 * i + j][p] += H[3 * i + k][p] * column[k];
    }
}

/* The forces of the stress F' C : dE'/dt, with Green and Lagrange's strain of F' */
SIMD_CLONES static void AddViscousForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                         const PetscReal u[], const PetscReal v[], PetscReal f[])
{
  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const CompositeBatch batch = GetBatch(solid, first);
    const PetscInt       n     = PetscMin(SIMD_WIDTH, count - first);
    SimdReal             nodal[DIM * NODES], rate[POINTS][9] = {{{0}}}, P[POINTS][9] = {{{0}}};
    CompositePoint       at[POINTS];
    CompositeMeans       means;

    GetNodal(connectivity, first, count, u, nodal);
    FindPoints(solid, PETSC_FALSE, &batch, nodal, at, &means);
    GetNodal(connectivity, first, count, v, nodal);
    for (PetscInt g = 0; g < POINTS; g++) GetGradient(nodal, batch.gradients + (ptrdiff_t)(g * NODES * DIM), rate[g]);
    if (solid->mean_share > 0) DilateRates(solid->mean_share, &batch, at, &means, rate);
    for (PetscInt g = 0; g < POINTS; g++) {
      RateOfStrain((const SimdReal *)at[g].H, rate[g]);
      (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])rate[g], P[g]);
      PullBack((const SimdReal *)at[g].H, P[g]);
    }
    (void)AddBatch(solid, PETSC_FALSE, scale, &batch, at, &means, P, connectivity + NODES * first, n, f);
  }
}

SIMD_CLONES static PetscErrorCode GetPoints(Element element, PetscInt first, const PetscScalar u[], SimdReal H[][9], SimdReal weights[])
{
  const Solid         *solid = (const Solid *)element->data;
  const CompositeBatch batch = GetBatch(solid, first);
  SimdReal             nodal[DIM * NODES];
  CompositePoint       at[POINTS];
  CompositeMeans       means;

  GetNodal(element->connectivity, first, element->count, u, nodal);
  FindPoints(solid, solid->linear, &batch, nodal, at, &means);
  for (PetscInt g = 0; g < POINTS; g++) {
    for (PetscInt k = 0; k < 9; k++)
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) H[g][k][p] = at[g].H[k][p];
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) weights[g][p] = batch.weights[g][p];
  }
  return PETSC_SUCCESS;
}

#include <impakt/private/solidops.h>
