/* Constitutive models. */
#pragma once
#include <petscviewer.h>

/*S
   Material - density and stress response of a body

   Level: beginner

.seealso: `MaterialCreate()`, `MaterialSetType()`, `MaterialRegister()`
S*/
typedef struct _p_Material *Material;

/*J
   MaterialType - name of a constitutive model

   Values:
. `MATERIAL_LINEAR_ELASTIC` - isotropic linear elasticity

   Level: beginner

.seealso: `MaterialSetType()`
J*/
typedef const char *MaterialType;
#define MATERIAL_LINEAR_ELASTIC "linear_elastic"

PETSC_EXTERN PetscClassId MATERIAL_CLASSID;

PETSC_EXTERN PetscErrorCode MaterialCreate(MPI_Comm, Material *);
PETSC_EXTERN PetscErrorCode MaterialSetOptionsPrefix(Material, const char[]);
PETSC_EXTERN PetscErrorCode MaterialSetType(Material, MaterialType);
PETSC_EXTERN PetscErrorCode MaterialSetFromOptions(Material);
PETSC_EXTERN PetscErrorCode MaterialView(Material, PetscViewer);
PETSC_EXTERN PetscErrorCode MaterialDestroy(Material *);
PETSC_EXTERN PetscErrorCode MaterialRegister(const char[], PetscErrorCode (*)(Material));
PETSC_EXTERN PetscErrorCode MaterialRegisterAll(void);
PETSC_EXTERN PetscErrorCode MaterialFinalizePackage(void);

PETSC_EXTERN PetscErrorCode MaterialGetDensity(Material, PetscReal *);
PETSC_EXTERN PetscErrorCode MaterialGetUniaxialModulus(Material, PetscReal *);
PETSC_EXTERN PetscErrorCode MaterialIsLinear(Material, PetscBool *);
PETSC_EXTERN PetscErrorCode MaterialComputeUniaxial(Material, PetscInt, const PetscReal[], PetscReal[]);
