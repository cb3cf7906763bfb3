/* The time loop over controller steps. */
#pragma once
#include <impakt/contact.h>

/*S
   Controller - advances bodies in contact from controller step to controller step, and tells observers

   Level: beginner

.seealso: `ControllerCreate()`, `ControllerSolve()`, `ControllerMonitorSet()`
S*/
typedef struct _p_Controller *Controller;

/* What a run takes of this process */
typedef struct {
  PetscLogDouble setup, wall, cpu; /* wall time of the set-up; wall and CPU time of the time loop [s] */
  PetscLogDouble memory;           /* most before there were bodies: what the process needs by itself [B] */
} ControllerCost;

PETSC_EXTERN PetscClassId CONTROLLER_CLASSID;

/*S
   ControllerSupport - what holds the bodies at a surface with prescribed displacements, or at an obstacle

   Level: intermediate

   Note:
   Forces are those on the bodies, at the end of an accepted controller step.

.seealso: `ControllerFrame`, `BodyGetReactions()`
S*/
typedef struct {
  PetscInt    body;      /* number of the body; -1: an obstacle */
  const char *name;      /* of the surface, or of the obstacle */
  PetscReal   force[3];  /* zeros beyond the space dimension [N] */
  PetscReal   moment[3]; /* about the origin, where the nodes are now [N m] */
} ControllerSupport;

/*S
   ControllerProbe - what a point of a body that is observed does at the end of an accepted controller step

   Level: intermediate

.seealso: `ControllerFrame`, `BodyAddProbe()`, `BodyGetProbes()`
S*/
typedef struct {
  PetscInt  body, number;    /* of the body, and of the point among the body's, from 0 */
  PetscReal position[3];     /* where it is now; zeros beyond the space dimension [m] */
  PetscReal displacement[3]; /* m */
  PetscReal velocity[3];     /* m/s */
  PetscReal stress[6];       /* Cauchy stress xx, yy, zz, xy, yz, xz of the elements that have it [Pa] */
} ControllerProbe;

/*S
   ControllerFrame - the state of everything at the end of an accepted controller step, as observers see it

   Level: intermediate

   Note:
   The same on every rank; arrays are owned by the controller and valid during the call.

.seealso: `ControllerMonitorSet()`
S*/
typedef struct {
  PetscInt                step;  /* 0: the initial state */
  PetscInt                steps; /* of the whole run */
  PetscReal               time;  /* s */
  PetscInt                n_bodies, n_pairs;
  const BodyMeasures     *bodies;             /* per body */
  const PetscReal        *contact_positions;  /* per body: mean position of its contact nodes, 3 numbers [m] */
  const PetscReal        *contact_velocities; /* per body: mean velocity of its contact nodes, 3 numbers [m/s] */
  const ContactPairState *pairs;              /* per pair */
  PetscInt                sweeps;             /* of this step, or of that part of it which took most */
  PetscReal               penalty_energy;     /* stored in springs between surfaces, see ContactCounts [J] */
  PetscReal uncounted_energy; /* that part of it which `energy_change` leaves out: of penalty springs, which are no glue [J] */
  PetscReal obstacle_work;    /* work of obstacles whose surface moves, see ContactCounts [J] */
  PetscReal friction_loss;    /* energy that friction has taken so far, see ContactCounts [J] */
  PetscReal glue_loss;        /* energy that damage of glue has taken so far [J] */
  PetscReal contact_loss;     /* energy that contact has taken so far by its rule, see `ContactTraits` [J] */
  PetscReal energy_change;    /* of all bodies since the start, less work done on them, with what friction, damage of glue, damping and
                                 plastic flow have taken [J] */
  PetscReal energy_scale;     /* what that is relative to: the largest so far of kinetic energy, without that of the common motion
                                 of bodies that are free, strain energy, and work done or taken [J] */
  PetscInt                 step_cuts; /* how often a step had to be cut in halves in this controller step */
  PetscInt                 n_supports;
  const ControllerSupport *supports; /* held surfaces body by body, then obstacles */
  PetscInt                 n_probes;
  const ControllerProbe   *probes; /* body by body */
} ControllerFrame;

