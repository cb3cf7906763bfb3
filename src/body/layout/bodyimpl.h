#pragma once
#include <impakt/private/bodyfloating.h>
#include <impakt/private/bodyforces.h>
#include <impakt/private/bodymass.h>
#include <impakt/private/bodymeasures.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodyrows.h>
#include <impakt/private/bodystart.h>
#include <impakt/private/bodystep.h>
#include <impakt/private/bodysweeps.h>
#include <impakt/private/stepfailure.h>
#include <impakt/private/tssecondorder.h>
#include <petsc/private/petscimpl.h>
#include <impakt/private/elementimpl.h>
#include <solver/constrainedsolver.h>
#include <body/layout/integrator.h>

typedef struct _n_LayerElements *LayerElements;
typedef struct _n_LayerSolver   *LayerSolver;
typedef struct _n_MassBlocks    *MassBlocks;
typedef struct _n_BodyGram      *BodyGram;
typedef struct _n_BodyHistory   *BodyHistory;

/* Nodes of this rank are numbered owned first, then ghosts */
typedef struct {
  DM             dm;
  PetscInt       dim;
  PetscInt       owned_nodes, local_nodes; /* the latter with ghosts */
  DMPolytopeType cell_shape;
  PetscInt       vertex_start;   /* point of the first vertex in the DM */
  PetscInt      *node_of_vertex; /* of the vertices in their order */
  PetscInt      *connectivity;   /* nodes of the elements, element by element */
  /* the cells of the DM, which are the elements but for composite ones: each of these is made of several cells that follow each other */
  PetscInt    n_cells, cell_nodes, cells_of_element;
  PetscInt   *cell_connectivity; /* `connectivity`, where cells are elements */
  PetscReal  *coordinates;       /* local_nodes x dim: reference positions [m] */
  PetscInt   *ghost_dofs;        /* global numbers */
  Vec         positions;         /* reference positions of owned nodes, laid out as displacements [m] */
  PetscReal   edge;              /* of the elements, see BODY_ELEMENT_SIZE; 0 until it is asked for [m] */
  PetscBool  *on_axis;           /* of axisymmetric bodies, per local node: on x = 0, where it is held in x; NULL for others */
  PetscBool   touches_axis;      /* there are such nodes on any rank */
  PetscMPIInt n_ranks, *ranks;   /* that are to have a mesh from options among them, ascending; 0: all, or as the program has divided it */
  PetscMPIInt owner;             /* the rank that has all cells, where one has; else the first */
  PetscBool   is_owner;          /* it is this one */
  PetscBool   whole;             /* there are several ranks, of which one has all cells */
  PetscBool   ghosted;           /* on any rank there may be nodes of others */
} BodyMesh;

/* Blocks of the mesh with materials of their own, and last, where there are cells in none of them, one with the body's */
typedef struct {
  PetscInt   n, given; /* all; those that have been named */
  char     **names;    /* the last is empty where it is the body's own */
  Material  *materials;
  PetscReal *mass;          /* of each, once there are elements [kg] */
  PetscInt  *of_cell;       /* the block of each cell of this rank; NULL until they have been looked for */
  PetscInt  *of_element;    /* the block of each element, once there are elements; `of_cell`, where cells are elements */
  char      *material_name; /* of all together: what a history belongs to */
} BodyBlocks;

typedef struct {
  Element  element;
  Material material;
  Material surface_material; /* of the elements with contact nodes the stiffest, before they are known that of all; no reference; NULL: the
                                body's */
  BodyBlocks blocks;         /* n is 0 where the body has one material */
  PetscBool  linear;         /* the stiffness is constant */
  Element    linearized_element; /* NULL until BodyPrepareLinearized() */
  PetscBool  linearized;         /* forces are those of the linearized element at present */
  Mat        stiffness;          /* of the undeformed body; NULL until BodyGetStiffness() */
  PetscReal  least_inverting;    /* energy of a linear body with an element inside out, at least; 0 until BodyGetInverted() [J] */
  PetscReal  least_stretch;      /* how far the displacements of an element must differ for that, at least, see inverted.c [m] */
} BodyModel;

