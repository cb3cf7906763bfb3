/* The loops over all elements of one shape, with a mean dilatation or without one, that find displacement gradients at all points of a
   batch before they ask the material. A template: boxpoints.h or compositepoints.h, which define

     Batch, GetBatch(solid, connectivity, first, count, batch)   a batch of undeformed elements, with the weights of its points
     Values, GetValues(connectivity, first, count, values, v)    what the nodes of a batch have
     GetGradient(batch, g, v, H)                                 its gradient at a point; H[8] too, where it may be other than zero
     Forces, AddForce(batch, g, P, F)                            adds the force of a stress, which may be overwritten
     AddToAll(scale, connectivity, first, in_batch, F, f)        adds the forces to those of all nodes; the first member of the batch that
                                                                 has one which is no number, -1: none
     SHARE(solid)                                                share of the mean in the ratio of volumes at a point

   and then this. */
#include <element/dilatation.h>

/* Displacement gradients at all points of a batch; then H' in their place, where there is a mean dilatation */
SIMD_INLINE void FindPoints(PetscBool linear, PetscBool mean, PetscReal share, const Batch *batch, Values *u, SimdReal H[POINTS][9],
                            Dilated at[POINTS], Means *means)
{
  for (PetscInt g = 0; g < POINTS; g++) {
    GetGradient(batch, g, u, H[g]);
    for (PetscInt p = 0; p < SIMD_WIDTH && DIM == 2 && !linear; p++)
      if (!(1 + H[g][8][p] > 0)) H[g][8][p] = NAN; /* a ring that has gone through the axis */
    if (mean) GetVolume(linear, (const SimdReal *)H[g], &at[g]);
  }
  if (!mean) return;
  GetMeans(linear, batch->weights, at, means);
  for (PetscInt g = 0; g < POINTS; g++) Dilate(linear, share, means, H[g], &at[g]);
}

/* The forces of the stresses P', by nodes */
SIMD_INLINE void SumForces(PetscBool linear, PetscBool mean, PetscReal share, const Batch *batch, SimdReal H[POINTS][9],
                           const Dilated at[POINTS], const Means *means, SimdReal P[POINTS][9], Forces *F)
{
  SimdReal pressure = {0};

  for (PetscInt g = 0; g < POINTS && mean; g++) Undilate(linear, share, (const SimdReal *)H[g], &at[g], batch->weights[g], P[g], pressure);
  for (PetscInt p = 0; p < SIMD_WIDTH && mean; p++) pressure[p] *= means->inverse[p] / means->volume[p];
  for (PetscInt g = 0; g < POINTS; g++) {
    if (mean) AddPressure(linear, &at[g], pressure, P[g]);
    AddForce(batch, g, P[g], F);
  }
}

SIMD_INLINE PetscInt AddBatches(PetscBool linear, PetscBool mean, const Solid *solid, PetscReal scale, PetscInt count,
                                const PetscInt connectivity[], const PetscReal u[], PetscReal f[])
{
  SimdReal H[POINTS][9] = {{{0}}}, P[POINTS][9];
  PetscInt inverted     = -1;

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    Batch    batch;
    Values   values;
    Forces   F = {0};
    Dilated  at[POINTS];
    Means    means;
    PetscInt bad;

    GetBatch(solid, connectivity, first, count, &batch);
    GetValues(connectivity, first, count, u, &values);
    FindPoints(linear, mean, SHARE(solid), &batch, &values, H, at, &means);
    for (PetscInt g = 0; g < POINTS; g++) SolidStress(solid, first, g, (const SimdReal *)H[g], P[g]);
    SumForces(linear, mean, SHARE(solid), &batch, H, at, &means, P, &F);
    bad = AddToAll(scale, connectivity, first, PetscMin(SIMD_WIDTH, count - first), &F, f);
    if (inverted < 0 && bad >= 0) inverted = first + bad;
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

/* The forces of the stress F C : dE/dt, with Green and Lagrange's strain; F' and E' with a mean dilatation */
SIMD_CLONES static void AddViscousForces(const Solid *solid, PetscReal scale, PetscInt count, const PetscInt connectivity[],
                                         const PetscReal u[], const PetscReal v[], PetscReal f[])
{
  const PetscBool mean         = (PetscBool)(solid->mean_share > 0);
  SimdReal        H[POINTS][9] = {{{0}}}, rate[POINTS][9] = {{{0}}}, P[POINTS][9], strain[9], S[9];

  for (PetscInt first = 0; first < count; first += SIMD_WIDTH) {
    Batch   batch;
    Values  values;
    Forces  F = {0};
    Dilated at[POINTS];
    Means   means;

    GetBatch(solid, connectivity, first, count, &batch);
    GetValues(connectivity, first, count, u, &values);
    FindPoints(PETSC_FALSE, mean, SHARE(solid), &batch, &values, H, at, &means);
    GetValues(connectivity, first, count, v, &values);
    for (PetscInt g = 0; g < POINTS; g++) GetGradient(&batch, g, &values, rate[g]);
    if (mean) DilateRates(SHARE(solid), batch.weights, H, at, &means, rate);
    for (PetscInt g = 0; g < POINTS; g++) {
      SolidRateOfStrain((const SimdReal *)H[g], (const SimdReal *)rate[g], strain);
      (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])strain, S);
      SolidPullBack((const SimdReal *)H[g], (const SimdReal *)S, P[g]);
    }
    SumForces(PETSC_FALSE, mean, SHARE(solid), &batch, H, at, &means, P, &F);
    (void)AddToAll(scale, connectivity, first, PetscMin(SIMD_WIDTH, count - first), &F, f);
  }
}

SIMD_CLONES static PetscErrorCode GetPoints(Element element, PetscInt first, const PetscScalar u[], SimdReal H[][9], SimdReal weights[])
{
  const Solid *solid = (const Solid *)element->data;
  Batch        batch;
  Values       values;
  Dilated      at[POINTS];
  Means        means;

  GetBatch(solid, element->connectivity, first, element->count, &batch);
  GetValues(element->connectivity, first, element->count, u, &values);
  FindPoints(solid->linear, (PetscBool)(solid->mean_share > 0), SHARE(solid), &batch, &values, H, at, &means);
  for (PetscInt g = 0; g < POINTS; g++)
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) weights[g][p] = batch.weights[g][p];
  return PETSC_SUCCESS;
}

#include <impakt/private/solidops.h>
