/* The state of contact and of its bodies as tables of nodes, by which a run is continued on another number of ranks: to round-off. Rows
   have other numbers there, and are found by their nodes. */
#include <contact/parts.h>
#include <body/interface/bodyvisit.h>
#include <interface/transfervisit.h>
#include "contactvisit.h"

/* What pairs have done so far, of which ranks have shares; loading, the first rank takes all */
static PetscErrorCode VisitImpulses(Contact contact, Tables tables)
{
  const PetscInt n      = CONTACT_IMPULSES * contact->n_pairs;
  PetscReal     *shares = contact->resultants.impulse, *sums;

  PetscFunctionBegin;
  PetscCall(TablesBegin(tables, "contact"));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(n, &sums));
  PetscCallMPI(MPIU_Allreduce(shares, sums, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscCall(TablesVisitNumbers(tables, "impulses", n, sums));
  for (PetscInt k = 0; k < n && TablesLoads(tables); k++) shares[k] = contact->ranks.rank ? 0 : sums[k];
  PetscCall(PetscFree(sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All rows, a line for each node of a pair */
static PetscErrorCode VisitRows(Contact contact, Tables tables)
{
  StateList list;

  PetscFunctionBegin;
  ContactListRowState(contact, &list);
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(ContactVisitPairNodes(&contact->pairs[p], &list, "contact", tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactVisitPairNodes - what a list has of the rows of a pair, a line for each node of its first surface */
PetscErrorCode ContactVisitPairNodes(const ContactPair *pair, const StateList *list, const char what[], Tables tables)
{
  const SurfaceData *data;

  PetscFunctionBegin;
  PetscCall(TablesBegin(tables, pair->name));
  PetscCall(SurfaceGetData(pair->surfaces[0], &data));
  PetscCall(StateListVisitNodes(list, pair->begin, (pair->end - pair->begin) / pair->components, pair->components, data->reference, what,
                                tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What follows from rows that have been loaded: merged rows, the matrices that bodies have of them, what the method has made of them */
static PetscErrorCode TakeRows(Contact contact, Tables tables)
{
  PetscFunctionBegin;
  PetscCall(ContactMergeDroppedRows(contact));
  PetscCall(VisitRows(contact, tables));
  ContactForgetMatrices(contact);
  PetscCall(ContactFillMatrices(contact));
  PetscCall(ContactUpdateBodies(contact, PETSC_TRUE));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyTakeRows(contact->bodies[b]));
  ContactForgetMatrices(contact);
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->rows.changed[i] = PETSC_TRUE; /* to the method all are new */
  PetscTryTypeMethod(contact, rowschanged);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state of contact and of its bodies after an accepted step; loading, in its first state, from the tables of another run, after
   ContactVisitShared(). Collective. */
PetscErrorCode ContactVisitTables(Contact contact, Tables tables)
{
  const PetscBool loads = TablesLoads(tables);

  PetscFunctionBegin;
  if (loads) {
    contact->attempt.level = 0; /* each controller step begins whole */
    contact->step          = contact->attempt.whole_step;
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyVisitTables(contact->bodies[b], tables));
  if (contact->rows.n_all) {
    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      PetscCall(TablesBegin(tables, contact->pairs[p].name));
      PetscCall(TransferVisitTables(contact->pairs[p].transfer, tables));
    }
    PetscCall(VisitRows(contact, tables));
    if (loads) PetscCall(TakeRows(contact, tables));
    PetscTryTypeMethod(contact, visittables, tables);
    if (loads) PetscCall(VisitRows(contact, tables));
  }
  PetscCall(VisitImpulses(contact, tables));
  if (!loads) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactStartImpulses(contact)); /* the forces of the last step each rank has of its own rows */
  contact->attempt.again = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
