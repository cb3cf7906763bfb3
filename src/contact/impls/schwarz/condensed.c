/*
   Sweeps on the interface compliance alone. What comes out of a linear body's rows is affine in the forces on them, so that the sweeps of a
   controller step need two integrations of each body whatever their number: one that changes are counted from, the free trial or one under
   the forces of the step before, and one under the forces that the sweeps have ended with. The iterates are the same, up to round-off.
*/
#include "schwarzimpl.h"

static const char *const Condenses[] = {"0", "1", "auto", "Condense", "CONDENSE_", NULL};

PetscErrorCode SchwarzReadCondensation(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEnum("-schwarz_condense", "Sweeps on the interface compliance", "", Condenses, (PetscEnum)schwarz->condense,
                             (PetscEnum *)&schwarz->condense, NULL));
  PetscCall(PetscOptionsInt("-schwarz_dense_limit", "Interface unknowns up to which its matrices are dense", "", schwarz->dense_limit,
                            &schwarz->dense_limit, NULL));
  PetscOptionsEnd();
  PetscCheck(schwarz->dense_limit >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-schwarz_dense_limit %" PetscInt_FMT " must not be negative", schwarz->dense_limit);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Why the sweeps cannot be condensed, or NULL; whether Newton's method may use the compliance all the same */
static PetscErrorCode FindObstacle(Contact contact, const char *why[], PetscBool *newton)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  *why    = NULL;
  *newton = PETSC_FALSE;
  if (schwarz->transmission != TRANSMISSION_DIRICHLET_NEUMANN) *why = "-schwarz_transmission is not dirichlet_neumann";
  else if (schwarz->swap) *why = "-contact_swap_sides is on";
  else if (schwarz->convergence == CONVERGENCE_POSITION) *why = "-schwarz_convergence position wants all nodes after each sweep";
  for (PetscInt p = 0; p < contact->n_pairs && !*why; p++) {
    PetscBool massless;

    PetscCall(BodyIsRedistributed(contact->bodies[contact->pairs[p].body[0]], &massless));
    if (!massless) *why = "the contact nodes of a Dirichlet side have mass (-<body>_mass_redistribute false)";
  }
  if (*why) PetscFunctionReturn(PETSC_SUCCESS);
  *newton = PETSC_TRUE;
  for (PetscInt b = 0; b < contact->n_bodies && !*why; b++) {
    PetscBool exact;

    PetscCall(BodyComplianceIsExact(contact->bodies[b], &exact));
    if (!exact) *why = "a body is nonlinear, or its integrator is not Newmark's";
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the pairs whose Dirichlet side makes substeps that its partner does not share: their forces are the unknowns, see
   SchwarzSetUpSides() */
static PetscErrorCode MarkUnshared(Contact contact, PetscBool *any)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  *any = PETSC_FALSE;
  for (PetscInt p = 0; p < contact->n_pairs && schwarz->waveform == WAVEFORM_LINEAR; p++) {
    ContactPair *pair = &contact->pairs[p];
    PetscInt     substeps[2];

    if (pair->obstacle) continue;
    for (PetscInt side = 0; side < 2; side++) PetscCall(BodyGetSubsteps(contact->bodies[pair->body[side]], &substeps[side]));
    pair->by_force = (PetscBool)(substeps[1] % substeps[0] != 0);
    if (pair->by_force) *any = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether Newton's method uses the bodies' compliance, and whether sweeps run on it. In one dimension the response to whole conditions,
   which is there already, is as good, unless forces are unknowns: where a node has several partners, or substeps are not shared. */
PetscErrorCode SchwarzChooseCondensation(Contact contact)
{
  Schwarz    *schwarz = (Schwarz *)contact->data;
  const char *why;
  PetscBool   newton, unshared, substeps = PETSC_FALSE;
  int         shared = contact->shared.n > 0;

  PetscFunctionBegin;
  PetscCall(ContactOr(contact, &shared));
  PetscCall(FindObstacle(contact, &why, &newton));
  PetscCall(MarkUnshared(contact, &unshared));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt n;

    PetscCall(BodyGetSubsteps(contact->bodies[b], &n));
    if (n > 1) substeps = PETSC_TRUE;
  }
  PetscCheck(schwarz->condense != CONDENSE_ALWAYS || !why, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-schwarz_condense 1: %s; leave it at auto", why);
  schwarz->by_compliance = (PetscBool)(newton && (contact->dim > 1 || shared || unshared || schwarz->condense == CONDENSE_ALWAYS));
  schwarz->exact         = (PetscBool)!why;
  schwarz->uses_secants  = (PetscBool)(schwarz->by_compliance && (why || substeps));
  schwarz->condensed     = (PetscBool)(schwarz->by_compliance && !why && schwarz->condense != CONDENSE_NEVER);
  contact->fades         = (PetscBool)(schwarz->by_compliance && schwarz->waveform == WAVEFORM_LINEAR);
  if (contact->fades) PetscCall(ContactSetUpRelease(contact));
  for (PetscInt p = 0; p < contact->n_pairs && !schwarz->by_compliance; p++) contact->pairs[p].by_force = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An integration under the contact forces of the step before; or what a body that tells it for less would do without contact */
static PetscErrorCode MakeBase(Contact contact, PetscInt b)
{
  const BodyTraces *traces = &contact->traces[b];
  PetscInt          levels;
  PetscBool         free_rows;

  PetscFunctionBegin;
  PetscCall(BodyHasFreeRows(contact->bodies[b], &free_rows));
  if (free_rows) {
    PetscCall(BodySetFreeBase(contact->bodies[b]));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(TraceGetSizes(traces->force_in, NULL, &levels));
  for (PetscInt level = 0; level <= levels; level++) {
    PetscScalar *force;

    PetscCall(TraceGetLevel(traces->force_in, level, &force));
    for (PetscInt i = 0; i < contact->n_rows; i++) {
      const ContactPair *pair = &contact->pairs[contact->row_pair[i]];

      force[i] = ((pair->body[1] == b) - (pair->body[0] == b)) * contact->saved_force[i];
    }
  }
  PetscCall(BodyIntegrate(contact->bodies[b]));
  PetscCall(BodySetBase(contact->bodies[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What changes are counted from in this controller step, and the part that each row plays now. Call with the active set known to the
   bodies. */
PetscErrorCode SchwarzPrepareCondensed(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  if (!schwarz->have_base) {
    PetscCall(ContactSetConditions(contact, CONDITIONS_ACTIVE_FORCES));
    for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(MakeBase(contact, b));
    schwarz->have_base = PETSC_TRUE;
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactGetConditions(contact, CONDITIONS_SCHWARZ, b, contact->conditions);
    PetscCall(BodySetRoles(contact->bodies[b], contact->conditions));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The whole bodies under the forces that the sweeps have ended with, which are in their traces */
PetscErrorCode SchwarzFinishCondensed(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactSetConditions(contact, CONDITIONS_ACTIVE_FORCES));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const BodyTraces *traces = &contact->traces[b];
    PetscInt          levels;

    PetscCall(TraceGetSizes(traces->force_in, NULL, &levels));
    for (PetscInt level = 0; level <= levels; level++) {
      PetscScalar *force, *reaction;

      PetscCall(TraceGetLevel(traces->force_in, level, &force));
      PetscCall(TraceGetLevel(traces->reaction, level, &reaction));
      for (PetscInt i = 0; i < contact->n_rows; i++)
        if (DirichletBody(&contact->pairs[contact->row_pair[i]]) == b) force[i] = reaction[i];
    }
    PetscCall(ContactLoadReleased(contact, b));
    PetscCall(BodyIntegrate(contact->bodies[b]));
  }
  PetscCall(ContactComputeGaps(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
