#include "compliance.h"

struct _n_Compliance {
  MPI_Comm     comm;
  PetscMPIInt  size;
  PetscInt     local, begin, global; /* rows of this rank, the first of them, rows of all ranks */
  PetscInt     n, room;              /* known rows; how many there is room for */
  PetscInt    *place;                /* per row of all ranks: its place among the known ones, or -1 */
  PetscInt    *rows;                 /* per place: its row */
  PetscScalar *matrix;               /* room x room by columns [m/N] */
  PetscScalar *values;               /* work space: a column */
};

/* A unit force: a vector that is 1 at one of its entries, by its number on all ranks, and else 0. Collective. */
PetscErrorCode ComplianceSetUnit(Vec vec, PetscInt entry)
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(vec));
  PetscCall(VecGetOwnershipRange(vec, &begin, &end));
  if (entry >= begin && entry < end) PetscCall(VecSetValue(vec, entry, 1, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(vec));
  PetscCall(VecAssemblyEnd(vec));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For rows laid out as a vector; none is known yet */
PetscErrorCode ComplianceCreate(Vec layout, Compliance *compliance)
{
  Compliance c;

  PetscFunctionBegin;
  PetscCall(PetscNew(&c));
  c->comm = PetscObjectComm((PetscObject)layout);
  PetscCall(VecGetLocalSize(layout, &c->local));
  PetscCall(VecGetOwnershipRange(layout, &c->begin, NULL));
  PetscCall(VecGetSize(layout, &c->global));
  PetscCallMPI(MPI_Comm_size(c->comm, &c->size));
  PetscCall(PetscMalloc1(c->global, &c->place));
  for (PetscInt j = 0; j < c->global; j++) c->place[j] = -1;
  *compliance = c;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ComplianceDestroy(Compliance *compliance)
{
  Compliance c = *compliance;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(c->place));
  PetscCall(PetscFree3(c->rows, c->values, c->matrix));
  PetscCall(PetscFree(*compliance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All that is known; the room for it stays */
void ComplianceClear(Compliance c)
{
  for (PetscInt i = 0; i < c->n; i++) c->place[c->rows[i]] = -1;
  c->n = 0;
}

/* Room for `more` rows beside those that are known, so that these need not allocate one by one */
PetscErrorCode ComplianceReserve(Compliance c, PetscInt more)
{
  const PetscInt old = c->room, room = PetscMin(c->global, PetscMax(c->n + more, 2 * old));
  PetscInt      *rows;
  PetscScalar   *values, *matrix;

  PetscFunctionBegin;
  if (c->n + more <= old) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc3(room, &rows, room, &values, room * room, &matrix));
  PetscCall(PetscArraycpy(rows, c->rows, c->n));
  for (PetscInt j = 0; j < c->n; j++) PetscCall(PetscArraycpy(matrix + j * room, c->matrix + j * old, c->n));
  PetscCall(PetscFree3(c->rows, c->values, c->matrix));
  c->rows   = rows;
  c->values = values;
  c->matrix = matrix;
  c->room   = room;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacements of this rank's rows under a unit force on a row; collective */
PetscErrorCode ComplianceSetColumn(Compliance c, PetscInt row, const PetscScalar mine[])
{
  PetscInt j;

  PetscFunctionBegin;
  if (c->place[row] < 0) {
    PetscCall(ComplianceReserve(c, 1));
    c->place[row]   = c->n;
    c->rows[c->n++] = row;
  }
  j = c->place[row];
  for (PetscInt i = 0; i < c->n; i++) {
    const PetscInt local = c->rows[i] - c->begin;

    c->values[i] = local >= 0 && local < c->local ? mine[local] : 0;
  }
  if (c->size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, c->values, (PetscMPIInt)c->n, MPIU_SCALAR, MPIU_SUM, c->comm));
  for (PetscInt i = 0; i < c->n; i++) c->matrix[j * c->room + i] = c->matrix[i * c->room + j] = c->values[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Any of: how many rows are known, which, and the place of each row of all ranks among them, or -1 */
void ComplianceGetRows(Compliance c, PetscInt *n, const PetscInt *rows[], const PetscInt *place[])
{
  if (n) *n = c->n;
  if (rows) *rows = c->rows;
  if (place) *place = c->place;
}

PetscBool ComplianceKnows(Compliance c, PetscInt row)
{
  return (PetscBool)(c->place[row] >= 0);
}

/* Known rows by known rows, with `leading` entries from one column to the next */
void ComplianceGetMatrix(Compliance c, PetscInt *leading, const PetscScalar *matrix[])
{
  *leading = c->room;
  *matrix  = c->matrix;
}

/* State for a checkpoint: the known rows in their order, with their matrix */
PetscErrorCode ComplianceVisit(Compliance c, Checkpoint checkpoint)
{
  PetscInt sizes[2] = {c->n, c->room};

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "compliance", 2, sizes));
  if (CheckpointLoads(checkpoint)) {
    ComplianceClear(c);
    PetscCall(ComplianceReserve(c, sizes[1]));
    c->n = sizes[0];
  }
  PetscCall(CheckpointVisitInts(checkpoint, "compliance rows", c->n, c->rows));
  for (PetscInt j = 0; j < c->n; j++) c->place[c->rows[j]] = j;
  for (PetscInt j = 0; j < c->n; j++) PetscCall(CheckpointVisitReals(checkpoint, "compliance column", c->n, c->matrix + j * c->room));
  PetscFunctionReturn(PETSC_SUCCESS);
}
