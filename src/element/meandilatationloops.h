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

/* Where |theta / J - 1| is larger, the cube root is taken by the library; the series below has an error of 1e-6 there, and the step of
   Halley's method after that one of 1e-18 */
#define SERIES_LIMIT 0.25

/* Volumes of half a batch of elements */
typedef struct {
  SimdVector undeformed, change;   /* the latter as part of the undeformed one: theta - 1 */
  SimdVector gradient[DIM][MODES]; /* of the deformed volume, by the coefficients of positions; of linear materials of the undeformed one */
} Volumes;

/* How F has been changed into F' at a point of half a batch */
typedef struct {
  SimdVector ratio;             /* r */
  SimdVector inverse[DIM][DIM]; /* F^-T */
} Dilated;

SIMD_INLINE void GetVolumes(PetscBool linear, SimdVector X[DIM][MODES], SimdVector U[DIM][MODES], Volumes *volumes)
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
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM - 1; i++)
    if (!linear) VolumeGradient(x, i, volumes->gradient[i]);
}

/* J F^-T of a displacement gradient, from F = 1 + H; and J - 1 with all its digits */
SIMD_INLINE void GetCofactors(const SimdVector h[DIM][DIM], SimdVector cofactor[DIM][DIM], SimdVector *change)
{
#if DIM == 2
  cofactor[0][0] = 1 + h[1][1];
  cofactor[0][1] = -h[1][0];
  cofactor[1][0] = -h[0][1];
  cofactor[1][1] = 1 + h[0][0];
  *change        = h[0][0] + h[1][1] + (h[0][0] * h[1][1] - h[0][1] * h[1][0]);
#else
  const SimdVector trace  = h[0][0] + h[1][1] + h[2][2];
  SimdVector       second = {0}, third = {0};

#  pragma GCC unroll 3
  for (PetscInt i = 0; i < 3; i++)
#  pragma GCC unroll 3
    for (PetscInt j = 0; j < 3; j++) {
      const PetscInt   k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
      const SimdVector c = h[k][m] * h[l][n] - h[k][n] * h[l][m];

      if (i == j) second += c;
      if (i == 0) third += h[0][j] * c;
      cofactor[i][j] = c - h[j][i];
      if (i == j) cofactor[i][j] += 1 + trace;
    }
  *change = trace + (second + third);
#endif
}

/* (1 + s)^(1/3) - 1 */
SIMD_INLINE void CubeRoot(SimdVector s, SimdVector *root)
{
  const SimdVector a = 1 + s;
  SimdVector       y = s * (1. / 3 + s * (-1. / 9 + s * (5. / 81 + s * (-10. / 243 + s * (22. / 729 - s * (154. / 6561))))));
  SimdVector       rest;

  rest = s - y * (3 + y * (3 + y));
  y += (1 + y) * rest / (3 * a - 2 * rest);
  for (PetscInt p = 0; p < SIMD_WIDTH / SIMD_PARTS; p++)
    if (!(PetscAbsReal(s[p]) <= SERIES_LIMIT)) y[p] = cbrt(1 + s[p]) - 1;
  *root = y;
}

/* H' = F' - 1 in place of H; NaN where the point is inverted */
SIMD_INLINE void Dilate(PetscInt part, SimdVector change, SimdReal H[9], Dilated *dilated)
{
  SimdVector h[DIM][DIM], j, J, s, y;

#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++) h[i][k] = SimdGetParts(H[3 * i + k])[part];
  GetCofactors((const SimdVector(*)[DIM])h, dilated->inverse, &j);
  J = 1 + j;
  for (PetscInt p = 0; p < SIMD_WIDTH / SIMD_PARTS; p++) J[p] = J[p] > 0 ? J[p] : NAN;
  J = 1 / J;
  s = (change - j) * J;
  CubeRoot(s, &y);
  dilated->ratio = 1 + y;
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++) {
      dilated->inverse[i][k] *= J;
      SimdGetParts(H[3 * i + k])[part] = i == k ? h[i][k] + y * (1 + h[i][k]) : h[i][k] + y * h[i][k];
    }
  if (DIM == 2) SimdGetParts(H[8])[part] = y;
}

