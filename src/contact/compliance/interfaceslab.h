/* The part of a body near its contact surfaces. Private to the files that make up the interface operator. */
#pragma once
#include "interfaceimpl.h"

typedef struct {
  PetscInt         body;
  PetscBool        is_layer; /* it is the body's massless layer, by which it answers */
  PetscObjectId    ids[2];   /* of the body's matrix A and rows B when the following were made; and their states */
  PetscObjectState states[2];
  Mat              functions; /* P: which displacements of the body are looked at; NULL: all, as of a massless layer */
  Mat              K;         /* P^T A P */
  Mat              rows;      /* B P */
} InterfaceSlab;

PETSC_INTERN PetscErrorCode InterfaceSlabUpdate(Contact, InterfaceSlab *, PetscBool *);
PETSC_INTERN PetscErrorCode InterfaceSlabReset(InterfaceSlab *);
