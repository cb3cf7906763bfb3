/*
   Rows that are laid out anew in the course of a run, as pairs come and go. Between two controller steps the rows of pairs that stay keep
   all that is known of them, under other numbers; those of new pairs begin open. Bodies whose pairs stay as they are notice nothing. What
   the method has made of the rows begins anew.
*/
#include <contact/parts.h>

/* What is kept of rows and pairs, while they are laid out */
typedef struct {
  PetscInt     n_pairs;
  ContactPair *pairs;
  PetscInt     width;     /* numbers of each row: what checkpoints have of it, and its first displacement */
  PetscReal   *rows;      /* per row: those */
  PetscReal   *impulses;  /* per pair */
  PetscReal   *pair_sums; /* per pair: 2 */
  PetscReal   *friction;  /* per pair: what it has taken, and the work of an obstacle [J] */
  PetscBool   *goes_on;   /* per pair */
} Kept;

static PetscErrorCode KeepRows(Contact contact, Kept *kept)
{
  StateList list;

  PetscFunctionBegin;
  ContactListRowState(contact, &list);
  kept->width = StateListGetWidth(&list) + 1;
  PetscCall(PetscCalloc5(kept->width * contact->rows.n, &kept->rows, CONTACT_IMPULSES * contact->n_pairs, &kept->impulses,
                         2 * contact->n_pairs, &kept->pair_sums, 2 * contact->n_pairs, &kept->friction, contact->n_pairs, &kept->goes_on));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    StateListCopyOne(&list, i, PETSC_FALSE, kept->rows + kept->width * i);
    kept->rows[kept->width * (i + 1) - 1] = (PetscReal)contact->rows.dof[i];
  }
  if (contact->n_pairs) PetscCall(PetscArraycpy(kept->impulses, contact->resultants.impulse, CONTACT_IMPULSES * contact->n_pairs));
  if (contact->n_pairs && contact->energy.pair_sums)
    PetscCall(PetscArraycpy(kept->pair_sums, contact->energy.pair_sums, 2 * contact->n_pairs));
  for (PetscInt p = 0; p < contact->n_pairs && contact->friction.pair_loss; p++) {
    kept->friction[2 * p]     = contact->friction.pair_loss[p];
    kept->friction[2 * p + 1] = contact->friction.pair_driven[p];
  }
  kept->n_pairs      = contact->n_pairs;
  kept->pairs        = contact->pairs;
  contact->pairs     = NULL;
  contact->n_pairs   = 0;
  contact->max_pairs = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number that a pair had among those before, -1: it is new; from `*next` on, since both are in order */
static PetscInt FindKept(Contact contact, const Kept *kept, const PetscInt pair[2], PetscInt *next)
{
  for (; *next < kept->n_pairs; (*next)++) {
    const PetscInt first = kept->pairs[*next].body[0], second = ContactPairPartner(contact, &kept->pairs[*next]);

    if (first == pair[0] && second == pair[1]) return *next;
    if (first > pair[0] || (first == pair[0] && second > pair[1])) break;
  }
  return -1;
}

/* The pairs that there are from now on; `was`: the number that each had, or -1. Bodies that have other pairs than before are marked. */
static PetscErrorCode TakePairs(Contact contact, PetscInt n, const PetscInt list[], Kept *kept, PetscInt was[], PetscBool affected[])
{
  PetscInt  next   = 0;
  PetscReal extent = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < n; p++) {
    const PetscInt old = FindKept(contact, kept, list + 2 * p, &next);
    ContactPair   *pair;

    PetscCall(ContactAppendNeighbours(contact, list[2 * p], list[2 * p + 1], &pair));
    was[p] = old;
    if (old >= 0) {
      PetscCall(PetscFree(pair->name));
      *pair              = kept->pairs[old];
      kept->goes_on[old] = PETSC_TRUE;
      continue;
    }
    PetscCall(ContactCreateSurfaces(contact, pair, &extent));
    PetscCall(ContactCreateTransfer(contact, pair));
    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) affected[pair->body[side]] = PETSC_TRUE;
  }
  for (PetscInt p = 0; p < kept->n_pairs; p++) {
    ContactPair *pair = &kept->pairs[p];

    if (kept->goes_on[p]) continue;
    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) affected[pair->body[side]] = PETSC_TRUE;
    PetscCall(ContactTakeLeave(contact, pair, kept->impulses + CONTACT_IMPULSES * p, kept->friction + 2 * p));
    PetscCall(ContactDestroyPair(pair));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What was known of the rows of pairs that stay; the others are described by their transfers */
static PetscErrorCode PutBack(Contact contact, const Kept *kept, const PetscInt old_begin[], const PetscInt was[])
{
  StateList list;

  PetscFunctionBegin;
  ContactListRowState(contact, &list);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (was[p] < 0) {
      PetscCall(ContactDescribeRows(contact, pair));
      for (PetscInt i = pair->begin; i < pair->end; i++) contact->start.gap[i] = contact->end.gap[i] = CONTACT_NO_GAP;
      continue;
    }
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      PetscReal *row = kept->rows + kept->width * (old_begin[p] + i - pair->begin);

      StateListCopyOne(&list, i, PETSC_TRUE, row);
      contact->rows.dof[i] = (PetscInt)row[kept->width - 1];
    }
    PetscCall(
        PetscArraycpy(contact->resultants.impulse + CONTACT_IMPULSES * p, kept->impulses + CONTACT_IMPULSES * was[p], CONTACT_IMPULSES));
    PetscCall(PetscArraycpy(contact->energy.pair_sums + 2 * p, kept->pair_sums + 2 * was[p], 2));
    if (!contact->friction.pair_loss) continue;
    contact->friction.pair_loss[p]   = kept->friction[2 * was[p]];
    contact->friction.pair_driven[p] = kept->friction[2 * was[p] + 1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of a body that has other pairs than before */
static PetscErrorCode ReplaceBody(Contact contact, PetscInt b, const PetscInt old_shift[], const PetscInt old_begin[], const PetscInt was[])
{
  const ContactBodyRows *of = &contact->body_rows[b];
  PetscInt              *from;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(of->n, &from));
  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt     i = of->rows[k], p = contact->rows.pair[i];
    const ContactPair *pair = &contact->pairs[p];
    const PetscInt     side = pair->body[0] == b ? 0 : 1;

    from[k] = was[p] < 0 ? -1 : old_begin[p] + i - pair->begin - old_shift[2 * p + side];
  }
  PetscCall(BodyReplaceInterface(contact->bodies[b], contact->interfaces[b], from));
  PetscCall(BodyGetTraces(contact->bodies[b], &contact->traces[b]));
  PetscCall(PetscFree(from));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrices of the bodies that have other pairs than before, and all that these bodies have made of them */
