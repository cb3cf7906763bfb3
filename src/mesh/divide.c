/* Meshes that are divided among ranks: as a graph, or by where surfaces may touch, see bisection.c. */
#include "meshimpl.h"

/* Divides the graph of a mesh by the partitioner of its options, a part for each of these ranks: part[c] of the cells of this rank */
static PetscErrorCode DivideGraph(DM dm, const MeshRanks *ranks, PetscInt part[])
{
  PetscPartitioner partitioner;
  PetscSection     section;
  PetscInt         n, *offsets, *neighbours;
  const PetscInt  *cells;
  IS               numbering, partition;

  PetscFunctionBegin;
  PetscCall(DMPlexGetPartitioner(dm, &partitioner));
  PetscCall(PetscPartitionerSetFromOptions(partitioner));
  PetscCall(DMPlexCreatePartitionerGraph(dm, 0, &n, &offsets, &neighbours, &numbering));
  PetscCall(PetscSectionCreate(PetscObjectComm((PetscObject)dm), &section));
  PetscCall(PetscPartitionerPartition(partitioner, ranks->n, n, offsets, neighbours, NULL, NULL, NULL, section, &partition));
  PetscCall(ISGetIndices(partition, &cells));
  for (PetscInt p = 0; p < ranks->n; p++) {
    PetscInt count, first;

    PetscCall(PetscSectionGetDof(section, p, &count));
    PetscCall(PetscSectionGetOffset(section, p, &first));
    for (PetscInt i = first; i < first + count; i++) part[cells[i]] = p; /* all cells are of one rank: its numbers are those of all */
  }
  PetscCall(ISRestoreIndices(partition, &cells));
  PetscCall(ISDestroy(&partition));
  PetscCall(PetscSectionDestroy(&section));
  PetscCall(ISDestroy(&numbering));
  PetscCall(PetscFree(offsets));
  PetscCall(PetscFree(neighbours));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Divides a mesh that is on the first rank among these ranks: by the coordinates of its cells where a surface may touch another body and
   that makes a step cheaper, else as a graph. stage: what there was of it before DMSetFromOptions() */
PetscErrorCode MeshDivideAmong(const MeshRanks *ranks, const char prefix[], const char name[], MeshStage stage, PetscBool placed, DM *dm,
                               MeshMiddles *middles)
{
  PetscBool spread = PETSC_FALSE;
  PetscInt  start, end, *part;

  PetscFunctionBegin;
  if (ranks->n > 1 && stage == MESH_ON_ONE_RANK) PetscCall(MeshSpreadContact(*dm, ranks, prefix, name, placed, &spread));
  if (!spread) {
    PetscCall(DMPlexGetHeightStratum(*dm, 0, &start, &end));
    PetscCall(PetscCalloc1(end - start, &part));
    if (ranks->n > 1) PetscCall(DivideGraph(*dm, ranks, part));
    PetscCall(MeshSetParts(*dm, ranks, end - start, part));
    PetscCall(PetscFree(part));
  }
  PetscCall(MeshDivideWithMiddles(dm, middles));
  PetscFunctionReturn(PETSC_SUCCESS);
}
