/* Which rows of held nodes are dropped. Methods that prescribe displacements have no use for any. Where bodies answer to forces such a row
   is a condition on the partner. Beside rows that are not held, as at the rim of an interface, it may follow from these, since the partner
   has no more displacements there than they have forces: then its force is not determined. So there it is dropped, see heldrows.c. Farther
   inside of what is held it stays, unless the partner is held too, so that no force on it moves anything. */
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

/* Marks the rows of held nodes, to be dropped; where bodies answer to forces, if they are at a rim or move nothing. Obstacles never
   move. */
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

/* Which rows of a pair have no entry on a displacement of the partner that answers to forces */
static PetscErrorCode FindHopeless(Contact contact, const ContactPair *pair, PetscBool hopeless[])
{
  const Body         partner = contact->bodies[pair->body[1]];
  const PetscInt     count   = pair->end - pair->begin;
  const PetscInt    *held;
  const PetscScalar *moved;
  PetscScalar       *answers;
  PetscInt           n, n_held, first, begin[2] = {0, 0};
  PetscBool          led;
  Mat                B[2] = {NULL, NULL};
  Vec                u, way;

  PetscFunctionBegin;
  PetscCall(BodyGetReferencePositions(partner, &u));
  PetscCall(VecDuplicate(u, &u));
  PetscCall(VecGetLocalSize(u, &n));
  PetscCall(VecGetOwnershipRange(u, &first, NULL));
  PetscCall(BodyGetHeldDofs(partner, &n_held, &held));
  PetscCall(BodyGetLed(partner, NULL, &led));
  PetscCall(VecGetArrayWrite(u, &answers));
  for (PetscInt i = 0; i < n; i++)
    answers[i] = led ? 0 : 2 + PetscSinReal((PetscReal)(first + i)); /* weights of both signs do not cancel */
  for (PetscInt k = 0; k < n_held; k++) answers[held[k]] = 0;
  PetscCall(VecRestoreArrayWrite(u, &answers));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)contact), &B[1]));
  PetscCall(MatSetSizes(B[1], count, n, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(B[1], MATAIJ));
  PetscCall(MatSetUp(B[1]));
  PetscCall(MatGetOwnershipRange(B[1], &begin[1], NULL));
  PetscCall(TransferSetValues(pair->transfer, begin, pair->components, NULL, B));
  PetscCall(MatAssemblyBegin(B[1], MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(B[1], MAT_FINAL_ASSEMBLY));
  PetscCall(MatCreateVecs(B[1], NULL, &way));
  PetscCall(MatMult(B[1], u, way));
  PetscCall(VecGetArrayRead(way, &moved));
  for (PetscInt i = 0; i < count; i++) hopeless[i] = (PetscBool)(moved[i] == 0);
  PetscCall(VecRestoreArrayRead(way, &moved));
  for (PetscInt i = 0; i < count && pair->law == CONTACT_LAW_FRICTION; i += pair->components) /* along the axes, here */
    for (PetscInt k = 0; k < pair->components; k++) hopeless[i] = (PetscBool)(hopeless[i] && hopeless[i + k]);
  for (PetscInt i = 0; i < count && pair->law == CONTACT_LAW_FRICTION; i++) hopeless[i] = hopeless[i - i % pair->components];
  PetscCall(VecDestroy(&way));
  PetscCall(VecDestroy(&u));
  PetscCall(MatDestroy(&B[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Dropped rows without heirs, which `known` does not mark: they are dropped all the same, or else stay as they are */
PetscErrorCode ContactKeepHeldRows(Contact contact, Vec known)
{
  const PetscScalar *has;
  PetscBool         *hopeless;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(contact->rows.n, &hopeless));
  PetscCall(VecGetArrayRead(known, &has));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    int                any  = 0;

    for (PetscInt i = pair->begin; i < pair->end; i++) any |= contact->held.dropped[i] && PetscRealPart(has[i]) == 0;
    PetscCall(ContactOr(contact, &any));
    if (!any) continue;
    PetscCall(FindHopeless(contact, pair, hopeless));
    for (PetscInt i = pair->begin; i < pair->end; i++)
      contact->held.dropped[i] = (PetscBool)(contact->held.dropped[i] && (PetscRealPart(has[i]) > 0 || hopeless[i - pair->begin]));
  }
  PetscCall(VecRestoreArrayRead(known, &has));
  PetscCall(PetscFree(hopeless));
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
