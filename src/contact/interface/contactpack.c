/* The state of contact and of its bodies as tables of nodes, by which a run is continued on another number of ranks: to round-off. Rows
   have other numbers there, and are found by their nodes. */
#include <contact/parts.h>
#include <body/interface/bodyvisit.h>
#include <interface/transfervisit.h>
#include "contactvisit.h"

/* Sums whose shares ranks have, to a table or from it: the first rank takes them */
static PetscErrorCode CopySums(Contact contact, PetscBool back, const char name[], PetscInt n, PetscReal shares[], Tables tables)
{
  const PetscInt   first = contact->ranks.rank ? 0 : 1;
  const PetscReal *sums;
  PetscReal       *all;
  PetscInt         lines;

  PetscFunctionBegin;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  if (back) {
    PetscCall(TablesGet(tables, name, n, &lines, &sums));
    for (PetscInt k = 0; k < n; k++) shares[k] = first * sums[k];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMalloc1(n, &all));
  PetscCallMPI(MPIU_Allreduce(shares, all, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscCall(TablesAdd(tables, name, first, n, all));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What pairs have done so far, those that have gone too */
static PetscErrorCode CopyImpulses(Contact contact, PetscBool back, Tables tables)
{
  PetscFunctionBegin;
  PetscCall(CopySums(contact, back, "impulses", CONTACT_IMPULSES * contact->n_pairs, contact->resultants.impulse, tables));
  PetscCall(CopySums(contact, back, "gone", CONTACT_IMPULSES * contact->neighbours.told.n, contact->neighbours.told.gone, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All rows of a pair to a table, a line for each node, or back */
static PetscErrorCode CopyPair(Contact contact, const ContactPair *pair, PetscBool back, Tables tables)
{
  const SurfaceData *data;
  StateList          list;
  char               name[256];

  PetscFunctionBegin;
  ContactListRowState(contact, &list);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s/contact", pair->name));
  PetscCall(SurfaceGetData(pair->surfaces[0], &data));
  PetscCall(StateListCopyNodes(&list, pair->begin, (pair->end - pair->begin) / pair->components, pair->components, data->reference, name,
                               back, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the tables of contact and of its bodies, after an accepted step. Collective. */
PetscErrorCode ContactPack(Contact contact, Tables tables)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyPack(contact->bodies[b], tables));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(TransferPack(contact->pairs[p].transfer, contact->pairs[p].name, tables));
    PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_FALSE, tables));
  }
  if (contact->rows.n_all) PetscTryTypeMethod(contact, pack, tables);
  PetscCall(CopyImpulses(contact, PETSC_FALSE, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows, and the matrices that bodies have of them */
static PetscErrorCode UnpackRows(Contact contact, Tables tables)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(TransferUnpack(contact->pairs[p].transfer, contact->pairs[p].name, tables));
    PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_TRUE, tables));
  }
  PetscCall(ContactMergeDroppedRows(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_TRUE, tables));
  ContactForgetMatrices(contact);
  PetscCall(ContactFillMatrices(contact));
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->work.moved[i] = PETSC_TRUE;
  PetscCall(ContactUpdateBodies(contact, contact->work.moved));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyTakeRows(contact->bodies[b]));
  ContactForgetMatrices(contact);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state of contact and of its bodies, in its first state, from the tables of another run, after ContactVisitShared(). Collective. */
PetscErrorCode ContactUnpack(Contact contact, Tables tables)
{
  PetscFunctionBegin;
  contact->attempt.level = 0; /* each controller step begins whole */
  contact->step          = contact->attempt.whole_step;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyUnpack(contact->bodies[b], tables));
  if (contact->rows.n_all) {
    PetscCall(UnpackRows(contact, tables));
    for (PetscInt i = 0; i < contact->rows.n; i++) contact->rows.changed[i] = PETSC_TRUE; /* to the method all are new */
    PetscTryTypeMethod(contact, rowschanged);
    PetscTryTypeMethod(contact, unpack, tables);
    for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_TRUE, tables));
  }
  PetscCall(CopyImpulses(contact, PETSC_TRUE, tables));
  PetscCall(ContactStartImpulses(contact)); /* the forces of the last step each rank has of its own rows */
  contact->attempt.again = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