/* The same of a linear material: the trace of H becomes its mean */
SIMD_INLINE void DilateLinear(PetscInt part, SimdVector change, SimdReal H[9])
{
  SimdVector trace = SimdGetParts(H[0])[part] + SimdGetParts(H[4])[part], third;

  if (DIM == 3) trace += SimdGetParts(H[8])[part];
  third = (change - trace) * (1. / 3);
  SimdGetParts(H[0])[part] += third;
  SimdGetParts(H[4])[part] += third;
  if (DIM == 3) SimdGetParts(H[8])[part] += third;
  else SimdGetParts(H[8])[part] = third;
}

/* r P' - (pi / 3) F^-T in place of P'; and pi / 3 */
SIMD_INLINE void Undilate(PetscInt part, SimdReal H[9], const Dilated *dilated, SimdReal P[9], SimdVector *pressure)
{
  SimdVector third = SimdGetParts(P[0])[part] + SimdGetParts(P[4])[part] + SimdGetParts(P[8])[part];

  if (DIM == 2) third += SimdGetParts(P[8])[part] * SimdGetParts(H[8])[part];
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++) third += SimdGetParts(P[3 * i + k])[part] * SimdGetParts(H[3 * i + k])[part];
  third *= 1. / 3;
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++)
      SimdGetParts(P[3 * i + k])[part] = dilated->ratio * SimdGetParts(P[3 * i + k])[part] - third * dilated->inverse[i][k];
  *pressure = third;
}

SIMD_INLINE void UndilateLinear(PetscInt part, SimdReal P[9], SimdVector *pressure)
{
  const SimdVector third = (SimdGetParts(P[0])[part] + SimdGetParts(P[4])[part] + SimdGetParts(P[8])[part]) * (1. / 3);

  SimdGetParts(P[0])[part] -= third;
  SimdGetParts(P[4])[part] -= third;
  if (DIM == 3) SimdGetParts(P[8])[part] -= third;
  *pressure = third;
}

/* Gradients at a point with the mean dilatation */
SIMD_INLINE void GetDilatedGradients(PetscBool linear, SimdVector X[SIMD_PARTS][DIM][MODES], SimdVector U[SIMD_PARTS][DIM][MODES],
                                     const Volumes volumes[SIMD_PARTS], const PetscReal xi[DIM], Gradients *at, Dilated dilated[SIMD_PARTS])
{
  GetGradients(X, U, xi, at);
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const SimdVector change = volumes[part].change;

    if (linear) DilateLinear(part, change, at->H);
    else Dilate(part, change, at->H, &dilated[part]);
  }
}

/* What the points have given and the force of the mean pressure, at the nodes */
SIMD_INLINE void GetNodalForces(PetscReal scale, const Volumes *volumes, PetscBool linear, SimdVector pressure, PetscInt part,
                                SimdVector F[DIM][MODES], SimdReal nodal[DIM][NODES])
{
  pressure /= volumes->undeformed;
  if (!linear) pressure /= 1 + volumes->change;
  for (PetscInt i = 0; i < DIM; i++) {
    SimdVector n[NODES];

    for (PetscInt k = 0; k < MODES; k++) F[i][k] = scale * (F[i][k] + pressure * volumes->gradient[i][k]);
    NodesOfModes(F[i], n);
#pragma GCC unroll 8
    for (PetscInt a = 0; a < NODES; a++) SimdGetParts(nodal[i][a])[part] = n[a];
  }
}

SIMD_INLINE void AddNodal(const PetscInt connectivity[], PetscInt first, PetscInt in_batch, const SimdReal nodal[DIM][NODES], PetscReal f[])
{
  for (PetscInt p = 0; p < in_batch; p++) {
    const PetscInt *nodes = connectivity + NODES * (first + p);

    for (PetscInt a = 0; a < NODES; a++)
      for (PetscInt i = 0; i < DIM; i++) f[DIM * nodes[a] + i] += nodal[i][a][p];
  }
}

