/* The one contact step: rows under forces, a rule for how these run within the step, a law for what they are. */
#pragma once
#include <contact/parts.h>
#include <contact/solve/lawproblem.h>

typedef struct _ContactStepper ContactStepper;

/* How forces run within a step, where rows lie, when a row counts as closed. One rule holds for each set of bodies that pairs connect. */
typedef struct {
  const char *name;
  const char *takes; /* (NULL) what closed rows take of the energy, which they bring none of, and what makes that less */
  PetscErrorCode (*place)(Contact, PetscInt);                              /* (NULL) where rows of a body are to be laid, before they are */
  PetscErrorCode (*begin)(Contact, ContactStepper *, const ContactPair *); /* which rows may touch, the guess, what closed rows may move */
  PetscErrorCode (*load)(Contact, ContactStepper *, PetscInt);             /* the forces `contact->end.force` on the rows of a body */
  BodyForceShape shape;                                                    /* of forces in the step */
  /* (NULL) after the first solution of the law: a smaller way of a closed row that joins, from the present one [m] and the way by which its
     force alone has moved it [m] */
  PetscReal (*limit)(PetscReal, PetscReal);
  PetscErrorCode (*more)(Contact, ContactStepper *, const ContactPair *, PetscBool *); /* (NULL) whether rows left out touch after all */
  PetscErrorCode (*end)(Contact, ContactStepper *, const ContactPair *);               /* (NULL) after the step has been made */
} ContactRule;

/* Where to tell of each pass, see monitor.c */
typedef struct {
  PetscViewer       viewer; /* NULL: nowhere */
  PetscViewerFormat format;
} ContactMonitor;

struct _ContactStepper {
  ContactMonitor     monitor;
  const ContactRule *asked; /* the rule of all sets; NULL: as bodies have mass on contact nodes or not */
  LawProblem         problem;
  SNES               outer; /* its unknowns are the forces of this rank's touching rows */
  Vec                x, f;
  PetscReal          rtol, atol;      /* tolerances of the outer iteration on what rows read [parts of the largest way; m] */
  PetscInt           passes, n_local; /* of this step; touching rows of this rank */
  PetscInt          *rows;            /* touching rows of all ranks, by their numbers, ascending */
  PetscInt           room;
  PetscInt          *of_body, *places;    /* work space: touching rows of a body, and their places in the list */
  PetscScalar       *gathered;            /* work space: three numbers per touching row */
  PetscScalar       *told;                /* work space: forces and readings of the last pass */
  PetscBool          has_told, corrected; /* there has been a pass in the step; S has been corrected in the last one */
  PetscInt64         state;               /* counts changes of rows, for which S is another */
  PetscInt64         assembled;
  PetscInt           n_assembled, *of_assembled; /* the rows that S has */
  /* per body */
  const ContactRule **rules; /* of its set */
  PetscInt           *group; /* the first body of its group: bodies that touch in this step, directly or by others */
  int                *moves; /* work space */
  PetscBool          *rests; /* it has been advanced under the forces that its rows have now */
  /* per group, by its first body */
  PetscBool *done;  /* it is within the tolerance */
  PetscReal *scale; /* the largest way of a touching row in the step, without forces or by its own [m] */
  PetscReal *off;   /* by how much rows still miss, after the last pass [m] */
  /* per row of this rank */
  PetscReal *given;            /* force under which its bodies have been advanced [N] */
  PetscBool *touches, *joined; /* it may touch in this step; its node has touched first in the last accepted step */
  PetscBool *joins;            /* the same of this step */
  PetscReal *last;             /* force at the end of the last step [N] */
  PetscReal *rate;             /* of what it reads, as the step begins [m/s] */
  PetscReal *lets;             /* how far a closed row moves in the step [m] */
  PetscReal *none;             /* zeros */
  PetscReal *mine, *before;    /* work space */
  PetscReal  step_loss;        /* what contact takes of the energy in this step, friction apart [J] */
};

PETSC_INTERN PetscErrorCode ContactCreate_Force(Contact);
PETSC_INTERN PetscErrorCode ContactStepperStep(Contact);
PETSC_INTERN PetscErrorCode ContactMonitorSetFromOptions(Contact, ContactMonitor *);
PETSC_INTERN PetscErrorCode ContactMonitorPass(Contact, const ContactStepper *);
PETSC_INTERN PetscErrorCode ContactMonitorStep(Contact, const ContactStepper *, SNESConvergedReason);
PETSC_INTERN PetscErrorCode ContactStepperComputeRates(Contact, PetscReal[]);
PETSC_INTERN PetscErrorCode ContactStepperPack(Contact, Tables);
PETSC_INTERN PetscErrorCode ContactStepperUnpack(Contact, Tables);
PETSC_INTERN PetscErrorCode ContactStepperAssemble(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperSetUpRules(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperFindGroups(Contact, ContactStepper *);
PETSC_INTERN PetscInt       ContactStepperGroup(Contact, const ContactStepper *, PetscInt);
PETSC_INTERN PetscErrorCode ContactStepperAdvance(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperCorrectS(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperGather(Contact, ContactStepper *, PetscInt, const PetscReal *const[], PetscScalar[]);
PETSC_INTERN PetscErrorCode ContactStepperIterate(Contact, ContactStepper *);
PETSC_INTERN PetscErrorCode ContactStepperCreateOuter(Contact, ContactStepper *);

/* The rule of a pair's set */
static inline const ContactRule *ContactStepperRule(const ContactStepper *stepper, const ContactPair *pair)
{
  return stepper->rules[pair->body[0]];
}

extern const ContactRule ContactRuleImpulse, ContactRuleLinear;
