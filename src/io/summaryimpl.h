/* What the files of the summary share: its JSON object is put together member by member. Private to src/io. */
#pragma once
#include <impakt.h>
#include <jansson.h>
#include "statisticstypes.h"

PETSC_INTERN PetscErrorCode SummarySetMember(json_t *, const char[], json_t *);
PETSC_INTERN PetscErrorCode SummarySetReal(json_t *, const char[], PetscReal);
PETSC_INTERN PetscErrorCode SummarySetInteger(json_t *, const char[], PetscInt64);
PETSC_INTERN PetscErrorCode SummarySetVector(json_t *, const char[], const PetscReal[3]);
PETSC_INTERN PetscErrorCode SummarySetObject(json_t *, const char[], json_t **);
PETSC_INTERN PetscErrorCode SummaryAddBodies(json_t *, const Body[], const StatisticsResults *);
PETSC_INTERN PetscErrorCode SummaryAddObstacles(json_t *, const StatisticsResults *);
