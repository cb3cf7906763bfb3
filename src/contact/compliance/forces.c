/* One sweep under given contact forces, and the rows whose gap rate counts in a step. */
#include "forces.h"
#include <checkpoint/checkpoint.h>

/* of dense matrices of all rows, 32 MB */
#define MAX_DENSE_ROWS 2000

/* The force that pushes the rows of a body, from `force`, into its input trace */
static PetscErrorCode SetBodyForces(Contact contact, PetscInt b, Trace force)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < contact->body_rows[b].n_pairs; k++) {
    const ContactPair *pair = &contact->pairs[contact->body_rows[b].pairs[k]];

    for (PetscInt side = 0; side < 2; side++)
      if (pair->body[side] == b)
        PetscCall(TraceResample(force, pair->begin, pair->end - pair->begin, side ? 1 : -1, contact->traces[b].force_in,
                                pair->begin - pair->shift[side]));
  }
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
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    from[i] = contact->start.force[i];
    to[i]   = factor * end[i];
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(SetBodyForces(contact, b, forces->trace));
  PetscCall(ContactIntegrateBodies(contact));
  if (!ContactFailed(contact)) PetscCall(ContactComputeGaps(contact));
  contact->counts.sweeps++;
  PetscCall(PetscTime(&finish));
  contact->counts.seconds += finish - begin;
  PetscCall(PetscLogEventEnd(CONTACT_Sweep, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ForcesCreate(Contact contact, Forces *forces)
{
  PetscFunctionBegin;
  PetscCall(TraceCreate(contact->rows.n, 1, &forces->trace));
  PetscCall(PetscCalloc1(contact->rows.n, &forces->touching));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint */
PetscErrorCode ForcesVisit(Contact contact, Forces *forces, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointVisitTrace(checkpoint, "forces", forces->trace));
  PetscCall(CheckpointVisitBools(checkpoint, "touching", contact->rows.n, forces->touching));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ForcesDestroy(Forces *forces)
{
  PetscFunctionBegin;
  PetscCall(TraceDestroy(&forces->trace));
  PetscCall(PetscFree(forces->touching));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All rows by all rows: for interfaces of a size that dense matrices suit */
PetscErrorCode ForcesCheckDense(Contact contact, const char type[])
{
  PetscFunctionBegin;
  PetscCheck(contact->rows.n_all <= MAX_DENSE_ROWS, PetscObjectComm((PetscObject)contact), PETSC_ERR_SUP,
             "-contact_type %s with these bodies solves for the forces of all contact nodes at once, and there are %" PetscInt_FMT
             ", more than %d; choose -contact_type schwarz or penalty, or coarser contact surfaces",
             type, contact->rows.n_all, MAX_DENSE_ROWS);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Free trial, where nothing was in contact or is tied; then, if there is contact, all rows are forced. `touching`: the rows that were in
   contact, or penetrate at the end of the trial or at the start of the step. What concerns the rate of the gap concerns these alone: while
   forces are sought, a row must not switch on and off with the sign of its gap. */
PetscErrorCode ForcesBeginStep(Contact contact, Forces *forces, PetscBool *in_contact)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(contact->end.active, contact->start.active, contact->rows.n));
  PetscCall(ContactAny(contact, PETSC_FALSE, in_contact));
  if (ContactAllPairsTie(contact)) *in_contact = PETSC_TRUE;
  if (!*in_contact) PetscCall(ContactIntegrateFree(contact, in_contact));
  if (!*in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++)
    forces->touching[i] = (PetscBool)(contact->start.active[i] || contact->end.gap[i] < -contact->options.tolerance);
  PetscCall(ContactSetConditions(contact, CONDITIONS_FORCES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The gap rate of rows with a force, and of those that penetrate, counts from now on; `changed`: that of any did not before */
PetscErrorCode ForcesTouch(Contact contact, Forces *forces, const PetscScalar force[], PetscBool *changed)
{
  PetscBool *touching = forces->touching;
  int        any      = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (touching[i] || !(force[i] > 0 || contact->end.gap[i] < -contact->options.tolerance)) continue;
    touching[i] = PETSC_TRUE;
    any         = 1;
  }
  PetscCall(ContactOr(contact, &any));
  *changed = (PetscBool)(any > 0);
  if (*changed) contact->counts.set_changes++;
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
