/* The matrices of the rows of each body, and how they get entries in other places as rows are built again. */
#include <contact/parts.h>
#include <impakt/private/bodymesh.h>

/* Entries of each row of a body, at most, by its transfer; columns of other ranks where they share the body. */
static PetscErrorCode CountEntries(Contact contact, PetscInt b, PetscInt entries[])
{
  const ContactBodyRows *of        = &contact->body_rows[b];
  PetscInt              *counts[2] = {contact->work.entry_counts, contact->work.entry_counts + contact->rows.n};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < of->n;) { /* rows of a pair follow each other */
    const ContactPair *pair = &contact->pairs[contact->rows.pair[of->rows[k]]];

    PetscCall(TransferCountValues(pair->transfer, counts[0], pair->obstacle ? NULL : counts[1]));
    for (PetscInt i = pair->begin; i < pair->end; i++, k++) {
      const PetscInt node = (i - pair->begin) / pair->components;

      entries[k] = (pair->body[0] == b ? counts[0][node] : 0) + (!pair->obstacle && pair->body[1] == b ? counts[1][node] : 0);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateMatrix(Contact contact, PetscInt b)
{
  Vec      positions;
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(BodyGetReferencePositions(contact->bodies[b], &positions));
  PetscCall(VecGetLocalSize(positions, &n));
  PetscCall(MatDestroy(&contact->interfaces[b]));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)contact), &contact->interfaces[b]));
  PetscCall(MatSetSizes(contact->interfaces[b], contact->body_rows[b].n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(contact->interfaces[b], MATAIJ));
  if (contact->ranks.size == 1) {
    PetscCall(CountEntries(contact, b, contact->work.intervals)); /* or PETSc collects them in a hash table */
    PetscCall(MatSeqAIJSetPreallocation(contact->interfaces[b], 0, contact->work.intervals));
  } else PetscCall(MatSetUp(contact->interfaces[b]));
  PetscCall(MatSetOption(contact->interfaces[b], MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Dofs of the nodes of a body that may touch, on the rank that has it, some twice */
static PetscErrorCode ListContactDofs(Contact contact, PetscInt b, PetscInt *n, PetscInt *dofs[])
{
  PetscFunctionBegin;
  for (PetscInt pass = 0; pass < 2; pass++) {
    PetscInt count = 0;

    for (PetscInt s = 0; s < contact->n_surfaces; s++) {
      const SurfaceData *data;

      if (contact->surfaces[s].body != b) continue;
      PetscCall(SurfaceGetData(contact->surfaces[s].surface, &data));
      for (PetscInt i = 0; i < contact->dim * data->n_owned && pass; i++)
        (*dofs)[count + i] = data->dofs[i / contact->dim] + i % contact->dim;
      count += contact->dim * data->n_owned;
    }
    if (!pass) PetscCall(PetscMalloc1(count, dofs));
    *n = count;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Has a new matrix know all columns in which the rows of other ranks than that of the body will ever have entries */
static PetscErrorCode ShareColumns(Contact contact, PetscInt b, PetscMPIInt rank)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)contact);
  PetscInt n, *dofs = NULL;

  PetscFunctionBegin;
  if (contact->ranks.rank == rank) PetscCall(ListContactDofs(contact, b, &n, &dofs));
  PetscCallMPI(MPI_Bcast(&n, 1, MPIU_INT, rank, comm));
  if (!dofs) PetscCall(PetscMalloc1(n, &dofs));
  PetscCallMPI(MPI_Bcast(dofs, (PetscMPIInt)n, MPIU_INT, rank, comm));
  PetscCall(BodyWholeRowsTellColumns(contact->interfaces[b], (PetscBool)(contact->ranks.rank == rank), n, dofs));
  PetscCall(PetscFree(dofs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix for entries in other places than those it has, or of new rows */
static PetscErrorCode PrepareMatrix(Contact contact, PetscInt b)
{
  ContactBodyRows *of = &contact->body_rows[b];
  PetscBool        whole, at_home; /* one of several ranks has all of the body; and all its rows too */
  PetscMPIInt      rank = -1;

  PetscFunctionBegin;
  if (contact->ranks.size > 1) PetscCall(ContactIsAtHome(contact, b, &rank, &at_home));
  whole = (PetscBool)(rank >= 0 && of->n_all);
  if (whole && of->patterns[0] < 0 && of->patterns[1] >= 0) { /* ranks need not find out anew what they tell each other in products */
    PetscCall(MatDestroy(&contact->interfaces[b]));
    PetscCall(MatDuplicate(contact->spares[b], MAT_DO_NOT_COPY_VALUES, &contact->interfaces[b]));
    PetscCall(MatSetOption(contact->interfaces[b], MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
    PetscCall(MatSetOption(contact->interfaces[b], MAT_NEW_NONZERO_LOCATION_ERR, PETSC_TRUE));
  } else if (!whole || of->patterns[0] < 0) {
    PetscCall(CreateMatrix(contact, b));
    if (!whole || at_home) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(ShareColumns(contact, b, rank));
  }
  PetscCall(CountEntries(contact, b, contact->work.intervals));
  PetscCall(BodyWholeRowsRenew(contact->interfaces[b], (PetscBool)(contact->ranks.rank == rank), contact->work.intervals));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of the two matrices of a body is filled. The body keeps the rows of the last accepted step until this one is accepted, since
   contact forces go over from them; the rows of a step that has failed are of no use any more. */
static void ChooseMatrix(Contact contact, PetscInt b)
{
  ContactBodyRows *of      = &contact->body_rows[b];
  const PetscInt64 pattern = of->patterns[0];
  const Mat        matrix  = contact->interfaces[b];

  if (of->filled) return;
  contact->interfaces[b] = contact->spares[b];
  contact->spares[b]     = matrix;
  of->patterns[0]        = of->patterns[1];
  of->patterns[1]        = pattern;
  of->filled             = PETSC_TRUE;
}

/* Fills the matrices of the bodies whose rows are affected: in place if they have entries where those that were filled last have them,
   which is so until rows are built again. Merged rows come from products of matrices, which are made anew. */
PetscErrorCode ContactFillMatrices(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactBodyRows *of      = &contact->body_rows[b];
    const PetscBool  product = (PetscBool)(contact->held.merger != NULL);

    if (!of->affected) continue;
    ChooseMatrix(contact, b);
    if (of->patterns[0] == of->pattern) PetscCall(MatZeroEntries(contact->interfaces[b]));
    else if (product) PetscCall(CreateMatrix(contact, b));
    else PetscCall(PrepareMatrix(contact, b));
    of->patterns[0] = product ? -1 : of->pattern;
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair     = &contact->pairs[p];
    PetscInt           begin[2] = {0, 0};
    Mat                rows[2]  = {NULL, NULL};
    PetscBool          any      = PETSC_FALSE, directed;

    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
      begin[side] = contact->body_rows[pair->body[side]].begin + pair->begin - pair->shift[side % ContactPairBodies(pair)];
      if (!contact->body_rows[pair->body[side]].affected) continue;
      rows[side] = contact->interfaces[pair->body[side]];
      any        = PETSC_TRUE;
    }
    directed = (PetscBool)(pair->law == CONTACT_LAW_FRICTION || pair->law == CONTACT_LAW_BONDED);
    if (any)
      PetscCall(TransferSetValues(pair->transfer, begin, pair->components, directed ? contact->rows.normal + 3 * pair->begin : NULL, rows));
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    if (!contact->body_rows[b].affected) continue;
    PetscCall(MatAssemblyBegin(contact->interfaces[b], MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(contact->interfaces[b], MAT_FINAL_ASSEMBLY));
    /* values in the same places need no word of other ranks when they are assembled again */
    PetscCall(MatSetOption(contact->interfaces[b], MAT_NEW_NONZERO_LOCATION_ERR, PETSC_TRUE));
    PetscCall(ContactMergeMatrix(contact, b));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
