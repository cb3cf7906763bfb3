/* A substep of a linear body on TSALPHA2: the residual at a first iterate, one solution with the factors of the constant effective matrix,
   and Newmark's formulas: an iteration of Newton's method, in two passes over the vectors. */
#include "implicitimpl.h"
#include <impakt/private/simd.h>

/* Acceleration at the end of the substep, a1 = c2 (u1 - u0) - c1 v0 - c0 a0, and velocity, v1 = v0 + dt ((1 - gamma) a0 + gamma a1) */
typedef struct {
  PetscReal c2, c1, c0, by_start, by_end;
} Newmark;

static Newmark NewmarkOf(const BodyImplicit *implicit, PetscReal dt)
{
  const PetscReal beta = implicit->beta, gamma = implicit->gamma;

  return (Newmark){1 / (beta * dt * dt), 1 / (beta * dt), (1 - 2 * beta) / (2 * beta), dt * (1 - gamma), dt * gamma};
}

SIMD_CLONES static void GetStageAccelerations(PetscInt n, Newmark m, PetscReal alpha_m, const PetscScalar u0[], const PetscScalar v0[],
                                              const PetscScalar a0[], const PetscScalar u1[], PetscScalar a[])
{
#pragma omp simd
  for (PetscInt i = 0; i < n; i++) a[i] = (1 - alpha_m) * a0[i] + alpha_m * (m.c2 * (u1[i] - u0[i]) - m.c1 * v0[i] - m.c0 * a0[i]);
}

/* Motion at the stage, of which the residual is, from U at the end with held dofs and prescribed rows in place. */
static PetscErrorCode ComputeStage(Body body, Vec U)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;
  const Newmark       m        = NewmarkOf(implicit, body->time.step);
  const PetscReal     alpha_f  = implicit->alpha_f;
  const PetscInt      n        = body->mesh.owned_nodes * body->mesh.dim;
  const PetscScalar  *u0, *v0, *a0, *u1;
  PetscScalar        *u, *v, *a;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(body->substep_start.u, &u0));
  PetscCall(VecGetArrayRead(body->substep_start.v, &v0));
  PetscCall(VecGetArrayRead(body->state.a, &a0));
  PetscCall(VecGetArrayRead(U, &u1));
  if (implicit->stage_a) {
    PetscCall(VecGetArrayWrite(implicit->stage_a, &a));
    GetStageAccelerations(n, m, implicit->alpha_m, u0, v0, a0, u1, a);
    PetscCall(VecRestoreArrayWrite(implicit->stage_a, &a));
  }
  if (implicit->stage_v) {
    PetscCall(VecGetArrayWrite(implicit->stage_v, &v));
#pragma omp simd
    for (PetscInt i = 0; i < n; i++)
      v[i] = v0[i] + alpha_f * (m.by_start * a0[i] + m.by_end * (m.c2 * (u1[i] - u0[i]) - m.c1 * v0[i] - m.c0 * a0[i]));
    PetscCall(VecRestoreArrayWrite(implicit->stage_v, &v));
  }
  if (implicit->stage_u) {
    PetscCall(VecGetArrayWrite(implicit->stage_u, &u));
#pragma omp simd
    for (PetscInt i = 0; i < n; i++) u[i] = u0[i] + alpha_f * (u1[i] - u0[i]);
    PetscCall(VecRestoreArrayWrite(implicit->stage_u, &u));
  }
  PetscCall(VecRestoreArrayRead(U, &u1));
  PetscCall(VecRestoreArrayRead(body->state.a, &a0));
  PetscCall(VecRestoreArrayRead(body->substep_start.v, &v0));
  PetscCall(VecRestoreArrayRead(body->substep_start.u, &u0));
  PetscCall(PetscLogFlops(10.0 * (PetscLogDouble)n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* u -= du, and velocity and acceleration with it, which is that at the start before */
SIMD_CLONES static void MoveEnds(PetscInt n, Newmark m, PetscReal scale, const PetscScalar du[], const PetscScalar u0[],
                                 const PetscScalar v0[], PetscScalar u[], PetscScalar v[], PetscScalar a[])
{
#pragma omp simd
  for (PetscInt i = 0; i < n; i++) {
    const PetscScalar way = (u[i] - u0[i]) - scale * du[i], a1 = m.c2 * way - m.c1 * v0[i] - m.c0 * a[i];

    u[i] = u0[i] + way;
    v[i] = v0[i] + m.by_start * a[i] + m.by_end * a1;
    a[i] = a1;
  }
}

/* The displacement at the end of the substep less a change of it at the stage, with the velocity and the acceleration there */
PetscErrorCode BodyImplicitMoveEnd(Body body, Vec du)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;
  const Newmark       m        = NewmarkOf(implicit, body->time.step);
  const PetscInt      n        = body->mesh.owned_nodes * body->mesh.dim;
  const PetscScalar  *change, *u0, *v0;
  PetscScalar        *u, *v, *a;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(du, &change));
  PetscCall(VecGetArrayRead(body->substep_start.u, &u0));
  PetscCall(VecGetArrayRead(body->substep_start.v, &v0));
  PetscCall(VecGetArray(body->state.u, &u));
  PetscCall(VecGetArrayWrite(body->state.v, &v));
  PetscCall(VecGetArray(body->state.a, &a));
  MoveEnds(n, m, 1 / implicit->alpha_f, change, u0, v0, u, v, a);
  PetscCall(VecRestoreArray(body->state.a, &a));
  PetscCall(VecRestoreArrayWrite(body->state.v, &v));
  PetscCall(VecRestoreArray(body->state.u, &u));
  PetscCall(VecRestoreArrayRead(body->substep_start.v, &v0));
  PetscCall(VecRestoreArrayRead(body->substep_start.u, &u0));
  PetscCall(VecRestoreArrayRead(du, &change));
  PetscCall(PetscLogFlops(12.0 * (PetscLogDouble)n));
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
  PetscCall(BodyImplicitMoveEnd(body, du));
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
