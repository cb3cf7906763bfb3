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

/*@C
  ExpressionCreate - a function of place and time from what a user has written

  Collective

  Input Parameters:
+ comm   - communicator; the text is the same on all its ranks
. option - where the text comes from, without the first `-`; for messages only
- text   - a formula, or `table:` and the name of a file

  Output Parameter:
. expression - the `Expression`

  Level: intermediate

  Notes:
  A formula is written in the variables x, y, z (reference position [m]), t (time [s]) and, on surfaces, nx, ny, nz (outward unit
  normal), with the constants pi and e and the operators and functions of muParser: + - * / ^, comparisons, && and ||, c ? a : b,
  sin, cos, tan, exp, ln, sqrt, abs, sign, min, max and so on.

  A table is a file with two numbers a line, a time [s] and a value, separated by blanks or a comma, times ascending; what follows
  a # is a comment. Values are interpolated linearly, and constant before the first and after the last line.

.seealso: `Expression`, `ExpressionListCreate()`, `ExpressionEvaluate()`, `ExpressionDestroy()`
@*/
PetscErrorCode ExpressionCreate(MPI_Comm comm, const char option[], const char text[], Expression *expression)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscAssertPointer(option, 2);
  PetscAssertPointer(text, 3);
  PetscAssertPointer(expression, 4);
  PetscCall(ExpressionInitializePackage());
  PetscCall(PetscHeaderCreate(*expression, EXPRESSION_CLASSID, "Expression", "Formula or table", "Expression", comm, ExpressionDestroy,
                              ExpressionView));
  PetscCall(PetscStrallocpy(option, &(*expression)->option));
  PetscCall(PetscStrallocpy(text, &(*expression)->text));
  error = Fill(*expression, comm);
  if (error) (void)ExpressionDestroy(expression);
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExpressionEvaluate - the value at one place and time

  Not Collective

  Input Parameters:
+ expression - the `Expression`
- point      - place, normal and time

  Output Parameter:
. value - a finite number; if the expression has none there, the call ends with an error

  Level: intermediate

.seealso: `Expression`, `ExpressionEvaluateRates()`
@*/
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

/*@
  ExpressionIsConstant - whether an expression has the same value everywhere and at all times

  Not Collective

  Input Parameter:
. expression - the `Expression`

  Output Parameters:
+ constant - whether it uses no variable
- value    - if so, that number; may be `NULL`

  Level: intermediate

.seealso: `Expression`, `ExpressionIsSteady()`, `ExpressionIsUniform()`
@*/
PetscErrorCode ExpressionIsConstant(Expression expression, PetscBool *constant, PetscReal *value)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(constant, 2);
  *constant = (PetscBool) !(expression->uses_position || expression->uses_normal || expression->uses_time);
  if (*constant && value) *value = expression->constant;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExpressionIsSteady - whether an expression does not depend on time

  Not Collective

  Input Parameter:
. expression - the `Expression`

  Output Parameter:
. steady - whether it does not use t

  Level: intermediate

.seealso: `Expression`, `ExpressionIsUniform()`
@*/
PetscErrorCode ExpressionIsSteady(Expression expression, PetscBool *steady)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(steady, 2);
  *steady = (PetscBool)!expression->uses_time;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExpressionIsUniform - whether an expression has the same value everywhere

  Not Collective

  Input Parameter:
. expression - the `Expression`

  Output Parameter:
. uniform - whether it uses neither the position nor the normal

  Level: intermediate

.seealso: `Expression`, `ExpressionIsSteady()`
@*/
PetscErrorCode ExpressionIsUniform(Expression expression, PetscBool *uniform)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(uniform, 2);
  *uniform = (PetscBool) !(expression->uses_position || expression->uses_normal);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExpressionUsesNormal - whether an expression depends on the normal, and so has a meaning on surfaces only

  Not Collective

  Input Parameter:
. expression - the `Expression`

  Output Parameter:
. normal - whether it uses nx, ny or nz

  Level: intermediate

.seealso: `Expression`
@*/
PetscErrorCode ExpressionUsesNormal(Expression expression, PetscBool *normal)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(normal, 2);
  *normal = expression->uses_normal;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ExpressionGetText - what the user has written

  Not Collective

  Input Parameter:
. expression - the `Expression`

  Output Parameter:
. text - a formula, or `table:` and the name of a file; owned by the expression

  Level: intermediate

.seealso: `Expression`, `ExpressionCreate()`
@*/
PetscErrorCode ExpressionGetText(Expression expression, const char *text[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(text, 2);
  *text = expression->text;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ExpressionGetOption - the option that the expression comes from

  Not Collective

  Input Parameter:
. expression - the `Expression`

  Output Parameter:
. option - without its dash; owned by the expression

  Level: intermediate

.seealso: `Expression`, `ExpressionCreate()`
@*/
PetscErrorCode ExpressionGetOption(Expression expression, const char *option[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  PetscAssertPointer(option, 2);
  *option = expression->option;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExpressionView - prints an expression

  Collective

  Input Parameters:
+ expression - the `Expression`
- viewer     - an ASCII viewer, `NULL` for standard output

  Level: developer

.seealso: `Expression`
@*/
PetscErrorCode ExpressionView(Expression expression, PetscViewer viewer)
{
  PetscBool ascii;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(expression, EXPRESSION_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)expression), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (ascii) PetscCall(PetscViewerASCIIPrintf(viewer, "%s: %s\n", expression->option, expression->text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExpressionDestroy - frees an expression

  Not Collective

  Input Parameter:
. expression - the `Expression`, set to `NULL`; it may be `NULL`

  Level: intermediate

.seealso: `Expression`, `ExpressionCreate()`
@*/
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
