/* The logarithm of a symmetric tensor 1 + A, and its first two derivatives, from eigenvalues: for one point at a time, where series do not
   serve. Derivatives are divided differences of the eigenvalues, in a form that holds however close these are (R. Hill, Aspects of
   invariance in solids, 1978; C. Miehe, M. Lambrecht, Algorithms for computation of stresses and elasticity moduli in terms of Seth-Hill's
   family of generalized strain tensors, 2001). */
#include "logarithm.h"
#include <impakt/private/plastic.h>
#include <math.h>

#define MAX_SWEEPS 30
/* Closer eigenvalues than this, relative to their mean, have a second divided difference by its series */
#define CLOSE     0.1
#define MAX_TERMS 24

/* Jacobi's method: a becomes diagonal, the columns of Q its axes */
static void Diagonalise(PetscReal a[3][3], PetscReal Q[3][3])
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) Q[i][j] = i == j;
  for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
    const PetscReal off = PetscAbsReal(a[0][1]) + PetscAbsReal(a[0][2]) + PetscAbsReal(a[1][2]);

    if (!(off > 0)) return;
    for (int i = 0; i < 2; i++)
      for (int j = i + 1; j < 3; j++) {
        const PetscReal half = 0.5 * (a[j][j] - a[i][i]), b = a[i][j];
        PetscReal       t, c, s;

        if (b == 0) continue;
        t = b / (PetscAbsReal(half) + hypot(half, b)); /* their squares may underflow */
        if (half < 0) t = -t;
        c = 1 / PetscSqrtReal(1 + t * t);
        s = t * c;
        a[i][i] -= t * b;
        a[j][j] += t * b;
        a[i][j] = a[j][i] = 0;
        {
          const int       k = 3 - i - j;
          const PetscReal x = a[k][i], y = a[k][j];

          a[k][i] = a[i][k] = c * x - s * y;
          a[k][j] = a[j][k] = s * x + c * y;
        }
        for (int k = 0; k < 3; k++) {
          const PetscReal x = Q[k][i], y = Q[k][j];

          Q[k][i] = c * x - s * y;
          Q[k][j] = s * x + c * y;
        }
      }
  }
}

/* (ln x - ln y) / (x - y) at 1 + a and 1 + b */
static PetscReal First(PetscReal a, PetscReal b)
{
  const PetscReal y = 1 + b, r = (a - b) / y;

  return (r == 0 ? 1 : log1p(r) / r) / y;
}

/* The second divided difference of the logarithm at 1 + a, 1 + b, 1 + c */
static PetscReal Second(PetscReal a, PetscReal b, PetscReal c)
{
  const PetscReal mean = (a + b + c) / 3, y = 1 + mean, low = PetscMin(a, PetscMin(b, c)), high = PetscMax(a, PetscMax(b, c));

  if (high - low > CLOSE * y) {
    const PetscReal middle = a + b + c - low - high;

    return (First(high, middle) - First(middle, low)) / (high - low);
  } else {
    const PetscReal u = (a - mean) / y, v = (b - mean) / y, w = (c - mean) / y;
    PetscReal       of_u = 1, of_v = 1, of_w = 1, sum = 0; /* complete homogeneous polynomials of u; u, v; u, v, w */

    for (int n = 2; n < MAX_TERMS; n++) {
      sum += (n % 2 ? 1 : -1) * of_w / n;
      of_u *= u;
      of_v = of_u + v * of_v;
      of_w = of_v + w * of_w;
    }
    return sum / (y * y);
  }
}

/* SymmetricLogCreate - eigenvalues and divided differences of ln(1 + a); those of three only if the second derivative is wanted */
void SymmetricLogCreate(const PetscReal a[3][3], PetscBool second, SymmetricLog *log)
{
  PetscReal d[3][3];

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) d[i][j] = a[i][j];
  Diagonalise(d, log->Q);
  for (int i = 0; i < 3; i++) log->value[i] = log1p(d[i][i]);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      log->first[i][j] = First(d[i][i], d[j][j]);
      for (int k = 0; k < 3 && second; k++) log->second[i][j][k] = Second(d[i][i], d[j][j], d[k][k]);
    }
}

/* b = Q^T a Q */
static void ToAxes(const PetscReal Q[3][3], const PetscReal a[3][3], PetscReal b[3][3])
{
  PetscReal half[3][3];

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) half[i][j] = a[i][0] * Q[0][j] + a[i][1] * Q[1][j] + a[i][2] * Q[2][j];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) b[i][j] = Q[0][i] * half[0][j] + Q[1][i] * half[1][j] + Q[2][i] * half[2][j];
}

/* b = Q a Q^T */
static void FromAxes(const PetscReal Q[3][3], const PetscReal a[3][3], PetscReal b[3][3])
{
  PetscReal half[3][3];

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) half[i][j] = a[i][0] * Q[j][0] + a[i][1] * Q[j][1] + a[i][2] * Q[j][2];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) b[i][j] = Q[i][0] * half[0][j] + Q[i][1] * half[1][j] + Q[i][2] * half[2][j];
}

void SymmetricLogGet(const SymmetricLog *log, PetscReal value[3][3])
{
  PetscReal d[3][3] = {{0}};

  for (int i = 0; i < 3; i++) d[i][i] = log->value[i];
  FromAxes(log->Q, d, value);
}

/* SymmetricLogApply - the derivative of the logarithm in the symmetric direction x; its own transpose too */
void SymmetricLogApply(const SymmetricLog *log, const PetscReal x[3][3], PetscReal result[3][3])
{
  PetscReal d[3][3];

  ToAxes(log->Q, x, d);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) d[i][j] *= log->first[i][j];
  FromAxes(log->Q, d, result);
}

/* SymmetricLogApplySecond - the second derivative, in the symmetric directions x and y */
void SymmetricLogApplySecond(const SymmetricLog *log, const PetscReal x[3][3], const PetscReal y[3][3], PetscReal result[3][3])
{
  PetscReal a[3][3], b[3][3], d[3][3];

  ToAxes(log->Q, x, a);
  ToAxes(log->Q, y, b);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      d[i][j] = 0;
      for (int k = 0; k < 3; k++) d[i][j] += log->second[i][k][j] * (a[i][k] * b[k][j] + b[i][k] * a[k][j]);
    }
  FromAxes(log->Q, d, result);
}
