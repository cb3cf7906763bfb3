/* All bodies under given contact forces: the step of methods that know the forces, or guess them until they fit. */
#include <contact/parts.h>

/* Forces on a body's rows at its substeps, linear from the last accepted step to `end` */
PetscErrorCode ContactLoadRows(Contact contact, PetscInt b, const PetscReal end[])
{
  const ContactBodyRows *of    = &contact->body_rows[b];
  Trace                  trace = contact->traces[b].force_in;
  PetscScalar           *force;
  PetscInt               levels;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(trace, NULL, &levels));
  for (PetscInt level = 0; level <= levels; level++) {
    PetscCall(TraceGetLevel(trace, level, &force));
    for (PetscInt k = 0; k < of->n; k++) {
      const PetscInt  i     = of->rows[k];
      const PetscReal start = contact->start.force[i];

      force[k] = start + (end[i] - start) * level / levels;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactIntegrateForces - advances all bodies from their saved states through one controller step, any number of times in it, under forces
   that go linearly from those of the last accepted step to `force`, of each row of this rank at the end of the step, compression positive
   [N]. Afterwards `contact->end` has forces and gaps at the end, and rows with a force are active. Where a body's step fails there are no
   gaps, and the step is to return too: ContactFailed() tells. Collective. */
PetscErrorCode ContactIntegrateForces(Contact contact, const PetscReal force[])
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(CONTACT_Sweep, contact, 0, 0, 0));
  PetscCall(ContactSetConditions(contact, CONDITIONS_FORCES));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(ContactLoadRows(contact, b, force));
  PetscCall(ContactIntegrateBodies(contact));
  if (!ContactFailed(contact)) PetscCall(ContactComputeGaps(contact));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    contact->end.force[i]  = force[i];
    contact->end.active[i] = (PetscBool)(force[i] != 0);
  }
  contact->counts.sweeps++;
  PetscCall(PetscLogEventEnd(CONTACT_Sweep, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
