/* One subdomain: a second-order TS on a DMPlex, with its material, mass and state. */
#pragma once
#include <impakt/expression.h>
#include <impakt/element.h>
#include <impakt/material.h>
#include <petscts.h>
#include <petscdmplex.h>
#include <impakt/trace.h>

/*S
   Body - one deformable body, integrated on its own

   Level: beginner

   Note:
   A body knows nothing of other bodies. It knows rows: linear combinations B u of its displacements, given by
   `BodySetInterface()`, that are free, prescribed or loaded during a controller step (`BodySetConditions()`).

.seealso: `BodyCreate()`, `BodySetFromOptions()`, `BodyIntegrate()`
S*/
typedef struct _p_Body *Body;

PETSC_EXTERN PetscClassId BODY_CLASSID;

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

/*E
   BodyMassType - how the mass of an element is put on its nodes

   Values:
+ `BODY_MASS_LUMPED`     - row sums on the diagonal
. `BODY_MASS_CONSISTENT` - from the shape functions
- `BODY_MASS_AVERAGED`   - the mean of both: fourth-order dispersion in one dimension

   Level: beginner

.seealso: `BodySetFromOptions()`
E*/
typedef enum { BODY_MASS_LUMPED, BODY_MASS_CONSISTENT, BODY_MASS_AVERAGED } BodyMassType;
PETSC_EXTERN const char *const BodyMassTypes[];

/*E
   BodyTractionType - which nodal force of the prescribed nodes is handed to the partner

   Values:
+ `BODY_TRACTION_INTERNAL` - internal force only (Hoy, Tezaur, Mota)
- `BODY_TRACTION_REACTION` - with the inertia of the nodes: the force that really holds them

   Level: intermediate

.seealso: `BodySetTractionType()`
E*/
typedef enum { BODY_TRACTION_INTERNAL, BODY_TRACTION_REACTION } BodyTractionType;
PETSC_EXTERN const char *const BodyTractionTypes[];

/*S
   BodyMeasures - energies and momentum of a body at the current time

   Level: intermediate

.seealso: `BodyGetMeasures()`
S*/
typedef struct {
  PetscReal kinetic;             /* J; staggered, for central differences */
  PetscReal potential;           /* J */
  PetscReal external_work;       /* done since the start by forces from outside and by held displacements, J */
  PetscReal momentum[3];         /* kg m/s */
  PetscReal angular_momentum[3]; /* about the origin, kg m^2/s */
  PetscReal mean_velocity[3];    /* mass-averaged, m/s */
  PetscBool loaded;              /* whether forces from outside, held displacements or obstacles act at all */
} BodyMeasures;

/*S
   BodyTraces - the waveforms through which a body and its partners talk, one level for each substep

   Level: developer

.seealso: `BodyGetTraces()`, `BodyIntegrate()`
S*/
typedef struct {
  Trace displacement_in, velocity_in, acceleration_in; /* of prescribed rows: read by BodyIntegrate() [m, m/s, m/s^2] */
  Trace force_in;                                      /* on forced and Robin rows: read by BodyIntegrate() [N] */
  Trace displacement, velocity, acceleration;          /* of all rows: written by BodyIntegrate() */
  Trace reaction;                                      /* force that acts along prescribed and Robin rows: written by BodyIntegrate() [N] */
} BodyTraces;

PETSC_EXTERN PetscErrorCode BodyInitializePackage(void);
PETSC_EXTERN PetscErrorCode BodyFinalizePackage(void);
PETSC_EXTERN PetscErrorCode BodyCreate(MPI_Comm, const char[], Body *);
PETSC_EXTERN PetscErrorCode BodySetDM(Body, DM);
PETSC_EXTERN PetscErrorCode BodySetMaterial(Body, Material);
PETSC_EXTERN PetscErrorCode BodySetCrossSection(Body, PetscReal);
PETSC_EXTERN PetscErrorCode BodySetThickness(Body, PetscReal);
PETSC_EXTERN PetscErrorCode BodySetPlaneStress(Body, PetscBool);
PETSC_EXTERN PetscErrorCode BodySetTSType(Body, TSType);
PETSC_EXTERN PetscErrorCode BodySetTimeStep(Body, PetscReal);
PETSC_EXTERN PetscErrorCode BodySetMassType(Body, BodyMassType);
PETSC_EXTERN PetscErrorCode BodyGetMassType(Body, BodyMassType *);
PETSC_EXTERN PetscErrorCode BodySetMassRedistribute(Body, PetscBool);
PETSC_EXTERN PetscErrorCode BodySetFromOptions(Body);
PETSC_EXTERN PetscErrorCode BodySetUpDiscretization(Body);
PETSC_EXTERN PetscErrorCode BodySetUp(Body);
PETSC_EXTERN PetscErrorCode BodyView(Body, PetscViewer);
PETSC_EXTERN PetscErrorCode BodyViewFromOptions(Body, PetscObject, const char[]);
PETSC_EXTERN PetscErrorCode BodyDestroy(Body *);

