/* The JSON summary of a run. */
#pragma once
#include <impakt/exact.h>
#include "verdict.h"

PETSC_INTERN PetscErrorCode SummaryWrite(Controller, const StatisticsResults *, Exact, const Verdict *, const char[]);
