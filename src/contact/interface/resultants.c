/* What the contact forces of each pair amount to: resultant, moment, impulse, area. */
#include <contact/parts.h>
#include <impakt/private/bodymesh.h>

enum {
  SUM_FORCE          = 0,
  SUM_ACTIVE         = 1,
  SUM_AREA           = 2,
  SUM_VECTOR         = 3,
  SUM_MOMENT         = SUM_VECTOR + 3,
  SUM_IMPULSE        = SUM_MOMENT + 3,
  SUM_NORMAL_IMPULSE = SUM_IMPULSE + 3,
  SUM_BEYOND         = SUM_NORMAL_IMPULSE + 1,
  SUM_SLIDING        = SUM_BEYOND + 1,
  N_SUMS             = SUM_SLIDING + 1
};

#define N_KEPT CONTACT_IMPULSES

/* Of what the largest value of a pair's rows is found */
enum { MAX_PENETRATION, MAX_TENSION, N_MAXIMA };

/* Makes room for the resultants of all pairs, and notes cross-sections */
PetscErrorCode ContactSetUpPairResultants(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactDestroyResultants(contact));
  PetscCall(PetscCalloc5(contact->n_pairs, &contact->resultants.cross_section, N_SUMS * contact->n_pairs, &contact->resultants.sums,
                         N_MAXIMA * contact->n_pairs, &contact->resultants.maxima, N_KEPT * contact->n_pairs, &contact->resultants.impulse,
                         contact->n_pairs, &contact->resultants.states));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    PetscCall(BodyGetScale(contact->bodies[contact->pairs[p].body[0]], BODY_CROSS_SECTION, &contact->resultants.cross_section[p]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for the resultants, and notes the controller step. The bodies must have been set up. */
PetscErrorCode ContactSetUpResultants(Contact contact)
{
  PetscInt substeps;
  TS       ts;

  PetscFunctionBegin;
  if (!contact->n_pairs && !contact->neighbours.come_and_go) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactSetUpPairResultants(contact));
  PetscCall(BodyGetTS(contact->bodies[0], &ts));
  PetscCall(TSGetTimeStep(ts, &contact->step));
  PetscCall(BodyGetSubsteps(contact->bodies[0], &substeps));
  contact->step *= substeps;
  contact->attempt.whole_step = contact->step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyResultants(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(PetscFree5(contact->resultants.cross_section, contact->resultants.sums, contact->resultants.maxima, contact->resultants.impulse,
                       contact->resultants.states));
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
    PetscReal *impulse = contact->resultants.impulse + N_KEPT * p, sums[N_FORCES];

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
    PetscReal *impulse = contact->resultants.impulse + N_KEPT * p, *last = impulse + 3, *normal = impulse + 6, first[N_FORCES],
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
  return (PetscBool)(contact->resultants.impulse[N_KEPT * (pair - contact->pairs) + 6] != 0);
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

/* This rank's sums and largest values over the rows of pair p */
static PetscErrorCode SumPair(Contact contact, PetscInt p, PetscReal sums[], PetscReal maxima[])
{
  const ContactPair *pair    = &contact->pairs[p];
  PetscInt           counted = -1; /* the node that was counted last: the rows of a tied node follow each other */
  PetscReal          normal  = 0;  /* force along the normal of the rows of a node so far [N] */
  PetscReal          forces[N_FORCES];
  TransferRows       rows;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(sums, N_SUMS));
  PetscCall(PetscArraycpy(sums + SUM_IMPULSE, contact->resultants.impulse + N_KEPT * p, 3));
  sums[SUM_NORMAL_IMPULSE] = contact->resultants.impulse[N_KEPT * p + 6];
  sums[SUM_BEYOND]         = contact->resultants.impulse[N_KEPT * p + 8];
  maxima[MAX_PENETRATION]  = -PETSC_MAX_REAL;
  maxima[MAX_TENSION]      = 0;
  for (PetscInt k = pair->near_begin; k < pair->near_end; k += ContactGapStride(pair))
    maxima[MAX_PENETRATION] = PetscMax(maxima[MAX_PENETRATION], -contact->end.gap[contact->rows.near[k]]);
  PetscCall(TransferGetRows(pair->transfer, &rows));
  for (PetscInt j = pair->acts_begin; j < pair->acts_end; j++) {
    const PetscInt  i = contact->rows.acting[j], node = (i - pair->begin) / pair->components, k = (i - pair->begin) % pair->components;
    const PetscReal along = ContactPairTies(pair) ? rows.normals[contact->dim * node + k] : k == 0;

    normal = (k ? normal : 0) + along * contact->end.force[i];
    if (k == pair->components - 1) maxima[MAX_TENSION] = PetscMax(maxima[MAX_TENSION], -normal);
    if (!contact->end.active[i]) continue;
    /* merged rows of one node may have different areas */
    if (contact->held.merger) sums[SUM_AREA] += PetscSqr(along) * contact->rows.area[i] * contact->resultants.cross_section[p];
    if (contact->rows.dof[i] == counted) continue;
    sums[SUM_ACTIVE] += 1;
    if (contact->friction.slides && contact->friction.slides[i]) sums[SUM_SLIDING] += 1;
    if (!contact->held.merger) sums[SUM_AREA] += contact->rows.area[i] * contact->resultants.cross_section[p];
    counted = contact->rows.dof[i];
  }
  PetscCall(SumForces(contact, pair, contact->end.force, forces));
  PetscCall(PetscArraycpy(sums + SUM_VECTOR, forces, 3));
  sums[SUM_FORCE] = forces[OF_NORMAL];
  PetscCall(SumMoments(contact, pair, sums + SUM_MOMENT));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaps of pairs none of whose near rows is close: others may be closer, whose gaps are old. `maxima`: of all ranks */
static PetscErrorCode FindFarGaps(Contact contact, PetscReal maxima[])
{
  const PetscReal until = -contact->rows.near_reach;
  PetscBool       any   = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) any = (PetscBool)(any || maxima[N_MAXIMA * p + MAX_PENETRATION] < until);
  if (!contact->rows.listed || !any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactRefreshGaps(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair    = &contact->pairs[p];
    PetscReal         *deepest = &maxima[N_MAXIMA * p + MAX_PENETRATION];

    for (PetscInt i = pair->begin; i < pair->end; i++) *deepest = PetscMax(*deepest, -contact->end.gap[i]);
  }
  PetscCall(ContactReduce(contact, N_MAXIMA * contact->n_pairs, MPIU_REAL, MPIU_MAX, maxima));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* States of all pairs */
PetscErrorCode ContactComputePairStates(Contact contact, ContactPairState states[])
{
  PetscReal *sums = contact->resultants.sums, *maxima = contact->resultants.maxima;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(SumPair(contact, p, sums + N_SUMS * p, maxima + N_MAXIMA * p));
  PetscCall(ContactReduce(contact, N_SUMS * contact->n_pairs, MPIU_REAL, MPIU_SUM, sums));
  PetscCall(ContactReduce(contact, N_MAXIMA * contact->n_pairs, MPIU_REAL, MPIU_MAX, maxima));
  PetscCall(FindFarGaps(contact, maxima));
  for (PetscInt p = 0; p < contact->n_pairs; p++, sums += N_SUMS, maxima += N_MAXIMA) {
    ContactPairState *state = &states[p];
    const PetscInt    sign  = ContactPairSign(&contact->pairs[p]);

    state->force   = sums[SUM_FORCE];
    state->active  = (PetscInt)sums[SUM_ACTIVE];
    state->gap     = -maxima[MAX_PENETRATION];
    state->tension = maxima[MAX_TENSION];
    state->area    = sums[SUM_AREA];
    for (PetscInt d = 0; d < 3; d++) {
      state->force_vector[d] = sign * sums[SUM_VECTOR + d];
      state->moment[d]       = sign * sums[SUM_MOMENT + d];
      state->impulse[d]      = sign * sums[SUM_IMPULSE + d];
    }
    state->normal_impulse = sums[SUM_NORMAL_IMPULSE];
    state->beyond_impulse = sums[SUM_BEYOND];
    state->sliding        = (PetscInt)sums[SUM_SLIDING];
    state->friction_loss  = contact->friction.pair_loss ? contact->friction.pair_loss[p] : 0;
    state->obstacle_work  = contact->friction.pair_driven ? contact->friction.pair_driven[p] : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
