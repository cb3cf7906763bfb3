/* What the implementation of a contact method needs. */
#pragma once
#include <impakt/contact.h>
#include <impakt/private/bodyfloating.h>
#include <impakt/private/bodyrows.h>
#include <impakt/private/contactsteps.h>
#include <impakt/private/transfer.h>
#include <petscksp.h>
#include <petsc/private/petscimpl.h>

typedef struct _n_Checkpoint *Checkpoint; /* src/checkpoint/checkpoint.h */
typedef struct _n_Tables     *Tables;     /* src/checkpoint/tables.h */

#define CONTACT_LAW_PARAMETERS 4 /* of a law of glue or friction, at most */

struct _ContactOps {
  PetscErrorCode (*setfromoptions)(Contact);
  PetscErrorCode (*setup)(Contact);
  PetscErrorCode (*layrows)(Contact); /* (NULL) before rows are laid again, as a step begins: where */
  PetscErrorCode (*step)(Contact);    /* advances all bodies from their saved states through one controller step */
  /* called after rows have been built again, or loaded: those marked as changed have new entries; NULL: runs with it have no checkpoints */
  PetscErrorCode (*rowschanged)(Contact);
  /* (NULL) energy that the method's springs store on a row at a gap [J]; without it nobody knows what contact gains, and it is not limited
   */
  PetscReal (*stored)(Contact, PetscInt, PetscReal);
  PetscErrorCode (*steplevel)(Contact); /* the controller step is contact->step from now on, and so is the bodies' compliance another */
  PetscErrorCode (*accept)(Contact);    /* corrects the states at the end of a step, before the next step starts from them */
  /* (NULL) what the method remembers from step to step, to or from a checkpoint; loading, after rowschanged() */
  PetscErrorCode (*visit)(Contact, Checkpoint);
  PetscErrorCode (*visitshared)(Contact, Checkpoint); /* (NULL) the same, what all ranks have */
  /* (NULL) the same, what no solver finds anew to round-off, to or from tables by which a run is continued on another number of ranks;
     loading, after visitshared() and rowschanged() */
  PetscErrorCode (*visittables)(Contact, Tables);
  PetscBool (*maybalance)(Contact); /* (NULL: not) whether gaps may be turned, see src/contact/rows/balance.c */
  /* (NULL) undoes `setup`, which follows if there are rows: pairs may come and go in the course of a run, */
  PetscErrorCode (*reset)(Contact);
  PetscBool (*mayreplacerows)(Contact); /* (NULL) if this says so */
  PetscErrorCode (*view)(Contact, PetscViewer);
  PetscErrorCode (*destroy)(Contact);
};

/* What contact forces keep from becoming negative: the gap, or, where bodies touch, the rate at which it changes over a controller step
   (the persistency condition of Laursen and Chawla 1997), or both */
typedef enum { CONTACT_CONSTRAINT_GAP, CONTACT_CONSTRAINT_GAP_RATE, CONTACT_CONSTRAINT_BOTH } ContactConstraint;
PETSC_INTERN const char *const ContactConstraints[];

/* What is done against chatter where contact nodes have mass: nothing; their acceleration is set to zero after each controller step; the
   contact-stabilized Newmark method (Deuflhard, Krause, Ertel 2008) */
typedef enum { CONTACT_STABILIZATION_NONE, CONTACT_STABILIZATION_NAIVE, CONTACT_STABILIZATION_CONTACT_STABILIZED } ContactStabilization;
PETSC_INTERN const char *const ContactStabilizations[];

/* What becomes of a controller step whose outer iteration does not converge: the run ends with an error, or it is accepted and counted */
typedef enum { SCHWARZ_UNCONVERGED_ERROR, SCHWARZ_UNCONVERGED_ACCEPT } SchwarzUnconverged;

