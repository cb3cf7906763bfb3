/*
   The next multipliers of the augmented Lagrangian: the forces that the last gave. Each such round makes the gaps smaller by
   1 / (1 + tau A W), with springs tau A and the interface compliance W. Where W is small for some mode of the rows, the changes d_k of the
   forces come to be parallel, each rho times the last. Then the sum of all that would follow, rho / (1 - rho) d_k, is added at once, as in
   Aitken's process for vectors (Macleod 1986). Forces still push alone, and the rounds that follow decide: nothing hangs on a poor guess
   but their number. A stack of five blocks that bounces takes 32 rounds at most, where more than 200 were not enough.

   Reference: A. J. Macleod, Acceleration of vector sequences by multi-dimensional Delta-2 methods, Communications in Applied Numerical
   Methods 2 (1986) 385-392
*/
#include "augmentation.h"

/* Changes are parallel where what is left of one beside the other is this part of it */
#define PARALLEL 0.1
/* Changes that are known, at least, before forces are extrapolated */
#define ROUNDS 3
/* Changes that would follow are added where each is this part of the last, at most */
#define SLOWEST 0.9999

PetscErrorCode AugmentationTakeForces(Contact contact, Augmentation *augmentation, PetscReal multiplier[])
{
  PetscReal *last = augmentation->last, sums[3] = {0, 0, 0}, ratio;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscReal change = contact->end.force[i] - multiplier[i];

    sums[0] += change * change;
    sums[1] += change * last[i];
    sums[2] += last[i] * last[i];
    last[i]       = change;
    multiplier[i] = contact->end.force[i];
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  if (++augmentation->rounds < ROUNDS || !(sums[1] > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  ratio = sums[1] / sums[2];
  if (ratio > SLOWEST || sums[0] - ratio * sums[1] > PetscSqr(PARALLEL) * sums[0]) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    multiplier[i] += ratio / (1 - ratio) * last[i];
    if (!contact->rows.tied[i] && !ContactRowRubs(contact, i)) multiplier[i] = PetscMax(multiplier[i], 0);
  }
  augmentation->rounds = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
