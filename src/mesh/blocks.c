/* Blocks: sets of cells by name, as the parts of a body that have materials of their own. */
#include "meshimpl.h"
#include <sys/names.h>

/* The cells of this rank that a label has, with one value or any */
static PetscErrorCode CollectCells(DM dm, DMLabel label, PetscInt value, PetscBool any, PetscInt *n, PetscInt *cells[])
{
  PetscInt cstart, cend;

  PetscFunctionBegin;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &cstart, &cend));
  PetscCall(PetscMalloc1(cend - cstart, cells));
  *n = 0;
  for (PetscInt cell = cstart; cell < cend; cell++) {
    PetscInt  found = -1;
    PetscBool in    = PETSC_FALSE;

    if (any) PetscCall(DMLabelGetValue(label, cell, &found));
    else PetscCall(DMLabelStratumHasPoint(label, value, cell, &in));
    if (in || found != -1) (*cells)[(*n)++] = cell;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AnyCells(DM dm, PetscInt n, PetscBool *any)
{
  PetscInt most = n;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPIU_INT, MPI_MAX, PetscObjectComm((PetscObject)dm)));
  *any = (PetscBool)(most > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The names and numbers of the blocks of a mesh, for messages. Collective */
PetscErrorCode MeshListBlocks(DM dm, char list[], size_t size)
{
  PetscInt cstart, cend;

  PetscFunctionBegin;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &cstart, &cend));
  PetscCall(MeshListLabels(dm, cstart, cend, "Cell Sets", list, size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells of a block by its name, or else by its number */
static PetscErrorCode FindBlock(DM dm, const char name[], PetscInt *n, PetscInt *cells[], PetscBool *found)
{
  DMLabel   label = NULL;
  PetscBool internal;
  char     *end;
  long      number;

  PetscFunctionBegin;
  *found = PETSC_FALSE;
  *cells = NULL;
  *n     = 0;
  PetscCall(MeshLabelIsInternal(name, &internal));
  if (!internal) PetscCall(DMGetLabel(dm, name, &label));
  if (label) {
    PetscCall(CollectCells(dm, label, 0, PETSC_TRUE, n, cells));
    PetscCall(AnyCells(dm, *n, found));
  }
  number = strtol(name, &end, 10);
  if (*found || !name[0] || *end) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(*cells));
  PetscCall(DMGetLabel(dm, "Cell Sets", &label));
  if (!label) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CollectCells(dm, label, (PetscInt)number, PETSC_FALSE, n, cells));
  PetscCall(AnyCells(dm, *n, found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a mesh has a block. Collective */
PetscErrorCode MeshHasBlock(DM dm, const char name[], PetscBool *has)
{
  PetscInt n, *cells;

  PetscFunctionBegin;
  PetscAssertPointer(name, 2);
  PetscAssertPointer(has, 3);
  PetscCall(FindBlock(dm, name, &n, &cells, has));
  PetscCall(PetscFree(cells));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cells of a block. `cells`: points of the `DMPLEX`, ascending; free with `PetscFree()`. An error lists the blocks. Collective */
PetscErrorCode MeshGetBlock(DM dm, const char name[], PetscInt *n, PetscInt *cells[])
{
  PetscBool found;
  char      list[1024];

  PetscFunctionBegin;
  PetscAssertPointer(name, 2);
  PetscAssertPointer(n, 3);
  PetscAssertPointer(cells, 4);
  PetscCall(FindBlock(dm, name, n, cells, &found));
  if (found) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(*cells));
  PetscCall(MeshListBlocks(dm, list, sizeof(list)));
  SETERRQ(PetscObjectComm((PetscObject)dm), PETSC_ERR_USER_INPUT, "The mesh of body '%s' has no block '%s'; it has: %s",
          ((PetscObject)dm)->name ? ((PetscObject)dm)->name : "", name, list[0] ? list : "none");
}
