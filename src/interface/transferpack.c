/* The state of a transfer as tables of its nodes, by which a run is continued on another number of ranks: what belongs to each node of the
   first side, what to each of the partner's, and the shares of the partner's nodes in the rows. */
#include "interfaceimpl.h"
#include "transfervisit.h"

#define N_SHARE 12 /* key of its row, position of the partner's node, weight, goal, slope and area */

static PetscErrorCode PackShares(Transfer transfer, Tables tables)
{
  const RowSet    *rows      = &transfer->rows;
  const PetscInt   n         = rows->offsets[transfer->n];
  const PetscReal *reference = transfer->dirichlet->data.reference;
  PetscReal       *packed;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n * N_SHARE, &packed));
  for (PetscInt i = 0; i < transfer->n; i++)
    for (PetscInt j = rows->offsets[i]; j < rows->offsets[i + 1]; j++) {
      PetscCall(PetscArraycpy(packed + N_SHARE * j, reference + 3 * i, 3));
      PetscCall(PetscArraycpy(packed + N_SHARE * j + 3, transfer->column_reference + 3 * rows->columns[j], 3));
      packed[N_SHARE * j + 6] = rows->shares[j].value;
      packed[N_SHARE * j + 7] = rows->shares[j].goal;
      PetscCall(PetscArraycpy(packed + N_SHARE * j + 8, rows->shares[j].slope, 3));
      packed[N_SHARE * j + 11] = rows->shares[j].area;
    }
  PetscCall(TablesAdd(tables, "shares", n, N_SHARE, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the nodes of both sides have, to tables or back; obstacles have none */
static PetscErrorCode VisitSides(Transfer transfer, Tables tables)
{
  static const char *const names[]     = {"rows", "partners"};
  const Surface            surfaces[2] = {transfer->dirichlet, transfer->neumann};
  StateList                lists[2];

  PetscFunctionBegin;
  TransferListState(transfer, lists);
  for (PetscInt side = 0; side < 2 && surfaces[side]; side++)
    PetscCall(StateListVisitNodes(&lists[side], 0, lists[side].n, 1, surfaces[side]->data.reference, names[side], tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where each node of a side is: rank, number there, first displacement; a table beside the others, of this run */
static PetscErrorCode ShareOwners(MPI_Comm comm, const SurfaceData *data, Tables *owners)
{
  PetscReal  *packed;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscMalloc1(6 * data->n_owned, &packed));
  for (PetscInt i = 0; i < data->n_owned; i++) {
    PetscCall(PetscArraycpy(packed + 6 * i, data->reference + 3 * i, 3));
    packed[6 * i + 3] = rank;
    packed[6 * i + 4] = (PetscReal)i;
    packed[6 * i + 5] = (PetscReal)data->dofs[i];
  }
  PetscCall(TablesCreate(comm, PETSC_TRUE, owners));
  PetscCall(TablesAdd(*owners, "owners", data->n_owned, 6, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The shares of the rows of this rank, and room for its rows */
static PetscErrorCode UnpackShares(Transfer transfer, Tables tables)
{
  PetscInt         n, count = 0, n_owners;
  const PetscReal *packed, *owner;
  Share           *shares;
  Tables           own, owners = NULL;

  PetscFunctionBegin;
  PetscCall(TablesGet(tables, "shares", N_SHARE, &n, &packed));
  PetscCall(PetscMalloc1(n, &shares));
  PetscCall(ShareOwners(PETSC_COMM_SELF, &transfer->dirichlet->data, &own)); /* rows of other ranks are left out */
  if (transfer->neumann) PetscCall(ShareOwners(transfer->comm, &transfer->neumann->data, &owners));
  for (PetscInt j = 0; j < n; j++) {
    PetscInt row, node;

    PetscCall(TablesLookFor(own, "owners", packed + N_SHARE * j, &row));
    if (row < 0) continue;
    PetscCall(TablesFind(owners, "owners", packed + N_SHARE * j + 3, &node));
    PetscCall(TablesGet(owners, "owners", 6, &n_owners, &owner));
    owner += 6 * node;
    shares[count] = (Share){.row         = row,
                            .owner_rank  = (PetscMPIInt)owner[3],
                            .owner_index = (PetscInt)owner[4],
                            .dof         = (PetscInt)owner[5],
                            .value       = packed[N_SHARE * j + 6],
                            .goal        = packed[N_SHARE * j + 7],
                            .area        = packed[N_SHARE * j + 11]};
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

/* The tables of a transfer, after TablesBegin() with the name of its pair; loading, of any number of ranks, after TransferVisitShared() */
PetscErrorCode TransferVisitTables(Transfer transfer, Tables tables)
{
  PetscFunctionBegin;
  if (TablesLoads(tables)) PetscCall(UnpackShares(transfer, tables));
  else PetscCall(PackShares(transfer, tables));
  PetscCall(VisitSides(transfer, tables));
  if (TablesLoads(tables)) transfer->saved.builds = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
