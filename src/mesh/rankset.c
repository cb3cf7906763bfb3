/* Meshes that some of the ranks have among them, and others nothing of.

   Such a mesh is made whole on the first rank, boxes of bricks apart, divided there into as many parts as there are ranks to have one, and
   sent to these. */
#include "meshimpl.h"
#include <petscpartitioner.h>

/* The part that a rank has; -1: none */
PetscMPIInt MeshRanksFind(const MeshRanks *ranks, PetscMPIInt rank)
{
  if (!ranks->list) return rank < ranks->n ? rank : -1;
  for (PetscMPIInt part = 0; part < ranks->n; part++)
    if (ranks->list[part] == rank) return part;
  return -1;
}

static PetscMPIInt RankOf(const MeshRanks *ranks, PetscInt part)
{
  return ranks->list ? ranks->list[part] : (PetscMPIInt)part;
}

/* Ends with an error if the ranks are not a set of those that there are, or if an option divides the mesh otherwise */
PetscErrorCode MeshRanksCheck(MPI_Comm comm, const char prefix[], PetscMPIInt size, const MeshRanks *ranks)
{
  static const char *const options[]   = {"-dm_distribute", "-dm_distribute_overlap"};
  const char *const        divisions[] = {"bricks", "graph", "whole"};
  PetscInt                 division    = 0;
  PetscBool                set;

  PetscFunctionBegin;
  for (PetscMPIInt i = 0; i < ranks->n; i++)
    PetscCheck(ranks->list[i] >= 0 && ranks->list[i] < size && (!i || ranks->list[i] > ranks->list[i - 1]), comm, PETSC_ERR_ARG_OUTOFRANGE,
               "Ranks that are to have a mesh must be ascending numbers from 0 to %d, not %d", size - 1, ranks->list[i]);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options); i++) {
    PetscCall(PetscOptionsHasName(NULL, prefix, options[i], &set));
    PetscCheck(!set, comm, PETSC_ERR_USER_INPUT,
               "-%s%s: PETSc divides the mesh among all ranks then, and not among those of -%sranks; leave one of them out", prefix,
               options[i] + 1, prefix);
  }
  PetscCall(PetscOptionsGetEList(NULL, prefix, "-mesh_division", divisions, 3, &division, &set));
  PetscCheck(!set || division < 2 || ranks->n == 1, comm, PETSC_ERR_USER_INPUT,
             "-%smesh_division whole: one rank has all of the mesh, and -%sranks names %d; name one, or leave one of the options out",
             prefix, prefix, ranks->n);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells PETSc which cells go to which rank: part[c] is the part that the cell c of this rank belongs to */
PetscErrorCode MeshSetParts(DM dm, const MeshRanks *ranks, PetscInt n, const PetscInt part[])
{
  PetscPartitioner partitioner;
  PetscMPIInt      size;
  PetscInt        *sizes, *next, *cells;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)dm), &size));
  PetscCall(PetscCalloc3(size, &sizes, size + 1, &next, n, &cells));
  for (PetscInt c = 0; c < n; c++) sizes[RankOf(ranks, part[c])]++;
  for (PetscMPIInt rank = 0; rank < size; rank++) next[rank + 1] = next[rank] + sizes[rank];
  for (PetscInt c = 0; c < n; c++) cells[next[RankOf(ranks, part[c])]++] = c;
  PetscCall(DMPlexGetPartitioner(dm, &partitioner));
  PetscCall(PetscPartitionerSetType(partitioner, PETSCPARTITIONERSHELL));
  PetscCall(PetscPartitionerShellSetPartition(partitioner, size, sizes, cells));
  PetscCall(PetscFree3(sizes, next, cells));
  PetscFunctionReturn(PETSC_SUCCESS);
}