typedef struct {
  BodyMassType      type;
  PetscBool         redistribute; /* contact nodes become massless */
  PetscBool         near;         /* but those that face no partner at the start, which keep their mass */
  PetscBool         automatic;    /* the body chooses whether and how they become massless, see masschoice.c */
  PetscBool         decided;      /* it has */
  PetscBool         moved;        /* the mass has found a place, by a factor */
  PetscBool         chosen;       /* program or options have said whether they are massless */
  Vec               row_sum;      /* M 1: the lumped mass */
  Vec               diagonal;     /* the mass matrix where it is diagonal, else NULL */
  Mat               matrix;       /* the mass matrix where it is not diagonal, else NULL */
  Mat               product;      /* the same for products with vectors */
  PetscScalar      *diagonals;    /* the same where it is tridiagonal, of a body of one dimension on one rank, else NULL: 3 x rows */
  Mat               of_nodes;     /* the same for nodes, where it couples nodes that share no element; else NULL */
  Vec               inverse;      /* of a diagonal one: 1/m, 0 on massless nodes */
  ConstrainedSolver solver;       /* of one that is not diagonal; NULL until first needed */
  MassBlocks        blocks; /* in its place where the matrix couples nodes near the surface alone, on one rank; NULL until first needed */
  PetscReal         total;  /* [kg] */
  PetscReal         centre[3]; /* of the undeformed body [m] */
  PetscReal
      inverse_inertia[9]; /* inverse of the inertia tensor of the undeformed body about its centre; zero in one dimension [1/(kg m^2)] */
  /* of a body with a massless contact layer */
  BodyMassMoments moments;
  PetscReal      *factor;                       /* per local node: on the masses that are left; NULL: none */
  PetscReal       least_factor, largest_factor; /* on nodes with mass; 0 without a factor */
  PetscReal       shift[3];                     /* how far the centre of mass is off that of the full mass; 0: it is kept [m] */
  PetscReal       inertia_error; /* largest relative change of a moment of inertia about an axis through the centre; 0: they are kept */
  PetscReal       turn_error;    /* the same of axes about which nothing that is held keeps the body from turning */
  /* of a body that extrapolates, over all ranks */
  Mat       extrapolation;     /* E, nodes x nodes: velocities from those of inner nodes; NULL: massless nodes do not move as these */
  PetscReal extrapolated_by;   /* the largest sum of the absolute weights of a node */
  PetscInt  n_contact, n_keep; /* contact nodes; those around which inner nodes do not span the body */
  PetscReal keeps_at[3];       /* where one of the latter is [m] */
} BodyMass;

/* The contact nodes, and those of their dofs that are massless */
typedef struct {
  PetscBool    *contains;      /* per local node: it belongs to a contact surface */
  PetscReal     edge;          /* of the elements with such a node, see BODY_CONTACT_ELEMENT_SIZE; 0 until it is asked for [m] */
  PetscBool     exists;        /* some rank has massless nodes */
  PetscInt      n_dofs;        /* owned */
  PetscInt     *dofs;          /* owned dofs (rank numbering) of massless nodes that are not held; none unless mass is redistributed */
  LayerElements elements;      /* those that touch massless nodes; NULL until somebody balances them, and so is what follows */
  IS            global;        /* `dofs`, numbers in the vectors of the body */
  Vec           rhs, solution; /* work space, of the layer */
  LayerSolver   solver;        /* NULL until BodySolveLayer() */
} BodyLayer;

typedef struct {
  TS             ts;
  PetscReal      start, controller_step, step; /* of the simulation; one part of the controller step; substep [s] */
  PetscReal      whole_step;                   /* the controller step before any cut [s] */
  PetscInt       level, accepted_level; /* how often the controller step is cut in halves; how often that was which was accepted last */
  PetscReal      requested_step;        /* 0: the controller step; < 0: automatic */
  PetscReal      stable_step;           /* of the undeformed body; 0 until BodyComputeStableStep() */
  BodyStepBounds bounds;                /* the elements that bound `stable_step`, found with it */
  /* of a nonlinear explicit body, see deformedstep.c: stable step as it is deformed, 0: not known; where and when it was found last */
  PetscReal stable_now, stable_found, thinness;
  PetscInt  shared;   /* parts of the controller step, at whose ends all bodies have a time in common */
  PetscInt  substeps; /* of one part */
  PetscInt  substep;  /* the one that is being made, 0 to substeps - 1 */
  PetscBool stepped;  /* in this run: the TS has all vectors that it makes with its first step */
} BodyTime;

/* What a step starts from and ends with. A member that is NULL in one of two states is left out where one is copied to the other. */
enum { STATE_TABLE = 5, STATE_VECS = 6 }; /* how many of the vectors are in tables of a checkpoint; all */
typedef struct {
  union {
    struct {
      Vec u, v, a;
      Vec applied;        /* forces from outside and reactions of held dofs; NULL without loads [N] */
      Vec damping;        /* forces of the dashpots, against the velocity; NULL without any [N] */
      Vec internal_force; /* at u [N]; the saved state has none of its own */
    };
    Vec vecs[STATE_VECS];
  };
  PetscReal external_work; /* done by the applied forces since the start [J] */
  PetscReal damping_work;  /* taken by the dashpots since the start [J] */
  PetscReal time;
  PetscInt  step;        /* substeps since the start */
  PetscBool incomplete;  /* displacements, and internal forces on massless nodes, are there; the rest waits for BodyCompleteStep() */
  PetscBool force_known; /* the internal force of the body is known to be that of this u, see BodyFindInternalForce() */
} BodyState;