/* Two bodies, or a body and an obstacle, that may touch */
typedef struct {
  char       *name;        /* as given: left:right */
  PetscInt    body[2];     /* numbers of the body that has a node for each row, and of the other; n_bodies if that is an obstacle */
  PetscBool   turned;      /* the body that has the rows is the one that the user names second */
  PetscInt    dirichlet;   /* which of them takes displacements in this controller step: 0 or 1 */
  char       *surface[2];  /* names of the surfaces; NULL for all faces that see the other body */
  Obstacle    obstacle;    /* in place of the second body, or NULL; borrowed */
  PetscBool   chosen;      /* the program has chosen the pair, not the user */
  const char *why;         /* why the program has the first body take displacements; NULL: the user says so */
  PetscBool   rows_second; /* the second body is to have the rows */
  Surface     surfaces[2]; /* those of the bodies */
  PetscInt    place[2];    /* these in contact->surfaces */
  Transfer    transfer;    /* between the surfaces */
  PetscBool   owned;       /* one of several ranks has all of both surfaces, and looks at them alone */
  PetscInt    components;  /* rows of each node: 1, along its normal, or as many as space has dimensions */
  PetscInt    begin, end;  /* rows of this rank: begin to end - 1 */
  PetscInt    near_begin, near_end; /* of them those near contact, in rows.near */
  PetscInt    acts_begin, acts_end; /* of these those that act, in rows.acting */
  PetscInt    shift[2];             /* row i of this rank has the number i - shift[side] among those of the body on that side */
  PetscReal   normal[3];            /* mean outward normal of the body that has the rows */
  PetscBool   bonded;     /* it is tied, or a node of it sticks already, see src/contact/rows/bonded.c: its rows stay as they are */
  PetscBool   keeps_mass; /* its nodes are tied and keep their mass, see src/contact/rows/tiedmass.c */
  PetscBool   rests;      /* one of its bodies has no inertia */
  PetscBool   ahead;      /* its rows are laid where the last attempt at the step has ended, see src/contact/rows/layahead.c */
  PetscInt    intervals;  /* of the controller step, between whose ends its force is linear */
  PetscBool   own_law;    /* it has a law of its own */
  ContactLaw  law;        /* what its surfaces do to each other */
  PetscInt    named;      /* that of glue or friction, see src/contact/laws/pairlaws.c */
  PetscReal   parameters[CONTACT_LAW_PARAMETERS]; /* its own; less than 0: those of all pairs */
} ContactPair;

/* A surface of a body, for all pairs that have the same */
typedef struct {
  PetscInt    body;
  const char *name;   /* borrowed from a pair; NULL: the whole boundary */
  PetscBool   shared; /* its faces are the same whoever the partner is */
  PetscBool   first;  /* of its body: the mean position and velocity of its nodes are in the history */
  Surface     surface;
} ContactSurface;

/* Default tolerances on lengths, in parts of the size of the smallest body: see ContactSetUpScales(). That of the outer iterations is
   1e-12 m for bars of 0.25 m, as in Hoy, Tezaur, Mota, section 4. */
#define CONTACT_POSITION_TOLERANCE     4e-12
#define CONTACT_AUGMENTATION_TOLERANCE 4e-10 /* gap that the augmented Lagrangian leaves: its rounds converge linearly only */

/* What the rows mean to the bodies in a controller step */
typedef enum {
  CONDITIONS_FREE,    /* all rows free */
  CONDITIONS_SCHWARZ, /* active rows: prescribed on the Dirichlet side, forced on the Neumann side */
  CONDITIONS_ROBIN,   /* active rows: Robin rows on both sides */
  CONDITIONS_FORCES   /* all rows forced on both sides */
} ContactConditions;

