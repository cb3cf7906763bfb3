/*
   The loops over all elements of one plane shape that are rings about the axis x = 0, which x is the distance from. A template: a shape's
   header, WEIGHT times 2 pi, solidbatch.h, and then this.

   Points of integration have the weight 2 pi r. The deformation gradient has F_33 = 1 + u_r / r across the plane, so that the force of a
   point is the stress in the plane against the gradients there, times r, and the stress P_33 along the ring against the shape functions
   (O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, volume 1, section 5.3). On straight-sided quadrilaterals and triangles the
   rules integrate r and products of gradients with it exactly, so that patch tests hold to round-off on any mesh.

   With a mean dilatation: as in meandilatationloops.h, volumes being those of rings, and the mean that of the points, which is exact.
*/
#include <impakt/private/solidbatch.h>
#include <element/dilatationratio.h>

/* Values at the nodes of a batch: coefficients of monomials, and what they leave of the first component */
typedef struct {
  SimdVector modes[SIMD_PARTS][DIM][MODES], constant[SIMD_PARTS];
} Field;

/* A point of integration of a batch */
typedef struct {
  Gradients at;             /* H with u_r / r in H[8]; with a mean dilatation it becomes H' */
  SimdReal  radius, weight; /* r [m], and det(dX/dxi) r */
  SimdReal  j;              /* J - 1 with F as it is; of linear materials the trace of H */
  Dilated   dilated;
} RingPoint;

/* The components that do not vanish */
#define IN_RING(i) ((i) == 8 || ((i) < 5 && (i) != 2))

SIMD_INLINE void GetField(const PetscInt connectivity[], PetscInt first, PetscInt count, const PetscReal values[], Field *field)
{
  SimdReal nodal[NODES];

  GetModes(connectivity, first, count, values, field->modes);
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscInt *nodes = connectivity + NODES * PetscMin(first + p, count - 1);

    for (PetscInt a = 0; a < NODES; a++) nodal[a][p] = values[(size_t)(DIM * nodes[a])];
  }
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    SimdVector n[NODES];

    for (PetscInt a = 0; a < NODES; a++) n[a] = SimdGetParts(nodal[a])[part];
    ConstantOfNodes(n, &field->constant[part]);
  }
}

/* The first component at a point */
SIMD_INLINE void GetValue(const Field *field, const PetscReal xi[DIM], SimdReal value)
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
    ValueOfModes(&field->constant[part], field->modes[part][0], xi, &SimdGetParts(value)[part]);
}

SIMD_INLINE void GetPoint(PetscBool linear, Field *X, Field *U, const PetscReal xi[DIM], RingPoint *point)
{
  SimdReal u;

  GetGradients(X->modes, U->modes, xi, &point->at);
  GetValue(X, xi, point->radius);
  GetValue(U, xi, u);
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal hoop = u[p] / point->radius[p], xx = point->at.H[0][p], yy = point->at.H[4][p];
    const PetscReal plane = xx + yy + (xx * yy - point->at.H[1][p] * point->at.H[3][p]);

    point->weight[p]  = point->at.determinant[p] * point->radius[p];
    point->at.H[8][p] = linear || 1 + hoop > 0 ? hoop : NAN; /* a ring that has gone through the axis */
    point->j[p]       = linear ? xx + yy + hoop : plane + hoop * (1 + plane);
  }
}

/* What the points have in common */
SIMD_INLINE void GetMeans(PetscBool linear, const RingPoint at[POINTS], Means *means, SimdReal volume)
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) volume[p] = means->change[p] = 0;
  for (PetscInt g = 0; g < POINTS; g++)
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
      volume[p] += at[g].weight[p];
      means->change[p] += at[g].weight[p] * at[g].j[p];
    }
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    means->change[p] /= volume[p];
    means->inverse_theta[p] = linear ? 1 : 1 + means->change[p] > 0 ? 1 / (1 + means->change[p]) : NAN;
  }
}

/* H' in place of H; `finite` also of linear materials where their viscous stress turns with the element */
SIMD_INLINE void Dilate(PetscBool linear, const Means *means, RingPoint *point)
{
  SimdReal *H = point->at.H, *cofactor = point->dilated.cofactor, y;

  if (linear) {
#pragma omp simd
    for (int p = 0; p < SIMD_WIDTH; p++) {
      const PetscReal third = (means->change[p] - point->j[p]) * (1. / 3);

      for (PetscInt i = 0; i < 9; i += 4) H[i][p] += third;
    }
    return;
  }
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal xx = 1 + H[0][p], yy = 1 + H[4][p], hoop = 1 + H[8][p];

    cofactor[0][p] = yy * hoop;
    cofactor[1][p] = -H[3][p] * hoop;
    cofactor[3][p] = -H[1][p] * hoop;
    cofactor[4][p] = xx * hoop;
    cofactor[8][p] = xx * yy - H[1][p] * H[3][p];
  }
  FindRatio(means, point->j, &point->dilated, y);
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal r = 1 + y[p];

    point->dilated.ratio[p] = r;
    for (PetscInt i = 0; i < 9; i++)
      if (IN_RING(i)) H[i][p] = (i % 4 ? 0 : y[p]) + r * H[i][p];
  }
}

