/* What is too much for a linear material. Private to src/io. */
#pragma once
#include "statisticstypes.h"

PETSC_INTERN PetscErrorCode LinearLimitsCheck(Controller, const ControllerFrame *, BodyStatistics[]);
