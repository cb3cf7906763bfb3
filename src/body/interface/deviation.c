/* How far a body is from a displacement given as formulas, for manufactured and known solutions. */
#include <body/layout/bodyimpl.h>

/*@
  BodyComputeDeviation - difference between the displacement of a body and given functions, in the L2 norm

  Collective

  Input Parameters:
+ body  - the `Body`, set up
- exact - a function of x, y, z, t for each component [m]

  Output Parameters:
+ difference - square root of the integral of |u - u_exact|^2 over the undeformed body, at its current time [m^(1 + dim/2)]
- norm       - the same of |u_exact|^2

  Options Database Key:
. -<body>_exact_displacement ux[,uy,uz] - the functions, for the summary

  Level: intermediate

  Note:
  The integrals are sums over the load points of the elements, exact for quadratic functions.

.seealso: `Body`, `ExpressionCreate()`
@*/
PetscErrorCode BodyComputeDeviation(Body body, const Expression exact[], PetscReal *difference, PetscReal *norm)
{
  const Element      element = body->model.element;
  const PetscInt     n = element->nodes, dim = body->mesh.dim;
  const PetscScalar *u;
  PetscReal          x[ELEMENT_MAX_POINTS * 3], weight[ELEMENT_MAX_POINTS], sums[2] = {0, 0};
  Vec                local;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(exact, 2);
  PetscAssertPointer(difference, 3);
  PetscAssertPointer(norm, 4);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  PetscCall(BodyGetLocalRead(body, body->state.u, &local, &u));
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscInt *nodes = body->mesh.connectivity + e * n;

    PetscCall((*element->ops->points)(element, e, x, weight));
    for (PetscInt p = 0; p < element->n_points; p++) {
      ExpressionPoint point = {.t = body->state.time};

      for (PetscInt d = 0; d < dim; d++) point.x[d] = x[p * dim + d];
      for (PetscInt d = 0; d < dim; d++) {
        PetscReal value, at = 0;

        PetscCall(ExpressionEvaluate(exact[d], &point, &value));
        for (PetscInt a = 0; a < n; a++) at += element->shape[p * n + a] * u[nodes[a] * dim + d];
        sums[0] += weight[p] * PetscSqr(at - value);
        sums[1] += weight[p] * PetscSqr(value);
      }
    }
  }
  PetscCall(BodyRestoreLocalRead(body, body->state.u, &local, &u));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  *difference = PetscSqrtReal(sums[0]);
  *norm       = PetscSqrtReal(sums[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
