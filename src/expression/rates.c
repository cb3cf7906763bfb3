/* Derivatives in time of what users give as functions of time. */
#include "expressionimpl.h"

/* Points of a difference formula; the notes of ExpressionEvaluateRates() give its errors */
#define RATE_POINTS 7
/* Their distance, in parts of the step */
#define RATE_SPACING 0.25

/* Weights of the values at 0, 1, 2, ..., by which value, first and second derivative at x are sums of these (Fornberg 1988, Generation of
   finite difference formulas on arbitrarily spaced grids, Math. Comp. 51, recursion of section 2) */
static void FindWeights(PetscReal x, PetscReal weights[3][RATE_POINTS])
{
  PetscReal c1 = 1;

  for (int m = 0; m < 3; m++)
    for (int i = 0; i < RATE_POINTS; i++) weights[m][i] = 0;
  weights[0][0] = 1;
  for (int i = 1; i < RATE_POINTS; i++) {
    PetscReal c2 = 1;

    for (int j = 0; j < i; j++) {
      const PetscReal c3 = i - j;

      c2 *= c3;
      if (j == i - 1)
        for (int m = PetscMin(i, 2); m >= 0; m--)
          weights[m][i] = c1 / c2 * ((m ? m * weights[m - 1][i - 1] : 0) - (i - 1 - x) * weights[m][i - 1]);
      for (int m = PetscMin(i, 2); m >= 0; m--) weights[m][j] = ((i - x) * weights[m][j] - (m ? m * weights[m - 1][j] : 0)) / c3;
    }
    c1 = c2;
  }
}

/* The value at one place and time, with its first and second derivative in time: 3 numbers. `start`: the earliest time at which the
   expression may be evaluated; `step`: a time that resolves how it varies. Differences over seven points a quarter of the step apart,
   centred, of sixth order, or shifted so as not to begin before `start`. With an angular frequency w and s = w step / 4, the relative
   errors are s^6 / 140 and s^6 / 560, and those of round-off in units of the machine's epsilon about 2 / s and 6 / s^2. A formula has to
   be defined until 3/4 of a step after the point, 3/2 steps after the start. The second derivative of a table is zero. */
PetscErrorCode ExpressionEvaluateRates(Expression expression, const ExpressionPoint *point, PetscReal start, PetscReal step,
                                       PetscReal values[])
{
  const PetscReal h      = RATE_SPACING * step;
  ExpressionPoint at     = *point;
  PetscReal       offset = (RATE_POINTS - 1) / 2., weights[3][RATE_POINTS];

  PetscFunctionBegin;
  PetscAssertPointer(values, 5);
  PetscCall(ExpressionEvaluate(expression, point, &values[0]));
  values[1] = values[2] = 0;
  if (!expression->uses_time) PetscFunctionReturn(PETSC_SUCCESS);
  if (point->t - offset * h < start) offset = PetscMax(0, (point->t - start) / h);
  FindWeights(offset, weights);
  for (int i = 0; i < RATE_POINTS; i++) {
    PetscReal value;

    at.t = point->t + (i - offset) * h;
    PetscCall(ExpressionEvaluate(expression, &at, &value));
    values[1] += weights[1][i] * value / h;
    values[2] += weights[2][i] * value / (h * h);
  }
  if (expression->table) values[2] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
