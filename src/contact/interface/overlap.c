/* Bodies that are inside each other. */
#include <contact/parts.h>

/* Depth from which on bodies are inside each other, in parts of a contact element: what penalty springs, and faces that do not match, leave
   of depth is less where they do what they should */
#define INSIDE 0.02
/* The same somewhere between nodes, before any node of the pair has touched: discs of 16 edges that meet have up to 0.05 */
#define UNFELT 0.1

/* Size of the smallest contact element of both bodies [m] */
static PetscErrorCode LeastElement(Contact contact, const ContactPair *pair, PetscReal *least)
{
  PetscFunctionBegin;
  *least = PETSC_MAX_REAL;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    PetscReal size;

    PetscCall(BodyGetContactElementSize(contact->bodies[pair->body[side]], &size));
    *least = PetscMin(*least, size);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that start no deeper than the bow of their partner's faces makes of surfaces which only touch, as two balls whose poles meet, start
   closed: the depth is added to their gap until they have been open, so that it is no blow in the first step. Bodies that begin with the
   state of another run (`of_state`) have been in contact there by other rows perhaps, of the other side: what these leave of depth is
   allowed too. */
PetscErrorCode ContactLetTouch(Contact contact, PetscBool of_state)
{
  PetscFunctionBegin;
  if (contact->options.law == CONTACT_LAW_TIED) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    TransferRows       rows;
    PetscReal          least;

    if (pair->obstacle) continue;
    PetscCall(TransferGetRows(pair->transfer, &rows));
    PetscCall(LeastElement(contact, pair, &least));
    for (PetscInt i = pair->begin; i < pair->end; i += pair->components) {
      const PetscReal depth = -contact->start.gap[i], bow = rows.bow[(i - pair->begin) / pair->components];

      if (!contact->rows.opposite[i] || depth <= 0 || depth > (of_state ? PetscMax(bow, INSIDE * least) : bow)) continue;
      contact->rows.gap_shift[i] += depth;
      contact->rows.initial_gap[i] += depth;
      contact->end.gap[i] = contact->start.gap[i] = 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Size of the smallest contact element of what pair `pair` tells of [m] */
static PetscErrorCode LeastTold(Contact contact, PetscInt pair, PetscReal *least)
{
  PetscFunctionBegin;
  *least = PETSC_MAX_REAL;
  if (!contact->neighbours.come_and_go) PetscCall(LeastElement(contact, &contact->pairs[pair], least));
  else
    for (PetscInt b = 0; b < contact->n_bodies; b++) *least = PetscMin(*least, contact->neighbours.edge[b]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetOverlap - how deep the bodies of a pair are inside each other

  Collective

  Input Parameters:
+ contact - the `Contact`, set up
. pair    - 0 to the number of pairs - 1
- state   - its state, as `ContactGetPairStates()` tells it

  Output Parameters:
+ depth  - the largest at any contact node, 0 or positive [m]
- inside - whether that is more than a fiftieth of a contact element; never with tied surfaces

  Level: intermediate

.seealso: `Contact`, `ContactGetPairStates()`
@*/
PetscErrorCode ContactGetOverlap(Contact contact, PetscInt pair, const ContactPairState *state, PetscReal *depth, PetscBool *inside)
{
  PetscReal least;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(state, 3);
  PetscAssertPointer(depth, 4);
  PetscAssertPointer(inside, 5);
  *depth = PetscMax(-state->gap, 0);
  PetscCall(LeastTold(contact, pair, &least));
  *inside = (PetscBool)(contact->options.law != CONTACT_LAW_TIED && *depth > INSIDE * least);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactIsUnfelt - whether bodies were deep inside each other before any row felt it

  Not Collective

  Input Parameters:
+ contact - the `Contact`, set up
. pair    - 0 to the number of pairs - 1
- overlap - the largest `overlap_unfelt` of its states [m]

  Output Parameter:
. unfelt - whether that is more than a tenth of a contact element

  Level: intermediate

  Note:
  A sharp corner that comes between two nodes of the surface that has the rows is not felt before the faces beside it reach these nodes.
  With rows on the body that has the corner it is, at once.

.seealso: `Contact`, `ContactPairState`, `ContactGetOverlap()`
@*/
PetscErrorCode ContactIsUnfelt(Contact contact, PetscInt pair, PetscReal overlap, PetscBool *unfelt)
{
  PetscReal least;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(unfelt, 4);
  PetscCall(LeastTold(contact, pair, &least));
  *unfelt = (PetscBool)(overlap > UNFELT * least);
  PetscFunctionReturn(PETSC_SUCCESS);
}
