/* A substep of a linear body on TSALPHA2: the residual at a first iterate, one solution with the factors of the constant effective matrix,
   and Newmark's formulas: an iteration of Newton's method. */
#include "implicitimpl.h"
#include <impakt/private/simd.h>

/* Acceleration at the end of the substep, a1 = (u1 - u0) / (beta dt^2) - v0 / (beta dt) - (1 - 2 beta) / (2 beta) a0, u1 being U */
PetscErrorCode BodyImplicitGetAcceleration(Body body, Vec U, Vec a1)
{
  const PetscReal beta = body->integrator->beta, dt = body->time.step;

  PetscFunctionBegin;
  PetscCall(VecWAXPY(a1, -1, body->substep_start.u, U));
  PetscCall(VecAXPBYPCZ(a1, -1 / (beta * dt), -(1 - 2 * beta) / (2 * beta), 1 / (beta * dt * dt), body->substep_start.v, body->state.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Motion at the stage, of which the residual is, from U at the end with held dofs and prescribed rows in place: v = v0 + alpha_f dt ((1 -
   gamma) a0 + gamma a1), a = (1 - alpha_m) a0 + alpha_m a1 */
static PetscErrorCode ComputeStage(Body body, Vec U)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;
  const PetscReal     alpha_m = implicit->alpha_m, alpha_f = implicit->alpha_f, dt = alpha_f * body->time.step;
  const PetscReal     gamma = body->integrator->gamma;

  PetscFunctionBegin;
  if (implicit->stage_u) PetscCall(VecAXPBYPCZ(implicit->stage_u, 1 - alpha_f, alpha_f, 0, body->substep_start.u, U));
  if (!implicit->stage_a) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyImplicitGetAcceleration(body, U, implicit->stage_a));
  if (implicit->stage_v) {
    PetscCall(VecWAXPY(implicit->stage_v, dt * (1 - gamma), body->state.a, body->substep_start.v));
    PetscCall(VecAXPY(implicit->stage_v, dt * gamma, implicit->stage_a));
  }
  PetscCall(VecAXPBY(implicit->stage_a, 1 - alpha_m, alpha_m, body->state.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* u -= du, acceleration from that at the start and at the stage, and velocity by both ends: in one pass over the vectors, since sums of
   vectors, one by one, take 5 % of a run of short bars */
SIMD_CLONES static void MoveEnds(PetscInt n, const PetscReal by[6], const PetscScalar du[], const PetscScalar stage_a[], PetscScalar u[],
                                 PetscScalar v[], PetscScalar a[])
{
#pragma omp simd
  for (PetscInt i = 0; i < n; i++) {
    const PetscScalar start = a[i], end = by[0] * stage_a[i] + by[1] * du[i] + by[2] * start;

    u[i] += by[3] * du[i];
    v[i] += by[4] * start + by[5] * end;
    a[i] = end;
  }
}

/* The displacement at the end of the substep less a change of it at the stage, with the velocity and the acceleration there */
static PetscErrorCode MoveEnd(Body body, Vec du)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;
  const PetscReal     dt = body->time.step, gamma = body->integrator->gamma, alpha_m = implicit->alpha_m, alpha_f = implicit->alpha_f;
  const PetscReal     by[6] = {
      1 / alpha_m, -1 / (alpha_f * body->integrator->beta * dt * dt), (alpha_m - 1) / alpha_m, -1 / alpha_f, dt * (1 - gamma), dt * gamma};
  const PetscScalar *change, *stage_a;
  PetscScalar       *u, *v, *a;

  PetscFunctionBegin;
  if (!implicit->stage_a) {
    PetscCall(VecAXPY(body->state.u, -1 / alpha_f, du));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecGetArrayRead(du, &change));
  PetscCall(VecGetArrayRead(implicit->stage_a, &stage_a));
  PetscCall(VecGetArray(body->state.u, &u));
  PetscCall(VecGetArray(body->state.v, &v));
  PetscCall(VecGetArray(body->state.a, &a));
  MoveEnds(body->mesh.owned_nodes * body->mesh.dim, by, change, stage_a, u, v, a);
  PetscCall(VecRestoreArray(body->state.a, &a));
  PetscCall(VecRestoreArray(body->state.v, &v));
  PetscCall(VecRestoreArray(body->state.u, &u));
  PetscCall(VecRestoreArrayRead(implicit->stage_a, &stage_a));
  PetscCall(VecRestoreArrayRead(du, &change));
  PetscCall(PetscLogFlops(11.0 * body->mesh.owned_nodes * body->mesh.dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the displacement at the end of the one substep of a linear body: A du = part B^T df with prescribed rows at B du = dx, A being the
   effective matrix; and velocity and acceleration with it. With a part other than 1 no row is prescribed. */
PetscErrorCode BodyImplicitCorrect(Body body, const PetscScalar displacement[], PetscReal part, PetscReal to_velocity,
                                   PetscReal to_acceleration, Vec du)
{
  PetscFunctionBegin;
  PetscCall(ConstrainedSolverCorrect(body->solver, displacement, du));
  PetscCall(VecAXPY(body->state.u, part, du));
  PetscCall(VecAXPY(body->state.v, part * to_velocity, du));
  PetscCall(VecAXPY(body->state.a, part * to_acceleration, du));
  body->state.force_known = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Held dofs and prescribed rows of U, where these are not there yet: then its internal force is another. Rows that are prescribed move. */
static PetscErrorCode Prescribe(Body body, Vec U)
{
  const Vec          before = body->work.nodes[0];
  const PetscScalar *old, *now;
  PetscBool          moved = (PetscBool)(body->rows.n_prescribed != 0);

  PetscFunctionBegin;
  PetscCall(BodyCopyHeld(body, U, before));
  PetscCall(BodyImplicitPrescribe(body, U));
  PetscCall(VecGetArrayRead(before, &old));
  PetscCall(VecGetArrayRead(U, &now));
  for (PetscInt i = 0; i < body->held.n && !moved; i++) moved = (PetscBool)(old[body->held.dofs[i]] != now[body->held.dofs[i]]);
  PetscCall(VecRestoreArrayRead(U, &now));
  PetscCall(VecRestoreArrayRead(before, &old));
  if (body->mesh.ghosted && body->held.any) PetscCall(BodyAnyRank(body, &moved));
  if (moved) body->state.force_known = body->saved.force_known = PETSC_FALSE;
  else PetscCall(BodyFindInternalForce(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MakeStep(TS ts)
{
  BodyResidualFn     *compute_residual;
  const BodyImplicit *implicit;
  PetscReal           t, dt;
  Body                body;
  Vec                 F, U, du;

  PetscFunctionBegin;
  PetscCall(TSGetI2Function(ts, &F, &compute_residual, (void *)&body));
  PetscCall(TSGetTime(ts, &t));
  implicit = (const BodyImplicit *)body->integrator->data;
  dt       = body->time.step;
  U        = body->state.u;
  du       = body->work.nodes[0];
  PetscCall(Prescribe(body, U));
  PetscCall(ComputeStage(body, U));
  PetscCall((*compute_residual)(ts, t + implicit->alpha_f * dt, implicit->stage_u ? implicit->stage_u : U, implicit->stage_v,
                                implicit->stage_a, F, body));
  PetscCall(ConstrainedSolverSolve(body->solver, F, du));
  PetscCall(MoveEnd(body, du));
  body->state.force_known = PETSC_FALSE;
  PetscCall(TSSetTime(ts, t + dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Steps of a linear body, without Newton's method. Its residual reads acceleration with inertia alone, velocity with damping alone. */
PetscErrorCode BodyImplicitSetUpLinear(Body body)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  body->integrator->leaves_force = PETSC_TRUE;
  if (body->integrator->has_inertia) PetscCall(BodyCreateVec(body, &implicit->stage_a));
  if (BodyIsDamped(body)) PetscCall(BodyCreateVec(body, &implicit->stage_v));
  if (implicit->alpha_f != 1) PetscCall(BodyCreateVec(body, &implicit->stage_u));
  PetscCall(TSAlpha2SetStep(body->time.ts, MakeStep));
  PetscFunctionReturn(PETSC_SUCCESS);
}
