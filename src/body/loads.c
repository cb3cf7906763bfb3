/* Initial values, from constants; loads are yet to come. */
#include "bodyimpl.h"
PetscErrorCode BodyLoadsSetFromOptions(Body body)
{
  (void)body;
  return PETSC_SUCCESS;
}
PetscErrorCode BodyLoadsDestroy(Body body)
{
  (void)body;
  return PETSC_SUCCESS;
}
PetscErrorCode BodyLoadsGetHeld(Body body, PetscInt *n, const PetscInt *d[])
{
  (void)body;
  *n = 0;
  *d = NULL;
  return PETSC_SUCCESS;
}
PetscErrorCode BodyLoadsAddForce(Body body, PetscReal t, PetscScalar s, Vec f)
{
  (void)body;
  (void)t;
  (void)s;
  (void)f;
  return PETSC_SUCCESS;
}
PetscErrorCode BodyLoadsPrescribe(Body body, PetscReal t, Vec u, Vec v, Vec a)
{
  (void)body;
  (void)t;
  (void)u;
  (void)v;
  (void)a;
  return PETSC_SUCCESS;
}
static PetscErrorCode Read(Body body, const char o[], Vec x)
{
  PetscReal    v[3] = {0};
  PetscInt     n    = 3;
  PetscBool    set;
  PetscScalar *a;
  PetscCall(PetscOptionsGetRealArray(NULL, ((PetscObject)body)->prefix, o, v, &n, &set));
  PetscCheck(!set || n == body->dim, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT, "-%s%s has %" PetscInt_FMT " components; body '%s' is %" PetscInt_FMT "-dimensional", ((PetscObject)body)->prefix, o + 1, n, body->hdr.name, body->dim);
  PetscCall(VecGetArray(x, &a));
  for (PetscInt i = 0; i < body->owned_nodes * body->dim; i++) a[i] = v[i % body->dim];
  PetscCall(VecRestoreArray(x, &a));
  return PETSC_SUCCESS;
}
PetscErrorCode BodyLoadsInitialState(Body body, Vec u, Vec v)
{
  PetscCall(Read(body, "-initial_displacement", u));
  PetscCall(Read(body, "-initial_velocity", v));
  return PETSC_SUCCESS;
}