/* What the user chooses */
typedef struct {
  ContactLaw           law; /* of pairs that have none of their own */
  ContactConstraint    constraint;
  ContactStabilization stabilization;
  PetscBool            rows_second;      /* the second body of all pairs of two bodies is to have the rows */
  PetscBool            separation;       /* surfaces that have met may come apart again */
  PetscBool            facing;           /* pairs of whole bodies keep only the faces that see each other at the start */
  PetscReal            slip_bound;       /* slip after which rows are built again [parts of a face] */
  PetscReal            angle_bound;      /* turn of a normal after which they are [rad] */
  PetscBool            allow_unstable;   /* what is known to gain energy runs all the same */
  SchwarzUnconverged   unconverged;      /* what becomes of a step whose outer iteration does not converge */
  PetscBool            keep_mass;        /* contact nodes keep it where that is left to the bodies */
  PetscBool            shared_times;     /* contact holds at all times that all bodies have, not at the ends of controller steps alone */
  PetscBool            balanced_start;   /* massless nodes are brought into balance in the first state */
  PetscBool            balance;          /* forces have the same sum along the normals of both sides, see src/contact/rows/balance.c */
  PetscBool            auto_balance;     /* whether they have follows from the bodies, at the set-up */
  PetscReal            energy_tolerance; /* energy that contact may take or bring in a step before it is cut [parts of the system's] */
  PetscBool            energy_cap;       /* steps in which contact would gain more energy than it has room for are made again */
  PetscReal            energy_excess;    /* part of the energy that contact may bring out of nothing in the whole run */
  PetscReal            tolerance;        /* depth that does not yet count as penetration [m] */
  PetscReal            tie_distance;     /* gap or overlap up to which nodes are tied [parts of a face] */
  PetscInt             named;            /* law of glue or friction of pairs that have none of their own */
} ContactOptions;

/* The size of the problem, of which default tolerances are parts, see ContactSetUpScales() */
typedef struct {
  PetscReal length; /* [m] */
  PetscReal force;  /* [N] */
} ContactScale;

/* The rows: those of this rank, but for n_all */
typedef struct {
  PetscInt   n;
  PetscInt   begin;       /* global number of the first */
  PetscInt   n_all;       /* number of rows of all ranks */
  PetscInt  *pair;        /* number of its pair */
  PetscInt  *dof;         /* first displacement of its node in the pair's first body, rank numbering */
  PetscReal *normal;      /* its direction: 3 numbers, zero beyond the dimension of space */
  PetscReal *initial_gap; /* gap without displacements [m] */
  PetscReal *area;        /* area that it covers [m^2; m in 2-D, 1 in 1-D: times the cross-section of the pair] */
  PetscBool *opposite;    /* it has a partner opposite */
  PetscBool *tied;        /* it stays in contact whatever its force */
  PetscBool *changed;     /* it was built again at the start of this controller step, and has new entries */
  PetscBool *followed;    /* it has followed the surfaces, and has new entries too */
  PetscReal *gap_shift;   /* added to its gap when it was built again [m] */
  /* those that may touch, see src/contact/rows/nearrows.c */
  PetscBool lists;             /* the method looks at no others */
  PetscBool listed;            /* there may be others */
  PetscInt  n_near;            /* of this rank */
  PetscInt *near;              /* their numbers, ascending: all rows of a node, or none */
  PetscInt  n_acting, *acting; /* near rows of nodes that touch in the step, or had a force in it or the last one, or all of them */
  PetscReal near_reach;        /* others are farther away than this, of all ranks [m] */
} ContactRows;

#define CONTACT_CARRIED 8 /* kinds of values that ContactGetFields() carries from rows to nodes */

/* The rows of a body: those of the pairs that it is in */
typedef struct {
  PetscInt   n;                 /* of this rank */
  PetscInt   begin;             /* the first of them has this number among those of the body on all ranks */
  PetscInt   n_all;             /* of all ranks */
  PetscInt  *rows;              /* their numbers among the rows of this rank, ascending */
  PetscInt  *all;               /* of those of all ranks: their numbers among the rows of all ranks, ascending */
  PetscInt   n_near, *near;     /* its rows near contact: their places in `rows`, ascending */
  PetscInt   n_acting, *acting; /* those that act, the same */
  PetscReal *area;              /* as that of rows; the body borrows it */
  Vec of_rows, *of_nodes; /* work space of ContactGetFields(), a vector of rows and CONTACT_CARRIED of displacements; NULL until used */
  /* its matrix in contact->interfaces, and the spare one */
  PetscBool  affected;    /* rows have got new entries in this attempt at a controller step */
  PetscBool  rewritten;   /* they have in any attempt at it */
  PetscBool  filled;      /* the matrix has been filled in this controller step */
  PetscInt64 pattern;     /* counts how often rows have got entries in other places */
  PetscInt64 patterns[2]; /* that count for both matrices, when they were filled; -1: they are made anew */
  PetscInt64 saved;       /* that count at the start of the controller step */
} ContactBodyRows;

