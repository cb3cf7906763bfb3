/* What a class remembers of each of its nodes or rows: a list of arrays. One list of a class serves all that copies its state: what is put
   aside for a step that may have to be made again, checkpoints, and tables by which a run is continued on another number of ranks. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <checkpoint/tables.h>

#define STATE_ARRAYS 28 /* at most */

typedef struct {
  PetscInt   per;   /* numbers of each node or row; 0: there is no such array */
  PetscReal *reals; /* NULL without `bools`: there are none now, and their place in a packed line stays as it is */
  PetscBool *bools; /* in place of `reals` */
} StateArray;

typedef struct {
  PetscInt   n; /* nodes or rows of this rank */
  StateArray arrays[STATE_ARRAYS];
} StateList;

PETSC_INTERN PetscInt       StateListGetWidth(const StateList *);
PETSC_INTERN PetscErrorCode StateListAllocate(const StateList *, PetscReal *[]);
PETSC_INTERN PetscErrorCode StateListCopy(const StateList *, PetscBool, PetscReal[]);
PETSC_INTERN void           StateListCopyOne(const StateList *, PetscInt, PetscBool, PetscReal[]);
PETSC_INTERN PetscErrorCode StateListVisit(const StateList *, const char[], Checkpoint);
PETSC_INTERN PetscErrorCode StateListVisitNodes(const StateList *, PetscInt, PetscInt, PetscInt, const PetscReal[], const char[], Tables);
