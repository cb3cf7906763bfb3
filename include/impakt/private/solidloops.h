/*
   The loops over all elements of one shape: internal force, energy, stress. A template: a shape's file defines

     DIM, NODES, POINTS            space dimension, nodes, points of integration
     MODES                         monomials beyond 1 that its shape functions span, of which the first DIM are the coordinates
     points[POINTS][DIM], WEIGHT   where in the reference element, and the weight of each
     ModesOfNodes(n, m)            coefficients of those monomials in the function with values n at the nodes
     NodesOfModes(m, n)            the transpose
     GradientOfModes(m, xi, d)     gradient in the reference element of the function with coefficients m
     ModesOfGradient(d, xi, m)     adds the transpose to m

   and includes this. Everything of an element but its nodes is found anew from the coordinates each time: it costs less than fetching it
   from memory. By monomials, gradients at a point of a hexahedron take 27 multiplications where nodes would take 72.
*/
#include <impakt/private/solid.h>

/* Gradients of a batch at a point of integration */
typedef struct {
  SimdReal   H[9];                           /* du_i/dX_j; third row and column zero in two dimensions */
  SimdVector cofactor[SIMD_PARTS][DIM][DIM]; /* of dX_i/dxi_j: its inverse is their transpose over the determinant */
  SimdReal   determinant;
} Gradients;

/* Values at the nodes of a batch of elements, as coefficients of monomials; past the last element, it is taken again */
SIMD_INLINE void GetModes(const PetscInt connectivity[], PetscInt first, PetscInt count, const PetscReal values[],
                          SimdVector modes[SIMD_PARTS][DIM][MODES])
{
  SimdReal nodal[DIM][NODES];

  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscInt *nodes = connectivity + NODES * PetscMin(first + p, count - 1);

    for (PetscInt a = 0; a < NODES; a++)
      for (PetscInt i = 0; i < DIM; i++) nodal[i][a][p] = values[DIM * nodes[a] + i];
  }
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
    for (PetscInt i = 0; i < DIM; i++) {
      SimdVector n[NODES];

#pragma GCC unroll 8
      for (PetscInt a = 0; a < NODES; a++) n[a] = SimdGetParts(nodal[i][a])[part];
      ModesOfNodes(n, modes[part][i]);
    }
}

/* Cofactors of a matrix, and its determinant */
SIMD_INLINE void Cofactors(SimdVector a[DIM][DIM], SimdVector c[DIM][DIM], SimdVector *determinant)
{
#if DIM == 2
  c[0][0]      = a[1][1];
  c[0][1]      = -a[1][0];
  c[1][0]      = -a[0][1];
  c[1][1]      = a[0][0];
  *determinant = a[0][0] * c[0][0] + a[0][1] * c[0][1];
#else
  c[0][0]      = a[1][1] * a[2][2] - a[1][2] * a[2][1];
  c[0][1]      = a[1][2] * a[2][0] - a[1][0] * a[2][2];
  c[0][2]      = a[1][0] * a[2][1] - a[1][1] * a[2][0];
  c[1][0]      = a[2][1] * a[0][2] - a[2][2] * a[0][1];
  c[1][1]      = a[2][2] * a[0][0] - a[2][0] * a[0][2];
  c[1][2]      = a[2][0] * a[0][1] - a[2][1] * a[0][0];
  c[2][0]      = a[0][1] * a[1][2] - a[0][2] * a[1][1];
  c[2][1]      = a[0][2] * a[1][0] - a[0][0] * a[1][2];
  c[2][2]      = a[0][0] * a[1][1] - a[0][1] * a[1][0];
  *determinant = a[0][0] * c[0][0] + a[0][1] * c[0][1] + a[0][2] * c[0][2];
#endif
}

SIMD_INLINE void GetGradientsOfPart(PetscInt part, SimdVector X[DIM][MODES], SimdVector U[DIM][MODES], const PetscReal xi[DIM],
                                    Gradients *at)
{
  SimdVector x[DIM][DIM], u[DIM][DIM], c[DIM][DIM], determinant, inverse;

#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++) {
    GradientOfModes(X[i], xi, x[i]);
    GradientOfModes(U[i], xi, u[i]);
  }
  Cofactors(x, c, &determinant);
  inverse                             = 1 / determinant;
  SimdGetParts(at->determinant)[part] = determinant;
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
    for (PetscInt j = 0; j < DIM; j++) {
      SimdVector h = u[i][0] * c[j][0];

#pragma GCC unroll 3
      for (PetscInt k = 1; k < DIM; k++) h += u[i][k] * c[j][k];
      SimdGetParts(at->H[3 * i + j])[part] = inverse * h;
      at->cofactor[part][i][j]             = c[i][j];
    }
}

