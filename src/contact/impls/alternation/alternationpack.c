/*
   What the method remembers from step to step, as tables by which a run is continued on another number of ranks: which side takes
   displacements, and the rows that a cycle of active sets holds.
*/
#include "alternationimpl.h"
#include <checkpoint/tables.h>

/* Numbers that all ranks have alike: a step has been made, which side takes displacements, active sets have gone round in a cycle */
enum { STARTED, SIDE, CYCLED, N_NUMBERS };

#define NUMBERS_NAME "alternation/memory"

/* Whether the rows of a pair are held to the end of a cycle, a line for each node of its first surface */
static PetscErrorCode CopyPair(Contact contact, const ContactPair *pair, PetscBool back, Tables tables)
{
  Alternation       *alternation = (Alternation *)contact->data;
  const PetscInt     n = (pair->end - pair->begin) / pair->components, width = TABLES_KEY + pair->components;
  PetscInt           n_all, row;
  const PetscReal   *values = NULL;
  const SurfaceData *data;
  PetscReal         *packed, *next;
  char               name[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s/alternation", pair->name));
  PetscCall(SurfaceGetData(pair->surfaces[0], &data));
  if (back) PetscCall(TablesGet(tables, name, width, &n_all, &values));
  PetscCall(PetscMalloc1(PetscMax(n, 1) * width, &packed));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal *line = packed + i * width;

    PetscCall(PetscArraycpy(line, data->reference + 3 * i, 3));
    if (back) {
      PetscCall(TablesFind(tables, name, line, &row));
      PetscCall(PetscArraycpy(line, values + row * width, width));
    }
    next = line + TABLES_KEY;
    for (PetscInt k = 0; k < pair->components; k++)
      TablesCopyBool(back, &alternation->rounds.kept[pair->begin + i * pair->components + k], &next);
  }
  if (!back) PetscCall(TablesAdd(tables, name, n, width, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the tables; collective */
PetscErrorCode AlternationPack(Contact contact, Tables tables)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  PetscCall(TablesAddNumbers(tables, NUMBERS_NAME, N_NUMBERS,
                             (PetscReal[N_NUMBERS]){alternation->started, (PetscReal)alternation->side, alternation->rounds.cycled}));
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_FALSE, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes them back, in a method that is as after its set-up; collective */
PetscErrorCode AlternationUnpack(Contact contact, Tables tables)
{
  Alternation     *alternation = (Alternation *)contact->data;
  const PetscReal *numbers;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(TablesGetNumbers(tables, NUMBERS_NAME, &n, &numbers));
  PetscCheck(n == N_NUMBERS, PetscObjectComm((PetscObject)contact), PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has another memory of -contact_type alternation: it is of another version of the program");
  alternation->started       = (PetscBool)(numbers[STARTED] != 0);
  alternation->side          = alternation->swap && numbers[SIDE] != 0;
  alternation->levels        = alternation->side_levels[alternation->side];
  alternation->rounds.cycled = (PetscBool)(numbers[CYCLED] != 0);
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_TRUE, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}
