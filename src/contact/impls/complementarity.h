/* A linear complementarity problem on all rows: 0 <= gaps + C forces, forces >= 0, one of them zero. Private to
   src/contact/impls. */
#pragma once
#include "../contactimpl.h"
#include <petscblaslapack.h>

typedef struct {
  PetscScalar  *compliance;    /* C: all rows by all rows, by columns */
  PetscScalar  *gaps, *forces; /* of all rows, on every rank */
  PetscBool    *active;        /* rows with a force */
  PetscScalar  *mine;          /* work space: rows of this rank */
  PetscScalar  *matrix, *rhs;  /* work space */
  PetscBLASInt *pivots;        /* work space */
} Complementarity;

PETSC_INTERN PetscErrorCode ComplementarityCreate(Contact, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementarityGather(Contact, const PetscScalar[], Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySolve(Contact, PetscReal, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySolveActive(Contact, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementarityGetBodyForces(Contact, PetscInt, const Complementarity *, PetscScalar[]);
PETSC_INTERN PetscErrorCode ComplementarityDestroy(Complementarity *);
