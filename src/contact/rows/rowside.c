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
  *body = ContactToldPair(contact, pair)->turned ? 1 : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt CountRigid(Contact contact, const ContactPair *pair)
{
  return BodyDoes(contact->bodies[pair->body[0]], BodyIsRigid) + (!pair->obstacle && BodyDoes(contact->bodies[pair->body[1]], BodyIsRigid));
}

/* An error where neither side of a pair gives: forces between rigid bodies with mass are impulses, which other methods do not have. Nor do
   springs of a penalty: a rigid disc on a rigid plate, both with default parameters, gained 5 % within 800 steps, and lost 35 % with softer
   springs and friction. */
static PetscErrorCode RefuseRigid(Contact contact, const ContactPair *pair)
{
  PetscFunctionBegin;
  PetscCheck(
      !pair->obstacle, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
      "-contact_pairs %s: body '%s' is rigid, and so is the obstacle; nothing gives where they meet: choose -contact_type schwarz, let the "
      "body deform, or put a body that deforms in place of the obstacle",
      pair->name, ((PetscObject)contact->bodies[pair->body[0]])->name);
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
          "-contact_pairs %s: both bodies are rigid, and nothing gives where they meet: choose -contact_type schwarz, let one of them "
          "deform, or "
          "leave the pair out (where 'auto' has chosen it, name the other pairs)",
          pair->name);
}

/* Turns a pair round, before it has a transfer */
static void TurnPair(ContactPair *pair)
{
  const ContactPair was = *pair;

  for (PetscInt side = 0; side < 2; side++) {
    pair->body[side]     = was.body[1 - side];
    pair->surface[side]  = was.surface[1 - side];
    pair->surfaces[side] = was.surfaces[1 - side];
    pair->place[side]    = was.place[1 - side];
  }
  pair->turned = (PetscBool)!was.turned;
}

/* Turns a pair round, whose surfaces are known, if its second body is to have the rows, or if its first one is rigid: rows lie on the side
   that takes displacements, and a rigid body takes forces, so that its partner has to give unless the method takes pairs of rigid bodies */
PetscErrorCode ContactChooseRowSide(Contact contact, ContactPair *pair)
{
  const PetscInt n = CountRigid(contact, pair);

  PetscFunctionBegin;
  if (!pair->obstacle && (pair->rows_second || contact->options.rows_second)) {
    pair->rows_second = PETSC_TRUE;
    TurnPair(pair);
  }
  if (n == 2 || (n && pair->obstacle)) {
    if (!contact->impulses) PetscCall(RefuseRigid(contact, pair));
  } else if (BodyDoes(contact->bodies[pair->body[0]], BodyIsRigid)) {
    PetscCheck(
        !pair->rows_second, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
        "-contact_rows second: the second body of pair %s, '%s', is rigid, and takes forces; rows lie on its partner. Leave the option "
        "out for this pair",
        pair->name, ((PetscObject)contact->bodies[pair->body[0]])->name);
    TurnPair(pair);
    pair->why = "the rigid body takes forces";
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether any body in a pair is rigid */
PetscBool ContactHasRigid(Contact contact)
{
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (CountRigid(contact, &contact->pairs[p])) return PETSC_TRUE;
  return PETSC_FALSE;
}
