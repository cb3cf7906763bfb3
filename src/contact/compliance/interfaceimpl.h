/* The operator of interfaceoperator.h. Private to the files that make it up. */
#pragma once
#include "interfaceoperator.h"
#include <solver/densefactor.h>
#include <solver/sparsefactor.h>

typedef struct _n_InterfacePreconditioner *InterfacePreconditioner;

struct _n_InterfaceOperator {
  Contact           contact; /* borrowed */
  InterfaceSettings settings;
  PetscBool        *feels;  /* per body: its displacements answer to forces at the end of the step */
  Mat               matrix; /* S where it is given as a sparse matrix, else NULL: from the compliance of the bodies */
  PetscInt          levels; /* matrices for forces at as many times in the controller step, as a convolution */
  /* rows of all ranks that are solved for, on every rank, in ascending order */
  PetscInt  n, room;
  PetscInt *rows;
  PetscInt *body_rows, *body_places; /* work space: those that concern a body, by its own numbers; their places in the list */
  /* groups of these, between which S is zero: each row's, and how many rows each has */
  PetscInt   n_groups, *group, *group_rows;
  PetscInt  *body_group;           /* work space, per body */
  PetscInt  *of_body, *body_begin; /* places of the rows of each body in the list, body by body; where those of each begin, and the end */
  PetscBool *has_rows;             /* per body: it answers to forces on some of the listed rows */
  /* dense: the compliance of each body on the rows of its own that are solved for, by columns, body by body and level by level, or all of
     a sparse S as one block; and where the block of each body begins in a level, and the end */
  PetscBool    dense, assembled;
  PetscInt    *block_begin, blocks_room;
  PetscScalar *blocks, *gathered; /* the latter is work space: values of one body's rows */
  DenseFactor  factor;            /* of S at the first level with the diagonal, on the rows that are `in` */
  SparseFactor sparse;            /* the same in its place where bodies are many */
  PetscBool    is_sparse;
  PetscBool    factored;
  PetscInt     n_in, *places; /* which of the listed rows these are, group by group */
  PetscScalar *listed[2];     /* work space */
  PetscScalar *grouped;       /* work space, in the order of places */
  /* rows of this rank */
  InterfaceMark *marks;
  PetscScalar   *diagonal; /* added to that of S, less than 0 on rows that are not solved for at present */
  /* conjugate gradients */
  InterfacePreconditioner preconditioner; /* NULL: the diagonal alone */
  KSP                     iterative;
  Vec                     unknown, rhs;
  Vec                    *on_bodies;                /* per body two, of its rows; NULL where it does not feel forces */
  PetscLogDouble product_flops, spent, dense_flops; /* of one product; of all iterations so far; of dense matrices that are put off, or 0 */
};

PETSC_INTERN PetscErrorCode InterfaceOperatorMakeRoom(InterfaceOperator, PetscInt);
PETSC_INTERN PetscErrorCode InterfaceOperatorListBodyRows(InterfaceOperator, PetscInt, PetscInt *);
PETSC_INTERN PetscErrorCode InterfaceOperatorFindGroups(InterfaceOperator);
PETSC_INTERN PetscErrorCode InterfaceBlocksUpdate(InterfaceOperator);
PETSC_INTERN void           InterfaceBlocksAdd(InterfaceOperator, PetscInt, const PetscInt[], PetscInt, PetscScalar[]);
PETSC_INTERN PetscErrorCode InterfaceBlocksMultiply(InterfaceOperator, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode InterfaceBlocksVisit(InterfaceOperator, Checkpoint);
PETSC_INTERN PetscInt       InterfaceBlockPlaces(InterfaceOperator, PetscInt, const PetscInt *[]);
PETSC_INTERN PetscErrorCode InterfaceOperatorSolveListed(InterfaceOperator, PetscScalar[]);
PETSC_INTERN PetscErrorCode InterfaceFactorVisit(InterfaceOperator, Checkpoint);
PETSC_INTERN PetscErrorCode InterfaceOperatorCreateVecs(InterfaceOperator);
PETSC_INTERN PetscErrorCode InterfaceOperatorApply(InterfaceOperator, Vec, Vec);
PETSC_INTERN PetscErrorCode InterfaceOperatorIterate(InterfaceOperator, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode InterfaceOperatorCreateProducts(InterfaceOperator);
PETSC_INTERN PetscErrorCode InterfaceOperatorCreateIterative(InterfaceOperator);
PETSC_INTERN PetscErrorCode InterfaceOperatorDestroyIterative(InterfaceOperator);
PETSC_INTERN PetscErrorCode InterfacePreconditionerCreate(InterfaceOperator, InterfacePreconditioner *);
PETSC_INTERN PetscErrorCode InterfacePreconditionerDestroy(InterfacePreconditioner *);

/* Where matrices of bodies are joined to one: the number in it of a row of one of them, with this layout, that any rank has; `shift` is
   what comes to numbers of each rank, of which this one is `mine` */
static inline PetscErrorCode InterfaceFindNumber(PetscLayout layout, const PetscInt shift[], PetscMPIInt mine, PetscInt row,
                                                 PetscInt *number)
{
  PetscFunctionBegin;
  if (row < layout->rstart || row >= layout->rend) PetscCall(PetscLayoutFindOwner(layout, row, &mine));
  *number = row + shift[mine];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a row of this rank is solved for at present */
static inline PetscBool InterfaceIsIn(InterfaceOperator op, PetscInt i)
{
  return (PetscBool)(PetscRealPart(op->diagonal[i]) >= 0);
}

/* With what sign forces on row i act on body b, and its displacement counts */
static inline PetscInt InterfaceSide(const ContactPair *pair, PetscInt b)
{
  return (pair->body[pair->dirichlet] == b) - (pair->body[1 - pair->dirichlet] == b);
}
