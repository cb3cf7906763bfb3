/* How far bodies are from displacements that the user gives as formulas. */
#pragma once
#include <impakt/controller.h>

typedef struct _n_Deviation *Deviation;

PETSC_INTERN PetscErrorCode DeviationCreate(Controller, Deviation *);
PETSC_INTERN PetscErrorCode DeviationSet(Deviation, Body, const char[]);
PETSC_INTERN PetscErrorCode DeviationCompute(Deviation, PetscReal[]);
PETSC_INTERN PetscErrorCode DeviationDestroy(Deviation *);
