#pragma once
#include <body/layout/faces.h>

#define LOADS_NAME_LENGTH 512 /* of options, as PETSc has it */

/* What formulas of some options may not depend on */
typedef enum { LOADS_NORMAL, LOADS_TIME, LOADS_PLACE } LoadsRefused;

typedef enum {
  LOAD_STEADY,
  LOAD_UNIFORM, /* varies in time alone */
  LOAD_VARYING, /* in time and place */
  LOAD_KINDS
} LoadKind;

/* A force from outside with a density: per area of a surface [Pa], or per volume [N/m^3] */
typedef struct {
  Expression component[3];
  Expression part[LOAD_KINDS][3]; /* the components of each kind, NULL for the others; borrowed */
  PetscBool  on_faces;            /* else in the volume */
  BodyFaces  faces;
} Load;

/* Values of a few owned dofs */
typedef struct {
  PetscInt   n, *dofs;
  PetscReal *values;
} DofValues;

/* A force that varies in time alone: the values are those of a density of 1 */
typedef struct {
  Expression density; /* borrowed */
  DofValues  unit;
} UniformForce;

/* Owned dofs with the same component of the same prescribed displacement */
typedef struct {
  PetscInt   prescription; /* of the surface whose prescription holds */
  Expression displacement; /* borrowed */
  PetscBool  steady, uniform;
  DofValues  held; /* values: of steady ones only [m] */
} HeldDofs;

typedef struct {
  char      *surface;
  Expression component[3]; /* NULL: free */
} PrescribedDisplacement;

struct _BodyLoads {
  /* displacements, in the order of their list */
  PetscInt                n_prescribed, n_groups, n_held;
  PrescribedDisplacement *prescribed;
  HeldDofs               *groups;
  PetscInt               *held_dofs; /* all of them, ascending */
  PetscReal              *reactions; /* work space of BodyGetReactions() */
  Expression              lead[6];   /* of a rigid body: displacement of its centre, components of its rotation vector; NULL: free, or 0 */
  PetscBool               led, turned; /* there are any of these; of the rotation */
  Expression              axis; /* 0: the distance from the axis of its nodes, the last prescription of all; NULL: there is no axis */
  /* forces; what comes below `ready` is made when they are first asked for */
  PetscInt         n_loads, n_uniform;
  Load            *loads;
  PetscBool        has_gravity, ready;
  PetscReal        gravity[3]; /* m/s^2 */
  DofValues        steady;     /* of all that does not vary in time, weight included [N] */
  UniformForce    *uniform;
  Vec              varying; /* scratch for what is integrated anew each time; NULL: nothing is */
  ExpressionPoint *points;  /* scratch, of one face or element */
  PetscReal       *x, *weights, *shape;
};

PETSC_INTERN PetscErrorCode BodyLoadsGetText(Body, const char[], const char *[]);
PETSC_INTERN PetscErrorCode BodyLoadsGetComponents(Body, const char[], const char[], PetscBool, Expression[]);
PETSC_INTERN PetscErrorCode BodyLoadsRefuse(Body, const char[], LoadsRefused, PetscInt, const Expression[]);
PETSC_INTERN PetscErrorCode BodyLoadsAddDisplacement(Body, const char[], const char[]);
PETSC_INTERN PetscErrorCode BodyLoadsAddTraction(Body, const char[], const char[]);
PETSC_INTERN PetscErrorCode BodyLoadsAddBodyForce(Body, const char[]);
PETSC_INTERN PetscErrorCode BodyLoadsSetGravity(Body, const PetscReal[]);
PETSC_INTERN PetscErrorCode BodyLoadsCheckGravity(Body);
PETSC_INTERN PetscErrorCode BodyLoadsSetInitial(Body, PetscBool, const PetscReal[]);
PETSC_INTERN PetscErrorCode BodyLoadsSetUpHeld(Body);
PETSC_INTERN PetscErrorCode BodyLoadsSetUpReactions(Body);
PETSC_INTERN PetscErrorCode BodyLoadsSetRigidDisplacement(Body, const char[]);
PETSC_INTERN PetscErrorCode BodyLoadsSetRigidRotation(Body, const char[]);
PETSC_INTERN PetscErrorCode BodyLoadsDestroyHeld(struct _BodyLoads *);
PETSC_INTERN PetscErrorCode BodyLoadsDestroyForces(struct _BodyLoads *);
PETSC_INTERN PetscErrorCode BodyLoadsReadInitialState(Body);
PETSC_INTERN PetscErrorCode BodyLoadsCompress(PetscInt, const PetscScalar[], PetscInt, PetscInt, DofValues *);