/* r P' - (pi / 3) F^-T in place of P'; pi / 3 times the weight is added to the pressure */
SIMD_INLINE void Undilate(PetscBool linear, const RingPoint *point, SimdReal P[9], SimdReal pressure)
{
  const SimdReal *H = point->at.H, *cofactor = point->dilated.cofactor;

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    PetscReal third = P[0][p] + P[4][p] + P[8][p];

    for (PetscInt i = 0; i < 9 && !linear; i++)
      if (IN_RING(i)) third += P[i][p] * H[i][p];
    third *= 1. / 3;
    pressure[p] += point->weight[p] * third;
    for (PetscInt i = 0; i < 9; i++)
      if (IN_RING(i)) {
        if (linear) P[i][p] -= i % 4 ? 0 : third;
        else P[i][p] = point->dilated.ratio[p] * P[i][p] - third * point->dilated.inverse[p] * cofactor[i][p];
      }
  }
}

/* What the mean pressure adds to the stress of a point */
SIMD_INLINE void AddPressure(PetscBool linear, const RingPoint *point, const SimdReal pressure, SimdReal P[9])
{
  for (PetscInt i = 0; i < 9; i++)
    if (IN_RING(i) && (!linear || i % 4 == 0))
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) P[i][p] += pressure[p] * (linear ? 1 : point->dilated.cofactor[i][p]);
}

/* Adds the force of a point, by monomials */
SIMD_INLINE void AddPoint(const RingPoint *point, SimdReal P[9], const PetscReal xi[DIM], Field *F)
{
  SimdReal hoop;

  for (PetscInt p = 0; p < SIMD_WIDTH; p++) hoop[p] = P[8][p] * point->at.determinant[p];
  for (PetscInt i = 0; i < 5; i++)
    if (i != 2)
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) P[i][p] *= point->radius[p];
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    AddPointOfPart(part, P, (SimdVector(*)[DIM])point->at.cofactor[part], xi, F->modes[part]);
    ModesOfValue(&SimdGetParts(hoop)[part], xi, &F->constant[part], F->modes[part][0]);
  }
}

/* Adds the forces of a batch; returns its first member with one that is no number, -1: none */
SIMD_INLINE PetscInt AddRings(PetscReal scale, const PetscInt connectivity[], PetscInt first, PetscInt in_batch, Field *F, PetscReal f[])
{
  SimdReal nodal[DIM][NODES], check;

  GetNodal(scale, F->modes, nodal);
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const SimdVector constant = scale * F->constant[part];
    SimdVector       n[NODES] = {{0}};

    NodesOfConstant(&constant, n);
    for (PetscInt a = 0; a < NODES; a++) SimdGetParts(nodal[0][a])[part] += n[a];
    SimdGetParts(check)[part] = F->modes[part][0][0] + F->modes[part][0][1] + F->modes[part][1][0] + F->modes[part][1][1];
  }
  AddNodal(connectivity, first, in_batch, (const SimdReal(*)[NODES])nodal, f);
  return FindNaN(check);
}

/* What the mean pressure makes of what Undilate() has summed up */
SIMD_INLINE void FinishPressure(const Means *means, const SimdReal volume, SimdReal pressure)
{
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) pressure[p] *= means->inverse_theta[p] / volume[p];
}

SIMD_INLINE PetscInt AddBatches(PetscBool linear, PetscBool mean, const Solid *solid, PetscReal scale, PetscInt count,
                                const PetscInt connectivity[], const PetscReal u[], PetscReal f[])
{
  PetscInt  inverted   = -1;
  RingPoint at[POINTS] = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdReal       P[POINTS][9], pressure = {0}, volume = {0};
    Field          X, U, F                              = {0};
    Means          means = {{0}, {0}};
    PetscInt       bad;

    if (SolidSkips(solid, first)) continue;
    GetField(connectivity, first, count, solid->coordinates, &X);
    GetField(connectivity, first, count, u, &U);
    for (PetscInt g = 0; g < POINTS; g++) GetPoint(linear, &X, &U, points[g], &at[g]);
    if (mean) GetMeans(linear, at, &means, volume);
    for (PetscInt g = 0; g < POINTS; g++) {
      if (mean) Dilate(linear, &means, &at[g]);
      SolidStress(solid, first, g, (const SimdReal *)at[g].at.H, P[g]);
      if (mean) Undilate(linear, &at[g], P[g], pressure);
    }
    if (mean) FinishPressure(&means, volume, pressure);
    for (PetscInt g = 0; g < POINTS; g++) {
      if (mean) AddPressure(linear, &at[g], pressure, P[g]);
      AddPoint(&at[g], P[g], points[g], &F);
    }
    bad = AddRings(scale, connectivity, first, in_batch, &F, f);
    if (inverted < 0 && bad >= 0) inverted = first + PetscMin(bad, in_batch - 1);
  }
  return inverted;
}

