/* The loops over all elements of one shape with one point of integration. A template: a shape's header, and then this.

   The stress is that of the mean displacement gradient H of the element (D. P. Flanagan, T. Belytschko, International Journal for Numerical
   Methods in Engineering 17, 1981). What H does not see are the amplitudes q_a of products h_a of the reference coordinates, with what
   linear functions have of them taken off. They are held by the stiffness that linear elasticity gives them in a box of the element's
   edges, with modes that bend as in enhanced.c (M. A. Puso, the same 49, 2000). With the vectors x_k along which the reference coordinates
   run in the middle of the deformed element, and the lengths a_k that these have in the undeformed one, c_ka = x_k . q_a does not change
   with rotations, and the energy is that of the strains

     c_kl / a_k^2, bending, of stress that is plane,  (c_kk + c_ll) / (a_k a_l), twisting,  and c_k4 / (a_k a_l) of xi eta zeta,

   a square, of which the forces are the derivative. */
#include <element/reduced.h>
#include <impakt/private/solidbatch.h>

#define HOURGLASSES (MODES - DIM)

/* Part of a batch: the undeformed element */
typedef struct {
  SimdVector volume, inverse;      /* and 1 / volume */
  SimdVector gradient[DIM][MODES]; /* by X_J of functions, times the volume */
  SimdVector squares[DIM];         /* 1 / a_k^2 */
} Undeformed;

/* The number of the hourglass whose product leaves coordinate k out; in two dimensions there is one for both */
SIMD_INLINE PetscInt Without(PetscInt k)
{
  return DIM == 2 ? 2 : k == 2 ? 3 : 4 + k;
}

/* 1 / s of each by one division, which takes as long as ten products */
SIMD_INLINE void InvertAll(SimdVector s[DIM])
{
#if DIM == 2
  const SimdVector inverse = 1 / (s[0] * s[1]), first = s[0];

  s[0] = inverse * s[1];
  s[1] = inverse * first;
#else
  const SimdVector xy = s[0] * s[1], inverse = 1 / (xy * s[2]), yz = s[1] * s[2], zx = s[2] * s[0];

  s[0] = inverse * yz;
  s[1] = inverse * zx;
  s[2] = inverse * xy;
#endif
}

SIMD_INLINE void GetUndeformed(SimdVector X[DIM][MODES], Undeformed *shape)
{
  SimdVector volume = {0};

#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++) VolumeGradient(X, i, shape->gradient[i]);
#pragma GCC unroll 8
  for (PetscInt k = 0; k < MODES; k++) volume += X[0][k] * shape->gradient[0][k];
  shape->volume  = volume;
  shape->inverse = 1 / volume;
#pragma GCC unroll 3
  for (PetscInt k = 0; k < DIM; k++) {
    shape->squares[k] = X[0][k] * X[0][k];
#pragma GCC unroll 3
    for (PetscInt i = 1; i < DIM; i++) shape->squares[k] += X[i][k] * X[i][k];
  }
  InvertAll(shape->squares);
}

SIMD_INLINE void GetMeanGradient(PetscInt part, const Undeformed *shape, SimdVector U[DIM][MODES], SimdReal H[9])
{
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
    for (PetscInt j = 0; j < DIM; j++) {
      SimdVector h = U[i][0] * shape->gradient[j][0];

    /* not of xi eta zeta, and in two dimensions not of xi eta */
#pragma GCC unroll 8
      for (PetscInt k = 1; k < (DIM == 3 ? 6 : 2); k++) h += U[i][k] * shape->gradient[j][k];
      SimdGetParts(H[3 * i + j])[part] = h * shape->inverse;
    }
}

