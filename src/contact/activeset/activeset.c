/* The active set and what is shared by all methods: conditions, gaps, the free step. */
#include <impakt/private/contactimpl.h>

/* Whether a row has been let go in this controller step, and its force is not zero all at once. Bodies of one step take it so by the force
   that their acceleration at the start has in it; one that makes substeps would lose it with the first of them, and momentum with it. */
static PetscBool RowFades(Contact contact, PetscInt i)
{
  return (PetscBool)(contact->fades && !contact->active[i] && contact->release_intervals[i]);
}

/* Room for the forces of rows that are let go: of each at the ends of as many intervals as a body makes substeps */
PetscErrorCode ContactSetUpRelease(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt substeps;

    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    contact->release_room = PetscMax(contact->release_room, substeps + 1);
  }
  PetscCall(PetscCalloc2(contact->n_rows, &contact->release_intervals, contact->n_rows * contact->release_room, &contact->release));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Force of a row that has been let go at a part (0 to 1) of the controller step */
static PetscReal ReleasedForce(Contact contact, PetscInt i, PetscReal part)
{
  const PetscInt   n     = contact->release_intervals[i];
  const PetscReal *force = contact->release + i * contact->release_room, at = part * n;
  const PetscInt   k = PetscMin((PetscInt)PetscFloorReal(at), n - 1);

  return force[k] + (at - k) * (force[k + 1] - force[k]);
}

/* Sum of the forces of a row that has been let go within a controller step of that many substeps, by the trapezoidal rule of integrators,
   and what it is to be for bodies of other substeps to get the same impulse: that of the force itself, and at least what the force at the
   start brings them */
