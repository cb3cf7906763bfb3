/* The lowest frequencies of a body. */
#pragma once
#include "support.h"
#include <body/layout/bodyimpl.h>
#include <petscblaslapack.h>

#define MODES 6 /* beyond those of a rigid body */

/* The lowest frequencies of a body without loads, from the dense problem M x = mu (K + shift M) x, whose right-hand matrix is positive
   definite though M has no mass at contact nodes: mu = 1 / (omega^2 + shift) [1/s] */
static inline void get_frequencies(Body body, PetscInt n_wanted, PetscReal frequency[])
{
  Mat          K, M, dense[2];
  PetscScalar *values[2], *work;
  PetscReal   *mu, shift;
  PetscInt     n;
  PetscBLASInt one = 1, order, info, lwork;

  ok(BodyGetStiffness(body, &K));
  ok(MatGetSize(K, &n, NULL));
  ok(MatDuplicate(K, MAT_COPY_VALUES, &M));
  if (body->mass.diagonal) {
    ok(MatZeroEntries(M));
    ok(MatDiagonalSet(M, body->mass.diagonal, INSERT_VALUES));
  } else ok(MatCopy(body->mass.matrix, M, DIFFERENT_NONZERO_PATTERN));
  ok(MatConvert(M, MATDENSE, MAT_INITIAL_MATRIX, &dense[0]));
  /* a millionth of the largest squares of frequencies: below those of the lowest modes */
  ok(MatNorm(K, NORM_1, &shift));
  shift *= 1e-6 * n / body->mesh.dim / body->mass.total;
  ok(MatAYPX(M, shift, K, DIFFERENT_NONZERO_PATTERN));
  ok(MatConvert(M, MATDENSE, MAT_INITIAL_MATRIX, &dense[1]));
  ok(MatDestroy(&M));
  for (PetscInt k = 0; k < 2; k++) ok(MatDenseGetArray(dense[k], &values[k]));
  ok(PetscBLASIntCast(n, &order));
  ok(PetscBLASIntCast(34 * n, &lwork));
  ok(PetscMalloc2(n, &mu, lwork, &work));
  LAPACKsygv_(&one, "N", "L", &order, values[0], &order, values[1], &order, mu, work, &lwork, &info);
  assert_int_equal(info, 0);
  for (PetscInt i = 0; i < n_wanted; i++) frequency[i] = PetscSqrtReal(PetscMax(0, 1 / mu[n - 1 - i] - shift)) / (2 * PETSC_PI);
  ok(PetscFree2(mu, work));
  for (PetscInt k = 0; k < 2; k++) {
    ok(MatDenseRestoreArray(dense[k], &values[k]));
    ok(MatDestroy(&dense[k]));
  }
}
