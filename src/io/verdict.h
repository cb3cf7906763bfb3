/* What a user should know before believing the figures of a run. */
#pragma once
#include "statistics.h"

#define VERDICT_MAX  8
#define VERDICT_SIZE 256

/* One sentence for each thing that is amiss */
typedef struct {
  PetscInt n;
  char     text[VERDICT_MAX][VERDICT_SIZE];
} Verdict;

PETSC_INTERN PetscErrorCode VerdictMake(Controller, const StatisticsResults *, Verdict *);
PETSC_INTERN PetscErrorCode VerdictPrint(MPI_Comm, const Verdict *);
