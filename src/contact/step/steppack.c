/* What the contact step remembers from step to step, as tables by which a run is continued on another number of ranks: which nodes have
   touched first in the last step, as their guess is another one, and what contact has taken. */
#include "stepimpl.h"
#include <checkpoint/tables.h>

#define LOSS_NAME "step/loss"

/* The rows of a node touch all together: a line for each node of the pair's first surface, to a table or back */
static PetscErrorCode CopyPair(Contact contact, const ContactPair *pair, PetscBool back, Tables tables)
{
  const ContactStepper *stepper = (const ContactStepper *)contact->data;
  const PetscInt        n = (pair->end - pair->begin) / pair->components, width = TABLES_KEY + 1;
  const PetscReal      *values = NULL;
  const SurfaceData    *data;
  PetscReal            *packed;
  PetscInt              n_all, row;
  char                  name[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s/step", pair->name));
  PetscCall(SurfaceGetData(pair->surfaces[0], &data));
  if (back) PetscCall(TablesGet(tables, name, width, &n_all, &values));
  PetscCall(PetscMalloc1(PetscMax(n, 1) * width, &packed));
  for (PetscInt i = 0; i < n; i++) {
    PetscBool *joined = stepper->joined + pair->begin + i * pair->components;
    PetscReal *line = packed + i * width, *next = line + TABLES_KEY;

    PetscCall(PetscArraycpy(line, data->reference + 3 * i, 3));
    if (back) {
      PetscCall(TablesFind(tables, name, line, &row));
      PetscCall(PetscArraycpy(line, values + row * width, width));
    }
    TablesCopyBool(back, joined, &next);
    for (PetscInt k = 1; k < pair->components; k++) joined[k] = joined[0];
  }
  if (!back) PetscCall(TablesAdd(tables, name, n, width, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the tables; collective */
PetscErrorCode ContactStepperPack(Contact contact, Tables tables)
{
  PetscFunctionBegin;
  PetscCall(TablesAddNumbers(tables, LOSS_NAME, 1, &contact->counts.contact_loss));
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_FALSE, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes them back, in a step that is as after its set-up; collective */
PetscErrorCode ContactStepperUnpack(Contact contact, Tables tables)
{
  ContactStepper  *stepper = (ContactStepper *)contact->data;
  const PetscReal *loss;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(TablesGetNumbers(tables, LOSS_NAME, &n, &loss));
  PetscCheck(n == 1, PetscObjectComm((PetscObject)contact), PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has %" PetscInt_FMT " losses of contact in place of one: it is of another problem", n);
  contact->counts.contact_loss = loss[0];
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_TRUE, tables));
  stepper->state++;
  PetscFunctionReturn(PETSC_SUCCESS);
}
