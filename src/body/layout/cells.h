/* The first part of the layout, after which elements may read their options. Private to src/body. */
#pragma once
#include <impakt/body.h>

PETSC_INTERN PetscErrorCode BodySetUpCells(Body);
PETSC_INTERN PetscErrorCode BodyFindComposite(Body);
PETSC_INTERN PetscErrorCode BodySetUpComposite(Body);
