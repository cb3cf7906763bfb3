/* Copies of the numbers in a list of arrays. Put aside are the arrays one behind the other, reals before flags. */
#include <checkpoint/statelist.h>

/* Numbers of each node or row */
PetscInt StateListGetWidth(const StateList *list)
{
  PetscInt width = 0;

  for (PetscInt k = 0; k < STATE_ARRAYS; k++) width += list->arrays[k].per;
  return width;
}

/* Room for what is put aside, never NULL. Free with PetscFree(). */
PetscErrorCode StateListAllocate(const StateList *list, PetscReal *aside[])
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(StateListGetWidth(list) * list->n + 1, aside));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All arrays, aside or back */
PetscErrorCode StateListCopy(const StateList *list, PetscBool back, PetscReal aside[])
{
  PetscBool *bools;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < STATE_ARRAYS; k++) {
    PetscReal     *own = list->arrays[k].reals;
    const PetscInt n   = own ? list->arrays[k].per * list->n : 0;

    PetscCall(PetscArraycpy(back ? own : aside, back ? aside : own, n));
    aside += n;
  }
  bools = (PetscBool *)aside;
  for (PetscInt k = 0; k < STATE_ARRAYS; k++) {
    PetscBool     *own = list->arrays[k].bools;
    const PetscInt n   = own ? list->arrays[k].per * list->n : 0;

    PetscCall(PetscArraycpy(back ? own : bools, back ? bools : own, n));
    bools += n;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The numbers of node or row i, to a packed line or back */
void StateListCopyOne(const StateList *list, PetscInt i, PetscBool back, PetscReal packed[])
{
  for (PetscInt k = 0; k < STATE_ARRAYS; k++) {
    const StateArray *own = &list->arrays[k];

    if (own->reals) TablesCopyReals(back, own->per, own->reals + own->per * i, &packed);
    else if (!own->bools) packed += own->per;
    for (PetscInt d = 0; own->bools && d < own->per; d++) TablesCopyBool(back, &own->bools[own->per * i + d], &packed);
  }
}

/* All arrays, to or from a checkpoint */
PetscErrorCode StateListVisit(const StateList *list, const char name[], Checkpoint checkpoint)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < STATE_ARRAYS && list->n; k++) { /* arrays of no length may be NULL */
    const StateArray *own = &list->arrays[k];

    if (own->reals) PetscCall(CheckpointVisitReals(checkpoint, name, own->per * list->n, own->reals));
    if (own->bools) PetscCall(CheckpointVisitBools(checkpoint, name, own->per * list->n, own->bools));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The numbers of n nodes with `each` rows, from row `begin` on, to a table with a line per node, or back. `keys`: the nodes' places */
PetscErrorCode StateListVisitNodes(const StateList *list, PetscInt begin, PetscInt n, PetscInt each, const PetscReal keys[],
                                   const char name[], Tables tables)
{
  const PetscInt   own = StateListGetWidth(list), width = TABLES_KEY + each * own;
  const PetscBool  back   = TablesLoads(tables);
  const PetscReal *values = NULL;
  PetscReal       *packed;
  PetscInt         n_all, row;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(width * PetscMax(n, 1), &packed));
  if (back) PetscCall(TablesGet(tables, name, width, &n_all, &values));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal *line = packed + (back ? 0 : width * i);

    PetscCall(PetscArraycpy(line, keys + TABLES_KEY * i, TABLES_KEY));
    if (back) {
      PetscCall(TablesFind(tables, name, line, &row));
      PetscCall(PetscArraycpy(line, values + width * row, width));
    }
    for (PetscInt k = 0; k < each; k++) StateListCopyOne(list, begin + i * each + k, back, line + TABLES_KEY + k * own);
  }
  if (!back) PetscCall(TablesAdd(tables, name, n, width, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}
