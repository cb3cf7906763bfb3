/* Rotations: from vectors, from matrices that are nearly so, and what they do to forces. */
#include "rigidmotion.h"

/* Steps of Newton's method to a rotation matrix: two take round-off away; from 1 % off six get there */
#define POLAR_STEPS 8
/* A last step by less leaves its square of R R^T - I */
#define LAST_STEP 1e-7
/* Below this angle the series are exact to round-off [rad] */
#define SMALL_ANGLE 1e-3

/* c = a x b */
void RigidCross(const PetscReal a[3], const PetscReal b[3], PetscReal c[3])
{
  for (PetscInt d = 0; d < 3; d++) c[d] = a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
}

/* y = A x */
void RigidMultiply(const PetscReal A[9], const PetscReal x[3], PetscReal y[3])
{
  for (PetscInt i = 0; i < 3; i++) y[i] = A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
}

/* y = A^T x */
void RigidMultiplyTransposed(const PetscReal A[9], const PetscReal x[3], PetscReal y[3])
{
  for (PetscInt i = 0; i < 3; i++) y[i] = A[i] * x[0] + A[3 + i] * x[1] + A[6 + i] * x[2];
}

/* C = A B */
void RigidProduct(const PetscReal A[9], const PetscReal B[9], PetscReal C[9])
{
  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
}

/* B = A^{-1}; false, and B is good for nothing, where A is singular */
PetscBool RigidInvert(const PetscReal A[9], PetscReal B[9])
{
  PetscReal cofactors[9], determinant;

  for (PetscInt row = 0; row < 3; row++) RigidCross(A + 3 * ((row + 1) % 3), A + 3 * ((row + 2) % 3), cofactors + 3 * row);
  determinant = A[0] * cofactors[0] + A[1] * cofactors[1] + A[2] * cofactors[2];
  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) B[3 * i + j] = cofactors[3 * j + i] / determinant;
  return (PetscBool)(PetscAbsReal(determinant) > 0 && !PetscIsInfOrNanReal(1 / determinant));
}

/* The rotation next to A, in its place: its polar decomposition by Newton's method, A <- (A + A^{-T}) / 2 (N. J. Higham, Computing the
   polar decomposition, SIAM Journal on Scientific and Statistical Computing 7, 1986). False where A is far from any. */
PetscBool RigidFindRotation(PetscReal A[9])
{
  PetscReal inverse[9], third[3], change = 1;

  for (PetscInt step = 0; step < POLAR_STEPS && change > LAST_STEP; step++) {
    if (!RigidInvert(A, inverse)) return PETSC_FALSE;
    change = 0;
    for (PetscInt k = 0; k < 9; k++) {
      const PetscReal half = 0.5 * (inverse[3 * (k % 3) + k / 3] - A[k]);

      A[k] += half;
      change = PetscMax(change, PetscAbsReal(half));
    }
  }
  RigidCross(A, A + 3, third);
  return (PetscBool)(change <= LAST_STEP &&
                     third[0] * A[6] + third[1] * A[7] + third[2] * A[8] > 0); /* else far from any, or a reflection */
}

/* a I + b v^ + c v v^T, v^ x being v x x */
static void FromVector(PetscReal a, PetscReal b, PetscReal c, const PetscReal v[3], PetscReal A[9])
{
  for (PetscInt i = 0; i < 3; i++) {
    for (PetscInt j = 0; j < 3; j++) A[3 * i + j] = c * v[i] * v[j];
    A[4 * i] += a;
    A[3 * i + (i + 1) % 3] -= b * v[(i + 2) % 3];
    A[3 * i + (i + 2) % 3] += b * v[(i + 1) % 3];
  }
}

/* (I - v^/2)^{-1} (I + v^/2), a rotation about v: then x1 - x0 = v x (x0 + x1) / 2 exactly (A. Cayley) */
void RigidCayley(const PetscReal v[3], PetscReal Q[9])
{
  const PetscReal square = 0.25 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), scale = 1 / (1 + square);

  FromVector((1 - square) * scale, scale, 0.5 * scale, v, Q);
}

/* The rotation by the angle |v| about v (O. Rodrigues) */
void RigidExponential(const PetscReal v[3], PetscReal R[9])
{
  const PetscReal square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2], angle = PetscSqrtReal(square);

  if (angle < SMALL_ANGLE)
    FromVector(1 - square / 2 + square * square / 24, 1 - square / 6 + square * square / 120, 0.5 - square / 24 + square * square / 720, v,
               R);
  else FromVector(PetscCosReal(angle), PetscSinReal(angle) / angle, (1 - PetscCosReal(angle)) / square, v, R);
}

/* Angular velocity of the rotation by v(t), from v and its rate */
void RigidSpin(const PetscReal v[3], const PetscReal rate[3], PetscReal spin[3])
{
  const PetscReal square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2], angle = PetscSqrtReal(square);
  PetscReal       A[9], b, c;

  if (angle < SMALL_ANGLE) {
    b = 0.5 - square / 24;
    c = 1. / 6 - square / 120;
  } else {
    b = (1 - PetscCosReal(angle)) / square;
    c = (angle - PetscSinReal(angle)) / (square * angle);
  }
  FromVector(1 - c * square, b, c, v, A);
  RigidMultiply(A, rate, spin);
}

/* The vector of axis times angle, 0 to pi, of a rotation: by its quaternion, of which the largest part is found first (S. W. Shepperd,
   Quaternion from rotation matrix, Journal of Guidance and Control 1, 1978) */
void RigidFindVector(const PetscReal R[9], PetscReal v[3])
{
  const PetscReal squares[4] = {1 + R[0] + R[4] + R[8], 1 + R[0] - R[4] - R[8], 1 - R[0] + R[4] - R[8], 1 - R[0] - R[4] + R[8]};
  PetscReal       q[4], length, scale;
  PetscInt        k = 0;

  for (PetscInt i = 1; i < 4; i++)
    if (squares[i] > squares[k]) k = i;
  q[k] = 0.5 * PetscSqrtReal(squares[k]);
  if (k == 0)
    for (PetscInt i = 0; i < 3; i++) q[1 + i] = (R[3 * ((i + 2) % 3) + (i + 1) % 3] - R[3 * ((i + 1) % 3) + (i + 2) % 3]) / (4 * q[0]);
  else {
    const PetscInt a = k - 1, b = k % 3, c = (k + 1) % 3;

    q[0]     = (R[3 * c + b] - R[3 * b + c]) / (4 * q[k]);
    q[1 + b] = (R[3 * a + b] + R[3 * b + a]) / (4 * q[k]);
    q[1 + c] = (R[3 * a + c] + R[3 * c + a]) / (4 * q[k]);
  }
  if (q[0] < 0)
    for (PetscInt i = 0; i < 4; i++) q[i] = -q[i];
  length = PetscSqrtReal(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  scale  = length > 0 ? 2 * PetscAtan2Real(length, q[0]) / length : 2;
  for (PetscInt i = 0; i < 3; i++) v[i] = scale * q[1 + i];
}

/* sum_i (G Y_i) x f_i, from D = sum_i f_i Y_i^T */
void RigidTorque(const PetscReal G[9], const PetscReal D[9], PetscReal torque[3])
{
  for (PetscInt d = 0; d < 3; d++) {
    const PetscInt e = (d + 1) % 3, f = (d + 2) % 3;

    torque[d] = 0;
    for (PetscInt b = 0; b < 3; b++) torque[d] += G[3 * e + b] * D[3 * f + b] - G[3 * f + b] * D[3 * e + b];
  }
}
