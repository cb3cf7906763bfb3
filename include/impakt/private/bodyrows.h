/* What contact and the rows of a body ask of each other in the time loop: conditions, waveforms, entries, steps. For those who write a
   contact method; a user of bodies needs <impakt/body.h> alone. */
#pragma once
#include <impakt/body.h>
#include <impakt/private/stepfailure.h>
#include <impakt/private/trace.h>

/* What a row of the interface means to a body in this controller step:
   free: nothing, as the row is not of this body, or not in contact;
   prescribed: displacement, velocity and acceleration of the row follow their input traces;
   forced: the force in its input trace acts along the row;
   Robin: the force in its input trace less that of a spring between the row and a fixed point acts along the row */
typedef enum { BODY_FREE, BODY_PRESCRIBED, BODY_FORCED, BODY_ROBIN } BodyCondition;

/* What goes into the rows of a body and comes out of them in a controller step, at the ends of its substeps */
enum { BODY_FIRST_FORCE = 3, BODY_TRACES = 8 }; /* the first of the traces that obstacles have too, and how many there are */
typedef union {
  struct {
    Trace displacement_in, velocity_in, acceleration_in; /* of prescribed rows: read by BodyIntegrate() [m, m/s, m/s^2] */
    Trace force_in;                                      /* on forced and Robin rows: read by BodyIntegrate() [N] */
    Trace displacement, velocity, acceleration;          /* of all rows: written by BodyIntegrate() */
    Trace reaction; /* force that acts along prescribed and Robin rows: written by BodyIntegrate() [N] */
  };
  Trace all[BODY_TRACES];
} BodyTraces;

/* How the steps of a body answer to contact; pointers are owned by the body */
typedef struct {
  PetscBool          local;        /* one of several ranks has the whole body and makes its steps, see BodyGetStepProperties() */
  PetscBool          free, forced; /* all rows are; the same on every rank */
  PetscBool          affine;       /* of linear bodies: displacements of rows are, in the contact forces at the ends of substeps */
  const PetscBool   *by_mean;      /* per row of this rank: see BodySetMeanForces(); NULL: none */
  const StepFailure *failure;      /* why the last integration failed, and the error that this becomes where nobody can repeat the step */
} BodyStepProperties;

PETSC_EXTERN PetscErrorCode BodySetInterface(Body, Mat);
PETSC_EXTERN PetscErrorCode BodyUpdateInterface(Body, Mat, const PetscInt[], const int[]);
PETSC_EXTERN PetscErrorCode BodyReplaceInterface(Body, Mat, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodySetNearRows(Body, PetscInt, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodyWriteStartTraces(Body);
PETSC_EXTERN PetscErrorCode BodyHandOver(Body, const PetscReal[], const PetscReal[], const PetscInt[], PetscInt);
PETSC_EXTERN PetscErrorCode BodySetConditions(Body, const BodyCondition[]);
PETSC_EXTERN PetscErrorCode BodyGetTraces(Body, BodyTraces *);
PETSC_EXTERN PetscErrorCode BodyGetRowForces(Body, PetscInt, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyIsLinear(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyGetStepProperties(Body, BodyStepProperties *);
PETSC_EXTERN PetscErrorCode BodyBeginExchange(Body, PetscBool);
PETSC_EXTERN PetscErrorCode BodyTryIntegrateRows(Body, StepConvergedReason *);
PETSC_EXTERN PetscErrorCode BodyCompleteStep(Body, StepConvergedReason *);
PETSC_EXTERN PetscErrorCode BodyEndExchange(Body);
