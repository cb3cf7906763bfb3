/* The part of a body near the surfaces of which it is the Dirichlet side. Private to the files that make up the interface operator. */
#pragma once
#include "interfaceimpl.h"

/* Of one body: its dofs on the surfaces of which it is the Dirichlet side, and those in the layers beside them */
typedef struct {
  PetscInt         body;
  PetscObjectId    id; /* of A, and its state, when it was factored */
  PetscObjectState state;
  Mat              B; /* the rows as they are; borrowed */
  IS               surface, layers;
  Mat              A_cc, A_cj, A_jc;
  KSP              factors; /* of A_jj; NULL where no dofs are beside the surface */
  VecScatter       gather;  /* from all dofs to those on the surface */
  Vec              rows, dofs, moved, force, diagonal, depth[2];
  PetscBool        is_layer; /* A is that of a massless layer, which has the surface alone */
  PetscBool       *moves;    /* per row of this rank that the body has: whether it has a part in R */
  PetscBool       *claimed;  /* work space, per dof of this rank */
  PetscReal        mean;     /* of the diagonal of P, which other rows of the Dirichlet side are multiplied with */
} InterfaceSlab;

PETSC_INTERN PetscErrorCode InterfaceSlabUpdate(Contact, InterfaceSlab *);
PETSC_INTERN PetscErrorCode InterfaceSlabApply(InterfaceSlab *);
PETSC_INTERN PetscErrorCode InterfaceSlabReset(InterfaceSlab *);
