/* The elements around each node of a body. */
#pragma once
#include <petscsys.h>
#include <impakt/body.h>

struct _n_NodeElements {
  PetscInt        nodes, count;     /* of an element; elements */
  const PetscInt *connectivity;     /* of the elements; owned by the body */
  PetscInt       *begin, *elements; /* per node of this rank: where its elements begin, and all of these */
};
typedef struct _n_NodeElements *NodeElements;

PETSC_INTERN PetscErrorCode BodyGetNodeElements(Body, NodeElements *);
PETSC_INTERN PetscErrorCode NodeElementsDestroy(NodeElements *);
PETSC_INTERN PetscErrorCode NodeElementsFindDistances(NodeElements, PetscInt, PetscInt, const PetscInt[], PetscInt, PetscInt[], PetscInt *,
                                                      PetscInt[]);
