#pragma once
#include <contact/activeset/rounds.h>
#include <contact/compliance/interfaceoperator.h>
#include <contact/compliance/inversemass.h>
#include <contact/compliance/outersolver.h>
#include <solver/densefactor.h>

/* How controller steps in contact are made: chosen at set-up from the bodies and the options */
typedef enum {
  SCHWARZ_MASS,     /* contact nodes of a Dirichlet side have mass: sweeps integrate the bodies, rows are let go all at once */
  SCHWARZ_BODIES,   /* sweeps integrate the bodies, since one is nonlinear or the options want it */
  SCHWARZ_CONDENSED /* sweeps run on the interface compliance of the bodies, which are all linear */
} SchwarzMode;

/* What sweeps are made on at the moment */
typedef enum {
  STEP_WHOLE,    /* the bodies */
  STEP_CONDENSED /* their compliance */
} SchwarzStep;

/* Newton's step of the outer iteration, on the active rows */
typedef struct {
  InterfaceOperator S;
  InterfaceMark    *marks;  /* of the rows of this rank */
  PetscInt          levels; /* times in the controller step at which there are forces */
  PetscInt          n;      /* rows that are solved for, of all ranks */
  const PetscInt   *rows;   /* which; owned by the operator */
  PetscBool         dense;
  PetscBool         chain;                     /* no convolution: the matrix of the whole sweep */
  DenseFactor       chained;                   /* that, levels x n */
  PetscInt          room;                      /* of the following */
  PetscScalar      *residual, *force, *change; /* levels x n, on every rank */
  Vec               probe[2];                  /* work space */
} Jacobian;

/* Up to so many unknowns matrices are dense from the start, where factoring them is cheap beside a step */
#define SCHWARZ_DENSE_ROWS 256

#define SCHWARZ_MAX_SECANTS 12

/* Changes from sweep to sweep, the newest before `next`, in units of the change of F */
typedef struct {
  PetscInt  n, next;
  PetscBool has_last;
  Vec      *dx, *df;
  Vec       last_x, last_f, rest;
  /* of the last fit: the unknowns of this rank and the pairs that took part, and factors of these */
  PetscInt    n_listed, *listed;
  PetscInt    used, which[SCHWARZ_MAX_SECANTS];
  PetscScalar factors[SCHWARZ_MAX_SECANTS];
  /* work space of a fit */
  PetscBool    whole;      /* each rank has the unknowns of all ranks that take part, as it has those of a dense Jacobian */
  PetscInt     size, room; /* unknowns of a vector; of how many there is room for */
  PetscInt    *at;         /* per listed unknown: its number among these */
  PetscScalar *vectors;    /* F, and the changes of F from the newest on */
} Secants;

/* What a group of bodies that touch each other does, see groups.c */
typedef enum {
  GROUP_FREE, /* nothing touches its one body */
  GROUP_MOVES,
  GROUP_LEFT, /* it rests before it has converged, since its active set will be another anyway: see leave.c */
  GROUP_RESTS
} GroupState;

typedef struct {
  PetscBool    on;       /* in the iteration under way */
  PetscInt     n;        /* groups with active rows */
  PetscInt    *of;       /* per body: the first body of its group, by which it is named */
  PetscBool   *rests;    /* per body: it is where its group has converged, and has nothing to do */
  GroupState  *state;    /* per group */
  PetscReal   *mismatch; /* per group, of all ranks: squared change of position in its last sweep [m^2] */
  PetscReal   *found;    /* the same, as a sweep adds it up on this rank; after these the square of all positions */
  PetscReal    position; /* square of all positions at the start of the step, of this rank [m^2] */
  PetscReal   *largest;  /* per group, of all ranks: residual of a row in the last sweep [m], and change of a force [N] */
  PetscReal   *before;   /* per group: that residual in the sweep before */
  PetscReal   *margin;   /* per group: what forces [N] and gaps [m] may still change by; 0 unless it has been left */
  PetscReal   *beyond;   /* per row: the same */
  PetscBool   *active;   /* per row: the active set that the groups belong to */
  PetscScalar *residual; /* per unknown: of the last sweep */
  int         *flags;    /* work space: two per pair */
  int         *wrong;    /* work space: per body */
} Groups;

