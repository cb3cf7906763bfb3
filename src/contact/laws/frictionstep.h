/* A controller step with friction: what its sources share. Private to this folder. */
#pragma once
#include "friction.h"
#include <contact/compliance/forces.h>
#include <contact/compliance/interfaceoperator.h>

typedef struct {
  Forces            forces;
  InterfaceOperator S;
  InterfaceMark    *marks; /* of this rank's rows */
  PetscScalar      *mine;  /* work space, a number for each */
  FrictionSolver    solver;
  FrictionProblem   problem;
  FrictionProducts  products;   /* S where it is no matrix, and, for each row of this rank: */
  PetscReal        *compliance; /* about what S has on the diagonal [m/N]; less than 0: not known */
  PetscReal        *largest;    /* work space: the largest displacement that probes have had */
  PetscScalar      *in, *out;   /* work space: forces and what rows open by */
  PetscBool        *chosen;     /* rows that are preconditioned */
  PetscReal        *sums;       /* work space, per pair */
  PetscReal         atol;       /* what S tells and what bodies do may differ by this [m] */
  /* springs between both sides of each row, which make it give by flexibility (force - multiplier); all are 0 where there are none */
  ContactFrictionSprings springs;
  PetscBool              has_springs;
  PetscReal             *flexibility; /* [m/N] */
  PetscReal             *multiplier;  /* [N] */
  PetscReal             *change;      /* work space of augmentations, a number for each row */
} FrictionStep;

PETSC_INTERN PetscErrorCode FrictionStartProblem(Contact);
PETSC_INTERN PetscErrorCode FrictionGatherOpened(Contact, PetscScalar[]);
PETSC_INTERN PetscErrorCode FrictionTakeForces(Contact);
PETSC_INTERN PetscErrorCode FrictionCreateProducts(Contact);
PETSC_INTERN PetscErrorCode FrictionDestroyProducts(Contact);
PETSC_INTERN PetscErrorCode FrictionFindDiagonal(Contact);
PETSC_INTERN PetscErrorCode FrictionSetUpSprings(Contact);
PETSC_INTERN PetscReal      FrictionStoredEnergy(Contact, PetscInt, PetscReal);
PETSC_INTERN PetscReal      FrictionGive(Contact, PetscInt);
PETSC_INTERN PetscErrorCode FrictionComputeSlips(Contact);
PETSC_INTERN PetscErrorCode FrictionVisit(Contact, Checkpoint);
PETSC_INTERN PetscErrorCode FrictionViewSprings(Contact, PetscViewer);
