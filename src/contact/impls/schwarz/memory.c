/*
   What the method remembers from step to step: the Jacobian and the active set that it belongs to, which rows the bodies' compliance knows,
   and secants. Controller steps that are cut in halves have their own, level by level, so that a step that has failed leaves no trace in
   those that are made in its place.
*/
#include "schwarzimpl.h"

/* What has been remembered at a level comes back, or begins */
PetscErrorCode SchwarzTakeMemory(Contact contact, PetscInt level, PetscBool *begins)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  SchwarzMemory *present = &schwarz->memory[schwarz->level], *next = &schwarz->memory[level];

  PetscFunctionBegin;
  *present       = (SchwarzMemory){PETSC_TRUE, schwarz->jacobian, schwarz->stale, schwarz->secants, schwarz->known, schwarz->solved_active};
  schwarz->level = level;
  *begins        = (PetscBool)!next->begun;
  if (*begins) {
    const PetscBool has_secants = (PetscBool)(schwarz->secants.dx != NULL);

    PetscCall(PetscCalloc2(contact->rows.n, &schwarz->known, contact->rows.n, &schwarz->solved_active));
    PetscCall(PetscMemzero(&schwarz->secants, sizeof(schwarz->secants)));
    PetscCall(PetscMemzero(&schwarz->jacobian, sizeof(schwarz->jacobian)));
    if (has_secants) PetscCall(SchwarzSetUpSecants(contact));
  } else {
    schwarz->jacobian      = next->jacobian;
    schwarz->stale         = next->stale;
    schwarz->secants       = next->secants;
    schwarz->known         = next->known;
    schwarz->solved_active = next->solved_active;
  }
  *next                 = (SchwarzMemory){.begun = PETSC_TRUE}; /* the rest is in use */
  schwarz->rounds.known = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The controller step is another: so are impedances, compliance and Jacobian */
PetscErrorCode SchwarzSetStepLevel(Contact contact, PetscInt level, PetscBool goes_on)
{
  Schwarz        *schwarz = (Schwarz *)contact->data;
  const PetscReal ratio   = schwarz->controller_step / contact->step; /* a power of two */
  PetscBool       begins;

  PetscFunctionBegin;
  schwarz->controller_step = contact->step;
  if (schwarz->transmission == SCHWARZ_TRANSMISSION_IMPEDANCE) {
    for (PetscInt i = 0; i < contact->rows.n; i++) schwarz->weight[i] *= ratio;
    PetscCall(SchwarzSetRobin(contact));
  }
  PetscCall(SchwarzTakeMemory(contact, level, &begins));
  if (begins) {
    PetscCall(SchwarzCreateJacobian(contact));
    PetscCall(PetscArraycpy(contact->end.active, contact->start.active, contact->rows.n));
  } else if (!goes_on) {
    PetscBool exact;

    /* nonlinear bodies have forgotten their compliance */
    for (PetscInt i = 0; i < contact->rows.n; i++)
      for (PetscInt side = 0; side < 2; side++) {
        const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];

        if (side && pair->obstacle) continue;
        PetscCall(BodyComplianceIsExact(contact->bodies[pair->body[side]], &exact));
        if (!exact) schwarz->known[i] = PETSC_FALSE;
      }
    if (schwarz->secants.dx) SchwarzResetSecants(contact, PETSC_TRUE);
    schwarz->stale = PETSC_TRUE;
  }
  if (schwarz->swap) schwarz->stale = PETSC_TRUE; /* the step that has failed has swapped the sides */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The bodies have forgotten the rows that have become known in the step that has failed */
PetscErrorCode SchwarzStepBack(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const ContactBodyRows *of = &contact->body_rows[b];

    for (PetscInt k = 0; k < of->n; k++) {
      const PetscInt row = of->begin + k;
      PetscInt       unknown;

      PetscCall(BodyCountUnknown(contact->bodies[b], 1, &row, &unknown));
      if (unknown) schwarz->known[of->rows[k]] = PETSC_FALSE;
    }
  }
  schwarz->stale = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyJacobian(Contact contact)
{
  Jacobian *jacobian = &((Schwarz *)contact->data)->jacobian;

  PetscFunctionBegin;
  PetscCall(InterfaceOperatorDestroy(&jacobian->S));
  PetscCall(PetscFree(jacobian->marks));
  PetscCall(PetscFree3(jacobian->residual, jacobian->force, jacobian->change));
  PetscCall(DenseFactorDestroy(&jacobian->chained));
  for (PetscInt k = 0; k < 2; k++) PetscCall(VecDestroy(&jacobian->probe[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroyMemory(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  for (PetscInt k = -1; k <= STEP_MAX_CUTS; k++) {
    if (k >= 0) {
      schwarz->jacobian      = schwarz->memory[k].jacobian;
      schwarz->secants       = schwarz->memory[k].secants;
      schwarz->known         = schwarz->memory[k].known;
      schwarz->solved_active = schwarz->memory[k].solved_active;
    }
    PetscCall(DestroyJacobian(contact));
    PetscCall(SchwarzDestroySecants(contact));
    PetscCall(PetscFree2(schwarz->known, schwarz->solved_active));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
