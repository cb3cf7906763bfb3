/* The rows of each body. A body has rows for its own pairs alone, with numbers of its own, so that what it stores and does goes with these,
   not with the rows of all bodies. On every rank they are in the order of the rows of contact; so both numbers ascend together. */
#include <contact/parts.h>

/* Which rows each body has. Call when the rows of all ranks and their pairs are known. */
PetscErrorCode ContactNumberBodyRows(Contact contact)
{
  const PetscInt   begin = contact->rows.begin, end = begin + contact->rows.n;
  ContactBodyRows *of = contact->body_rows;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) of[b].n = of[b].begin = of[b].n_all = 0;
  for (PetscInt pass = 0; pass < 2; pass++) {
    for (PetscInt row = 0; row < contact->rows.n_all; row++) {
      const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[row]];

      for (PetscInt side = 0; side < ContactPairBodies(pair); side++) {
        ContactBodyRows *body = &of[pair->body[side]];

        if (pass) body->all[body->n_all] = row;
        else if (row < begin) body->begin++;
        else if (row < end) body->n++;
        body->n_all++;
      }
    }
    for (PetscInt b = 0; b < contact->n_bodies && !pass; b++) {
      PetscCall(PetscMalloc1(of[b].n_all, &of[b].all));
      of[b].n_all = 0;
    }
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) contact->pairs[p].shift[1] = 0; /* obstacles have the traces of all rows */
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(PetscMalloc4(of[b].n, &of[b].rows, of[b].n, &of[b].area, of[b].n, &of[b].near, of[b].n, &of[b].acting));
    for (PetscInt k = 0; k < of[b].n; k++) {
      const PetscInt i    = of[b].all[of[b].begin + k] - begin;
      ContactPair   *pair = &contact->pairs[contact->rows.pair[i]];

      of[b].rows[k]                           = i;
      pair->shift[pair->body[0] == b ? 0 : 1] = i - k;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyBodyRows(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; contact->body_rows && b < contact->n_bodies; b++) {
    PetscCall(PetscFree4(contact->body_rows[b].rows, contact->body_rows[b].area, contact->body_rows[b].near, contact->body_rows[b].acting));
    PetscCall(PetscFree(contact->body_rows[b].all));
    PetscCall(VecDestroy(&contact->body_rows[b].of_rows));
    PetscCall(VecDestroyVecs(CONTACT_CARRIED, &contact->body_rows[b].of_nodes));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

void ContactAffectAll(Contact contact)
{
  for (PetscInt b = 0; b < contact->n_bodies; b++) contact->body_rows[b].affected = contact->body_rows[b].rewritten = PETSC_TRUE;
}

/* Rows have come from elsewhere: all matrices are made anew, and none belongs to a controller step under way */
void ContactForgetMatrices(Contact contact)
{
  ContactAffectAll(contact);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactBodyRows *of = &contact->body_rows[b];

    of->filled = of->rewritten = PETSC_FALSE;
    of->patterns[0] = of->patterns[1] = -1;
  }
}

/* Of numbers of all rows, those of a body's */
void ContactTakeRows(Contact contact, PetscInt b, const PetscReal all[], PetscReal of_body[])
{
  const ContactBodyRows *of = &contact->body_rows[b];

  for (PetscInt k = 0; k < of->n; k++) of_body[k] = all[of->rows[k]];
}

/* Adds numbers of a body's rows to those of all */
void ContactAddRows(Contact contact, PetscInt b, const PetscReal of_body[], PetscReal all[])
{
  const ContactBodyRows *of = &contact->body_rows[b];

  for (PetscInt k = 0; k < of->n; k++) all[of->rows[k]] += of_body[k];
}

/* Areas of the rows, as bodies borrow them */
PetscErrorCode ContactCopyAreas(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) ContactTakeRows(contact, b, contact->rows.area, contact->body_rows[b].area);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the bodies whose rows are affected these as the matrices have them now. Entries of `all` rows differ, or of those that have
   changed. */
PetscErrorCode ContactUpdateBodies(Contact contact, PetscBool all)
{
  ContactRanks *ranks = &contact->ranks;

  PetscFunctionBegin;
  PetscCall(ContactCopyAreas(contact));
  for (PetscInt i = 0; i < contact->rows.n; i++) ranks->mine_active[i] = all || contact->rows.changed[i] || contact->rows.followed[i];
  PetscCall(ContactGatherRows(contact, MPI_INT, ranks->mine_active, ranks->all_active));
  for (PetscInt k = 0; k < contact->n_bodies; k++) {
    const PetscInt b = ranks->visits[k];

    if (contact->body_rows[b].affected)
      PetscCall(BodyUpdateInterface(contact->bodies[b], contact->interfaces[b], contact->body_rows[b].all, ranks->all_active));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All rows by all rows, sparse, without entries yet */
PetscErrorCode ContactCreateRowMatrix(Contact contact, Mat *matrix)
{
  PetscFunctionBegin;
  PetscCall(MatCreate(PetscObjectComm((PetscObject)contact), matrix));
  PetscCall(MatSetSizes(*matrix, contact->rows.n, contact->rows.n, contact->rows.n_all, contact->rows.n_all));
  PetscCall(MatSetType(*matrix, MATAIJ));
  PetscCall(MatSetUp(*matrix));
  PetscCall(MatSetOption(*matrix, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a matrix of all rows of a body by all rows of it to one of all rows by all rows */
PetscErrorCode ContactAddBodyMatrix(Contact contact, PetscInt b, Mat part, Mat sum)
{
  const ContactBodyRows *of = &contact->body_rows[b];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt     row = of->all[of->begin + k], *columns;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(part, of->begin + k, &n, &columns, &values));
    for (PetscInt j = 0; j < n; j++) PetscCall(MatSetValue(sum, row, of->all[columns[j]], values[j], ADD_VALUES));
    PetscCall(MatRestoreRow(part, of->begin + k, &n, &columns, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