static PetscErrorCode ReplaceBodies(Contact contact, const PetscBool affected[], const PetscInt old_shift[], const PetscInt old_begin[],
                                    const PetscInt was[])
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactBodyRows *of = &contact->body_rows[b];

    of->affected = affected[b];
    of->filled = of->rewritten = PETSC_FALSE;
    if (!affected[b]) continue;
    PetscCall(MatDestroy(&contact->interfaces[b]));
    PetscCall(MatDestroy(&contact->spares[b]));
    of->patterns[0] = of->patterns[1] = -1;
  }
  PetscCall(ContactFillMatrices(contact));
  PetscCall(ContactCopyAreas(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    if (affected[b]) PetscCall(ReplaceBody(contact, b, old_shift, old_begin, was));
    contact->body_rows[b].affected = contact->body_rows[b].filled = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What counts for each body how its rows have changed goes over to the new numbering */
static PetscErrorCode LayOut(Contact contact)
{
  ContactBodyRows *old;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(contact->n_bodies, &old));
  PetscCall(PetscArraycpy(old, contact->body_rows, contact->n_bodies));
  PetscCall(ContactDestroyRows(contact));
  PetscCall(ContactLayOutRows(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactBodyRows *of = &contact->body_rows[b];

    of->pattern     = old[b].pattern;
    of->patterns[0] = old[b].patterns[0];
    of->patterns[1] = old[b].patterns[1];
  }
  PetscCall(PetscFree(old));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Other pairs than before, between two controller steps. `list`: for each of n pairs its first body and its second one, or the number of
   bodies and that of an obstacle; in order */
PetscErrorCode ContactReplacePairs(Contact contact, PetscInt n, const PetscInt list[])
{
  PetscInt  *was, *old_begin, *old_shift;
  PetscBool *affected;
  Kept       kept;

  PetscFunctionBegin;
  PetscCall(PetscCalloc4(n, &was, n, &old_begin, 2 * n, &old_shift, contact->n_bodies, &affected));
  PetscCall(KeepRows(contact, &kept));
  PetscCall(TakePairs(contact, n, list, &kept, was, affected));
  for (PetscInt p = 0; p < n; p++) {
    old_begin[p]         = contact->pairs[p].begin;
    old_shift[2 * p]     = contact->pairs[p].shift[0];
    old_shift[2 * p + 1] = contact->pairs[p].shift[1];
  }
  PetscCall((*contact->ops->reset)(contact));
  PetscCall(LayOut(contact));
  PetscCall(ContactSetUpPairResultants(contact));
  PetscCall(ContactSetUpRowEnergy(contact));
  PetscCall(ContactSetUpFriction(contact));
  PetscCall(PutBack(contact, &kept, old_begin, was));
  PetscCall(ReplaceBodies(contact, affected, old_shift, old_begin, was));
  PetscCall(ContactSetUpObstacleTraces(contact));
  if (contact->rows.n_all) PetscTryTypeMethod(contact, setup);
  contact->neighbours.layouts++;
  PetscCall(PetscFree5(kept.rows, kept.impulses, kept.pair_sums, kept.friction, kept.goes_on));
  PetscCall(PetscFree(kept.pairs));
  PetscCall(PetscFree4(was, old_begin, old_shift, affected));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the pairs found are those that there are */
static PetscBool Same(Contact contact, PetscInt n)
{
  const PetscInt *found = contact->neighbours.found;

  if (n != contact->n_pairs) return PETSC_FALSE;
  for (PetscInt p = 0; p < n; p++)
    if (contact->pairs[p].body[0] != found[2 * p] || ContactPairPartner(contact, &contact->pairs[p]) != found[2 * p + 1])
      return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Before a whole controller step, or `at_once`: takes the pairs that are near where bodies may have used up the distance up to which pairs
   were taken. `near`: bodies that far apart may touch in the step [m]. */
PetscErrorCode ContactRenewNeighbours(Contact contact, PetscReal near, PetscBool at_once, PetscBool *any)
{
  PetscInt n;

  PetscFunctionBegin;
  *any = PETSC_FALSE;
  if (!contact->neighbours.come_and_go) PetscFunctionReturn(PETSC_SUCCESS);
  if (!ContactNeighboursUsed(contact, near) && !at_once) PetscFunctionReturn(PETSC_SUCCESS);
  if (contact->attempt.again || contact->attempt.level) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactFindNeighbours(contact, near, &n));
  if (Same(contact, n)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactListAllRows(contact));
  PetscCall(ContactMoveSurfaces(contact));
  PetscCall(ContactReplacePairs(contact, n, contact->neighbours.found));
  *any = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
