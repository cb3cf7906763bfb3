/* What pointloops.h asks for, of quadrilaterals, triangles and hexahedra. A template: a shape's header, and then this; RING for rings about
   the axis x = 0, which x is the distance from, with WEIGHT times 2 pi.

   Points of rings have the weight 2 pi r. The deformation gradient has F_33 = 1 + u_r / r across the plane, so that the force of a
   point is the stress in the plane against the gradients there, times r, and the stress P_33 along the ring against the shape functions
   (O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, volume 1, section 5.3). On straight-sided quadrilaterals and triangles the
   rules integrate r and products of gradients with it exactly, so that patch tests hold to round-off on any mesh. */
#include <impakt/private/solidbatch.h>
#include <impakt/private/solidaffine.h>

#define SHARE(solid) 1

typedef struct {
  SimdVector inverse[POINTS][SIMD_PARTS][DIM][DIM]; /* of the Jacobian dX_i/dxi_j, transposed */
  PetscInt   step;                                  /* 0: the first one is that of all points */
  SimdReal   weights[POINTS], radius[POINTS];       /* of rings: r [m] */
} Batch;

/* Coefficients of monomials; of rings what they leave of the first component too */
typedef struct {
  SimdVector modes[SIMD_PARTS][DIM][MODES], constant[SIMD_PARTS];
} Values;

typedef Values Forces;

SIMD_INLINE void GetValues(const PetscInt connectivity[], PetscInt first, PetscInt count, const PetscReal values[], Values *v)
{
  GetModes(connectivity, first, count, values, v->modes);
#if defined(RING)
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    SimdVector n[NODES];

    for (PetscInt a = 0; a < NODES; a++) {
      size_t at[SIMD_WIDTH / SIMD_PARTS];

      for (PetscInt p = 0; p < SIMD_WIDTH / SIMD_PARTS; p++)
        at[p] = DIM * (size_t)connectivity[NODES * PetscMin(first + SIMD_WIDTH / SIMD_PARTS * part + p, count - 1) + a];
      n[a] = Gather(values, at);
    }
    ConstantOfNodes(n, &v->constant[part]);
  }
#endif
}

SIMD_INLINE void GetBatch(const Solid *solid, const PetscInt connectivity[], PetscInt first, PetscInt count, Batch *batch)
{
  Values X;

  GetValues(connectivity, first, count, solid->coordinates, &X);
  batch->step = IsAffine(X.modes) ? 0 : 1;
  for (PetscInt g = 0; g < POINTS; g++)
    for (PetscInt part = 0; part < SIMD_PARTS; part++) {
      SimdVector *weight = &SimdGetParts(batch->weights[g])[part], x[DIM][DIM], cofactor[DIM][DIM], over;

      if (g * batch->step == g) {
        for (PetscInt i = 0; i < DIM; i++) GradientOfModes(X.modes[part][i], points[g], x[i]);
        Cofactors(x, cofactor, weight);
        over = 1 / *weight;
        for (PetscInt i = 0; i < DIM; i++)
          for (PetscInt k = 0; k < DIM; k++) batch->inverse[g][part][i][k] = over * cofactor[i][k];
      } else *weight = SimdGetParts(batch->weights[0])[part];
    }
#if defined(RING)
  for (PetscInt g = POINTS - 1; g >= 0; g--)
    for (PetscInt part = 0; part < SIMD_PARTS; part++) {
      SimdVector *radius = &SimdGetParts(batch->radius[g])[part];

      ValueOfModes(&X.constant[part], X.modes[part][0], points[g], radius);
      SimdGetParts(batch->weights[g])[part] *= *radius;
    }
#endif
}

SIMD_INLINE void GetGradient(const Batch *batch, PetscInt g, Values *v, SimdReal H[9])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const SimdVector(*inverse)[DIM] = batch->inverse[g * batch->step][part];

#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++) {
      SimdVector u[DIM];

      GradientOfModes(v->modes[part][i], points[g], u);
#pragma GCC unroll 3
      for (PetscInt j = 0; j < DIM; j++) {
        SimdVector h = u[0] * inverse[j][0];

#pragma GCC unroll 3
        for (PetscInt k = 1; k < DIM; k++) h += u[k] * inverse[j][k];
        SimdGetParts(H[3 * i + j])[part] = h;
      }
    }
#if defined(RING)
    ValueOfModes(&v->constant[part], v->modes[part][0], points[g], &SimdGetParts(H[8])[part]);
    SimdGetParts(H[8])[part] /= SimdGetParts((PetscReal *)batch->radius[g])[part];
#else
    if (DIM == 2) SimdGetParts(H[8])[part] = (SimdVector){0};
#endif
  }
}

SIMD_INLINE void AddForce(const Batch *batch, PetscInt g, SimdReal P[9], Forces *F)
{
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++)
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt j = 0; j < DIM; j++) P[3 * i + j][p] *= batch->weights[g][p];
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    AddPointOfPart(part, P, batch->inverse[g * batch->step][part], points[g], F->modes[part]);
#if defined(RING)
    const SimdVector hoop = SimdGetParts(P[8])[part] * SimdGetParts((PetscReal *)batch->weights[g])[part] /
                            SimdGetParts((PetscReal *)batch->radius[g])[part];

    ModesOfValue(&hoop, points[g], &F->constant[part], F->modes[part][0]);
#endif
  }
}

SIMD_INLINE PetscInt AddToAll(PetscReal scale, const PetscInt connectivity[], PetscInt first, PetscInt in_batch, Forces *F, PetscReal f[])
{
  SimdReal nodal[DIM][NODES], check = {0};
  PetscInt bad;

  for (PetscInt part = 0; part < SIMD_PARTS; part++)
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt k = 0; k < DIM; k++) SimdGetParts(check)[part] += F->modes[part][i][k]; /* every stress goes into these */
  GetNodal(scale, F->modes, nodal);
#if defined(RING)
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const SimdVector constant = scale * F->constant[part];
    SimdVector       n[NODES] = {{0}};

    NodesOfConstant(&constant, n);
    for (PetscInt a = 0; a < NODES; a++) SimdGetParts(nodal[0][a])[part] += n[a];
  }
#endif
  AddNodal(connectivity, first, in_batch, (const SimdReal(*)[NODES])nodal, f);
  bad = FindNaN(check);
  return PetscMin(bad, in_batch - 1);
}

#include <element/pointloops.h>
