/* Rows that are laid out anew in the course of a run, as pairs come and go. Between two controller steps the rows of pairs that stay keep
   all that is known of them, under other numbers; those of new pairs begin open. What the method has made of the rows begins anew. */
#include <contact/parts.h>

/* Pairs are looked for again before what was taken is used up, with room for steps that become faster */
#define STEPS_AHEAD 2

/* What is kept of rows and pairs, while they are laid out */
typedef struct {
  PetscInt          n_pairs;
  ContactPair      *pairs;
  PetscInt          width;   /* numbers of each row: what checkpoints have of it, and its first displacement */
  PetscReal        *rows;    /* per row: those */
  PetscReal        *sums;    /* per pair: N_SUMS */
  ContactPairState *states;  /* per pair */
  PetscBool        *goes_on; /* per pair */
} Kept;

/* Of a pair: impulses, sums of energies, what friction has taken, and the work of an obstacle [J] */
enum { SUM_ENERGY = CONTACT_IMPULSES, SUM_FRICTION = SUM_ENERGY + 2, SUM_DRIVEN = SUM_FRICTION + 1, N_SUMS = SUM_DRIVEN + 1 };

static void CopySums(Contact contact, PetscInt p, PetscBool back, PetscReal sums[])
{
  PetscReal *energy = sums + SUM_ENERGY, *friction = sums + SUM_FRICTION, *driven = sums + SUM_DRIVEN;

  TablesCopyReals(back, CONTACT_IMPULSES, contact->resultants.impulse + CONTACT_IMPULSES * p, &sums);
  if (contact->energy.pair_sums) TablesCopyReals(back, 2, contact->energy.pair_sums + 2 * p, &energy);
  if (!contact->friction.pair_loss) return;
  TablesCopyReals(back, 1, &contact->friction.pair_loss[p], &friction);
  TablesCopyReals(back, 1, &contact->friction.pair_driven[p], &driven);
}

static PetscErrorCode KeepRows(Contact contact, Kept *kept)
{
  StateList list;

  PetscFunctionBegin;
  ContactListRowState(contact, &list);
  kept->width = StateListGetWidth(&list) + 1;
  PetscCall(PetscCalloc4(kept->width * contact->rows.n, &kept->rows, N_SUMS * contact->n_pairs, &kept->sums, contact->n_pairs,
                         &kept->goes_on, contact->n_pairs, &kept->states));
  PetscCall(ContactComputePairStates(contact, kept->states));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    StateListCopyOne(&list, i, PETSC_FALSE, kept->rows + kept->width * i);
    kept->rows[kept->width * (i + 1) - 1] = (PetscReal)contact->rows.dof[i];
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) CopySums(contact, p, PETSC_FALSE, kept->sums + N_SUMS * p);
  kept->n_pairs    = contact->n_pairs;
  kept->pairs      = contact->pairs;
  contact->pairs   = NULL;
  contact->n_pairs = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pairs that there are from now on; `was`: the number that each had, or less than 0. Marks bodies that have other pairs now. */
