/*
   The loops over all elements of one shape with a mean dilatation. A template: a shape's header, solidbatch.h, and then this.

   J. C. Simo, R. L. Taylor, K. S. Pister, Computer Methods in Applied Mechanics and Engineering 51 (1985): in an element the ratio of
   volumes is constant, theta, the deformed volume over the undeformed one. Materials are given F' = (theta / J)^(1/3) F in place of the
   deformation gradient F with J = det F, and the force is the derivative of the energy that they return. With P' = P(F'), r = (theta /
   J)^(1/3) and pi = P' : F', and with F^-T for the inverse of the transpose,

     force of a point      r P' - (pi / 3) F^-T  against the gradients there, and
     force of the element  sum of pi / (3 theta V)  against the gradient of the deformed volume.

   Of linear materials, for small displacements: the trace of H is replaced by its mean (T. J. R. Hughes, International Journal for
   Numerical
   Methods in Engineering 15, 1980: B-bar).
*/
#include <impakt/private/solidbatch.h>
#include <impakt/private/solidaffine.h>
#include <impakt/private/tensor.h>
#include <element/dilatationratio.h>

/* Volumes of half a batch of elements */
typedef struct {
  SimdVector undeformed, change;   /* the latter as part of the undeformed one: theta - 1 */
  SimdVector inverse;              /* 1 / theta; NaN where the element is inverted */
  SimdVector gradient[DIM][MODES]; /* of the deformed volume, by the coefficients of positions; of linear materials of the undeformed one */
} Volumes;

SIMD_INLINE void GetVolumesOfPart(PetscBool linear, SimdVector X[DIM][MODES], SimdVector U[DIM][MODES], Volumes *volumes)
{
  SimdVector x[DIM][MODES], change = {0}, whole = {0};

  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt k = 0; k < MODES; k++) x[i][k] = X[i][k];
  /* one component of the positions is moved after the other, so that small changes keep their digits */
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++) {
    VolumeGradient(x, i, volumes->gradient[i]);
#pragma GCC unroll 8
    for (PetscInt k = 0; k < MODES; k++) {
      if (i == 0) whole += X[0][k] * volumes->gradient[0][k];
      change += U[i][k] * volumes->gradient[i][k];
      if (!linear) x[i][k] += U[i][k];
    }
  }
  volumes->undeformed = whole;
  volumes->change     = change / whole;
  volumes->inverse    = 1 / (1 + volumes->change);
  for (PetscInt p = 0; p < SIMD_WIDTH / SIMD_PARTS && !linear; p++)
    if (!(volumes->inverse[p] > 0)) volumes->inverse[p] = NAN;
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM - 1; i++)
    if (!linear) VolumeGradient(x, i, volumes->gradient[i]);
}

SIMD_INLINE void GetVolumes(PetscBool linear, SimdVector X[SIMD_PARTS][DIM][MODES], SimdVector U[SIMD_PARTS][DIM][MODES],
                            Volumes volumes[SIMD_PARTS], Means *means)
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    GetVolumesOfPart(linear, X[part], U[part], &volumes[part]);
    SimdGetParts(means->change)[part]        = volumes[part].change;
    SimdGetParts(means->inverse_theta)[part] = volumes[part].inverse;
  }
}

/* H' = F' - 1 in place of H; NaN where the point is inverted */
SIMD_INLINE void Dilate(const Means *means, SimdReal H[9], Dilated *dilated)
{
  SimdReal j, y;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
#if DIM == 2
    const PetscReal xx = H[0][p], xy = H[1][p], yx = H[3][p], yy = H[4][p];

    dilated->cofactor[0][p] = 1 + yy;
    dilated->cofactor[1][p] = -yx;
    dilated->cofactor[3][p] = -xy;
    dilated->cofactor[4][p] = 1 + xx;
    j[p]                    = xx + yy + (xx * yy - xy * yx);
#else
    const Tensor    h = TensorLoad((const PetscReal(*)[SIMD_WIDTH])H, p), c = TensorCofactor(h);
    const PetscReal trace = TensorTrace(h), d = 1 + trace;

    TensorStore((Tensor){c.xx - h.xx + d, c.xy - h.yx, c.xz - h.zx, c.yx - h.xy, c.yy - h.yy + d, c.yz - h.zy, c.zx - h.xz, c.zy - h.yz,
                         c.zz - h.zz + d},
                dilated->cofactor, p);
    j[p] = trace + TensorVolumeRemainder(h, c);
#endif
  }
  FindRatio(means, j, dilated, y);
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal r = 1 + y[p];

    dilated->ratio[p] = r;
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++) H[3 * i + k][p] = (i == k ? y[p] : 0) + r * H[3 * i + k][p];
    if (DIM == 2) H[8][p] = y[p];
  }
}

