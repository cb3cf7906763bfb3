/* Formulas, lists of them, and their rates */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t data[], size_t size)
{
  const ExpressionPoint point = {.x = {0.5, -1, 2}, .n = {1}, .t = 1e-3};
  char                 *text;
  Expression            expression = NULL, list[3] = {NULL};
  PetscReal             values[3];
  PetscInt              n;

  text = malloc(size + 1);
  if (!text) abort();
  memcpy(text, data, size);
  text[size] = 0;
  if (strncmp(text, "table:", 6) != 0 && !ExpressionCreate(PETSC_COMM_SELF, "-load", text, &expression)) {
    if (!ExpressionEvaluate(expression, &point, values)) FUZZ_IGNORE(ExpressionEvaluateRates(expression, &point, 0, 1e-3, values));
  }
  FUZZ_IGNORE(ExpressionDestroy(&expression));
  if (!strstr(text, "table:") && !ExpressionListCount(text, &n) && n <= 3 &&
      !ExpressionListCreate(PETSC_COMM_SELF, "-load", text, n, PETSC_FALSE, list))
    for (PetscInt i = 0; i < n; i++) FUZZ_IGNORE(ExpressionDestroy(&list[i]));
  free(text);
  return 0;
}
