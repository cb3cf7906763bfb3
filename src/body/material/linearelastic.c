#include "materialimpl.h"

typedef struct {
  PetscReal youngs_modulus; /* Pa */
  PetscReal poissons_ratio;
} LinearElastic;

static PetscErrorCode MaterialSetFromOptions_LinearElastic(Material material)
{
  LinearElastic *elastic = (LinearElastic *)material->data;
  const char    *prefix  = ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "";
  MPI_Comm       comm    = PetscObjectComm((PetscObject)material);
  PetscBool      set;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsReal("-youngs_modulus", "Young's modulus [Pa]", "", elastic->youngs_modulus, &elastic->youngs_modulus, &set));
  PetscCall(PetscOptionsReal("-poissons_ratio", "Poisson's ratio", "", elastic->poissons_ratio, &elastic->poissons_ratio, NULL));
  PetscOptionsEnd();
  PetscCheck(set, comm, PETSC_ERR_USER_INPUT, "-%syoungs_modulus is missing; give Young's modulus in Pa", prefix);
  PetscCheck(elastic->youngs_modulus > 0, comm, PETSC_ERR_USER_INPUT, "-%syoungs_modulus is %g Pa; it must be positive", prefix, (double)elastic->youngs_modulus);
  PetscCheck(elastic->poissons_ratio > -1 && elastic->poissons_ratio < 0.5, comm, PETSC_ERR_USER_INPUT, "-%spoissons_ratio is %g; it must lie between -1 and 0.5", prefix, (double)elastic->poissons_ratio);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialView_LinearElastic(Material material, PetscViewer viewer)
{
  const LinearElastic *elastic = (const LinearElastic *)material->data;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  Young's modulus %g Pa, Poisson's ratio %g\n", (double)elastic->youngs_modulus, (double)elastic->poissons_ratio));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialDestroy_LinearElastic(Material material)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(material->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialUniaxialModulus_LinearElastic(Material material, PetscReal *modulus)
{
  PetscFunctionBegin;
  *modulus = ((const LinearElastic *)material->data)->youngs_modulus;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialUniaxial_LinearElastic(Material material, PetscInt n, const PetscReal strain[], PetscReal stress[])
{
  const PetscReal youngs_modulus = ((const LinearElastic *)material->data)->youngs_modulus;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) stress[i] = youngs_modulus * strain[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_LinearElastic(Material material)
{
  LinearElastic *elastic;

  PetscFunctionBegin;
  PetscCall(PetscNew(&elastic));
  material->data                 = elastic;
  material->linear               = PETSC_TRUE;
  material->ops->setfromoptions  = MaterialSetFromOptions_LinearElastic;
  material->ops->view            = MaterialView_LinearElastic;
  material->ops->destroy         = MaterialDestroy_LinearElastic;
  material->ops->uniaxialmodulus = MaterialUniaxialModulus_LinearElastic;
  material->ops->uniaxial        = MaterialUniaxial_LinearElastic;
  PetscFunctionReturn(PETSC_SUCCESS);
}
