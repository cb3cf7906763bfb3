/* What a material answers: stress, energy, tangent and moduli. */
#include <impakt/private/materialimpl.h>

/* Tangent of uniaxial stress against uniaxial strain, at zero strain (Young's modulus). `modulus`: [Pa] */
PetscErrorCode MaterialGetUniaxialModulus(Material material, PetscReal *modulus)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscAssertPointer(modulus, 2);
  PetscUseTypeMethod(material, uniaxialmodulus, modulus);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether stress is proportional to strain, so that stiffness matrices are constant */
PetscErrorCode MaterialIsLinear(Material material, PetscBool *linear)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscAssertPointer(linear, 2);
  *linear = material->linear;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Modulus M of the fastest wave at zero strain, speed sqrt(M / density). `modulus`: lambda + 2 mu; in plane stress E / (1 - nu^2) [Pa] */
PetscErrorCode MaterialGetWaveModulus(Material material, PetscReal *modulus)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscAssertPointer(modulus, 2);
  PetscUseTypeMethod(material, wavemodulus, material->plane_stress, modulus);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the body is a thin plate, free of stress across it; else gradients are as given: plane strain with a third row and column of 0 */
PetscErrorCode MaterialSetPlaneStress(Material material, PetscBool plane_stress)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscValidLogicalCollectiveBool(material, plane_stress, 2);
  material->plane_stress = plane_stress;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The functions that element loops call. `kernels`: stress, energy and tangent; their data is the material's own and lives until it is
   destroyed or changes its type. In plane stress or not, as `MaterialSetPlaneStress()` said before */
PetscErrorCode MaterialGetKernels(Material material, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscAssertPointer(kernels, 2);
  PetscUseTypeMethod(material, kernels, material->plane_stress, kernels);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nominal stress of bars with free sides, for a batch of strains. `stress`: stresses: force over reference cross-section [Pa], n of them;
   NaN where the material is not defined. Nonlinear models are not defined at strains of -1 and below; nor is Saint-Venant-Kirchhoff's
   where the sides would have no width left, 2 nu (e + e^2/2) >= 1, and the neo-Hookean one where they have no equilibrium (large
   stretches with a negative Poisson's ratio) */
PetscErrorCode MaterialComputeUniaxial(Material material, PetscInt n, const PetscReal strain[], PetscReal stress[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscUseTypeMethod(material, uniaxial, n, strain, stress, NULL, NULL);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Derivative of nominal stress by strain of bars with free sides. `tangent`: n of them [Pa]; NaN where not defined */
PetscErrorCode MaterialComputeUniaxialTangent(Material material, PetscInt n, const PetscReal strain[], PetscReal tangent[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscUseTypeMethod(material, uniaxial, n, strain, NULL, tangent, NULL);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stored energy of bars with free sides for n strains. `energy`: n, per reference volume [J/m^3]; NaN where not defined */
PetscErrorCode MaterialComputeUniaxialEnergy(Material material, PetscInt n, const PetscReal strain[], PetscReal energy[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscUseTypeMethod(material, uniaxial, n, strain, NULL, NULL, energy);
  PetscFunctionReturn(PETSC_SUCCESS);
}