/* Contact forces that go over from the rows of the last accepted step to those of this one, see handover.c */
typedef struct {
  Mat        matrix;       /* the rows of the last accepted step; NULL before the first */
  PetscReal *before, *now; /* per local row: force at the start of the step, along the row as it was and as it is [N] */
  PetscReal *rest;         /* per local row: the part of it that remains, see BodySetStartForce() */
  PetscInt  *intervals;    /* per local row: of the waveform of its force */
  PetscReal  until;        /* position in the controller step from which on there is nothing of the old rows; 0: they are the same */
} BodyHandover;

/* What ranks tell each other before and after a step in place of within it, see exchange.c */
typedef struct {
  PetscBool open;
  PetscBool writes; /* the step has traces to be written */
  Vec       force;  /* that of contact on all nodes at its end; NULL until needed [N] */
} BodyExchange;

/* Some rows of this rank */
typedef struct {
  PetscInt n, *numbers; /* ascending */
  Mat      matrix;      /* these of the matrix; that itself where they are all */
  Vec      values;      /* work space: a number for each */
} RowList;

typedef struct {
  Mat              matrix;      /* B: rows of all ranks x displacements */
  Mat              free_matrix; /* without held dofs; the same matrix where none is held */
  Vec              free_dofs;   /* 1, 0 on held dofs; NULL until needed */
  PetscMPIInt     *changed;     /* work space, per row of all ranks */
  PetscMPIInt      size;        /* ranks */
  PetscInt         local, global, begin;
  PetscBool        at_home;     /* the mesh is whole on one of several ranks, and no other has rows */
  PetscBool        expected;    /* rows may come in the course of the run */
  BodyGram         gram;        /* of prescribed rows that are not orthonormal */
  PetscBool        any_oblique; /* on any rank it has blocks */
  PetscBool       *by_mean;     /* per local row: see BodySetMeanForces(); NULL: none */
  PetscBool        any_by_mean; /* on any rank */
  const PetscReal *weights;     /* of rows that depend on each other; borrowed, NULL: they are equal */
  BodyTractionType traction;
  PetscBool        have_mass; /* prescribed nodes carry mass, and take velocity and acceleration from their partner */
  PetscBool        tied_mass; /* rows on nodes with mass are ties: constraints in the equations of motion */
  /* conditions */
  BodyCondition *conditions;                      /* per local row */
  PetscBool     *constrained;                     /* per local row: prescribed, or a Robin row */
  PetscReal     *flexibility;                     /* per local row: of its Robin spring [m/N]; 0: it is held */
  PetscReal     *robin;                           /* per local row: stiffness of its Robin spring [N/m] */
  PetscInt       n_prescribed, n_forced, n_robin; /* over all ranks; Robin rows are forced ones */
  /* of a nonlinear body whose equations hold at a stage within the substep: forces are what they are there, and those at the end follow */
  PetscReal    stage;         /* where it is, as a part of the substep */
  Vec          stage_balance; /* forces that hold rows and held dofs at the stage; NULL: they are those at the end [N] */
  BodyHandover handover;
  BodyExchange exchange;
  /* per local row, at the end of the controller step: what the present end state was made with, and by how much that has changed since, see
     BodyRepeat(): force [N] and displacement [m] */
  PetscScalar *inputs[2], *changes[2];
  /* rows that anything happens to, see BodySetNearRows() */
  RowList        near;
  PetscBool      some_near;   /* on some rank there may be others than near ones */
  PetscBool      constant;    /* forces act that are the same throughout the controller step, see BodySetConstantForces() */
  PetscReal     *excess;      /* per local row: by how much these are more than those that the last step ended with [N] */
  PetscBool      idle;        /* these are zero; where all rows are on this rank */
  Vec            nodal_force; /* while the body is probed: acts on its nodes in the controller step; else NULL [N] */
  BodyForceShape nodal_shape; /* how */
} BodyRows;

/* What a body keeps for controller steps that have been cut in halves so many times, see src/body/interface/steplevel.c */
typedef struct {
  struct _BodyCompliance *compliance; /* NULL until there is a step of this level */
  ConstrainedSolver       solver;     /* where it depends on the step, else that of all levels */
} BodyLevel;

typedef struct {
  PetscInt        n;
  PetscBool       any;  /* there are some on any rank */
  const PetscInt *dofs; /* owned ones, rank numbering, ascending; owned by the loads */
} BodyHeld;

/* Motions of a body as if it were rigid: as many as space has translations and rotations */
#define BODY_MAX_RIGID 6

