/* Tables of times and values */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t data[], size_t size)
{
  const ExpressionPoint points[] = {{.t = -1}, {.t = 0}, {.t = 0.5}, {.t = 1e9}};
  char                  path[64], text[80];
  Expression            expression = NULL;
  PetscReal             values[3];

  FuzzWrite(data, size, ".txt", path, sizeof(path));
  (void)snprintf(text, sizeof(text), "table:%s", path);
  if (!ExpressionCreate(PETSC_COMM_SELF, "-load", text, &expression))
    for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(points); i++)
      FUZZ_IGNORE(ExpressionEvaluateRates(expression, &points[i], 0, 1e-3, values));
  FUZZ_IGNORE(ExpressionDestroy(&expression));
  (void)unlink(path);
  return 0;
}
