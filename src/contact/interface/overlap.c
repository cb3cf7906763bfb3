/* Bodies that are inside each other. */
#include <impakt/private/contactimpl.h>

/* Depth from which on bodies are inside each other, in parts of a contact element: what penalty springs, and faces that do not match, leave
   of depth is less where they do what they should */
#define INSIDE 0.02

/* Rows that start no deeper than the bow of their partner's faces makes of surfaces which only touch, as two balls whose poles meet, start
   closed: the depth is added to their gap until they have been open, so that it is no blow in the first step */
PetscErrorCode ContactLetTouch(Contact contact)
{
  PetscFunctionBegin;
  if (contact->options.law == CONTACT_LAW_TIED) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    TransferRows       rows;

    if (pair->obstacle) continue;
    PetscCall(TransferGetRows(pair->transfer, &rows));
    for (PetscInt i = pair->begin; i < pair->end; i += pair->components) {
      const PetscReal depth = -contact->start.gap[i];

      if (!contact->rows.opposite[i] || depth <= 0 || depth > rows.bow[(i - pair->begin) / pair->components]) continue;
      contact->rows.gap_shift[i] += depth;
      contact->rows.initial_gap[i] += depth;
      contact->end.gap[i] = contact->start.gap[i] = 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetOverlap - how deep the bodies of a pair are inside each other

  Collective

  Input Parameters:
+ contact - the `Contact`, set up
- pair    - 0 to the number of pairs - 1

  Output Parameters:
+ depth  - the largest at any contact node, 0 or positive [m]
- inside - whether that is more than a fiftieth of a contact element; never with tied surfaces

  Level: intermediate

.seealso: `Contact`, `ContactGetPairState()`
@*/
PetscErrorCode ContactGetOverlap(Contact contact, PetscInt pair, PetscReal *depth, PetscBool *inside)
{
  const ContactPair *p;
  ContactPairState   state;
  PetscReal          size = 0, least = PETSC_MAX_REAL;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(depth, 3);
  PetscAssertPointer(inside, 4);
  PetscCall(ContactGetPairState(contact, pair, &state));
  p      = &contact->pairs[pair];
  *depth = PetscMax(-state.gap, 0);
  for (PetscInt side = 0; side < (p->obstacle ? 1 : 2); side++) {
    PetscCall(BodyGetContactElementSize(contact->bodies[p->body[side]], &size));
    least = PetscMin(least, size);
  }
  *inside = (PetscBool)(contact->options.law != CONTACT_LAW_TIED && *depth > INSIDE * least);
  PetscFunctionReturn(PETSC_SUCCESS);
}
