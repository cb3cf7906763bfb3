/* One sweep under given contact forces, the interface compliance of all bodies, and the set of rows that a step holds. */
#include "forces.h"

/* of dense matrices of all rows */
#define MAX_DENSE_ROWS 2000

/* The force that pushes the rows of a body, from `force`, into its input trace; how much more than before at the end of the step */
static PetscErrorCode SetBodyForces(Contact contact, PetscInt b, Trace force, PetscScalar change[])
{
  const BodyTraces *traces = &contact->traces[b];
  PetscScalar      *end;
  PetscInt          levels;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(traces->force_in, NULL, &levels));
  PetscCall(TraceGetLevel(traces->force_in, levels, &end));
  for (PetscInt i = 0; i < contact->n_rows; i++) change[i] = -end[i];
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt side = 0; side < 2; side++)
      if (pair->body[side] == b) PetscCall(TraceResample(force, pair->begin, pair->end, side ? 1 : -1, traces->force_in));
  }
  for (PetscInt i = 0; i < contact->n_rows; i++) change[i] += end[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Advances all bodies under contact forces that go linearly from those of the last step to `factor` times `end`; leaves the gaps
   at the end of the step. */
PetscErrorCode ForcesIntegrate(Contact contact, Forces *forces, const PetscScalar end[], PetscReal factor)
{
  PetscScalar   *from, *to;
  PetscLogDouble begin, finish;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(CONTACT_Sweep, contact, 0, 0, 0));
  PetscCall(PetscTime(&begin));
  PetscCall(TraceGetLevel(forces->trace, 0, &from));
  PetscCall(TraceGetLevel(forces->trace, 1, &to));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    from[i] = contact->saved_force[i];
    to[i]   = factor * end[i];
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(SetBodyForces(contact, b, forces->trace, forces->change));
    if (forces->feels[b] || !forces->integrated) PetscCall(BodyIntegrate(contact->bodies[b]));
    else PetscCall(BodyAddEndForce(contact->bodies[b], forces->change));
  }
  forces->integrated = PETSC_TRUE;
  PetscCall(ContactComputeGaps(contact));
  contact->counts_made.sweeps++;
  PetscCall(PetscTime(&finish));
  contact->counts_made.seconds += finish - begin;
  PetscCall(PetscLogEventEnd(CONTACT_Sweep, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ForcesCreate(Contact contact, Forces *forces)
{
  PetscFunctionBegin;
  PetscCall(TraceCreate(contact->n_rows, 1, &forces->trace));
  PetscCall(PetscCalloc3(contact->n_rows, &forces->held, contact->n_rows, &forces->change, contact->n_bodies, &forces->feels));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyFeelsEndForce(contact->bodies[b], &forces->feels[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ForcesDestroy(Forces *forces)
{
  PetscFunctionBegin;
  PetscCall(TraceDestroy(&forces->trace));
  PetscCall(PetscFree3(forces->held, forces->change, forces->feels));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All rows by all rows: for interfaces of a size that dense matrices suit */
PetscErrorCode ForcesCheckDense(Contact contact, const char type[])
{
  PetscFunctionBegin;
  PetscCheck(contact->n_all_rows <= MAX_DENSE_ROWS, PetscObjectComm((PetscObject)contact), PETSC_ERR_SUP,
             "-contact_type %s with these bodies solves for the forces of all contact nodes at once, and there are %" PetscInt_FMT
             ", more than %d; choose -contact_type schwarz or penalty, or coarser contact surfaces",
             type, contact->n_all_rows, MAX_DENSE_ROWS);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Change of all gaps at the end of the step for unit forces there: the sum of what the bodies of each pair do; all rows by all
   rows, by columns [m/N]. Also makes what repeated sweeps profit from. */
PetscErrorCode ForcesComputeCompliance(Contact contact, PetscScalar compliance[])
{
  const PetscInt n = contact->n_all_rows;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(compliance, n * n));
  PetscCall(ContactSetConditions(contact, CONDITIONS_FORCES));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const PetscScalar *response;

    PetscCall(BodyComputeResponse(contact->bodies[b], &response));
    PetscCall(ContactAddCompliance(contact, b, response, compliance));
  }
  PetscCall(ContactSetConditions(contact, CONDITIONS_FREE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Free trial, where nothing was in contact or is tied; then, if there is contact, all rows are forced. `held`: the rows that were in
   contact, or penetrate at the end of the trial or at the start of the step. What concerns the rate of the gap concerns these alone: while
   forces are sought, a row must not switch on and off with the sign of its gap. */
PetscErrorCode ForcesBeginStep(Contact contact, Forces *forces, PetscBool *in_contact)
{
  PetscFunctionBegin;
  forces->integrated = PETSC_FALSE;
  PetscCall(PetscArraycpy(contact->active, contact->saved_active, contact->n_rows));
  PetscCall(ContactAny(contact, PETSC_FALSE, in_contact));
  if (contact->law == CONTACT_LAW_TIED) *in_contact = PETSC_TRUE;
  if (!*in_contact) PetscCall(ContactIntegrateFree(contact, in_contact));
  if (!*in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->n_rows; i++)
    forces->held[i] = (PetscBool)(contact->saved_active[i] || contact->gap[i] < -contact->tolerance);
  PetscCall(ContactSetConditions(contact, CONDITIONS_FORCES));
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (forces->feels[b]) PetscCall(BodyPrepareSweeps(contact->bodies[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows with a force, and those that penetrate, are held from now on; whether any was not before */
PetscErrorCode ForcesHold(Contact contact, Forces *forces, const PetscScalar force[], PetscBool *changed)
{
  PetscBool *held = forces->held;
  int        any  = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    if (held[i] || !(force[i] > 0 || contact->gap[i] < -contact->tolerance)) continue;
    held[i] = PETSC_TRUE;
    any     = 1;
  }
  PetscCall(ContactOr(contact, &any));
  *changed = (PetscBool)(any > 0);
  if (*changed) contact->counts_made.set_changes++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The controller step [s] */
PetscErrorCode ForcesGetStep(Contact contact, PetscReal *step)
{
  PetscInt substeps;
  TS       ts;

  PetscFunctionBegin;
  PetscCall(BodyGetTS(contact->bodies[0], &ts));
  PetscCall(TSGetTimeStep(ts, step));
  PetscCall(BodyGetSubsteps(contact->bodies[0], &substeps));
  *step *= substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the bodies are, for messages */
PetscErrorCode ForcesGetTime(Contact contact, PetscReal *time)
{
  TS ts;

  PetscFunctionBegin;
  PetscCall(BodyGetTS(contact->bodies[0], &ts));
  PetscCall(TSGetTime(ts, time));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckBeforeObstacle(Contact contact, const ContactPair *pair, const char type[])
{
  const Body  body = contact->bodies[pair->body[0]];
  const char *name = ((PetscObject)body)->name;
  PetscBool   feels;

  PetscFunctionBegin;
  PetscCall(BodyFeelsEndForce(body, &feels));
  PetscCheck(feels, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_type %s closes the gap by the contact force at the end of the step, which does not move the explicit contact nodes "
             "with mass of '%s' before the next step; set -%s_mass_redistribute true, give it -%s_ts_type alpha2, or use -contact_type "
             "lagrange with all bodies explicit, with mass and without substeps",
             type, name, name, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The gap of a pair must answer to the force at the end of the step: explicit nodes with mass do not feel it before the next one
   (and several substeps of theirs feel it less than the force at the start, so that the forces would oscillate and grow) */
PetscErrorCode ForcesCheckBodies(Contact contact, const char type[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const char *name[2];
    PetscBool   answers = PETSC_FALSE;
    PetscInt    substeps[2];

    if (contact->pairs[p].obstacle) {
      PetscCall(CheckBeforeObstacle(contact, &contact->pairs[p], type));
      continue;
    }
    for (PetscInt side = 0; side < 2; side++) {
      const Body body = contact->bodies[contact->pairs[p].body[side]];
      PetscBool  is_explicit, massless;

      PetscCall(BodyIsExplicit(body, &is_explicit));
      PetscCall(BodyIsRedistributed(body, &massless));
      PetscCall(BodyGetSubsteps(body, &substeps[side]));
      name[side] = ((PetscObject)body)->name;
      if (!is_explicit || massless) answers = PETSC_TRUE;
    }
    PetscCheck(answers, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_type %s closes the gap by the contact force at the end of the step, which does not move explicit contact nodes "
               "with mass before the next step, and both '%s' (%" PetscInt_FMT " substeps) and '%s' (%" PetscInt_FMT
               " substeps) have such; set -%s_mass_redistribute true, give one of them -%s_ts_type alpha2, or use -contact_type lagrange "
               "with one step for all bodies, explicit and with mass (-%s_ts_time_step and -%s_ts_time_step equal to -time_step)",
               type, name[0], substeps[0], name[1], substeps[1], name[0], name[0], name[0], name[1]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