/* What is remembered from step to step: of cut controller steps at each level apart */
typedef struct {
  PetscBool  begun; /* there has been a step of this level */
  Jacobian   jacobian;
  PetscBool  stale; /* the Jacobian belongs to another active set */
  Secants    secants;
  PetscBool *known;         /* per row: the bodies' compliance knows it */
  PetscBool *solved_active; /* per row: the active set that the Jacobian belongs to */
} SchwarzMemory;

typedef struct {
  /* options */
  SchwarzConvergence  convergence;
  SchwarzRelaxation   relaxation;
  BodyTractionType    traction;
  SchwarzTransmission transmission;
  SchwarzPredictor    predictor;
  SchwarzWaveform     waveform;
  SchwarzCondense     condense;
  PetscReal           robin_parameter; /* N/m for each unit of area; 0: from the stiffness of the elements */
  PetscReal           impedance;       /* N s/m for each unit of area; 0: that of plane waves in the Neumann side */
  PetscInt            dense_limit;     /* unknowns of the interface up to which its matrices are dense */
  PetscBool           recheck;         /* tensile reactions leave the active set within the step */
  PetscBool           swap;            /* sides change with every controller step */
  PetscReal           atol, rtol;      /* on the change of position [m], relative */
  /* chosen at set-up; what follows is gone after a reset */
  SchwarzMode mode;
  PetscBool   exact;           /* the compliance of all bodies tells all that sweeps do */
  PetscBool   substeps;        /* a body makes several */
  PetscBool   newton;          /* the outer iteration is Newton's method */
  PetscBool   full_steps;      /* without a line search */
  PetscReal   controller_step; /* [s]; of the present level, as what is remembered below */
  PetscBool   has_forces;      /* forces are the unknowns of some rows */
  /* unknowns of the outer iteration */
  OuterSolver outer;
  PetscInt   *levels;         /* per pair: times in the controller step at which its trace is an unknown */
  PetscInt   *side_levels[2]; /* the same for each choice of sides */
  PetscInt   *room;           /* per pair: unknowns that each of its rows has room for */
  PetscInt   *offset;         /* per row: its first unknown on this rank */
  PetscInt   *all_offset;     /* per row of all ranks: its first unknown */
  /* what goes back and forth */
  PetscInt   n_traces;  /* of `trace`: two for each pair */
  Trace     *trace;     /* per pair and side, of its rows: what its unknowns put on the Dirichlet side */
  Trace     *exchange;  /* per body: what it hands to its partners */
  Trace      rate[2];   /* velocity and acceleration put on the Dirichlet sides of kinematic pairs */
  PetscBool *kinematic; /* per pair and side: velocity and acceleration of the Dirichlet side follow from its displacement */
  PetscReal *weight;    /* per row: Robin stiffness [N/m] */
  PetscReal *mass[2];   /* per row: what its body, and the partner, weigh in the inelastic predictor */
  /* Newton's step */
  Jacobian      jacobian;
  Secants       secants;
  PetscBool     stale;                     /* the Jacobian belongs to another active set */
  PetscBool    *known;                     /* per row: the bodies' compliance knows it */
  SchwarzMemory memory[STEP_MAX_CUTS + 1]; /* of other levels */
  PetscInt      level;                     /* the present one */
  Groups        groups;
  /* ties that keep their mass */
  struct {
    PetscBool    any;      /* there are ties that keep their mass, of whatever bodies */
    PetscBool    forward;  /* all ties are those of explicit bodies, see tiedexplicit.c */
    PetscScalar *drift[2]; /* per row */
  } tied;
  /* Aitken */
  PetscReal damping; /* relaxation of the last iteration */
  Vec       last_residual;
  /* the controller step under way */
  SchwarzStep step;
  PetscInt    side;      /* 0, or 1 while sides are swapped */
  PetscBool   started;   /* a step has been made */
  PetscBool   have_base; /* an integration of this step that condensed sweeps count from */
  PetscBool   iterated;  /* unknowns, forces and traces are those that the round before ended with */
  PetscBool   goes_on;   /* and the one under way goes on from these */
  Rounds      rounds;
  PetscBool  *solved_active;    /* per row: the active set that the Jacobian belongs to */
  PetscBool  *by_force;         /* per row: its unknown was a force in the last round */
  PetscBool   swept;            /* `previous` is of this step */
  PetscBool   leaves;           /* the next sweep leaves massless layers off balance, for Newton's step to find it */
  PetscReal   change, position; /* of the last sweep: the body with the worst ratio */
  PetscReal   growth;           /* of the change over that of the sweep before */
  struct {
    PetscInt     sweeps, steady; /* of this iteration; of these the last ones with steady forces and no smaller change of position */
    PetscInt     bases;          /* how often sweeps on the compliance have got a new base in this step, see BodySetBase() */
    PetscBool    rebase;         /* they need another one */
    PetscReal    least;          /* change of position in this iteration [m] */
    PetscScalar *force;          /* of the rows after the last sweep, and room for those of this one [N] */
  } stall;
  PetscBool converged;
  /* work space */
  PetscScalar *previous;   /* displacements of the rows of both bodies of each pair in the last sweep */
  PetscScalar *row_work;   /* three for each row */
  PetscReal   *kept_force; /* of the contact solution, during a free trial after it */
} Schwarz;

