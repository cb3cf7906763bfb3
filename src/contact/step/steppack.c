/* Memory of the contact step, as tables to continue a run on another number of ranks: which nodes have touched first in the last step, as
   their guess is another one, what laws keep of glued nodes, what secants have shown, and what contact and damage have taken. */
#include "stepimpl.h"
#include <checkpoint/statelist.h>

#define LOSS_NAME "step/loss"

/* The place of a row of this rank among those of which the body on one side of its pair has secants; -1: none */
static PetscErrorCode FindPlace(Contact contact, const ContactPair *pair, PetscInt side, PetscInt i, PetscReal *place)
{
  const PetscInt        b    = pair->body[side];
  const StepperSecants *kept = &((const ContactStepper *)contact->data)->assembly.of_body[b].kept;
  PetscInt              k    = -1;

  PetscFunctionBegin;
  if (side < ContactPairBodies(pair)) PetscCall(PetscFindInt(contact->body_rows[b].begin + i - pair->shift[side], kept->n, kept->rows, &k));
  *place = PetscMax(k, -1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of a pair, to a table with a line for each node of its first surface, or back. `places`: of rows, on both sides, in secants */
static PetscErrorCode CopyPair(Contact contact, const ContactPair *pair, PetscBool back, PetscReal *const places[2], Tables tables)
{
  const ContactStepper *stepper = (const ContactStepper *)contact->data;
  const StateList       list    = {
      .n      = contact->rows.n,
      .arrays = {{1, .bools = stepper->joined}, {1, places[0]}, {1, places[1]}, {stepper->glued ? ROW_LAW_HISTORY : 0, stepper->history}}};
  const SurfaceData *data;
  char               name[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s/step", pair->name));
  PetscCall(SurfaceGetData(pair->surfaces[0], &data));
  for (PetscInt i = pair->begin; i < pair->end && !back; i++)
    for (PetscInt side = 0; side < 2; side++) PetscCall(FindPlace(contact, pair, side, i, &places[side][i]));
  PetscCall(StateListCopyNodes(&list, pair->begin, (pair->end - pair->begin) / pair->components, pair->components, data->reference, name,
                               back, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SecantsName(Contact contact, PetscInt b, size_t length, char name[])
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, length, "step/secants/%s", ((PetscObject)contact->bodies[b])->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of how many rows secants are, then their numbers */
static PetscErrorCode PackSecants(Contact contact, PetscInt b, Tables tables)
{
  const StepperSecants *kept = &((const ContactStepper *)contact->data)->assembly.of_body[b].kept;
  const PetscInt        size = 2 * kept->n * kept->n_pairs;
  PetscReal            *values;
  char                  name[256];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(1 + size, &values));
  values[0] = (PetscReal)kept->n;
  PetscCall(PetscArraycpy(values + 1, kept->values, size));
  PetscCall(SecantsName(contact, b, sizeof(name), name));
  PetscCall(TablesAddNumbers(tables, name, 1 + size, values));
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes back the secants of rows, which have other numbers now. `places`: of all rows, on both sides */
static PetscErrorCode UnpackSecants(Contact contact, PetscInt b, PetscReal *const places[2], Tables tables)
{
  StepperSecants  *kept = &((ContactStepper *)contact->data)->assembly.of_body[b].kept;
  const PetscReal *values;
  PetscInt         n, size, n_pairs, *from, found = 0;
  char             name[256];

  PetscFunctionBegin;
  PetscCall(SecantsName(contact, b, sizeof(name), name));
  PetscCall(TablesGetNumbers(tables, name, &size, &values));
  n       = (PetscInt)values[0];
  n_pairs = n ? (size - 1) / (2 * n) : 0;
  PetscCheck(size == 1 + 2 * n * n_pairs, PetscObjectComm((PetscObject)contact), PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has %" PetscInt_FMT " numbers of '%s', which are no secants of %" PetscInt_FMT " rows: it is damaged", size,
             name, n);
  PetscCall(StepperSecantsResize(kept, n, n_pairs));
  PetscCall(PetscMalloc1(PetscMax(n, 1), &from));
  for (PetscInt r = 0; r < contact->body_rows[b].n_all && found < n; r++) {
    const PetscInt row   = contact->body_rows[b].all[r];
    const PetscInt side  = contact->pairs[contact->ranks.row_pair[row]].body[0] != b;
    const PetscInt place = (PetscInt)places[side][row];

    if (place < 0) continue;
    kept->rows[found] = r;
    from[found++]     = place;
  }
  PetscCheck(found == n, PetscObjectComm((PetscObject)contact), PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has '%s' of %" PetscInt_FMT " rows, and places of %" PetscInt_FMT ": it is damaged", name, n, found);
  for (PetscInt j = 0; j < 2 * n_pairs; j++)
    for (PetscInt k = 0; k < n; k++) kept->values[j * n + k] = values[1 + j * n + from[k]];
  PetscCall(PetscFree(from));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same, of all bodies, from the places of this rank's rows */
static PetscErrorCode UnpackAllSecants(Contact contact, PetscReal *const mine[2], Tables tables)
{
  const PetscInt n_all = contact->rows.n_all;
  PetscReal     *places[2];

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n_all, &places[0], n_all, &places[1]));
  for (PetscInt side = 0; side < 2; side++) PetscCall(ContactGatherRows(contact, mine[side], places[side]));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(UnpackSecants(contact, b, places, tables));
  PetscCall(PetscFree2(places[0], places[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the tables; collective */
PetscErrorCode ContactStepperPack(Contact contact, Tables tables)
{
  const ContactStepper *stepper   = (const ContactStepper *)contact->data;
  PetscReal *const      places[2] = {stepper->mine, stepper->before};
  const PetscReal       losses[]  = {contact->counts.contact_loss, contact->counts.glue_loss};

  PetscFunctionBegin;
  PetscCall(TablesAddNumbers(tables, LOSS_NAME, 2, losses));
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_FALSE, places, tables));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(PackSecants(contact, b, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes them back, in a step that is as after its set-up; collective */
PetscErrorCode ContactStepperUnpack(Contact contact, Tables tables)
{
  ContactStepper  *stepper   = (ContactStepper *)contact->data;
  PetscReal       *places[2] = {stepper->mine, stepper->before};
  const PetscReal *loss;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(TablesGetNumbers(tables, LOSS_NAME, &n, &loss));
  PetscCheck(n == 2, PetscObjectComm((PetscObject)contact), PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has %" PetscInt_FMT " losses of contact in place of two: it is of another problem", n);
  contact->counts.contact_loss = loss[0];
  contact->counts.glue_loss    = loss[1];
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_TRUE, places, tables));
  if (stepper->glued) PetscCall(PetscArraycpy(stepper->grown, stepper->history, ROW_LAW_HISTORY * contact->rows.n));
  PetscCall(UnpackAllSecants(contact, places, tables));
  stepper->state++;
  PetscFunctionReturn(PETSC_SUCCESS);
}
