/*
   S, the operator that takes contact forces on the rows of all pairs to the change of their gaps at the end of a controller step,

     S = sum over bodies of t_b W_b t_b,   t_b = 1 on rows whose Dirichlet side is b, -1 on those whose Neumann side it is, 0 on others,

   W_b being the interface compliance of a body. All contact methods assemble it, multiply with it, factor it and solve with it here: dense,
   the same on every rank, or by conjugate gradients with products alone. Private to src/contact.
*/
#pragma once
#include <contact/parts.h>

typedef struct _n_InterfaceOperator *InterfaceOperator;

/* What forces on both sides of the rows do to the displacements of both sides */
typedef enum { INTERFACE_GAP /* S: opposite forces on both sides; Dirichlet minus Neumann displacement */ } InterfaceMap;

typedef enum { INTERFACE_LEFT_OUT, INTERFACE_SOLVED } InterfaceMark;

typedef struct {
  const char *prefix;       /* of the options of conjugate gradients */
  PetscReal   tolerance;    /* of conjugate gradients, relative to the right-hand side */
  PetscReal   worst;        /* what they may leave of it all the same where round-off keeps them from `tolerance`, relative */
  PetscInt    dense_limit;  /* rows, times levels, up to which matrices are dense */
  PetscInt    few;          /* up to which they are so from the start */
  PetscBool   warm;         /* conjugate gradients begin with what the solution is before */
  PetscBool   precondition; /* products have a preconditioner, where rows are too many for dense matrices and bodies let it be made */
  PetscBool   sparse;       /* factors of S may be sparse, with more rows than dense_limit, where the bodies are many */
  PetscBool products; /* where matrices are not dense S is multiplied with alone, and nothing is iterated for here: they are so beyond `few`
                         where products cost little */
} InterfaceSettings;

PETSC_INTERN PetscErrorCode InterfaceOperatorCreate(Contact, const InterfaceSettings *, InterfaceOperator *);
PETSC_INTERN PetscErrorCode InterfaceOperatorDestroy(InterfaceOperator *);
PETSC_INTERN PetscErrorCode InterfaceOperatorSetMatrix(InterfaceOperator, Mat);
PETSC_INTERN PetscErrorCode InterfaceOperatorSetRows(InterfaceOperator, const InterfaceMark[], PetscInt);
PETSC_INTERN void           InterfaceOperatorGetRows(InterfaceOperator, PetscInt *, const PetscInt *[], PetscBool *);
PETSC_INTERN PetscErrorCode InterfaceOperatorAssemble(InterfaceOperator, InterfaceMap, PetscScalar[]);
PETSC_INTERN PetscErrorCode InterfaceOperatorFactor(InterfaceOperator, const PetscBool[], const PetscReal[]);
/* on the listed rows of all ranks, where matrices are dense */
PETSC_INTERN PetscErrorCode InterfaceOperatorSum(InterfaceOperator, PetscInt, PetscScalar[]);
PETSC_INTERN PetscErrorCode InterfaceOperatorGather(InterfaceOperator, const PetscScalar[], PetscScalar[]);
PETSC_INTERN void           InterfaceOperatorScatter(InterfaceOperator, const PetscScalar[], PetscScalar[]);
/* on the rows of this rank, dense or not */
PETSC_INTERN PetscErrorCode InterfaceOperatorSolve(InterfaceOperator, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode InterfaceOperatorMultiply(InterfaceOperator, InterfaceMap, const PetscScalar[], PetscScalar[]);
/* on the rows of this rank, where S is only multiplied with: what preconditions it */
PETSC_INTERN PetscBool      InterfaceOperatorHasPreconditioner(InterfaceOperator);
PETSC_INTERN PetscErrorCode InterfaceOperatorChoose(InterfaceOperator, const PetscBool[]);
PETSC_INTERN PetscErrorCode InterfaceOperatorPrecondition(InterfaceOperator, const PetscScalar[], PetscScalar[]);

PETSC_INTERN PetscErrorCode InterfaceOperatorVisit(InterfaceOperator, Checkpoint);
