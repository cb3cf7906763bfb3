/* Friction: rows across the normals of contact nodes, the law that bounds their forces, and what they dissipate. Private to src/contact. */
#pragma once
#include <contact/parts.h>

PETSC_INTERN PetscErrorCode ContactLawCreate_Coulomb(Contact, ContactFrictionLaw *);
PETSC_INTERN PetscErrorCode ContactComputeSlips(Contact);
