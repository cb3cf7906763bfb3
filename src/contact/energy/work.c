/* What contact forces do to the energy of the bodies in a controller step: the work of the force on each row along its displacement, by the
   trapezoidal rule of the integrators over the substeps of each body, and what springs of penalty forces have taken of it. */
#include "energyimpl.h"
#include <impakt/private/bodymeasures.h>

/* For methods whose forces close gaps and store nothing */
PetscReal ContactStoresNothing(Contact contact, PetscInt row, PetscReal gap)
{
  (void)contact;
  (void)row;
  (void)gap;
  return 0;
}

/* What springs hold at the end of the step [J]; collective */
PetscErrorCode ContactSumStored(Contact contact)
{
  PetscReal energy = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) energy += (*contact->ops->stored)(contact, i, contact->end.gap[i]);
  PetscCall(ContactReduce(contact, 1, MPIU_REAL, MPIU_SUM, &energy));
  contact->resultants.penalty_energy = energy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactHasForce - whether a row has a force in the step, which it begins with this one */
PetscBool ContactHasForce(Contact contact, PetscInt i, const PetscReal start_force[])
{
  return (PetscBool)(contact->end.active[i] || contact->end.force[i] != 0 || start_force[i] != 0);
}

/* Work of the forces on a body's rows along their displacements [J], which begin the step with `start_force`. That of rows across normals
   is taken from `loss`, of each row, that of others is added to `sums`, two numbers of each pair; NULL: it is not asked for. */
PetscErrorCode ContactAddWork(Contact contact, PetscInt b, const PetscReal start_force[], PetscReal loss[], PetscReal sums[])
{
  const ContactBodyRows *of   = &contact->body_rows[b];
  const Trace            u    = contact->traces[b].displacement;
  PetscReal             *last = contact->energy.last, *now = contact->energy.now;
  PetscBool              any = PETSC_FALSE;
  BodyStepProperties     properties;
  PetscScalar           *first;
  PetscInt               substeps;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < of->n_acting; j++) {
    last[of->acting[j]] = start_force[of->rows[of->acting[j]]];
    any                 = (PetscBool)(any || ContactHasForce(contact, of->rows[of->acting[j]], start_force));
  }
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
  PetscCall(BodyGetStepProperties(contact->bodies[b], &properties));
  PetscCall(TraceGetLevel(u, 0, &first));
  for (PetscInt level = 1; level <= substeps; level++) {
    PetscScalar *before, *after;

    PetscCall(TraceGetLevel(u, level - 1, &before));
    PetscCall(TraceGetLevel(u, level, &after));
    PetscCall(BodyGetRowForces(contact->bodies[b], level, now));
    for (PetscInt j = 0; j < of->n_acting; j++) {
      const PetscInt  k = of->acting[j], i = of->rows[k];
      const PetscBool across  = ContactRowRubs(contact, i);
      const PetscBool by_mean = (PetscBool)(properties.by_mean && properties.by_mean[k]); /* one force in all substeps */
      const PetscReal work    = 0.5 * (last[k] + now[k]) * PetscRealPart(after[k] - (by_mean ? first : before)[k]);

      if ((by_mean && level < substeps) || !(across ? loss : sums) || !ContactHasForce(contact, i, start_force)) continue;
      last[k] = now[k];
      if (across) loss[i] -= work;
      else sums[2 * contact->rows.pair[i]] += work;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the energy that each pair's springs have gained in the step, damage included. `across`: those across normals too */
static void AddSprings(Contact contact, PetscBool across, PetscReal sums[])
{
  if (contact->ops->stored == ContactStoresNothing) return;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (across || !ContactRowRubs(contact, i))
      sums[2 * contact->rows.pair[i]] += (*contact->ops->stored)(contact, i, contact->end.gap[i]) - contact->energy.last_stored[i] +
                                         contact->energy.broken[i];
}

/* What ranks have of numbers of pairs, with the forces of these */
static PetscErrorCode AddUp(Contact contact, PetscReal sums[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    sums[2 * contact->rows.pair[i] + 1] += PetscMax(PetscAbsReal(contact->end.force[i]), PetscAbsReal(contact->energy.accepted_force[i]));
  PetscCall(ContactReduce(contact, 2 * contact->n_pairs, MPIU_REAL, MPIU_SUM, sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Work of contact on the bodies in the step made without changes at its start, and forces of touching pairs, on all ranks. Collective. */
PetscErrorCode ContactComputeWork(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(energy->pair_sums, 2 * contact->n_pairs));
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    PetscCall(ContactAddWork(contact, b, energy->last_force, NULL, energy->pair_sums)); /* what friction takes is no room */
  AddSprings(contact, PETSC_FALSE, energy->pair_sums);
  PetscCall(AddUp(contact, energy->pair_sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Energy of each body now, of each pair's springs with what friction takes in the step, and which pairs touch; collective */
PetscErrorCode ContactComputeEnergies(Contact contact, PetscReal bodies[], PetscReal springs[])
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  PetscCall(BodyComputeEnergies(contact->n_bodies, contact->bodies, energy->sums, bodies));
  PetscCall(PetscArrayzero(springs, 2 * contact->n_pairs));
  AddSprings(contact, PETSC_TRUE, springs);
  PetscCall(AddUp(contact, springs));
  for (PetscInt p = 0; p < contact->n_pairs && contact->friction.pair_step; p++)
    springs[2 * p] += contact->friction.pair_step[p] - contact->friction.pair_work[p];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After rows have got new entries at the start of the step: work along old and new ones differs, so energies are compared. Collective. */
PetscErrorCode ContactNoteRebuild(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  /* in halves of a step the staggered energy of explicit bodies is another */
  if (energy->start_known && contact->attempt.level == 0 && contact->attempt.accepted_level == 0) PetscFunctionReturn(PETSC_SUCCESS);
  energy->start_known = PETSC_FALSE;
  PetscCall(BodyComputeEnergies(contact->n_bodies, contact->bodies, energy->sums, energy->start_energy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells, after ContactAccept(), the energies of the bodies at the start of the next step: kinetic and potential less the work of loads [J].
   They need not be computed again then for the energy that contact gains. */
PetscErrorCode ContactSetStartEnergies(Contact contact, const PetscReal energies[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(energies, 2);
  PetscCall(PetscArraycpy(contact->energy.start_energy, energies, contact->n_bodies));
  contact->energy.start_known = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
