/* What the implementation of a contact method needs. */
#pragma once
#include <impakt/contact.h>
#include <impakt/private/bodyrows.h>
#include <petscksp.h>
#include <petsc/private/petscimpl.h>

struct _ContactOps {
  PetscErrorCode (*setfromoptions)(Contact);
  PetscErrorCode (*setup)(Contact);
  PetscErrorCode (*step)(Contact);        /* advances all bodies from their saved states through one controller step */
  PetscErrorCode (*rowschanged)(Contact); /* called after rows have been built again: those marked as changed have new entries */
  PetscErrorCode (*accept)(Contact);      /* corrects the states at the end of a step, before the next step starts from them */
  PetscErrorCode (*view)(Contact, PetscViewer);
  PetscErrorCode (*destroy)(Contact);
};

/* Two bodies, or a body and an obstacle, that may touch */
typedef struct {
  char     *name;        /* as given: left:right */
  PetscInt  body[2];     /* numbers of the first body, which has a node for each row, and of the second; n_bodies if that is an obstacle */
  PetscInt  dirichlet;   /* which of them takes displacements in this controller step: 0 or 1 */
  char     *surface[2];  /* names of the surfaces; NULL for all faces that see the other body */
  Obstacle  obstacle;    /* in place of the second body, or NULL; borrowed */
  PetscBool chosen;      /* the program has chosen the sides, not the user */
  Surface   surfaces[2]; /* those of the bodies */
  Transfer  transfer;    /* between the surfaces */
  PetscInt  components;  /* rows of each node: 1, along its normal, or one along each axis */
  PetscInt  begin, end;  /* rows of this rank: begin to end - 1 */
  PetscReal normal[3];   /* mean outward normal of the first body */
  PetscBool by_force;    /* all its rows have forces as unknowns, see SchwarzSetUpSides() */
} ContactPair;

/* Default tolerances on lengths, in parts of the size of the smallest body: see ContactGetLengthScale(). That of the outer iterations is
   1e-12 m for bars of 0.25 m, as in Hoy, Tezaur, Mota, section 4. */
#define CONTACT_POSITION_TOLERANCE     4e-12
#define CONTACT_AUGMENTATION_TOLERANCE 4e-10 /* gap that the augmented Lagrangian leaves: its rounds converge linearly only */
/* Default tolerance on contact forces, in parts of ContactGetForceScale(). A strain of 1e-17 is below all round-off: forces are found to
   their relative tolerance unless they vanish. */
#define CONTACT_FORCE_TOLERANCE 1e-17

/* The gap of a row that has no partner opposite: larger than any gap, in whatever unit, and still a number that displacements can be added
   to */
#define CONTACT_NO_GAP 1e30

/* Nodes of this rank that have rows of several pairs, see src/contact/rows/sharednodes.c */
typedef struct {
  PetscInt   n, *offsets, *rows; /* node k has the rows rows[offsets[k]] to rows[offsets[k + 1] - 1] */
  PetscBool *free_dofs;          /* per node, 3 each: its displacement along this axis is not held */
  PetscBool *left_out;           /* per entry of `rows`: the row is that of an obstacle behind another one */
  PetscReal *unit;     /* per pair: stiffness per unit of area by which unknowns in metres are multiplied to give forces [N/m^3] */
  PetscBool *answers;  /* per pair: the partner moves under forces in the same controller step */
  PetscBool  arranges; /* rows that depend on others of their node may have forces as unknowns, or be let go */
  PetscInt  *sorted;   /* work space */
} SharedNodes;

/* What the rows mean to the bodies in a controller step */
typedef enum {
  CONDITIONS_FREE,         /* all rows free */
  CONDITIONS_SCHWARZ,      /* active rows: prescribed on the Dirichlet side, forced on the Neumann side */
  CONDITIONS_ROBIN,        /* active rows: Robin rows on both sides */
  CONDITIONS_FORCES,       /* all rows forced on both sides */
  CONDITIONS_ACTIVE_FORCES /* active rows forced on both sides */
} ContactConditions;