SIMD_INLINE PetscInt AddBatches(PetscBool linear, const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                const PetscReal u[], PetscReal f[])
{
  PetscInt  inverted = -1;
  Gradients at[2]    = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], F[SIMD_PARTS][DIM][MODES] = {{{{0}}}};
    SimdVector     pressure[SIMD_PARTS] = {{0}};
    SimdReal       P[9], nodal[DIM][NODES], check;
    Volumes        volumes[SIMD_PARTS];
    Dilated        dilated[2][SIMD_PARTS];

    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    for (PetscInt part = 0; part < SIMD_PARTS; part++) GetVolumes(linear, X[part], U[part], &volumes[part]);
    GetDilatedGradients(linear, X, U, volumes, points[0], &at[0], dilated[0]);
    for (PetscInt g = 0; g < POINTS; g++) {
      const PetscInt now = g % 2;

      /* gradients one point ahead, as in solidloops.h */
      if (g + 1 < POINTS) GetDilatedGradients(linear, X, U, volumes, points[g + 1], &at[1 - now], dilated[1 - now]);
      (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])at[now].H, P);
      for (PetscInt part = 0; part < SIMD_PARTS; part++) {
        SimdVector third;

        if (linear) UndilateLinear(part, P, &third);
        else Undilate(part, at[now].H, &dilated[now][part], P, &third);

        pressure[part] += SimdGetParts(at[now].determinant)[part] * third;
        AddPointOfPart(part, P, at[now].cofactor[part], points[g], F[part]);
      }
    }
    for (PetscInt part = 0; part < SIMD_PARTS; part++) {
      SimdGetParts(check)[part] = pressure[part];
      GetNodalForces(scale, &volumes[part], linear, pressure[part], part, F[part], nodal);
    }
    if (inverted < 0) {
      const PetscInt bad = FindNaN(check);

      if (bad >= 0) inverted = first + PetscMin(bad, in_batch - 1);
    }
    AddNodal(connectivity, first, in_batch, (const SimdReal(*)[NODES])nodal, f);
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

/* dF' = r (dF + F (d theta / theta - F^-T : dF) / 3), which is how F' moves with the velocity, in place of dF */
SIMD_INLINE void DilateRate(PetscInt part, SimdVector change, const SimdReal H[9], const Dilated *dilated, SimdReal rate[9])
{
  SimdVector g = change;

#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++) g -= dilated->inverse[i][k] * SimdGetParts(rate[3 * i + k])[part];
  g *= 1. / 3;
  /* r F is F' */
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++) {
      SimdVector h = ((const SimdVector *)H[3 * i + k])[part];

      if (i == k) h += 1;
      SimdGetParts(rate[3 * i + k])[part] = dilated->ratio * SimdGetParts(rate[3 * i + k])[part] + g * h;
    }
  if (DIM == 2) SimdGetParts(rate[8])[part] = g * (1 + ((const SimdVector *)H[8])[part]);
}