/* Turns of gaps with which forces have the same sum along the normals of both sides, see src/contact/rows/balance.c */
typedef struct {
  PetscInt   n;         /* of all pairs */
  PetscInt  *begin;     /* per pair: its first one; n_pairs + 1 */
  PetscReal *change;    /* by how much gaps are turned in the controller step [m] */
  PetscReal *stiffness; /* per pair: of both sides against a force on a row [N/m] */
  PetscReal *edge;      /* per pair: of an element of the coarser body [m] */
  PetscReal *turned;    /* per row: what that adds to its gap at the end of the step [m] */
} ContactTurns;

/* Which rows tie surfaces that lay on each other at the start, see src/contact/rows/ties.c */
typedef struct {
  PetscBool           *holds;    /* per row: its node was within the tie distance, whether the user holds it or not */
  PetscReal           *distance; /* per row: the gap of its node along the normal then [m] */
  PetscBool            by_mean;  /* over the substeps of a body ties with massless nodes act by their mean force, see BodySetMeanForces() */
  PetscBool            all_explicit; /* the ties that keep their mass are of explicit bodies, */
  struct _InverseMass *inverse;      /* and what forces on them do; NULL: there are none, see src/contact/rows/tiedends.c */
} ContactTies;

/* Rows whose node is held, and their heirs, see src/contact/rows/heldrows.c */
typedef struct {
  PetscBool *dropped;    /* per row: it is held, and would otherwise have a partner opposite */
  PetscBool *heir;       /* per row: it has taken over shares of dropped ones */
  PetscReal *merged_gap; /* per row: what that has added to its gap [m] */
  Mat        merger;     /* new rows by old rows; NULL if none has been dropped */
  Vec        places;     /* work space: a number for each old row */
  Vec        means;      /* work space: a number for each new row */
} ContactHeldRows;

/* The state of each row at the end of the controller step, and at its start */
typedef struct {
  PetscReal *force;  /* compression positive [N] */
  PetscReal *gap;    /* [m] */
  PetscBool *active; /* it is in contact */
} ContactState;

/* Rows and their states at the start of the controller step, before any have changed, see src/contact/rows/saverows.c */
typedef struct {
  PetscReal *state;    /* that of all rows, see ContactListRowState(); their normals come first; NULL: none have been put aside */
  PetscBool  known;    /* it has been put aside in this step; else rows have stayed in it */
  PetscInt   rebuilds; /* counted then */
} ContactSavedRows;

/* What every rank knows of the rows of all ranks */
typedef struct {
  PetscMPIInt size;        /* number of ranks */
  PetscMPIInt rank;        /* this one */
  PetscLayout layout;      /* which rank has which rows */
  PetscSF     gather;      /* brings numbers of the rows of each rank to all */
  PetscInt   *row_pair;    /* per row of all ranks: number of its pair */
  PetscInt   *visits;      /* the bodies in the order in which they are integrated where any will do, see ContactOrderVisits() */
  int        *mine_active; /* work space: what this rank sends of its rows */
  int        *all_active;  /* work space: what has been gathered of all rows */
} ContactRanks;

/* What the forces of each pair amount to */
typedef struct {
  PetscReal        *cross_section;  /* of its first body: turns lengths and points into areas */
  PetscReal        *impulse;        /* this rank's shares, see resultants.c */
  PetscReal         penalty_energy; /* energy in the penalty springs of all pairs [J] */
  PetscReal        *gaps;           /* work space */
  ContactPairState *states;         /* work space */
  MPI_Datatype      state;          /* that of a pair, */
  MPI_Op            add;            /* and how ranks add their shares of it */
} ContactResultants;

/* The search for a start of the step that keeps the energy of a group of bodies within its room, see src/contact/energy/limit.c */
typedef struct {
  PetscInt  stage;     /* see limit.c */
  PetscInt  tries;     /* of this stage */
  PetscBool done;      /* the last attempt is the step */
  PetscBool returned;  /* it has been looked for between the last two halves already */
  PetscInt  in_vain;   /* halves in succession that have brought far too little */
  PetscReal part;      /* of the force that leaving rows start with in the last attempt, or of the way back to the half before */
  PetscReal low, high; /* parts with which the energy stays within the room, and does not */
  PetscReal gain[2];   /* energy that contact has brought with them [J] */
} ContactSearch;

