/* One subdomain: a second-order TS on a DMPlex, with its material, mass and state. */
#pragma once
#include <impakt/expression.h>
#include <impakt/element.h>
#include <impakt/material.h>
#include <petscts.h>
#include <petscdmplex.h>

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

/*S
   BodyMeasures - energies and momentum of a body at the current time

   Level: intermediate

.seealso: `BodyGetMeasures()`
S*/
typedef struct {
  PetscReal kinetic;             /* J; staggered, for central differences */
  PetscReal kinetic_unstaggered; /* J; the same for all other integrators */
  PetscReal potential;           /* J */
  PetscReal hourglass_energy;    /* part of the potential that holds what elements with one point do not see, J */
  PetscReal external_work;       /* done since the start by forces from outside and by held displacements, J */
  PetscReal damping_work;        /* taken since the start by Rayleigh damping, J */
  PetscReal plastic_work;        /* taken since the start by plastic flow, with what hardening stores of it, by the mean stress of each step
                                    where the body has inertia, J */
  PetscReal momentum[3];         /* kg m/s */
  PetscReal angular_momentum[3]; /* about the origin, kg m^2/s */
  PetscReal mean_velocity[3];    /* mass-averaged, m/s */
  PetscReal rotation[3];    /* mean rotation of a linear body since its undeformed state, about each axis, as long as it is small: zero for
                               bodies that are nonlinear, whose rotation is not limited [rad] */
  PetscReal place[3];       /* its centre of mass, m */
  PetscReal orientation[3]; /* how a rigid body has turned: axis times angle between 0 and pi; zeros for others [rad] */
  PetscReal angular_velocity[3]; /* of a rigid body; zeros for others [rad/s] */
  PetscBool loaded;              /* whether forces from outside, held displacements, obstacles or damping by the mass act at all */
} BodyMeasures;

/*E
   BodyMassMoments - what a body with massless contact nodes keeps of its full mass

   Values:
+ `BODY_MASS_TOTAL`   - the total alone: the centre moves inwards
. `BODY_MASS_CENTRE`  - that and the centre of mass
- `BODY_MASS_INERTIA` - that and, where positive masses allow, the moments of inertia (default)

   Level: intermediate

.seealso: `BodySetMassRedistribute()`
E*/
typedef enum { BODY_MASS_TOTAL, BODY_MASS_CENTRE, BODY_MASS_INERTIA } BodyMassMoments;
PETSC_EXTERN const char *const BodyMassMomentsNames[];

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

/* At most so many elements are told of */
#define BODY_STEP_BOUNDS 10

/*S
   BodyStepBounds - the elements that bound the stable step of a body, those with the shortest steps first, and the median of all

   Level: intermediate

   Note:
   Elements all of whose nodes are massless have no step, and do not count.

.seealso: `BodyGetStepBounds()`, `BodyGetStableStep()`
S*/
typedef struct {
  PetscReal median; /* of the stable steps of all elements [s] */
  PetscInt  n;
  PetscInt  number[BODY_STEP_BOUNDS];    /* of the element, rank after rank, from 0 */
  PetscReal step[BODY_STEP_BOUNDS];      /* s */
  PetscReal centre[BODY_STEP_BOUNDS][3]; /* in the undeformed mesh; zeros beyond the space dimension [m] */
} BodyStepBounds;

