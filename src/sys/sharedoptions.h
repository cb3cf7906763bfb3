/* Options that several bodies share: -all_density, -material_steel_density. Private to src. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscBool      OptionsIsShared(const char[]);
PETSC_INTERN PetscErrorCode OptionsCheckName(MPI_Comm, const char[], const char[]);
PETSC_INTERN PetscErrorCode OptionsExpandShared(MPI_Comm, PetscInt, char *const[]);
PETSC_INTERN PetscErrorCode OptionsFindShared(const char[], const char[], char[], size_t);
PETSC_INTERN PetscErrorCode OptionsFindMaterial(const char[], char[], size_t);
PETSC_INTERN PetscErrorCode OptionsSharedIsUnread(const char[], PetscInt, const char *const[], PetscBool *);
PETSC_INTERN PetscErrorCode OptionsMaterialIsNamed(const char[], PetscInt, const char *const[], PetscBool *);
PETSC_INTERN PetscErrorCode OptionsExplainShared(const char[], char[], size_t);