/* Artificial springs of a static body that contact or ties alone hold, see src/body/system/springs.c */
typedef struct {
  PetscReal part;                /* stiffness in parts of what the body sets against a stretch as large as itself */
  PetscInt  n;                   /* their number: as many as the body has free motions as a whole; 0: it is held */
  PetscInt  dof[BODY_MAX_RIGID]; /* per spring: the owned displacement that it pulls at (rank numbering); -1 on all other ranks */
  PetscReal stiffness;           /* of each [N/m] */
  PetscReal size;                /* of the body: the longest edge of its box [m] */
  PetscReal motions[BODY_MAX_RIGID * BODY_MAX_RIGID];    /* the free motions, springs x all rigid motions, orthonormal */
  PetscReal at_springs[BODY_MAX_RIGID * BODY_MAX_RIGID]; /* the free motions at the springs, free motions x springs */
  PetscReal start[BODY_MAX_RIGID];                       /* per spring, on every rank: displacement in the saved state [m] */
  PetscReal place[BODY_MAX_RIGID];                       /* per spring, on every rank: displacement at which it is at rest [m] */
  PetscReal reached[BODY_MAX_RIGID]; /* per spring, on every rank: displacement at the end of the step that was measured last [m] */
} BodySprings;

struct _p_Body {
  PETSCHEADER(int);
  PetscBool setup;
  PetscBool begun;        /* BodyBeginSetUp() has been called */
  PetscBool solver_begun; /* `solver` has no factors yet */
  /* The mesh is whole on one of several ranks, and steps of the integrator need nothing of others but where rows are prescribed: see
     src/body/README.md. What a substep finds out of the body as a whole (works, stable step, failure) that rank alone knows. */
  PetscBool         local;
  BodyMesh          mesh;
  BodyModel         model;
  BodyMass          mass;
  BodyLayer         layer;
  BodyTime          time;
  BodyIntegrator    integrator;
  ConstrainedSolver solver; /* with the matrix that contact forces on the rows go through: the integrator's, made at set-up, or NULL */
  BodyState         state, saved; /* as it is; at the start of the controller step */
  BodyHistory       history;      /* of the material at the points of integration; NULL where it has none */
  /* the last sums that measures are made of, and the states that they were found from */
  struct {
    PetscReal        sums[BODY_MEASURE_SUMS];
    PetscObjectState of[4]; /* of the displacement, velocity, acceleration and internal force; 0: there are none */
    PetscReal        time_step;
  } measured;
  PetscReal plastic_before; /* plastic work in the history that was done before this run [J] */
  BodyState substep_start;  /* u and v, which are NULL unless loads or the integrator read them; of one substep those of `saved` */
  /* contact forces at the start of the step that are not those of the end of the last one, see BodySetStartForce() */
  struct {
    Vec       a;       /* the saved acceleration as it was, where forces on rows may change it [m/s^2]; NULL until needed */
    Vec       change;  /* work space of BodyTurnToMeanForce() [m/s^2]; NULL until BodySetMeanForces() */
    PetscBool changed; /* the saved acceleration is not that of the last step's end */
    PetscReal energy;  /* that these forces bring to the first state, see BodyNoteStartEnergy() [J] */
  } start;
  /* of a body whose contact nodes answer by themselves, see contactnodes.c; empty until needed */
  struct {
    Vec       force; /* on contact nodes, zero but while it is divided by the mass [N] */
    PetscInt  n;     /* owned displacements of contact nodes that near rows act on */
    PetscInt *dofs;  /* rank numbering, ascending */
  } nodes;
  /* interface */
  BodyRows                rows;
  BodyTraces              traces;
  struct _BodyCompliance *compliance; /* of the present level, as is the solver */
  BodyLevel               levels[STEP_MAX_CUTS + 1];
  StepFailure             failure; /* of the last integration */
  PetscBool repeats; /* the present end state is that of an integration from the saved state, under the present conditions and inputs */
  /* loads */
  struct _BodyLoads   *loads; /* conditions on surfaces and forces from outside; NULL: none */
  BodyHeld             held;
  BodySprings          springs;
  struct _BodyPoints  *points;     /* that are observed, see src/body/interface/points.c; NULL: none */
  struct _BodyDamping *damping;    /* dashpots, see src/body/system/damping.c; NULL: none */
  PetscBool            loads_grow; /* over the first controller step, see BodyAddExternalForce() */
  PetscBool            unloaded;   /* while its compliance is probed: no forces from outside, held dofs at zero */
  /* what BodyGetPositionChange() compares with */
  struct {
    Vec       u;
    PetscBool known; /* it is of this controller step */
  } iterate;
  /* work space of one function at a time; what that function calls may overwrite it */
  struct {
    Vec nodes[3]; /* laid out as displacements */
    Vec rows[3];  /* one number for each row */
  } work;
  struct {
    PetscInt64     substeps; /* in all sweeps */
    PetscLogDouble seconds;  /* in BodyIntegrate() */
  } statistics;
};

