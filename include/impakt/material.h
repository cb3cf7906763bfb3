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
+ `MATERIAL_LINEAR_ELASTIC`          - isotropic linear elasticity
. `MATERIAL_SAINT_VENANT_KIRCHHOFF` - stress proportional to the Green-Lagrange strain
. `MATERIAL_NEO_HOOKEAN`            - compressible neo-Hookean hyperelasticity
. `MATERIAL_MOONEY_RIVLIN`          - Mooney-Rivlin hyperelasticity with volumetric and isochoric parts
. `MATERIAL_J2`                     - metal plasticity at finite strain: von Mises' yield condition, Hencky's elasticity
. `MATERIAL_J2_SMALL`               - the same for small strains and rotations
- `MATERIAL_JOHNSON_COOK`           - metal plasticity at finite strain, whose strength depends on rate and temperature

   Level: beginner

.seealso: `MaterialSetType()`
J*/
typedef const char *MaterialType;
#define MATERIAL_LINEAR_ELASTIC         "linear_elastic"
#define MATERIAL_SAINT_VENANT_KIRCHHOFF "saint_venant_kirchhoff"
#define MATERIAL_NEO_HOOKEAN            "neo_hookean"
#define MATERIAL_MOONEY_RIVLIN          "mooney_rivlin"
#define MATERIAL_J2                     "j2"
#define MATERIAL_J2_SMALL               "j2_small"
#define MATERIAL_JOHNSON_COOK           "johnson_cook"

/*S
   MaterialKernels - what the element loops call: plain functions of batches of 8 points, for speed without error codes

   Level: developer

   Notes:
   Tensors are laid out component first: H[3 i + k][p] is du_i/dX_k of point p. In plane strain the third row and column are zero.
   In plane stress (`MaterialSetPlaneStress()`) what is given for H[8], and for H[2], H[5], H[6], H[7], is not read, and the stress
   across the plane is zero.

   A material with history has `n_history` numbers for each point, all zero to begin with: history[c][p] is number c of point p. Its
functions advance() and advancetangent() are the response to a step from the history at the start of the step; hold() is that of a history
as it is. stress(), energy() and tangent() are those of the virgin material as if nothing irreversible happened.

   Every function returns NaN for a point at which the material is not defined: for nonlinear models an inverted one, det(I + H) <= 0, and
   in plane stress one at which no stretch across the plane leaves it free of stress. Linear elasticity is defined everywhere.

.seealso: `Material`
S*/
typedef struct {
  const void *data; /* to be handed to the functions; owned by the material */
  /* first Piola-Kirchhoff stress [Pa] at 8 points, for displacement gradients H */
  void (*stress)(const void *data, const PetscReal H[9][8], PetscReal P[9][8]);
  /* stored energy [J/m^3] at 8 points */
  void (*energy)(const void *data, const PetscReal H[9][8], PetscReal W[8]);
  /* dP/dH at one point: tangent[9 (3 i + j) + 3 k + l] = dP_ij / dH_kl [Pa] */
  void (*tangent)(const void *data, const PetscReal H[9], PetscReal tangent[81]);
  /* of materials with history */
  PetscInt n_history;                    /* numbers for each point; 0: none */
  PetscInt plastic_strain, plastic_work; /* which of them are the equivalent plastic strain, and plastic work [J/m^3] */
  PetscInt taken; /* and which the same of the mean of the stresses at both ends of each step, by the trapezoidal rule; 0: there is none */
  /* stress at the end of a step of dt [s] to H, from the history at its start; `end`, unless NULL, becomes the history at its end. A
     negative dt: nothing flows. */
  void (*advance)(const void *data, PetscReal dt, const PetscReal H[9][8], const PetscReal start[][8], PetscReal end[][8],
                  PetscReal P[9][8]);
  /* stored energy, and stress unless P is NULL, for a history as it is */
  void (*hold)(const void *data, const PetscReal H[9][8], const PetscReal now[][8], PetscReal W[8], PetscReal P[9][8]);
  /* derivative of advance()'s stress at one point */
  void (*advancetangent)(const void *data, PetscReal dt, const PetscReal H[9], const PetscReal start[], PetscReal tangent[81]);
} MaterialKernels;

PETSC_EXTERN PetscClassId MATERIAL_CLASSID;

PETSC_EXTERN PetscErrorCode MaterialInitializePackage(void);
PETSC_EXTERN PetscErrorCode MaterialRegister(const char[], PetscErrorCode (*)(Material));

PETSC_EXTERN PetscErrorCode MaterialCreate(MPI_Comm, Material *);
PETSC_EXTERN PetscErrorCode MaterialSetType(Material, MaterialType);
PETSC_EXTERN PetscErrorCode MaterialSetDensity(Material, PetscReal);
PETSC_EXTERN PetscErrorCode MaterialGetDensity(Material, PetscReal *);
PETSC_EXTERN PetscErrorCode MaterialSetYoungsModulus(Material, PetscReal);
PETSC_EXTERN PetscErrorCode MaterialGetYoungsModulus(Material, PetscReal *);
PETSC_EXTERN PetscErrorCode MaterialSetPoissonsRatio(Material, PetscReal);
PETSC_EXTERN PetscErrorCode MaterialGetPoissonsRatio(Material, PetscReal *);
PETSC_EXTERN PetscErrorCode MaterialSetFromOptions(Material);
PETSC_EXTERN PetscErrorCode MaterialView(Material, PetscViewer);
PETSC_EXTERN PetscErrorCode MaterialDestroy(Material *);

PETSC_EXTERN PetscErrorCode MaterialGetUniaxialModulus(Material, PetscReal *);
PETSC_EXTERN PetscErrorCode MaterialIsLinear(Material, PetscBool *);
PETSC_EXTERN PetscErrorCode MaterialGetWaveModulus(Material, PetscReal *);
PETSC_EXTERN PetscErrorCode MaterialSetPlaneStress(Material, PetscBool);
PETSC_EXTERN PetscErrorCode MaterialGetKernels(Material, MaterialKernels *);
PETSC_EXTERN PetscErrorCode MaterialLinearize(Material, Material *);
PETSC_EXTERN PetscErrorCode MaterialComputeUniaxial(Material, PetscInt, const PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode MaterialComputeUniaxialTangent(Material, PetscInt, const PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode MaterialComputeUniaxialEnergy(Material, PetscInt, const PetscReal[], PetscReal[]);