SIMD_INLINE void GetGradients(SimdVector X[SIMD_PARTS][DIM][MODES], SimdVector U[SIMD_PARTS][DIM][MODES], const PetscReal xi[DIM],
                              Gradients *at)
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) GetGradientsOfPart(part, X[part], U[part], xi, at);
}

/* The same at the first point, with all that it takes */
SIMD_INLINE void GetFirstGradients(const Solid *solid, const PetscInt connectivity[], PetscInt first, PetscInt count, const PetscReal u[],
                                   Gradients *at)
{
  SimdVector X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES];

  GetModes(connectivity, first, count, solid->coordinates, X);
  GetModes(connectivity, first, count, u, U);
  GetGradients(X, U, points[0], at);
}

/* Adds the force of one point, by monomials: the stress against the axes of the reference element against their gradients */
SIMD_INLINE void AddPointOfPart(PetscInt part, SimdReal P[9], SimdVector cofactor[DIM][DIM], const PetscReal xi[DIM],
                                SimdVector F[DIM][MODES])
{
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++) {
    SimdVector q[DIM];

#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++) {
      q[k] = SimdGetParts(P[3 * i])[part] * cofactor[0][k];
#pragma GCC unroll 3
      for (PetscInt j = 1; j < DIM; j++) q[k] += SimdGetParts(P[3 * i + j])[part] * cofactor[j][k];
    }
    ModesOfGradient(q, xi, F[i]);
  }
}

/* The first member of a batch whose number is not one; -1: none */
SIMD_INLINE PetscInt FindNaN(const SimdReal values)
{
  PetscInt any = 0;

  for (PetscInt p = 0; p < SIMD_WIDTH; p++) any |= values[p] != values[p]; /* NOLINT(misc-redundant-expression): the test that vectorises */
  if (any)
    for (PetscInt p = 0; p < SIMD_WIDTH; p++)
      if (isnan(values[p])) return p;
  return -1;
}

/* Returns the first element with a stress that is no number; -1: none */
SIMD_CLONES static PetscInt AddForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                      const PetscReal u[], PetscReal f[])
{
  PetscInt  inverted = -1;
  Gradients at[2]    = {0};

  if (count && POINTS == 1) GetFirstGradients(solid, connectivity, 0, count, u, &at[0]);
  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], F[SIMD_PARTS][DIM][MODES] = {{{{0}}}};
    SimdReal       P[9], nodal[DIM][NODES], check                                                  = {0};

    /* gradients one point ahead, where there is one point that of the next batch: read in whole right after it is written in parts, H would
       have to go through the cache */
    if (POINTS == 1) {
      if (first + SIMD_WIDTH < count)
        GetFirstGradients(solid, connectivity, first + SIMD_WIDTH, count, u, &at[(first / SIMD_WIDTH + 1) % 2]);
    } else {
      GetModes(connectivity, first, count, solid->coordinates, X);
      GetModes(connectivity, first, count, u, U);
      GetGradients(X, U, points[0], &at[0]);
    }
    for (PetscInt g = 0; g < POINTS; g++) {
      const PetscInt now = (POINTS == 1 ? first / SIMD_WIDTH : g) % 2;

      if (g + 1 < POINTS) GetGradients(X, U, points[g + 1], &at[1 - now]);
      SolidStress(solid, first, g, (const SimdReal *)at[now].H, P);
      for (PetscInt part = 0; part < SIMD_PARTS; part++) AddPointOfPart(part, P, at[now].cofactor[part], points[g], F[part]);
    }
    for (PetscInt part = 0; part < SIMD_PARTS; part++)
      for (PetscInt i = 0; i < DIM; i++) {
        SimdVector n[NODES];

        for (PetscInt k = 0; k < DIM; k++) SimdGetParts(check)[part] += F[part][i][k]; /* every stress goes into these */
        for (PetscInt k = 0; k < MODES; k++) F[part][i][k] *= scale;
        NodesOfModes(F[part][i], n);
#pragma GCC unroll 8
        for (PetscInt a = 0; a < NODES; a++) SimdGetParts(nodal[i][a])[part] = n[a];
      }
    if (inverted < 0) {
      const PetscInt bad = FindNaN(check);

      if (bad >= 0) inverted = first + PetscMin(bad, in_batch - 1);
    }
    for (PetscInt p = 0; p < in_batch; p++) {
      const PetscInt *nodes = connectivity + NODES * (first + p);

      for (PetscInt a = 0; a < NODES; a++)
        for (PetscInt i = 0; i < DIM; i++) f[DIM * nodes[a] + i] += nodal[i][a][p];
    }
  }
  return inverted;
}

