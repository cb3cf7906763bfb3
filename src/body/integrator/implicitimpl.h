/* What the integrators on TSALPHA2 share, with inertia and without. Private to src/body/integrator. */
#pragma once
#include <body/layout/bodyimpl.h>

/* Descents that the line search wants of a static body, in parts of the slope, see newton.c */
#define BODY_STATIC_WHOLE   (-1e12)
#define BODY_STATIC_DESCENT 1e-4

typedef struct {
  PetscReal alpha_m, alpha_f;            /* of TSALPHA2 */
  Mat       matrix;                      /* K + shift M, its held dofs eliminated: body->solver has its factors */
  Mat       matrices[STEP_MAX_CUTS + 1]; /* that of each level of cut steps which there has been */
  PetscBool iterated;                    /* of a nonlinear body: in this substep by Newton's method, or refactored at its start */
  Vec       stiffness;                   /* diagonal of the stiffness of a nonlinear body, undeformed [N/m] */
  PetscReal shift;                       /* [1/s^2]; 0 without inertia */
  PetscReal shift_velocity;              /* of C where the body is damped [1/s] */
  PetscReal first;                       /* norm of the first residual of the substep [N] */
  PetscReal terms, round_off;            /* of a nonlinear residual: norm of the forces that it is the balance of, and its round-off [N] */
  PetscReal unit_strain;                 /* norm of the forces of strains of size 1, of a nonlinear body [N] */
  Vec       lead[4];                     /* work of BodyImplicitCarry() */
  Vec       stage_u, stage_v, stage_a;   /* of a linear body, at the stage: NULL where its residual does not read them, or is at the end */
  struct _BodyOwnStep *own;              /* of a nonlinear body that one of several ranks has: see ownstep.c; or NULL */
  PetscBool            alone;            /* the substep under way is that rank's alone */
} BodyImplicit;

typedef PetscErrorCode BodyResidualFn(TS, PetscReal, Vec, Vec, Vec, Vec, void *);
typedef PetscErrorCode BodyPredictorFn(TS, Vec, Vec, Vec, Vec, void *);
typedef PetscErrorCode BodyNewtonFn(Body, TS, Mat, BodyPredictorFn *);

PETSC_INTERN PetscErrorCode BodyImplicitCreate(BodyIntegrator);
PETSC_INTERN PetscErrorCode BodyImplicitDestroy(Body);
PETSC_INTERN PetscErrorCode BodyImplicitSetUp(Body, BodyResidualFn *, BodyPredictorFn *);
PETSC_INTERN PetscErrorCode BodyImplicitSetUpLinear(Body);
PETSC_INTERN PetscErrorCode BodyImplicitSetUpNewton(Body, TS, Mat, BodyPredictorFn *);
PETSC_INTERN PetscErrorCode BodyImplicitSetUpOwnStep(Body, BodyResidualFn *, BodyPredictorFn *, BodyNewtonFn *);
PETSC_INTERN PetscErrorCode BodyImplicitGetSNES(Body, SNES *);
PETSC_INTERN PetscErrorCode BodyImplicitLinearize(Body, Vec);
PETSC_INTERN PetscErrorCode BodyImplicitDestroyOwnStep(Body);
PETSC_INTERN PetscErrorCode BodyImplicitCreateSolver(Body, Vec);
PETSC_INTERN PetscErrorCode BodyImplicitComputeUnitStrainForce(Body);
PETSC_INTERN PetscErrorCode BodyImplicitSetLevel(Body);
PETSC_INTERN PetscErrorCode BodyImplicitRefactor(Body, Vec);
PETSC_INTERN PetscErrorCode BodyImplicitRenew(Body);
PETSC_INTERN PetscErrorCode BodyImplicitCheckSubstep(Body);
PETSC_INTERN PetscErrorCode BodyImplicitAddForces(Body, PetscReal, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyImplicitPrescribe(Body, Vec);
PETSC_INTERN PetscErrorCode BodyImplicitCarry(Body, BodyResidualFn *, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyImplicitCorrect(Body, const PetscScalar[], PetscReal, PetscReal, PetscReal, Vec);
PETSC_INTERN PetscErrorCode BodyImplicitGetAcceleration(Body, Vec, Vec);
