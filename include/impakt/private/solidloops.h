/*
   The loops over all elements of one shape, fully integrated: internal and viscous force, points. A shape's file defines what solidbatch.h
   asks for, and includes this.
*/
#include <impakt/private/solidbatch.h>
#include <impakt/private/solidaffine.h>

/* Returns the first element with a stress that is no number; -1: none. `n_affine`: elements in batches of parallelepipeds. */
SIMD_CLONES static PetscInt AddForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                      const PetscReal u[], PetscReal f[], PetscInt *n_affine)
{
  PetscInt  inverted = -1;
  Gradients at[2]    = {0};
  Frame     frame    = {0};

  *n_affine = 0;
  if (count && POINTS == 1) GetFirstGradients(solid, connectivity, 0, count, u, &at[0]);
  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], F[SIMD_PARTS][DIM][MODES];
    SimdReal       P[9], check = {0};
    PetscBool      affine = PETSC_FALSE, by_terms = PETSC_FALSE;

    ZeroModes(F);
    /* gradients one point ahead, where there is one point that of the next batch: read in whole right after it is written in parts, H would
       have to go through the cache */
    if (POINTS == 1 && first + SIMD_WIDTH < count)
      GetFirstGradients(solid, connectivity, first + SIMD_WIDTH, count, u, &at[(first / SIMD_WIDTH + 1) % 2]);
    if (POINTS > 1) {
      GetModes(connectivity, first, count, solid->coordinates, X);
      GetModes(connectivity, first, count, u, U);
      affine = GetFrame(X, &frame);
      *n_affine += affine ? in_batch : 0;
      by_terms = (PetscBool)(affine && solid->linear);
      for (PetscInt k = 0; k < 2 && affine && !by_terms; k++) SetFrame(&frame, &at[k]);
      if (by_terms) AddTerms(solid, first, &frame, U, F);
      else GetGradientsOf(affine, &frame, X, U, points[0], &at[0]);
    }
    for (PetscInt g = 0; g < POINTS && !by_terms; g++) {
      const PetscInt now = (POINTS == 1 ? first / SIMD_WIDTH : g) % 2;

      if (g + 1 < POINTS) GetGradientsOf(affine, &frame, X, U, points[g + 1], &at[1 - now]);
      SolidStress(solid, first, g, (const SimdReal *)at[now].H, P);
      for (PetscInt part = 0; part < SIMD_PARTS; part++) AddPointOfPart(part, P, at[now].cofactor[part], points[g], F[part]);
    }
    for (PetscInt part = 0; part < SIMD_PARTS && inverted < 0; part++)
      for (PetscInt i = 0; i < DIM; i++)
        for (PetscInt k = 0; k < DIM; k++) SimdGetParts(check)[part] += F[part][i][k]; /* every stress goes into these */
    if (inverted < 0) {
      const PetscInt bad = FindNaN(check);

      if (bad >= 0) inverted = first + PetscMin(bad, in_batch - 1);
    }
    AddBatchForces(scale, connectivity, first, in_batch, F, f);
  }
  return inverted;
}

/* The forces of the stress F C : dE/dt */
SIMD_CLONES static void AddViscousForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                         const PetscReal u[], const PetscReal v[], PetscReal f[])
{
  Gradients at = {0}, rate = {0};

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    const PetscInt in_batch = PetscMin(SIMD_WIDTH, count - first);
    SimdVector     X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES], V[SIMD_PARTS][DIM][MODES], F[SIMD_PARTS][DIM][MODES] = {{{{0}}}};
    SimdReal       strain[9], S[9], P[9] = {{0}};

    GetModes(connectivity, first, count, solid->coordinates, X);
    GetModes(connectivity, first, count, u, U);
    GetModes(connectivity, first, count, v, V);
    for (PetscInt g = 0; g < POINTS; g++) {
      GetGradients(X, U, points[g], &at);
      GetGradients(X, V, points[g], &rate);
      SolidRateOfStrain(at.H, rate.H, strain);
      (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])strain, S);
      SolidPullBack(at.H, S, P);
      for (PetscInt part = 0; part < SIMD_PARTS; part++) AddPointOfPart(part, P, at.cofactor[part], points[g], F[part]);
    }
    AddBatchForces(scale, connectivity, first, in_batch, F, f);
  }
}

SIMD_CLONES static PetscErrorCode GetPoints(Element element, PetscInt first, const PetscScalar u[], SimdReal H[][9], SimdReal weights[])
{
  const Solid *solid = (const Solid *)element->data;
  Gradients    at    = {0};
  SimdVector   X[SIMD_PARTS][DIM][MODES], U[SIMD_PARTS][DIM][MODES];
  Frame        frame;
  PetscBool    affine;

  GetModes(element->connectivity, first, element->count, solid->coordinates, X);
  GetModes(element->connectivity, first, element->count, u, U);
  affine = GetFrame(X, &frame);
  if (affine) SetFrame(&frame, &at);
  for (PetscInt g = 0; g < POINTS; g++) {
    GetGradientsOf(affine, &frame, X, U, points[g], &at);
    StorePoint(&at, H[g], weights[g]);
  }
  return PETSC_SUCCESS;
}

static PetscErrorCode InternalForce(Element element, const PetscScalar u[], PetscScalar f[])
{
  const Solid   *solid = (const Solid *)element->data;
  PetscInt       n_affine;
  PetscLogDouble flops;

  PetscFunctionBegin;
  element->inverted = AddForces(solid, WEIGHT * element->cross_section, element->count, element->connectivity, u, f, &n_affine);
  flops             = CountAffineFlops(solid->linear) * (PetscLogDouble)n_affine;
  PetscCall(PetscLogFlops(flops + element->flops * (PetscLogDouble)(element->count - n_affine)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define SOLID_HAS_FORCE
#include <impakt/private/solidops.h>

static PetscErrorCode Create(Element element, const SolidShape *shape)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate_Solid(element, shape));
  SetLoops(element);
  PetscFunctionReturn(PETSC_SUCCESS);
}