/* The bodies of a pair by what they take in this controller step */
static inline PetscInt DirichletBody(const ContactPair *pair)
{
  return pair->body[pair->dirichlet];
}

static inline PetscInt NeumannBody(const ContactPair *pair)
{
  return pair->body[1 - pair->dirichlet];
}

/* A contact force acts along the row with this sign on the Neumann side, against it on the Dirichlet side */
static inline PetscReal NeumannSign(const ContactPair *pair)
{
  return pair->dirichlet == 0 ? 1 : -1;
}

/* Row i of a pair has the number i - DirichletShift() among those of its Dirichlet side */
static inline PetscInt DirichletShift(const ContactPair *pair)
{
  return pair->shift[pair->dirichlet];
}
static inline PetscInt NeumannShift(const ContactPair *pair)
{
  return pair->shift[1 - pair->dirichlet];
}

/* Whether the unknown of an active row is the force that holds its Dirichlet side, in units of ContactForceUnit() */
static inline PetscBool ByForce(Contact contact, PetscInt i)
{
  return (PetscBool)(contact->end.active[i] && contact->rows.by_force[i]);
}

/* Index of a pair in arrays that have an entry for each choice of sides */
static inline PetscInt SideIndex(const Schwarz *schwarz, PetscInt p)
{
  return 2 * p + schwarz->side;
}

/* What active rows mean to the bodies */
static inline ContactConditions SchwarzConditions(const Schwarz *schwarz)
{
  return schwarz->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN ? CONDITIONS_SCHWARZ : CONDITIONS_ROBIN;
}

