/* A linear complementarity problem on all rows: 0 <= gaps + C forces, forces >= 0, one of them zero; C is sparse. Private to
   src/contact/impls. */
#pragma once
#include <contact/parts.h>
#include <contact/activeset/rounds.h>
#include <contact/compliance/interfaceoperator.h>

typedef struct {
  InterfaceOperator S;          /* C, with the active rows as those that are solved for */
  Mat               compliance; /* C */
  /* of the rows of this rank */
  PetscScalar   *gaps, *forces;
  PetscBool     *active; /* rows with a force */
  PetscScalar   *mine;   /* work space */
  PetscScalar   *closed; /* gaps under the forces */
  Rounds         rounds;
  InterfaceMark *marks;
  PetscBool      current; /* those of C with S as it is */
  Vec            force_vec, gap_vec;
} Complementarity;

PETSC_INTERN PetscErrorCode ComplementarityCreate(Contact, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySetCompliance(Contact, PetscErrorCode (*)(Body, Mat *), Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySolve(Contact, PetscReal, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySolveActive(Contact, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementarityGetBodyForces(Contact, PetscInt, const Complementarity *, PetscScalar[]);
PETSC_INTERN PetscErrorCode ComplementarityDestroy(Complementarity *);
PETSC_INTERN PetscErrorCode ComplementarityVisit(Contact, Complementarity *, Checkpoint);
