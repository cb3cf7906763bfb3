/*
   Sweeps on the interface compliance alone. What comes out of a linear body's rows is affine in the forces on them, so that the sweeps of a
   controller step need two integrations of each body whatever their number: one that changes are counted from, the free trial or one under
   the forces of the step before, and one under the forces that the sweeps have ended with. The iterates are the same, up to round-off.
*/
#include "schwarzimpl.h"

/* What the compliance of n rows over s substeps takes in a sweep, s^2 n^2 / 2 terms, beside substeps of the body: time of a term where rows
   are few, and of one where they are more and BLAS adds them up; of a substep, and of each of its dofs [ns]. Two bars of 200 elements, one
   of which makes 1000 substeps, take as long either way, with 4000 of them 2.5 times as long on the compliance. With 625 rows of an
   explicit body of 8000 hexahedra, whose implicit partner is spared sweeps too, it takes 0.65, 0.71 and 0.82 of the time with 5, 10 and 20.
 */
#define FEW_ROWS     8
#define TIME_FEW     7
#define TIME_MANY    0.1
#define TIME_SUBSTEP 11000
#define TIME_DOF     55

static const char *const Condenses[] = {"0", "1", "auto", "SchwarzCondense", "SCHWARZ_CONDENSE_", NULL};

PetscErrorCode SchwarzReadCondensation(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEnum("-schwarz_condense", "Sweeps on the interface compliance", "ContactSchwarzSetCondense", Condenses,
                             (PetscEnum)schwarz->condense, (PetscEnum *)&schwarz->condense, NULL));
  PetscCall(PetscOptionsInt("-schwarz_dense_limit", "Interface unknowns up to which its matrices are dense", "ContactSchwarzSetDenseLimit",
                            schwarz->dense_limit, &schwarz->dense_limit, NULL));
  PetscOptionsEnd();
  PetscCheck(schwarz->dense_limit >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-schwarz_dense_limit %" PetscInt_FMT " must not be negative", schwarz->dense_limit);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a side of a pair has mass on its contact nodes, ties that keep theirs apart */
static PetscErrorCode SideHasMass(Contact contact, const ContactPair *pair, PetscInt side, PetscBool *has)
{
  PetscFunctionBegin;
  *has = PETSC_FALSE;
  if (pair->obstacle && side == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyPrescribesMass(contact->bodies[pair->body[side]], has));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether contact nodes with mass are prescribed: their force is not the one that would move them */
static PetscErrorCode PrescribesMass(Contact contact, PetscBool *prescribes)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  *prescribes = PETSC_FALSE;
  if (schwarz->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt side = 0; side <= (schwarz->swap ? 1 : 0); side++) {
      PetscBool has;

      PetscCall(SideHasMass(contact, &contact->pairs[p], side, &has));
      *prescribes = (PetscBool)(*prescribes || has);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What keeps sweeps from running on the interface compliance, or NULL */
static PetscErrorCode CondensationPrevented(Contact contact, PetscBool mass, const char *reason[])
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  *reason = NULL;
  if (mass) *reason = "the contact nodes of a Dirichlet side have mass (-<body>_mass_redistribute false)";
  else if (schwarz->convergence == SCHWARZ_CONVERGENCE_POSITION) *reason = "-schwarz_convergence position wants all nodes after each sweep";
  for (PetscInt b = 0; b < contact->n_bodies && !*reason; b++) {
    PetscBool exact;
    PetscInt  substeps;

    PetscCall(BodyComplianceIsExact(contact->bodies[b], &exact));
    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    if (substeps > 1 && contact->ties.by_mean) *reason = "ties act by their mean force over the substeps of a body";
    if (!exact) *reason = "a body is nonlinear, or its integrator is not Newmark's";
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the pairs whose Dirichlet side makes substeps that its partner does not share, or at whose ends contact does not hold: their forces
   are the unknowns, see SchwarzSetUpSides() */
static PetscErrorCode MarkUnshared(Contact contact)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];
    PetscInt     substeps[2];

    if (pair->obstacle) continue;
    for (PetscInt side = 0; side < 2; side++) PetscCall(BodyGetSubsteps(contact->bodies[pair->body[side]], &substeps[side]));
    if (contact->options.shared_times) pair->by_force = (PetscBool)(substeps[0] > 1 || (schwarz->swap && substeps[1] > 1));
    else pair->by_force = (PetscBool)(substeps[1] % substeps[0] != 0 || (schwarz->swap && substeps[0] % substeps[1] != 0));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the forces of a pair are to be unknowns. They are where a side is static, not linear and held by contact alone. With many rows
   they also are where each side moves by its massless layer alone, or is a linear body of one substep with too many rows for a dense
   matrix. */
static PetscErrorCode PairPrefersForces(Contact contact, const ContactPair *pair, PetscBool *prefers)
{
  const Schwarz  *schwarz = (const Schwarz *)contact->data;
  const PetscBool many    = (PetscBool)(contact->rows.n_all > PetscMin(SCHWARZ_DENSE_ROWS, schwarz->dense_limit));
  const PetscBool large   = (PetscBool)(contact->rows.n_all > schwarz->dense_limit);
  PetscBool       floats  = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2 && !floats; side++) {
    PetscBool exact;

    PetscCall(BodyIsFloating(contact->bodies[pair->body[side]], &floats));
    PetscCall(BodyComplianceIsExact(contact->bodies[pair->body[side]], &exact));
    floats = (PetscBool)(floats && !exact);
  }
  *prefers = (PetscBool)(many || floats);
  for (PetscInt side = 0; side < 2; side++) {
    const Body body = contact->bodies[pair->body[side]];
    Mat        K;
    PetscBool  exact, feels;
    PetscInt   substeps;

    PetscCall(BodyGetLayerMatrices(body, &K, NULL));
    PetscCall(BodyComplianceIsExact(body, &exact));
    PetscCall(BodyFeelsEndForce(body, &feels));
    PetscCall(BodyGetSubsteps(body, &substeps));
    if (!K && !(large && exact && feels && substeps == 1) && !(floats && feels)) *prefers = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newton's method finds forces as well as displacements. Where there are many rows, a body under given forces takes one solution with its
   factors, or with those of its massless layer, and one with prescribed displacements as many as conjugate gradients make: there forces
   become the unknowns. So they do where a nonlinear body is held by contact alone: a stiff one that lies on a soft one, prescribed to the
   last digit of its place, would push with the round-off of that times its stiffness. */
PetscErrorCode SchwarzPreferForces(Contact contact)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  if (schwarz->swap || schwarz->mode == SCHWARZ_MASS || schwarz->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN)
    PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];

    if (pair->obstacle || pair->by_force) continue;
    PetscCall(PairPrefersForces(contact, pair, &pair->by_force));
    for (PetscInt i = pair->begin; i < pair->end; i++) contact->rows.by_force[i] = pair->by_force;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a body makes so many substeps that it integrates faster than its compliance tells what they do */
static PetscErrorCode HasManySubsteps(Contact contact, PetscInt b, PetscBool *many)
{
  PetscInt  substeps, dofs, n = contact->body_rows[b].n_all;
  PetscReal term = n > FEW_ROWS ? TIME_MANY : TIME_FEW;
  Vec       positions;

  PetscFunctionBegin;
  PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
  PetscCall(BodyGetReferencePositions(contact->bodies[b], &positions));
  PetscCall(VecGetSize(positions, &dofs));
  *many = (PetscBool)(substeps > 1 && term * substeps * n * n > TIME_SUBSTEP + (PetscReal)TIME_DOF * dofs);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How controller steps in contact are made. Everything but the mass of prescribed nodes changes the way to the solution, not the solution:
   forces of rows that are let go fade in the course of the step wherever contact nodes are massless. */
PetscErrorCode SchwarzChooseMode(Contact contact)
{
  Schwarz    *schwarz = (Schwarz *)contact->data;
  const char *reason;
  PetscBool   prescribes, has, many = PETSC_FALSE;

  PetscFunctionBegin;
  contact->ties.by_mean = (PetscBool)(ContactAllPairsTie(contact) && contact->options.shared_times &&
                                      schwarz->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN &&
                                      schwarz->waveform == SCHWARZ_WAVEFORM_LINEAR);
  PetscCall(PrescribesMass(contact, &prescribes));
  PetscCall(CondensationPrevented(contact, prescribes, &reason));
  PetscCheck(schwarz->condense != SCHWARZ_CONDENSE_ALWAYS || !reason, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-schwarz_condense 1: %s; leave it at auto", reason);
  schwarz->exact         = PETSC_TRUE;
  contact->release.fades = (PetscBool)(schwarz->waveform == SCHWARZ_WAVEFORM_LINEAR);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool exact;
    PetscInt  n;

    PetscCall(BodyComplianceIsExact(contact->bodies[b], &exact));
    PetscCall(BodyGetSubsteps(contact->bodies[b], &n));
    if (!exact || prescribes) schwarz->exact = PETSC_FALSE;
    if (n > 1) schwarz->substeps = PETSC_TRUE;
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(SideHasMass(contact, &contact->pairs[p], 0, &has));
    if (has) contact->release.fades = PETSC_FALSE;
  }
  if (prescribes) contact->energy.unlimited = "nodes with mass take velocity and acceleration from their partner";
  for (PetscInt b = 0; b < contact->n_bodies && schwarz->condense == SCHWARZ_CONDENSE_AUTO && !many; b++)
    PetscCall(HasManySubsteps(contact, b, &many));
  if (prescribes) schwarz->mode = SCHWARZ_MASS;
  else if (reason || many || schwarz->condense == SCHWARZ_CONDENSE_NEVER) schwarz->mode = SCHWARZ_BODIES;
  else schwarz->mode = SCHWARZ_CONDENSED;
  if (!prescribes && schwarz->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN && schwarz->waveform == SCHWARZ_WAVEFORM_LINEAR)
    PetscCall(MarkUnshared(contact));
  if (contact->release.fades) PetscCall(ContactSetUpRelease(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The contact forces of the step before, on a body */
static PetscErrorCode LoadStartForces(Contact contact, PetscInt b)
{
  const ContactBodyRows *of     = &contact->body_rows[b];
  const BodyTraces      *traces = &contact->traces[b];
  PetscInt               levels;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(traces->force_in, NULL, &levels));
  for (PetscInt level = 0; level <= levels; level++) {
    PetscScalar *force;

    PetscCall(TraceGetLevel(traces->force_in, level, &force));
    for (PetscInt k = 0; k < of->n; k++)
      force[k] = ContactSign(&contact->pairs[contact->rows.pair[of->rows[k]]], b) * contact->start.force[of->rows[k]];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An integration of each body under the contact forces of the step before; or what a body that tells it for less would do without contact
 */
static PetscErrorCode MakeBases(Contact contact)
{
  PetscBool *free_rows = contact->work.left_out;

  PetscFunctionBegin;
  PetscCall(ContactSetConditions(contact, CONDITIONS_ACTIVE_FORCES));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodyHasFreeRows(contact->bodies[b], &free_rows[b]));
    if (free_rows[b]) PetscCall(BodySetFreeBase(contact->bodies[b]));
    else PetscCall(LoadStartForces(contact, b));
  }
  PetscCall(ContactIntegrateSome(contact, free_rows));
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (!free_rows[b]) PetscCall(BodySetBase(contact->bodies[b]));
  PetscCall(ContactAgree(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells the bodies' compliance what each row is in this round */
PetscErrorCode SchwarzSetRoles(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactGetConditions(contact, SchwarzConditions((const Schwarz *)contact->data), b, contact->work.conditions);
    PetscCall(BodyProposeRoles(contact->bodies[b], contact->work.conditions, &contact->work.words[b]));
  }
  PetscCall(ContactTellWords(contact, contact->work.words));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyTakeRoles(contact->bodies[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The integrations that condensed sweeps count changes from, and what each row is in this round. Call with the active set known to the
 * bodies. */
PetscErrorCode SchwarzPrepareCondensed(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  if (!schwarz->have_base) {
    PetscCall(MakeBases(contact));
    schwarz->have_base = PETSC_TRUE;
  }
  PetscCall(SchwarzSetRoles(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces that the sweeps have ended with, on the rows whose force they have found, into the input trace of a body */
static PetscErrorCode LoadSolution(Contact contact, PetscInt b)
{
  const BodyTraces *traces = &contact->traces[b];
  PetscInt          levels;

  PetscFunctionBegin;
  ContactGetConditions(contact, SchwarzConditions((const Schwarz *)contact->data), b, contact->work.conditions);
  PetscCall(TraceGetSizes(traces->force_in, NULL, &levels));
  for (PetscInt level = 0; level <= levels; level++) {
    PetscScalar *force, *reaction;

    PetscCall(TraceGetLevel(traces->force_in, level, &force));
    PetscCall(TraceGetLevel(traces->reaction, level, &reaction));
    for (PetscInt k = 0; k < contact->body_rows[b].n; k++)
      if (contact->work.conditions[k] == BODY_PRESCRIBED || contact->work.conditions[k] == BODY_ROBIN) force[k] = reaction[k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The whole bodies under the forces that the sweeps have ended with */
PetscErrorCode SchwarzFinishCondensed(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(LoadSolution(contact, b));
    PetscCall(ContactLoadReleased(contact, b));
  }
  PetscCall(ContactSetConditions(contact, CONDITIONS_ACTIVE_FORCES));
  PetscCall(ContactIntegrateBodies(contact));
  if (!ContactFailed(contact)) PetscCall(ContactComputeGaps(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