PETSC_EXTERN PetscErrorCode BodyInitializePackage(void);
PETSC_EXTERN PetscErrorCode BodyCreate(MPI_Comm, const char[], Body *);
PETSC_EXTERN PetscErrorCode BodySetDM(Body, DM);
PETSC_EXTERN PetscErrorCode BodySetRanks(Body, PetscInt, const PetscMPIInt[]);
PETSC_EXTERN PetscErrorCode BodyGetRanks(Body, PetscInt *, const PetscMPIInt *[]);
PETSC_EXTERN PetscErrorCode BodyGetMeshRank(Body, PetscMPIInt *);
PETSC_EXTERN PetscErrorCode BodySetMaterial(Body, Material);
PETSC_EXTERN PetscErrorCode BodySetCrossSection(Body, PetscReal);
PETSC_EXTERN PetscErrorCode BodySetThickness(Body, PetscReal);
PETSC_EXTERN PetscErrorCode BodySetPlaneStress(Body, PetscBool);
PETSC_EXTERN PetscErrorCode BodyGetAxisymmetric(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodySetTSType(Body, TSType);
PETSC_EXTERN PetscErrorCode BodySetRigid(Body, PetscBool);
PETSC_EXTERN PetscErrorCode BodyIsRigid(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodySetRigidDisplacement(Body, const char[]);
PETSC_EXTERN PetscErrorCode BodySetRigidRotation(Body, const char[]);
PETSC_EXTERN PetscErrorCode BodySetTimeStep(Body, PetscReal);
PETSC_EXTERN PetscErrorCode BodyGetTimeStep(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodySetMassType(Body, BodyMassType);
PETSC_EXTERN PetscErrorCode BodyGetMassType(Body, BodyMassType *);
PETSC_EXTERN PetscErrorCode BodySetMassRedistribute(Body, PetscBool);
PETSC_EXTERN PetscErrorCode BodySetFromOptions(Body);
PETSC_EXTERN PetscErrorCode BodyView(Body, PetscViewer);
PETSC_EXTERN PetscErrorCode BodyDestroy(Body *);

PETSC_EXTERN PetscErrorCode BodyAddDisplacement(Body, const char[], const char[]);
PETSC_EXTERN PetscErrorCode BodyAddTraction(Body, const char[], const char[]);
PETSC_EXTERN PetscErrorCode BodyAddBodyForce(Body, const char[]);
PETSC_EXTERN PetscErrorCode BodyGetGravity(Body, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetGravity(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetInitialDisplacement(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetInitialVelocity(Body, const PetscReal[]);

PETSC_EXTERN PetscErrorCode BodySetInitialState(Body, PetscErrorCode (*)(PetscInt, const PetscReal[], PetscScalar[], PetscScalar[], void *),
                                                void *);

PETSC_EXTERN PetscErrorCode BodyGetDM(Body, DM *);
PETSC_EXTERN PetscErrorCode BodyGetTS(Body, TS *);
PETSC_EXTERN PetscErrorCode BodyGetMaterial(Body, Material *);
PETSC_EXTERN PetscErrorCode BodyGetSubsteps(Body, PetscInt *);
PETSC_EXTERN PetscErrorCode BodyGetStableStep(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetStepBounds(Body, const BodyStepBounds **);
PETSC_EXTERN PetscErrorCode BodyGetMass(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetInertia(Body, PetscReal[3], PetscReal[9]);
PETSC_EXTERN PetscErrorCode BodyAddProbe(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyGetNumProbes(Body, PetscInt *);
PETSC_EXTERN PetscErrorCode BodyGetProbes(Body, PetscReal[], PetscReal[], PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetDamping(Body, PetscReal, PetscReal);
PETSC_EXTERN PetscErrorCode BodyGetDamping(Body, PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetMassRedistribution(Body, PetscReal *, PetscReal *, PetscReal[], PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetSolution(Body, Vec *, Vec *, Vec *);
PETSC_EXTERN PetscErrorCode BodyGetReferencePositions(Body, Vec *);
PETSC_EXTERN PetscErrorCode BodyGetDimension(Body, PetscInt *);
PETSC_EXTERN PetscErrorCode BodyIsExplicit(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyIsStatic(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyIsRedistributed(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyGetMeasures(Body, BodyMeasures *);
PETSC_EXTERN PetscReal      BodyMeasuresGetBalance(const BodyMeasures *);
PETSC_EXTERN PetscErrorCode BodyGetNumReactions(Body, PetscInt *);
PETSC_EXTERN PetscErrorCode BodyGetReactionSurface(Body, PetscInt, const char *[]);
PETSC_EXTERN PetscErrorCode BodyGetReactions(Body, PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyGetCells(Body, DMPolytopeType *, PetscInt *, PetscInt *, PetscInt *[]);
PETSC_EXTERN PetscErrorCode BodyComputeStress(Body, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyComputePlasticStrain(Body, PetscReal[], PetscReal *);
PETSC_EXTERN PetscErrorCode BodySetBlockMaterial(Body, const char[], Material);
PETSC_EXTERN PetscErrorCode BodyGetBlocks(Body, PetscInt *, const char *const *[], const Material *[]);
PETSC_EXTERN PetscErrorCode BodyGetCellBlocks(Body, const PetscInt *[]);
PETSC_EXTERN PetscErrorCode BodyGetBlockMass(Body, const PetscReal *[]);
PETSC_EXTERN PetscErrorCode BodyComputeDeviation(Body, const Expression[], PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetTotalSubsteps(Body, PetscInt64 *, PetscLogDouble *);