/* The forces of the stress F' C : dE'/dt, with Green and Lagrange's strain of F' */
SIMD_CLONES static void AddViscousForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                         const PetscReal u[], const PetscReal v[], PetscReal f[])
{
  Gradients at = {0}, rate = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], V[SIMD_PARTS][DIM][MODES], F[SIMD_PARTS][DIM][MODES] = {{{{0}}}};
    SimdVector     pressure[SIMD_PARTS] = {{0}}, growth[SIMD_PARTS] = {{0}};
    SimdReal       strain[9], S[9], P[9] = {{0}}, nodal[DIM][NODES];
    Volumes        volumes[SIMD_PARTS];
    Dilated        dilated[SIMD_PARTS];

    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    GetModes(connectivity, first, count, v, V);
    for (PetscInt part = 0; part < SIMD_PARTS; part++) {
      GetVolumes(PETSC_FALSE, X[part], U[part], &volumes[part]);
      for (PetscInt i = 0; i < DIM; i++)
        for (PetscInt k = 0; k < MODES; k++) growth[part] += V[part][i][k] * volumes[part].gradient[i][k];
      growth[part] /= volumes[part].undeformed * (1 + volumes[part].change);
    }
    for (PetscInt g = 0; g < POINTS; g++) {
      GetDilatedGradients(PETSC_FALSE, X, U, volumes, points[g], &at, dilated);
      GetGradients(X, V, points[g], &rate);
      for (PetscInt part = 0; part < SIMD_PARTS; part++)
        DilateRate(part, growth[part], (const PetscReal(*)[SIMD_WIDTH])at.H, &dilated[part], rate.H);
      RateOfStrain(at.H, rate.H, strain);
      (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])strain, S);
      PullBack(at.H, S, P);
      for (PetscInt part = 0; part < SIMD_PARTS; part++) {
        SimdVector third;

        Undilate(part, at.H, &dilated[part], P, &third);
        pressure[part] += SimdGetParts(at.determinant)[part] * third;
        AddPointOfPart(part, P, at.cofactor[part], points[g], F[part]);
      }
    }
    for (PetscInt part = 0; part < SIMD_PARTS; part++)
      GetNodalForces(scale, &volumes[part], PETSC_FALSE, pressure[part], part, F[part], nodal);
    AddNodal(connectivity, first, in_batch, (const SimdReal(*)[NODES])nodal, f);
  }
}

/* Adds the energies of a batch, one by one, and returns its first member without one; -1: none. With `stress`, the mean Cauchy stress of
   each too */
SIMD_INLINE PetscInt ObserveBatch(const Solid *solid, PetscInt first, PetscInt count, const PetscInt connectivity[], const PetscReal u[],
                                  PetscReal *energy, PetscReal stress[])
{
  const PetscInt n  = PetscMin(SIMD_WIDTH, count - first);
  Gradients      at = {0};
  SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES];
  SimdReal       P[9], W, sum[6] = {{0}}, stored = {0}, volume = {0};
  Volumes        volumes[SIMD_PARTS];
  Dilated        dilated[SIMD_PARTS];
  PetscInt       bad;

  GetModes(connectivity, first, count, solid->coordinates, X);
  GetModes(connectivity, first, count, u, U);
  for (PetscInt part = 0; part < SIMD_PARTS; part++) GetVolumes(solid->linear, X[part], U[part], &volumes[part]);
  for (PetscInt g = 0; g < POINTS; g++) {
    GetDilatedGradients(solid->linear, X, U, volumes, points[g], &at, dilated);
    if (energy) {
      (*solid->kernels.energy)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])at.H, W);
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) stored[p] += at.determinant[p] * W[p];
      continue;
    }
    (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])at.H, P);
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
      PetscReal sigma[6];

      SolidCauchy(at.H, P, solid->linear, p, sigma);
      for (PetscInt k = 0; k < 6; k++) sum[k][p] += at.determinant[p] * sigma[k];
      volume[p] += at.determinant[p];
    }
  }
  for (PetscInt p = 0; p < n && energy; p++) *energy += stored[p];
  for (PetscInt p = 0; p < n && stress; p++)
    for (PetscInt k = 0; k < 6; k++) stress[6 * (first + p) + k] = sum[k][p] / volume[p];
  bad = FindNaN(stored);
  return bad < 0 ? -1 : first + PetscMin(bad, n - 1);
}

SIMD_CLONES static PetscInt AddEnergy(const Solid *solid, PetscInt count, const PetscInt connectivity[], const PetscReal u[],
                                      PetscReal *energy)
{
  PetscInt inverted = -1;

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt bad = ObserveBatch(solid, first, count, connectivity, u, energy, NULL);

    if (inverted < 0) inverted = bad;
  }
  return inverted;
}

SIMD_CLONES static void GetStress(const Solid *solid, PetscInt count, const PetscInt connectivity[], const PetscReal u[],
                                  PetscReal stress[])
{
  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) (void)ObserveBatch(solid, first, count, connectivity, u, NULL, stress);
}

#include <impakt/private/solidops.h>