/* Energy that contact brings and takes, see src/contact/energy/README.md. Work on bodies is positive. */
typedef struct {
  const char    *unlimited;              /* why the method cannot have that, or NULL */
  const char    *not_always;             /* why it cannot in every step, or NULL */
  const char    *takes;                  /* what contact takes by its rule, which brings none, and what makes that less; or NULL */
  const char    *asked;                  /* an option that limits what contact brings or takes, as the user has given it, or NULL */
  PetscReal      scale;                  /* that energy [J] */
  PetscBool      begun;                  /* it is known */
  PetscBool      at_rest;                /* there is none at the start */
  PetscBool      known;                  /* the work of the present step has been computed */
  PetscBool      rebuilt;                /* rows have got new entries at the start of the present step */
  PetscBool      start_known;            /* the energies at its start have been told, see ContactSetStartEnergies() */
  PetscBool      changed;                /* the step has begun with other forces than those that the last one ended with */
  PetscBool      again;                  /* the step is made again, with other contact forces at its start */
  PetscReal      largest_force;          /* sum over all rows, of the accepted step in which it was largest [N] */
  PetscReal      work;                   /* of all accepted steps [J] */
  PetscReal      step_work;              /* of the present step [J] */
  PetscReal     *room;                   /* per body: what contact may bring it [J] */
  PetscReal     *change;                 /* per body: what its energy has changed by at the start, since this step has another size [J] */
  PetscBool      stays_whole;            /* halves of the step would have more energy from the start than there is room for */
  PetscInt      *group;                  /* per body: the first body of the group that touches in this step */
  PetscReal     *group_work;             /* per group, by its first body: work of contact in the step [J] */
  PetscReal     *first_work;             /* the same in the step as made first, less energies of bodies and springs then [J] */
  PetscReal     *pair_sums;              /* per pair, of all ranks: work in the step as made first [J]; sum of all rows' forces [N] */
  PetscReal     *start_energy;           /* per body: at the start of the step, where rows have been built again [J] */
  PetscReal     *energies;               /* per body: at the end of the step as made last [J] */
  PetscReal     *springs;                /* per pair, of all ranks: gain of the springs in the step [J]; sum of all rows' forces [N] */
  PetscReal     *last_force;             /* per row: at the end of the last step [N] */
  PetscReal     *accepted_force;         /* the same, also of rows that have been let go since, with their surfaces [N] */
  PetscReal     *last_stored;            /* per row: what springs had stored then [J] */
  PetscReal     *broken;                 /* per row: what damage of glue takes in the present step [J] */
  PetscReal     *start_force;            /* per row: that with which the step begins instead [N] */
  PetscReal     *rest;                   /* per row: the part that remains of what goes over from it as it was before it changed */
  PetscReal     *half_force, *half_rest; /* per row: the same in the last attempt by halves that is within the room */
  PetscReal     *gain_force;             /* per row: the same in the one before, which has gained too much */
  PetscReal     *last, *now;             /* work space, per row */
  PetscBool     *leaves;                 /* per row: it has left in this step, or in an attempt at it */
  ContactSearch *search;                 /* per group, by its first body */
  PetscReal     *of_group;               /* work space: three numbers per group, by its first body */
  PetscReal     *sums;                   /* work space: `BODY_MEASURE_SUMS` per body */
  BodyMeasures  *measures;               /* work space, per body */
} ContactEnergy;

/* Friction, see src/contact/laws/README.md. Arrays have a number for each row: what concerns a node is at its first one. */
typedef struct {
  PetscReal *slip;                    /* of rows across the normal: in the present step [m] */
  PetscReal *drive;                   /* the same: the part of it that the surface of an obstacle goes along itself [m] */
  PetscReal *step_loss;               /* the same: energy that the present step loses by friction [J] */
  PetscReal *loss;                    /* of nodes: the same in all accepted steps */
  PetscReal *distance;                /* of nodes: way that they have slid [m] */
  PetscReal *speed;                   /* of nodes: at which they have slid in the last accepted step [m/s] */
  PetscReal *pair_step;               /* per pair, of all ranks: energy that the present step loses by friction [J] */
  PetscReal *pair_loss;               /* the same in all accepted steps */
  PetscReal *pair_work, *pair_driven; /* per pair, of all ranks: work of an obstacle whose surface moves, in the step, and in all [J] */
  PetscBool *slides;                  /* of nodes, at the end of the present step */
} ContactFriction;

