/* Motions of a body as if it were rigid, and which of them nothing holds. Private to src/body/system. */
#pragma once
#include <body/layout/bodyimpl.h>

/* Origin of a body's rigid motions; rotations have positions in parts of its size, so that all motions are displacements */
typedef struct {
  PetscReal centre[3]; /* of the undeformed body's box [m] */
  PetscReal size;      /* its longest edge [m] */
  PetscInt  n;         /* of rigid motions: translations along the axes, then rotations, in two dimensions about the third axis */
} RigidFrame;

PETSC_INTERN PetscErrorCode BodyGetRigidFrame(Body, RigidFrame *);
PETSC_INTERN PetscReal      BodyRigidMotion(Body, const RigidFrame *, PetscInt, PetscInt);