/* Returns the first element with a stress that is no number; -1: none */
SIMD_CLONES static PetscInt AddForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                      const PetscReal u[], PetscReal f[])
{
  if (!(solid->mean_share > 0)) return AddBatches(solid->linear, PETSC_FALSE, solid, scale, count, connectivity, u, f);
  return solid->linear ? AddBatches(PETSC_TRUE, PETSC_TRUE, solid, scale, count, connectivity, u, f)
                       : AddBatches(PETSC_FALSE, PETSC_TRUE, solid, scale, count, connectivity, u, f);
}

/* dF' = r (dF + F (d theta / theta - F^-T : dF) / 3) in place of dF, at all points of a batch; r F is F' = 1 + H' */
SIMD_INLINE void DilateRates(const RingPoint at[POINTS], const Means *means, const SimdReal volume, RingPoint rate[POINTS])
{
  SimdReal growth = {0}, along[POINTS];

  for (PetscInt g = 0; g < POINTS; g++)
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
      along[g][p] = 0;
      for (PetscInt i = 0; i < 9; i++)
        if (IN_RING(i)) along[g][p] += at[g].dilated.cofactor[i][p] * rate[g].at.H[i][p];
      growth[p] += at[g].weight[p] * along[g][p] * means->inverse_theta[p] / volume[p];
    }
  for (PetscInt g = 0; g < POINTS; g++)
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
      const PetscReal part = (growth[p] - along[g][p] * at[g].dilated.inverse[p]) * (1. / 3);

      for (PetscInt i = 0; i < 9; i++)
        if (IN_RING(i)) rate[g].at.H[i][p] = at[g].dilated.ratio[p] * rate[g].at.H[i][p] + part * ((i % 4 ? 0 : 1) + at[g].at.H[i][p]);
    }
}

/* The forces of the stress F C : dE/dt, with Green and Lagrange's strain; F' and E' with a mean dilatation */
SIMD_CLONES static void AddViscousForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                         const PetscReal u[], const PetscReal v[], PetscReal f[])
{
  RingPoint at[POINTS] = {0}, rate[POINTS] = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    SimdReal strain[9], S[9], P[POINTS][9], pressure = {0}, volume = {0};
    Field    X, U, V, F = {0};
    Means    means = {{0}, {0}};

    GetField(connectivity, first, count, solid->coordinates, &X);
    GetField(connectivity, first, count, u, &U);
    GetField(connectivity, first, count, v, &V);
    for (PetscInt g = 0; g < POINTS; g++) {
      GetPoint(PETSC_FALSE, &X, &U, points[g], &at[g]);
      GetPoint(PETSC_TRUE, &X, &V, points[g], &rate[g]);
    }
    if (solid->mean_share > 0) {
      GetMeans(PETSC_FALSE, at, &means, volume);
      for (PetscInt g = 0; g < POINTS; g++) Dilate(PETSC_FALSE, &means, &at[g]);
      DilateRates(at, &means, volume, rate);
    }
    for (PetscInt g = 0; g < POINTS; g++) {
      RateOfStrain((const SimdReal *)at[g].at.H, (const SimdReal *)rate[g].at.H, strain);
      (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])strain, S);
      PullBack((const SimdReal *)at[g].at.H, (const SimdReal *)S, P[g]);
      if (solid->mean_share > 0) Undilate(PETSC_FALSE, &at[g], P[g], pressure);
    }
    if (solid->mean_share > 0) FinishPressure(&means, volume, pressure);
    for (PetscInt g = 0; g < POINTS; g++) {
      if (solid->mean_share > 0) AddPressure(PETSC_FALSE, &at[g], pressure, P[g]);
      AddPoint(&at[g], P[g], points[g], &F);
    }
    (void)AddRings(scale, connectivity, first, PetscMin(SIMD_WIDTH, count - first), &F, f);
  }
}

SIMD_CLONES static PetscErrorCode GetPoints(Element element, PetscInt first, const PetscScalar u[], SimdReal H[][9], SimdReal weights[])
{
  const Solid *solid      = (const Solid *)element->data;
  RingPoint    at[POINTS] = {0};
  SimdReal     volume     = {0};
  Field        X, U;
  Means        means = {{0}, {0}};

  GetField(element->connectivity, first, element->count, solid->coordinates, &X);
  GetField(element->connectivity, first, element->count, u, &U);
  for (PetscInt g = 0; g < POINTS; g++) GetPoint(solid->linear, &X, &U, points[g], &at[g]);
  if (solid->mean_share > 0) GetMeans(solid->linear, at, &means, volume);
  for (PetscInt g = 0; g < POINTS; g++) {
    if (solid->mean_share > 0) Dilate(solid->linear, &means, &at[g]);
    StorePoint(&at[g].at, H[g], weights[g]);
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) weights[g][p] *= at[g].radius[p];
  }
  return PETSC_SUCCESS;
}

#include <impakt/private/solidops.h>