struct _p_Contact {
  PETSCHEADER(struct _ContactOps);
  PetscInt     n_bodies, n_pairs, max_pairs, dim;
  Body        *bodies;
  BodyTraces  *traces;     /* per body, and then those of what stays where it is */
  Mat         *interfaces; /* per body: rows of all pairs */
  ContactPair *pairs;
  PetscInt     n_obstacles;
  Obstacle    *obstacles;
  ContactLaw   law;
  PetscBool    prescribes;              /* the method prescribes displacements on Dirichlet sides */
  PetscBool    facing;                  /* whole bodies come with the faces alone that see each other at the start */
  PetscReal    slip_bound, angle_bound; /* beyond which rows are built again: parts of a face, rad */
  PetscInt    *order;                   /* sweep order: Dirichlet sides before their Neumann sides */
  /* rows of this rank */
  PetscInt             n_rows, row_begin, n_all_rows;
  PetscInt            *row_pair;
  PetscReal           *initial_gap, *area;
  PetscInt            *row_dof;       /* first displacement of its node in the pair's first body, rank numbering */
  PetscReal           *row_normal;    /* its direction, 3 numbers, 0 beyond the dimension */
  PetscBool           *opposite;      /* it has anything to touch */
  PetscBool           *tied;          /* it is held whatever its force and gap */
  PetscBool           *dropped;       /* it would be one to touch, but its node is held */
  PetscBool           *heir;          /* it has been merged with dropped ones */
  PetscReal           *merged_gap;    /* added to its gap for that [m] */
  Mat                  merger;        /* dropped rows to those of their neighbours; NULL: there are none */
  Vec                  places, means; /* work space of the same sizes */
  PetscBool           *by_force;      /* its force is an unknown of the method, on both sides; NULL: of none */
  SharedNodes          shared;
  PetscBool           *changed;                 /* it has new entries */
  PetscReal           *gap_shift;               /* added to its gap when it was built again [m] */
  PetscReal           *last_gap;                /* work space: before that */
  PetscReal           *force, *gap;             /* at the end of the controller step */
  PetscReal           *saved_force, *saved_gap; /* at its start */
  PetscBool           *active, *saved_active;
  PetscBool            fades; /* rows are not let go all at once: their forces fall to zero in the course of the controller step */
  PetscInt            *release_intervals; /* per row let go in this controller step: between the times at which its force is told; else 0 */
  PetscInt             release_room;      /* times that each row has room for */
  PetscReal           *release;           /* per row: its force at these times [N] */
  BodyCondition       *conditions;        /* work space */
  PetscInt            *all_row_pair;      /* of all rows, on every rank */
  int                 *mine_active, *all_active;
  PetscMPIInt          size, *counts, *offsets;
  PetscReal           *speeds;    /* work space, per body */
  PetscReal            tolerance; /* gaps above minus this are not penetration [m] */
  PetscInt           **node_dofs; /* per body: its owned contact nodes, first displacement, rank numbering */
  PetscInt            *n_node_dofs, *n_all_nodes;
  ContactConstraint    constraint;
  ContactStabilization stabilization;
  PetscBool           *stabilized; /* work space: rows of a body in contact */
  ContactCounts        counts_made;
  PetscReal            penalty_energy;
  /* resultants of the pairs */
  PetscReal *cross_section; /* per pair: of the first body, which makes areas of `area` */
  PetscReal *sums, *maxima; /* per pair: work space */
  PetscReal *impulse;       /* per pair, this rank's share: impulse so far, force at the end of the last accepted step; 3 numbers each */
  PetscReal  step;          /* controller step [s] */
  PetscReal  length_scale, force_scale; /* of the problem, see ContactSetUpScales() [m, N] */
  PetscBool  setup;
  void      *data;
};

PETSC_INTERN PetscFunctionList ContactList;

