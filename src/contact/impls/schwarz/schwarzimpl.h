#pragma once
#include <contact/compliance/outersolver.h>

/* Rounds of the active set in one step after which something must be wrong */
#define SCHWARZ_MAX_ROUNDS 100

/* What "change of position" is compared with the tolerances */
typedef enum {
  CONVERGENCE_AUTO,             /* the first for nrichardson with fixed relaxation and sweeps of whole bodies, the last otherwise */
  CONVERGENCE_POSITION,         /* of all nodes of every body, from one sweep to the next (the paper's) */
  CONVERGENCE_CONTACT_POSITION, /* of the contact nodes of every body, from one sweep to the next */
  CONVERGENCE_MISMATCH          /* of the contact nodes, that one more plain sweep would bring: |x - G(x)| */
} ConvergenceTest;

typedef enum { RELAXATION_FIXED, RELAXATION_AITKEN } Relaxation;

typedef enum { UNCONVERGED_ERROR, UNCONVERGED_ACCEPT } Unconverged;

/* What is prescribed on both sides of the contact boundary */
typedef enum {
  TRANSMISSION_DIRICHLET_NEUMANN, /* displacements one way, tractions the other */
  TRANSMISSION_ROBIN,             /* both ways traction and displacement, weighted by a stiffness */
  TRANSMISSION_IMPEDANCE          /* both ways traction and velocity, weighted by an impedance */
} Transmission;

/* Where the first sweep of a step starts from */
typedef enum {
  PREDICTOR_LAST,        /* where the contact nodes were at its start */
  PREDICTOR_TRIAL,       /* where they go without contact */
  PREDICTOR_EXTRAPOLATE, /* where they go with their velocity */
  PREDICTOR_INELASTIC    /* where they go with the common velocity after an inelastic collision */
} Predictor;

/* How the traction of a partner with longer substeps varies in the course of them */
typedef enum { WAVEFORM_LINEAR, WAVEFORM_CONSTANT } TractionWaveform;

/* Whether the sweeps of a controller step run on the interface compliance of the bodies */
typedef enum {
  CONDENSE_NEVER,
  CONDENSE_ALWAYS,
  CONDENSE_AUTO /* in two and three dimensions, where it gives the same */
} Condense;

/* The linearised contact problem on the active rows, in terms of contact forces: what Newton's method solves */
typedef struct {
  PetscInt      n, capacity; /* active rows of all ranks; how many unknowns there is room for */
  PetscInt      n_known;     /* with those whose force fades, which come after them in `rows` */
  PetscInt     *rows, *body_rows;
  PetscInt      levels;               /* times in the controller step at which there are forces */
  PetscBool     chain;                /* no such simple form: the matrix of the whole sweep */
  PetscBool     dense, factored;      /* else conjugate gradients */
  PetscScalar  *matrices, *dirichlet; /* for each level n x n, by columns: on gaps, and on the displacement of Dirichlet sides [m/N] */
  PetscScalar  *factor;               /* LU of the first, or of the chain */
  PetscBLASInt *pivots;
  PetscScalar  *residual, *force, *change; /* levels x n */
  KSP           iterative;
  Vec           force_vec, residual_vec, work[2];
} InterfaceProblem;

#define SCHWARZ_MAX_SECANTS 12

/* Changes from sweep to sweep, the newest before `next`, in units of the change of F */
typedef struct {
  PetscInt  n, next;
  PetscBool has_last;
  Vec      *dx, *df, *basis;
  Vec       last_x, last_f, rest;
} Secants;

/* The active sets of one controller step */
typedef struct {
  PetscBool *tried;    /* those seen, one after the other */
  PetscInt   n, first; /* how many; those before the first were under another rule */
  PetscBool  cycled;   /* one has been seen twice */
  PetscBool  single;   /* one row changes in a round, not all */
  PetscInt   fewest;   /* wrong rows in any round since */
  PetscBool *kept;     /* per row: it stays held */
} Rounds;

