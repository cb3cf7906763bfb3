/* A complementarity problem on rows: 0 <= gaps + C forces, forces >= 0, one of them zero; C is sparse. Private to src/contact/impls. */
#pragma once
#include <contact/parts.h>
#include <contact/solve/lawimpl.h>
#include <impakt/private/bodyforces.h>

typedef struct {
  Mat        compliance; /* C, of all rows */
  LawProblem problem;    /* the same on every rank */
  PetscInt  *rows;       /* of the problem, by their numbers among those of all ranks, ascending */
  PetscBool  current;    /* the problem has the C that there is, of these rows */
  PetscReal *gaps;       /* per row of this rank: what comes in [m, or m/s] */
  PetscReal *forces;     /* per row of this rank: what goes out [N, or N s] */
  PetscBool *active;     /* per row of this rank: it has a force */
  PetscReal *mine;       /* work space, per row of this rank */
  PetscReal *all;        /* work space, per row of all ranks */
} Complementarity;

PETSC_INTERN PetscErrorCode ComplementarityCreate(Contact, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySetCompliance(Contact, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementaritySolve(Contact, PetscBool, Complementarity *);
PETSC_INTERN PetscErrorCode ComplementarityApply(Contact, Complementarity *, BodyStepSide, const PetscReal[3]);
PETSC_INTERN PetscErrorCode ComplementarityDestroy(Complementarity *);
