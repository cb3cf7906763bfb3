/* The active sets that are tried in one controller step, one after the other, and what ends an alternation. Private to src/contact. */
#pragma once
#include <contact/parts.h>

/* Rounds of the active set in one step after which something must be wrong: more than any run of the tests takes, by five times */
#define ROUNDS_MAX 100

/* Rows of this rank are active, have a force or a gap as the end of the step in `contact` has them */
typedef struct {
  Contact          contact; /* borrowed */
  const PetscBool *known;   /* whether a row's gap is known; NULL: of all; borrowed */
  PetscBool        recheck; /* rows that are pulled leave */
  PetscBool       *tried;   /* sets seen in the step, one after the other */
  PetscInt         n;       /* how many; */
  PetscInt         first;   /* those before this one came before a cycle that has been ended */
  PetscBool        cycled;  /* one has been seen twice */
  PetscBool       *kept;    /* per row: it stays active to the end of the step */
} Rounds;

PETSC_INTERN PetscErrorCode RoundsCreate(Contact, Rounds *);
PETSC_INTERN PetscErrorCode RoundsDestroy(Rounds *);
PETSC_INTERN PetscErrorCode RoundsBegin(Rounds *);
PETSC_INTERN PetscErrorCode RoundsNext(Rounds *);
PETSC_INTERN PetscErrorCode RoundsChange(Rounds *, PetscBool *);
PETSC_INTERN PetscErrorCode RoundsBreakCycle(Rounds *, PetscBool *);
