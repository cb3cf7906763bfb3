/* The compliance of displacements: a matrix of the displacement of one under a unit force on another one. It is symmetric (Maxwell, Betti),
   the same on every rank, and known row by row: a row gets a place among the known ones. */
#pragma once
#include <petscvec.h>
#include <checkpoint/checkpoint.h>

typedef struct _n_Compliance *Compliance;

PETSC_INTERN PetscErrorCode ComplianceSetUnit(Vec, PetscInt);
PETSC_INTERN PetscErrorCode ComplianceCreate(Vec, Compliance *);
PETSC_INTERN PetscErrorCode ComplianceDestroy(Compliance *);
PETSC_INTERN void           ComplianceClear(Compliance);
PETSC_INTERN PetscErrorCode ComplianceReserve(Compliance, PetscInt);
PETSC_INTERN PetscErrorCode ComplianceSetColumn(Compliance, PetscInt, const PetscScalar[]);
PETSC_INTERN void           ComplianceGetRows(Compliance, PetscInt *, const PetscInt *[], const PetscInt *[]);
PETSC_INTERN PetscBool      ComplianceKnows(Compliance, PetscInt);
PETSC_INTERN void           ComplianceGetMatrix(Compliance, PetscInt *, const PetscScalar *[]);
PETSC_INTERN PetscErrorCode ComplianceVisit(Compliance, Checkpoint);
