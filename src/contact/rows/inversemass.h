#pragma once
#include <contact/parts.h>
#include <impakt/private/bodyforces.h>

typedef enum {
  INVERSE_MASS_ONCE,      /* that of the bodies, for a few solutions: each multiplication solves with it */
  INVERSE_MASS_ASSEMBLED, /* that of the bodies, for many solutions */
  INVERSE_MASS_LUMPED     /* its row sums */
} InverseMassType;

/* Accelerations of ties' rows by forces on them: C = sum_bodies B M^{-1} B^T [1/kg], on the rows of pairs whose nodes keep their mass */
typedef struct _InverseMass {
  Contact      contact;
  PetscBool    lumped;
  KSP          ksp; /* with C, on all rows: the identity on others */
  Vec          rhs, solution;
  PetscBool   *takes_part; /* per row of this rank */
  PetscScalar *work[2];    /* per row of this rank */
} InverseMass;

PETSC_INTERN PetscErrorCode InverseMassAssemble(Contact, PetscBool, Mat *);
PETSC_INTERN PetscErrorCode InverseMassCreate(Contact, InverseMassType, InverseMass *);
PETSC_INTERN PetscErrorCode InverseMassSolve(Contact, InverseMass *, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode InverseMassAlign(Contact, InverseMass *, BodyStepSide, PetscScalar *const[2]);
PETSC_INTERN PetscErrorCode InverseMassDestroy(InverseMass *);
