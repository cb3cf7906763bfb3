/*
   Rows as they are at the start of a controller step, before they are built again or follow the surfaces: where the step is made again in
   halves, they do so anew, by what they expect of the shorter step. Gaps, shifts, merged rows and forces of rows that have been let go come
   back with them.

   The matrices of the bodies are not brought back: the halves have theirs filled anew. Bodies have forgotten the compliance of rows that
   have changed, and find it again. That is the same to the last bit where the rows that change in the halves are those that did in the
   whole step; where the whole step changes more of them, to the round-off of their compliance.
*/
#include <contact/parts.h>

PetscErrorCode ContactSetUpSavedRows(Contact contact)
{
  const PetscInt    n     = contact->rows.n;
  ContactSavedRows *saved = &contact->saved;

  PetscFunctionBegin;
  PetscCall(PetscMalloc5(3 * n, &saved->normal, n, &saved->initial_gap, n, &saved->area, n, &saved->gap_shift, n, &saved->merged_gap));
  PetscCall(PetscMalloc4(n, &saved->opposite, n, &saved->tied, n, &saved->dropped, n, &saved->heir));
  PetscCall(PetscMalloc6(n, &saved->start.force, n, &saved->start.gap, n, &saved->start.active, n, &saved->end.force, n, &saved->end.gap, n,
                         &saved->end.active));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroySavedRows(Contact contact)
{
  ContactSavedRows *saved = &contact->saved;

  PetscFunctionBegin;
  PetscCall(PetscFree5(saved->normal, saved->initial_gap, saved->area, saved->gap_shift, saved->merged_gap));
  PetscCall(PetscFree4(saved->opposite, saved->tied, saved->dropped, saved->heir));
  PetscCall(PetscFree6(saved->start.force, saved->start.gap, saved->start.active, saved->end.force, saved->end.gap, saved->end.active));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyReals(PetscBool back, PetscInt n, PetscReal now[], PetscReal aside[])
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(back ? now : aside, back ? aside : now, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyBools(PetscBool back, PetscInt n, PetscBool now[], PetscBool aside[])
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(back ? now : aside, back ? aside : now, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyState(PetscBool back, PetscInt n, ContactState *now, ContactState *aside)
{
  PetscFunctionBegin;
  PetscCall(CopyReals(back, n, now->force, aside->force));
  PetscCall(CopyReals(back, n, now->gap, aside->gap));
  PetscCall(CopyBools(back, n, now->active, aside->active));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Copy(Contact contact, PetscBool back)
{
  const PetscInt    n     = contact->rows.n;
  ContactSavedRows *saved = &contact->saved;

  PetscFunctionBegin;
  PetscCall(CopyReals(back, 3 * n, contact->rows.normal, saved->normal));
  PetscCall(CopyReals(back, n, contact->rows.initial_gap, saved->initial_gap));
  PetscCall(CopyReals(back, n, contact->rows.area, saved->area));
  PetscCall(CopyReals(back, n, contact->rows.gap_shift, saved->gap_shift));
  PetscCall(CopyReals(back, n, contact->held.merged_gap, saved->merged_gap));
  PetscCall(CopyBools(back, n, contact->rows.opposite, saved->opposite));
  PetscCall(CopyBools(back, n, contact->rows.tied, saved->tied));
  PetscCall(CopyBools(back, n, contact->held.dropped, saved->dropped));
  PetscCall(CopyBools(back, n, contact->held.heir, saved->heir));
  PetscCall(CopyState(back, n, &contact->start, &saved->start));
  PetscCall(CopyState(back, n, &contact->end, &saved->end));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of near rows that are read what changes while rows stay as they are, of those that have acted in the last step forces, too; all else has
   been put aside since rows changed last */
static void SaveNear(Contact contact)
{
  ContactSavedRows *saved = &contact->saved;

  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt k = pair->near_begin; k < pair->near_end; k += ContactReadStride(pair)) {
      const PetscInt i = contact->rows.near[k];

      saved->initial_gap[i] = contact->rows.initial_gap[i];
      saved->gap_shift[i]   = contact->rows.gap_shift[i];
      saved->start.gap[i]   = contact->start.gap[i];
      saved->end.gap[i]     = contact->end.gap[i];
    }
  }
  for (PetscInt k = 0; k < contact->rows.n_acting; k++) {
    const PetscInt i = contact->rows.acting[k];

    saved->start.force[i]  = contact->start.force[i];
    saved->start.active[i] = contact->start.active[i];
    saved->end.force[i]    = contact->end.force[i];
    saved->end.active[i]   = contact->end.active[i];
  }
}

/* At the start of a controller step that may have to be made again, before the rows change */
PetscErrorCode ContactSaveRows(Contact contact)
{
  PetscFunctionBegin;
  if (contact->rows.listed) SaveNear(contact);
  else PetscCall(Copy(contact, PETSC_FALSE));
  contact->saved.rebuilds = contact->counts.rebuilds;
  for (PetscInt b = 0; b < contact->n_bodies; b++) contact->body_rows[b].saved = contact->body_rows[b].pattern;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];

    pair->was_far = pair->far;
    if (!pair->bonded && !pair->far) PetscCall(TransferSave(pair->transfer));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the start of the step that is made again. The matrices of the bodies are filled anew with the rows that follow from here. */
PetscErrorCode ContactRestoreRows(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(Copy(contact, PETSC_TRUE));
  ContactForgetReadRows(contact);
  contact->counts.rebuilds = contact->saved.rebuilds;
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (contact->body_rows[b].pattern != contact->body_rows[b].saved) contact->body_rows[b].pattern++;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];

    if (pair->bonded) continue;
    if (pair->was_far) PetscCall(TransferSleep(pair->transfer));
    else PetscCall(TransferRestore(pair->transfer));
    pair->far = pair->was_far;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