static PetscErrorCode ReleasedSums(Contact contact, PetscInt i, PetscInt levels, PetscReal *sum, PetscReal *wanted)
{
  const ContactPair *pair  = &contact->pairs[contact->row_pair[i]];
  const PetscInt     n     = contact->release_intervals[i];
  const PetscReal   *force = contact->release + i * contact->release_room;
  PetscReal          impulse;

  PetscFunctionBegin;
  impulse = 0.5 * (force[0] + force[n]) / n;
  for (PetscInt k = 1; k < n; k++) impulse += force[k] / n;
  for (PetscInt side = 0; side < 2; side++) {
    PetscInt substeps;

    PetscCall(BodyGetSubsteps(contact->bodies[pair->body[side]], &substeps));
    impulse = PetscMax(impulse, 0.5 * force[0] / substeps);
  }
  *sum = 0;
  for (PetscInt level = 1; level < levels; level++) *sum += ReleasedForce(contact, i, (PetscReal)level / levels);
  *wanted = impulse * levels - 0.5 * force[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where substeps of the two bodies differ so that a force at the times of one is not that at the times of the other */
static PetscErrorCode BalanceReleased(Contact contact, PetscInt b)
{
  Trace        trace = contact->traces[b].force_in;
  PetscInt     levels;
  PetscScalar *force;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(trace, NULL, &levels));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const ContactPair *pair = &contact->pairs[contact->row_pair[i]];
    PetscReal          sum = 0, wanted = 0;

    if (!pair->by_force || !RowFades(contact, i) || (pair->body[0] != b && pair->body[1] != b)) continue;
    PetscCall(ReleasedSums(contact, i, levels, &sum, &wanted));
    for (PetscInt level = 1; level < levels; level++) {
      PetscCall(TraceGetLevel(trace, level, &force));
      if (sum > 0) force[i] *= wanted / sum;
      else if (level == 1) force[i] = (pair->body[1] == b ? 1 : -1) * wanted;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces of rows that are let go, over the substeps of a body */
PetscErrorCode ContactLoadReleased(Contact contact, PetscInt b)
{
  Trace        trace = contact->traces[b].force_in;
  PetscScalar *force;
  PetscInt     levels;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(trace, NULL, &levels));
  for (PetscInt level = 0; level <= levels && contact->fades; level++) {
    PetscCall(TraceGetLevel(trace, level, &force));
    for (PetscInt i = 0; i < contact->n_rows; i++) {
      const ContactPair *pair = &contact->pairs[contact->row_pair[i]];

      if (RowFades(contact, i))
        force[i] = ((pair->body[1] == b) - (pair->body[0] == b)) * ReleasedForce(contact, i, (PetscReal)level / levels);
    }
  }
  PetscCall(BalanceReleased(contact, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the rows mean to a body */
void ContactGetConditions(Contact contact, ContactConditions conditions, PetscInt b, BodyCondition rows[])
{
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const ContactPair *pair  = &contact->pairs[contact->row_pair[i]];
    const PetscBool    takes = (PetscBool)(pair->body[0] == b || pair->body[1] == b);

    rows[i] = BODY_FREE;
    if (!takes || conditions == CONDITIONS_FREE) continue;
    if (conditions == CONDITIONS_FORCES) rows[i] = BODY_FORCED;
    if (RowFades(contact, i) && (conditions == CONDITIONS_SCHWARZ || conditions == CONDITIONS_ACTIVE_FORCES)) rows[i] = BODY_FORCED;
    if (!contact->active[i]) continue;
    if (conditions == CONDITIONS_ACTIVE_FORCES) rows[i] = BODY_FORCED;
    if (conditions == CONDITIONS_SCHWARZ)
      rows[i] = pair->body[pair->dirichlet] == b && !contact->by_force[i] ? BODY_PRESCRIBED : BODY_FORCED;
    if (conditions == CONDITIONS_ROBIN) rows[i] = BODY_ROBIN;
  }
}

/* Tells every body what its rows mean */
PetscErrorCode ContactSetConditions(Contact contact, ContactConditions conditions)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactGetConditions(contact, conditions, b, contact->conditions);
    PetscCall(BodySetConditions(contact->bodies[b], contact->conditions));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds what a body does to all gaps under unit contact forces; `displacement` is its rows' displacement under unit forces on
   them, all rows by all rows. A contact force pushes Neumann sides along the rows and Dirichlet sides against them, and so their
   displacements open and close the gap. */
PetscErrorCode ContactAddCompliance(Contact contact, PetscInt b, const PetscScalar displacement[], PetscScalar compliance[])
{
  const PetscInt n = contact->n_all_rows;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) {
      const ContactPair *pair_i = &contact->pairs[contact->all_row_pair[i]], *pair_j = &contact->pairs[contact->all_row_pair[j]];
      const PetscInt     sign_i = (pair_i->body[1] == b) - (pair_i->body[0] == b), sign_j = (pair_j->body[1] == b) - (pair_j->body[0] == b);

      compliance[j * n + i] += sign_i * sign_j * displacement[j * n + i];
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether any row on any rank is active (penetrating = false), or penetrates without being active (true) */
PetscErrorCode ContactAny(Contact contact, PetscBool penetrating, PetscBool *any)
{
  int found = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++)
    if (penetrating ? !contact->active[i] && contact->gap[i] < -contact->tolerance : contact->active[i]) found = 1;
  PetscCall(ContactOr(contact, &found));
  *any = (PetscBool)(found > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The active set on every rank: 1; rows that have been let go in this controller step with a force that fades: 2 */
PetscErrorCode ContactGatherActive(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) contact->mine_active[i] = contact->active[i] ? 1 : RowFades(contact, i) ? 2 : 0;
  PetscCallMPI(MPI_Allgatherv(contact->mine_active, (PetscMPIInt)contact->n_rows, MPI_INT, contact->all_active, contact->counts,
                              contact->offsets, MPI_INT, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaps at the end of the controller step, from the bodies' traces */
PetscErrorCode ContactComputeGaps(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscScalar       *end[2];

    for (PetscInt side = 0; side < 2; side++) {
      const BodyTraces *traces = &contact->traces[pair->body[side]];
      PetscInt          levels;

      PetscCall(TraceGetSizes(traces->displacement, NULL, &levels));
      PetscCall(TraceGetLevel(traces->displacement, levels, &end[side]));
    }
    for (PetscInt i = pair->begin; i < pair->end; i++) contact->gap[i] = contact->initial_gap[i] + end[1][i] - end[0][i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All bodies through the controller step without contact; the gaps at its end; whether any row penetrates. The active set is
   empty afterwards. */
PetscErrorCode ContactIntegrateFree(Contact contact, PetscBool *penetrating)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(contact->active, contact->n_rows));
  PetscCall(PetscArrayzero(contact->force, contact->n_rows));
  PetscCall(ContactSetConditions(contact, CONDITIONS_ACTIVE_FORCES)); /* of rows that are let go, as none is active */
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(ContactLoadReleased(contact, b));
    PetscCall(BodyIntegrate(contact->bodies[b]));
  }
  PetscCall(ContactComputeGaps(contact));
  PetscCall(ContactAny(contact, PETSC_TRUE, penetrating));
  PetscFunctionReturn(PETSC_SUCCESS);
}
