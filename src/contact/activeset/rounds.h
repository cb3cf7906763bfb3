/* The active sets that are tried in one controller step, one after the other, and what ends an alternation. Private to src/contact. */
#pragma once
#include <contact/parts.h>

/* Rounds of the active set in one step after which something must be wrong: more than any run of the tests takes, by five times */
#define ROUNDS_MAX 100

typedef struct {
  Contact contact; /* borrowed */
  /* of this rank's rows, all borrowed: what is changed, and what is looked at for it */
  PetscBool       *active;
  const PetscReal *force, *gap; /* of active rows [N], less than 0 where they are pulled; of the others [m] */
  const PetscBool *known;       /* whether a row's gap is told; NULL: of all */
  PetscReal        tolerance;   /* gaps above minus this are not penetration [m] */
  PetscBool        recheck;     /* rows that are pulled leave */
  /* the step under way */
  PetscBool *tried;    /* those seen, one after the other */
  PetscInt   n, first; /* how many; those before the first were under another rule */
  PetscBool  cycled;   /* one has been seen twice */
  PetscBool  single;   /* one row changes in a round, not all */
  PetscInt   fewest;   /* wrong rows in any round since */
  PetscBool *kept;     /* per row: it stays active to the end of the step */
} Rounds;

PETSC_INTERN PetscErrorCode RoundsCreate(Contact, PetscBool[], const PetscReal[], const PetscReal[], Rounds *);
PETSC_INTERN PetscErrorCode RoundsDestroy(Rounds *);
PETSC_INTERN PetscErrorCode RoundsBegin(Rounds *);
PETSC_INTERN PetscErrorCode RoundsNext(Rounds *);
PETSC_INTERN PetscErrorCode RoundsChange(Rounds *);
PETSC_INTERN PetscErrorCode RoundsHaveChanged(const Rounds *, PetscBool *);
PETSC_INTERN PetscErrorCode RoundsBreakCycle(Rounds *, PetscBool *);
PETSC_INTERN PetscErrorCode RoundsVisit(Rounds *, Checkpoint);
