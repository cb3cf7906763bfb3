/* What the contact forces of each pair amount to: resultant, moment, impulse, area. */
#include <contact/parts.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodystep.h>

/* Adds a share of the state of a pair. With the sign -1 that alone counts which has a direction, and is turned round. */
void ContactAddPairState(ContactPairState *sum, PetscInt sign, const ContactPairState *share)
{
  sum->gap     = PetscMin(sum->gap, share->gap);
  sum->tension = PetscMax(sum->tension, share->tension);
  for (PetscInt d = 0; d < 3; d++) {
    sum->impulse[d] += sign * share->impulse[d];
    sum->force_vector[d] += sign * share->force_vector[d];
    sum->moment[d] += sign * share->moment[d];
  }
  if (sign < 0) return;
  sum->normal_impulse += share->normal_impulse;
  sum->beyond_impulse += share->beyond_impulse;
  sum->friction_loss += share->friction_loss;
  sum->obstacle_work += share->obstacle_work;
  sum->force += share->force;
  sum->active += share->active;
  sum->area += share->area;
  sum->sliding += share->sliding;
}

/* For MPI: adds the states of all pairs on one rank to those on another */
static void MPIAPI AddStates(void *of_one, void *sums, PetscMPIInt *n, MPI_Datatype *type)
{
  (void)type;
  for (PetscMPIInt p = 0; p < *n; p++) ContactAddPairState((ContactPairState *)sums + p, 1, (const ContactPairState *)of_one + p);
}

/* What MPI needs to know of the states of pairs */
PetscErrorCode ContactCreateResultants(Contact contact)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous(sizeof(ContactPairState), MPI_BYTE, &contact->resultants.state));
  PetscCallMPI(MPI_Type_commit(&contact->resultants.state));
  PetscCallMPI(MPI_Op_create(AddStates, 1, &contact->resultants.add));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for the resultants of all pairs, and notes cross-sections */