PETSC_EXTERN PetscLogEvent CONTACT_Step, CONTACT_Sweep, CONTACT_Update;

PETSC_EXTERN PetscErrorCode ContactGetLengthScale(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactGetForceScale(Contact, PetscReal *);

/* What a method calls in a controller step */
PETSC_EXTERN PetscErrorCode ContactIntegrateFree(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactIntegrateForces(Contact, const PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactSetConditions(Contact, ContactConditions);
PETSC_EXTERN PetscErrorCode ContactComputeGaps(Contact);
PETSC_EXTERN PetscErrorCode ContactAny(Contact, PetscBool, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactOr(Contact, int *);

PETSC_INTERN PetscErrorCode ContactSetUpScales(Contact);
PETSC_INTERN PetscErrorCode ContactCheckObstacleName(Contact, const char[]);
PETSC_INTERN PetscErrorCode ContactFindDimension(Contact);
PETSC_INTERN PetscErrorCode ContactAddAllPairs(Contact);
PETSC_INTERN PetscErrorCode ContactOrderBodies(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyPairs(Contact);
PETSC_INTERN PetscErrorCode ContactSetUpRows(Contact);
PETSC_INTERN PetscErrorCode ContactSetUpObstacleTraces(Contact);
PETSC_INTERN PetscErrorCode ContactComputeStartGaps(Contact);
PETSC_INTERN PetscErrorCode ContactFindSharedNodes(Contact);
PETSC_INTERN PetscErrorCode ContactDestroySharedNodes(Contact);
PETSC_INTERN PetscErrorCode ContactLeaveOutObstacles(Contact);
PETSC_INTERN PetscErrorCode ContactSetUpSharedNodes(Contact, PetscBool);
PETSC_INTERN PetscReal      ContactForceUnit(Contact, PetscInt);
PETSC_INTERN void           ContactArrangeShared(Contact);
PETSC_INTERN PetscErrorCode ContactDropShared(Contact);
PETSC_INTERN PetscErrorCode ContactDescribeRows(Contact, const ContactPair *);
PETSC_INTERN PetscErrorCode ContactMergeDroppedRows(Contact);
PETSC_INTERN PetscErrorCode ContactMergeMatrix(Contact, Mat *);
PETSC_INTERN PetscErrorCode ContactSumMergedMoments(Contact, const ContactPair *, const PetscScalar[], const PetscScalar[], PetscReal[]);
PETSC_INTERN PetscErrorCode ContactDestroyMerger(Contact);
PETSC_INTERN PetscErrorCode ContactFillMatrices(Contact);
PETSC_INTERN PetscErrorCode ContactUpdateRows(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyRows(Contact);
PETSC_INTERN void           ContactGetConditions(Contact, ContactConditions, PetscInt, BodyCondition[]);
PETSC_INTERN PetscErrorCode ContactSetUpRelease(Contact);
PETSC_INTERN PetscErrorCode ContactBeginRelease(Contact);
PETSC_INTERN PetscErrorCode ContactReleaseRow(Contact, PetscInt, PetscBool);
PETSC_INTERN PetscBool      ContactRowFades(Contact, PetscInt);
PETSC_INTERN PetscErrorCode ContactLoadReleased(Contact, PetscInt);

PETSC_INTERN PetscErrorCode ContactSetUpResultants(Contact);
PETSC_INTERN PetscErrorCode ContactAddImpulses(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyResultants(Contact);

PETSC_INTERN PetscErrorCode ContactSetUpStabilization(Contact);
PETSC_INTERN PetscErrorCode ContactStabilize(Contact);

PETSC_INTERN PetscErrorCode ContactCreate_Schwarz(Contact);
PETSC_INTERN PetscErrorCode ContactCreate_Penalty(Contact);
PETSC_INTERN PetscErrorCode ContactCreate_Lagrange(Contact);
PETSC_INTERN PetscErrorCode ContactCreate_AugmentedLagrangian(Contact);