/* How the controller step is being made */
typedef struct {
  StepFailure failure;
  PetscBool   local;                 /* a body has been integrated whose failure one rank alone knows; until ContactAgree() */
  PetscInt    failed;                /* the first of these that has failed on this rank; PETSC_INT_MAX: none */
  PetscReal   most_loss;             /* energy that a step may take or bring at contact before it is cut, where it may be [J] */
  PetscBool   may_cut;               /* who can make the step again in halves, so that nothing is accepted that has not converged */
  PetscInt    level, accepted_level; /* how often the step is cut in halves; how often that was which was accepted last */
  PetscReal   whole_step;            /* the controller step before any cut [s] */
  PetscBool   moves_start;           /* the method changes the state that its steps start from, so that none can be made again */
  PetscBool   again; /* the step before this one began at the same state, and has failed: sides are those of this step already */
} ContactAttempt;

/* The artificial springs of a body in a controller step */
typedef struct {
  PetscInt        body;   /* its number */
  PetscInt        begin;  /* number of its first spring among all */
  BodySpringState state;  /* as the step has left it when made last */
  PetscReal       least;  /* square of the least stretch in the step [m^2] */
  PetscInt        stalls; /* times in a row that the stretch has not fallen much below that */
  PetscBool       falls;  /* the stretch is steady, since nothing resists: they leap */
  PetscReal       steady; /* square of the stretch when they have leapt last [m^2] */
  PetscReal       leap;   /* of how many times the stretch the last leap was */
} ContactSprings;

/* Static bodies that contact or ties alone hold, see src/contact/interface/floating.c */
typedef struct {
  PetscInt        n;
  ContactSprings *bodies;
  PetscInt        n_springs;       /* of all bodies; the following have a number for each */
  PetscReal      *stretch, *last;  /* as the step has left them when made last, and the time before [m] */
  PetscReal      *move;            /* by which they have been moved last [m] */
  PetscBool       leapt;           /* a body has leapt then */
  PetscInt        plain;           /* times that are made without them, since the stretch has grown */
  PetscInt        patience;        /* how many that will be when it grows again */
  PetscInt        n_known;         /* moves whose changes of the stretch are known: */
  PetscReal      *changes, *moves; /* an orthonormal basis of these; moves that bring them [m] */
  PetscReal      *forces;          /* work space, per body of the contact */
  PetscReal      *start_force;     /* per row: at the start of the step [N] */
  PetscBool      *start_active;    /* the same, in contact */
  PetscReal       time;            /* at which the step begins [s] */
} ContactFloating;

/* What is told of pairs that come and go, see src/contact/interface/told.c */
typedef struct {
  PetscInt          n;
  ContactPair      *pairs; /* their names and bodies */
  ContactPairState *gone;  /* what pairs that have gone have done, of all ranks */
} ContactTold;

/* How deep bodies are inside each other, see src/contact/interface/overlap.c */
typedef struct {
  Surface      *boundaries; /* per body: all of its faces; NULL until they are asked for */
  PetscInt      n_allowed;
  SurfaceDepth *allowed; /* overlaps of the start that are there on purpose; of infinite depth where nothing counts */
} ContactOverlaps;

/* Which bodies are near each other where pairs come and go, see src/contact/rows/neighbours.c */
typedef struct {
  PetscBool                 all;               /* the program is to choose all pairs, and has not yet */
  PetscBool                 come_and_go;       /* pairs have rows while their bodies are near */
  char                      stay[256];         /* why they have all the time, where there are many; else empty */
  struct ContactPreference *preferences;       /* per body */
  PetscInt                 *place;             /* per body: its place in the order of the bodies */
  PetscReal                *edge;              /* per body: of its contact elements [m] */
  PetscReal                *boxes;             /* per body: lower corner, and the upper one with its sign changed [m] */
  PetscReal                 near;              /* how far apart bodies may touch in a step, when pairs were looked for last [m] */
  PetscReal                 room_left;         /* by which bodies that are no pair may come nearer until they are looked for again [m] */
  PetscInt                  room, *found;      /* pairs found, by ContactNumberPair() */
  PetscInt                  n_living, *living; /* those that have rows, ascending */
  PetscReal                *lower;             /* work space, per body */
  PetscInt                 *sorted;            /* the same */
  ContactTold               told;
} ContactNeighbours;

