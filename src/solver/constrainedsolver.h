/* Solves A x = b with some rows of B x at prescribed values, by the factors of A alone. */
#pragma once
#include <petscksp.h>
#include <checkpoint/checkpoint.h>

typedef struct _n_ConstrainedSolver *ConstrainedSolver;

PETSC_INTERN PetscErrorCode     ConstrainedSolverBegin(Mat, Mat, PetscInt, const char[], PetscBool, ConstrainedSolver *);
PETSC_INTERN PetscErrorCode     ConstrainedSolverFactor(ConstrainedSolver);
PETSC_INTERN PetscErrorCode     ConstrainedSolverEnd(ConstrainedSolver);
PETSC_INTERN PetscErrorCode     ConstrainedSolverCreate(Mat, Mat, PetscInt, const char[], PetscBool, ConstrainedSolver *);
PETSC_INTERN PetscErrorCode     ConstrainedSolverDestroy(ConstrainedSolver *);
PETSC_INTERN PetscErrorCode     ConstrainedSolverRefactor(ConstrainedSolver);
PETSC_INTERN PetscErrorCode     ConstrainedSolverFreeRows(ConstrainedSolver);
PETSC_INTERN PetscErrorCode     ConstrainedSolverForgetColumns(ConstrainedSolver);
PETSC_INTERN PetscErrorCode     ConstrainedSolverGetMatrices(ConstrainedSolver, Mat *, Mat *);
PETSC_INTERN PetscErrorCode     ConstrainedSolverChoose(KSP, Mat, PetscInt);
PETSC_INTERN PetscErrorCode     ConstrainedSolverChooseMUMPS(PC);
PETSC_INTERN PetscErrorCode     ConstrainedSolverAdjust(KSP);
PETSC_INTERN PetscErrorCode     ConstrainedSolverSetConstraints(ConstrainedSolver, const PetscBool[], const PetscReal[]);
PETSC_INTERN PetscErrorCode     ConstrainedSolverSetRows(ConstrainedSolver, Mat, const PetscMPIInt[]);
PETSC_INTERN PetscErrorCode     ConstrainedSolverReplaceRows(ConstrainedSolver, Mat);
PETSC_INTERN PetscErrorCode     ConstrainedSolverApplyCompliance(ConstrainedSolver, Vec, Vec);
PETSC_INTERN PetscErrorCode     ConstrainedSolverSolveFree(ConstrainedSolver, Vec, Vec);
PETSC_INTERN PetscErrorCode     ConstrainedSolverSolveFreeColumns(ConstrainedSolver, Mat, Mat);
PETSC_INTERN PetscErrorCode     ConstrainedSolverGetMUMPS(ConstrainedSolver, Mat *);
PETSC_INTERN PetscErrorCode     ConstrainedSolverSolve(ConstrainedSolver, Vec, Vec);
PETSC_INTERN KSPConvergedReason ConstrainedSolverTakeFailure(ConstrainedSolver);
PETSC_INTERN PetscBool          ConstrainedSolverIsDirect(ConstrainedSolver);
PETSC_INTERN void               ConstrainedSolverSetExact(ConstrainedSolver);
PETSC_INTERN PetscBool          ConstrainedSolverIsHome(ConstrainedSolver);
PETSC_INTERN PetscErrorCode     ConstrainedSolverBring(ConstrainedSolver, const PetscScalar[]);
PETSC_INTERN PetscErrorCode     ConstrainedSolverCorrect(ConstrainedSolver, const PetscScalar[], Vec);
PETSC_INTERN PetscErrorCode     ConstrainedSolverVisit(ConstrainedSolver, Checkpoint);
PETSC_INTERN PetscErrorCode     ConstrainedSolverRepeats(ConstrainedSolver, PetscBool *);
