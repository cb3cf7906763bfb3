/* The logarithm of a symmetric tensor 1 + A and its derivatives at one point. */
#pragma once
#include <petscsys.h>

typedef struct {
  PetscReal Q[3][3];         /* axes, in columns */
  PetscReal value[3];        /* logarithms of the eigenvalues */
  PetscReal first[3][3];     /* divided differences of pairs of eigenvalues */
  PetscReal second[3][3][3]; /* and of three */
} SymmetricLog;

PETSC_INTERN void SymmetricLogCreate(const PetscReal[3][3], PetscBool, SymmetricLog *);
PETSC_INTERN void SymmetricLogGet(const SymmetricLog *, PetscReal[3][3]);
PETSC_INTERN void SymmetricLogApply(const SymmetricLog *, const PetscReal[3][3], PetscReal[3][3]);
PETSC_INTERN void SymmetricLogApplySecond(const SymmetricLog *, const PetscReal[3][3], const PetscReal[3][3], PetscReal[3][3]);
