/* Finite elements: what turns the displacements of a body's nodes into forces on them. */
#pragma once
#include <impakt/material.h>
#include <petscdmplex.h>

/*S
   Element - all finite elements of a body on this rank: one shape of cell, one material, flat loops over all of them

   Level: intermediate

   Notes:
   A body makes its own `Element` from the shape of the cells of its mesh; programs meet elements where they add a shape with
   `ElementRegister()`. What such an element has to do is in `<impakt/private/elementimpl.h>`; solid elements with a few shape functions
   are easier to write with the loops in `<impakt/private/solidloops.h>`.

.seealso: `ElementRegister()`, `BodySetThickness()`, `Material`
S*/
typedef struct _p_Element *Element;

/* Formulations that Impakt brings, for -<body>_element_formulation */
#define ELEMENT_FULL            "full"
#define ELEMENT_MEAN_DILATATION "mean_dilatation"
#define ELEMENT_ENHANCED        "enhanced"
#define ELEMENT_REDUCED         "reduced"
#define ELEMENT_COMPOSITE       "composite"

PETSC_EXTERN PetscClassId ELEMENT_CLASSID;

PETSC_EXTERN PetscErrorCode ElementRegister(DMPolytopeType, PetscErrorCode (*)(Element));
