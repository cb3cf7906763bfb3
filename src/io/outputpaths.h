/* Which files the paths of outputs stand for. Private to src/io. */
#pragma once
#include <checkpoint/checkpoint.h>

PETSC_INTERN PetscErrorCode OutputPathResolve(const char[], size_t, char[]);
PETSC_INTERN PetscErrorCode OutputPathDrop(char[], PetscBool *);
PETSC_INTERN PetscErrorCode OutputPathsCheck(MPI_Comm, PetscInt, const char *const[], const char *const[]);
PETSC_INTERN PetscErrorCode OutputPathVisit(const char[], const char[], Checkpoint, PetscBool *);