/* The derivatives of the energy by c_ka, and twice the energy, times a scale */
SIMD_INLINE void GetHourglassForces(const Hourglass *constants, const Undeformed *shape, PetscReal scale, SimdVector c[DIM][HOURGLASSES],
                                    SimdVector s[DIM][HOURGLASSES], SimdVector *twice)
{
  const SimdVector third = shape->volume * (scale / 3);

#if DIM == 2
  *twice = 0 * third;
  for (PetscInt k = 0; k < 2; k++) {
    s[k][0] = third * constants->bending * shape->squares[k] * shape->squares[k] * c[k][0];
    *twice += s[k][0] * c[k][0];
  }
#else
  const SimdVector ninth = shape->volume * (scale / 9);
  SimdVector       twist[3];

  /* about coordinate m; a number of an hourglass is that of the coordinate that it leaves out, and 3 that of all */
#  pragma GCC unroll 3
  for (PetscInt m = 0; m < 3; m++) {
    const PetscInt   k = (m + 1) % 3, l = (m + 2) % 3;
    const SimdVector along = c[k][l] * shape->squares[k], across = c[l][k] * shape->squares[l];

    s[k][l]  = third * shape->squares[k] * (constants->bending * along + constants->coupling * across);
    s[l][k]  = third * shape->squares[l] * (constants->bending * across + constants->coupling * along);
    twist[m] = third * constants->shear * shape->squares[k] * shape->squares[l] * (c[k][k] + c[l][l]);
  }
  *twice = 0 * third;
#  pragma GCC unroll 3
  for (PetscInt k = 0; k < 3; k++) {
    const PetscInt l = (k + 1) % 3, m = (k + 2) % 3;

    s[k][k] = twist[l] + twist[m];
    s[k][3] = ninth * shape->squares[k] * c[k][3] *
              (constants->stretch * shape->squares[k] + constants->shear * (shape->squares[l] + shape->squares[m]));
#  pragma GCC unroll 4
    for (PetscInt a = 0; a < 4; a++) *twice += s[k][a] * c[k][a];
  }
#endif
}

/* The mode that is hourglass a */
SIMD_INLINE PetscInt ModeOf(PetscInt a)
{
  return DIM == 3 && a == 3 ? 6 : Without(a);
}

/* Forces F of hourglasses times a scale, and by how much they lower the stress times volume and scale; twice their energy */
SIMD_INLINE void GetHourglasses(PetscBool linear, PetscInt part, const Hourglass *constants, const Undeformed *shape,
                                SimdVector X[DIM][MODES], SimdVector U[DIM][MODES], SimdReal H[9], PetscReal scale,
                                SimdVector F[DIM][MODES], SimdVector stress[DIM][DIM], SimdVector *twice)
{
  SimdVector q[DIM][HOURGLASSES], c[DIM][HOURGLASSES], s[DIM][HOURGLASSES], x[DIM][DIM];

#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++) {
#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++) {
      x[i][k] = X[i][k];
      if (!linear) x[i][k] += U[i][k];
    }
#pragma GCC unroll 4
    for (PetscInt a = 0; a < HOURGLASSES; a++) {
      q[i][a] = U[i][ModeOf(a)];
#pragma GCC unroll 3
      for (PetscInt j = 0; j < DIM; j++) q[i][a] -= SimdGetParts(H[3 * i + j])[part] * X[j][ModeOf(a)];
    }
#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++)
#pragma GCC unroll 4
      for (PetscInt a = 0; a < HOURGLASSES; a++) c[k][a] = i == 0 ? x[0][k] * q[0][a] : c[k][a] + x[i][k] * q[i][a];
  }
  GetHourglassForces(constants, shape, scale, c, s, twice);
#pragma GCC unroll 3
  for (PetscInt i = 0; i < DIM; i++) {
    SimdVector g[HOURGLASSES];

#pragma GCC unroll 4
    for (PetscInt a = 0; a < HOURGLASSES; a++) {
      g[a] = s[0][a] * x[i][0];
#pragma GCC unroll 3
      for (PetscInt k = 1; k < DIM; k++) g[a] += s[k][a] * x[i][k];
      F[i][ModeOf(a)] = g[a];
    }
#pragma GCC unroll 3
    for (PetscInt k = 0; k < DIM; k++) {
      F[i][k] = (SimdVector){0};
#pragma GCC unroll 4
      for (PetscInt a = 0; a < HOURGLASSES && !linear; a++) F[i][k] += s[k][a] * q[i][a];
    }
#pragma GCC unroll 3
    for (PetscInt j = 0; j < DIM; j++) {
      stress[i][j] = g[0] * X[j][ModeOf(0)];
#pragma GCC unroll 4
      for (PetscInt a = 1; a < HOURGLASSES; a++) stress[i][j] += g[a] * X[j][ModeOf(a)];
    }
  }
}