/* rate = (F^T dH + dH^T F) / 2 with F = 1 + H */
SIMD_INLINE void RateOfStrain(const SimdReal H[9], const SimdReal dH[9], SimdReal rate[9])
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++)
    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt j = 0; j < 3; j++) {
        PetscReal sum = dH[3 * i + j][p] + dH[3 * j + i][p];

        for (PetscInt k = 0; k < DIM; k++) sum += H[3 * k + i][p] * dH[3 * k + j][p] + H[3 * k + j][p] * dH[3 * k + i][p];
        rate[3 * i + j][p] = 0.5 * sum;
      }
}

/* P = F S with F = 1 + H */
SIMD_INLINE void PullBack(const SimdReal H[9], const SimdReal S[9], SimdReal P[9])
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++)
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt j = 0; j < DIM; j++) {
        PetscReal sum = S[3 * i + j][p];

        for (PetscInt k = 0; k < DIM; k++) sum += H[3 * i + k][p] * S[3 * k + j][p];
        P[3 * i + j][p] = sum;
      }
}

/* The forces of the stress F C : dE/dt */
SIMD_CLONES static void AddViscousForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                         const PetscReal u[], const PetscReal v[], PetscReal f[])
{
  Gradients at = {0}, rate = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], V[SIMD_PARTS][DIM][MODES], F[SIMD_PARTS][DIM][MODES] = {{{{0}}}};
    SimdReal       strain[9], S[9], P[9] = {{0}}, nodal[DIM][NODES];

    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    GetModes(connectivity, first, count, v, V);
    for (PetscInt g = 0; g < POINTS; g++) {
      GetGradients(X, U, points[g], &at);
      GetGradients(X, V, points[g], &rate);
      RateOfStrain(at.H, rate.H, strain);
      (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])strain, S);
      PullBack(at.H, S, P);
      for (PetscInt part = 0; part < SIMD_PARTS; part++) AddPointOfPart(part, P, at.cofactor[part], points[g], F[part]);
    }
    for (PetscInt part = 0; part < SIMD_PARTS; part++)
      for (PetscInt i = 0; i < DIM; i++) {
        SimdVector n[NODES];

        for (PetscInt k = 0; k < MODES; k++) F[part][i][k] *= scale;
        NodesOfModes(F[part][i], n);
        for (PetscInt a = 0; a < NODES; a++) SimdGetParts(nodal[i][a])[part] = n[a];
      }
    for (PetscInt p = 0; p < in_batch; p++) {
      const PetscInt *nodes = connectivity + NODES * (first + p);

      for (PetscInt a = 0; a < NODES; a++)
        for (PetscInt i = 0; i < DIM; i++) f[DIM * nodes[a] + i] += nodal[i][a][p];
    }
  }
}

SIMD_CLONES static PetscInt AddEnergy(const Solid *solid, PetscInt count, const PetscInt connectivity[], const PetscReal u[],
                                      PetscReal *energy, PetscReal *plastic)
{
  PetscInt  inverted = -1;
  Gradients at       = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt n = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES];
    SimdReal       W, work, sum = {0}, flowed = {0};
    PetscInt       bad;

    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    for (PetscInt g = 0; g < POINTS; g++) {
      GetGradients(X, U, points[g], &at);
      SolidEnergy(solid, first, g, (const SimdReal *)at.H, W, work);
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) sum[p] += at.determinant[p] * W[p];
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) flowed[p] += at.determinant[p] * work[p];
    }
    bad = FindNaN(sum);
    if (inverted < 0 && bad >= 0) inverted = first + PetscMin(bad, n - 1);
    for (PetscInt p = 0; p < n; p++) *energy += sum[p];
    for (PetscInt p = 0; p < n; p++) *plastic += flowed[p];
  }
  return inverted;
}

/* sigma = P F^T / det F; of linear materials P, for which they are the same */
SIMD_INLINE void Cauchy(SimdReal H[9], SimdReal P[9], PetscBool linear, PetscInt p, PetscReal sigma[6])
{
  const PetscReal xx = 1 + H[0][p], yy = 1 + H[4][p], zz = 1 + H[8][p], xy = H[1][p], xz = H[2][p], yx = H[3][p], yz = H[5][p],
                  zx = H[6][p], zy = H[7][p];
  const PetscReal s = 1 / (xx * (yy * zz - yz * zy) + xy * (yz * zx - yx * zz) + xz * (yx * zy - yy * zx));

  if (linear) {
    sigma[0] = P[0][p];
    sigma[1] = P[4][p];
    sigma[2] = P[8][p];
    sigma[3] = P[1][p];
    sigma[4] = P[5][p];
    sigma[5] = P[2][p];
  } else {
    sigma[0] = s * (P[0][p] * xx + P[1][p] * xy + P[2][p] * xz);
    sigma[1] = s * (P[3][p] * yx + P[4][p] * yy + P[5][p] * yz);
    sigma[2] = s * (P[6][p] * zx + P[7][p] * zy + P[8][p] * zz);
    sigma[3] = s * (P[0][p] * yx + P[1][p] * yy + P[2][p] * yz);
    sigma[4] = s * (P[3][p] * zx + P[4][p] * zy + P[5][p] * zz);
    sigma[5] = s * (P[0][p] * zx + P[1][p] * zy + P[2][p] * zz);
  }
}

