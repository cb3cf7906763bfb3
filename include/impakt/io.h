/* What a run leaves behind: history, summary, results table. */
#pragma once
#include <impakt/controller.h>

/*S
   Output - the files that a run writes and the table that it prints

   Level: beginner

   Note:
   It observes a controller through monitors; the controller does not know of it.

.seealso: `OutputCreate()`, `OutputSetFromOptions()`, `OutputReport()`
S*/
typedef struct _n_Output *Output;

PETSC_EXTERN PetscErrorCode OutputCreate(Controller, Output *);
PETSC_EXTERN PetscErrorCode OutputSetFromOptions(Output);
PETSC_EXTERN PetscErrorCode OutputReport(Output);
PETSC_EXTERN PetscErrorCode OutputDestroy(Output *);
