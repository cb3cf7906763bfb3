/* What preconditions S on the rows of a massless layer. Private to the files that make up the interface operator. */
#pragma once
#include "interfaceimpl.h"

typedef struct {
  PetscInt   body;
  PetscBool *has;                         /* per pair: P has its rows */
  Mat        K, B;                        /* as they are; borrowed */
  Vec        rows, dofs, force, diagonal; /* the latter of K, the others work space */
  PetscBool *moves;                       /* per row of this rank that the body has: whether it has a part in R */
  PetscBool *claimed;                     /* work space, per dof of this rank */
  PetscReal  mean;                        /* of the diagonal of P, which other rows of the Dirichlet side are multiplied with */
} InterfaceLayer;

PETSC_INTERN PetscErrorCode InterfaceLayerUpdate(InterfaceOperator, InterfaceLayer *);
PETSC_INTERN PetscErrorCode InterfaceLayerApply(InterfaceOperator, InterfaceLayer *, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode InterfaceLayerReset(InterfaceLayer *);
