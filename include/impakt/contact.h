/* Contact between bodies: pairs, active set, and the methods that advance all bodies through a controller step. */
#pragma once
#include <impakt/body.h>
#include <impakt/stepreason.h>
#include <impakt/obstacle.h>

/*S
   Contact - the contact pairs among some bodies and the method that enforces contact

   Level: beginner

.seealso: `ContactCreate()`, `ContactSetType()`, `ContactStep()`, `ContactRegister()`
S*/
typedef struct _p_Contact *Contact;

/*J
   ContactType - name of a contact method

   Values:
+ `CONTACT_SCHWARZ`              - the contact step: forces of rows by a rule and a law, also on nodes with mass
. `CONTACT_ALTERNATION`          - the Schwarz alternating method as in the paper: displacements one way, tractions the other
. `CONTACT_PENALTY`              - penalty method
. `CONTACT_LAGRANGE`             - Lagrange multipliers, implicit or forward-increment
. `CONTACT_AUGMENTED_LAGRANGIAN` - penalty method whose forces are added up until the gap is closed
- `CONTACT_FORCE`                - another name of `CONTACT_SCHWARZ`

   Level: beginner

.seealso: `ContactSetType()`
J*/
typedef const char *ContactType;
#define CONTACT_SCHWARZ              "schwarz"
#define CONTACT_ALTERNATION          "alternation"
#define CONTACT_PENALTY              "penalty"
#define CONTACT_LAGRANGE             "lagrange"
#define CONTACT_AUGMENTED_LAGRANGIAN "augmented_lagrangian"
#define CONTACT_FORCE                "force"

/*E
   ContactLaw - what contact surfaces do to each other

   Values:
+ `CONTACT_LAW_FRICTIONLESS` - they push along the normal and slide without resistance
. `CONTACT_LAW_TIED`         - nodes that lie on the partner at the start, see `ContactSetTieDistance()`, stay there: all components of the
                               displacement since then are equal
. `CONTACT_LAW_BONDED`       - they slide without resistance until they meet; a node that has been pushed against the partner stays there
                               from the next controller step on
. `CONTACT_LAW_GLUE`         - nodes that lie on the partner at the start are glued to it, by the law that `ContactSetGlueLaw()` names:
                               springs in all directions, which may break
- `CONTACT_LAW_FRICTION`     - they resist sliding, by the law that `ContactSetFrictionLaw()` names

   Level: beginner

.seealso: `ContactSetLaw()`, `ContactSetPairLaw()`, `ContactSetGlueLaw()`, `ContactSetFrictionLaw()`
E*/
typedef enum { CONTACT_LAW_FRICTIONLESS, CONTACT_LAW_TIED, CONTACT_LAW_BONDED, CONTACT_LAW_GLUE, CONTACT_LAW_FRICTION } ContactLaw;
PETSC_EXTERN const char *const ContactLaws[];

/*E
   ContactRowSide - which body of a pair has a contact row for each of its nodes

   Level: intermediate

   Values:
+  `CONTACT_ROW_SIDE_FIRST`  - the one that is named first
.  `CONTACT_ROW_SIDE_SECOND` - the one that is named second
-  `CONTACT_ROW_SIDE_FINER`  - the one whose surface is finer where the two may touch

.seealso: `ContactSetRowSide()`, `ContactSetPairRowSide()`
E*/
typedef enum { CONTACT_ROW_SIDE_FIRST, CONTACT_ROW_SIDE_SECOND, CONTACT_ROW_SIDE_FINER } ContactRowSide;
PETSC_EXTERN const char *const ContactRowSides[];

/*E
   ContactConstraint - what contact forces keep from becoming negative

   Values:
+ `CONTACT_CONSTRAINT_GAP`      - the gap
. `CONTACT_CONSTRAINT_GAP_RATE` - the rate at which the gap changes over a controller step, where bodies touch
- `CONTACT_CONSTRAINT_BOTH`     - both

   Level: intermediate

   Note:
   The condition on the rate is the persistency condition of Laursen and Chawla 1997.

.seealso: `ContactSetConstraint()`
E*/
typedef enum { CONTACT_CONSTRAINT_GAP, CONTACT_CONSTRAINT_GAP_RATE, CONTACT_CONSTRAINT_BOTH } ContactConstraint;
PETSC_EXTERN const char *const ContactConstraints[];

