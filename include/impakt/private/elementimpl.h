/* Finite elements: flat loops over all elements of a body on this rank. Private to src/body. */
#pragma once
#include <impakt/material.h>
#include <petscdmplex.h>

#define ELEMENT_MAX_DOFS 24

typedef struct _n_Element *Element;

typedef struct {
  PetscErrorCode (*setfromoptions)(Element, MPI_Comm, const char[]);
  PetscErrorCode (*copyoptions)(Element, Element);                              /* what options have set, from the first to the second */
  PetscErrorCode (*setup)(Element, const PetscReal[]);                          /* coordinates of the rank's nodes */
  PetscErrorCode (*internalforce)(Element, const PetscScalar[], PetscScalar[]); /* adds to the second [N] */
  PetscErrorCode (*energy)(Element, const PetscScalar[], PetscReal *);          /* stored by all elements of this rank [J] */
  PetscErrorCode (*stiffness)(Element, PetscInt, const PetscScalar[],
                              PetscScalar[]); /* tangent of one element at the displacement of the rank's nodes, row by row [N/m] */
  PetscErrorCode (*mass)(Element, PetscInt, PetscScalar[]); /* consistent mass of one element [kg] */
  PetscErrorCode (*stress)(Element, const PetscScalar[],
                           PetscReal[]); /* Cauchy stress, mean of each element: xx yy zz xy yz xz, 6 x count [Pa] */
  PetscErrorCode (*points)(Element, PetscInt, PetscReal[], PetscReal[]); /* of one element: reference positions of its load points, n_points
                                                                            x dim [m], and their weights [m^3, m^2 x thickness] */
  PetscErrorCode (*destroy)(Element);
} ElementOps;

struct _n_Element {
  ElementOps ops;
  PetscErrorCode (*create)(Element); /* of this shape */
  PetscInt         dim, nodes;       /* space dimension; nodes of one element */
  PetscInt         count;            /* elements of this rank */
  const PetscInt  *connectivity;     /* count x nodes: local node numbers, in VTK's order of vertices; owned by the body */
  Material         material;
  PetscReal        cross_section; /* of bars [m^2], thickness of plane bodies [m]; 1 for other shapes */
  PetscInt         n_points;      /* load points of one element: a rule exact for quadratic functions at least */
  const PetscReal *shape;         /* shape functions there, n_points x nodes; owned by the element */
  PetscInt         inverted;      /* first element of this rank that the last internalforce() or energy() found inverted; -1: none */
  void            *data;
};

PETSC_INTERN PetscErrorCode ElementRegister(DMPolytopeType, PetscErrorCode (*)(Element));
PETSC_INTERN PetscErrorCode ElementRegisterAll(void);
PETSC_INTERN PetscErrorCode ElementFinalizePackage(void);
PETSC_INTERN PetscErrorCode ElementCreate(MPI_Comm, const char[], DMPolytopeType, Material, Element *);
PETSC_INTERN PetscErrorCode ElementCreateLike(Element, Material, Element *);
PETSC_INTERN PetscErrorCode ElementSetUp(Element, PetscInt, const PetscInt[], const PetscReal[]);
PETSC_INTERN PetscErrorCode ElementDestroy(Element *);

PETSC_INTERN PetscErrorCode ElementCreate_Bar2(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Tri3(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Quad4(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Tet4(Element);
PETSC_INTERN PetscErrorCode ElementCreate_Hex8(Element);
