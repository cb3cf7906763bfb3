/* What the implementation of a constitutive model needs. */
#pragma once
#include <impakt/material.h>
#include <petsc/private/petscimpl.h>

/* Densities and moduli, in any units: products with squares of times and sizes are numbers */
#define MATERIAL_SMALLEST 1e-60
#define MATERIAL_LARGEST  1e60

struct _MaterialOps {
  PetscErrorCode (*setfromoptions)(Material);
  PetscErrorCode (*setup)(Material); /* an error where a constant is missing */
  PetscErrorCode (*view)(Material, PetscViewer);
  PetscErrorCode (*destroy)(Material);
  PetscErrorCode (*kernels)(Material, PetscBool, MaterialKernels *); /* in plane stress, or not */
  PetscErrorCode (*wavemodulus)(Material, PetscBool, PetscReal *);   /* at zero strain; in plane stress, or not */
  PetscErrorCode (*uniaxialmodulus)(Material, PetscReal *);          /* at zero strain */
  /* of bars, a batch of points: strain -> stress, its derivative, its integral, of which any may be NULL */
  PetscErrorCode (*uniaxial)(Material, PetscInt, const PetscReal[], PetscReal[], PetscReal[], PetscReal[]);
};

/* What kernels of plane stress need of the solid */
typedef struct {
  MaterialKernels solid;
  void (*thickness)(const void *data, const PetscReal H[9][8], PetscReal Hzz[8]); /* NULL: by Newton's method */
} PlaneStressData;

struct _p_Material {
  PETSCHEADER(struct _MaterialOps);
  PetscReal       density;      /* kg/m^3; 0 until set */
  PetscBool       linear;       /* stress proportional to strain: matrices are constant */
  PetscBool       isotropic;    /* `data` begins with an `Isotropic` */
  PetscBool       plane_stress; /* what MaterialGetKernels() and MaterialGetWaveModulus() speak of */
  PlaneStressData plane;        /* data of the kernels of plane stress, for models that use MaterialCondenseKernels() */
  void           *data;
};

PETSC_INTERN PetscFunctionList MaterialList;

PETSC_EXTERN PetscErrorCode MaterialSetUp(Material);
PETSC_EXTERN PetscErrorCode MaterialCondenseKernels(Material, void (*)(const void *, const PetscReal[9][8], PetscReal[8]),
                                                    MaterialKernels *);
PETSC_EXTERN void           MaterialFindThickness(const MaterialKernels *, PetscReal[9][8]);
PETSC_EXTERN PetscReal      MaterialFindSides(const MaterialKernels *, PetscReal, PetscReal[9][8], PetscReal[9][8], PetscReal[81]);
PETSC_INTERN PetscErrorCode MaterialCreate_LinearElastic(Material);
PETSC_INTERN PetscErrorCode MaterialCreate_SaintVenantKirchhoff(Material);
PETSC_INTERN PetscErrorCode MaterialCreate_NeoHookean(Material);
PETSC_INTERN PetscErrorCode MaterialCreate_MooneyRivlin(Material);
PETSC_INTERN PetscErrorCode MaterialCreate_J2(Material);
PETSC_INTERN PetscErrorCode MaterialCreate_J2Small(Material);
PETSC_INTERN PetscErrorCode MaterialCreate_JohnsonCook(Material);
