/* What the isotropic models share: the data of each is one of these. */
#pragma once
#include <impakt/private/materialimpl.h>

typedef struct {
  PetscReal youngs_modulus; /* Pa */
  PetscReal poissons_ratio;
  PetscReal lambda, mu;   /* Lame's constants [Pa] */
  PetscReal plane_lambda; /* lambda of plane stress: 2 lambda mu / (lambda + 2 mu) [Pa] */
} Isotropic;

PETSC_EXTERN PetscErrorCode MaterialCreate_Isotropic(Material);
PETSC_INTERN PetscErrorCode MaterialSetFromOptions_Isotropic(Material);
PETSC_INTERN PetscErrorCode MaterialSetUp_Isotropic(Material);
PETSC_INTERN PetscErrorCode MaterialView_Isotropic(Material, PetscViewer);
PETSC_INTERN PetscErrorCode MaterialDestroy_Isotropic(Material);