/*E
   ContactStabilization - what is done against chatter where contact nodes have mass

   Values:
+ `CONTACT_STABILIZATION_NONE`               - nothing
. `CONTACT_STABILIZATION_NAIVE`              - the acceleration of the nodes in contact is set to zero after each controller step
- `CONTACT_STABILIZATION_CONTACT_STABILIZED` - contact-stabilized Newmark method (Deuflhard, Krause, Ertel 2008)

   Level: intermediate

.seealso: `ContactSetStabilization()`
E*/
typedef enum { CONTACT_STABILIZATION_NONE, CONTACT_STABILIZATION_NAIVE, CONTACT_STABILIZATION_CONTACT_STABILIZED } ContactStabilization;
PETSC_EXTERN const char *const ContactStabilizations[];

/*E
   SchwarzTransmission - what Schwarz's method prescribes on both sides of the contact boundary

   Values:
+ `SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN` - displacements one way, tractions the other
. `SCHWARZ_TRANSMISSION_ROBIN`             - both ways traction and displacement, weighted by a stiffness
- `SCHWARZ_TRANSMISSION_IMPEDANCE`         - both ways traction and velocity, weighted by an impedance

   Level: intermediate

.seealso: `ContactSchwarzSetTransmission()`
E*/
typedef enum { SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN, SCHWARZ_TRANSMISSION_ROBIN, SCHWARZ_TRANSMISSION_IMPEDANCE } SchwarzTransmission;

/*E
   SchwarzPredictor - where the first sweep of a controller step starts from

   Values:
+ `SCHWARZ_PREDICTOR_LAST`        - where the contact nodes were at its start
. `SCHWARZ_PREDICTOR_TRIAL`       - where they go without contact
. `SCHWARZ_PREDICTOR_EXTRAPOLATE` - where they go with their velocity
- `SCHWARZ_PREDICTOR_INELASTIC`   - where they go with the common velocity after an inelastic collision

   Level: intermediate

.seealso: `ContactSchwarzSetPredictor()`
E*/
typedef enum {
  SCHWARZ_PREDICTOR_LAST,
  SCHWARZ_PREDICTOR_TRIAL,
  SCHWARZ_PREDICTOR_EXTRAPOLATE,
  SCHWARZ_PREDICTOR_INELASTIC
} SchwarzPredictor;

/*E
   SchwarzWaveform - how the traction of a partner with longer substeps varies in the course of them

   Values:
+ `SCHWARZ_WAVEFORM_LINEAR`   - linearly, which keeps momentum
- `SCHWARZ_WAVEFORM_CONSTANT` - not at all

   Level: advanced

.seealso: `ContactSchwarzSetTractionWaveform()`
E*/
typedef enum { SCHWARZ_WAVEFORM_LINEAR, SCHWARZ_WAVEFORM_CONSTANT } SchwarzWaveform;

/*E
   SchwarzRelaxation - relaxation of the plain alternation

   Values:
+ `SCHWARZ_RELAXATION_FIXED`  - by a given factor
- `SCHWARZ_RELAXATION_AITKEN` - by Aitken's, from the last two residuals

   Level: advanced

.seealso: `ContactSchwarzSetRelaxation()`
E*/
typedef enum { SCHWARZ_RELAXATION_FIXED, SCHWARZ_RELAXATION_AITKEN } SchwarzRelaxation;