/* Whether a step of the body is one rank's alone: then no rank waits for another in it */
static inline PetscBool BodyStepsAlone(Body body)
{
  return (PetscBool)(body->local && !body->rows.n_prescribed && !body->rows.n_robin);
}

/* Whether another rank has all there is of the body, its mesh and its rows, and makes its steps without this one: then there is nothing to
   do here but to count them. It stays so as long as the body has the same rows under the same conditions. What is left out here must create
   no object of PETSc on the communicator of the body, and use no scatter for the first time (BodyUseScatter()): both take a tag from the
   communicator, of which each rank is to have taken as many. */
static inline PetscBool BodyIsElsewhere(Body body)
{
  return (PetscBool)(BodyStepsAlone(body) && body->rows.at_home && !body->mesh.is_owner && body->time.stepped);
}

/* Whether a failure ends a step at once. With a local body the step is made to its end, in vain, so that all ranks do the same. */
static inline PetscBool BodyHasStopped(Body body)
{
  return (PetscBool)(body->failure.reason < 0 && !body->local);
}

#define BodyCheckNotSetUp(body)                                                                                                            \
  PetscCheck(!(body)->setup, PetscObjectComm((PetscObject)(body)), PETSC_ERR_ARG_WRONGSTATE, "Body '%s': call %s() before BodySetUp()",    \
             (body)->hdr.name, PETSC_FUNCTION_NAME)

PETSC_EXTERN PetscLogEvent BODY_Integrate, BODY_Compliance, BODY_InternalForce, BODY_LayerForce, BODY_Tangent;

