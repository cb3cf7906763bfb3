/* A waveform: a field on contact rows over one controller step, piecewise linear in time. */
#pragma once
#include <petscsys.h>

/* Values of `size` numbers at `levels` + 1 equally spaced times of one controller step, level 0 being its start; linear in between */
typedef struct _n_Trace *Trace;

PETSC_EXTERN PetscErrorCode TraceCreate(PetscInt, PetscInt, Trace *);
PETSC_EXTERN PetscErrorCode TraceDestroy(Trace *);
PETSC_EXTERN PetscErrorCode TraceGetSizes(Trace, PetscInt *, PetscInt *);
PETSC_EXTERN PetscErrorCode TraceGetLevel(Trace, PetscInt, PetscScalar **);
PETSC_EXTERN PetscErrorCode TraceInterpolate(Trace, PetscReal, PetscInt, PetscInt, PetscScalar[]);
PETSC_EXTERN PetscErrorCode TraceResampleConstant(Trace, PetscInt, PetscInt, PetscScalar, Trace, PetscInt);
PETSC_EXTERN PetscErrorCode TraceResample(Trace, PetscInt, PetscInt, PetscScalar, Trace, PetscInt);