/*E
   SchwarzConvergence - what change of position is compared with the tolerances of the outer iteration

   Values:
+ `SCHWARZ_CONVERGENCE_AUTO`             - the first of those below for the plain alternation with fixed relaxation, the last otherwise
. `SCHWARZ_CONVERGENCE_POSITION`         - of all nodes of every body, from one sweep to the next (Hoy, Tezaur, Mota)
. `SCHWARZ_CONVERGENCE_CONTACT_POSITION` - of the contact nodes of every body, from one sweep to the next
- `SCHWARZ_CONVERGENCE_MISMATCH`         - of the contact nodes, that one more plain sweep would bring

   Level: advanced

.seealso: `ContactSchwarzSetConvergence()`
E*/
typedef enum {
  SCHWARZ_CONVERGENCE_AUTO,
  SCHWARZ_CONVERGENCE_POSITION,
  SCHWARZ_CONVERGENCE_CONTACT_POSITION,
  SCHWARZ_CONVERGENCE_MISMATCH
} SchwarzConvergence;

/*E
   SchwarzUnconverged - what becomes of a controller step whose outer iteration does not converge

   Values:
+ `SCHWARZ_UNCONVERGED_ERROR`  - the run ends with an error
- `SCHWARZ_UNCONVERGED_ACCEPT` - it is accepted and counted

   Level: advanced

.seealso: `ContactSchwarzSetUnconverged()`
E*/
typedef enum { SCHWARZ_UNCONVERGED_ERROR, SCHWARZ_UNCONVERGED_ACCEPT } SchwarzUnconverged;

PETSC_EXTERN PetscClassId CONTACT_CLASSID;

/* The gap of a row, or of a pair, that has no partner opposite: larger than any gap, in whatever unit, and still a number that
   displacements can be added to */
#define CONTACT_NO_GAP 1e30

/*S
   ContactPairState - what a contact pair does at the end of a controller step

   Level: intermediate

.seealso: `ContactGetPairState()`
S*/
typedef struct {
  PetscReal force;   /* resultant of the normal contact forces, compression positive [N] */
  PetscReal gap;     /* smallest normal gap; of a chosen pair whose bodies are far apart that of their boxes as the step begins [m] */
  PetscInt  active;  /* nodes in contact */
  PetscReal tension; /* largest tensile force of a node along its normal, of ties too; 0 if there is none [N] */
  PetscReal area;    /* of the active nodes; of bars, the cross-section of the body that has the rows [m^2] */
  /* on the second body; on the first act their opposites; zeros beyond the space dimension */
  PetscReal force_vector[3]; /* resultant [N] */
  PetscReal moment[3];       /* of the forces about the origin, where the nodes that have the rows are now [N m] */
  PetscReal impulse[3];      /* integral of the resultant over the accepted controller steps, whole or cut, trapezoidal [N s] */
  PetscReal normal_impulse;  /* the same of `force` [N s] */
  PetscReal friction_loss;   /* energy that friction has taken so far [J] */
  PetscReal obstacle_work;   /* work that an obstacle whose surface moves has done so far [J] */
  PetscInt  sliding;         /* of the nodes in contact those that slide, with friction */
  PetscReal beyond_impulse;  /* what nodes beyond the end of the partner bear of that, see `TransferSetGuards()`; not trapezoidal [N s] */
} ContactPairState;

/* Overlap from which on bodies are inside each other [parts of an element]: faces that do not match leave about 0.01 */
#define CONTACT_OVERLAP 0.05

/*S
   ContactOverlap - the deepest point of a body inside another or an obstacle, or of another inside it

   Level: intermediate

.seealso: `ContactGetOverlaps()`
S*/
typedef struct {
  PetscInt  other; /* number of the other body; obstacles are counted after all bodies; -1: there is none */
  PetscReal depth; /* distance of the point from the closest face [m] */
  PetscReal part;  /* the same in parts of the smallest face there; of tied bodies what is more than at the start */
  PetscReal x[3];  /* the point [m] */
  PetscBool pair;  /* they are a contact pair */
} ContactOverlap;

