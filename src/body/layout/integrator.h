/* How a body goes through one substep: operations of an integrator, and properties by which the rest of src/body knows it. Nobody asks
   which integrator a body has. Found by the type of the body's TS; src/body/integrator/README.md says how to add one. */
#pragma once
#include <impakt/body.h>
#include <solver/compliance.h>

typedef struct _n_BodyIntegrator *BodyIntegrator;

/* Those marked (NULL) may be missing */
typedef struct {
  PetscErrorCode (*setdefaults)(Body);   /* (NULL) gives a TS that has just been made the parameters that are Impakt's default */
  PetscErrorCode (*getparameters)(Body); /* (NULL) reads and checks the parameters of the TS, after program and options have set them */
  PetscErrorCode (*setup)(Body);         /* callbacks of the TS, matrices and factors; mass, rows, loads and substeps are known */
  PetscErrorCode (*setrows)(Body);       /* (NULL) of a solver that has the rows on other dofs than the body: it gets them, before they are
                                            prescribed or read, if they are new */
  PetscErrorCode (*setlevel)(Body); /* (NULL) the controller step is cut in halves another number of times, body->time.level: matrix and
                                       solver are those of this level, made where there are none yet */
  PetscErrorCode (*renew)(Body); /* of a body that uses Newton's method: factors of its last iteration in this substep, or at its start */
  PetscErrorCode (*step)(Body);  /* (NULL) makes a substep in place of TSStep(); may be set in setup() */
  PetscErrorCode (*checksubstep)(
      Body); /* (NULL) after TSStep(): notes in the body's failure where, and why, the equations of the substep were not solved */
  /* (NULL) after TSStep(): velocity and acceleration of massless, held and prescribed nodes, and what else the TS leaves undone */
  PetscErrorCode (*finishsubstep)(Body);
  /* (NULL) after the one substep of a controller step: moves its end state to the present inputs, given by how much more force acts on
     forced and Robin rows [N], and by how much prescribed rows go farther [m], than when it was made; may be unset in setup() */
  PetscErrorCode (*repeat)(Body, const PetscScalar[], const PetscScalar[]);
  /* (NULL) finds what TSStep() and repeat() have left out of a state that they mark as incomplete; may be set in setup() */
  PetscErrorCode (*complete)(Body);
  PetscErrorCode (*save)(Body);    /* (NULL) the state has been put aside: so is to be what the integrator remembers beside it */
  PetscErrorCode (*restore)(Body); /* (NULL) the state has been brought back: what the integrator remembers must be as it was
                                                then, so that the same integration gives the same bits */
  /* (NULL) memory from step to step, to or from a checkpoint, for a level of cut steps, which is present in loading */
  PetscErrorCode (*visit)(Body, PetscInt, Checkpoint);
  PetscErrorCode (*agree)(Body); /* (NULL) of a local body whose rows are to be prescribed, or whose state is to be saved: all ranks get to
                                    know what one of them remembers of the steps that it has made alone */
  /* (NULL) of a nonlinear layer: where its factors were made, and two numbers, to a vector; (true) back, with factors */
  PetscErrorCode (*copypoint)(Body, PetscBool, Vec, PetscReal[2]);
  /* (NULL) columns of some displacements of any rank, into a compliance, for the step from the saved state, without making it */
  PetscErrorCode (*nodalcolumns)(Body, BodyForceShape, PetscInt, const PetscInt[], Compliance);
  PetscErrorCode (*solvemass)(Body, Vec, Vec);     /* (NULL) the acceleration [m/s^2] that forces on the nodes bring [N] */
  PetscErrorCode (*start)(Body);                   /* (NULL) checks, and corrects, displacement and velocity of the first state */
  PetscErrorCode (*startacceleration)(Body);       /* (NULL) makes that of the first state, which solvemass() has found, complete */
  PetscErrorCode (*measure)(Body, BodyMeasures *); /* (NULL) where a rigid body is, and how it turns */
  PetscErrorCode (*view)(Body, PetscViewer);       /* (NULL) what there is to tell of such a body */
  PetscErrorCode (*destroy)(Body); /* (NULL) frees what `data` points to, not that itself; the body may not have been set up */
} BodyIntegratorOps;

struct _n_BodyIntegrator {
  const char       *type; /* of the TS that it is for */
  BodyIntegratorOps ops;
  void             *data;
  /* known from creation on */
  PetscBool deforms;           /* false: a rigid body, without strain, stress and internal force */
  PetscBool has_inertia;       /* false: neither mass nor acceleration means anything, and the state has no kinetic energy */
  PetscBool needs_stable_step; /* substeps are bounded by 2 / omega_max */
  PetscBool divides_by_mass;   /* each substep divides by the mass, so that factoring it has to be paid for */
  PetscReal staggered;         /* the energy that the scheme conserves has 1/2 (v'Mv - staggered dt^2 a'Ma) for kinetic energy */
  /* known after getparameters() */
  PetscReal beta, gamma; /* of Newmark's formulas for nodes with mass; 0: they do not hold */
  PetscBool affine; /* for linear materials, displacements at the ends of substeps are affine in the contact forces at these ends alone */
  /* known after setup() */
  PetscBool is_local;           /* substeps need no word of other ranks but what rows that are prescribed take: see `local` in bodyimpl.h */
  PetscBool uses_newton;        /* the SNES of the TS solves the equations of each substep */
  PetscBool depends_on_step;    /* displacements of the rows under forces on them depend on the length of the substep */
  PetscBool leaves_force;       /* substeps leave the internal force to BodyFindInternalForce() */
  PetscBool reads_start;        /* finishsubstep() reads body->substep_start */
  PetscBool repeats_prescribed; /* repeat() can do it with prescribed rows */
  PetscBool repeats_by_solver;  /* repeat() lets the solver correct, which has been brought the changes of forces from ranks with rows */
  PetscBool repeats_constant;   /* repeat() can do it with forces that are the same throughout the step */
  PetscBool answers_by_layer;   /* those of the rows do so by the massless layer alone, whose matrix is that of body->solver */
};

PETSC_INTERN PetscErrorCode BodyIntegratorCreate(Body, const char[]);
PETSC_INTERN PetscErrorCode BodyIntegratorDestroy(Body);
PETSC_INTERN PetscErrorCode BodyIntegratorCreate_Implicit(BodyIntegrator);
PETSC_INTERN PetscErrorCode BodyIntegratorCreate_Explicit(BodyIntegrator);
PETSC_INTERN PetscErrorCode BodyIntegratorCreate_Static(BodyIntegrator);
PETSC_INTERN PetscErrorCode BodyIntegratorCreate_Rigid(BodyIntegrator);
