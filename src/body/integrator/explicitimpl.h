/* Central differences: what they need beside the TS. Private to src/body/integrator. */
#pragma once
#include <body/layout/bodyimpl.h>

typedef struct _n_LayerBalance *LayerBalance;

typedef struct {
  LayerBalance layer;       /* NULL: no node is massless, on any rank */
  PetscBool    layer_alone; /* where rows get in a step, and what holds them, is known before the acceleration: the layer alone answers */
} BodyExplicit;

static inline LayerBalance GetLayerBalance(Body body)
{
  return ((BodyExplicit *)body->integrator->data)->layer;
}

PETSC_INTERN PetscErrorCode LayerBalanceCreate(Body, LayerBalance *);
PETSC_INTERN PetscErrorCode LayerBalanceDestroy(LayerBalance *);
PETSC_INTERN PetscErrorCode LayerBalanceSetRows(Body);
PETSC_INTERN PetscErrorCode LayerBalanceSolve(LayerBalance, Body, PetscReal, PetscReal, Vec, Vec);
PETSC_INTERN PetscErrorCode LayerBalanceGetForce(Body, Vec, Vec);
PETSC_INTERN PetscErrorCode LayerBalanceSave(Body);
PETSC_INTERN PetscErrorCode LayerBalanceRestore(Body);
PETSC_INTERN PetscErrorCode LayerBalanceAgree(Body);
PETSC_INTERN PetscErrorCode LayerBalanceVisit(Body, PetscInt, Checkpoint);
PETSC_INTERN PetscErrorCode LayerBalanceCopyPoint(Body, PetscBool, Vec, PetscReal[2]);
PETSC_INTERN PetscBool      BodyHasOutsideForce(Body, PetscBool);
PETSC_INTERN PetscErrorCode BodyComputeOutsideForce(Body, PetscReal, PetscReal, PetscBool, Vec, Vec);
