/*
   What the method remembers from step to step, as tables by which a run is continued on another number of ranks: the active set that was
   solved for, rows that a cycle of active sets holds, and secants. The Jacobian follows from the compliance of the bodies, to round-off.
   Secants do not follow from anything: without them the first steps take other sweeps, and agree to the tolerance of the outer iteration
   alone.
*/
#include "schwarzimpl.h"
#include <checkpoint/tables.h>

/* Numbers that all ranks have alike: a step has been made, which side takes displacements, active sets have gone round in a cycle, secants
 * there are, and the next one */
enum { STARTED, SIDE, CYCLED, N_SECANTS, NEXT_SECANT, N_NUMBERS };

/* Of each row: the active set that was solved for, and whether the row is held to the end of a cycle */
enum { SOLVED, KEPT, N_FLAGS };

#define NUMBERS_NAME "schwarz/memory"

/* Of whole controller steps */
static void GetWhole(Schwarz *schwarz, Secants **secants, PetscBool **solved_active)
{
  SchwarzMemory *whole = &schwarz->memory[0];

  *secants       = schwarz->level ? &whole->secants : &schwarz->secants;
  *solved_active = schwarz->level ? whole->solved_active : schwarz->solved_active;
}

/* The unknowns of a row in a vector, to a line or back */
static PetscErrorCode CopyUnknowns(Contact contact, PetscInt i, PetscBool back, Vec vec, PetscReal **packed)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;
  PetscScalar   *values;

  PetscFunctionBegin;
  PetscCall(VecGetArray(vec, &values));
  TablesCopyReals(back, schwarz->room[contact->rows.pair[i]], values + schwarz->offset[i], packed);
  PetscCall(VecRestoreArray(vec, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyRow(Contact contact, PetscInt i, PetscBool back, PetscReal **packed)
{
  Schwarz   *schwarz = (Schwarz *)contact->data;
  Secants   *secants;
  PetscBool *solved_active;

  PetscFunctionBegin;
  GetWhole(schwarz, &secants, &solved_active);
  TablesCopyBool(back, &solved_active[i], packed);
  TablesCopyBool(back, &schwarz->rounds.kept[i], packed);
  for (PetscInt k = 0; k < secants->n; k++) {
    PetscCall(CopyUnknowns(contact, i, back, secants->dx[k], packed));
    PetscCall(CopyUnknowns(contact, i, back, secants->df[k], packed));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of a pair, a line for each node of its first surface */
static PetscErrorCode CopyPair(Contact contact, const ContactPair *pair, PetscBool back, Tables tables)
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const PetscInt     n = (pair->end - pair->begin) / pair->components, p = (PetscInt)(pair - contact->pairs);
  PetscInt           width, n_all, row;
  const PetscReal   *values = NULL;
  const SurfaceData *data;
  PetscReal         *packed, *next;
  PetscBool         *solved_active;
  Secants           *secants;
  char               name[256];

  PetscFunctionBegin;
  GetWhole(schwarz, &secants, &solved_active);
  width = TABLES_KEY + pair->components * (N_FLAGS + 2 * secants->n * schwarz->room[p]);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s/schwarz", pair->name));
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
    for (PetscInt k = 0; k < pair->components; k++) PetscCall(CopyRow(contact, pair->begin + i * pair->components + k, back, &next));
  }
  if (!back) PetscCall(TablesAdd(tables, name, n, width, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the tables; collective */
PetscErrorCode SchwarzPack(Contact contact, Tables tables)
{
  Schwarz   *schwarz = (Schwarz *)contact->data;
  PetscBool *solved_active;
  Secants   *secants;

  PetscFunctionBegin;
  GetWhole(schwarz, &secants, &solved_active);
  PetscCall(TablesAddNumbers(tables, NUMBERS_NAME, N_NUMBERS,
                             (PetscReal[N_NUMBERS]){schwarz->started, (PetscReal)schwarz->side, schwarz->rounds.cycled,
                                                    (PetscReal)secants->n, (PetscReal)secants->next}));
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_FALSE, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes them back, in a method that is as after its set-up; collective */
PetscErrorCode SchwarzUnpack(Contact contact, Tables tables)
{
  Schwarz         *schwarz = (Schwarz *)contact->data;
  const PetscReal *numbers;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(TablesGetNumbers(tables, NUMBERS_NAME, &n, &numbers));
  PetscCheck(n == N_NUMBERS && numbers[N_SECANTS] >= 0 && numbers[N_SECANTS] <= (schwarz->secants.dx ? SCHWARZ_MAX_SECANTS : 0),
             PetscObjectComm((PetscObject)contact), PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has a memory of -contact_type schwarz that this run has no room for: it is of another problem");
  schwarz->started       = (PetscBool)(numbers[STARTED] != 0);
  schwarz->side          = schwarz->swap && numbers[SIDE] != 0;
  schwarz->levels        = schwarz->side_levels[schwarz->side];
  schwarz->rounds.cycled = (PetscBool)(numbers[CYCLED] != 0);
  schwarz->secants.n     = (PetscInt)numbers[N_SECANTS];
  schwarz->secants.next  = (PetscInt)numbers[NEXT_SECANT] % SCHWARZ_MAX_SECANTS;
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CopyPair(contact, &contact->pairs[p], PETSC_TRUE, tables));
  /* a whole step after steps that were cut begins without them, as the run without the restart does: see SchwarzSetStepLevel() */
  if (contact->attempt.accepted_level && schwarz->secants.dx) SchwarzResetSecants(contact, PETSC_TRUE);
  PetscFunctionReturn(PETSC_SUCCESS);
}