/* The same of a linear material: the trace of H becomes its mean */
SIMD_INLINE void DilateLinear(const Means *means, SimdReal H[9])
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal third = (means->change[p] - (H[0][p] + H[4][p] + (DIM == 3 ? H[8][p] : 0))) * (1. / 3);

    H[0][p] += third;
    H[4][p] += third;
    H[8][p] = DIM == 3 ? H[8][p] + third : third;
  }
}

/* r P' - (pi / 3) F^-T in place of P'; and pi / 3 times a weight is added to the pressure */
SIMD_INLINE void Undilate(const SimdReal H[9], const Dilated *dilated, const SimdReal weight, SimdReal P[9], SimdReal pressure)
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    PetscReal sum = P[0][p] + P[4][p] + P[8][p], over_J;

    if (DIM == 2) sum += P[8][p] * H[8][p];
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++) sum += P[3 * i + k][p] * H[3 * i + k][p];
    sum *= 1. / 3;
    pressure[p] += weight[p] * sum;
    over_J = sum * dilated->inverse[p];
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++) P[3 * i + k][p] = dilated->ratio[p] * P[3 * i + k][p] - over_J * dilated->cofactor[3 * i + k][p];
  }
}

SIMD_INLINE void UndilateLinear(const SimdReal weight, SimdReal P[9], SimdReal pressure)
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal third = (P[0][p] + P[4][p] + P[8][p]) * (1. / 3);

    pressure[p] += weight[p] * third;
    P[0][p] -= third;
    P[4][p] -= third;
    P[8][p] -= third;
  }
}

SIMD_INLINE void DilateAny(PetscBool linear, const Means *means, SimdReal H[9], Dilated *dilated)
{
  if (linear) DilateLinear(means, H);
  else Dilate(means, H, dilated);
}

/* Adds the force of the mean pressure to what the points have given, and both to the nodes */
SIMD_INLINE void AddWithPressure(PetscBool linear, PetscReal scale, const PetscInt connectivity[], PetscInt first, PetscInt in_batch,
                                 const Volumes volumes[SIMD_PARTS], SimdReal pressure, SimdVector F[SIMD_PARTS][DIM][MODES], PetscReal f[])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    SimdVector mean = SimdGetParts(pressure)[part] / volumes[part].undeformed;

    if (!linear) mean *= volumes[part].inverse;
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < MODES; k++) F[part][i][k] += mean * volumes[part].gradient[i][k];
  }
  AddBatchForces(scale, connectivity, first, in_batch, F, f);
}

SIMD_INLINE PetscInt AddBatches(PetscBool linear, const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                const PetscReal u[], PetscReal f[])
{
  PetscInt  inverted = -1;
  Gradients at[3]    = {0};
  Frame     frame    = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], F[SIMD_PARTS][DIM][MODES];
    SimdReal       P[9], pressure = {0};
    Volumes        volumes[SIMD_PARTS];
    Means          means;
    Dilated        dilated[2];
    PetscBool      affine;

    if (SolidSkips(solid, first)) continue;
    ZeroModes(F);
    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    affine = GetFrame(X, &frame);
    for (PetscInt k = 0; k < 3 && affine; k++) SetFrame(&frame, &at[k]);
    GetGradientsOf(affine, &frame, X, U, points[0], &at[0]);
    GetVolumes(linear, X, U, volumes, &means);
    GetGradientsOf(affine, &frame, X, U, points[1], &at[1]);
    DilateAny(linear, &means, at[0].H, &dilated[0]);
    for (PetscInt g = 0; g < POINTS; g++) {
      Gradients *now = &at[g % 3];

      /* gradients two points ahead, and F' one, as what is written in parts and read in whole right after would go through the cache */
      if (g + 2 < POINTS) GetGradientsOf(affine, &frame, X, U, points[g + 2], &at[(g + 2) % 3]);
      if (g + 1 < POINTS) DilateAny(linear, &means, at[(g + 1) % 3].H, &dilated[(g + 1) % 2]);
      SolidStress(solid, first, g, (const SimdReal *)now->H, P);
      if (linear) UndilateLinear(now->determinant, P, pressure);
      else Undilate((const PetscReal(*)[SIMD_WIDTH])now->H, &dilated[g % 2], now->determinant, P, pressure);
      for (PetscInt part = 0; part < SIMD_PARTS; part++) AddPointOfPart(part, P, now->cofactor[part], points[g], F[part]);
    }
    if (inverted < 0) {
      const PetscInt bad = FindNaN(pressure);

      if (bad >= 0) inverted = first + PetscMin(bad, in_batch - 1);
    }
    AddWithPressure(linear, scale, connectivity, first, in_batch, volumes, pressure, F, f);
  }
  return inverted;
}

