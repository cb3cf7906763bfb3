/*
   Pairs whose rows are built again, and those whose rows follow. How far the surfaces of a pair have moved relative to each other takes the
   motion of all of their nodes: ranks add it up for all pairs at once.
*/
#include <contact/parts.h>
#include <sys/stages.h>

/* Rows stay as they are while the partner slips [parts of a face] and the normal turns [rad] by less. Bars that meet head on far above the
   load at which they buckle would do so from round-off. */
#define STILL 1e-6
/* The same between two linear bodies, whose displacements are small: with rows of the undeformed state pressures agree with closed forms to
   1e-8, and energy is kept to 1e-6. Linear bodies that turn do not keep angular momentum themselves. */
#define STILL_LINEAR 0.05

/* Rows of two bodies with inertia follow their surfaces, so that neither angular momentum nor energy is lost as they slide and turn. Rows
   of static bodies are built anew at the place where they are, and merged rows are means of several. */
static PetscErrorCode FollowPair(Contact contact, const ContactPair *pair, PetscBool *any)
{
  const PetscReal near    = ContactPairReach(contact, pair);
  PetscBool      *touches = contact->work.flags, linear = PETSC_TRUE; /* of each node, which has several rows with friction */

  PetscFunctionBegin;
  *any = PETSC_FALSE;
  if (pair->obstacle || contact->held.merger) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt side = 0; side < 2; side++) {
    PetscBool is_static, is_linear;

    PetscCall(BodyIsStatic(contact->bodies[pair->body[side]], &is_static));
    if (is_static) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(BodyIsLinear(contact->bodies[pair->body[side]], &is_linear));
    linear = (PetscBool)(linear && is_linear);
  }
  for (PetscInt i = pair->begin; i < pair->end; i += pair->components)
    touches[(i - pair->begin) / pair->components] = contact->start.active[i];
  PetscCall(TransferFollow(pair->transfer, touches, near, linear ? STILL_LINEAR : STILL, (PetscBool)!linear, contact->at_end[pair->body[0]],
                           contact->step, contact->attempt.whole_step / PetscPowRealInt(2, contact->attempt.accepted_level), any));
  if (contact->turns.n) PetscCall(TransferBalance(pair->transfer, contact->start.force + pair->begin, near, any));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacements of the bodies of a pair with which its rows are laid */
