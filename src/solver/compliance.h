/*
   The compliance of rows: matrices W_k, k = 0 ... levels - 1, of the displacement of one row under a unit force on another one, k substeps
   after the force has acted. They are symmetric (Maxwell, Betti), the same on every rank, and known row by row: a row gets a place among
   the known ones, and keeps it until it is forgotten.
*/
#pragma once
#include <petscsys.h>
#include <checkpoint/checkpoint.h>
#include <checkpoint/tables.h>

typedef struct _n_Compliance *Compliance;

PETSC_INTERN PetscErrorCode ComplianceCreate(MPI_Comm, PetscInt, PetscInt, PetscInt, PetscInt, Compliance *);
PETSC_INTERN PetscErrorCode ComplianceDestroy(Compliance *);
PETSC_INTERN void           ComplianceClear(Compliance);
PETSC_INTERN PetscErrorCode ComplianceReserve(Compliance, PetscInt);
PETSC_INTERN PetscErrorCode ComplianceSetColumn(Compliance, PetscInt, PetscInt, const PetscScalar[]);
PETSC_INTERN PetscErrorCode ComplianceForget(Compliance, const PetscMPIInt[]);
PETSC_INTERN PetscErrorCode ComplianceTruncate(Compliance, PetscInt);
PETSC_INTERN void           ComplianceSpread(Compliance, PetscInt, const PetscScalar[], PetscScalar[]);
PETSC_INTERN void           ComplianceGetRows(Compliance, PetscInt *, const PetscInt *[], const PetscInt *[]);
PETSC_INTERN PetscBool      ComplianceKnows(Compliance, PetscInt);
PETSC_INTERN void           ComplianceGetMatrix(Compliance, PetscInt, PetscInt *, const PetscScalar *[]);
PETSC_INTERN PetscErrorCode ComplianceVisit(Compliance, Checkpoint);
PETSC_INTERN PetscErrorCode CompliancePack(Compliance, const char[], Tables);
PETSC_INTERN PetscErrorCode ComplianceUnpack(Compliance, const char[], const PetscInt[], Tables);
