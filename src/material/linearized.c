/* The linear elastic material that another one is at zero strain. */
#include <impakt/private/isotropic.h>

/* Makes the linear elastic material with the density and the elastic constants of an isotropic one at zero strain. Reads no options.
   Lame's constants come from the tangent of the material, so any isotropic model will do. Collective */
PetscErrorCode MaterialLinearize(Material material, Material *linearized)
{
  const PetscReal undeformed[9] = {0};
  PetscReal       tangent[81], lambda, mu;
  MaterialKernels kernels;
  Isotropic      *constants;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscAssertPointer(linearized, 2);
  PetscUseTypeMethod(material, kernels, PETSC_FALSE, &kernels);
  (*kernels.tangent)(kernels.data, undeformed, tangent);
  lambda = tangent[4];     /* dP_xx / dH_yy */
  mu     = tangent[9 + 1]; /* dP_xy / dH_xy */
  PetscCall(MaterialCreate(PetscObjectComm((PetscObject)material), linearized));
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)*linearized, ((PetscObject)material)->prefix));
  PetscCall(MaterialSetType(*linearized, MATERIAL_LINEAR_ELASTIC));
  (*linearized)->density      = material->density;
  (*linearized)->plane_stress = material->plane_stress;
  constants                   = (Isotropic *)(*linearized)->data;
  constants->lambda           = lambda;
  constants->mu               = mu;
  constants->plane_lambda     = 2 * lambda * mu / (lambda + 2 * mu);
  constants->poissons_ratio   = 0.5 * lambda / (lambda + mu);
  PetscCall(MaterialGetUniaxialModulus(material, &constants->youngs_modulus));
  PetscFunctionReturn(PETSC_SUCCESS);
}
