/* Constants of the stiffness that holds the hourglasses of elements with one point, from the material at zero strain. Private to src. */
#pragma once
#include <impakt/private/solid.h>

typedef struct {
  PetscReal bending, coupling; /* of two strains in a plane whose stress is plane: E / (1 - nu^2), nu times that [Pa] */
  PetscReal stretch, shear;    /* E, mu [Pa] */
} Hourglass;

PETSC_INTERN PetscErrorCode ElementCreate_Solid_Reduced(Element);
