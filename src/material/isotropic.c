/* Constants of isotropic models, by which they agree with linear elasticity at small strain. */
#include "isotropic.h"

static PetscErrorCode MaterialSetFromOptions_Isotropic(Material material)
{
  Isotropic  *constants = (Isotropic *)material->data;
  const char *prefix    = ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "";
  MPI_Comm    comm      = PetscObjectComm((PetscObject)material);
  PetscReal   E, nu;
  PetscBool   set;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsReal("-youngs_modulus", "Young's modulus [Pa]", "", constants->youngs_modulus, &constants->youngs_modulus, &set));
  PetscCall(PetscOptionsReal("-poissons_ratio", "Poisson's ratio", "", constants->poissons_ratio, &constants->poissons_ratio, NULL));
  PetscOptionsEnd();
  E  = constants->youngs_modulus;
  nu = constants->poissons_ratio;
  PetscCheck(set, comm, PETSC_ERR_USER_INPUT, "-%syoungs_modulus is missing; give Young's modulus in Pa", prefix);
  PetscCheck(E > 0, comm, PETSC_ERR_USER_INPUT, "-%syoungs_modulus is %g Pa; it must be positive", prefix, (double)E);
  PetscCheck(nu > -1 && nu < 0.5, comm, PETSC_ERR_USER_INPUT, "-%spoissons_ratio is %g; it must lie between -1 and 0.5", prefix,
             (double)nu);
  constants->lambda       = E * nu / ((1 + nu) * (1 - 2 * nu));
  constants->mu           = E / (2 * (1 + nu));
  constants->plane_lambda = E * nu / ((1 + nu) * (1 - nu));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialView_Isotropic(Material material, PetscViewer viewer)
{
  const Isotropic *constants = (const Isotropic *)material->data;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  Young's modulus %g Pa, Poisson's ratio %g\n", (double)constants->youngs_modulus,
                                   (double)constants->poissons_ratio));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialDestroy_Isotropic(Material material)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(material->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialUniaxialModulus_Isotropic(Material material, PetscReal *modulus)
{
  PetscFunctionBegin;
  *modulus = ((const Isotropic *)material->data)->youngs_modulus;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialWaveModulus_Isotropic(Material material, PetscBool plane_stress, PetscReal *modulus)
{
  const Isotropic *constants = (const Isotropic *)material->data;

  PetscFunctionBegin;
  *modulus = (plane_stress ? constants->plane_lambda : constants->lambda) + 2 * constants->mu;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_Isotropic(Material material)
{
  Isotropic *constants;

  PetscFunctionBegin;
  PetscCall(PetscNew(&constants));
  material->data                 = constants;
  material->ops->setfromoptions  = MaterialSetFromOptions_Isotropic;
  material->ops->view            = MaterialView_Isotropic;
  material->ops->destroy         = MaterialDestroy_Isotropic;
  material->ops->uniaxialmodulus = MaterialUniaxialModulus_Isotropic;
  material->ops->wavemodulus     = MaterialWaveModulus_Isotropic;
  PetscFunctionReturn(PETSC_SUCCESS);
}