typedef struct {
  OuterSolver         outer;
  PetscReal           atol, rtol;
  ConvergenceTest     convergence;
  Relaxation          relaxation;
  Unconverged         unconverged;
  BodyTractionType    traction;
  Transmission        transmission;
  Predictor           predictor;
  TractionWaveform    waveform;
  PetscReal           controller_step; /* [s] */
  PetscReal           robin_parameter; /* N/m for each unit of area; 0: from the stiffness of the elements */
  Condense            condense;
  PetscInt            dense_limit;   /* unknowns of the interface up to which its matrices are dense */
  PetscBool           by_compliance; /* Newton's method by the bodies' compliance; else by probing them under each set of conditions */
  PetscBool           condensed;     /* sweeps on the compliance alone */
  PetscBool           responding;    /* sweeps are, just now */
  PetscBool           have_base;     /* an integration of this step that they count from */
  PetscBool          *known;         /* per row: it is known to the bodies' compliance */
  PetscBool           has_forces;    /* forces are the unknowns of some rows */
  InterfaceProblem    problem;
  PetscBool           exact;        /* the compliance is */
  PetscBool           uses_secants; /* it is not, or not all of it is used where conjugate gradients are */
  Secants             secants;
  PetscBool           recheck;         /* tensile reactions leave the active set within the step */
  PetscBool           swap;            /* sides change with every controller step */
  PetscInt            side;            /* 0, or 1 while they are swapped */
  PetscBool           started;         /* a step has been made */
  PetscInt           *levels;          /* per pair: times in the controller step at which its trace is an unknown */
  PetscInt           *side_levels[2];  /* the same for each choice of sides */
  PetscInt           *offset;          /* per row: its first unknown on this rank */
  PetscInt           *room;            /* per pair: unknowns that each of its rows has room for */
  Trace              *trace;           /* per pair and side: what its unknowns put on the Dirichlet side */
  Trace              *exchange;        /* per body: what it hands to its partners */
  Trace               rate[2];         /* velocity and acceleration put on the Dirichlet sides of kinematic pairs */
  PetscBool          *kinematic;       /* per pair and side: velocity and acceleration of the Dirichlet side follow from its displacement */
  PetscReal          *weight;          /* per row: Robin stiffness [N/m] */
  PetscReal          *mass[2];         /* per row: of the contact element of its body and of the partner's [kg] */
  PetscScalar        *interpolated;    /* work space: per row */
  PetscScalar        *previous;        /* displacements of the rows of both bodies of each pair in the last sweep */
  PetscBool           swept;           /* they are of this step */
  PetscBool           stale;           /* the Jacobian belongs to another active set */
  PetscBool          *jacobian_active; /* per row: the set that it belongs to */
  PetscInt           *all_offset;      /* per row, all ranks: its first unknown */
  const PetscScalar **responses;       /* per body: its waveform response */
  Trace              *body_in, *body_out; /* per body: waveforms of all rows, on every rank */
  Trace              *body_exchange;
  Trace              *unit;             /* per pair and side: a unit at one of its unknowns */
  PetscReal           change, position; /* of the last sweep: the body with the worst ratio */
  PetscBool           converged;
  PetscReal           damping; /* Aitken: relaxation of the last iteration */
  Vec                 last_residual;
  Rounds              rounds;
  PetscReal          *kept_force; /* of the contact solution, during a free trial after it */
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

/* Whether the unknown of an active row is the force that holds its Dirichlet side, in units of ContactForceUnit() */
static inline PetscBool ByForce(Contact contact, PetscInt i)
{
  return (PetscBool)(contact->active[i] && contact->by_force[i]);
}

/* Index of a pair in arrays that have an entry for each choice of sides */
static inline PetscInt SideIndex(const Schwarz *schwarz, PetscInt p)
{
  return 2 * p + schwarz->side;
}

/* What active rows mean to the bodies */
static inline ContactConditions SchwarzConditions(const Schwarz *schwarz)
{
  return schwarz->transmission == TRANSMISSION_DIRICHLET_NEUMANN ? CONDITIONS_SCHWARZ : CONDITIONS_ROBIN;
}

PETSC_INTERN PetscErrorCode ContactStep_Schwarz(Contact);
PETSC_INTERN PetscErrorCode SchwarzBeginRounds(Contact);
PETSC_INTERN PetscErrorCode SchwarzBeginRound(Contact);
PETSC_INTERN PetscErrorCode SchwarzTakeActiveSet(Contact, PetscBool *);
PETSC_INTERN PetscErrorCode SchwarzUpdateActiveSet(Contact, PetscBool *);
PETSC_INTERN PetscErrorCode SchwarzBreakCycle(Contact, PetscBool *);
PETSC_INTERN PetscErrorCode SchwarzSweep(SNES, Vec, Vec, void *);
PETSC_INTERN PetscErrorCode SchwarzResampleForce(const Schwarz *, Trace, PetscInt, PetscInt, PetscScalar, Trace);
PETSC_INTERN PetscReal      SchwarzOffset(Contact, PetscInt, PetscReal);
PETSC_INTERN PetscErrorCode SchwarzPredict(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpTransmission(Contact);
PETSC_INTERN PetscReal      SchwarzResidualScale(Contact, PetscInt);
PETSC_INTERN PetscErrorCode SchwarzSetUpSides(Contact);
PETSC_INTERN PetscErrorCode SchwarzSwapSides(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpNewton(Contact);
PETSC_INTERN PetscErrorCode SchwarzDestroyNewton(Contact);
PETSC_INTERN PetscErrorCode SchwarzComputeJacobian(SNES, Vec, Mat, Mat, void *);
PETSC_INTERN PetscErrorCode SchwarzSetUpInterfaceProblem(Contact);
PETSC_INTERN PetscErrorCode SchwarzUpdateInterfaceProblem(Contact);
PETSC_INTERN PetscErrorCode SchwarzSolveIteratively(Contact, Vec, Vec);
PETSC_INTERN PetscErrorCode SchwarzDestroyInterfaceProblem(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpSecants(Contact);
PETSC_INTERN PetscErrorCode SchwarzDestroySecants(Contact);
PETSC_INTERN PetscErrorCode SchwarzApplySecants(Contact, Vec, Vec *, PetscInt *, PetscInt[], PetscScalar[]);
PETSC_INTERN void           SchwarzResetSecants(Contact, PetscBool);
PETSC_INTERN PetscErrorCode SchwarzReadCondensation(Contact);
PETSC_INTERN PetscErrorCode SchwarzChooseCondensation(Contact);
PETSC_INTERN PetscErrorCode SchwarzPrepareCondensed(Contact);
PETSC_INTERN PetscErrorCode SchwarzFinishCondensed(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpAitken(Contact);
PETSC_INTERN PetscErrorCode SchwarzMeasureChange(Contact, const PetscScalar[]);
PETSC_INTERN PetscErrorCode SchwarzTestConvergence(SNES, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason *, void *);
PETSC_INTERN PetscErrorCode SchwarzCheckConverged(Contact);
