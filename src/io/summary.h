/* The JSON summary of a run. */
#pragma once
#include <impakt/exact.h>
#include "statistics.h"

PETSC_INTERN PetscErrorCode SummaryWrite(Controller, const StatisticsResults *, Exact, const char[]);
