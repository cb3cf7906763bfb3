/* What stands on the command line, before PETSc sees it. For main.c alone. */
#pragma once
#include <petscsys.h>

typedef struct {
  int    n;
  char **words;            /* those of the command line, with -options_file before each file that stands alone; ends with NULL */
  char   files_option[16]; /* -options_file */
  char   error[1024];      /* what is wrong with them, else empty */
} CommandLine;

PETSC_INTERN PetscErrorCode CommandLineCreate(int, char **, CommandLine *);
PETSC_INTERN PetscErrorCode CommandLineCheckFiles(CommandLine *);
PETSC_INTERN PetscErrorCode CommandLineInsert(const CommandLine *);
PETSC_INTERN void           CommandLineDestroy(CommandLine *);
