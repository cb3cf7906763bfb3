/* The results table of a run. */
#pragma once
#include <impakt/exact.h>
#include "statistics.h"

PETSC_INTERN PetscErrorCode ReportView(Controller, const StatisticsResults *, Exact, PetscViewer);
