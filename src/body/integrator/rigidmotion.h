/* Rotations and rigid motions. Matrices are 3 x 3, by rows; plane bodies turn about the third axis. Private to src/body. */
#pragma once
#include <impakt/body.h>

/* Where a rigid body is, and how it moves: x = c + R (X - C) */
typedef struct {
  PetscReal centre[3];                        /* c: of its mass [m] */
  PetscReal rotation[9];                      /* R */
  PetscReal velocity[3], angular_velocity[3]; /* of the centre [m/s]; about it [rad/s] */
  PetscReal acceleration[3], angular_acceleration[3];
} RigidMotion;

PETSC_INTERN void      RigidCross(const PetscReal[3], const PetscReal[3], PetscReal[3]);
PETSC_INTERN void      RigidMultiply(const PetscReal[9], const PetscReal[3], PetscReal[3]);
PETSC_INTERN void      RigidMultiplyTransposed(const PetscReal[9], const PetscReal[3], PetscReal[3]);
PETSC_INTERN void      RigidProduct(const PetscReal[9], const PetscReal[9], PetscReal[9]);
PETSC_INTERN PetscBool RigidInvert(const PetscReal[9], PetscReal[9]);
PETSC_INTERN PetscBool RigidFindRotation(PetscReal[9]);
PETSC_INTERN void      RigidCayley(const PetscReal[3], PetscReal[9]);
PETSC_INTERN void      RigidExponential(const PetscReal[3], PetscReal[9]);
PETSC_INTERN void      RigidSpin(const PetscReal[3], const PetscReal[3], PetscReal[3]);
PETSC_INTERN void      RigidFindVector(const PetscReal[9], PetscReal[3]);
PETSC_INTERN void      RigidTorque(const PetscReal[9], const PetscReal[9], PetscReal[3]);

PETSC_INTERN PetscErrorCode BodyLead(Body, PetscReal, RigidMotion *);