/*S
   ControllerCuts - how often controller steps had to be cut in halves so far

   Level: intermediate

.seealso: `ControllerGetCuts()`, `ControllerSetStepCuts()`
S*/
typedef struct {
  PetscInt cuts;        /* steps, whole or cut before, that were made again in halves */
  PetscInt steps;       /* controller steps with cuts */
  PetscInt lossy_steps; /* accepted after the last cut although contact took or brought more energy than the tolerance of `ContactTraits` */
  PetscReal smallest_step; /* that has been made; the controller step if none was cut [s] */
} ControllerCuts;

/*S
   ControllerStatics - which bodies have no inertia

   Level: intermediate

.seealso: `ControllerGetStatics()`, `BodyIsStatic()`
S*/
typedef struct {
  PetscBool some, all; /* some bodies, or all, are static: momenta are kept without any alone; with all, time only counts loads */
  PetscBool balanced;  /* energies balance, but for errors. They do not where all bodies are static and contact or ties alone hold one of
                          them: while that one crosses a gap, nothing stores the work of its loads. */
} ControllerStatics;

typedef PetscErrorCode ControllerMonitorFn(Controller, const ControllerFrame *, void *);

/*S
   ControllerAfterStepFn - what is called after each accepted controller step, when all observers have been; may set `stop`

   Level: intermediate

.seealso: `ControllerSetAfterStep()`
S*/
typedef PetscErrorCode ControllerAfterStepFn(Controller, PetscInt, void *, PetscBool *);

PETSC_EXTERN PetscErrorCode ControllerInitializePackage(void);
PETSC_EXTERN PetscErrorCode ControllerCreate(MPI_Comm, Controller *);
PETSC_EXTERN PetscErrorCode ControllerAddBody(Controller, Body);
PETSC_EXTERN PetscErrorCode ControllerSetTimes(Controller, PetscReal, PetscReal, PetscReal);
PETSC_EXTERN PetscErrorCode ControllerSetStepCuts(Controller, PetscInt);
PETSC_EXTERN PetscErrorCode ControllerGetCuts(Controller, ControllerCuts *);
PETSC_EXTERN PetscErrorCode ControllerSetFromOptions(Controller);
PETSC_EXTERN PetscErrorCode ControllerSetEnergyGuard(Controller, PetscReal);
PETSC_EXTERN PetscErrorCode ControllerSetUp(Controller);
PETSC_EXTERN PetscErrorCode ControllerMonitorSet(Controller, ControllerMonitorFn *, void *, PetscErrorCode (*)(void **));
PETSC_EXTERN PetscErrorCode ControllerSetAfterStep(Controller, ControllerAfterStepFn *, void *);
PETSC_EXTERN PetscErrorCode ControllerGetStep(Controller, PetscInt *);
PETSC_EXTERN PetscErrorCode ControllerSetMonitorInterval(Controller, PetscInt);
PETSC_EXTERN PetscErrorCode ControllerCheck(Controller, PetscViewer);
PETSC_EXTERN PetscErrorCode ControllerSolve(Controller);
PETSC_EXTERN PetscErrorCode ControllerView(Controller, PetscViewer);
PETSC_EXTERN PetscErrorCode ControllerDestroy(Controller *);
PETSC_EXTERN PetscErrorCode ControllerGetBodies(Controller, PetscInt *, const Body *[]);
PETSC_EXTERN PetscErrorCode ControllerGetContact(Controller, Contact *);
PETSC_EXTERN PetscErrorCode ControllerGetProbes(Controller, PetscInt *, const ControllerProbe *[]);
PETSC_EXTERN PetscErrorCode ControllerGetSupports(Controller, PetscInt *, const ControllerSupport *[]);
PETSC_EXTERN PetscErrorCode ControllerGetStatics(Controller, ControllerStatics *);
PETSC_EXTERN PetscErrorCode ControllerGetTimes(Controller, PetscReal *, PetscReal *, PetscInt *);
PETSC_EXTERN PetscErrorCode ControllerGetResolvedStep(Controller, PetscReal *);
PETSC_EXTERN PetscErrorCode ControllerGetCost(Controller, ControllerCost *);
