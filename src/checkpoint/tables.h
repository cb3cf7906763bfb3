/* Numbers of the nodes of all ranks by their places in the mesh: what a run is continued from on another number of ranks. */
#pragma once
#include <petscsys.h>

typedef struct _n_Tables *Tables;

#define TABLES_KEY 3 /* the first columns of each row: the reference position of a node, zeros beyond the dimension of space [m] */

PETSC_INTERN PetscErrorCode TablesCreate(MPI_Comm, PetscBool, Tables *);
PETSC_INTERN PetscErrorCode TablesDestroy(Tables *);
PETSC_INTERN PetscBool      TablesLoads(Tables);
PETSC_INTERN PetscErrorCode TablesBegin(Tables, const char[]);
PETSC_INTERN PetscErrorCode TablesAdd(Tables, const char[], PetscInt, PetscInt, const PetscReal[]);
PETSC_INTERN PetscErrorCode TablesVisitNumbers(Tables, const char[], PetscInt, PetscReal[]);
PETSC_INTERN PetscErrorCode TablesShare(Tables, const char[], PetscInt, PetscInt, PetscReal[]);
PETSC_INTERN void           TablesGetNumber(Tables, PetscInt *);
PETSC_INTERN PetscInt       TablesGetWidth(Tables, const char[]);
PETSC_INTERN PetscErrorCode TablesGetTable(Tables, PetscInt, const char *[], PetscInt *, PetscInt *, const PetscReal *[]);
PETSC_INTERN PetscErrorCode TablesGet(Tables, const char[], PetscInt, PetscInt *, const PetscReal *[]);
PETSC_INTERN PetscErrorCode TablesFind(Tables, const char[], const PetscReal[], PetscInt *);
PETSC_INTERN PetscErrorCode TablesLookFor(Tables, const char[], const PetscReal[], PetscInt *);

/* Copies numbers to a packed row or back, and goes on behind them */
static inline void TablesCopyReals(PetscBool back, PetscInt n, PetscReal own[], PetscReal **packed)
{
  for (PetscInt i = 0; i < n; i++) *(back ? &own[i] : &(*packed)[i]) = back ? (*packed)[i] : own[i];
  *packed += n;
}

static inline void TablesCopyBool(PetscBool back, PetscBool *own, PetscReal **packed)
{
  if (back) *own = (PetscBool)(**packed != 0);
  else **packed = *own ? 1 : 0;
  ++*packed;
}
