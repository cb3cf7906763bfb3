#pragma once
#include <impakt/private/bodyrows.h>
#include <impakt/tssecondorder.h>
#include <petsc/private/petscimpl.h>
#include <impakt/private/elementimpl.h>
#include <solver/constrainedsolver.h>
#include <body/layout/integrator.h>

/* Displacement, velocity and acceleration of a body: what a restore brings back. */
typedef struct {
  Vec u, v, a;
} BodyState;

/* Rows of this rank within all rows, and how to have all of them on every rank. */
typedef struct {
  PetscMPIInt  size;
  PetscInt     local, global, begin;
  PetscMPIInt *counts, *offsets;
} BodyRows;

typedef struct _n_LayerElements *LayerElements;
typedef struct _n_BodyGram      *BodyGram;

struct _p_Body {
  PETSCHEADER(int);
  /* mesh and numbering: nodes of this rank are numbered owned first, then ghosts */
  DM             dm;
  PetscInt       dim;
  PetscInt       owned_nodes, local_nodes;
  DMPolytopeType cell_shape;
  PetscInt       vertex_start;
  PetscInt      *node_of_vertex;
  PetscInt      *connectivity;
  PetscReal     *coordinates;                 /* local_nodes x dim */
  PetscInt      *ghost_dofs;                  /* global numbers */
  Vec            positions;                   /* reference positions of owned nodes [m] */
  Element        element, linearized_element; /* the latter NULL until BodyPrepareLinearized() */
  Material       material, linearized_material;
  PetscBool      linear;     /* constant stiffness */
  PetscBool      linearized; /* forces are those of the linearized elements */
  /* mass */
  BodyMassType      mass_type;
  PetscBool         mass_redistribute;
  PetscBool        *in_layer;                  /* per local node: belongs to a contact surface */
  PetscInt          n_layer_dofs;              /* owned */
  PetscInt         *layer_dofs;                /* owned dof (rank numbering) of massless nodes; empty unless redistributed */
  Vec               mass_row_sum;              /* M 1: the lumped mass */
  Vec               mass_diagonal;             /* the mass matrix where it is diagonal, else NULL */
  Mat               mass_matrix;               /* the mass matrix where it is not diagonal, else NULL */
  Vec               orphan_mass;               /* of elements without inner nodes, where redistribution has put it; NULL: none [kg] */
  Vec               inverse_mass;              /* diagonal: 1/m, 0 on massless nodes */
  ConstrainedSolver mass_solver;               /* not diagonal; an implicit body makes it when first needed */
  PetscReal         total_mass, mass_shift[3]; /* [kg]; how far redistribution has moved the centre of mass [m] */
  Mat               stiffness;                 /* of the undeformed body; NULL until BodyGetStiffness() */
  /* time */
  TS             ts;
  BodyIntegrator integrator;     /* that goes with it */
  PetscReal      requested_step; /* 0: the controller step; < 0: automatic */
  PetscReal      controller_step, time_step, time_start;
  PetscInt       substeps;
  PetscReal      stable_step; /* 0 until BodyComputeStableStep() */
  /* state */
  BodyState    state, saved, substep_start; /* of the latter, u and v only, and NULL unless loads or the integrator read it */
  PetscReal    time, saved_time;
  PetscInt     step, saved_step;
  Vec          internal_force; /* at state.u */
  Vec          previous_u;     /* state.u after the last BodyIntegrate() that began at the saved state */
  PetscBool    swept;          /* previous_u holds such a state */
  Vec          kept[4];        /* displacement, velocity, acceleration, internal force put aside by BodyKeep() */
  PetscScalar *kept_traces;
  Vec          work[3];
  /* interface rows */
  Mat               interface;
  Mat               free_rows;   /* without held dofs; the same matrix where none is held */
  PetscBool         any_oblique; /* on any rank there are rows of one node that are not orthonormal */
  BodyGram          gram;        /* of prescribed rows that are not orthonormal */
  const PetscReal  *row_weights; /* of rows that depend on each other; borrowed, NULL: they are equal */
  BodyRows          rows;
  BodyCondition    *conditions;             /* local rows */
  PetscBool        *held;                   /* those that are prescribed, or Robin rows */
  PetscReal        *flexibility;            /* per local row: of its Robin spring [m/N]; 0: it is held */
  PetscReal        *robin;                  /* per local row: stiffness of its Robin spring [N/m] */
  PetscInt          n_prescribed, n_forced; /* over all ranks; Robin rows are forced ones */
  PetscInt          n_robin;
  PetscBool         prescribed_mass; /* prescribed nodes carry mass */
  BodyTractionType  traction;
  BodyTraces        traces;
  PetscInt          substep; /* 0 to substeps - 1 */
  Vec               row_vec[3];
  ConstrainedSolver solver; /* with the matrix that contact forces on the rows go through: the integrator's, made at set-up, or NULL */
  LayerElements     layer_elements; /* those that touch the massless layer; NULL: nobody balances it */
  struct _BodyCompliance *compliance;
  struct _BodyRepeat     *repeat;
  PetscBool repeats; /* the present end state is that of an integration from the saved state, under the present conditions and inputs */
  struct _BodyProbe *probe; /* room for the state while unit inputs are tried; NULL until then */
  /* loads */
  struct _BodyLoads *loads; /* conditions on surfaces and forces from outside; NULL: none */
  PetscInt           n_held;
  PetscBool          any_held;                  /* on any rank */
  const PetscInt    *held_dofs;                 /* owned dofs whose displacement is prescribed; owned by the loads */
  PetscBool          unloaded;                  /* while its compliance is probed: no forces from outside, held dofs at zero */
  Vec                applied, saved_applied;    /* forces from outside and reactions of held dofs; NULL without loads [N] */
  PetscReal          external_work, saved_work; /* done by them since the start [J] */
  PetscInt64         total_substeps;
  PetscLogDouble     seconds;
  PetscBool          setup;
};

