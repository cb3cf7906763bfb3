/* Which rows of held nodes are dropped. Methods that prescribe displacements have no use for any. Where bodies answer to forces such a row
   is a condition on the partner. Beside rows that are not held, as at the rim of an interface, it may follow from these, since the partner
   has no more displacements there than they have forces: then its force is not determined. So there it is dropped, see heldrows.c. Farther
   inside of what is held it stays. Where the partner is held too no force on it moves anything: what is prescribed of both has to fit. */
#include <contact/parts.h>
#include <impakt/private/bodymesh.h>

/* A component of a unit normal that is smaller is round-off: the row does not ask for that displacement */
#define NO_COMPONENT 1e-9

/* Neither opens nor closes */
static void LeaveOut(Contact contact, PetscInt i)
{
  contact->rows.opposite[i] = contact->rows.tied[i] = PETSC_FALSE;
  contact->rows.initial_gap[i]                      = CONTACT_NO_GAP;
}

/* Whether row i is held: all displacements that it asks for are prescribed. Rows of a node that rubs are held together. */
static PetscErrorCode RowIsHeld(Contact contact, const ContactPair *pair, PetscInt i, PetscBool *held)
{
  const PetscInt *dofs;
  PetscInt        n;

  PetscFunctionBegin;
  PetscCall(BodyGetHeldDofs(contact->bodies[pair->body[0]], &n, &dofs));
  *held = (PetscBool)(n > 0);
  for (PetscInt d = 0; d < contact->dim && *held; d++) {
    PetscInt place;

    if (PetscAbsReal(contact->rows.normal[3 * i + d]) < NO_COMPONENT && pair->law != CONTACT_LAW_FRICTION) continue;
    PetscCall(PetscFindInt(contact->rows.dof[i] + d, n, dofs, &place));
    if (place < 0) *held = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the rows of held nodes, to be dropped; where bodies answer to forces, if they are at a rim. Obstacles never move. */
PetscErrorCode ContactMarkHeldRows(Contact contact)
{
  const PetscBool merges = (PetscBool)(contact->sideless || contact->dim > 1);

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs && (contact->sideless || contact->prescribes); p++) {
    const ContactPair *pair = &contact->pairs[p];
    const PetscInt    *dofs;
    PetscInt           n;
    TransferRows       rows;

    PetscCall(BodyGetHeldDofs(contact->bodies[pair->body[0]], &n, &dofs));
    if (!n) continue; /* of this rank, all the time */
    PetscCall(TransferGetRows(pair->transfer, &rows));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscBool meets = ContactPairTies(pair) ? contact->ties.holds[i] : rows.opposite[(i - pair->begin) / pair->components];
      PetscBool       held  = PETSC_FALSE;

      PetscCall(RowIsHeld(contact, pair, i, &held));
      contact->held.dropped[i] = (PetscBool)(held && meets && merges && !pair->obstacle && pair->law != CONTACT_LAW_BONDED);
      if (held && (pair->obstacle || contact->prescribes)) LeaveOut(contact, i);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes with all rows dropped are left out. Of others a dropped row is a tie without entries, closed and without force. */
void ContactLeaveOutDropped(Contact contact)
{
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt first = pair->begin; first < pair->end; first += pair->components) {
      PetscBool all = PETSC_TRUE;

      for (PetscInt i = first; i < first + pair->components; i++) all = (PetscBool)(all && contact->held.dropped[i]);
      for (PetscInt i = first; i < first + pair->components && all; i++) LeaveOut(contact, i);
    }
  }
}
