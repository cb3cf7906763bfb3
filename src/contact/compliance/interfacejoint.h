/* What preconditions S where bodies are linear, in all pairs together. Private to the files that make up the interface operator. */
#pragma once
#include "interfaceimpl.h"

typedef struct _n_InterfaceJoint *InterfaceJoint;

PETSC_INTERN PetscErrorCode InterfaceJointCreate(InterfaceOperator, InterfaceJoint *);
PETSC_INTERN PetscErrorCode InterfaceJointDestroy(InterfaceJoint *);
PETSC_INTERN PetscBool      InterfaceJointHasPair(InterfaceJoint, PetscInt);
PETSC_INTERN PetscErrorCode InterfaceJointUpdate(InterfaceOperator, InterfaceJoint);
PETSC_INTERN PetscErrorCode InterfaceJointApply(InterfaceOperator, InterfaceJoint, const PetscScalar[], PetscScalar[]);
