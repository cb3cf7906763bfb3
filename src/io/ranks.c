/* How the work of a run lies on the ranks: the most that one of them has, and the mean. */
#include "ranks.h"
#include <petscsf.h>
#include <sys/petsccompat.h>
#include <sys/resource.h>

const char *const RanksNames[RANKS_COUNTS] = {"elements", "nodes", "facets", "rows", "neighbours", "peak_memory"};

/* Marks the ranks with which this one shares nodes of a mesh */
static PetscErrorCode MarkNeighbours(DM dm, PetscBool neighbour[])
{
  PetscSF            sf;
  SF_RANK_COUNT      n;
  const PetscMPIInt *ranks;

  PetscFunctionBegin;
  PetscCall(DMGetPointSF(dm, &sf));
  PetscCall(PetscSFSetUp(sf));
  PetscCall(PetscSFGetRootRanks(sf, &n, &ranks, NULL, NULL, NULL));
  for (SF_RANK_COUNT i = 0; i < n; i++) neighbour[ranks[i]] = PETSC_TRUE;
  PetscCall(PetscSFGetLeafRanks(sf, &n, &ranks, NULL, NULL));
  for (SF_RANK_COUNT i = 0; i < n; i++) neighbour[ranks[i]] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CountOnRank(Controller controller, PetscMPIInt size, PetscMPIInt rank, PetscReal counts[])
{
  PetscInt      n, facets, rows;
  const Body   *bodies;
  Contact       contact;
  PetscBool    *neighbour;
  struct rusage usage;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(counts, RANKS_COUNTS));
  PetscCall(ControllerGetBodies(controller, &n, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(PetscCalloc1(size, &neighbour));
  for (PetscInt b = 0; b < n; b++) {
    DM       dm;
    PetscInt start, end;

    PetscCall(BodyGetDM(bodies[b], &dm));
    PetscCall(DMPlexGetHeightStratum(dm, 0, &start, &end));
    counts[RANKS_ELEMENTS] += (PetscReal)(end - start);
    PetscCall(DMPlexGetDepthStratum(dm, 0, &start, &end));
    counts[RANKS_NODES] += (PetscReal)(end - start);
    if (size > 1) PetscCall(MarkNeighbours(dm, neighbour));
  }
  neighbour[rank] = PETSC_FALSE;
  for (PetscMPIInt r = 0; r < size; r++) counts[RANKS_NEIGHBOURS] += neighbour[r] ? 1 : 0;
  PetscCall(PetscFree(neighbour));
  PetscCall(ContactGetShare(contact, &facets, &rows));
  counts[RANKS_FACETS] = (PetscReal)facets;
  counts[RANKS_ROWS]   = (PetscReal)rows;
  if (!getrusage(RUSAGE_SELF, &usage)) counts[RANKS_PEAK_MEMORY] = 1024 * (PetscReal)usage.ru_maxrss; /* Linux counts kB */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  RanksGather - the most that one rank has, and the mean over all ranks

  Collective

  Input Parameter:
. controller - the `Controller`, after its set-up

  Output Parameter:
. summary - the same on all ranks
*/
PetscErrorCode RanksGather(Controller controller, RanksSummary *summary)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)controller);
  PetscReal   counts[RANKS_COUNTS];
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &summary->size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(CountOnRank(controller, summary->size, rank, counts));
  PetscCallMPI(MPI_Allreduce(counts, summary->largest, RANKS_COUNTS, MPIU_REAL, MPIU_MAX, comm));
  PetscCallMPI(MPI_Allreduce(counts, summary->mean, RANKS_COUNTS, MPIU_REAL, MPIU_SUM, comm));
  for (PetscInt i = 0; i < RANKS_COUNTS; i++) summary->mean[i] /= summary->size;
  PetscFunctionReturn(PETSC_SUCCESS);
}
