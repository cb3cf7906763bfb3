/* The one contact step: rows under forces, a rule for how these run within the step, a law for what they are. */
#pragma once
#include <contact/parts.h>
#include <contact/solve/lawimpl.h>
#include <contact/laws/pairlaws.h>
#include <impakt/private/bodyforces.h>

typedef struct _ContactStepper ContactStepper;

/* How forces run within a step, where rows lie, when a row counts as closed. One rule holds for each set of bodies that pairs connect. */
typedef struct {
  const char *name;
  const char *takes; /* (NULL) what closed rows take of the energy, which they bring none of, and what makes that less */
  PetscReal   ahead; /* rows are laid where bodies will be then, by their velocities [parts of the step] */
  PetscErrorCode (*begin)(Contact, ContactStepper *, const ContactPair *); /* which rows may touch, what closed rows may move */
  PetscErrorCode (*load)(Contact, ContactStepper *, PetscInt);             /* the forces `contact->end.force` on the rows of a body */
  BodyForceShape shape;                                                    /* of forces in the step */
  /* (NULL) after the first solution of the law: the way of a closed row along the normal [m], by that which its force alone makes [m] */
  PetscReal (*limit)(Contact, const ContactStepper *, PetscInt, PetscReal);
  PetscErrorCode (*more)(Contact, ContactStepper *, const ContactPair *, PetscBool *); /* (NULL) whether rows left out touch after all */
  PetscErrorCode (*end)(Contact, ContactStepper *, const ContactPair *);               /* (NULL) after the step has been made */
} ContactRule;

/* Secants of a body: forces on some of its rows, by which two passes differ, and how these rows have gone then */
typedef struct {
  PetscInt     n, row_room, *rows; /* their numbers among those of the body, ascending */
  PetscInt     n_pairs, room;      /* of numbers */
  PetscScalar *values;             /* per pair, in the order in which they were found: n forces [N], then n ways [m] */
} StepperSecants;

/* The touching rows of a body: entries of all ranks, row by row */
typedef struct {
  PetscBool      alone;            /* S needs no block of it: no node of the body answers to forces on others, or S is products */
  PetscInt       n, room;          /* rows; room for entries */
  PetscInt      *rows, *places;    /* per row: its number among those of the body, and its place among the touching ones */
  PetscInt      *begin;            /* per row: its first entry; n + 1 */
  PetscScalar   *product;          /* work space: two per row */
  PetscInt       n_dofs, *dofs;    /* displacements in which rows have entries, ascending */
  PetscInt      *columns;          /* per entry: the place of the displacement in `dofs` */
  PetscScalar   *values, *answers; /* per entry, with the sign by which the row's gap goes with the body; work space */
  PetscInt       block_room;       /* room for the block */
  PetscScalar   *block;            /* n by n, unless it is `alone`: displacements of rows by forces on them [m/N] */
  PetscScalar   *own;              /* the same, as the body has it, without secants */
  PetscBool      follows;          /* `own` is as the body has answered in some pass of the step */
  PetscBool      corrected;        /* `block` is `own` corrected by `secants`, and by no others */
  PetscBool      forgets;          /* the next step makes `block` anew */
  StepperSecants secants, kept;    /* of this step and those before it; those of accepted steps */
  Vec            force, way;       /* work space of products: of all rows of the body, or NULL */
} StepperEntries;

/* What S is made of, see assemble.c */
typedef struct {
  PetscInt        n_bodies;
  PetscInt64      of_state; /* of rows, of which bodies have been asked last */
  StepperEntries *of_body;
  Mat             product; /* R R^T, with R the rows of bodies whose nodes answer alone */
} StepperAssembly;

/* Turns of gaps, see turns.c */
typedef struct {
  /* per pair */
  PetscBool *fixed, *joined; /* it is not turned in this step; a row has joined for it */
  PetscReal *softness;       /* W, by which a turn gives [m/N] */
  /* per turn [m] */
  PetscReal *start, *read; /* t_0; with which rows have read what they have */
  /* per touching row of all ranks */
  PetscReal *uneven, *lever; /* C and L, two numbers of each */
  PetscReal *own, *shift;    /* what the diagonal of S has of turns [m/N]; by what turns have changed what is read, after the pass [m] */
  PetscInt   rounds;         /* how often the law has been solved for t_0 */
} StepperTurns;

/* Springs and dampers that users have asked for: of the penalty method, and of the augmented Lagrangian */
typedef struct {
  PetscBool any;
  PetscReal parameter; /* stiffness of springs on a unit of area [N/m^3; N/m in one dimension]; 0: from materials and elements */
  PetscReal scale;     /* of the latter; 0: by the mass of the contact nodes */
  PetscReal damping;   /* of dampers, on a unit of area [N s/m^3; N s/m in one dimension] */
  PetscReal tolerance; /* that the augmented Lagrangian leaves [m] */
  PetscInt  rounds;    /* solutions of the law in a step, at most; 0: the penalty method */
} StepperPenalty;

