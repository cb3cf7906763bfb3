#include "compliance.h"

/* A column that ranks have still to add up: the place of its row, at how many levels, on how many rows */
typedef struct {
  PetscInt place, levels, n;
} Waiting;

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
  PetscScalar *ramp;                         /* room x room; made when asked for */
  PetscBool    ramp_valid;
  /* columns that have been set since ComplianceWait(), one after the other, level by level */
  PetscBool    waits;
  PetscInt     n_waiting, most_waiting; /* how many; how many there is room for */
  Waiting     *waiting;
  PetscInt     n_values, most_values;
  PetscScalar *values;
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
  PetscCall(PetscFree2(c->matrices, c->ramp));
  PetscCall(PetscFree(c->waiting));
  PetscCall(PetscFree(c->values));
  PetscCall(PetscFree(*compliance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All that is known; the room for it stays */
void ComplianceClear(Compliance c)
{
  for (PetscInt i = 0; i < c->n; i++) c->place[c->rows[i]] = -1;
  c->n = c->n_waiting = c->n_values = 0;
  c->ramp_valid                     = PETSC_FALSE;
}

/* Room for `more` rows beside those that are known, so that these need not allocate one by one */
PetscErrorCode ComplianceReserve(Compliance c, PetscInt more)
{
  const PetscInt old = c->room, room = PetscMin(c->global, PetscMax(c->n + more, 2 * old));
  PetscInt      *rows, *known, *from;
  PetscScalar   *matrices, *ramp;

  PetscFunctionBegin;
  if (c->n + more <= old) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc3(room, &rows, room, &known, room, &from));
  PetscCall(PetscMalloc2(c->levels * room * room, &matrices, room * room, &ramp));
  PetscCall(PetscArraycpy(rows, c->rows, c->n));
  PetscCall(PetscArraycpy(known, c->known, c->n));
  for (PetscInt k = 0; k < c->levels; k++)
    for (PetscInt j = 0; j < c->n; j++) PetscCall(PetscArraycpy(matrices + (k * room + j) * room, c->matrices + (k * old + j) * old, c->n));
  PetscCall(PetscFree3(c->rows, c->known, c->from));
  PetscCall(PetscFree2(c->matrices, c->ramp));
  c->rows       = rows;
  c->known      = known;
  c->from       = from;
  c->matrices   = matrices;
  c->ramp       = ramp;
  c->room       = room;
  c->ramp_valid = PETSC_FALSE;
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

/* Room for another column that waits */
static PetscErrorCode MakeWaitingRoom(Compliance c, PetscInt size)
{
  PetscFunctionBegin;
  if (c->n_waiting == c->most_waiting) {
    c->most_waiting = PetscMax(c->room, 2 * c->most_waiting);
    PetscCall(PetscRealloc(c->most_waiting * sizeof(*c->waiting), &c->waiting));
  }
  if (c->n_values + size > c->most_values) {
    c->most_values = PetscMax(c->n_values + size, PetscMax(c->levels * c->room, 2 * c->most_values));
    PetscCall(PetscRealloc(c->most_values * sizeof(*c->values), &c->values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns that are set from now on wait until ranks have added them up, which callers do for many bodies at once: each with the values of
   the rank's own rows until then */
void ComplianceWait(Compliance c)
{
  c->waits = PETSC_TRUE;
}

/* What is to be added up over all ranks, in place */
void ComplianceGetWaiting(Compliance c, PetscInt *n, PetscScalar *values[])
{
  *n      = c->size > 1 ? c->n_values : 0;
  *values = c->values;
}

/* The columns that have waited, of all ranks */
void ComplianceTakeWaiting(Compliance c)
{
  const PetscScalar *value = c->values;

  for (PetscInt w = 0; w < c->n_waiting; w++) {
    const Waiting *column = &c->waiting[w];
    const PetscInt j      = column->place;

    for (PetscInt k = 0; k < column->levels; k++) {
      PetscScalar *matrix = c->matrices + k * c->room * c->room;

      for (PetscInt i = 0; i < column->n; i++) matrix[j * c->room + i] = matrix[i * c->room + j] = *value++;
    }
  }
  c->n_waiting = c->n_values = 0;
  c->waits                   = PETSC_FALSE;
}

/* Room for a column of some levels, the last one that waits; `values`: where they belong, of the known rows of every rank */
static PetscErrorCode BeginColumn(Compliance c, PetscInt row, PetscInt levels, PetscScalar *values[])
{
  PetscInt j;

  PetscFunctionBegin;
  if (c->place[row] < 0) PetscCall(AddRow(c, row));
  j = c->place[row];
  PetscCall(MakeWaitingRoom(c, levels * c->n));
  *values                    = c->values + c->n_values;
  c->waiting[c->n_waiting++] = (Waiting){.place = j, .levels = levels, .n = c->n};
  c->n_values += levels * c->n;
  c->known[j]   = PetscMax(c->known[j], levels);
  c->ramp_valid = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The values are there: unless they are to wait, ranks add them up */
static PetscErrorCode EndColumn(Compliance c)
{
  PetscFunctionBegin;
  if (c->waits) PetscFunctionReturn(PETSC_SUCCESS);
  if (c->size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, c->values, (PetscMPIInt)c->n_values, MPIU_SCALAR, MPIU_SUM, c->comm));
  ComplianceTakeWaiting(c);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacements of this rank's rows under a unit force on a row, at the first `levels` of the levels; collective */
PetscErrorCode ComplianceSetColumn(Compliance c, PetscInt row, PetscInt levels, const PetscScalar mine[])
{
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(BeginColumn(c, row, levels, &values));
  ComplianceSpread(c, levels, mine, values);
  PetscCall(EndColumn(c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same, at the first level, of the rows of all ranks from one that has found them; NULL: this is another. Collective. */
PetscErrorCode ComplianceSetWholeColumn(Compliance c, PetscInt row, const PetscScalar all[])
{
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(BeginColumn(c, row, 1, &values));
  for (PetscInt i = 0; i < c->n; i++) values[i] = all ? all[c->rows[i]] : 0;
  PetscCall(EndColumn(c));
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
  c->n          = n;
  c->ramp_valid = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows that have become known last are not known any more, but for the first `n` */
PetscErrorCode ComplianceTruncate(Compliance c, PetscInt n)
{
  PetscFunctionBegin;
  if (c->n <= n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = n; j < c->n; j++) c->place[c->rows[j]] = -1;
  c->n          = n;
  c->ramp_valid = PETSC_FALSE;
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

/* The same at the end of the last level for forces that rise linearly over all of them: the sum of W_{L - l} l / L for l = 1 ... L */
PetscErrorCode ComplianceGetRamp(Compliance c, PetscInt *leading, const PetscScalar *matrix[])
{
  PetscFunctionBegin;
  if (c->levels == 1) {
    ComplianceGetMatrix(c, 0, leading, matrix);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt j = 0; j < c->n && !c->ramp_valid; j++)
    for (PetscInt i = 0; i < c->n; i++) {
      PetscScalar sum = 0;

      for (PetscInt l = 1; l <= c->levels; l++)
        sum += (PetscReal)l / c->levels * c->matrices[((c->levels - l) * c->room + j) * c->room + i];
      c->ramp[j * c->room + i] = sum;
    }
  c->ramp_valid = PETSC_TRUE;
  *leading      = c->room;
  *matrix       = c->ramp;
  PetscFunctionReturn(PETSC_SUCCESS);
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
    c->n          = sizes[0];
    c->ramp_valid = PETSC_FALSE;
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
  c->n          = n;
  c->ramp_valid = PETSC_FALSE;
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
