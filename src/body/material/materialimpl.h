#pragma once
#include <material.h>
#include <petsc/private/petscimpl.h>

struct _MaterialOps {
  PetscErrorCode (*setfromoptions)(Material);
  PetscErrorCode (*view)(Material, PetscViewer);
  PetscErrorCode (*destroy)(Material);
  PetscErrorCode (*uniaxialmodulus)(Material, PetscReal *);                       /* at zero strain */
  PetscErrorCode (*uniaxial)(Material, PetscInt, const PetscReal[], PetscReal[]); /* strain -> stress, a batch of points */
};

struct _p_Material {
  PETSCHEADER(struct _MaterialOps);
  PetscReal density; /* kg/m^3; 0 until set */
  PetscBool linear;  /* stress proportional to strain: matrices are constant */
  void     *data;
};

PETSC_INTERN PetscErrorCode MaterialCreate_LinearElastic(Material);
