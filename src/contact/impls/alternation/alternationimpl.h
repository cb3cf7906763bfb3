#pragma once
#include <contact/parts.h>
#include <petscsnes.h>

/* What both sides of the contact boundary get: displacements one way, tractions the other; or both ways traction and displacement, weighted
   by a stiffness, or traction and velocity, weighted by an impedance */
typedef enum { SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN, SCHWARZ_TRANSMISSION_ROBIN, SCHWARZ_TRANSMISSION_IMPEDANCE } SchwarzTransmission;

/* Where the first sweep of a controller step starts from: where the contact nodes were at its start, or go with the common velocity after
   an inelastic collision */
typedef enum { SCHWARZ_PREDICTOR_LAST, SCHWARZ_PREDICTOR_INELASTIC } SchwarzPredictor;

/* How the traction of a partner with longer substeps varies in the course of them: linearly, which keeps momentum, or not at all */
typedef enum { SCHWARZ_WAVEFORM_LINEAR, SCHWARZ_WAVEFORM_CONSTANT } SchwarzWaveform;

/* Relaxation of the plain alternation, by a given factor, or by Aitken's from the last two residuals */
typedef enum { SCHWARZ_RELAXATION_FIXED, SCHWARZ_RELAXATION_AITKEN } SchwarzRelaxation;

typedef struct {
  /* options */
  SchwarzRelaxation   relaxation;
  BodyTractionType    traction;
  SchwarzTransmission transmission;
  SchwarzPredictor    predictor;
  SchwarzWaveform     waveform;
  PetscReal           parameter;  /* of a unit of area: stiffness [N/m], or impedance [N s/m]; 0: from the elements of the Neumann side */
  PetscBool           swap;       /* sides change with every controller step */
  PetscReal           atol, rtol; /* on the change of position [m], relative */
  /* chosen at set-up */
  PetscBool mass_prescribed; /* contact nodes of a Dirichlet side have mass: they take velocity and acceleration from their partner */
  PetscReal controller_step; /* [s]; of the present level */
  PetscBool by_mismatch;     /* tolerances are for what one more plain sweep would bring at contact nodes; else, with fixed relaxation, for
                                the change of position of all nodes from one sweep to the next (Hoy, Tezaur, Mota) */
  /* unknowns of the outer iteration */
  SNES      snes;
  Vec       x, residual;
  PetscInt *levels[2]; /* per pair and choice of sides: times in the controller step at which its trace is an unknown */
  PetscInt *room;      /* per pair: unknowns that each of its rows has room for */
  PetscInt *offset;    /* per row: its first unknown on this rank */
  /* what goes back and forth */
  Trace     *trace;     /* per pair and side, of its rows: what its unknowns put on the Dirichlet side */
  Trace     *exchange;  /* per body: what it hands to its partners */
  Trace      rate[2];   /* velocity and acceleration put on the Dirichlet sides of kinematic pairs */
  PetscBool *kinematic; /* per pair and side: velocity and acceleration of the Dirichlet side follow from its displacement */
  PetscReal *weight;    /* per row: Robin stiffness [N/m] */
  PetscReal *mass[2];   /* per row: what its body, and the partner, weigh in the inelastic predictor */
  /* ties that keep their mass */
  PetscScalar *drift[2]; /* per row: see InverseMassAlign(); NULL: there are none */
  /* Aitken */
  PetscReal damping; /* relaxation of the last iteration */
  Vec       last_residual;
  /* the controller step under way */
  PetscInt *left;   /* per row: 1 once it has left in this step, 2 once it has joined again */
  PetscBool cycled; /* one has joined again */
  PetscReal change; /* of position, by the last sweep: of the body with the largest [m] */
  PetscBool converged;
  /* work space */
  PetscScalar *row_work; /* one for each row */
} Alternation;

/* The bodies of a pair by what they take in this controller step */
static inline PetscInt DirichletBody(const ContactPair *pair)
{
  return pair->body[pair->dirichlet];
}

static inline PetscInt NeumannBody(const ContactPair *pair)
{
  return pair->body[1 - pair->dirichlet];
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

/* Index of a pair in arrays that have an entry for each choice of sides */
static inline PetscInt SideIndex(Contact contact, PetscInt p)
{
  return 2 * p + contact->pairs[p].dirichlet;
}

PETSC_INTERN PetscErrorCode ContactStep_Alternation(Contact);
PETSC_INTERN PetscErrorCode AlternationSweep(SNES, Vec, Vec, void *);
PETSC_INTERN PetscReal      AlternationOffset(Contact, PetscInt, PetscReal);
PETSC_INTERN PetscErrorCode AlternationPredict(Contact);
PETSC_INTERN PetscErrorCode AlternationSetUpTransmission(Contact);
PETSC_INTERN PetscErrorCode AlternationSetStepLevel(Contact);
PETSC_INTERN PetscErrorCode AlternationSetUpSides(Contact);
PETSC_INTERN void           AlternationSwapSides(Contact);
PETSC_INTERN PetscErrorCode AlternationGetForces(Contact, PetscScalar[]);
PETSC_INTERN PetscErrorCode AlternationMeasureChange(Contact, const PetscScalar[]);
PETSC_INTERN PetscErrorCode AlternationTestConvergence(SNES, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason *, void *);
PETSC_INTERN PetscErrorCode AlternationCheckConverged(Contact);
PETSC_INTERN PetscErrorCode AlternationSetUpOuterSolver(Contact, PetscInt);
