/* What a run leaves behind: history, summary, results table. */
#pragma once
#include <impakt/exact.h>

/*S
   Output - the files that a run writes and the table that it prints

   Level: beginner

   Note:
   It observes a controller through monitors; the controller does not know of it.

.seealso: `OutputCreate()`, `OutputSetFromOptions()`, `OutputReport()`
S*/
typedef struct _p_Output *Output;

PETSC_EXTERN PetscClassId OUTPUT_CLASSID;

/*E
   OutputPrecision - of the numbers in a file of fields

   Values:
+ `OUTPUT_SINGLE` - 4 bytes, about 7 digits
- `OUTPUT_DOUBLE` - 8 bytes, about 16 digits

   Level: intermediate

.seealso: `OutputSetFields()`
E*/
typedef enum { OUTPUT_SINGLE, OUTPUT_DOUBLE } OutputPrecision;
PETSC_EXTERN const char *const OutputPrecisions[];

/* Exit code of a program whose run has ended before its time, see OutputIsStopped(): that of <sysexits.h> for "try again later" */
#define IMPAKT_STOPPED 75

PETSC_EXTERN PetscErrorCode OutputInitializePackage(void);
PETSC_EXTERN PetscErrorCode OutputCreate(Controller, Output *);
PETSC_EXTERN PetscErrorCode OutputSetExact(Output, ExactType);
PETSC_EXTERN PetscErrorCode OutputSetExactDisplacement(Output, Body, const char[]);
PETSC_EXTERN PetscErrorCode OutputSetSummary(Output, const char[]);
PETSC_EXTERN PetscErrorCode OutputSetHistory(Output, const char[]);
PETSC_EXTERN PetscErrorCode OutputSetFields(Output, const char[], PetscInt, OutputPrecision);
PETSC_EXTERN PetscErrorCode OutputSetCheckpoint(Output, const char[], PetscInt, PetscReal);
PETSC_EXTERN PetscErrorCode OutputSetRestart(Output, const char[], PetscBool);
PETSC_EXTERN PetscErrorCode OutputSetRestartState(Output, const char[]);
PETSC_EXTERN PetscErrorCode OutputSetMaxWallTime(Output, PetscReal);
PETSC_EXTERN PetscErrorCode OutputCatchSignals(Output);
PETSC_EXTERN PetscErrorCode OutputSetFromOptions(Output);
PETSC_EXTERN PetscErrorCode OutputRestart(Output);
PETSC_EXTERN PetscErrorCode OutputIsStopped(Output, PetscBool *);
PETSC_EXTERN PetscErrorCode OutputSetCheck(Output, PetscBool);
PETSC_EXTERN PetscErrorCode OutputGetCheck(Output, PetscBool *);
PETSC_EXTERN PetscErrorCode OutputCheck(Output);
PETSC_EXTERN PetscErrorCode OutputReport(Output);
PETSC_EXTERN PetscErrorCode OutputView(Output, PetscViewer);
PETSC_EXTERN PetscErrorCode OutputDestroy(Output *);