PETSC_INTERN PetscErrorCode ContactStep_Schwarz(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpTied(Contact);
PETSC_INTERN PetscErrorCode SchwarzStepTied(Contact);
PETSC_INTERN PetscErrorCode SchwarzAcceptTied(Contact);
PETSC_INTERN PetscErrorCode SchwarzDestroyTied(Contact);
PETSC_INTERN PetscErrorCode SchwarzTakeActiveSet(Contact, PetscBool *);
PETSC_INTERN PetscErrorCode SchwarzUpdateActiveSet(Contact, PetscBool *);
PETSC_INTERN PetscErrorCode SchwarzBreakCycle(Contact, PetscBool *);
PETSC_INTERN PetscErrorCode SchwarzSweep(SNES, Vec, Vec, void *);
PETSC_INTERN PetscErrorCode SchwarzReportByForce(Contact, PetscInt);
PETSC_INTERN PetscReal      SchwarzOffset(Contact, PetscInt, PetscReal);
PETSC_INTERN PetscErrorCode SchwarzPredict(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpTransmission(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetRobin(Contact);
PETSC_INTERN PetscReal      SchwarzResidualScale(Contact, PetscInt);
PETSC_INTERN PetscErrorCode SchwarzSetUpSides(Contact);
PETSC_INTERN PetscErrorCode SchwarzSwapSides(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpJacobian(Contact);
PETSC_INTERN PetscErrorCode SchwarzCreateJacobian(Contact);
PETSC_INTERN PetscErrorCode SchwarzMakeJacobianRoom(Jacobian *, PetscInt, PetscInt);
PETSC_INTERN PetscErrorCode SchwarzStepBack(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetStepLevel(Contact, PetscInt, PetscBool);
PETSC_INTERN PetscErrorCode SchwarzDestroyMemory(Contact);
PETSC_INTERN PetscErrorCode SchwarzTakeMemory(Contact, PetscInt, PetscBool *);
PETSC_INTERN PetscErrorCode SchwarzUpdateJacobian(Contact);
PETSC_INTERN PetscErrorCode SchwarzComputeJacobian(SNES, Vec, Mat, Mat, void *);
PETSC_INTERN PetscErrorCode SchwarzSetRoles(Contact);
PETSC_INTERN PetscErrorCode SchwarzChooseMode(Contact);
PETSC_INTERN PetscErrorCode SchwarzPreferForces(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpSecants(Contact);
PETSC_INTERN PetscErrorCode SchwarzDestroySecants(Contact);
PETSC_INTERN PetscErrorCode SchwarzApplySecants(Contact, Vec, Vec *);
PETSC_INTERN PetscErrorCode SchwarzAddSecants(Contact, Vec);
PETSC_INTERN void           SchwarzResetSecants(Contact, PetscBool);
PETSC_INTERN PetscErrorCode SchwarzSetUpGroups(Contact);
PETSC_INTERN PetscErrorCode SchwarzDestroyGroups(Contact);
PETSC_INTERN PetscErrorCode SchwarzBeginGroups(Contact);
PETSC_INTERN void           SchwarzWakeBodies(Contact);
PETSC_INTERN PetscErrorCode SchwarzFindGroups(Contact);
PETSC_INTERN PetscBool      SchwarzPairRests(Contact, PetscInt);
PETSC_INTERN PetscErrorCode SchwarzListMoving(Contact, PetscInt *, PetscInt[]);
PETSC_INTERN PetscErrorCode SchwarzHoldUnknowns(Contact, Vec);
PETSC_INTERN PetscBool      SchwarzPairMoves(Contact, PetscInt);
PETSC_INTERN PetscErrorCode SchwarzCopyResidual(Contact, PetscScalar[]);
PETSC_INTERN PetscBool      SchwarzPairTells(Contact, PetscInt);
PETSC_INTERN PetscErrorCode SchwarzSettleGroups(Contact, PetscReal[2]);
PETSC_INTERN PetscErrorCode SchwarzGetForces(Contact, PetscScalar[]);
PETSC_INTERN PetscErrorCode SchwarzComputeEnd(Contact);
PETSC_INTERN PetscErrorCode SchwarzLeaveGroups(Contact);
PETSC_INTERN PetscErrorCode SchwarzTakeMargins(Contact);
PETSC_INTERN PetscErrorCode SchwarzReadCondensation(Contact);
PETSC_INTERN PetscErrorCode SchwarzPrepareCondensed(Contact);
PETSC_INTERN PetscErrorCode SchwarzFinishCondensed(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpAitken(Contact);
PETSC_INTERN PetscErrorCode SchwarzMeasureChange(Contact, const PetscScalar[]);
PETSC_INTERN PetscErrorCode SchwarzTestConvergence(SNES, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason *, void *);
PETSC_INTERN PetscErrorCode SchwarzCheckConverged(Contact);
PETSC_INTERN PetscErrorCode SchwarzVisit(Contact, Checkpoint);
PETSC_INTERN PetscErrorCode SchwarzPack(Contact, Tables);
PETSC_INTERN PetscErrorCode SchwarzUnpack(Contact, Tables);