/* The same, for the rows that there are; see springs.c */
typedef struct {
  PetscReal   *stiffness;             /* per pair [N/m^3] */
  PetscScalar *softness, *multiplier; /* per touching row of all ranks: 1/K [m/N], m [N] */
  PetscInt     rounds;                /* of this step */
  PetscReal    give;                  /* by how much springs of the augmented Lagrangian give after the last round [m] */
} StepperSprings;

struct _ContactStepper {
  /* options */
  PetscViewer        monitor; /* where to tell of each pass, see monitor.c; NULL: nowhere */
  const ContactRule *asked;   /* the rule of all sets; NULL: as bodies have mass on contact nodes or not */
  StepperPenalty     penalty;
  PetscReal          rtol, atol; /* tolerances of the outer iteration on what rows read [parts of the largest way; m] */
  void              *method;     /* what a contact type that is made of the step keeps beside it, or NULL */
  /* set-up; what follows is for the rows that there are, see Reset() */
  SNES                outer; /* its unknowns are the forces of all rows */
  Contact             contact;
  LawProblem          problem;
  const ContactRule **rules;      /* per body: that of its set */
  const RowLaw      **laws;       /* per pair: of nodes that are held; those that may open have the unilateral one */
  PetscBool           glued;      /* a law is of glue */
  PetscReal          *parameters; /* ROW_LAW_PARAMETERS per pair: of its glue */
  /* state between steps, per row of this rank */
  PetscBool *joined;  /* its node has touched first in the last accepted step */
  PetscReal *grows;   /* by how much its force has grown in that step [N] */
  PetscReal *history; /* of a node, at its first row: ROW_LAW_HISTORY numbers of its law of glue, as the step begins, */
  PetscReal *grown;   /* and at its end */
  /* state of a step, per row of this rank */
  PetscBool *touches, *joins; /* it may touch in this step; its node touches for the first time */
  PetscReal *last;            /* force at the end of the last step [N] */
  PetscReal *rate;            /* of what it reads, as the step begins [m/s] */
  PetscReal *lets;            /* how far a closed row moves in the step [m] */
  PetscReal *given;           /* force under which its bodies have been advanced [N] */
  /* the same, per touching row of all ranks */
  PetscInt    *rows; /* by their numbers, ascending */
  PetscScalar *told; /* forces of the last pass, then how their first bodies have gone along them, and their second ones */
  /* per body, and per group of bodies that touch, directly or by others, in the place of its first body */
  PetscInt  *group; /* the first body of its group */
  PetscBool *rests; /* it has been advanced under the forces that its rows have now */
  PetscBool *done;  /* the group is within the tolerance */
  PetscReal *scale; /* the largest way of a touching row in the step, without forces or by its own [m] */
  PetscReal *off;   /* by how much rows still miss, after the last pass [m] */
  /* the step as a whole */
  PetscInt  passes;
  PetscBool forms;               /* S has entries even where it might be products: Newton's method alone has not solved the law */
  PetscBool has_told, corrected; /* there has been a pass with these rows; S has been corrected in the last one */
  struct {
    PetscReal loss;  /* what contact takes of the energy in this step, friction apart [J] */
    PetscReal force; /* sum over the rows whose changes of gaps, not gaps, are held in this step [N] */
  } closed;
  /* S: counts of the changes of rows, for which S is another; now, and when S was assembled; the rows that it has */
  StepperAssembly assembly;
  PetscInt64      state, assembled;
  PetscInt        n_assembled, *of_assembled;
  PetscBool       products;                 /* it is products, see products.c */
  PetscErrorCode (*answer)(Body, Vec, Vec); /* how rows of a body go under forces on them, for these */
  StepperTurns   turns;                     /* what it has of turns */
  StepperSprings springs;                   /* what it has of springs between the surfaces */
  /* work space */
  Vec          x;
  PetscReal   *all;      /* a number per row of all ranks */
  PetscScalar *gathered; /* a number per touching row */
  PetscScalar *ends;     /* two: how its first body has gone along it in the last pass, and its second one [m] */
  PetscReal   *none;     /* zeros */
  PetscReal   *mine, *before;
  PetscScalar *aligns[2]; /* per row of this rank: see InverseMassAlign(); NULL where no ties keep their mass */
  int         *moves;     /* per body */
};

