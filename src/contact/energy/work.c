/*
   What contact forces do to the energy of the bodies in a controller step: the work of the force on each row along its displacement, by the
   trapezoidal rule of the integrators over the substeps of each body, and what springs of penalty forces have taken of it.
*/
#include "energyimpl.h"

/* What a spring that pushes with this force has stored, in parts of whose compression the gap is negative [J] */
static PetscReal SpringEnergy(PetscReal force, PetscReal gap)
{
  return 0.5 * force * PetscMax(-gap, 0);
}

/* Adds the work on body b to that of the pairs */
static PetscErrorCode AddWorkOn(Contact contact, PetscInt b)
{
  ContactEnergy    *energy = &contact->energy;
  const BodyTraces *traces = &contact->traces[b];
  PetscReal        *last = energy->last, *now = energy->now;
  PetscInt          substeps;

  PetscFunctionBegin;
  PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];

    last[i] = ((pair->body[1] == b) - (pair->body[0] == b)) * energy->last_force[i];
  }
  for (PetscInt level = 1; level <= substeps; level++) {
    PetscScalar *before, *after;

    PetscCall(TraceGetLevel(traces->displacement, level - 1, &before));
    PetscCall(TraceGetLevel(traces->displacement, level, &after));
    PetscCall(BodyGetRowForces(contact->bodies[b], level, now));
    for (PetscInt i = 0; i < contact->rows.n; i++) {
      energy->pair_sums[2 * contact->rows.pair[i]] += 0.5 * (last[i] + now[i]) * PetscRealPart(after[i] - before[i]);
      last[i] = now[i];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Energy that the springs of all pairs have gained in the step, into `work` of each pair, where there is one of springs */
static void AddSprings(Contact contact, PetscReal sums[], PetscInt stride)
{
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (!contact->rows.tied[i])
      sums[stride * contact->rows.pair[i]] += SpringEnergy(contact->end.force[i], contact->end.gap[i]) -
                                              SpringEnergy(contact->energy.last_force[i], contact->start.gap[i]);
}

/* Work of contact on the bodies in the step as it has been made without changes at its start, and which pairs touch: for each pair, on all
   ranks. Collective. */
PetscErrorCode ContactComputeWork(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(energy->pair_sums, 2 * contact->n_pairs));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(AddWorkOn(contact, b));
  AddSprings(contact, energy->pair_sums, 2);
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (contact->end.force[i] != 0 || energy->last_force[i] != 0) energy->pair_sums[2 * contact->rows.pair[i] + 1] = 1;
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, energy->pair_sums, (PetscMPIInt)(2 * contact->n_pairs), MPIU_REAL, MPIU_SUM,
                               PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Energy of each body and of the springs of each pair, as they are now, and which pairs touch; collective */
PetscErrorCode ContactComputeEnergies(Contact contact, PetscReal bodies[], PetscReal springs[])
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyComputeEnergy(contact->bodies[b], &bodies[b]));
  PetscCall(PetscArrayzero(springs, 2 * contact->n_pairs));
  AddSprings(contact, springs, 2);
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (contact->end.force[i] != 0 || energy->last_force[i] != 0) springs[2 * contact->rows.pair[i] + 1] = 1;
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, springs, (PetscMPIInt)(2 * contact->n_pairs), MPIU_REAL, MPIU_SUM,
                               PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