SIMD_CLONES static void GetStress(const Solid *solid, PetscInt count, const PetscInt connectivity[], const PetscReal u[],
                                  PetscReal stress[])
{
  Gradients at = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt n = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES];
    SimdReal       P[9], sum[6] = {{0}}, volume = {0};

    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    for (PetscInt g = 0; g < POINTS; g++) {
      GetGradients(X, U, points[g], &at);
      SolidStress(solid, first, g, (const SimdReal *)at.H, P);
      if (solid->plane_stress && !solid->linear) SolidStretchThickness(solid, at.H);
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
        PetscReal sigma[6];

        Cauchy(at.H, P, solid->linear, p, sigma);
        for (PetscInt k = 0; k < 6; k++) sum[k][p] += at.determinant[p] * sigma[k];
        volume[p] += at.determinant[p];
      }
    }
    for (PetscInt p = 0; p < n; p++)
      for (PetscInt k = 0; k < 6; k++) stress[6 * (first + p) + k] = sum[k][p] / volume[p];
  }
}

/* Plastic work of all elements but for the weight of a point, and the mean equivalent plastic strain of each */
SIMD_CLONES static void GetPlastic(const Solid *solid, PetscInt count, const PetscInt connectivity[], PetscReal *work, PetscReal strain[])
{
  const ElementHistory *history = solid->history;
  Gradients             at      = {0};

  *work = 0;
  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt n = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES];
    SimdReal       sum = {0}, volume = {0};

    GetModes(connectivity, first, count, solid->coordinates, X);
    for (PetscInt g = 0; g < POINTS; g++) {
      const PetscReal *point = history->start + SolidHistoryOffset(history, first, g);

      GetGradients(X, X, points[g], &at);
      for (PetscInt p = 0; p < n; p++) {
        *work += at.determinant[p] * point[solid->kernels.plastic_work * SIMD_WIDTH + p];
        sum[p] += at.determinant[p] * point[solid->kernels.plastic_strain * SIMD_WIDTH + p];
        volume[p] += at.determinant[p];
      }
    }
    for (PetscInt p = 0; p < n && strain; p++) strain[first + p] = sum[p] / volume[p];
  }
}

static PetscErrorCode InternalForce(Element element, const PetscScalar u[], PetscScalar f[])
{
  PetscFunctionBegin;
  element->inverted = AddForces((const Solid *)element->data, WEIGHT * element->cross_section, element->count, element->connectivity, u, f);
  PetscCall(PetscLogFlops(element->flops * (PetscLogDouble)element->count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViscousForce(Element element, const PetscScalar u[], const PetscScalar v[], PetscScalar f[])
{
  PetscFunctionBegin;
  AddViscousForces((const Solid *)element->data, WEIGHT * element->cross_section, element->count, element->connectivity, u, v, f);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Energy(Element element, const PetscScalar u[], PetscReal *energy)
{
  PetscFunctionBegin;
  *energy               = 0;
  element->plastic_work = 0;
  element->inverted     = AddEnergy((const Solid *)element->data, element->count, element->connectivity, u, energy, &element->plastic_work);
  *energy *= WEIGHT * element->cross_section;
  element->plastic_work *= WEIGHT * element->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Stress(Element element, const PetscScalar u[], PetscReal stress[])
{
  PetscFunctionBegin;
  GetStress((const Solid *)element->data, element->count, element->connectivity, u, stress);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Plastic(Element element, PetscReal *work, PetscReal strain[])
{
  const Solid *solid = (const Solid *)element->data;

  PetscFunctionBegin;
  GetPlastic(solid, element->count, element->connectivity, work, strain);
  *work *= WEIGHT * element->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(Element element, const SolidShape *shape)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate_Solid(element, shape));
  element->ops->internalforce = InternalForce;
  element->ops->viscousforce  = ViscousForce;
  element->ops->energy        = Energy;
  element->ops->stress        = Stress;
  element->ops->plastic       = Plastic;
  PetscFunctionReturn(PETSC_SUCCESS);
}