/* How fast bodies move at the start of the step, see reach.c */
typedef struct {
  PetscReal *mean;         /* per body: mean velocity of its nodes [m/s], and their number */
  PetscReal *spread;       /* per body: the most by which the velocity of a node differs from that [m/s] */
  PetscReal *acceleration; /* per body: the largest of a node, where pairs come and go [m/s^2]; follows `spread` in memory */
} ContactReach;

/* Work space. What goes to a body has an entry for each row of that body, and room for all of this rank. */
typedef struct {
  PetscReal     *traces;        /* eight numbers per body, see ContactGetBodyTraces() */
  int           *hands_over;    /* per body: it begins the step with forces along other rows than it ends it with */
  PetscBool     *flags;         /* to a body */
  PetscReal     *last_gap;      /* per row */
  PetscReal     *tilts, *drift; /* per node of a pair */
  PetscReal     *last_force;    /* per row */
  PetscReal     *handover;      /* two numbers to a body per row */
  PetscInt      *intervals;     /* to a body */
  PetscInt      *entry_counts;  /* two numbers per row */
  PetscReal     *rest;          /* to a body */
  int           *updated;       /* per pair: what has become of its rows, see pairsupdate.c */
  PetscReal     *motion;        /* per pair: how its surfaces have moved, and whether they touch, see pairsupdate.c */
  PetscReal     *off;           /* per pair: how far planes of nodes in contact are off its partner, see layahead.c */
  BodyCondition *conditions;    /* to a body */
} ContactWork;

struct _p_Contact {
  PETSCHEADER(struct _ContactOps);
  /* The problem */
  PetscInt        n_bodies;
  Body           *bodies;
  PetscInt        dim; /* of space */
  PetscInt        n_pairs;
  ContactPair    *pairs;
  PetscInt        n_surfaces, max_surfaces;
  ContactSurface *surfaces; /* of all pairs */
  PetscInt        n_obstacles;
  Obstacle       *obstacles;
  PetscInt        parts; /* of a controller step, see ContactTraits */
  PetscReal       step;  /* one part of the controller step [s] */
  ContactOptions  options;
  ContactScale    scale;
  /* What goes between contact and bodies */
  PetscBool prescribes; /* the method prescribes displacements on Dirichlet sides */
  PetscBool impulses;   /* contact nodes with mass hit each other by impulses, and keep their mass in all of a set */
  PetscBool sideless;   /* bodies answer to forces on rows, and no more is seen of them: pairs may go round in circles, have different laws,
                           and be of rigid bodies alone */
  PetscInt         *order;      /* order of the bodies in a sweep: Dirichlet sides come before their Neumann sides */
  BodyTraces       *traces;     /* per body; the last ones are those of all obstacles, which do not move */
  ContactBodyRows  *body_rows;  /* per body */
  Mat              *interfaces; /* per body: its rows */
  Mat              *spares;     /* the same of other steps, to be filled next */
  Vec              *ends;       /* per body: where rows are laid if not where it is, as where the last attempt at the step has ended */
  PetscReal        *ahead;      /* per body: rows of all its pairs are laid where it will be in that time, by its velocities [s] */
  ContactRows       rows;
  ContactTurns      turns;
  ContactTies       ties;
  ContactHeldRows   held;
  ContactState      end;
  ContactState      start;
  ContactSavedRows  saved;
  ContactEnergy     energy;
  ContactRanks      ranks;
  ContactResultants resultants;
  ContactCounts     counts;
  ContactAttempt    attempt;
  ContactFloating   floating;
  ContactFriction   friction;
  PetscReal        *law_parameters; /* of each law of glue or friction, of pairs that have none of their own; less than 0: not set */
  ContactWork       work;
  ContactNeighbours neighbours;
  ContactReach      reach;
  ContactOverlaps   overlaps;
  PetscBool         surfaces_known; /* ContactSetUpSurfaces() has been called */
  PetscBool         setup;          /* ContactSetUp() has been called */
  void             *data;           /* what the method keeps */
};

