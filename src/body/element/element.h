/* Finite elements: flat loops over all elements of a body on this rank. Private to src/body. */
#pragma once
#include <material.h>
#include <petscdmplex.h>

#define ELEMENT_MAX_DOFS 24

typedef struct _n_Element *Element;

typedef struct {
  PetscErrorCode (*setfromoptions)(Element, MPI_Comm, const char[]);
  PetscErrorCode (*setup)(Element, const PetscReal[]);                                /* coordinates of the rank's nodes */
  PetscErrorCode (*internalforce)(Element, const PetscScalar[], PetscScalar[]);       /* adds to the second */
  PetscErrorCode (*stiffness)(Element, PetscInt, const PetscScalar[], PetscScalar[]); /* tangent of one element, row by row */
  PetscErrorCode (*mass)(Element, PetscInt, PetscScalar[]);                           /* consistent mass of one element */
  PetscErrorCode (*destroy)(Element);
} ElementOps;

struct _n_Element {
  ElementOps      ops;
  PetscInt        dim, nodes;   /* space dimension; nodes of one element */
  PetscInt        count;        /* elements of this rank */
  const PetscInt *connectivity; /* count x nodes: local node numbers; owned by the body */
  Material        material;
  PetscReal       cross_section; /* of bars [m^2]; 1 for other shapes */
  void           *data;
};

PETSC_INTERN PetscErrorCode ElementRegister(DMPolytopeType, PetscErrorCode (*)(Element));
PETSC_INTERN PetscErrorCode ElementRegisterAll(void);
PETSC_INTERN PetscErrorCode ElementFinalizePackage(void);
PETSC_INTERN PetscErrorCode ElementCreate(MPI_Comm, const char[], DMPolytopeType, Material, Element *);
PETSC_INTERN PetscErrorCode ElementSetUp(Element, PetscInt, const PetscInt[], const PetscReal[]);
PETSC_INTERN PetscErrorCode ElementDestroy(Element *);

PETSC_INTERN PetscErrorCode ElementCreate_Bar2(Element);
