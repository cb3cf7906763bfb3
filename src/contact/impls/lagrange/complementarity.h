/* A linear complementarity problem on all rows: 0 <= gaps + C forces, forces >= 0, one of them zero; C is sparse. Private to
   src/contact/impls. */
#pragma once
#include <impakt/private/contactimpl.h>
#include <petscblaslapack.h>

typedef struct {
  Contact contact; /* borrowed */
  Mat     compliance;
  /* of the rows of this rank */
  PetscScalar *gaps, *forces;
  PetscBool   *active; /* rows with a force */
  PetscScalar *mine;   /* work space */
  Vec          force_vec, gap_vec, rhs_vec;
  /* active rows of all ranks, on every rank, where there are not too many */
  PetscBool     dense, current; /* whether rows and factor are those of the active rows */
  PetscBool    *factored;       /* rows of this rank that are in the factor */
  PetscInt      n, capacity;
  PetscInt     *rows, *place; /* place: of each row of all ranks among them, or -1 */
  PetscScalar  *factor, *rhs;
  PetscBLASInt *pivots;
  /* with more of them */
  KSP iterative;
} Complementarity;

PETSC_INTERN PetscErrorCode ComplementarityCreate(Contact, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySetCompliance(Contact, PetscErrorCode (*)(Body, Mat *), Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySolve(Contact, PetscReal, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySolveActive(Contact, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementarityGetBodyForces(Contact, PetscInt, const Complementarity *, PetscScalar[]);
PETSC_INTERN PetscErrorCode ComplementarityDestroy(Complementarity *);
