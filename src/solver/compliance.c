#include "compliance.h"

struct _n_Compliance {
  MPI_Comm     comm;
  PetscMPIInt  size;
  PetscInt     local, begin, global, levels; /* rows of this rank, the first of them, rows of all ranks; matrices */
  PetscInt     n, room;                      /* known rows; how many there is room for */
  PetscInt    *place;                        /* per row of all ranks: its place among the known ones, or -1 */
  PetscInt    *rows;                         /* per place: its row */
  PetscInt    *known;                        /* per place: levels that its column has */
  PetscInt    *from;                         /* work space, per place */
  PetscScalar *matrices;                     /* levels of them, room x room by columns [m/N] */
  PetscInt     most_values;                  /* room for the following */
  PetscScalar *values;                       /* work space: a column */
};

/* For `local` rows of this rank from number `begin` on, of `global` rows in all */
PetscErrorCode ComplianceCreate(MPI_Comm comm, PetscInt local, PetscInt begin, PetscInt global, PetscInt levels, Compliance *compliance)
{
  Compliance c;

  PetscFunctionBegin;
  PetscCall(PetscNew(&c));
  c->comm   = comm;
  c->local  = local;
  c->begin  = begin;
  c->global = global;
  c->levels = levels;
  PetscCallMPI(MPI_Comm_size(comm, &c->size));
  PetscCall(PetscMalloc1(global, &c->place));
  for (PetscInt j = 0; j < global; j++) c->place[j] = -1;
  *compliance = c;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ComplianceDestroy(Compliance *compliance)
{
  Compliance c = *compliance;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(c->place));
  PetscCall(PetscFree3(c->rows, c->known, c->from));
  PetscCall(PetscFree(c->matrices));
  PetscCall(PetscFree(c->values));
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
  PetscInt      *rows, *known, *from;
  PetscScalar   *matrices;

  PetscFunctionBegin;
  if (c->n + more <= old) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc3(room, &rows, room, &known, room, &from));
  PetscCall(PetscMalloc1(c->levels * room * room, &matrices));
  PetscCall(PetscArraycpy(rows, c->rows, c->n));
  PetscCall(PetscArraycpy(known, c->known, c->n));
  for (PetscInt k = 0; k < c->levels; k++)
    for (PetscInt j = 0; j < c->n; j++) PetscCall(PetscArraycpy(matrices + (k * room + j) * room, c->matrices + (k * old + j) * old, c->n));
  PetscCall(PetscFree3(c->rows, c->known, c->from));
  PetscCall(PetscFree(c->matrices));
  c->rows     = rows;
  c->known    = known;
  c->from     = from;
  c->matrices = matrices;
  c->room     = room;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Values of this rank's rows, for some levels one after the other, on the known rows of every rank: to be added up over these */
void ComplianceSpread(Compliance c, PetscInt levels, const PetscScalar mine[], PetscScalar all[])
{
  for (PetscInt k = 0; k < levels; k++)
    for (PetscInt i = 0; i < c->n; i++) {
      const PetscInt local = c->rows[i] - c->begin;

      all[k * c->n + i] = local >= 0 && local < c->local ? mine[k * c->local + local] : 0;
    }
}

