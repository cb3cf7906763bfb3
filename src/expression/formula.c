/* Formulas, parsed and evaluated by muParser. */
#include "expressionimpl.h"
#include <muParserDLL.h>

/* An error handler that does nothing: muParser's own would print errors on standard output, and mupError() tells of them as well */
static void KeepQuiet(muParserHandle_t parser)
{
  (void)parser;
}

/* Ends with an error if muParser was built for wide characters, which its C interface here cannot pass */
static PetscErrorCode CheckNarrow(muParserHandle_t parser, MPI_Comm comm)
{
  const char *version = (const char *)mupGetVersion(parser);
  PetscBool   narrow  = (PetscBool)(sizeof(muChar_t) == 1 && version && version[0] && version[1]);

  PetscFunctionBegin;
  PetscCheck(narrow, comm, PETSC_ERR_LIB, "This muParser has been built for wide characters; build it with -DENABLE_WIDE_CHAR=OFF");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a formula sets a variable (x = 3), which muParser would allow */
static PetscBool Assigns(const char text[])
{
  for (const char *c = text; *c; c++) {
    if (*c != '=') continue;
    if (c[1] == '=') c++;
    else if (c == text || !(c[-1] == '<' || c[-1] == '>' || c[-1] == '!')) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Compiles a formula. `reason` says why that is not possible (else empty); `position`: the character in question, from 1, 0: not known. */
static PetscErrorCode Compile(muParserHandle_t parser, const char text[], char reason[], size_t size, PetscInt *position)
{
  int n_values = 0;

  PetscFunctionBegin;
  reason[0] = 0;
  *position = 0;
  if (Assigns(text)) {
    const char *message = "a formula cannot set a variable; to compare, write ==";

    PetscCall(PetscStrncpy(reason, message, size));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  mupSetExpr(parser, text);
  if (!mupError(parser)) (void)mupEvalMulti(parser, &n_values);
  if (mupError(parser)) {
    size_t length;

    PetscCall(PetscStrncpy(reason, mupGetErrorMsg(parser), size));
    PetscCall(PetscStrlen(reason, &length));
    while (length && strchr(". ", reason[length - 1])) reason[--length] = 0; /* the message goes on after it */
    *position = (PetscInt)mupGetErrorPos(parser) + 1;
  } else if (n_values != 1) PetscCall(PetscSNPrintf(reason, size, "it has %d values, separated by commas, where one is wanted", n_values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds out which variables a formula uses, and its value at zero */
static PetscErrorCode FindVariables(Expression expression)
{
  const int n = mupGetExprVarNum(expression->parser);

  PetscFunctionBegin;
  for (int i = 0; i < n; i++) {
    const muChar_t *name;
    muFloat_t      *variable;

    mupGetExprVar(expression->parser, (unsigned)i, &name, &variable);
    if (variable == &expression->point.t) expression->uses_time = PETSC_TRUE;
    else if (variable >= expression->point.x && variable < expression->point.x + 3) expression->uses_position = PETSC_TRUE;
    else expression->uses_normal = PETSC_TRUE;
  }
  expression->constant = mupEval(expression->parser); /* at zero; this also makes muParser compile the formula */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Parses a formula, and keeps the parser unless it is constant. All ranks parse the same text: all succeed or none. */
PetscErrorCode ExpressionParse(Expression expression, MPI_Comm comm)
{
  const char *const positions[] = {"x", "y", "z"}, *const normals[] = {"nx", "ny", "nz"};
  char             reason[512], where[64]                           = "";
  muParserHandle_t parser;
  PetscInt         position;

  PetscFunctionBegin;
  parser = mupCreate(muBASETYPE_FLOAT);
  PetscCheck(parser, comm, PETSC_ERR_LIB, "muParser cannot be started");
  expression->parser = parser; /* from now on it is freed with the expression */
  PetscCall(CheckNarrow(parser, comm));
  mupSetErrorHandler(parser, KeepQuiet);
  for (int d = 0; d < 3; d++) {
    mupDefineVar(parser, positions[d], &expression->point.x[d]);
    mupDefineVar(parser, normals[d], &expression->point.n[d]);
  }
  mupDefineVar(parser, "t", &expression->point.t);
  mupDefineConst(parser, "pi", PETSC_PI);
  mupDefineConst(parser, "e", 2.71828182845904523536);
  PetscCheck(!mupError(parser), comm, PETSC_ERR_LIB, "muParser does not take the names of variables: %s", mupGetErrorMsg(parser));
  PetscCall(Compile(parser, expression->text, reason, sizeof(reason), &position));
  if (position > 0) PetscCall(PetscSNPrintf(where, sizeof(where), " at character %" PetscInt_FMT, position));
  PetscCheck(!reason[0], comm, PETSC_ERR_USER_INPUT,
             "-%s: the formula '%s' is not understood%s: %s. A formula may use x, y, z, t (and nx, ny, nz on surfaces), pi, e, and "
             "muParser's operators and functions",
             expression->option, expression->text, where, reason);
  PetscCall(FindVariables(expression));
  if (expression->uses_position || expression->uses_normal || expression->uses_time) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(PetscAbsReal(expression->constant) <= PETSC_MAX_REAL, comm, PETSC_ERR_USER_INPUT,
             "-%s: '%s' is %g, which is not a finite number", expression->option, expression->text, (double)expression->constant);
  PetscCall(ExpressionDestroyParser(expression));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ExpressionEvaluateFormula(Expression expression, PetscReal *value)
{
  PetscFunctionBegin;
  *value = mupEval(expression->parser);
  PetscCheck(!mupError(expression->parser), PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "-%s: '%s' cannot be evaluated: %s", expression->option,
             expression->text, mupGetErrorMsg(expression->parser));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ExpressionDestroyParser(Expression expression)
{
  PetscFunctionBegin;
  if (expression->parser) mupRelease(expression->parser);
  expression->parser = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