/* What acts on the body with the rows and on its partner, in the user's order: 1, or -1 where that is turned round */
static inline PetscInt ContactPairSign(const ContactPair *pair)
{
  return pair->turned ? -1 : 1;
}

/* How many bodies have the rows of a pair: one beside an obstacle, or with both surfaces */
static inline PetscInt ContactPairBodies(const ContactPair *pair)
{
  return pair->obstacle || pair->body[0] == pair->body[1] ? 1 : 2;
}

/* Row i of a pair by the traces of its bodies, see ContactGetPairTraces() */
static inline PetscReal ContactRowSum(const ContactPair *pair, PetscScalar *const u[2], PetscInt i)
{
  return PetscRealPart(u[0][i - pair->shift[0]] + u[1][i - pair->shift[1]]);
}

/* The first row of the node that row i belongs to: that along its normal, unless the node is tied */
static inline PetscInt ContactFirstRow(Contact contact, PetscInt i)
{
  const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];

  return i - (i - pair->begin) % pair->components;
}

/* Whether a row lies across the normal of a node and has a force by friction alone */
static inline PetscBool ContactRowRubs(Contact contact, PetscInt i)
{
  return (PetscBool)(contact->pairs[contact->rows.pair[i]].law == CONTACT_LAW_FRICTION && i != ContactFirstRow(contact, i));
}

/* Whether nodes of a pair that lie on the partner at the start are held there, rigidly or by springs: their rows are along the axes */
static inline PetscBool ContactPairTies(const ContactPair *pair)
{
  return (PetscBool)(pair->law == CONTACT_LAW_TIED || pair->law == CONTACT_LAW_GLUE);
}

/* Whether any pair has a law; where there are none at present, those to come */
static inline PetscBool ContactAnyPairHas(Contact contact, ContactLaw law)
{
  if (!contact->n_pairs) return (PetscBool)(contact->options.law == law);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (contact->pairs[p].law == law) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* The same of all pairs: whether they tie what lies on each other at the start */
static inline PetscBool ContactAllPairsTie(Contact contact)
{
  if (!contact->n_pairs) return (PetscBool)(contact->options.law == CONTACT_LAW_TIED || contact->options.law == CONTACT_LAW_GLUE);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (!ContactPairTies(&contact->pairs[p])) return PETSC_FALSE;
  return PETSC_TRUE;
}

PETSC_EXTERN PetscLogEvent CONTACT_Step, CONTACT_Sweep, CONTACT_Update, CONTACT_Factor;

/* What a method calls in a controller step. After a failure there is nothing to be had from the bodies, and the step returns as soon as it
   can: ContactFailed() tells. */
PETSC_EXTERN PetscErrorCode ContactIntegrateBody(Contact, PetscInt);
PETSC_EXTERN PetscErrorCode ContactIntegrateSome(Contact, const PetscBool[]);
PETSC_EXTERN PetscErrorCode ContactIntegrateBodies(Contact);
PETSC_EXTERN PetscErrorCode ContactAgree(Contact);
PETSC_EXTERN PetscErrorCode ContactCompleteBodies(Contact);
PETSC_EXTERN PetscErrorCode ContactIntegrateFree(Contact, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactIntegrateForces(Contact, const PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactSetConditions(Contact, ContactConditions);
PETSC_EXTERN PetscErrorCode ContactComputeGaps(Contact);
PETSC_EXTERN PetscErrorCode ContactAny(Contact, PetscBool, PetscBool *);
PETSC_EXTERN PetscErrorCode ContactOr(Contact, PetscBool *);
PETSC_EXTERN PetscReal      ContactStoresNothing(Contact, PetscInt, PetscReal);
PETSC_EXTERN PetscErrorCode ContactSumStored(Contact);

/* Whether the controller step under way cannot be made; the same on every rank */
static inline PetscBool ContactFailed(Contact contact)
{
  return (PetscBool)(contact->attempt.failure.reason < 0);
}
