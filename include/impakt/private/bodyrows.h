/*
   What contact methods ask of a body: rows of its displacements, what they mean in a controller step, and how they answer to forces. For
   those who write a contact method; a user of bodies needs <impakt/body.h> alone.
*/
#pragma once
#include <impakt/body.h>
#include <impakt/private/stepfailure.h>
#include <impakt/private/trace.h>

/*E
   BodyCondition - what a row of the interface means to a body in this controller step

   Values:
+ `BODY_FREE`       - nothing: the row is not of this body, or not in contact
. `BODY_PRESCRIBED` - displacement, velocity and acceleration of the row follow their input traces
. `BODY_FORCED`     - the force in its input trace acts along the row
- `BODY_ROBIN`      - the force in its input trace less that of a spring between the row and a fixed point acts along the row

   Level: developer

.seealso: `BodySetConditions()`, `BodySetRobin()`
E*/
typedef enum { BODY_FREE, BODY_PRESCRIBED, BODY_FORCED, BODY_ROBIN } BodyCondition;

/*S
   BodyTraces - what goes into the rows of a body and comes out of them in a controller step, at the ends of its substeps

   Level: developer

.seealso: `BodyGetTraces()`, `BodyIntegrate()`
S*/
typedef struct {
  Trace displacement_in, velocity_in, acceleration_in; /* of prescribed rows: read by BodyIntegrate() [m, m/s, m/s^2] */
  Trace force_in;                                      /* on forced and Robin rows: read by BodyIntegrate() [N] */
  Trace displacement, velocity, acceleration;          /* of all rows: written by BodyIntegrate() */
  Trace reaction;                                      /* force that acts along prescribed and Robin rows: written by BodyIntegrate() [N] */
} BodyTraces;

#define BODY_SUDDEN_LENGTH 512 /* of the text of BodyDescribeSuddenLoad() */

#define BODY_MAX_SPRINGS 6 /* as many as a body has motions as if it were rigid */

/*S
   BodySpringState - how the artificial springs of a floating body are stretched at the end of a controller step

   Level: developer

.seealso: `BodyMeasureSprings()`
S*/
typedef struct {
  PetscInt  n;
  PetscReal stretch[BODY_MAX_SPRINGS]; /* [m] */
  PetscReal fall[3];                   /* by which that takes the body along as a whole, without turning it [m] */
  PetscReal falls[BODY_MAX_SPRINGS];   /* the part of the stretch which that is [m] */
  PetscReal stiffness;                 /* of each [N/m] */
  PetscReal part;                      /* the same, in parts of that of the body */
  PetscBool linear;                    /* the body is */
  PetscReal displacement;              /* the largest of the dofs that they pull at [m] */
  PetscReal way;                       /* the largest of these less that in the saved state [m] */
  PetscReal size;                      /* of the body: the longest edge of its box [m] */
} BodySpringState;

