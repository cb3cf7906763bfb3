/* Rows as they are at the start of a controller step, before they are built again or follow the surfaces: where the step is made again in
   halves, they do so anew, by what they expect of the shorter step. Gaps, shifts, merged rows and forces of dropped rows come back.

   The matrices of the bodies are filled anew. Bodies find the compliance of changed rows again: the same to the last bit where the halves
   change the rows that the whole step did, to round-off of the compliance where the whole step changes more. */
#include <contact/parts.h>

/* What is remembered of each row */
void ContactListRowState(Contact contact, StateList *list)
{
  const ContactRows     *rows  = &contact->rows;
  const ContactState    *start = &contact->start, *end = &contact->end;
  const ContactEnergy   *energy   = &contact->energy;
  const ContactFriction *friction = &contact->friction;
  const PetscInt         rubs     = friction->slip ? 1 : 0;

  *list = (StateList){.n      = rows->n,
                      .arrays = {{3, rows->normal},
                                 {1, rows->initial_gap},
                                 {1, rows->gap_shift},
                                 {1, start->gap},
                                 {1, end->gap},
                                 {1, start->force},
                                 {1, .bools = start->active},
                                 {1, end->force},
                                 {1, .bools = end->active},
                                 {1, rows->area},
                                 {1, contact->held.merged_gap},
                                 {1, .bools = rows->opposite},
                                 {1, .bools = rows->tied},
                                 {1, .bools = rows->changed},
                                 {1, .bools = rows->followed},
                                 {1, .bools = contact->held.dropped},
                                 {1, .bools = contact->held.heir},
                                 {1, .bools = contact->ties.holds},
                                 {1, contact->ties.distance},
                                 {1, energy->last_force},
                                 {1, energy->accepted_force},
                                 {1, energy->last_stored},
                                 {rubs, friction->loss},
                                 {rubs, friction->distance},
                                 {rubs, friction->speed},
                                 {rubs, .bools = friction->slides}}};
}

/* Puts aside what is remembered of each row */
PetscErrorCode ContactSaveRowState(Contact contact)
{
  StateList list;

  PetscFunctionBegin;
  ContactListRowState(contact, &list);
  if (!contact->saved.state) PetscCall(StateListAllocate(&list, &contact->saved.state));
  PetscCall(StateListCopy(&list, PETSC_FALSE, contact->saved.state));
  contact->saved.known = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the start of a controller step that may have to be made again, before the rows change. Where near rows are listed a step in which rows
   stay leaves all as it was but for what ContactStepBack() brings back: then ContactListAllRows() puts it aside, before rows change. */
PetscErrorCode ContactSaveRows(Contact contact)
{
  PetscFunctionBegin;
  contact->saved.known = PETSC_FALSE;
  if (!contact->rows.listed) PetscCall(ContactSaveRowState(contact));
  contact->saved.rebuilds = contact->counts.rebuilds;
  for (PetscInt b = 0; b < contact->n_bodies; b++) contact->body_rows[b].saved = contact->body_rows[b].pattern;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (!contact->pairs[p].bonded) PetscCall(TransferSave(contact->pairs[p].transfer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the start of the step that is made again. The matrices of the bodies are filled anew with the rows that follow from here. */
PetscErrorCode ContactRestoreRows(Contact contact)
{
  StateList list;

  PetscFunctionBegin;
  ContactListRowState(contact, &list);
  if (contact->saved.known) PetscCall(StateListCopy(&list, PETSC_TRUE, contact->saved.state));
  contact->counts.rebuilds = contact->saved.rebuilds;
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (contact->body_rows[b].pattern != contact->body_rows[b].saved) contact->body_rows[b].pattern++;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (!contact->pairs[p].bonded) PetscCall(TransferRestore(contact->pairs[p].transfer));
  PetscFunctionReturn(PETSC_SUCCESS);
}
