/* Functions of place and time that users write in options. */
#pragma once
#include <petscsys.h>

/* A formula in x, y, z, t (and, on surfaces, the outward unit normal nx, ny, nz), or a table in t */
typedef struct _p_Expression *Expression;

PETSC_EXTERN PetscClassId EXPRESSION_CLASSID;

/* What a formula may refer to */
typedef struct {
  PetscReal x[3]; /* reference position [m], zeros beyond the space dimension */
  PetscReal n[3]; /* outward unit normal of a surface there, else zeros */
  PetscReal t;    /* s */
} ExpressionPoint;

PETSC_EXTERN PetscErrorCode ExpressionInitializePackage(void);
PETSC_EXTERN PetscErrorCode ExpressionCreate(MPI_Comm, const char[], const char[], Expression *);
PETSC_EXTERN PetscErrorCode ExpressionEvaluate(Expression, const ExpressionPoint *, PetscReal *);
PETSC_EXTERN PetscErrorCode ExpressionEvaluateRates(Expression, const ExpressionPoint *, PetscReal, PetscReal, PetscReal[]);
PETSC_EXTERN PetscErrorCode ExpressionIsConstant(Expression, PetscBool *, PetscReal *);
PETSC_EXTERN PetscErrorCode ExpressionGetNature(Expression, PetscBool *, PetscBool *, PetscBool *);
PETSC_EXTERN PetscErrorCode ExpressionGetOption(Expression, const char *[]);
PETSC_EXTERN PetscErrorCode ExpressionGetText(Expression, const char *[]);
PETSC_EXTERN PetscErrorCode ExpressionDestroy(Expression *);
PETSC_EXTERN PetscErrorCode ExpressionListCreate(MPI_Comm, const char[], const char[], PetscInt, PetscBool, Expression[]);
PETSC_EXTERN PetscErrorCode ExpressionListCount(const char[], PetscInt *);
