/* Central differences for M a = f(t, u): the explicit Newmark scheme, beta = 0, gamma = 1/2, in its velocity form

     v_{n+1/2} = v_n + dt/2 a_n,   u_{n+1} = u_n + dt v_{n+1/2},   a_{n+1} = a(t_{n+1}, u_{n+1}),   v_{n+1} = v_{n+1/2} + dt/2 a_{n+1} */
#include <impakt/private/tssecondorder.h>
#include "constructors.h"
#include <petsc/private/tsimpl.h>

typedef struct {
  TSCentralDifferenceFn *acceleration;
  void                  *ctx;
  Vec                    A;      /* acceleration at ts->ptime; it belongs to the caller of TSCentralDifferenceSetAcceleration() */
  PetscBool              leaves; /* the function has left the acceleration, and the velocity at the end of the step, to others */
} TS_CentralDifference;

/* v += half a, and, if dt is not 0, u += dt v: in one pass over memory, which is what takes the time with large bodies */
static PetscErrorCode Kick(Vec U, Vec V, Vec A, PetscReal half, PetscReal dt)
{
  const PetscScalar *a;
  PetscScalar       *u, *v;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(V, &n));
  PetscCall(VecGetArrayRead(A, &a));
  PetscCall(VecGetArray(V, &v));
  if (dt != 0) {
    PetscCall(VecGetArray(U, &u));
    for (PetscInt i = 0; i < n; i++) {
      v[i] += half * a[i];
      u[i] += dt * v[i];
    }
    PetscCall(VecRestoreArray(U, &u));
  } else {
    for (PetscInt i = 0; i < n; i++) v[i] += half * a[i];
  }
  PetscCall(VecRestoreArray(V, &v));
  PetscCall(VecRestoreArrayRead(A, &a));
  PetscCall(PetscLogFlops((dt != 0 ? 4.0 : 2.0) * (PetscLogDouble)n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TSStep_CentralDifference(TS ts)
{
  TS_CentralDifference *cd   = (TS_CentralDifference *)ts->data;
  const PetscReal       half = 0.5 * ts->time_step;
  PetscReal             next = ts->time_step;
  PetscBool             accept;

  PetscFunctionBegin;
  PetscCall(TSSecondOrderCheckSolution(ts));
  PetscCall(Kick(ts->vec_sol, ts->vec_dot, cd->A, half, ts->time_step));
  cd->leaves = PETSC_FALSE;
  PetscCall((*cd->acceleration)(ts, ts->ptime + ts->time_step, ts->vec_sol, ts->vec_dot, cd->A, cd->ctx));
  if (!cd->leaves) PetscCall(Kick(NULL, ts->vec_dot, cd->A, half, 0));
  PetscCall(TSAdaptChoose(ts->adapt, ts, ts->time_step, NULL, &next, &accept));
  ts->ptime += ts->time_step;
  ts->time_step = next;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TSSetUp_CentralDifference(TS ts)
{
  TS_CentralDifference *cd = (TS_CentralDifference *)ts->data;

  PetscFunctionBegin;
  PetscCall(TSSecondOrderKeepNoStart(ts));
  PetscCheck(cd->acceleration, PetscObjectComm((PetscObject)ts), PETSC_ERR_ARG_WRONGSTATE,
             "Call TSCentralDifferenceSetAcceleration() first");
  PetscCall(TSGetAdapt(ts, &ts->adapt));
  PetscCall(TSAdaptCandidatesClear(ts->adapt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TSReset_CentralDifference(TS ts)
{
  TS_CentralDifference *cd = (TS_CentralDifference *)ts->data;

  PetscFunctionBegin;
  PetscCall(VecDestroy(&cd->A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TSDestroy_CentralDifference(TS ts)
{
  PetscFunctionBegin;
  PetscCall(TSReset_CentralDifference(ts));
  PetscCall(PetscFree(ts->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the function that gives the acceleration for a displacement, and the vector that holds it between steps. `acceleration`: function
   (ts, t, U, V, A, ctx): computes A = M^{-1} f(t, U) [m/s^2]. It may correct U (prescribed and massless nodes) and V (the velocity at
   mid-step) before it does. The caller fills `A` at the start, and to restore an earlier state. */
PetscErrorCode TSCentralDifferenceSetAcceleration(TS ts, TSCentralDifferenceFn *acceleration, Vec A, void *ctx)
{
  TS_CentralDifference *cd = (TS_CentralDifference *)ts->data;

  PetscFunctionBegin;
  PetscValidHeaderSpecificType(ts, TS_CLASSID, 1, TSCENTRALDIFFERENCE);
  PetscValidHeaderSpecific(A, VEC_CLASSID, 3);
  PetscCall(PetscObjectReference((PetscObject)A));
  PetscCall(VecDestroy(&cd->A));
  cd->A            = A;
  cd->acceleration = acceleration;
  cd->ctx          = ctx;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Leaves the velocity at mid-step in this step. For the function of `TSCentralDifferenceSetAcceleration()`, where it has not computed the
   acceleration: who does that later adds half a step of it to the velocity */
PetscErrorCode TSCentralDifferenceLeaveVelocity(TS ts)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecificType(ts, TS_CLASSID, 1, TSCENTRALDIFFERENCE);
  ((TS_CentralDifference *)ts->data)->leaves = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   TSCENTRALDIFFERENCE - explicit Newmark scheme (beta = 0, gamma = 1/2) for second-order systems; second order, stable for
   dt < 2 / omega_max

   Level: beginner

   Note:
   One evaluation of the acceleration in a step. It conserves the staggered energy 1/2 v'Mv - dt^2/8 a'Ma + potential. `TSRollBack()` is
   refused: whoever wants to undo a step keeps displacement, velocity and acceleration, and calls `TSSecondOrderSetState()`.

.seealso: `TSALPHA2`
M*/
PetscErrorCode TSCreate_CentralDifference(TS ts)
{
  TS_CentralDifference *cd;

  PetscFunctionBegin;
  PetscCall(PetscNew(&cd));
  ts->data               = cd;
  ts->ops->setup         = TSSetUp_CentralDifference;
  ts->ops->step          = TSStep_CentralDifference;
  ts->ops->reset         = TSReset_CentralDifference;
  ts->ops->destroy       = TSDestroy_CentralDifference;
  ts->default_adapt_type = TSADAPTNONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
