/* What the files of the rigid body share. Private to src/body/integrator. */
#pragma once
#include <body/layout/bodyimpl.h>
#include "rigidmotion.h"

typedef struct {
  PetscBool turns;                        /* it can: not bars and rings */
  PetscReal inertia[9], inverse[9];       /* about the centre of mass, undeformed; in two dimensions about the third axis alone [kg m^2] */
  PetscReal spread[9], inverse_spread[9]; /* sum m Y Y^T by the masses of the nodes, Y being positions from the centre [kg m^2] */
} BodyRigid;

/* Momentum and moment of momentum about the centre, of velocities or of forces over mass */
typedef struct {
  PetscReal linear[3], angular[3];
} Momentum;

/* Forces on the nodes as far as a rigid body feels them: their sum [N], and sum f Y^T [N m]; or the same of other vectors */
typedef struct {
  PetscReal force[3], dyad[9];
} Resultant;

PETSC_INTERN BodyRigid     *BodyGetRigid(Body);
PETSC_INTERN void           BodyRigidGetArm(const struct _p_Body *, PetscInt, PetscReal[3]);
PETSC_INTERN PetscErrorCode BodyRigidFindPlace(Body, Vec, RigidMotion *);
PETSC_INTERN PetscErrorCode BodyRigidFindMotion(Body, Vec, Vec, RigidMotion *);
PETSC_INTERN PetscErrorCode BodyRigidFindMomentum(Body, const RigidMotion *, Vec, Momentum *);
PETSC_INTERN PetscErrorCode BodyRigidFindResultant(Body, Vec, Vec, Resultant *);
PETSC_INTERN PetscErrorCode BodyRigidSum(Body, Resultant *);
PETSC_INTERN PetscErrorCode BodyRigidWriteMotion(Body, const RigidMotion *, Vec, Vec, Vec);
PETSC_INTERN PetscBool      BodyRigidIsFixed(const struct _p_Body *, PetscInt);
PETSC_INTERN void           BodyRigidFindAcceleration(Body, const PetscReal[3], const PetscReal[3], RigidMotion *);
PETSC_INTERN PetscErrorCode BodyRigidFindInertia(Body);
PETSC_INTERN PetscErrorCode BodyRigidMeasure(Body, BodyMeasures *);
PETSC_INTERN PetscErrorCode BodyRigidView(Body, PetscViewer);
PETSC_INTERN PetscErrorCode BodyRigidSolveMass(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode BodyRigidSetNodalColumns(Body, BodyForceShape, PetscInt, const PetscInt[], Compliance);
