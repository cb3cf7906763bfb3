/* What is too much for a linear material. Private to src/io. */
#pragma once
#include "statistics.h"

PETSC_INTERN PetscErrorCode LinearLimitsCheck(Controller, const ControllerFrame *, BodyStatistics[]);
