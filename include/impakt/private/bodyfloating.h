/* Static bodies that contact or ties alone hold, and their artificial springs. */
#pragma once
#include <impakt/body.h>

#define BODY_MAX_SPRINGS 6 /* as many as a body has motions as if it were rigid */

/* How the artificial springs of a floating body are stretched at the end of a controller step */
typedef struct {
  PetscInt  n;
  PetscReal stretch[BODY_MAX_SPRINGS]; /* [m] */
  PetscReal falls[BODY_MAX_SPRINGS];   /* the part of it by which the body does not turn [m] */
  PetscReal stiffness;                 /* of each [N/m] */
  PetscReal part;                      /* the same, in parts of that of the body */
  PetscBool linear;                    /* the body is */
  PetscReal displacement;              /* the largest of the dofs that they pull at [m] */
  PetscReal way;                       /* the largest of these less that in the saved state [m] */
  PetscReal size;                      /* of the body: the longest edge of its box [m] */
} BodySpringState;

PETSC_EXTERN PetscErrorCode BodyIsFloating(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyGetLeastStiffness(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodySetSpringStiffness(Body, PetscReal);
PETSC_EXTERN PetscErrorCode BodyResetSprings(Body);
PETSC_EXTERN PetscErrorCode BodyMeasureSprings(Body, BodySpringState *);
PETSC_EXTERN PetscErrorCode BodyMoveSprings(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyDescribeDrift(Body, size_t, char[]);
