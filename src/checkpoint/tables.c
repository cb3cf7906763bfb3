/* Tables of numbers, a row for each node. While they are written the first rank has them; read, every rank has all of them. */
#include "tables.h"
#include <string.h>

#define MOST_NAME 512

typedef struct {
  char       name[MOST_NAME];
  PetscInt   n, width;
  PetscReal *values;
  PetscInt  *order; /* of the rows by their keys; NULL until one is looked for */
} Table;

struct _n_Tables {
  MPI_Comm  comm;
  PetscBool loads;
  char      of[MOST_NAME]; /* with which names begin, for all but TablesShare() and TablesGetTable() */
  PetscInt  n;
  Table    *tables;
};

/* TablesCreate - none yet; `loads`: visits overwrite what they visit with what TablesShare() will have given, else they add tables */
PetscErrorCode TablesCreate(MPI_Comm comm, PetscBool loads, Tables *tables)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(tables));
  (*tables)->comm  = comm;
  (*tables)->loads = loads;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TablesDestroy(Tables *tables)
{
  PetscFunctionBegin;
  if (!*tables) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < (*tables)->n; i++) {
    PetscCall(PetscFree((*tables)->tables[i].values));
    PetscCall(PetscFree((*tables)->tables[i].order));
  }
  PetscCall(PetscFree((*tables)->tables));
  PetscCall(PetscFree(*tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool TablesLoads(Tables tables)
{
  return tables->loads;
}

/* TablesBegin - names are those of tables of this from now on: `nodes` is `block/nodes` */
PetscErrorCode TablesBegin(Tables tables, const char of[])
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(tables->of, sizeof(tables->of), "%s/", of));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* TablesShare - takes over a table that every rank has; values from PetscMalloc() */
PetscErrorCode TablesShare(Tables tables, const char name[], PetscInt n, PetscInt width, PetscReal values[])
{
  Table *table;

  PetscFunctionBegin;
  PetscCall(PetscRealloc((size_t)(tables->n + 1) * sizeof(Table), &tables->tables));
  table = &tables->tables[tables->n++];
  PetscCall(PetscMemzero(table, sizeof(*table)));
  PetscCall(PetscStrncpy(table->name, name, sizeof(table->name)));
  table->n      = n;
  table->width  = width;
  table->values = values;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* TablesAdd - gathers the rows of all ranks on the first one, or, where visits load, on each; Collective */
PetscErrorCode TablesAdd(Tables tables, const char name[], PetscInt n, PetscInt width, const PetscReal values[])
{
  PetscMPIInt rank, size, mine, *counts, *offsets, total = 0;
  PetscReal  *all = NULL;
  char        full[MOST_NAME];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(tables->comm, &rank));
  PetscCallMPI(MPI_Comm_size(tables->comm, &size));
  PetscCall(PetscMPIIntCast(n * width, &mine));
  PetscCall(PetscMalloc2(size, &counts, size, &offsets));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, counts, 1, MPI_INT, tables->comm));
  for (PetscMPIInt r = 0; r < size && (tables->loads || !rank); total += counts[r++]) offsets[r] = total;
  PetscCall(PetscMalloc1(total, &all));
  if (tables->loads) PetscCallMPI(MPI_Allgatherv(values, mine, MPIU_REAL, all, counts, offsets, MPIU_REAL, tables->comm));
  else PetscCallMPI(MPI_Gatherv(values, mine, MPIU_REAL, all, counts, offsets, MPIU_REAL, 0, tables->comm));
  PetscCall(PetscFree2(counts, offsets));
  PetscCall(PetscSNPrintf(full, sizeof(full), "%s%s", tables->of, name));
  PetscCall(TablesShare(tables, full, total / width, width, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void TablesGetNumber(Tables tables, PetscInt *n)
{
  *n = tables->n;
}

/* TablesGetTable - one of them; all pointers are owned by the tables */
PetscErrorCode TablesGetTable(Tables tables, PetscInt i, const char *name[], PetscInt *n, PetscInt *width, const PetscReal *values[])
{
  const Table *table = &tables->tables[i];

  PetscFunctionBegin;
  *name   = table->name;
  *n      = table->n;
  *width  = table->width;
  *values = table->values;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static Table *LookForTable(Tables tables, const char name[])
{
  const size_t begin = strlen(tables->of);

  for (PetscInt i = 0; i < tables->n; i++)
    if (!strncmp(tables->tables[i].name, tables->of, begin) && !strcmp(tables->tables[i].name + begin, name)) return &tables->tables[i];
  return NULL;
}

/* TablesGetWidth - how many columns the table of a name has; 0: there is none */
PetscInt TablesGetWidth(Tables tables, const char name[])
{
  const Table *table = LookForTable(tables, name);

  return table ? table->width : 0;
}

static PetscErrorCode FindTable(Tables tables, const char name[], Table **table)
{
  PetscFunctionBegin;
  *table = LookForTable(tables, name);
  PetscCheck(*table, tables->comm, PETSC_ERR_FILE_UNEXPECTED, "The checkpoint has no table '%s%s': it is of another problem", tables->of,
             name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* TablesGet - the table of a name, with so many columns */
PetscErrorCode TablesGet(Tables tables, const char name[], PetscInt width, PetscInt *n, const PetscReal *values[])
{
  Table *table;

  PetscFunctionBegin;
  PetscCall(FindTable(tables, name, &table));
  PetscCheck(table->width == width, tables->comm, PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has %" PetscInt_FMT " numbers for each row of '%s' where this run has %" PetscInt_FMT
             ": it is of another problem",
             table->width, table->name, width);
  *n      = table->n;
  *values = table->values;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* TablesVisitNumbers - a table of one row, of what all ranks have alike; Collective */
PetscErrorCode TablesVisitNumbers(Tables tables, const char name[], PetscInt n, PetscReal values[])
{
  const PetscReal *there;
  PetscInt         lines;
  PetscMPIInt      rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(tables->comm, &rank));
  if (!tables->loads) {
    PetscCall(TablesAdd(tables, name, rank ? 0 : 1, n, values));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(TablesGet(tables, name, n, &lines, &there));
  PetscCheck(lines == 1, tables->comm, PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has %" PetscInt_FMT " rows in '%s%s' where there is to be one: it is of another problem", lines, tables->of,
             name);
  PetscCall(PetscArraycpy(values, there, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int CompareKeys(const PetscReal a[], const PetscReal b[])
{
  for (PetscInt d = 0; d < TABLES_KEY; d++)
    if (a[d] != b[d]) return a[d] < b[d] ? -1 : 1;
  return 0;
}

static int CompareRows(const void *a, const void *b, void *context)
{
  const Table *table = (const Table *)context;

  return CompareKeys(table->values + *(const PetscInt *)a * table->width, table->values + *(const PetscInt *)b * table->width);
}

/* TablesLookFor - the row of the node at a place, which must be the only one there; -1 if there is none */
PetscErrorCode TablesLookFor(Tables tables, const char name[], const PetscReal key[], PetscInt *row)
{
  PetscInt low = 0, high;
  Table   *table;

  PetscFunctionBegin;
  PetscCall(FindTable(tables, name, &table));
  high = table->n;
  if (!table->order) {
    PetscCall(PetscMalloc1(table->n, &table->order));
    for (PetscInt i = 0; i < table->n; i++) table->order[i] = i;
    if (table->n > 1) PetscCall(PetscTimSort(table->n, table->order, sizeof(PetscInt), CompareRows, table));
    for (PetscInt i = 1; i < table->n; i++)
      PetscCheck(CompareRows(table->order + i - 1, table->order + i, table), tables->comm, PETSC_ERR_SUP,
                 "Two nodes of '%s' lie at one place, and cannot be told from each other: the run can be continued on as many ranks as "
                 "before alone",
                 table->name);
  }
  while (high - low > 1) {
    const PetscInt middle = (low + high) / 2;

    if (CompareKeys(table->values + table->order[middle] * table->width, key) <= 0) low = middle;
    else high = middle;
  }
  *row = table->n && !CompareKeys(table->values + table->order[low] * table->width, key) ? table->order[low] : -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* TablesFind - the row of the node at a place, which must be there */
PetscErrorCode TablesFind(Tables tables, const char name[], const PetscReal key[], PetscInt *row)
{
  PetscFunctionBegin;
  PetscCall(TablesLookFor(tables, name, key, row));
  PetscCheck(*row >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has no node of '%s%s' at (%.9g, %.9g, %.9g) m: it is of another mesh", tables->of, name, (double)key[0],
             (double)key[1], (double)key[2]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