SIMD_INLINE PetscInt AddBatches(PetscBool linear, const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                const PetscReal u[], PetscReal f[])
{
  const Hourglass *constants = (const Hourglass *)solid->own;
  PetscInt         inverted  = -1;
  SimdReal         H[9]      = {{0}};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], F[SIMD_PARTS][DIM][MODES];
    SimdVector     stress[SIMD_PARTS][DIM][DIM], twice;
    SimdReal       P[9], check;
    Undeformed     shape[SIMD_PARTS];
    PetscInt       bad;

    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    for (PetscInt part = 0; part < SIMD_PARTS; part++) {
      GetUndeformed(X[part], &shape[part]);
      GetMeanGradient(part, &shape[part], U[part], H);
    }
    for (PetscInt part = 0; part < SIMD_PARTS; part++)
      GetHourglasses(linear, part, constants, &shape[part], X[part], U[part], H, scale, F[part], stress[part], &twice);
    (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])H, P);
    for (PetscInt part = 0; part < SIMD_PARTS; part++) {
      for (PetscInt i = 0; i < DIM; i++) {
#pragma GCC unroll 3
        for (PetscInt j = 0; j < DIM; j++) {
          const SimdVector p = scale * SimdGetParts(P[3 * i + j])[part] - stress[part][i][j] * shape[part].inverse;

#pragma GCC unroll 8
          for (PetscInt k = 0; k < (DIM == 3 ? 6 : 2); k++) F[part][i][k] += p * shape[part].gradient[j][k];
        }
      }
      SimdGetParts(check)[part] = F[part][0][0] + F[part][1][0] + F[part][DIM - 1][0];
    }
    bad = inverted < 0 ? FindNaN(check) : -1;
    if (bad >= 0) inverted = first + PetscMin(bad, in_batch - 1);
    AddBatchForces(1, connectivity, first, in_batch, F, f);
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

/* The energy of the hourglasses [J/m of thickness, or J] */
SIMD_CLONES static PetscReal GetHourglassEnergy(const Solid *solid, PetscInt count, const PetscInt connectivity[], const PetscReal u[])
{
  PetscReal energy = 0;
  SimdReal  H[9]   = {{0}};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    SimdVector X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], F[DIM][MODES], stress[DIM][DIM], twice;
    SimdReal   hourglass;
    Undeformed shape;

    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    for (PetscInt part = 0; part < SIMD_PARTS; part++) {
      GetUndeformed(X[part], &shape);
      GetMeanGradient(part, &shape, U[part], H);
      GetHourglasses(solid->linear, part, (const Hourglass *)solid->own, &shape, X[part], U[part], H, 1, F, stress, &twice);
      SimdGetParts(hourglass)[part] = 0.5 * twice;
    }
    for (PetscInt p = 0; p < PetscMin(SIMD_WIDTH, count - first); p++) energy += hourglass[p];
  }
  return energy;
}

SIMD_CLONES static PetscErrorCode GetPoints(Element element, PetscInt first, const PetscScalar u[], SimdReal H[][9], SimdReal weights[])
{
  SimdVector X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES];
  Undeformed shape;

  GetModes(element->connectivity, first, element->count, ((const Solid *)element->data)->coordinates, X);
  GetModes(element->connectivity, first, element->count, u, U);
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    GetUndeformed(X[part], &shape);
    GetMeanGradient(part, &shape, U[part], H[0]);
    SimdGetParts(weights[0])[part] = shape.volume;
  }
  return PETSC_SUCCESS;
}

static PetscErrorCode InternalForce(Element element, const PetscScalar u[], PetscScalar f[])
{
  PetscFunctionBegin;
  element->inverted = AddForces((const Solid *)element->data, element->cross_section, element->count, element->connectivity, u, f);
  PetscCall(PetscLogFlops(element->flops * (PetscLogDouble)element->count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode HourglassEnergy(Element element, const PetscScalar u[], PetscReal *energy)
{
  const Solid *solid = (const Solid *)element->data;

  PetscFunctionBegin;
  *energy = element->cross_section * GetHourglassEnergy(solid, element->count, element->connectivity, u);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateReduced(Element element)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate_Solid_Reduced(element));
  ((Solid *)element->data)->scale   = 1;
  ((Solid *)element->data)->observe = GetPoints;
  element->ops->internalforce       = InternalForce;
  element->ops->hourglass           = HourglassEnergy;
  PetscFunctionReturn(PETSC_SUCCESS);
}