PETSC_INTERN PetscErrorCode BodySetUpLayout(Body);
PETSC_INTERN PetscErrorCode BodyAnyRank(Body, PetscBool *);
PETSC_INTERN PetscErrorCode BodyUseScatter(VecScatter, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyGetLocalDot(Vec, Vec, PetscReal *);
PETSC_INTERN PetscErrorCode BodyGetNorm(Body, Vec, PetscReal *);
PETSC_INTERN PetscErrorCode BodyGetDot(Body, Vec, Vec, PetscReal *);
PETSC_INTERN PetscErrorCode BodyAddPendingWork(Body, PetscReal[2]);
PETSC_INTERN PetscReal      BodyShareOf(Body, PetscReal);
PETSC_INTERN PetscErrorCode BodyGetLocalRead(Body, Vec, Vec *, const PetscScalar *[]);
PETSC_INTERN PetscErrorCode BodyRestoreLocalRead(Body, Vec, Vec *, const PetscScalar *[]);
PETSC_INTERN PetscErrorCode BodyGetLocalSum(Body, Vec, Vec *, PetscScalar *[]);
PETSC_INTERN PetscErrorCode BodyRestoreLocalSum(Body, Vec, Vec *, PetscScalar *[]);
PETSC_INTERN PetscErrorCode BodyCreateVec(Body, Vec *);
PETSC_INTERN PetscErrorCode BodyStateCreate(Body, PetscBool, BodyState *);
PETSC_INTERN PetscErrorCode BodyStateCopy(Body, const BodyState *, BodyState *);
PETSC_INTERN PetscErrorCode BodyStateDestroy(BodyState *);
PETSC_INTERN PetscErrorCode BodySetUpMass(Body);
PETSC_INTERN PetscErrorCode BodyGetElementEigenvalue(Body, PetscInt, const PetscScalar[], PetscReal *);
PETSC_INTERN PetscErrorCode BodyGetStepOfEigenvalue(Body, PetscReal, PetscReal *);
PETSC_INTERN PetscErrorCode BodyEstimateElementEigenvalue(Body, PetscInt, const PetscScalar[], const PetscReal[], PetscReal *);
PETSC_INTERN PetscErrorCode BodyNoteStepBounds(Body, const PetscScalar[], const PetscReal[]);
PETSC_INTERN void           BodyGetElementCentre(Body, PetscInt, PetscReal[3]);
PETSC_INTERN PetscErrorCode BodySetUpInertia(Body);
PETSC_INTERN PetscErrorCode BodyMarkNodes(Body, PetscInt, const PetscInt[], PetscBool[]);
PETSC_INTERN PetscErrorCode BodyFindTurns(Body, PetscInt *, PetscReal[9]);
PETSC_INTERN PetscErrorCode BodySetUpMassSolver(Body);
PETSC_INTERN PetscErrorCode BodySumNodes(Body, PetscReal *, PetscReal *, PetscReal *, PetscReal[3], PetscReal[3], PetscReal[3],
                                         PetscReal[3]);
PETSC_INTERN PetscErrorCode BodyGetElementMassParts(Body, PetscInt, PetscBool, PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode BodyGetElementMass(Body, PetscInt, PetscScalar[]);
PETSC_INTERN PetscErrorCode BodyFindMassFactor(Body, PetscReal *);
PETSC_INTERN PetscErrorCode BodyCreateMassOfNodes(Body, Mat *);
PETSC_INTERN PetscErrorCode BodyExtrapolateMass(Body);
PETSC_INTERN PetscErrorCode BodyCreateMassBlocks(Body, MassBlocks *);
PETSC_INTERN PetscErrorCode BodySolveMassBlocks(Body, MassBlocks, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyDestroyMassBlocks(MassBlocks *);
PETSC_INTERN PetscErrorCode BodyGetStiffness(Body, Mat *);
PETSC_INTERN PetscErrorCode BodyEndSolver(Body);
PETSC_INTERN PetscErrorCode BodyBeginAssembly(Body, Mat, Mat *);
PETSC_INTERN PetscErrorCode BodyEndAssembly(Mat, Mat);
PETSC_INTERN PetscErrorCode BodyAssembleTangent(Body, Vec, const PetscBool[], Mat);
PETSC_INTERN PetscErrorCode BodyCreateNodeGraph(Body, const PetscBool[], Mat *);
PETSC_INTERN PetscErrorCode BodyCreateMatrix(Body, const PetscBool[], Mat *);
PETSC_INTERN PetscErrorCode BodyNoteInverted(Body, PetscBool);
PETSC_INTERN PetscErrorCode BodyFindFirstElement(Body, PetscInt, PetscMPIInt *, PetscReal[3]);
PETSC_INTERN PetscErrorCode BodyLocateLargest(Body, PetscBool, Vec, PetscInt *, PetscReal[3], PetscReal *);
PETSC_INTERN PetscErrorCode BodySubtractHeldInertia(Body, PetscReal, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyCheckHeld(Body, PetscInt *, PetscReal[]);
PETSC_INTERN PetscErrorCode BodyDescribeMotions(PetscInt, const PetscReal[], size_t, char[]);
PETSC_INTERN PetscBool      BodyIsDamped(Body);
PETSC_INTERN PetscErrorCode BodyViewDamping(Body, PetscViewer);
PETSC_INTERN PetscErrorCode BodySetUpDamping(Body);
PETSC_INTERN PetscErrorCode BodySetUpPoints(Body);
PETSC_INTERN PetscErrorCode BodyDestroyPoints(Body);
PETSC_INTERN PetscErrorCode BodyDestroyDamping(Body);
PETSC_INTERN PetscErrorCode BodyMultiplyDamping(Body, Vec, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyNoteDamping(Body);
PETSC_INTERN PetscErrorCode BodyAddDampingMatrix(Body, Vec, PetscReal, Mat);
PETSC_INTERN PetscErrorCode BodyAddDampingWork(Body);
PETSC_INTERN PetscErrorCode BodyGetPendingDampingWork(Body, PetscReal *);
PETSC_INTERN PetscErrorCode BodySetUpSprings(Body, PetscInt, const PetscReal[]);
PETSC_INTERN PetscErrorCode BodyAddSpringForce(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyAddSpringStiffness(Body, Mat);
PETSC_INTERN PetscErrorCode BodyZeroHeld(Body, Vec);
PETSC_INTERN PetscErrorCode BodyCopyHeld(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyPrescribeHeld(Body, PetscReal, Vec, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyAddExternalForce(Body, PetscReal, PetscScalar, Vec);
PETSC_INTERN PetscErrorCode BodySetUpWork(Body);
PETSC_INTERN PetscErrorCode BodyAddWork(Body, Vec);
PETSC_INTERN PetscErrorCode BodyEliminateHeld(Body, Mat);
PETSC_INTERN PetscErrorCode BodyFindExtrapolation(Body);
PETSC_INTERN PetscErrorCode BodyGetElementDofs(Body, PetscInt, PetscInt[]);
PETSC_INTERN PetscErrorCode BodyComputeStableStep(Body);
PETSC_INTERN PetscErrorCode BodyComputeStableStepAt(Body, const PetscScalar[], PetscBool, PetscReal *);
PETSC_INTERN PetscErrorCode BodyUpdateStableStep(Body);
PETSC_INTERN PetscErrorCode BodyCheckStableStep(Body);
PETSC_INTERN PetscErrorCode BodySetUpSubsteps(Body);
PETSC_INTERN PetscErrorCode BodySetUpTime(Body);
PETSC_INTERN PetscErrorCode BodyComputeInternalForce(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyFindInternalForce(Body);
PETSC_INTERN PetscErrorCode BodySetUpHistory(Body);
PETSC_INTERN PetscErrorCode BodyDestroyHistory(Body);
PETSC_INTERN PetscErrorCode BodyHistoryBegin(Body);
PETSC_INTERN PetscErrorCode BodyHistoryBeginHeld(Body);
PETSC_INTERN PetscErrorCode BodyHistoryNote(Body, Vec);
PETSC_INTERN PetscErrorCode BodyHistoryTakeEnd(Body, PetscBool *);
PETSC_INTERN PetscErrorCode BodyEndHistory(Body);
PETSC_INTERN void           BodyHistorySave(Body);
PETSC_INTERN void           BodyHistoryRestore(Body);
PETSC_INTERN void           BodyHistoryLook(Body, ElementHistory *);
PETSC_INTERN void           BodyHistoryForget(Body, ElementHistory *);
PETSC_INTERN void           BodyHistoryLookBack(Body, const ElementHistory *);
PETSC_INTERN PetscErrorCode BodyHistoryCreateBuffer(Body, PetscInt, PetscInt *, char **, PetscReal **);
PETSC_INTERN void           BodyHistoryGather(Body, PetscBool, Element, const PetscInt[], PetscReal[]);
PETSC_INTERN PetscInt       BodyHistoryGetEpoch(Body);
PETSC_INTERN PetscReal     *BodyHistoryGetSaved(Body, size_t *);
PETSC_INTERN PetscErrorCode BodyGetElement(Body, Element *);
PETSC_INTERN PetscErrorCode BodySetUpLayerElements(Body);
PETSC_INTERN PetscErrorCode BodyLayerElementsDestroy(BodyLayer *);
PETSC_INTERN PetscErrorCode BodySetUpBlocks(Body, PetscBool *);
PETSC_INTERN PetscErrorCode BodyReadBlocks(Body);
PETSC_INTERN PetscErrorCode BodyDestroyBlocks(Body);
PETSC_INTERN PetscErrorCode BodyNoteSurfaceMaterial(Body);
PETSC_INTERN PetscErrorCode BodyComputeBlockMass(Body);
PETSC_INTERN PetscErrorCode BodyViewBlocks(Body, PetscViewer);
PETSC_INTERN const char    *BodyGetMaterialName(Body);
PETSC_INTERN PetscErrorCode BodyLayerLinearize(Body);
PETSC_INTERN PetscErrorCode BodyCreateLayerVec(Body, Vec *);
PETSC_INTERN PetscErrorCode BodyGatherLayer(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodySpreadLayer(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyLayerCreateHistory(Body, PetscInt *, char **, PetscReal **);
PETSC_INTERN PetscErrorCode BodyLayerCopyHistory(Body, PetscReal[], PetscReal *);
PETSC_INTERN PetscErrorCode BodyAssembleLayer(Body, Vec, const PetscReal[], PetscReal, PetscScalar[], Mat);
PETSC_INTERN PetscErrorCode BodyCreateLayerMatrix(Body, Mat *);
PETSC_INTERN PetscErrorCode BodySubtractLayerForce(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyPrepareLayer(Body, Vec);
PETSC_INTERN PetscErrorCode BodyApplyLayerCompliance(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyReadLayer(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyWriteLayer(Body, Vec, InsertMode, Vec);
PETSC_INTERN PetscErrorCode BodySolveLayer(Body, Vec, Vec, Vec, Vec);
PETSC_INTERN PetscInt       BodyCountLayerTangents(Body);
PETSC_INTERN PetscErrorCode BodyMultiplyLayerTangent(Body, const PetscScalar[], Vec, Vec);
PETSC_INTERN PetscErrorCode BodyLayerSolverDestroy(LayerSolver *);
PETSC_INTERN PetscErrorCode BodyMultiplyMass(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyAddMassMatrix(Body, PetscReal, Mat);
PETSC_INTERN PetscErrorCode BodySolveMass(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodySolveMassOfRows(Body, const PetscScalar[], Vec);
PETSC_INTERN PetscBool      BodyAnswersByNodes(Body);
PETSC_INTERN PetscErrorCode BodyAddAnswerOfNodes(Body, const PetscScalar[], PetscBool, PetscInt, const PetscReal[], const Vec[]);
PETSC_INTERN PetscErrorCode BodyDestroyContactNodes(Body);
PETSC_INTERN PetscErrorCode BodyPrescribe(Body, Trace, PetscReal, Vec);
PETSC_INTERN PetscErrorCode BodyFreeRows(Body);
PETSC_INTERN PetscErrorCode BodySetConstraints(Body);
PETSC_INTERN PetscErrorCode BodyAddContactForce(Body, PetscReal, PetscScalar, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyHandoverEnd(Body);
PETSC_INTERN PetscBool      BodyHandsOver(Body);
PETSC_INTERN PetscErrorCode BodySetHandoverRest(Body, const PetscReal[]);
PETSC_INTERN PetscErrorCode BodyAddStoppedHandover(Body, Vec);
PETSC_INTERN PetscErrorCode BodyAddHandover(Body, PetscReal, PetscScalar, Vec);
PETSC_INTERN PetscErrorCode BodyTurnToMeanForce(Body);
PETSC_INTERN PetscErrorCode BodyEndMeanForce(Body);
PETSC_INTERN PetscErrorCode BodyReadRows(Body, Mat, Vec, PetscScalar[]);
PETSC_INTERN PetscErrorCode BodySpreadRows(Body, Mat, const PetscScalar[], Vec);
PETSC_INTERN PetscErrorCode BodyWriteTrace(Body, Mat, Vec, Trace, PetscInt);
PETSC_INTERN PetscErrorCode BodyAddNearRows(Body, const PetscScalar[], Vec);
PETSC_INTERN PetscBool      BodyNearRowsAreZero(Body, const PetscScalar[]);
PETSC_INTERN PetscErrorCode BodyListContactDofs(Body);
PETSC_INTERN PetscErrorCode BodyCopyContactNodes(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyMarkColumns(Mat, Vec);
PETSC_INTERN PetscErrorCode BodyWriteTraces(Body, PetscInt);
PETSC_INTERN PetscErrorCode BodyWriteRest(Body);
PETSC_INTERN PetscErrorCode BodyBringChanges(Body);
PETSC_INTERN PetscErrorCode BodyMakeSubsteps(Body);
PETSC_INTERN PetscErrorCode BodyFinishLayer(Body);
PETSC_INTERN PetscErrorCode BodyCheckSubstep(Body);
PETSC_INTERN PetscErrorCode BodyCreateCompliance(Body);
PETSC_INTERN PetscErrorCode BodyDestroyCompliance(Body);
PETSC_INTERN PetscErrorCode BodySetRowsOfLevels(Body, const PetscMPIInt[]);
PETSC_INTERN PetscErrorCode BodyTakeLevel(Body, PetscInt);
PETSC_INTERN PetscErrorCode BodyDestroyLevels(Body);
PETSC_INTERN PetscErrorCode BodyRepeat(Body, PetscBool *);
PETSC_INTERN PetscErrorCode BodyNoteInputs(Body);
PETSC_INTERN PetscErrorCode BodyPrepareLinearized(Body);
PETSC_INTERN PetscErrorCode BodyTryIntegrate(Body, StepConvergedReason *);
PETSC_INTERN PetscErrorCode BodyProbeNodes(Body, BodyForceShape, PetscInt, const PetscInt[], Compliance);
PETSC_INTERN PetscErrorCode BodyAnswerAtStart(Body, Vec);
PETSC_INTERN PetscErrorCode BodyNoteStart(Body);
PETSC_INTERN PetscErrorCode BodyNoteStartEnergy(Body);
PETSC_INTERN PetscErrorCode BodySumStaggering(Body, Vec, PetscReal *);
PETSC_INTERN PetscErrorCode BodyComputeForceChange(Body, PetscBool *, Vec);
PETSC_INTERN PetscErrorCode BodyCreateTraces(Body);
PETSC_INTERN PetscErrorCode BodyDestroyTraces(Body);
PETSC_INTERN PetscErrorCode BodyCreateRowArrays(Body);
PETSC_INTERN PetscErrorCode BodyDestroyRowArrays(Body);
PETSC_INTERN PetscErrorCode BodySetUpFreeRows(Body);
PETSC_INTERN PetscErrorCode BodyUpdateGram(Body);
PETSC_INTERN void           BodyUnmarkDependent(Body, PetscBool[]);
PETSC_INTERN void           BodyDivideByGram(Body, PetscScalar[]);
PETSC_INTERN PetscErrorCode BodyGramDestroy(BodyGram *);
PETSC_INTERN PetscErrorCode BodyLoadsSetFromOptions(Body);
PETSC_INTERN PetscErrorCode BodyLoadsDestroy(Body);
PETSC_INTERN PetscErrorCode BodyLoadsHoldAxis(Body);
PETSC_INTERN PetscBool      BodyIsLoaded(Body);
PETSC_INTERN PetscBool      BodyIsLed(Body);
PETSC_INTERN PetscBool      BodyLeads(Body, PetscInt);
PETSC_INTERN PetscErrorCode BodyLoadsAddForce(Body, PetscReal, PetscScalar, Vec);
PETSC_INTERN PetscErrorCode BodyLoadsPrescribe(Body, PetscReal, Vec, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyLoadsInitialState(Body, Vec, Vec);
