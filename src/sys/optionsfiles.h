/* Options files, looked at apart from PETSc: whether it can read them, and in which line an option stands. Private to src. */
#pragma once
#include <petscsys.h>
#include <sys/stat.h>

/* An option without its dash, its value or NULL, where it stands, and what belongs to the visitor */
typedef PetscErrorCode (*OptionsVisitor)(const char[], const char[], const char[], void *);

PETSC_INTERN PetscBool      OptionsIsUnclosed(const char[]);
PETSC_INTERN PetscErrorCode OptionsFileCheck(const char[], char[], size_t);
PETSC_INTERN PetscErrorCode OptionsFilesInclude(const struct stat *, PetscBool *);
PETSC_INTERN PetscErrorCode OptionsFindOrigin(const char[], char[], size_t);
PETSC_INTERN PetscErrorCode OptionsVisit(OptionsVisitor, void *);
