/* Which body of a pair has the contact rows: a row for each of its nodes. Pairs whose second body has them are turned round here, once and
   for all; what users and files see stays in the order in which the user has named the bodies. */
#include <contact/parts.h>

/* The body that has the rows takes displacements, its partner tractions, whatever their order in ContactAddPair(). Names, forces, moments
   and normals of the pair stay in that order. A pair with an obstacle has its rows on the body. */

/*@
  ContactGetPairRowSide - which body of a pair has the contact rows

  Not Collective

  Input Parameters:
+ contact - the `Contact`, set up
- pair    - 0 to the number of pairs - 1

  Output Parameter:
. body - 0: the one that `ContactGetPair()` gives first; 1: the second one

  Level: intermediate

.seealso: `Contact`, `ContactGetPair()`, `ContactView()`
@*/
PetscErrorCode ContactGetPairRowSide(Contact contact, PetscInt pair, PetscInt *body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(body, 3);
  ContactCheckPair(contact, pair);
  *body = !contact->neighbours.come_and_go && contact->pairs[pair].turned ? 1 : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns a pair round if its second body is to have the rows. Its surfaces must be known. */
PetscErrorCode ContactChooseRowSide(Contact contact, ContactPair *pair)
{
  PetscFunctionBegin;
  if (!pair->obstacle && (pair->rows_second || contact->options.rows_second)) {
    pair->rows_second = PETSC_TRUE;
    ContactTurnPair(pair);
  }
  PetscCall(ContactTurnRigid(contact, pair));
  PetscFunctionReturn(PETSC_SUCCESS);
}
