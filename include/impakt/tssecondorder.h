/* Names of time integrators for second-order systems beside PETSc's own TSALPHA2, for BodySetTSType(). */
#pragma once
#include <petscts.h>

#define TSCENTRALDIFFERENCE "centraldifference"
#define TSSTATIC            "static"
#define TSRIGID             "rigid"