static PetscErrorCode TakePairs(Contact contact, PetscInt n, const PetscInt list[], Kept *kept, PetscInt was[], PetscBool affected[])
{
  PetscReal extent = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < n; p++) {
    ContactPair *pair;

    PetscCall(ContactAppendNeighbours(contact, list[p], &pair));
    PetscCall(PetscFindInt(list[p], kept->n_pairs, contact->neighbours.living, &was[p]));
    if (was[p] >= 0) {
      PetscCall(PetscFree(pair->name));
      *pair                 = kept->pairs[was[p]];
      kept->goes_on[was[p]] = PETSC_TRUE;
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
    ContactTell(contact, pair, &kept->states[p], contact->neighbours.told.gone); /* what it has done stays with its bodies */
    PetscCall(ContactDestroyPair(pair));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What was known of the rows of pairs that stay; the others are described by their transfers */
static PetscErrorCode PutBack(Contact contact, const Kept *kept, const PetscInt was[])
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
      PetscReal *row = kept->rows + kept->width * (kept->pairs[was[p]].begin + i - pair->begin);

      StateListCopyOne(&list, i, PETSC_TRUE, row);
      contact->rows.dof[i] = (PetscInt)row[kept->width - 1];
    }
    CopySums(contact, p, PETSC_TRUE, kept->sums + N_SUMS * was[p]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrices of the bodies that have other pairs than before, and all that these bodies have made of them */
static PetscErrorCode ReplaceBodies(Contact contact, const PetscBool affected[], const Kept *kept, const PetscInt was[])
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
    ContactBodyRows *of = &contact->body_rows[b];
    PetscInt        *from; /* per row: its number before, or less than 0 */

    if (affected[b]) {
      PetscCall(PetscMalloc1(of->n, &from));
      for (PetscInt k = 0; k < of->n; k++) {
        const PetscInt     i = of->rows[k], p = contact->rows.pair[i];
        const ContactPair *pair = &contact->pairs[p], *old = was[p] < 0 ? NULL : &kept->pairs[was[p]];

        from[k] = old ? old->begin + i - pair->begin - old->shift[pair->body[0] == b ? 0 : 1] : -1;
      }
      PetscCall(BodyReplaceInterface(contact->bodies[b], contact->interfaces[b], from));
      PetscCall(BodyGetTraces(contact->bodies[b], &contact->traces[b]));
      PetscCall(PetscFree(from));
    }
    of->affected = of->filled = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Other pairs than before, between two controller steps. `list`: the numbers of n pairs by ContactNumberPair(), ascending */
PetscErrorCode ContactReplacePairs(Contact contact, PetscInt n, const PetscInt list[])
{
  PetscInt  *was;
  PetscBool *affected;
  Kept       kept;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(n, &was, contact->n_bodies, &affected));
  PetscCall(KeepRows(contact, &kept));
  PetscCall(TakePairs(contact, n, list, &kept, was, affected));
  PetscCall(ContactNoteNeighbours(contact, n, list));
  PetscCall((*contact->ops->reset)(contact));
  PetscCall(ContactDestroyRows(contact));
  PetscCall(ContactLayOutRows(contact));
  PetscCall(ContactSetUpPairResultants(contact));
  PetscCall(ContactSetUpRowEnergy(contact));
  PetscCall(ContactSetUpFriction(contact));
  PetscCall(PutBack(contact, &kept, was));
  PetscCall(ReplaceBodies(contact, affected, &kept, was));
  PetscCall(ContactSetUpObstacleTraces(contact));
  if (contact->rows.n_all) PetscTryTypeMethod(contact, setup);
  PetscCall(PetscFree4(kept.rows, kept.sums, kept.goes_on, kept.states));
  PetscCall(PetscFree(kept.pairs));
  PetscCall(PetscFree2(was, affected));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Before a whole controller step, or `at_once`: takes the pairs that are near where bodies may have used up the distance up to which pairs
   were taken. `near`: bodies that far apart may touch in the step [m]. What was within reach of a step then is not now where bodies have
   become faster. */
PetscErrorCode ContactRenewNeighbours(Contact contact, PetscReal near, PetscBool at_once, PetscBool *any)
{
  ContactNeighbours *neighbours = &contact->neighbours;
  PetscBool          same;
  PetscInt           n;

  PetscFunctionBegin;
  *any = PETSC_FALSE;
  if (!neighbours->come_and_go || contact->attempt.again) PetscFunctionReturn(PETSC_SUCCESS);
  neighbours->room_left -= near;
  if (contact->attempt.level || (neighbours->room_left + neighbours->near >= STEPS_AHEAD * near && !at_once))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactFindNeighbours(contact, near, &n));
  same = (PetscBool)(n == neighbours->n_living);
  if (same) PetscCall(PetscArraycmp(neighbours->found, neighbours->living, n, &same));
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactListAllRows(contact));
  PetscCall(ContactMoveSurfaces(contact));
  PetscCall(ContactReplacePairs(contact, n, neighbours->found));
  *any = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
