/* The active set and what is shared by all methods: conditions, gaps, the free step. */
#include <contact/parts.h>

static void GetConditions(Contact contact, ContactConditions conditions, PetscInt b, BodyCondition rows[])
{
  const ContactBodyRows *of = &contact->body_rows[b];

  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt     i    = of->rows[k];
    const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];

    rows[k] = BODY_FREE;
    if (conditions == CONDITIONS_FREE) continue;
    if (conditions == CONDITIONS_FORCES) rows[k] = BODY_FORCED;
    if (!contact->end.active[i]) continue;
    if (conditions == CONDITIONS_SCHWARZ) rows[k] = pair->body[pair->dirichlet] == b ? BODY_PRESCRIBED : BODY_FORCED;
    if (conditions == CONDITIONS_ROBIN) rows[k] = BODY_ROBIN;
  }
}

/* Tells the bodies what their rows mean */
PetscErrorCode ContactSetConditions(Contact contact, ContactConditions conditions)
{
  PetscBool same = (PetscBool)(conditions == CONDITIONS_FORCES || conditions == CONDITIONS_FREE);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && same; b++) {
    BodyStepProperties properties;

    PetscCall(BodyGetStepProperties(contact->bodies[b], &properties));
    same = conditions == CONDITIONS_FREE ? properties.free : properties.forced;
  }
  for (PetscInt b = 0; b < contact->n_bodies && !same; b++) {
    GetConditions(contact, conditions, b, contact->work.conditions);
    PetscCall(BodySetConditions(contact->bodies[b], contact->work.conditions));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether any row on any rank is active (penetrating = false), or penetrates without being active (true) */
PetscErrorCode ContactAny(Contact contact, PetscBool penetrating, PetscBool *any)
{
  PetscFunctionBegin;
  *any = PETSC_FALSE;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (penetrating ? !contact->end.active[i] && contact->end.gap[i] < -contact->options.tolerance : contact->end.active[i])
      *any = PETSC_TRUE;
  PetscCall(ContactOr(contact, any));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the bodies of a pair have in their traces at the start or the end of the controller step: displacements (`order` 0), velocities or
   accelerations. Where one body has its rows the second trace is that of obstacles, which is zero. */
PetscErrorCode ContactGetPairTraces(Contact contact, const ContactPair *pair, PetscInt order, PetscBool at_end, PetscScalar *level[2])
{
  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) {
    const BodyTraces *of    = &contact->traces[side < ContactPairBodies(pair) ? pair->body[side] : contact->n_bodies];
    const Trace       trace = order == 0 ? of->displacement : order == 1 ? of->velocity : of->acceleration;
    PetscInt          levels;

    PetscCall(TraceGetSizes(trace, NULL, &levels));
    PetscCall(TraceGetLevel(trace, at_end ? levels : 0, &level[side]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaps at the end of the controller step, from the bodies' traces */
PetscErrorCode ContactComputeGaps(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscScalar       *end[2];

    PetscCall(ContactGetPairTraces(contact, pair, 0, PETSC_TRUE, end));
    for (PetscInt k = pair->near_begin; k < pair->near_end; k += ContactGapStride(pair)) {
      const PetscInt i = contact->rows.near[k];

      contact->end.gap[i] = contact->rows.initial_gap[i] + ContactRowSum(pair, end, i);
      if (contact->turns.n) contact->end.gap[i] += contact->turns.turned[i];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* First or second gap rates of this rank's rows at the start or the end of the controller step, from the bodies' traces [m/s, m/s^2] */
PetscErrorCode ContactComputeRates(Contact contact, PetscInt order, PetscBool at_end, PetscScalar rates[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscScalar       *level[2];

    PetscCall(ContactGetPairTraces(contact, pair, order, at_end, level));
    for (PetscInt i = pair->begin; i < pair->end; i++) rates[i] = ContactRowSum(pair, level, i);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The failure of a body's step is that of the controller step; that of a body of one rank alone once ContactAgree() tells the others */
static PetscErrorCode TakeFailure(Contact contact, PetscInt b, StepConvergedReason reason)
{
  BodyStepProperties properties;

  PetscFunctionBegin;
  PetscCall(BodyGetStepProperties(contact->bodies[b], &properties));
  contact->attempt.local = (PetscBool)(contact->attempt.local || properties.local);
  if (reason >= 0) PetscFunctionReturn(PETSC_SUCCESS);
  if (properties.local) contact->attempt.failed = PetscMin(contact->attempt.failed, b);
  else StepFailureCopy(properties.failure, &contact->attempt.failure);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After bodies have been integrated: all ranks get the failure that bodies of one rank report, the first if several. */
PetscErrorCode ContactAgree(Contact contact)
{
  PetscInt           failed = contact->attempt.failed;
  BodyStepProperties properties;
  StepFailure        told;
  PetscMPIInt        rank;

  PetscFunctionBegin;
  if (!contact->attempt.local) PetscFunctionReturn(PETSC_SUCCESS);
  contact->attempt.local  = PETSC_FALSE;
  contact->attempt.failed = PETSC_INT_MAX;
  PetscCall(ContactReduce(contact, 1, MPIU_INT, MPI_MIN, &failed));
  if (failed == PETSC_INT_MAX) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetMeshRank(contact->bodies[failed], &rank));
  PetscCall(BodyGetStepProperties(contact->bodies[failed], &properties));
  told = *properties.failure;
  PetscCallMPI(MPI_Bcast(&told, sizeof(told), MPI_BYTE, rank, PetscObjectComm((PetscObject)contact)));
  StepFailureCopy(&told, &contact->attempt.failure);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One body through the controller step, as far as its rows depend on it, unless the step has failed already; for bodies that wait for each
   other. ContactAgree() follows when all bodies have been integrated. */
PetscErrorCode ContactIntegrateBody(Contact contact, PetscInt b)
{
  StepConvergedReason reason;

  PetscFunctionBegin;
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyTryIntegrateRows(contact->bodies[b], &reason));
  PetscCall(TakeFailure(contact, b, reason));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ranks with rows of bodies and those with the bodies exchange inputs and results of steps, of all but those left out (`NULL`: none) */
static PetscErrorCode BeginExchange(Contact contact, const PetscBool left_out[], PetscBool completes)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && contact->ranks.size > 1; b++)
    if (!left_out || !left_out[b]) PetscCall(BodyBeginExchange(contact->bodies[b], completes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode EndExchange(Contact contact, const PetscBool left_out[])
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && contact->ranks.size > 1; b++)
    if (!left_out || !left_out[b]) PetscCall(BodyEndExchange(contact->bodies[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Integrates bodies that do not wait for each other, but those that are left out (`NULL`: none). ContactAgree() follows. */
PetscErrorCode ContactIntegrateSome(Contact contact, const PetscBool left_out[])
{
  PetscFunctionBegin;
  PetscCall(BeginExchange(contact, left_out, PETSC_FALSE));
  for (PetscInt k = 0; k < contact->n_bodies; k++) {
    const PetscInt b = contact->ranks.visits[k];

    if (!left_out || !left_out[b]) PetscCall(ContactIntegrateBody(contact, b));
  }
  PetscCall(EndExchange(contact, left_out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All bodies, whose rows are loaded, through the controller step */
PetscErrorCode ContactIntegrateBodies(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactIntegrateSome(contact, NULL));
  PetscCall(ContactAgree(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the bodies have left undone in the sweeps of a controller step, once it has been made */
PetscErrorCode ContactCompleteBodies(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(BeginExchange(contact, NULL, PETSC_TRUE));
  for (PetscInt k = 0; k < contact->n_bodies && !ContactFailed(contact); k++) {
    const PetscInt      b = contact->ranks.visits[k];
    StepConvergedReason reason;

    PetscCall(BodyCompleteStep(contact->bodies[b], &reason));
    PetscCall(TakeFailure(contact, b, reason));
  }
  PetscCall(EndExchange(contact, NULL));
  PetscCall(ContactAgree(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The controller step without contact: gaps at its end; whether any row penetrates. The active set is empty afterwards. */
PetscErrorCode ContactIntegrateFree(Contact contact, PetscBool *penetrating)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(contact->end.active, contact->rows.n));
  PetscCall(PetscArrayzero(contact->end.force, contact->rows.n));
  PetscCall(ContactTurn(contact, NULL));
  PetscCall(ContactSetConditions(contact, CONDITIONS_FREE));
  PetscCall(ContactIntegrateBodies(contact));
  *penetrating = PETSC_FALSE;
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactComputeGaps(contact));
  PetscCall(ContactAny(contact, PETSC_TRUE, penetrating));
  PetscFunctionReturn(PETSC_SUCCESS);
}
