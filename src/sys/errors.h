/* How errors reach the user of the program. Private to src/sys. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode ImpaktReportError(MPI_Comm, int, const char *, const char *, PetscErrorCode, PetscErrorType, const char *,
                                              void *);