/* Returns the first element with a stress that is no number; -1: none */
SIMD_CLONES static PetscInt AddForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                      const PetscReal u[], PetscReal f[])
{
  return solid->linear ? AddBatches(PETSC_TRUE, solid, scale, count, connectivity, u, f)
                       : AddBatches(PETSC_FALSE, solid, scale, count, connectivity, u, f);
}

/* dF' = r (dF + F (d theta / theta - F^-T : dF) / 3), which is how F' moves with the velocity, in place of dF; r F is F' */
SIMD_INLINE void DilateRate(const SimdReal growth, const SimdReal H[9], const Dilated *dilated, SimdReal rate[9])
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    PetscReal g = 0;

    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++) g += dilated->cofactor[3 * i + k][p] * rate[3 * i + k][p];
    g = (growth[p] - g * dilated->inverse[p]) * (1. / 3);
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++)
        rate[3 * i + k][p] = dilated->ratio[p] * rate[3 * i + k][p] + g * ((i == k ? 1 : 0) + H[3 * i + k][p]);
    if (DIM == 2) rate[8][p] = g * (1 + H[8][p]);
  }
}

/* The forces of the stress F' C : dE'/dt, with Green and Lagrange's strain of F' */
SIMD_CLONES static void AddViscousForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                         const PetscReal u[], const PetscReal v[], PetscReal f[])
{
  Gradients at = {0}, rate = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], V[SIMD_PARTS][DIM][MODES], F[SIMD_PARTS][DIM][MODES] = {{{{0}}}};
    SimdReal       strain[9], S[9], P[9] = {{0}}, pressure = {0}, growth;
    Volumes        volumes[SIMD_PARTS];
    Means          means;
    Dilated        dilated;

    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    GetModes(connectivity, first, count, v, V);
    GetVolumes(PETSC_FALSE, X, U, volumes, &means);
    for (PetscInt part = 0; part < SIMD_PARTS; part++) {
      SimdVector sum = {0};

      for (PetscInt i = 0; i < DIM; i++)
        for (PetscInt k = 0; k < MODES; k++) sum += V[part][i][k] * volumes[part].gradient[i][k];
      SimdGetParts(growth)[part] = sum * volumes[part].inverse / volumes[part].undeformed;
    }
    for (PetscInt g = 0; g < POINTS; g++) {
      GetGradients(X, U, points[g], &at);
      Dilate(&means, at.H, &dilated);
      GetGradients(X, V, points[g], &rate);
      DilateRate(growth, (const PetscReal(*)[SIMD_WIDTH])at.H, &dilated, rate.H);
      RateOfStrain(at.H, rate.H, strain);
      (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])strain, S);
      PullBack(at.H, S, P);
      Undilate((const PetscReal(*)[SIMD_WIDTH])at.H, &dilated, at.determinant, P, pressure);
      for (PetscInt part = 0; part < SIMD_PARTS; part++) AddPointOfPart(part, P, at.cofactor[part], points[g], F[part]);
    }
    AddWithPressure(PETSC_FALSE, scale, connectivity, first, in_batch, volumes, pressure, F, f);
  }
}

SIMD_CLONES static PetscErrorCode GetPoints(Element element, PetscInt first, const PetscScalar u[], SimdReal H[][9], SimdReal weights[])
{
  const Solid *solid = (const Solid *)element->data;
  Gradients    at    = {0};
  SimdVector   X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES];
  Volumes      volumes[SIMD_PARTS];
  Means        means;
  Dilated      dilated;
  PetscBool    affine;
  Frame        frame = {0};

  GetModes(element->connectivity, first, element->count, solid->coordinates, X);
  GetModes(element->connectivity, first, element->count, u, U);
  affine = GetFrame(X, &frame);
  if (affine) SetFrame(&frame, &at);
  GetVolumes(solid->linear, X, U, volumes, &means);
  for (PetscInt g = 0; g < POINTS; g++) {
    GetGradientsOf(affine, &frame, X, U, points[g], &at);
    DilateAny(solid->linear, &means, at.H, &dilated);
    StorePoint(&at, H[g], weights[g]);
  }
  return PETSC_SUCCESS;
}

#include <impakt/private/solidops.h>