/*S
   ContactCounts - how much work the steps so far took

   Level: intermediate

.seealso: `ContactGetCounts()`
S*/
typedef struct {
  PetscInt       sweeps; /* of the last step: each body integrated once; 0 without contact */
  PetscInt64     total_sweeps;
  PetscInt       unconverged_steps; /* accepted by -schwarz_unconverged accept */
  PetscInt       set_changes;       /* rounds of the active set beyond the first, all steps */
  PetscInt       set_cycles;        /* steps in which a set came up twice and a rule ended the alternation */
  PetscInt       limited_steps;     /* made again since contact would have gained energy in them */
  PetscInt       unlimited_steps;   /* of these, in which it gained energy all the same */
  PetscInt64     energy_attempts;   /* how often these were made again */
  PetscInt64     inner_iterations;  /* of conjugate gradients on the interface, with friction of GMRES */
  PetscReal      friction_least;    /* least energy that friction has taken on a row in a step, by the forces at its ends; 0 or less [J] */
  PetscInt       ambiguous_steps;   /* in which friction may have had more than one solution */
  PetscReal      friction_tilt;     /* most by which normal forces were off along surfaces, in parts of what friction can bear; statics */
  PetscReal      friction_residual; /* most by which a step has missed the law of friction, de Saxce's residual [m] */
  PetscReal      contact_loss;      /* energy that contact has taken, friction apart, where `ContactGetLossReason()` has one [J] */
  PetscReal      glue_loss;         /* energy that damage of glue has taken, see `ContactGlueBreaks()` [J] */
  PetscInt       rebuilds;          /* of the operators between contact surfaces, beyond the first */
  PetscLogDouble seconds;           /* in sweeps */
} ContactCounts;

/* What ContactFieldsCompute() gives for each node */
#define CONTACT_FIELDS_FORCE         0  /* three components [N] */
#define CONTACT_FIELDS_PRESSURE      3  /* [Pa] */
#define CONTACT_FIELDS_GAP           4  /* [m] */
#define CONTACT_FIELDS_ACTIVE        5  /* 1 in contact, else 0 */
#define CONTACT_FIELDS_TRACTION      6  /* of friction, along the surface: three components [Pa] */
#define CONTACT_FIELDS_SLIDING       9  /* 1 in contact and sliding, else 0 */
#define CONTACT_FIELDS_SLIP_DISTANCE 10 /* that it has slid in contact so far [m] */
#define CONTACT_FIELDS_FRICTION_LOSS 11 /* energy that friction has taken so far, per area [J/m^2] */
#define CONTACT_FIELDS_SIZE          12

/*S
   ContactFields - contact forces, pressures, gaps and active nodes of bodies, node by node

   Level: intermediate

.seealso: `ContactFieldsCreate()`, `ContactFieldsCompute()`
S*/
typedef struct _n_ContactFields *ContactFields;

