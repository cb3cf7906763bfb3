/* Blocks: sets of cells by name, as the parts of a body that have materials of their own. */
#include "meshimpl.h"

/* The names and numbers of the blocks of a mesh, for messages. Collective */
PetscErrorCode MeshListBlocks(DM dm, char list[], size_t size)
{
  PetscInt cstart, cend;

  PetscFunctionBegin;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &cstart, &cend));
  PetscCall(MeshListLabels(dm, cstart, cend, "Cell Sets", list, size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a mesh has a block. Collective */
PetscErrorCode MeshHasBlock(DM dm, const char name[], PetscBool *has)
{
  PetscInt n, *cells;

  PetscFunctionBegin;
  PetscAssertPointer(name, 2);
  PetscAssertPointer(has, 3);
  PetscCall(MeshFindBlock(dm, name, &n, &cells, has));
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
  PetscCall(MeshFindBlock(dm, name, n, cells, &found));
  if (found) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(*cells));
  PetscCall(MeshListBlocks(dm, list, sizeof(list)));
  SETERRQ(PetscObjectComm((PetscObject)dm), PETSC_ERR_USER_INPUT, "The mesh of body '%s' has no block '%s'; it has: %s",
          ((PetscObject)dm)->name ? ((PetscObject)dm)->name : "", name, list[0] ? list : "none");
}