PETSC_INTERN PetscErrorCode ContactStepperSetFromOptions(Contact);
PETSC_INTERN PetscErrorCode ContactStepperSetUp(Contact);
PETSC_INTERN PetscErrorCode ContactStepperView(Contact, PetscViewer);
PETSC_INTERN PetscErrorCode ContactStepperRowsChanged(Contact);
PETSC_INTERN PetscErrorCode ContactStepperAccept(Contact);
PETSC_INTERN PetscErrorCode ContactStepperVisit(Contact, Checkpoint);
PETSC_INTERN PetscErrorCode ContactStepperDestroy(Contact);
PETSC_INTERN PetscErrorCode ContactStepperStep(Contact);
PETSC_INTERN PetscReal      ContactStepperTaken(Contact, const ContactStepper *, PetscInt);
PETSC_INTERN PetscErrorCode ContactStepperSetUpGlue(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperBeginGlue(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperEndGlue(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperAcceptGlue(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactMonitorPass(Contact, const ContactStepper *);
PETSC_INTERN PetscErrorCode ContactMonitorStep(Contact, const ContactStepper *, SNESConvergedReason);
PETSC_INTERN PetscErrorCode ContactStepperGuess(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperGetLimits(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperMarkRows(Contact, const ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperVisitTables(Contact, Tables);
PETSC_INTERN PetscErrorCode ContactStepperAssemble(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperMakeBlock(Contact, ContactStepper *, PetscInt);
PETSC_INTERN PetscErrorCode ContactStepperChooseProducts(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperCreateShell(ContactStepper *, Mat *);
PETSC_INTERN PetscErrorCode ContactStepperCreateProducts(ContactStepper *, Mat *, Mat *);
PETSC_INTERN PetscErrorCode ContactStepperDestroyAssembly(StepperAssembly *);
PETSC_INTERN PetscErrorCode ContactStepperGetFlatHit(Contact, PetscInt, PetscReal *);
PETSC_INTERN PetscErrorCode ContactStepperSetUpRules(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperFindGroups(Contact, ContactStepper *);
PETSC_INTERN PetscInt       ContactStepperGroup(Contact, const ContactStepper *, PetscInt);
PETSC_INTERN PetscErrorCode ContactStepperAdvance(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperCorrectS(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperBeginSecants(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperAcceptSecants(ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperVisitShared(Contact, Checkpoint);
PETSC_INTERN PetscErrorCode ContactStepperCorrectBlock(Contact, ContactStepper *, PetscInt);
PETSC_INTERN PetscErrorCode StepperSecantsResize(StepperSecants *, PetscInt, PetscInt);
PETSC_INTERN PetscErrorCode StepperSecantsDestroy(StepperSecants *);
PETSC_INTERN PetscReal      StepperSecantMultiply(PetscInt, const PetscScalar[], const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscBool      StepperSecantCorrect(StepperEntries *, PetscBool, PetscReal, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode ContactStepperSetUpTurns(Contact, ContactStepper *);
PETSC_INTERN PetscBool      ContactStepperMayTurn(Contact);
PETSC_INTERN PetscErrorCode ContactStepperBeginTurns(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperListTurns(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperAddTurns(Contact, ContactStepper *, Mat);
PETSC_INTERN PetscErrorCode ContactStepperTurn(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperImproveTurns(Contact, ContactStepper *, PetscBool *);
PETSC_INTERN PetscErrorCode ContactStepperJoinTurned(Contact, ContactStepper *, PetscBool *);
PETSC_INTERN PetscReal      ContactStepperKeeps(Contact, const ContactStepper *, PetscInt);
PETSC_INTERN void           ContactStepperGetSpring(Contact, const ContactStepper *, PetscInt, PetscReal *, PetscReal *);
PETSC_INTERN PetscErrorCode ContactStepperSetUpSprings(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperListSprings(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperAddSprings(const ContactStepper *, Mat);
PETSC_INTERN void           ContactStepperReadSprings(ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperImproveSprings(ContactStepper *, PetscBool *);
PETSC_INTERN PetscErrorCode ContactStepperEndSprings(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperCreateVecs(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperDestroyVecs(ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperGather(Contact, ContactStepper *, const PetscReal[], PetscScalar[]);
PETSC_INTERN PetscErrorCode ContactStepperListRows(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperListBodyRows(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperIterate(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperCreateOuter(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperEndTies(Contact, ContactStepper *);

static inline ContactStepper *Stepper(Contact contact)
{
  return (ContactStepper *)contact->data;
}

static inline const ContactRule *ContactStepperRule(const ContactStepper *stepper, const ContactPair *pair)
{
  return stepper->rules[pair->body[0]];
}

extern const ContactRule ContactRuleImpulse, ContactRuleLinear;

/* A constant force does its work on the mean gap of the step, of which laws read twice; one that is linear in time, on that at each time */
static inline PetscReal ContactStepperTimes(Contact contact, const ContactStepper *stepper, PetscInt i)
{
  return ContactStepperRule(stepper, &contact->pairs[contact->rows.pair[i]])->shape == BODY_FORCE_CONSTANT ? 2 : 1;
}

static inline const RowLaw *ContactStepperLaw(Contact contact, const ContactStepper *stepper, PetscInt i)
{
  return contact->rows.tied[ContactFirstRow(contact, i)] ? stepper->laws[contact->rows.pair[i]] : &RowLawUnilateral;
}