PETSC_EXTERN PetscLogEvent BODY_Integrate, BODY_Compliance, BODY_InternalForce, BODY_LayerForce, BODY_Tangent;

PETSC_INTERN PetscErrorCode BodySetUpLayout(Body);
PETSC_INTERN PetscErrorCode BodyAnyRank(Body, PetscBool *);
PETSC_INTERN PetscErrorCode BodyGetLocalRead(Body, Vec, Vec *, const PetscScalar *[]);
PETSC_INTERN PetscErrorCode BodyRestoreLocalRead(Body, Vec, Vec *, const PetscScalar *[]);
PETSC_INTERN PetscErrorCode BodyCreateVec(Body, Vec *);
PETSC_INTERN PetscErrorCode BodySetUpMass(Body);
PETSC_INTERN PetscErrorCode BodySetUpMassSolver(Body);
PETSC_INTERN PetscErrorCode BodyGetElementMass(Body, PetscInt, PetscScalar[]);
PETSC_INTERN PetscErrorCode BodyGetStiffness(Body, Mat *);
PETSC_INTERN PetscErrorCode BodyAssembleTangent(Body, Vec, Mat);
PETSC_INTERN PetscErrorCode BodyCreateMatrix(Body, Mat *);
PETSC_INTERN PetscErrorCode BodyCheckInverted(Body);
PETSC_INTERN PetscErrorCode BodySubtractHeldInertia(Body, PetscReal, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyCheckHeld(Body);
PETSC_INTERN PetscErrorCode BodyZeroHeld(Body, Vec);
PETSC_INTERN PetscErrorCode BodyCopyHeld(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyPrescribeHeld(Body, PetscReal, Vec, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyAddExternalForce(Body, PetscReal, PetscScalar, Vec);
PETSC_INTERN PetscErrorCode BodySetUpWork(Body);
PETSC_INTERN PetscErrorCode BodyAddWork(Body, Vec);
PETSC_INTERN PetscErrorCode BodyEliminateHeld(Body, Mat);
PETSC_INTERN PetscErrorCode BodyRedistributeOrphans(Body);
PETSC_INTERN PetscErrorCode BodyGetElementDofs(Body, PetscInt, PetscInt[]);
PETSC_INTERN PetscErrorCode BodyComputeStableStep(Body);
PETSC_INTERN PetscErrorCode BodySetUpSubsteps(Body);
PETSC_INTERN PetscErrorCode BodySetUpTime(Body);
PETSC_INTERN PetscErrorCode BodyComputeInternalForce(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyGetElement(Body, Element *);
PETSC_INTERN PetscErrorCode BodySetUpLayerElements(Body, Vec);
PETSC_INTERN PetscErrorCode BodyLayerElementsDestroy(LayerElements *);
PETSC_INTERN PetscErrorCode BodyLayerLinearize(Body, Material);
PETSC_INTERN PetscErrorCode BodyCreateLayerVec(Body, Vec *);
PETSC_INTERN PetscErrorCode BodyGatherLayer(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyAssembleLayer(Body, Vec, Mat);
PETSC_INTERN PetscErrorCode BodyCreateLayerMatrix(Body, Mat *);
PETSC_INTERN void           BodyGetNearLayer(Body, PetscInt *, const PetscInt *[]);
PETSC_INTERN PetscErrorCode BodySubtractLayerForce(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyMultiplyMass(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodySolveMass(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodySolveMassOfRows(Body, const PetscScalar[], Vec);
PETSC_INTERN PetscErrorCode BodyPrescribe(Body, Trace, PetscReal, Vec);
PETSC_INTERN PetscErrorCode BodySetConstraints(Body);
PETSC_INTERN PetscErrorCode BodyAddContactForce(Body, PetscReal, PetscScalar, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyWriteTrace(Body, Mat, Vec, Trace, PetscInt);
PETSC_INTERN PetscErrorCode BodyWriteTraces(Body, PetscInt);
PETSC_INTERN PetscErrorCode BodyIntegrateWindow(Body);
PETSC_INTERN PetscErrorCode BodyCreateCompliance(Body);
PETSC_INTERN Compliance     BodyGetSharedCompliance(Body);
PETSC_INTERN PetscErrorCode BodyDestroyCompliance(Body);
PETSC_INTERN PetscErrorCode BodySetUpRepeat(Body);
PETSC_INTERN PetscErrorCode BodyRepeat(Body, PetscBool *);
PETSC_INTERN PetscErrorCode BodyNoteInputs(Body);
PETSC_INTERN PetscErrorCode BodyDestroyRepeat(Body);
PETSC_INTERN PetscErrorCode BodyDestroyProbe(Body);
PETSC_INTERN PetscErrorCode BodySetUpFreeRows(Body);
PETSC_INTERN PetscErrorCode BodySetUpGram(Body);
PETSC_INTERN PetscErrorCode BodyUpdateGram(Body);
PETSC_INTERN void           BodyUnmarkDependent(Body, PetscBool[]);
PETSC_INTERN void           BodyDivideByGram(Body, PetscScalar[]);
PETSC_INTERN PetscErrorCode BodyGramDestroy(BodyGram *);
PETSC_INTERN PetscErrorCode BodyLoadsSetFromOptions(Body);
PETSC_INTERN PetscErrorCode BodyLoadsDestroy(Body);
PETSC_INTERN PetscErrorCode BodyLoadsGetHeld(Body, PetscInt *, const PetscInt *[]);
PETSC_INTERN PetscErrorCode BodyLoadsHaveForce(Body, PetscBool *);
PETSC_INTERN PetscErrorCode BodyLoadsAddForce(Body, PetscReal, PetscScalar, Vec);
PETSC_INTERN PetscErrorCode BodyLoadsPrescribe(Body, PetscReal, Vec, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyLoadsInitialState(Body, Vec, Vec);
