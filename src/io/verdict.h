/* What a user should know before believing the figures of a run. */
#pragma once
#include "statisticstypes.h"
#include <sys/units.h>

/* What may be amiss with the run, and with each of many bodies or pairs */
typedef enum {
  VERDICT_RUN = -1,
  VERDICT_UNITS,
  VERDICT_CENTRE,
  VERDICT_INERTIA,
  VERDICT_TURNED,
  VERDICT_INVERTED,
  VERDICT_UNTIED,
  VERDICT_APART,
  VERDICT_BEYOND,
  VERDICT_INSIDE,
  VERDICT_KINDS
} VerdictKind;

#define VERDICT_OF_A_KIND 3 /* sentences of one kind; one more has the number of the others */
#define VERDICT_OF_RUN    10
#define VERDICT_MAX       (VERDICT_OF_RUN + VERDICT_KINDS * (VERDICT_OF_A_KIND + 1))
#define VERDICT_SIZE      400

/* One sentence for each thing that is amiss */
typedef struct {
  ControllerStatics statics;
  Units             units;
  PetscInt          n, found[VERDICT_KINDS];
  char              text[VERDICT_MAX][VERDICT_SIZE];
} Verdict;

PETSC_INTERN PetscErrorCode VerdictMake(Controller, const StatisticsResults *, Verdict *);
PETSC_INTERN PetscErrorCode VerdictView(Controller, const StatisticsResults *, const Verdict *, PetscViewer);
PETSC_INTERN PetscErrorCode VerdictPrint(MPI_Comm, const Verdict *);
