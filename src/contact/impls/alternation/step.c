/* One controller step: trial, contact, and the nodes that join and leave. */
#include "alternationimpl.h"

/* The outer iteration with the active set as it is, then forces and gaps */
static PetscErrorCode SolveActive(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  PetscCall(AlternationPredict(contact));
  PetscCall(ContactSetConditions(contact, alternation->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN ? CONDITIONS_SCHWARZ
                                                                                                              : CONDITIONS_ROBIN));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SNESSolve(alternation->snes, NULL, alternation->x));
  PetscCall(AlternationCheckConverged(contact));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AlternationGetForces(contact, contact->end.force));
  PetscCall(ContactComputeGaps(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that penetrate join, rows that are pulled leave; whether there are any. One that joins again after it has left stays to the step's
   end, since over substeps it may be pulled while held and penetrate when not: no set repeats for ever. Collective. */
static PetscErrorCode ChangeSet(Contact contact, PetscBool *changed)
{
  Alternation *alternation = (Alternation *)contact->data;
  int          any         = 0; /* 2: one joins again */

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    PetscBool *active = &contact->end.active[i];
    PetscInt  *left   = &alternation->left[i];

    if (*active ? contact->end.force[i] < 0 && !contact->rows.tied[i] && *left < 2 : contact->end.gap[i] < -contact->options.tolerance) {
      if (*active || *left) ++*left;
      any     = PetscMax(any, PetscMax(1, (int)*left));
      *active = (PetscBool) !*active;
    }
  }
  PetscCall(ContactReduce(contact, 1, MPI_INT, MPI_MAX, &any));
  *changed = (PetscBool)(any > 0);
  if (any > 1 && !alternation->cycled) contact->counts.set_cycles++;
  if (any > 1) alternation->cycled = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Free trial, where no pair is pushed together; the rows that penetrate at its end become active */
static PetscErrorCode Trial(Contact contact, PetscBool *in_contact)
{
  PetscBool changed;

  PetscFunctionBegin;
  PetscCall(ContactIntegrateFree(contact, in_contact));
  if (*in_contact) PetscCall(ChangeSet(contact, &changed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStep_Alternation(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;
  PetscBool    in_contact, changed;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(alternation->left, contact->rows.n));
  alternation->cycled = PETSC_FALSE;
  /* push: in contact in the last step (sustainability), with compressive traction at its end (compression) */
  for (PetscInt i = 0; i < contact->rows.n; i++)
    contact->end.active[i] = (PetscBool)(contact->rows.tied[i] || (contact->start.active[i] && contact->start.force[i] > 0));
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscCall(Trial(contact, &in_contact));
  while (in_contact) {
    const PetscInt sweeps = contact->counts.sweeps;

    PetscCall(SolveActive(contact));
    if (ContactFailed(contact)) break;
    PetscCall(ChangeSet(contact, &changed));
    if (!changed) break;
    contact->counts.set_changes++;
    PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
    if (in_contact) continue;
    PetscCall(Trial(contact, &in_contact));
    if (in_contact && alternation->cycled) contact->counts.sweeps = sweeps; /* the solution that is made again counts once */
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
