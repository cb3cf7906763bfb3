/* Central differences: what they need beside the TS. Private to src/body/integrator. */
#pragma once
#include <body/layout/bodyimpl.h>

typedef struct _n_LayerBalance *LayerBalance;
typedef struct _n_LayerRows    *LayerRows;
typedef struct _n_FrontStep    *FrontStep;

PETSC_INTERN PetscErrorCode LayerRowsCreate(Body, IS, LayerRows *);
PETSC_INTERN PetscErrorCode LayerRowsUpdate(LayerRows, Body);
PETSC_INTERN Mat            LayerRowsGetMatrix(LayerRows);
PETSC_INTERN PetscErrorCode LayerRowsDestroy(LayerRows *);

PETSC_INTERN PetscErrorCode LayerBalanceCreate(Body, LayerBalance *);
PETSC_INTERN PetscErrorCode LayerBalanceDestroy(LayerBalance *);
PETSC_INTERN PetscErrorCode LayerBalanceSetRows(LayerBalance, Body, const PetscMPIInt[]);
PETSC_INTERN PetscErrorCode LayerBalanceSolve(LayerBalance, Body, PetscReal, PetscReal, Vec, Vec);
PETSC_INTERN PetscErrorCode LayerBalanceGetForce(LayerBalance, Body, Vec, Vec);
PETSC_INTERN PetscErrorCode LayerBalanceSave(LayerBalance, Body, BodySlot);
PETSC_INTERN PetscErrorCode LayerBalanceRestore(LayerBalance, Body, BodySlot);
PETSC_INTERN PetscErrorCode LayerBalanceAgree(LayerBalance, Body);
PETSC_INTERN PetscErrorCode LayerBalanceVisit(LayerBalance, Body, Checkpoint);
PETSC_INTERN PetscErrorCode LayerBalanceCopyPoint(LayerBalance, Body, PetscBool, Vec, PetscReal[2]);
PETSC_INTERN PetscErrorCode FrontStepDestroy(FrontStep *);
PETSC_INTERN PetscErrorCode FrontStepMake(FrontStep *, Body);
PETSC_INTERN PetscErrorCode FrontStepNote(FrontStep, Body, Vec, Vec);
PETSC_INTERN PetscBool      BodyHasOutsideForce(Body, PetscBool);
PETSC_INTERN PetscErrorCode BodyComputeOutsideForce(Body, PetscReal, PetscReal, PetscBool, Vec, Vec);
