/* How the work of a run lies on the ranks: the most that one of them has, and the mean. */
#include "ranks.h"
#include <impakt/private/contactsteps.h>
#include <petscsf.h>
#include <sys/petsccompat.h>
#include <sys/resource.h>

const char *const RanksNames[RANKS_COUNTS] = {"elements",   "nodes",       "halo",        "facets", "rows",
                                              "neighbours", "peak_memory", "base_memory", "work"};

/* Work for a face of a contact surface and for a row, in units of that for an explicit hexahedron, which was 0.21 us: 3904 faces and 2401
   rows took 12 ms in a step, most of it for the layers of nodes on both surfaces */
#define WORK_FOR_FACET 13
#define WORK_FOR_ROW   3

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
  PetscInt       n, facets, rows;
  const Body    *bodies;
  Contact        contact;
  PetscBool     *neighbour;
  ControllerCost cost;
  struct rusage  usage;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(counts, RANKS_COUNTS));
  PetscCall(ControllerGetBodies(controller, &n, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(PetscCalloc1(size, &neighbour));
  for (PetscInt b = 0; b < n; b++) {
    DM              dm;
    PetscSF         sf;
    const PetscInt *leaf;
    PetscInt        n_leaves, start, end;

    PetscCall(BodyGetDM(bodies[b], &dm));
    PetscCall(DMPlexGetHeightStratum(dm, 0, &start, &end));
    counts[RANKS_ELEMENTS] += (PetscReal)(end - start);
    PetscCall(DMPlexGetDepthStratum(dm, 0, &start, &end));
    counts[RANKS_NODES] += (PetscReal)(end - start);
    PetscCall(DMGetPointSF(dm, &sf));
    PetscCall(PetscSFGetGraph(sf, NULL, &n_leaves, &leaf, NULL));
    for (PetscInt i = 0; i < n_leaves; i++) {
      const PetscInt point = leaf ? leaf[i] : i;

      if (point >= start && point < end) counts[RANKS_HALO]++;
    }
    if (size > 1) PetscCall(MarkNeighbours(dm, neighbour));
  }
  neighbour[rank] = PETSC_FALSE;
  for (PetscMPIInt r = 0; r < size; r++) counts[RANKS_NEIGHBOURS] += neighbour[r] ? 1 : 0;
  PetscCall(PetscFree(neighbour));
  PetscCall(ContactGetShare(contact, &facets, &rows));
  counts[RANKS_FACETS] = (PetscReal)facets;
  counts[RANKS_ROWS]   = (PetscReal)rows;
  PetscCall(ControllerGetCost(controller, &cost));
  counts[RANKS_BASE_MEMORY] = (PetscReal)cost.memory;
  if (!getrusage(RUSAGE_SELF, &usage)) counts[RANKS_PEAK_MEMORY] = 1024 * (PetscReal)usage.ru_maxrss; /* Linux counts kB */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Faces and rows can be worked on once all elements have been, by all ranks */
static PetscReal WorkFor(const PetscReal counts[])
{
  return counts[RANKS_ELEMENTS] + WORK_FOR_FACET * counts[RANKS_FACETS] + WORK_FOR_ROW * counts[RANKS_ROWS];
}

/* The most that one rank has, and the mean over all ranks. Collective */
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
  summary->largest[RANKS_WORK] = WorkFor(summary->largest);
  summary->mean[RANKS_WORK]    = WorkFor(summary->mean);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The most that a rank has, by the mean; 1 where there is none of it */
static PetscReal Imbalance(const RanksSummary *summary, RanksCount count)
{
  return summary->mean[count] > 0 ? summary->largest[count] / summary->mean[count] : 1;
}

/* Prints how work and memory lie on several ranks. Collective on the viewer */
PetscErrorCode RanksView(const RanksSummary *summary, PetscViewer viewer)
{
  const PetscReal megabyte = 1e6;

  PetscFunctionBegin;
  if (summary->size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "%d ranks, largest by mean\n", summary->size));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  %-32s %13.6g elements %.3g, contact faces %.3g, rows %.3g\n", "work",
                                   (double)Imbalance(summary, RANKS_WORK), (double)Imbalance(summary, RANKS_ELEMENTS),
                                   (double)Imbalance(summary, RANKS_FACETS), (double)Imbalance(summary, RANKS_ROWS)));
  PetscCall(PetscViewerASCIIPrintf(
      viewer, "  %-32s %13.6g %.3g MB, %.3g MB of it before there were bodies; %.3g of its nodes are a halo\n", "memory",
      (double)Imbalance(summary, RANKS_PEAK_MEMORY), (double)(summary->largest[RANKS_PEAK_MEMORY] / megabyte),
      (double)(summary->largest[RANKS_BASE_MEMORY] / megabyte), (double)(summary->mean[RANKS_HALO] / summary->mean[RANKS_NODES])));
  PetscFunctionReturn(PETSC_SUCCESS);
}
