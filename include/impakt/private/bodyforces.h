/* Forces on the rows of a body that no trace has, impulses on them, and the displacements that they bring: the interface compliance. */
#pragma once
#include <impakt/body.h>

/* How a force on a body runs in the course of a controller step: from that which the last step has ended with to that at the end of this
   one, or the same throughout */
typedef enum { BODY_FORCE_LINEAR, BODY_FORCE_CONSTANT } BodyForceShape;

/* Where in a controller step a state is changed */
typedef enum { BODY_AT_START, BODY_AT_END } BodyStepSide;

PETSC_EXTERN PetscErrorCode BodySetStartForce(Body, const PetscScalar[], const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyDropStartForce(Body);
PETSC_EXTERN PetscErrorCode BodySetConstantForces(Body, PetscInt, const PetscInt[], const PetscReal[], const PetscReal[],
                                                  const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyEndConstantForces(Body, const PetscScalar[], const PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodySetMeanForces(Body, const PetscBool[]);
PETSC_EXTERN PetscErrorCode BodyAddImpulses(Body, BodyStepSide, PetscBool, const PetscReal[3], const PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyClearAcceleration(Body, const PetscBool[]);
PETSC_EXTERN PetscErrorCode BodyGetNodalDiagonal(Body, BodyForceShape, Vec *);
PETSC_EXTERN PetscErrorCode BodyGetNodalCompliance(Body, BodyForceShape, PetscInt, const PetscInt[], const PetscInt *[], PetscInt *,
                                                   const PetscScalar *[]);
PETSC_EXTERN PetscErrorCode BodyNodalComplianceFollows(Body, PetscInt, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyGetLayerMatrices(Body, Mat *, Mat *);
PETSC_EXTERN PetscErrorCode BodyApplyCompliance(Body, Vec, Vec);
