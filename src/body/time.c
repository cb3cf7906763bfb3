/* Substeps, the stable step, and the TS of a body. */
#include "bodyimpl.h"
#include <petscblaslapack.h>

/* Largest eigenvalue of K x = lambda M x of one element, its massless nodes held: no eigenvalue of the body is larger
   (Irons and Treharne 1971), whether its contact nodes are free or prescribed. */
static PetscErrorCode GetElementEigenvalue(Body body, PetscInt e, PetscReal *largest)
{
  const PetscInt *nodes                  = body->connectivity + e * body->element->nodes;
  const PetscInt  n                      = body->element->nodes * body->dim;
  PetscScalar     zero[ELEMENT_MAX_DOFS] = {0}, K[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], work[4 * ELEMENT_MAX_DOFS];
  PetscReal       eigenvalues[ELEMENT_MAX_DOFS];
  PetscInt        kept[ELEMENT_MAX_DOFS], n_kept = 0;
  PetscBLASInt    one = 1, m, lwork = 4 * ELEMENT_MAX_DOFS, info;

  PetscFunctionBegin;
  PetscCall((*body->element->ops.stiffness)(body->element, e, zero, K));
  PetscCall(BodyGetElementMass(body, e, M));
  for (PetscInt i = 0; i < n; i++)
    if (!(body->mass_redistribute && body->in_layer[nodes[i / body->dim]])) kept[n_kept++] = i;
  for (PetscInt i = 0; i < n_kept; i++)
    for (PetscInt j = 0; j < n_kept; j++) {
      K[i * n_kept + j] = K[kept[i] * n + kept[j]];
      M[i * n_kept + j] = M[kept[i] * n + kept[j]];
    }
  PetscCall(PetscBLASIntCast(n_kept, &m));
  PetscCallBLAS("LAPACKsygv", LAPACKsygv_(&one, "N", "L", &m, K, &m, M, &m, eigenvalues, work, &lwork, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "Body '%s', element %" PetscInt_FMT ": no eigenvalues (LAPACK sygv info %d); is its mass matrix singular?", body->hdr.name, e, (int)info);
  *largest = eigenvalues[n_kept - 1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 2 / omega_max, from below */
PetscErrorCode BodyComputeStableStep(Body body)
{
  PetscReal largest = 0;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < body->element->count; e++) {
    PetscReal eigenvalue;

    PetscCall(GetElementEigenvalue(body, e, &eigenvalue));
    largest = PetscMax(largest, eigenvalue);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)body)));
  body->stable_step = 2 / PetscSqrtReal(largest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A whole number of substeps to the controller step */
PetscErrorCode BodySetUpSubsteps(Body body)
{
  MPI_Comm    comm   = PetscObjectComm((PetscObject)body);
  const char *prefix = ((PetscObject)body)->prefix;

  PetscFunctionBegin;
  PetscCheck(body->controller_step > 0, comm, PETSC_ERR_ARG_WRONGSTATE, "Call BodySetControllerStep() first");
  if (body->requested_step < 0) {
    /* the tolerance keeps a quotient that is a whole number but for round-off from being counted up */
    body->substeps = (PetscInt)PetscCeilReal(body->controller_step / (0.9 * body->stable_step) * (1 - 1e-12));
  } else {
    const PetscReal step = body->requested_step > 0 ? body->requested_step : body->controller_step;

    PetscCheck(body->controller_step / step < 1e9, comm, PETSC_ERR_USER_INPUT, "-%sts_time_step %g s is too small for the controller step -time_step %g s", prefix, (double)step, (double)body->controller_step);
    body->substeps = (PetscInt)PetscFloorReal(0.5 + body->controller_step / step);
    PetscCheck(body->substeps > 0 && PetscAbsReal(body->substeps * step - body->controller_step) <= 1e-6 * body->controller_step, comm, PETSC_ERR_USER_INPUT, "-%sts_time_step %g s does not divide the controller step -time_step %g s (ratio %.9g); choose a whole fraction of it, or 'auto'", prefix, (double)step, (double)body->controller_step, (double)(body->controller_step / step));
  }
  body->time_step = body->controller_step / body->substeps;
  if (body->is_explicit) PetscCheck(body->time_step <= body->stable_step * (1 + 1e-12), comm, PETSC_ERR_USER_INPUT, "-%sts_time_step %g s of the explicit body '%s' is larger than its stable step, %.6g s; choose a smaller one, or 'auto'", prefix, (double)body->time_step, body->hdr.name, (double)body->stable_step);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The TS, on the state's vectors, at the start time */
PetscErrorCode BodySetUpTime(Body body)
{
  TSAdapt   adapt;
  PetscBool none;

  PetscFunctionBegin;
  PetscCall(TS2SetSolution(body->ts, body->state.u, body->state.v));
  PetscCall(TSGetAdapt(body->ts, &adapt));
  PetscCall(PetscObjectTypeCompare((PetscObject)adapt, TSADAPTNONE, &none));
  PetscCheck(none, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT, "-%sts_adapt_type: adaptive substeps within a controller step are not supported; leave it at none", ((PetscObject)body)->prefix);
  PetscCall(TSSetMaxTime(body->ts, 1e300));
  PetscCall(TSSetExactFinalTime(body->ts, TS_EXACTFINALTIME_STEPOVER));
  if (body->is_explicit) PetscCall(BodySetUpExplicit(body));
  else PetscCall(BodySetUpImplicit(body));
  PetscCall(TSSetUp(body->ts));
  body->time = body->time_start;
  body->step = 0;
  PetscCall(TSSecondOrderSetState(body->ts, body->time, body->time_step, body->step));
  PetscFunctionReturn(PETSC_SUCCESS);
}
