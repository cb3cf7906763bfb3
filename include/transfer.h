/* What goes between the two surfaces of a contact pair, and back by the transpose. */
#pragma once
#include <petscmat.h>
#include <surface.h>

/*S
   Transfer - rows that compare the two surfaces of a contact pair: the gap at a node i of the Dirichlet side is

     gap_i = gap_i^0 + n_i . sum_j P_ij u_j  -  n_i . u_i,

   with its outward normal n_i and the nodes j of the Neumann side's face opposite to it, whose weights P_ij sum to one. The first
   sum is a row of the Neumann side's matrix, n_i . u_i of the Dirichlet side's. Forces go back by the transposes.

   Level: developer

.seealso: `TransferCreate()`, `TransferSetValues()`
S*/
typedef struct _n_Transfer *Transfer;

PETSC_EXTERN PetscErrorCode TransferCreate(MPI_Comm, Surface, Surface, Transfer *);
PETSC_EXTERN PetscErrorCode TransferDestroy(Transfer *);
PETSC_EXTERN PetscErrorCode TransferGetSize(Transfer, PetscInt *);
PETSC_EXTERN PetscErrorCode TransferGetRow(Transfer, PetscInt, PetscInt *, PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode TransferSetValues(Transfer, PetscInt, PetscInt, Mat, Mat);
PETSC_EXTERN PetscErrorCode TransferGetNodes(Transfer, PetscBool, PetscInt *, const PetscInt *[]);