/* Mesh and material, as contact methods scale by them */
PETSC_EXTERN PetscErrorCode BodyGetElementSize(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetContactElementSize(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetInitialVelocity(Body, PetscReal[3]);
PETSC_EXTERN PetscErrorCode BodyGetElementStiffness(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetImpedance(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetCrossSection(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetHeldDofs(Body, PetscInt *, const PetscInt *[]);
PETSC_EXTERN PetscErrorCode BodyGetLed(Body, PetscBool *, PetscBool *);

/* Rows, set up once and given new entries later */
PETSC_EXTERN PetscErrorCode BodySetContactNodes(Body, PetscInt, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodyChooseMass(Body, PetscInt, const PetscInt[], PetscBool *);
PETSC_EXTERN PetscBool      BodyChoosesMass(Body);
PETSC_EXTERN PetscErrorCode BodyKeepMass(Body);
PETSC_EXTERN PetscErrorCode BodyGetContactPart(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodySetInterface(Body, Mat);
PETSC_EXTERN PetscErrorCode BodyAllRowsAre(Body, BodyCondition, PetscBool *);
PETSC_EXTERN PetscErrorCode BodySetNearRows(Body, PetscInt, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodyWriteStartTraces(Body);
PETSC_EXTERN PetscErrorCode BodyUpdateInterface(Body, Mat, const PetscInt[], const int[]);
PETSC_EXTERN PetscErrorCode BodyExpectRows(Body);
PETSC_EXTERN PetscErrorCode BodyReplaceInterface(Body, Mat, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodyHandOver(Body, const PetscReal[], const PetscReal[], const PetscInt[], PetscInt);
PETSC_EXTERN PetscErrorCode BodySetRowWeights(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetRobin(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetTractionType(Body, BodyTractionType);
PETSC_EXTERN PetscErrorCode BodyComputeRowStiffness(Body, PetscReal[]);

/* One controller step */
PETSC_EXTERN PetscErrorCode BodySetUpSteps(Body);
PETSC_EXTERN PetscErrorCode BodyShareControllerStep(Body, PetscInt);
PETSC_EXTERN PetscErrorCode BodySave(Body);
PETSC_EXTERN PetscErrorCode BodyRestore(Body);
PETSC_EXTERN PetscErrorCode BodyStepBack(Body);
PETSC_EXTERN PetscErrorCode BodySetStepLevel(Body, PetscInt);
PETSC_EXTERN PetscErrorCode BodyKeep(Body);
PETSC_EXTERN PetscErrorCode BodyReinstate(Body);
PETSC_EXTERN PetscErrorCode BodySetConditions(Body, const BodyCondition[]);
PETSC_EXTERN PetscErrorCode BodyGetTraces(Body, BodyTraces *);
PETSC_EXTERN PetscErrorCode BodyResetTraces(Body);
PETSC_EXTERN PetscErrorCode BodyGetRowForces(Body, PetscInt, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyIsLocal(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyComputeEnergy(Body, PetscReal *);
/* Numbers that measures and energies of a body are summed up from */
#define BODY_MEASURE_SUMS 24
PETSC_EXTERN PetscErrorCode BodyGetAllMeasures(PetscInt, const Body[], PetscReal[], BodyMeasures[]);
PETSC_EXTERN PetscErrorCode BodyComputeEnergies(PetscInt, const Body[], PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyGetOwnKinetic(PetscInt, const Body[], const BodyMeasures[], PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetAllBoxes(PetscInt, const Body[], PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyIntegrate(Body);
PETSC_EXTERN PetscErrorCode BodyTryIntegrateRows(Body, StepConvergedReason *);
PETSC_EXTERN PetscErrorCode BodyCompleteStep(Body, StepConvergedReason *);
PETSC_EXTERN PetscErrorCode BodyBeginExchange(Body, PetscBool);
PETSC_EXTERN PetscErrorCode BodyEndExchange(Body);
PETSC_EXTERN PetscErrorCode BodyGetFailure(Body, const StepFailure **);
PETSC_EXTERN PetscErrorCode BodyGetPositionChange(Body, PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetNewmark(Body, PetscReal *, PetscReal *, PetscReal *, PetscReal *, PetscReal *, PetscReal *);

/* Matrices of rows of a body that one of several ranks has all of, which is that rank's `owner` */
PETSC_EXTERN PetscErrorCode BodyWholeRowsTellColumns(Mat, PetscBool, PetscInt, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodyWholeRowsRenew(Mat, PetscBool, const PetscInt[]);

/* Static bodies that contact or ties alone hold */
PETSC_EXTERN PetscErrorCode BodyIsFloating(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyResetSprings(Body);
PETSC_EXTERN PetscErrorCode BodyGetLeastStiffness(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodySetSpringStiffness(Body, PetscReal);
PETSC_EXTERN PetscErrorCode BodyMeasureSprings(Body, BodySpringState *);
PETSC_EXTERN PetscErrorCode BodyMoveSprings(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyDescribeDrift(Body, size_t, char[]);
PETSC_EXTERN PetscErrorCode BodyGetInertiaChange(Body, PetscInt, const PetscInt[], PetscReal *);
PETSC_EXTERN PetscErrorCode BodyDescribeSuddenLoad(Body, char[BODY_SUDDEN_LENGTH]);

/*E
   BodyForceShape - how a force on a body runs in the course of a controller step

   Values:
+ `BODY_FORCE_LINEAR`   - from that which the last step has ended with to that at the end of this one
- `BODY_FORCE_CONSTANT` - the same throughout

   Level: developer

.seealso: `BodySetConstantForces()`, `BodyGetNodalCompliance()`
E*/
typedef enum { BODY_FORCE_LINEAR, BODY_FORCE_CONSTANT } BodyForceShape;

/* Forces of a shape, and how nodes answer */
PETSC_EXTERN PetscErrorCode BodySetConstantForces(Body, PetscInt, const PetscInt[], const PetscReal[], const PetscReal[],
                                                  const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyEndConstantForces(Body, const PetscScalar[], const PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyGetNodalDiagonal(Body, BodyForceShape, Vec *);
PETSC_EXTERN PetscErrorCode BodyGetNodalCompliance(Body, BodyForceShape, PetscInt, const PetscInt[], const PetscInt *[], PetscInt *,
                                                   const PetscScalar *[]);
PETSC_EXTERN PetscErrorCode BodyNodalComplianceFollows(Body, PetscInt, PetscBool *);

/* Displacements of rows under contact forces: the interface compliance */
PETSC_EXTERN PetscErrorCode BodyGetLayerMatrices(Body, Mat *, Mat *);
PETSC_EXTERN PetscErrorCode BodyComplianceIsExact(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyApplyCompliance(Body, Vec, Vec);

/* The balance of the massless layer in the first state */
PETSC_EXTERN PetscErrorCode BodyIsOutOfBalance(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyMarkRows(Body, PetscBool[], PetscBool[]);
PETSC_EXTERN PetscErrorCode BodyRelaxLayer(Body, PetscScalar[], PetscReal *);
PETSC_EXTERN PetscErrorCode BodyMultiplyLayerCompliance(Body, const PetscScalar[], PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyMoveLayer(Body, const PetscScalar[], PetscReal *);
PETSC_EXTERN PetscErrorCode BodyStartUnderForces(Body, const PetscScalar[]);

/* Where in a controller step a state is changed */
typedef enum { BODY_AT_START, BODY_AT_END } BodyStepSide;

/* Forces and impulses on rows that act at one end of a step, and corrections of the state there */
PETSC_EXTERN PetscErrorCode BodySetStartForce(Body, const PetscScalar[], const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyDropStartForce(Body);
PETSC_EXTERN PetscErrorCode BodyGetLevelEnergy(Body, PetscInt, PetscReal *);
PETSC_EXTERN PetscErrorCode BodySetMeanForces(Body, const PetscBool[]);
PETSC_EXTERN PetscErrorCode BodyGetMeanForces(Body, const PetscBool *[]);
PETSC_EXTERN PetscErrorCode BodyFeelsEndForce(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyAddImpulses(Body, BodyStepSide, PetscBool, const PetscReal[3], const PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyComputeInverseMass(Body, PetscBool, Mat *);
PETSC_EXTERN PetscErrorCode BodyBoundInverseMass(Body, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyMultiplyInverseMass(Body, const PetscScalar[], PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyClearAcceleration(Body, const PetscBool[]);
