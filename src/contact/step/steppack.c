/* Memory of the contact step, for checkpoints: which nodes have touched first in the last step, and how their forces have grown in it, for
   the guess, what laws keep of glued nodes, and what secants have shown. */
#include "stepimpl.h"
#include <checkpoint/statelist.h>

/* What is remembered of rows. `numbers`: work space for another number of ranks, their numbers among those of both bodies; NULL: none */
static StateList ListRows(Contact contact, PetscReal *const numbers[2])
{
  const ContactStepper *stepper = Stepper(contact);
  const PetscInt        others  = numbers ? 1 : 0;

  return (StateList){.n      = contact->rows.n,
                     .arrays = {{1, .bools = stepper->joined},
                                {1, stepper->grows},
                                {stepper->glued ? ROW_LAW_HISTORY : 0, stepper->history},
                                {stepper->glued ? ROW_LAW_HISTORY : 0, stepper->grown},
                                {others, numbers ? numbers[0] : NULL},
                                {others, numbers ? numbers[1] : NULL}}};
}

/* ContactStepperVisit - what a rank has, to or from a checkpoint */
PetscErrorCode ContactStepperVisit(Contact contact, Checkpoint checkpoint)
{
  const StateList list = ListRows(contact, NULL);

  PetscFunctionBegin;
  PetscCall(StateListVisit(&list, "step", checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Secants of a body are of rows that have other numbers now. `numbers`: those that all rows had, on both sides */
static PetscErrorCode RenumberSecants(Contact contact, PetscInt b, PetscReal *const numbers[2])
{
  StepperSecants *kept = &Stepper(contact)->assembly.of_body[b].kept;
  const PetscInt  n    = kept->n;
  PetscInt       *rows, *from, found = 0;
  PetscScalar    *values;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &rows, n, &from, n, &values));
  for (PetscInt r = 0; r < contact->body_rows[b].n_all && found < n; r++) {
    const PetscInt row  = contact->body_rows[b].all[r];
    const PetscInt side = contact->pairs[contact->ranks.row_pair[row]].body[0] != b;

    PetscCall(PetscFindInt((PetscInt)numbers[side][row], n, kept->rows, &from[found]));
    if (from[found] >= 0) rows[found++] = r;
  }
  PetscCheck(found == n, PetscObjectComm((PetscObject)contact), PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has secants of %" PetscInt_FMT " rows of body '%s', and %" PetscInt_FMT " of these rows: it is damaged", n,
             ((PetscObject)contact->bodies[b])->name, found);
  PetscCall(PetscArraycpy(kept->rows, rows, n));
  for (PetscInt j = 0; j < 2 * kept->n_pairs; j++) {
    PetscCall(PetscArraycpy(values, kept->values + j * n, n));
    for (PetscInt k = 0; k < n; k++) kept->values[j * n + k] = values[from[k]];
  }
  PetscCall(PetscFree3(rows, from, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same, of all bodies, from the numbers of this rank's rows */
static PetscErrorCode RenumberAllSecants(Contact contact, PetscReal *const mine[2])
{
  const PetscInt n_all = contact->rows.n_all;
  PetscReal     *numbers[2];

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n_all, &numbers[0], n_all, &numbers[1]));
  for (PetscInt side = 0; side < 2; side++) PetscCall(ContactGatherRows(contact, MPIU_REAL, mine[side], numbers[side]));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(RenumberSecants(contact, b, numbers));
  PetscCall(PetscFree2(numbers[0], numbers[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactStepperVisitTables - the same for another number of ranks; loading, in a step that is as after its set-up, with secants of rows
   as they were numbered. Collective. */
PetscErrorCode ContactStepperVisitTables(Contact contact, Tables tables)
{
  ContactStepper  *stepper    = Stepper(contact);
  PetscReal *const numbers[2] = {stepper->mine, stepper->before};
  const StateList  list       = ListRows(contact, numbers);

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt side = 0; side < 2; side++)
      for (PetscInt i = pair->begin; i < pair->end; i++)
        numbers[side][i] = side < ContactPairBodies(pair) ? (PetscReal)(contact->body_rows[pair->body[side]].begin + i - pair->shift[side])
                                                          : -1;
    PetscCall(ContactVisitPairNodes(pair, &list, "step", tables));
  }
  if (TablesLoads(tables)) PetscCall(RenumberAllSecants(contact, numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}
