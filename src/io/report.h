/* The results table of a run. */
#pragma once
#include <impakt/exact.h>
#include "verdict.h"

PETSC_INTERN PetscErrorCode ReportView(Controller, const StatisticsResults *, Exact, const Verdict *, PetscViewer);
