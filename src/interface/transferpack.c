/* The state of a transfer as tables of its nodes, by which a run is continued on another number of ranks: what belongs to each node of the
   first side, what to each of the partner's, and the shares of the partner's nodes in the rows. */
#include "interfaceimpl.h"
#include "transfervisit.h"

#define N_SHARE 11 /* key of its row, position of the partner's node, weight, goal and slope */

static PetscErrorCode Name(const char pair[], const char what[], char name[], size_t size)
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, size, "%s/%s", pair, what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PackShares(Transfer transfer, const char pair[], Tables tables)
{
  const RowSet    *rows      = &transfer->rows;
  const PetscInt   n         = rows->offsets[transfer->n];
  const PetscReal *reference = transfer->dirichlet->data.reference;
  PetscReal       *packed;
  char             name[256];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n * N_SHARE, &packed));
  for (PetscInt i = 0; i < transfer->n; i++)
    for (PetscInt j = rows->offsets[i]; j < rows->offsets[i + 1]; j++) {
      PetscCall(PetscArraycpy(packed + N_SHARE * j, reference + 3 * i, 3));
      PetscCall(PetscArraycpy(packed + N_SHARE * j + 3, transfer->column_reference + 3 * rows->columns[j], 3));
      packed[N_SHARE * j + 6] = rows->shares[j].value;
      packed[N_SHARE * j + 7] = rows->shares[j].goal;
      PetscCall(PetscArraycpy(packed + N_SHARE * j + 8, rows->shares[j].slope, 3));
    }
  PetscCall(Name(pair, "shares", name, sizeof(name)));
  PetscCall(TablesAdd(tables, name, n, N_SHARE, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the nodes of both sides have, to tables or back; obstacles have none */
static PetscErrorCode VisitSides(Transfer transfer, const char pair[], Tables tables)
{
  static const char *const names[]     = {"rows", "partners"};
  const Surface            surfaces[2] = {transfer->dirichlet, transfer->neumann};
  StateList                lists[2];
  char                     name[256];

  PetscFunctionBegin;
  TransferListState(transfer, lists);
  for (PetscInt side = 0; side < 2 && surfaces[side]; side++) {
    PetscCall(Name(pair, names[side], name, sizeof(name)));
    PetscCall(StateListVisitNodes(&lists[side], 0, lists[side].n, 1, surfaces[side]->data.reference, name, tables));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where each node of the partner is: rank, number there, first displacement; a table beside the others, of this run */
static PetscErrorCode ShareOwners(Transfer transfer, Tables *owners)
{
  const SurfaceData *data = &transfer->neumann->data;
  PetscMPIInt        rank, size, mine, *counts, *offsets, total = 0;
  PetscReal         *packed, *all;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(transfer->comm, &rank));
  PetscCallMPI(MPI_Comm_size(transfer->comm, &size));
  PetscCall(PetscMalloc3(6 * data->n_owned, &packed, size, &counts, size, &offsets));
  for (PetscInt i = 0; i < data->n_owned; i++) {
    PetscCall(PetscArraycpy(packed + 6 * i, data->reference + 3 * i, 3));
    packed[6 * i + 3] = rank;
    packed[6 * i + 4] = (PetscReal)i;
    packed[6 * i + 5] = (PetscReal)data->dofs[i];
  }
  PetscCall(PetscMPIIntCast(6 * data->n_owned, &mine));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, counts, 1, MPI_INT, transfer->comm));
  for (PetscMPIInt r = 0; r < size; total += counts[r++]) offsets[r] = total;
  PetscCall(PetscMalloc1(total, &all));
  PetscCallMPI(MPI_Allgatherv(packed, mine, MPIU_REAL, all, counts, offsets, MPIU_REAL, transfer->comm));
  PetscCall(PetscFree3(packed, counts, offsets));
  PetscCall(TablesCreate(transfer->comm, PETSC_TRUE, owners));
  PetscCall(TablesShare(*owners, "owners", total / 6, 6, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The shares of the rows of this rank, and room for its rows */
static PetscErrorCode UnpackShares(Transfer transfer, const char pair[], Tables tables)
{
  const SurfaceData *data = &transfer->dirichlet->data;
  PetscInt           n, count = 0, n_owners;
  const PetscReal   *packed, *owner;
  Share             *shares;
  Tables             own, owners = NULL;
  PetscReal         *keys;
  char               name[256];

  PetscFunctionBegin;
  PetscCall(Name(pair, "shares", name, sizeof(name)));
  PetscCall(TablesGet(tables, name, N_SHARE, &n, &packed));
  PetscCall(PetscMalloc1(n, &shares));
  /* the rows of this rank by their keys, with those of other ranks left out */
  PetscCall(TablesCreate(PETSC_COMM_SELF, PETSC_TRUE, &own));
  PetscCall(PetscMalloc1(4 * transfer->n, &keys));
  for (PetscInt i = 0; i < transfer->n; i++) {
    PetscCall(PetscArraycpy(keys + 4 * i, data->reference + 3 * i, 3));
    keys[4 * i + 3] = (PetscReal)i;
  }
  PetscCall(TablesShare(own, "own", transfer->n, 4, keys));
  if (transfer->neumann) PetscCall(ShareOwners(transfer, &owners));
  for (PetscInt j = 0; j < n; j++) {
    PetscInt row, node;

    PetscCall(TablesLookFor(own, "own", packed + N_SHARE * j, &row));
    if (row < 0) continue;
    PetscCall(TablesFind(owners, "owners", packed + N_SHARE * j + 3, &node));
    PetscCall(TablesGet(owners, "owners", 6, &n_owners, &owner));
    owner += 6 * node;
    shares[count] = (Share){.row         = row,
                            .owner_rank  = (PetscMPIInt)owner[3],
                            .owner_index = (PetscInt)owner[4],
                            .dof         = (PetscInt)owner[5],
                            .value       = packed[N_SHARE * j + 6],
                            .goal        = packed[N_SHARE * j + 7]};
    PetscCall(PetscArraycpy(shares[count].slope, packed + N_SHARE * j + 8, 3));
    count++;
  }
  if (count > 1) PetscCall(PetscTimSort(count, shares, sizeof(Share), ShareCompare, NULL));
  PetscCall(RowSetDestroy(&transfer->rows));
  PetscCall(RowSetAllocate(transfer->dim, transfer->n, count, &transfer->rows));
  PetscCall(PetscArraycpy(transfer->rows.shares, shares, count));
  for (PetscInt j = 0; j < count; j++) transfer->rows.offsets[shares[j].row + 1]++;
  for (PetscInt i = 0; i < transfer->n; i++) transfer->rows.offsets[i + 1] += transfer->rows.offsets[i];
  PetscCall(PetscFree(shares));
  PetscCall(TablesDestroy(&own));
  PetscCall(TablesDestroy(&owners));
  PetscCall(TransferSetUpColumns(transfer, &transfer->rows, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The tables of a transfer, whose names begin with that of the pair; loading, of any number of ranks, after TransferVisitShared() */
PetscErrorCode TransferVisitTables(Transfer transfer, const char pair[], Tables tables)
{
  PetscFunctionBegin;
  if (TablesLoads(tables)) PetscCall(UnpackShares(transfer, pair, tables));
  else PetscCall(PackShares(transfer, pair, tables));
  PetscCall(VisitSides(transfer, pair, tables));
  if (TablesLoads(tables)) transfer->saved.builds = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
