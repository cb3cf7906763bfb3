/* The class: a formula, a table or a number, and what it depends on; and the package of the class. */
#include "expressionimpl.h"
#include <sys/package.h>

PetscClassId EXPRESSION_CLASSID = 0;

PetscErrorCode ExpressionInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Expression", &EXPRESSION_CLASSID, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds out what the text of an expression is, and reads or parses it */
static PetscErrorCode Fill(Expression expression, MPI_Comm comm)
{
  PetscBool is_table, is_free;

  PetscFunctionBegin;
  PetscCall(PetscStrncmp(expression->text, "table:", 6, &is_table));
  if (is_table) {
    PetscBool constant;

    PetscCall(TableRead(comm, expression->option, expression->text + 6, &expression->table));
    PetscCall(TableIsConstant(expression->table, &constant));
    if (constant) expression->constant = TableEvaluate(expression->table, 0);
    else expression->uses_time = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscStrcmp(expression->text, "free", &is_free));
  PetscCheck(!is_free, comm, PETSC_ERR_USER_INPUT,
             "-%s: 'free' can only be a component of a prescribed displacement; give a number, a formula or table:file",
             expression->option);
  PetscCall(ExpressionParse(expression, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A function of place and time from what a user has written: a formula of muParser in x, y, z, t and, on surfaces, nx, ny, nz, with the
   constants pi and e; or `table:` and a file with a time and a value a line, times ascending, between which values are interpolated
   linearly, and constant before and after. `option`: where the text comes from, without its dash, for messages. Collective */
PetscErrorCode ExpressionCreate(MPI_Comm comm, const char option[], const char text[], Expression *expression)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscAssertPointer(option, 2);
  PetscAssertPointer(text, 3);
  PetscAssertPointer(expression, 4);
  PetscCall(ExpressionInitializePackage());
  PetscCall(
      PetscHeaderCreate(*expression, EXPRESSION_CLASSID, "Expression", "Formula or table", "Expression", comm, ExpressionDestroy, NULL));
  PetscCall(PetscStrallocpy(option, &(*expression)->option));
  PetscCall(PetscStrallocpy(text, &(*expression)->text));
  error = Fill(*expression, comm);
  if (error) (void)ExpressionDestroy(expression);
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The value at one place and time */
PetscErrorCode ExpressionEvaluate(Expression expression, const ExpressionPoint *point, PetscReal *value)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(point, 2);
  PetscAssertPointer(value, 3);
  if (expression->parser) {
    expression->point = *point;
    PetscCall(ExpressionEvaluateFormula(expression, value));
    PetscCheck(PetscAbsReal(*value) <= PETSC_MAX_REAL, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "-%s: '%s' is %g at x = %g, y = %g, z = %g, t = %g; it must be a finite number wherever and whenever it is needed",
               expression->option, expression->text, (double)*value, (double)point->x[0], (double)point->x[1], (double)point->x[2],
               (double)point->t);
  } else *value = expression->uses_time ? TableEvaluate(expression->table, point->t) : expression->constant;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether an expression has the same value everywhere and at all times. `value`: if so, that number; may be `NULL` */
PetscErrorCode ExpressionIsConstant(Expression expression, PetscBool *constant, PetscReal *value)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(constant, 2);
  *constant = (PetscBool) !(expression->uses_position || expression->uses_normal || expression->uses_time);
  if (*constant && value) *value = expression->constant;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What an expression depends on: `steady`: not on time; `uniform`: it has the same value everywhere; `normal`: on the normal, so that it
   has a meaning on surfaces only. Any may be `NULL` */
PetscErrorCode ExpressionGetNature(Expression expression, PetscBool *steady, PetscBool *uniform, PetscBool *normal)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  if (steady) *steady = (PetscBool)!expression->uses_time;
  if (uniform) *uniform = (PetscBool) !(expression->uses_position || expression->uses_normal);
  if (normal) *normal = expression->uses_normal;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the user has written. `text`: a formula, or `table:` and the name of a file; owned by the expression */
PetscErrorCode ExpressionGetText(Expression expression, const char *text[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(text, 2);
  *text = expression->text;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The option that the expression comes from. `option`: without its dash; owned by the expression */
PetscErrorCode ExpressionGetOption(Expression expression, const char *option[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(option, 2);
  *option = expression->option;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Frees an expression. `expression`: the `Expression`, set to `NULL`; it may be `NULL` */
PetscErrorCode ExpressionDestroy(Expression *expression)
{
  PetscFunctionBegin;
  if (!*expression) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*expression, EXPRESSION_CLASSID, 1);
  if (--((PetscObject)*expression)->refct > 0) {
    *expression = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ExpressionDestroyParser(*expression));
  PetscCall(TableDestroy(&(*expression)->table));
  PetscCall(PetscFree((*expression)->option));
  PetscCall(PetscFree((*expression)->text));
  PetscCall(PetscHeaderDestroy(expression));
  PetscFunctionReturn(PETSC_SUCCESS);
}
