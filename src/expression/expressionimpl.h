/* What formulas and tables share. Private to src/expression. */
#pragma once
#include <impakt/expression.h>
#include <petsc/private/petscimpl.h>

typedef struct _n_Table *Table;

struct _p_Expression {
  PETSCHEADER(int);
  char           *option, *text;
  PetscBool       uses_position, uses_normal, uses_time;
  PetscReal       constant; /* the value, if it uses none of these */
  void           *parser;   /* muParser's, which reads its variables from `point`; NULL for a constant or a table */
  ExpressionPoint point;
  Table           table;
};

PETSC_INTERN PetscErrorCode ExpressionParse(Expression, MPI_Comm);
PETSC_INTERN PetscErrorCode ExpressionEvaluateFormula(Expression, PetscReal *);
PETSC_INTERN PetscErrorCode ExpressionDestroyParser(Expression);
PETSC_INTERN PetscErrorCode TableRead(MPI_Comm, const char[], const char[], Table *);
PETSC_INTERN PetscReal      TableEvaluate(Table, PetscReal);
PETSC_INTERN PetscErrorCode TableIsConstant(Table, PetscBool *);
PETSC_INTERN PetscErrorCode TableDestroy(Table *);