static PetscErrorCode GetDisplacements(Contact contact, const ContactPair *pair, Vec u[2])
{
  PetscFunctionBegin;
  u[0] = u[1] = NULL;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) PetscCall(ContactGetRowPlace(contact, pair->body[side], &u[side]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether there is anything to update */
static PetscBool MayChange(const ContactPair *pair)
{
  return (PetscBool)(!pair->bonded && !pair->far);
}

/* Numbers of the pairs that have surfaces on several ranks, over all of these: `each` for each pair */
static PetscErrorCode ReduceMotion(Contact contact, PetscInt each, MPI_Op operation, PetscReal values[])
{
  PetscReal *packed = contact->work.motion;
  PetscInt   n      = 0;

  PetscFunctionBegin;
  if (contact->ranks.size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt pass = 0; pass < 2; pass++) {
    n = 0;
    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      PetscMPIInt owner;

      if (!MayChange(&contact->pairs[p])) continue;
      PetscCall(TransferGetOwner(contact->pairs[p].transfer, &owner));
      if (owner >= 0) continue;
      PetscCall(PetscArraycpy(pass ? values + each * p : packed + n, pass ? packed + n : values + each * p, each));
      n += each;
    }
    if (!pass && n)
      PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, packed, (PetscMPIInt)n, MPIU_REAL, operation, PetscObjectComm((PetscObject)contact)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether rows of a pair touch on this rank, or have had a force, and the number of those that may close in this step */
static void CountTouching(Contact contact, const ContactPair *pair, PetscReal counts[2])
{
  counts[0] = ContactHasTouched(contact, pair);
  counts[1] = 0;
  for (PetscInt i = pair->begin; i < pair->end && !pair->obstacle && !counts[0]; i += pair->components) {
    counts[0] += contact->start.active[i];
    counts[1] += contact->rows.opposite[i] && contact->start.gap[i] <= ContactRowReach(contact, pair, contact->rows.normal + 3 * i);
  }
}

/* How far the surfaces of each pair have moved since its rows were built, of all pairs at once. Rows of surfaces that may touch in this
   step for the first time are built where the surfaces are now: what happens then does not depend on when they were built before. */
static PetscErrorCode CompareMotion(Contact contact)
{
  PetscReal *sums = contact->work.motion + CONTACT_SUMS * contact->n_pairs, *largest = sums + CONTACT_SUMS * contact->n_pairs;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (!MayChange(pair)) continue;
    PetscCall(TransferBeginUpdate(pair->transfer, ContactPairReach(contact, pair), sums + CONTACT_SUMS * p));
    CountTouching(contact, pair, sums + CONTACT_SUMS * p + TRANSFER_SUMS);
  }
  PetscCall(ReduceMotion(contact, CONTACT_SUMS, MPIU_SUM, sums));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair   = &contact->pairs[p];
    const PetscReal   *counts = sums + CONTACT_SUMS * p + TRANSFER_SUMS;

    if (!MayChange(pair)) continue;
    PetscCall(TransferCompareMotion(pair->transfer, sums + CONTACT_SUMS * p, (PetscBool)(pair->ahead || (counts[0] == 0 && counts[1] > 0)),
                                    largest + TRANSFER_LARGEST * p));
  }
  PetscCall(ReduceMotion(contact, TRANSFER_LARGEST, MPIU_MAX, largest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of a pair where its bodies are; none, where they are far apart */
static PetscErrorCode UpdatePair(Contact contact, PetscInt p, PetscBool *rebuilt)
{
  const PetscReal   *largest = contact->work.motion + 2 * CONTACT_SUMS * contact->n_pairs + TRANSFER_LARGEST * p;
  const ContactPair *pair    = &contact->pairs[p];
  Vec                u[2], at[2];

  PetscFunctionBegin;
  if (pair->far) {
    PetscCall(TransferSleep(pair->transfer));
    *rebuilt = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(GetDisplacements(contact, pair, u));
  for (PetscInt side = 0; side < 2; side++) at[side] = pair->ahead && u[side] ? contact->ends[pair->body[side]] : u[side];
  for (PetscInt side = 0; side < 2 && pair->ahead && u[side]; side++) PetscCall(SurfaceUpdate(pair->surfaces[side], at[side]));
  PetscCall(TransferEndUpdate(pair->transfer, at[0], at[1], ContactPairReach(contact, pair), largest, rebuilt));
  /* other pairs may have these surfaces too */
  for (PetscInt side = 0; side < 2 && pair->ahead && u[side]; side++) PetscCall(SurfaceUpdate(pair->surfaces[side], u[side]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What becomes of the rows of a pair in this step */
static PetscErrorCode RenewPair(Contact contact, PetscInt p, int *updated)
{
  const ContactPair *pair     = &contact->pairs[p];
  PetscBool          followed = PETSC_FALSE, rebuilt, logged;

  PetscFunctionBegin;
  *updated = ROWS_STAY;
  if (pair->bonded || (pair->far && pair->was_far)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(StageBegin(STAGE_SEARCH, &logged));
  PetscCall(UpdatePair(contact, p, &rebuilt));
  PetscCall(StageEnd(logged));
  if (!pair->far) PetscCall(FollowPair(contact, pair, &followed));
  *updated = rebuilt ? ROWS_REBUILT : followed ? ROWS_FOLLOWED : ROWS_STAY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Builds the rows of those pairs again whose surfaces have slid or turned far enough, and lets those near contact follow: what has become
   of them, for each pair, the same on all ranks */
PetscErrorCode ContactUpdatePairs(Contact contact)
{
  int      *updated = contact->work.updated;
  PetscBool logged;

  PetscFunctionBegin;
  PetscCall(StageBegin(STAGE_SEARCH, &logged));
  PetscCall(CompareMotion(contact));
  PetscCall(StageEnd(logged));
  /* those of several ranks first, which wait for each other there, and would for what each has to do by itself */
  for (PetscInt pass = 0; pass < 2; pass++)
    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      PetscMPIInt owner;

      PetscCall(TransferGetOwner(contact->pairs[p].transfer, &owner));
      if ((owner >= 0) == (pass > 0)) PetscCall(RenewPair(contact, p, &updated[p]));
    }
  /* of its own rows, and of a pair that it has to itself, each rank alone knows */
  if (contact->ranks.size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, updated, (PetscMPIInt)contact->n_pairs, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
