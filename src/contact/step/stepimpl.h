/* The one contact step: rows under forces, a rule for how these run within the step, a law for what they are. */
#pragma once
#include <contact/parts.h>
#include <contact/solve/lawproblem.h>

typedef struct _ContactStepper ContactStepper;

/* How forces run within a step, where rows lie, when a row counts as closed */
typedef struct {
  const char *name;
  const char *takes; /* (NULL) what closed rows take of the energy, which they bring none of, and what makes that less */
  PetscErrorCode (*place)(Contact, ContactStepper *);             /* (NULL) where rows are to be laid, before they are */
  PetscErrorCode (*begin)(Contact, ContactStepper *);             /* which rows may touch, the guess, what closed rows may still move */
  PetscErrorCode (*load)(Contact, ContactStepper *, PetscInt);    /* the forces `contact->end.force` on the rows of a body */
  BodyForceShape shape;                                           /* of forces in the step */
  /* (NULL) after the first solution of the law: changes what closed rows may still move, from the ways of all ranks' touching rows [m] */
  PetscErrorCode (*limit)(Contact, ContactStepper *, const PetscScalar[]);
  PetscErrorCode (*more)(Contact, ContactStepper *, PetscBool *); /* (NULL) whether rows that were left out touch after all */
  PetscErrorCode (*end)(Contact, ContactStepper *);               /* (NULL) after the step has been made */
} ContactRule;

/* Where to tell of each pass, see monitor.c */
typedef struct {
  PetscViewer       viewer; /* NULL: nowhere */
  PetscViewerFormat format;
} ContactMonitor;

struct _ContactStepper {
  ContactMonitor     monitor;
  const ContactRule *rule;
  LawProblem         problem;
  SNES               outer; /* its unknowns are the forces of this rank's touching rows */
  Vec                x, f;
  PetscReal          rtol, atol;      /* tolerances of the outer iteration on what rows read [parts of the largest way; m] */
  PetscReal          scale;           /* the largest way of a touching row in the step, without forces or by its own [m] */
  PetscReal          off;             /* by how much rows still miss, after the last pass [m] */
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
  /* per row of this rank */
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
PETSC_INTERN PetscErrorCode ContactStepperCreateOuter(Contact, ContactStepper *);

extern const ContactRule ContactRuleImpulse, ContactRuleLinear;