PETSC_EXTERN PetscErrorCode ContactInitializePackage(void);
PETSC_EXTERN PetscErrorCode ContactFinalizePackage(void);
PETSC_EXTERN PetscErrorCode ContactRegister(const char[], PetscErrorCode (*)(Contact));
PETSC_EXTERN PetscErrorCode ContactRegisterAll(void);
PETSC_EXTERN PetscErrorCode ContactCreate(MPI_Comm, Contact *);
PETSC_EXTERN PetscErrorCode ContactSetBodies(Contact, PetscInt, const Body[]);
PETSC_EXTERN PetscErrorCode ContactAddObstacle(Contact, Obstacle);
PETSC_EXTERN PetscErrorCode ContactGetNumObstacles(Contact, PetscInt *);
PETSC_EXTERN PetscErrorCode ContactGetObstacle(Contact, PetscInt, Obstacle *);
PETSC_EXTERN PetscErrorCode ContactGetPairObstacle(Contact, PetscInt, PetscInt *);
PETSC_EXTERN PetscErrorCode ContactPairIsNamed(Contact, PetscInt, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactAddPair(Contact, const char[]);
PETSC_EXTERN PetscErrorCode ContactSetRowSide(Contact, ContactRowSide);
PETSC_EXTERN PetscErrorCode ContactGetRowSide(Contact, ContactRowSide *);
PETSC_EXTERN PetscErrorCode ContactSetPairRowSide(Contact, PetscInt, ContactRowSide);
PETSC_EXTERN PetscErrorCode ContactGetPairRowSide(Contact, PetscInt, PetscInt *);
PETSC_EXTERN PetscErrorCode ContactSetType(Contact, ContactType);
PETSC_EXTERN PetscErrorCode ContactGetType(Contact, ContactType *);
PETSC_EXTERN PetscErrorCode ContactSetEnergyTolerance(Contact, PetscReal);
PETSC_EXTERN PetscErrorCode ContactGetEnergyTolerance(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactSetLaw(Contact, ContactLaw);
PETSC_EXTERN PetscErrorCode ContactGetLaw(Contact, ContactLaw *);
PETSC_EXTERN PetscErrorCode ContactSetPairLaw(Contact, PetscInt, ContactLaw);
PETSC_EXTERN PetscErrorCode ContactGetPairLaw(Contact, PetscInt, ContactLaw *);
PETSC_EXTERN PetscErrorCode ContactHasLaw(Contact, ContactLaw, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactSetGlueLaw(Contact, const char[]);
PETSC_EXTERN PetscErrorCode ContactSetPairGlueLaw(Contact, PetscInt, const char[]);
PETSC_EXTERN PetscErrorCode ContactSetGlueParameter(Contact, const char[], const char[], PetscReal);
PETSC_EXTERN PetscErrorCode ContactSetPairGlueParameter(Contact, PetscInt, const char[], PetscReal);
PETSC_EXTERN PetscErrorCode ContactGlueBreaks(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactSetFrictionLaw(Contact, const char[]);
PETSC_EXTERN PetscErrorCode ContactSetPairFrictionLaw(Contact, PetscInt, const char[]);
PETSC_EXTERN PetscErrorCode ContactSetFriction(Contact, PetscReal);
PETSC_EXTERN PetscErrorCode ContactSetPairFriction(Contact, PetscInt, PetscReal);
PETSC_EXTERN PetscErrorCode ContactSetKineticFriction(Contact, PetscReal, PetscReal);
PETSC_EXTERN PetscErrorCode ContactGetFrictionLoss(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactGetObstacleWork(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactSetConstraint(Contact, ContactConstraint);
PETSC_EXTERN PetscErrorCode ContactGetConstraint(Contact, ContactConstraint *);
PETSC_EXTERN PetscErrorCode ContactSetStabilization(Contact, ContactStabilization);
PETSC_EXTERN PetscErrorCode ContactGetStabilization(Contact, ContactStabilization *);
PETSC_EXTERN PetscErrorCode ContactSetFacing(Contact, PetscBool);
PETSC_EXTERN PetscErrorCode ContactGetFacing(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactSetBounds(Contact, PetscReal, PetscReal);
PETSC_EXTERN PetscErrorCode ContactGetBounds(Contact, PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactSetAllowUnstable(Contact, PetscBool);
PETSC_EXTERN PetscErrorCode ContactGetAllowUnstable(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactSetSharedTimes(Contact, PetscBool);
PETSC_EXTERN PetscErrorCode ContactSetBalance(Contact, PetscBool);
PETSC_EXTERN PetscErrorCode ContactGetBalance(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactSetAutomaticBalance(Contact);
PETSC_EXTERN PetscErrorCode ContactGetSharedTimes(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactGetUnlimitedReason(Contact, const char *[], const char *[]);
PETSC_EXTERN PetscErrorCode ContactGetLossReason(Contact, const char *[]);
PETSC_EXTERN PetscErrorCode ContactSetBalancedStart(Contact, PetscBool);
PETSC_EXTERN PetscErrorCode ContactGetBalancedStart(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactGetParts(Contact, PetscInt *);
PETSC_EXTERN PetscErrorCode ContactSetStartEnergies(Contact, const PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactSetEnergyCap(Contact, PetscBool, PetscReal);
PETSC_EXTERN PetscErrorCode ContactGetEnergyCap(Contact, PetscBool *, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactSetTolerance(Contact, PetscReal);
PETSC_EXTERN PetscErrorCode ContactSetSeparation(Contact, PetscBool);
PETSC_EXTERN PetscErrorCode ContactGetSeparation(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactSetTieDistance(Contact, PetscReal);
PETSC_EXTERN PetscErrorCode ContactGetTieDistance(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactGetTolerance(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactSetFromOptions(Contact);
PETSC_EXTERN PetscErrorCode ContactSetUp(Contact);
PETSC_EXTERN PetscErrorCode ContactSetUpSurfaces(Contact);
PETSC_EXTERN PetscErrorCode ContactGetShare(Contact, PetscInt *, PetscInt *);
PETSC_EXTERN PetscErrorCode ContactGetResolvedStep(Contact, PetscReal *, size_t, char[]);
PETSC_EXTERN PetscErrorCode ContactCheckInitialGap(Contact);
PETSC_EXTERN PetscErrorCode ContactStep(Contact);
PETSC_EXTERN PetscErrorCode ContactAccept(Contact);
PETSC_EXTERN PetscErrorCode ContactTryStep(Contact, PetscBool, PetscReal, StepConvergedReason *);
PETSC_EXTERN PetscErrorCode ContactStepBack(Contact);
PETSC_EXTERN PetscErrorCode ContactSetStepLevel(Contact, PetscInt);
PETSC_EXTERN PetscErrorCode ContactCanCut(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactRaiseFailure(Contact, PetscInt, PetscInt);
PETSC_EXTERN PetscErrorCode ContactGetNearInertiaChange(Contact, PetscInt, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactGetOverlaps(Contact, ContactOverlap[]);
PETSC_EXTERN PetscErrorCode ContactGetOverlapName(Contact, const ContactOverlap *, const char *[]);
PETSC_EXTERN PetscErrorCode ContactGetEnergyLoss(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactGetUnresolvedEnergy(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactView(Contact, PetscViewer);
PETSC_EXTERN PetscErrorCode ContactViewFromOptions(Contact, PetscObject, const char[]);
PETSC_EXTERN PetscErrorCode ContactDestroy(Contact *);

PETSC_EXTERN PetscErrorCode ContactSchwarzSetTransmission(Contact, SchwarzTransmission);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetRobinParameter(Contact, PetscReal);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetImpedanceParameter(Contact, PetscReal);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetTraction(Contact, BodyTractionType);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetTractionWaveform(Contact, SchwarzWaveform);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetPredictor(Contact, SchwarzPredictor);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetSwapSides(Contact, PetscBool);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetRelaxation(Contact, SchwarzRelaxation);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetConvergence(Contact, SchwarzConvergence);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetUnconverged(Contact, SchwarzUnconverged);
PETSC_EXTERN PetscErrorCode ContactSchwarzSetRecheck(Contact, PetscBool);
PETSC_EXTERN PetscErrorCode ContactPenaltySetParameter(Contact, PetscReal);
PETSC_EXTERN PetscErrorCode ContactPenaltySetScale(Contact, PetscReal);
PETSC_EXTERN PetscErrorCode ContactPenaltySetDamping(Contact, PetscReal);
PETSC_EXTERN PetscErrorCode ContactPenaltySetAugmentation(Contact, PetscReal, PetscInt);

PETSC_EXTERN PetscErrorCode ContactGetNumPairs(Contact, PetscInt *);
PETSC_EXTERN PetscErrorCode ContactGetPair(Contact, PetscInt, const char *[], Body *, Body *);
PETSC_EXTERN PetscErrorCode ContactGetPairNormal(Contact, PetscInt, PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactGetPairState(Contact, PetscInt, ContactPairState *);
PETSC_EXTERN PetscErrorCode ContactGetPairStates(Contact, ContactPairState[]);
PETSC_EXTERN PetscErrorCode ContactGetPenaltyEnergy(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactGetCounts(Contact, ContactCounts *);
PETSC_EXTERN PetscErrorCode ContactGetBodyTrace(Contact, PetscInt, PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactGetBodyTraces(Contact, PetscReal[], PetscReal[]);

PETSC_EXTERN PetscErrorCode ContactFieldsCreate(Contact, ContactFields *);
PETSC_EXTERN PetscErrorCode ContactFieldsCompute(ContactFields, PetscInt, PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactFieldsDestroy(ContactFields *);
