/* Everything Impakt offers as a library. */
#pragma once
#include <body.h>
#include <contact.h>
#include <controller.h>
#include <exact.h>
#include <expression.h>
#include <io.h>
#include <material.h>
#include <mesh.h>
#include <surface.h>
#include <trace.h>
#include <transfer.h>
#include <tssecondorder.h>

#define IMPAKT_VERSION "0.1.0"

PETSC_EXTERN PetscErrorCode ImpaktInitialize(int *, char ***);
PETSC_EXTERN PetscErrorCode ImpaktFinalize(void);
PETSC_EXTERN PetscErrorCode ImpaktRegisterAll(void);
PETSC_EXTERN PetscErrorCode ImpaktCheckOptions(PetscInt, const char *const[]);
PETSC_EXTERN PetscErrorCode ImpaktPrintOptions(void);
PETSC_EXTERN int            ImpaktExit(PetscErrorCode);
