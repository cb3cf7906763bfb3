/* Files that a run writes: checked before computing, and replaced as a whole. */
#pragma once
#include <petscsys.h>

/* Writes a file under the name it is given, for OutputFileWrite() */
typedef PetscErrorCode OutputWriteFn(const char part[], void *ctx);

PETSC_INTERN PetscErrorCode OutputFileCheck(MPI_Comm, const char[], const char[]);
PETSC_INTERN PetscErrorCode OutputFileGetPart(const char[], size_t, char[]);
PETSC_INTERN PetscErrorCode OutputFileWrite(const char[], OutputWriteFn *, void *, int *);
PETSC_INTERN PetscErrorCode OutputFilePlace(const char[], const char[], int *, PetscBool *);
PETSC_INTERN PetscErrorCode OutputFileHold(const char[], int *);
PETSC_INTERN PetscErrorCode OutputFileMakeParents(const char[]);
PETSC_INTERN PetscErrorCode OutputFileRelease(int *);
PETSC_INTERN PetscErrorCode OutputFileCopy(int, const char[]);
PETSC_INTERN PetscErrorCode OutputFileRestore(int, const char[]);
PETSC_INTERN PetscErrorCode OutputFileSync(int, const char[]);
PETSC_INTERN PetscErrorCode OutputFileSyncFolder(const char[]);
PETSC_INTERN PetscErrorCode OutputFileShareError(MPI_Comm, PetscErrorCode, const char[], const char[], const char[]);