PETSC_EXTERN PetscErrorCode BodyAddDisplacement(Body, const char[], const char[]);
PETSC_EXTERN PetscErrorCode BodyAddTraction(Body, const char[], const char[]);
PETSC_EXTERN PetscErrorCode BodyAddBodyForce(Body, const char[]);
PETSC_EXTERN PetscErrorCode BodySetGravity(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetInitialDisplacement(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetInitialVelocity(Body, const PetscReal[]);

PETSC_EXTERN PetscErrorCode BodySetControllerStep(Body, PetscReal, PetscReal);
PETSC_EXTERN PetscErrorCode BodySetContactNodes(Body, PetscInt, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodySetInterface(Body, Mat);
PETSC_EXTERN PetscErrorCode BodySetTractionType(Body, BodyTractionType);
PETSC_EXTERN PetscErrorCode BodySetRowWeights(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetRobin(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetInitialState(Body, PetscErrorCode (*)(PetscInt, const PetscReal[], PetscScalar[], PetscScalar[], void *),
                                                void *);

PETSC_EXTERN PetscErrorCode BodyGetDM(Body, DM *);
PETSC_EXTERN PetscErrorCode BodyGetTS(Body, TS *);
PETSC_EXTERN PetscErrorCode BodyGetMaterial(Body, Material *);
PETSC_EXTERN PetscErrorCode BodyGetSubsteps(Body, PetscInt *);
PETSC_EXTERN PetscErrorCode BodyGetStableStep(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetMass(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetSolution(Body, Vec *, Vec *, Vec *);
PETSC_EXTERN PetscErrorCode BodyGetReferencePositions(Body, Vec *);
PETSC_EXTERN PetscErrorCode BodyGetDimension(Body, PetscInt *);
PETSC_EXTERN PetscErrorCode BodyIsExplicit(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyIsStatic(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyIsRedistributed(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyGetHeldDofs(Body, PetscInt *, const PetscInt *[]);
PETSC_EXTERN PetscErrorCode BodyGetMeasures(Body, BodyMeasures *);
PETSC_EXTERN PetscErrorCode BodyGetCells(Body, DMPolytopeType *, PetscInt *, PetscInt *, PetscInt *[]);
PETSC_EXTERN PetscErrorCode BodyComputeStress(Body, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyComputeDeviation(Body, const Expression[], PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetTotalSubsteps(Body, PetscInt64 *, PetscLogDouble *);

PETSC_EXTERN PetscErrorCode BodySave(Body);
PETSC_EXTERN PetscErrorCode BodyRestore(Body);
PETSC_EXTERN PetscErrorCode BodyKeep(Body);
PETSC_EXTERN PetscErrorCode BodyReinstate(Body);
PETSC_EXTERN PetscErrorCode BodySetConditions(Body, const BodyCondition[]);
PETSC_EXTERN PetscErrorCode BodyGetTraces(Body, BodyTraces *);
PETSC_EXTERN PetscErrorCode BodyIntegrate(Body);
PETSC_EXTERN PetscErrorCode BodyHasFreeRows(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyComputeFreeRows(Body, PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyPrepareLinearized(Body);
PETSC_EXTERN PetscErrorCode BodyAddImpulse(Body, const PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyGetPositionChange(Body, PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyComputeResponse(Body, const PetscScalar *[]);
PETSC_EXTERN PetscErrorCode BodyPrepareSweeps(Body);
PETSC_EXTERN PetscErrorCode BodyResetTraces(Body);
PETSC_EXTERN PetscErrorCode BodyGetWaveformResponse(Body, const PetscScalar *[]);
PETSC_EXTERN PetscErrorCode BodyGetRateResponse(Body, const PetscScalar *[], const PetscScalar *[]);
PETSC_EXTERN PetscErrorCode BodyUpdateInterface(Body, Mat, const PetscBool[]);
PETSC_EXTERN PetscErrorCode BodyExtendCompliance(Body, PetscInt, const PetscInt[]);
PETSC_EXTERN PetscErrorCode BodyForgetCompliance(Body, const PetscMPIInt[]);
PETSC_EXTERN PetscErrorCode BodyGetCompliance(Body, PetscInt, const PetscInt *[], PetscInt *, const PetscScalar *[]);
PETSC_EXTERN PetscErrorCode BodyComplianceIsExact(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodySetBase(Body);
PETSC_EXTERN PetscErrorCode BodySetFreeBase(Body);
PETSC_EXTERN PetscErrorCode BodySetRoles(Body, const BodyCondition[]);
PETSC_EXTERN PetscErrorCode BodyRespond(Body);
PETSC_EXTERN PetscErrorCode BodyApplyCompliance(Body, Vec, Vec);
PETSC_EXTERN PetscErrorCode BodyGetNewmark(Body, PetscReal *, PetscReal *, PetscReal *, PetscReal *, PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyComputeRowStiffness(Body, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyGetImpedance(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetCrossSection(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyComputeForwardCompliance(Body, Mat *);
PETSC_EXTERN PetscErrorCode BodyBoundForwardCompliance(Body, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyComputeInverseMass(Body, Mat *);
PETSC_EXTERN PetscErrorCode BodyFeelsEndForce(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyAddEndForce(Body, const PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyGetElementSize(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetElementStiffness(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyAddVelocity(Body, const PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyAddAcceleration(Body, const PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyClearAcceleration(Body, const PetscBool[]);
PETSC_EXTERN PetscErrorCode BodyShiftStart(Body, const PetscScalar[]);