/* A place for a row that has none: all it does to others is unknown, and zero until it is */
static PetscErrorCode AddRow(Compliance c, PetscInt row)
{
  const PetscInt n = c->n;

  PetscFunctionBegin;
  PetscCall(ComplianceReserve(c, 1));
  for (PetscInt k = 0; k < c->levels; k++) {
    PetscScalar *matrix = c->matrices + k * c->room * c->room;

    for (PetscInt i = 0; i <= n; i++) matrix[n * c->room + i] = matrix[i * c->room + n] = 0;
  }
  c->place[row] = n;
  c->rows[n]    = row;
  c->known[n]   = 0;
  c->n          = n + 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacements of this rank's rows under a unit force on a row, at the first `levels` of the levels; collective */
PetscErrorCode ComplianceSetColumn(Compliance c, PetscInt row, PetscInt levels, const PetscScalar mine[])
{
  PetscInt j;

  PetscFunctionBegin;
  if (c->place[row] < 0) PetscCall(AddRow(c, row));
  j = c->place[row];
  if (levels * c->n > c->most_values) {
    c->most_values = PetscMax(levels * c->n, PetscMax(c->levels * c->room, 2 * c->most_values));
    PetscCall(PetscFree(c->values));
    PetscCall(PetscMalloc1(c->most_values, &c->values));
  }
  ComplianceSpread(c, levels, mine, c->values);
  if (c->size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, c->values, (PetscMPIInt)(levels * c->n), MPIU_SCALAR, MPIU_SUM, c->comm));
  for (PetscInt k = 0; k < levels; k++) {
    PetscScalar *matrix = c->matrices + k * c->room * c->room;

    for (PetscInt i = 0; i < c->n; i++) matrix[j * c->room + i] = matrix[i * c->room + j] = c->values[k * c->n + i];
  }
  c->known[j] = PetscMax(c->known[j], levels);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that have changed are not known any more; `changed`: for each row of all ranks */
PetscErrorCode ComplianceForget(Compliance c, const PetscMPIInt changed[])
{
  PetscInt n = 0, *from = c->from;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < c->n; j++) {
    if (changed[c->rows[j]]) c->place[c->rows[j]] = -1;
    else from[n++] = j;
  }
  for (PetscInt k = 0; k < c->levels; k++) {
    PetscScalar *matrix = c->matrices + k * c->room * c->room;

    for (PetscInt j = 0; j < n; j++)
      for (PetscInt i = 0; i < n; i++) matrix[j * c->room + i] = matrix[from[j] * c->room + from[i]];
  }
  for (PetscInt j = 0; j < n; j++) {
    c->rows[j]           = c->rows[from[j]];
    c->known[j]          = c->known[from[j]];
    c->place[c->rows[j]] = j;
  }
  c->n = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows that have become known last are not known any more, but for the first `n` */
PetscErrorCode ComplianceTruncate(Compliance c, PetscInt n)
{
  PetscFunctionBegin;
  if (c->n <= n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = n; j < c->n; j++) c->place[c->rows[j]] = -1;
  c->n = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Any of: how many rows are known, which, and the place of each row of all ranks among them, or -1 */
void ComplianceGetRows(Compliance c, PetscInt *n, const PetscInt *rows[], const PetscInt *place[])
{
  if (n) *n = c->n;
  if (rows) *rows = c->rows;
  if (place) *place = c->place;
}

/* Whether a row's column is known at all levels */
PetscBool ComplianceKnows(Compliance c, PetscInt row)
{
  return (PetscBool)(c->place[row] >= 0 && c->known[c->place[row]] == c->levels);
}

/* Known rows by known rows, with `leading` entries from one column to the next */
void ComplianceGetMatrix(Compliance c, PetscInt level, PetscInt *leading, const PetscScalar *matrix[])
{
  *leading = c->room;
  *matrix  = c->matrices + level * c->room * c->room;
}

/* State for a checkpoint: the known rows in their order, with their matrices */
PetscErrorCode ComplianceVisit(Compliance c, Checkpoint checkpoint)
{
  PetscInt sizes[3] = {c->n, c->room, c->levels};

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "compliance", 3, sizes));
  if (CheckpointLoads(checkpoint)) {
    PetscCheck(sizes[2] == c->levels, c->comm, PETSC_ERR_FILE_UNEXPECTED, "The checkpoint has another number of substeps");
    for (PetscInt j = 0; j < c->global; j++) c->place[j] = -1;
    c->n = 0;
    PetscCall(ComplianceReserve(c, sizes[1]));
    c->n = sizes[0];
  }
  PetscCall(CheckpointVisitInts(checkpoint, "compliance rows", c->n, c->rows));
  PetscCall(CheckpointVisitInts(checkpoint, "compliance known", c->n, c->known));
  for (PetscInt j = 0; j < c->n; j++) c->place[c->rows[j]] = j;
  for (PetscInt k = 0; k < c->levels; k++)
    for (PetscInt j = 0; j < c->n; j++)
      PetscCall(CheckpointVisitReals(checkpoint, "compliance column", c->n, c->matrices + (k * c->room + j) * c->room));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The known rows with their matrices as a table, for a checkpoint that is continued on another number of ranks: how many rows, which, the
   levels that each is known at, and the columns of each level. All ranks have the same. */
PetscErrorCode CompliancePack(Compliance c, const char name[], Tables tables)
{
  const PetscInt size = 1 + 2 * c->n + c->levels * c->n * c->n;
  PetscReal     *packed, *next;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(size, &packed));
  next    = packed;
  *next++ = (PetscReal)c->n;
  for (PetscInt j = 0; j < c->n; j++) *next++ = (PetscReal)c->rows[j];
  for (PetscInt j = 0; j < c->n; j++) *next++ = (PetscReal)c->known[j];
  for (PetscInt k = 0; k < c->levels; k++)
    for (PetscInt j = 0; j < c->n; j++)
      for (PetscInt i = 0; i < c->n; i++) *next++ = PetscRealPart(c->matrices[(k * c->room + j) * c->room + i]);
  PetscCall(TablesAddNumbers(tables, name, size, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* That table in place of what is known; `now`: for each row of the run that has written it, its number in this run */
PetscErrorCode ComplianceUnpack(Compliance c, const char name[], const PetscInt now[], Tables tables)
{
  const PetscReal *packed;
  PetscInt         size, n;

  PetscFunctionBegin;
  PetscCall(TablesGetNumbers(tables, name, &size, &packed));
  n = (PetscInt)*packed++;
  PetscCheck(n >= 0 && n <= c->global && size == 1 + 2 * n + c->levels * n * n, c->comm, PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has %" PetscInt_FMT " numbers in '%s' for %" PetscInt_FMT " rows: it is of another problem", size, name, n);
  for (PetscInt j = 0; j < c->global; j++) c->place[j] = -1;
  c->n = 0;
  PetscCall(ComplianceReserve(c, n));
  c->n = n;
  for (PetscInt j = 0; j < n; j++) {
    const PetscReal row = *packed++;

    PetscCheck(row >= 0 && row < c->global, c->comm, PETSC_ERR_FILE_UNEXPECTED, "The checkpoint has a row %g of %" PetscInt_FMT " in '%s'",
               (double)row, c->global, name);
    c->rows[j]           = now[(PetscInt)row];
    c->place[c->rows[j]] = j;
  }
  for (PetscInt j = 0; j < n; j++) c->known[j] = (PetscInt)*packed++;
  for (PetscInt k = 0; k < c->levels; k++)
    for (PetscInt j = 0; j < n; j++)
      for (PetscInt i = 0; i < n; i++) c->matrices[(k * c->room + j) * c->room + i] = *packed++;
  PetscFunctionReturn(PETSC_SUCCESS);
}