PetscErrorCode ContactSetUpPairResultants(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactDestroyResultants(contact));
  PetscCall(PetscCalloc4(contact->n_pairs, &contact->resultants.cross_section, contact->n_pairs, &contact->resultants.gaps,
                         CONTACT_IMPULSES * contact->n_pairs, &contact->resultants.impulse, contact->n_pairs, &contact->resultants.states));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    PetscCall(BodyGetScale(contact->bodies[contact->pairs[p].body[0]], BODY_CROSS_SECTION, &contact->resultants.cross_section[p]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for the resultants, and notes the controller step. The bodies must have been set up. */
PetscErrorCode ContactSetUpResultants(Contact contact)
{
  PetscFunctionBegin;
  if (!contact->n_pairs && !contact->neighbours.come_and_go) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactSetUpPairResultants(contact));
  PetscCall(BodyGetControllerStep(contact->bodies[0], &contact->step));
  contact->attempt.whole_step = contact->step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyResultants(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(
      PetscFree4(contact->resultants.cross_section, contact->resultants.gaps, contact->resultants.impulse, contact->resultants.states));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* This rank's shares of what the forces of the rows of a pair amount to [N]: the three components of their sum on the partner of the body
   that has the rows, the sum of the normal ones, and that of those on nodes beyond the end of the partner */
enum { OF_NORMAL = 3, OF_BEYOND, N_FORCES };

static PetscErrorCode SumForces(Contact contact, const ContactPair *pair, const PetscReal row[], PetscReal sums[N_FORCES])
{
  TransferRows rows;

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  PetscCall(PetscArrayzero(sums, N_FORCES));
  for (PetscInt j = pair->acts_begin; j < pair->acts_end; j++) {
    const PetscInt i = contact->rows.acting[j], node = (i - pair->begin) / pair->components, k = (i - pair->begin) % pair->components;

    if (row[i] == 0) continue; /* as most are */
    for (PetscInt d = 0; d < 3; d++) sums[d] += row[i] * contact->rows.normal[3 * i + d];
    sums[OF_NORMAL] += (ContactPairTies(pair) ? rows.normals[contact->dim * node + k] : k == 0) * row[i];
    if (k == 0 && rows.beyond[node]) sums[OF_BEYOND] += row[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces at the start are those that the first controller step begins with */
PetscErrorCode ContactStartImpulses(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscReal *impulse = contact->resultants.impulse + CONTACT_IMPULSES * p, sums[N_FORCES];

    PetscCall(SumForces(contact, &contact->pairs[p], contact->end.force, sums));
    PetscCall(PetscArraycpy(impulse + 3, sums, 3));
    impulse[7] = sums[OF_NORMAL];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the controller step that has been accepted to the impulses */
PetscErrorCode ContactAddImpulses(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscReal *impulse = contact->resultants.impulse + CONTACT_IMPULSES * p, *last = impulse + 3, *normal = impulse + 6, first[N_FORCES],
              end[N_FORCES];

    PetscCall(PetscArraycpy(first, last, 3));
    first[OF_NORMAL] = normal[1];
    if (contact->energy.changed) PetscCall(SumForces(contact, &contact->pairs[p], contact->start.force, first));
    PetscCall(SumForces(contact, &contact->pairs[p], contact->end.force, end));
    for (PetscInt d = 0; d < 3; d++) impulse[d] += 0.5 * contact->step * (first[d] + end[d]);
    PetscCall(PetscArraycpy(last, end, 3));
    normal[0] += 0.5 * contact->step * (first[OF_NORMAL] + end[OF_NORMAL]);
    normal[1] = end[OF_NORMAL];
    impulse[8] += contact->step * end[OF_BEYOND];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a pair has had a force in an accepted step, along rows of this rank */
PetscBool ContactHasTouched(Contact contact, const ContactPair *pair)
{
  return (PetscBool)(contact->resultants.impulse[CONTACT_IMPULSES * (pair - contact->pairs) + 6] != 0);
}

/* This rank's share of the moment of a pair about the origin on the partner of the body that has the rows [N m] */
static PetscErrorCode SumMoments(Contact contact, const ContactPair *pair, PetscReal moment[])
{
  const Body         body = contact->bodies[pair->body[0]];
  const SurfaceData *data;
  const PetscScalar *displacement, *parts = NULL;
  TransferRows       rows;
  Vec                u, of_parts;

  PetscFunctionBegin;
  if (BodyDoes(body, BodyGetAxisymmetric)) PetscFunctionReturn(PETSC_SUCCESS); /* around a ring moments are in balance */
  PetscCall(TransferGetRows(pair->transfer, &rows));
  if (contact->held.merger) {
    PetscCall(ContactGetPartForces(contact, &of_parts));
    PetscCall(VecGetArrayRead(of_parts, &parts));
  }
  PetscCall(SurfaceGetData(pair->surfaces[0], &data));
  PetscCall(BodyGetSolution(body, &u, NULL, NULL));
  PetscCall(VecGetArrayRead(u, &displacement));
  for (PetscInt k = pair->acts_begin; k < pair->acts_end; k++) {
    const PetscInt  i = contact->rows.acting[k], node = (i - pair->begin) / pair->components, dof = contact->rows.dof[i];
    const PetscReal force = parts ? PetscRealPart(parts[i]) : contact->end.force[i];
    PetscReal       x[3]  = {0}, normal[3];

    if (parts) ContactGetDirection(contact, pair, &rows, i, normal);
    else PetscCall(PetscArraycpy(normal, contact->rows.normal + 3 * i, 3));
    for (PetscInt d = 0; d < contact->dim; d++) x[d] = data->reference[3 * node + d] + PetscRealPart(displacement[dof + d]);
    for (PetscInt d = 0; d < 3; d++) moment[d] += force * (x[(d + 1) % 3] * normal[(d + 2) % 3] - x[(d + 2) % 3] * normal[(d + 1) % 3]);
  }
  if (parts) PetscCall(VecRestoreArrayRead(of_parts, &parts));
  PetscCall(VecRestoreArrayRead(u, &displacement));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* This rank's share of the state of pair p, but for what friction and obstacles do */
static PetscErrorCode SumPair(Contact contact, PetscInt p, ContactPairState *state)
{
  const ContactPair *pair    = &contact->pairs[p];
  const PetscReal   *impulse = contact->resultants.impulse + CONTACT_IMPULSES * p;
  const PetscInt     sign    = ContactPairSign(pair);
  PetscInt           counted = -1; /* the node that was counted last: the rows of a tied node follow each other */
  PetscReal          normal  = 0;  /* force along the normal of the rows of a node so far [N] */
  PetscReal          forces[N_FORCES];
  TransferRows       rows;

  PetscFunctionBegin;
  *state = (ContactPairState){.gap = PETSC_MAX_REAL, .normal_impulse = impulse[6], .beyond_impulse = impulse[8]};
  for (PetscInt k = pair->near_begin; k < pair->near_end; k += ContactGapStride(pair))
    state->gap = PetscMin(state->gap, contact->end.gap[contact->rows.near[k]]);
  PetscCall(TransferGetRows(pair->transfer, &rows));
  for (PetscInt j = pair->acts_begin; j < pair->acts_end; j++) {
    const PetscInt  i = contact->rows.acting[j], node = (i - pair->begin) / pair->components, k = (i - pair->begin) % pair->components;
    const PetscReal along = ContactPairTies(pair) ? rows.normals[contact->dim * node + k] : k == 0;

    normal = (k ? normal : 0) + along * contact->end.force[i];
    if (k == pair->components - 1) state->tension = PetscMax(state->tension, -normal);
    if (!contact->end.active[i]) continue;
    /* merged rows of one node may have different areas */
    if (contact->held.merger) state->area += PetscSqr(along) * contact->rows.area[i] * contact->resultants.cross_section[p];
    if (contact->rows.dof[i] == counted) continue;
    state->active++;
    if (contact->friction.slides && contact->friction.slides[i]) state->sliding++;
    if (!contact->held.merger) state->area += contact->rows.area[i] * contact->resultants.cross_section[p];
    counted = contact->rows.dof[i];
  }
  PetscCall(SumForces(contact, pair, contact->end.force, forces));
  PetscCall(SumMoments(contact, pair, state->moment));
  state->force = forces[OF_NORMAL];
  for (PetscInt d = 0; d < 3; d++) {
    state->force_vector[d] = sign * forces[d];
    state->moment[d] *= sign;
    state->impulse[d] = sign * impulse[d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaps of pairs none of whose near rows is close: others may be closer, whose gaps are old */
static PetscErrorCode FindFarGaps(Contact contact, ContactPairState states[])
{
  PetscReal *gaps = contact->resultants.gaps;
  PetscBool  any  = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) any = (PetscBool)(any || states[p].gap > contact->rows.near_reach);
  if (!contact->rows.listed || !any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactRefreshGaps(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    gaps[p] = states[p].gap;
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++) gaps[p] = PetscMin(gaps[p], contact->end.gap[i]);
  }
  PetscCall(ContactReduce(contact, contact->n_pairs, MPIU_REAL, MPIU_MIN, gaps));
  for (PetscInt p = 0; p < contact->n_pairs; p++) states[p].gap = gaps[p];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* States of all pairs */
PetscErrorCode ContactComputePairStates(Contact contact, ContactPairState states[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(SumPair(contact, p, &states[p]));
  PetscCall(ContactReduce(contact, contact->n_pairs, contact->resultants.state, contact->resultants.add, states));
  PetscCall(FindFarGaps(contact, states));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    if (contact->friction.pair_loss) states[p].friction_loss = contact->friction.pair_loss[p];
    if (contact->friction.pair_driven) states[p].obstacle_work = contact->friction.pair_driven[p];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
