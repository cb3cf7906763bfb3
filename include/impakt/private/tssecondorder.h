/* What is needed to drive time integrators for second-order systems, PETSc's own TSALPHA2 among them, in sweeps. */
#pragma once
#include <impakt/tssecondorder.h>

typedef PetscErrorCode TSCentralDifferenceFn(TS, PetscReal, Vec, Vec, Vec, void *);
typedef PetscErrorCode TSAlpha2StepFn(TS);
typedef PetscErrorCode TSRigidFn(TS, PetscReal, PetscReal, Vec, Vec, void *);

PETSC_EXTERN PetscErrorCode TSCentralDifferenceSetAcceleration(TS, TSCentralDifferenceFn *, Vec, void *);
PETSC_EXTERN PetscErrorCode TSCentralDifferenceLeaveVelocity(TS);
PETSC_EXTERN PetscErrorCode TSRigidSetAdvance(TS, TSRigidFn *, void *);
PETSC_EXTERN PetscErrorCode TSSecondOrderRegisterAll(void);
PETSC_EXTERN PetscErrorCode TSSecondOrderSetState(TS, PetscReal, PetscReal, PetscInt);
PETSC_EXTERN PetscErrorCode TSAlpha2SetStep(TS, TSAlpha2StepFn *);
