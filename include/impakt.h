/* Everything Impakt offers as a library. */
#pragma once
#include <impakt/body.h>
#include <impakt/contact.h>
#include <impakt/controller.h>
#include <impakt/element.h>
#include <impakt/exact.h>
#include <impakt/expression.h>
#include <impakt/io.h>
#include <impakt/material.h>
#include <impakt/stepreason.h>
#include <impakt/tssecondorder.h>
#include <impakt/version.h>

PETSC_EXTERN PetscErrorCode ImpaktInitialize(int *, char ***);
PETSC_EXTERN PetscErrorCode ImpaktInitialized(PetscBool *);
PETSC_EXTERN PetscErrorCode ImpaktFinalize(void);
PETSC_EXTERN PetscErrorCode ImpaktGetVersion(char[], size_t);
PETSC_EXTERN PetscErrorCode ImpaktCheckOptions(PetscInt, const char *const[]);
PETSC_EXTERN PetscErrorCode ImpaktPrintOptions(void);
PETSC_EXTERN int            ImpaktExit(PetscErrorCode);
