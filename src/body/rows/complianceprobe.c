/* Columns of the interface compliance: a body at rest under a unit force on one row. */
#include "complianceimpl.h"

/* Newmark's recursion from rest, with the effective matrix as it is factored; the hat is over after the first substep */
static PetscErrorCode ProbeImplicit(Body body, PetscInt row)
{
  struct _BodyCompliance *c  = body->compliance;
  const PetscReal         dt = body->time_step, c2 = 1 / (body->beta * dt * dt), c1 = c2 * dt, c0 = (1 - 2 * body->beta) / (2 * body->beta);
  const PetscInt          n = body->owned_nodes * body->dim, local = body->rows.local;
  const Vec               u = c->work[0], v = c->work[1], a = c->work[2], next = body->substeps > 1 ? c->work[3] : body->work[0];

  PetscFunctionBegin;
  PetscCall(ConstrainedSolverApplyUnit(body->solver, row, next, c->mine));
  if (body->substeps == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArrayzero(c->mine + local, (body->substeps - 1) * local));
  if (body->is_static) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecZeroEntries(u));
  PetscCall(VecZeroEntries(v));
  PetscCall(VecZeroEntries(a));
  for (PetscInt k = 0; k < body->substeps; k++) {
    const PetscScalar *u1, *rows;
    PetscScalar       *u0, *v0, *a0;

    if (k) {
      PetscCall(VecCopy(a, body->work[1]));
      PetscCall(VecAXPBYPCZ(body->work[1], c2, c1, c0, u, v));
      PetscCall(BodyMultiplyMass(body, body->work[1], body->work[0]));
      PetscCall(BodyZeroHeld(body, body->work[0]));
      PetscCall(ConstrainedSolverSolveFree(body->solver, body->work[0], next));
      PetscCall(MatMult(body->interface, next, body->row_vec[0]));
      PetscCall(VecGetArrayRead(body->row_vec[0], &rows));
      PetscCall(PetscArraycpy(c->mine + k * local, rows, local));
      PetscCall(VecRestoreArrayRead(body->row_vec[0], &rows));
    }
    PetscCall(VecGetArrayRead(next, &u1));
    PetscCall(VecGetArray(u, &u0));
    PetscCall(VecGetArray(v, &v0));
    PetscCall(VecGetArray(a, &a0));
    for (PetscInt i = 0; i < n; i++) {
      const PetscScalar now = c2 * (u1[i] - u0[i]) - c1 * v0[i] - c0 * a0[i];

      v0[i] += dt * ((1 - body->gamma) * a0[i] + body->gamma * now);
      a0[i] = now;
    }
    for (PetscInt i = 0; i < body->n_layer_dofs; i++) {
      const PetscInt dof = body->layer_dofs[i];

      v0[dof] = (u1[dof] - u0[dof]) / dt;
      a0[dof] = 0;
    }
    PetscCall(PetscArraycpy(u0, u1, n));
    PetscCall(VecRestoreArray(a, &a0));
    PetscCall(VecRestoreArray(v, &v0));
    PetscCall(VecRestoreArray(u, &u0));
    PetscCall(VecRestoreArrayRead(next, &u1));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With one substep an explicit body answers by its massless layer alone, or, where its contact nodes have mass, not at all; with more, the
   substeps are made */
static PetscErrorCode ProbeExplicit(Body body, PetscInt row)
{
  struct _BodyCompliance *c     = body->compliance;
  const PetscInt          local = row - body->rows.begin;
  PetscScalar            *values;

  PetscFunctionBegin;
  if (body->substeps == 1) {
    if (body->layer_scatter) PetscCall(ConstrainedSolverApplyUnit(body->solver, row, body->layer_solution, c->mine));
    else PetscCall(PetscArrayzero(c->mine, body->rows.local));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodySetUnitForce(body, row));
  if (local >= 0 && local < body->rows.local) body->conditions[local] = BODY_FORCED;
  PetscCall(BodyRestore(body));
  PetscCall(BodyIntegrateWindow(body));
  body->total_substeps -= body->substeps;
  if (local >= 0 && local < body->rows.local) body->conditions[local] = BODY_FREE;
  for (PetscInt k = 0; k < body->substeps; k++) {
    PetscCall(TraceGetLevel(body->traces.displacement, k + 1, &values));
    PetscCall(PetscArraycpy(c->mine + k * body->rows.local, values, body->rows.local));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Column of a row at all levels, into the work space `mine` */
static PetscErrorCode ProbeRow(Body body, PetscInt row)
{
  PetscFunctionBegin;
  if (body->is_explicit) PetscCall(ProbeExplicit(body, row));
  else PetscCall(ProbeImplicit(body, row));
  PetscCall(ComplianceSetColumn(body->compliance->matrices, row, body->substeps, body->compliance->mine));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By integrating the body at rest, with all rows free but the one in hand */
static PetscErrorCode ProbeByIntegrating(Body body, PetscInt n, const PetscInt rows[])
{
  const PetscInt counts[3] = {body->n_prescribed, body->n_forced, body->n_robin};
  BodyCondition *kept;

  PetscFunctionBegin;
  PetscCall(BodyBeginProbe(body));
  PetscCall(PetscMalloc1(body->rows.local, &kept));
  PetscCall(PetscArraycpy(kept, body->conditions, body->rows.local));
  PetscCall(PetscArrayzero(body->conditions, body->rows.local));
  body->n_prescribed = body->n_robin = 0;
  body->n_forced                     = 1;
  PetscCall(BodySetConstraints(body));
  PetscCall(BodyPrepareLinearized(body));
  body->linearized = (PetscBool)!body->linear;
  for (PetscInt i = 0; i < n; i++)
    if (!ComplianceKnows(body->compliance->matrices, rows[i])) PetscCall(ProbeRow(body, rows[i]));
  body->linearized = PETSC_FALSE;
  PetscCall(BodyEndProbe(body));
  PetscCall(PetscArraycpy(body->conditions, kept, body->rows.local));
  body->n_prescribed = counts[0];
  body->n_forced     = counts[1];
  body->n_robin      = counts[2];
  PetscCall(BodySetConstraints(body));
  PetscCall(PetscFree(kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns of the rows that are not known yet. With one substep the body's solver has them, where its compliance is this one. */
PetscErrorCode BodyProbeCompliance(Body body, PetscInt n, const PetscInt rows[])
{
  const PetscBool shares = (PetscBool)(body->substeps == 1 && body->solver && BodyGetSharedCompliance(body));

  PetscFunctionBegin;
  if (body->is_explicit && body->substeps > 1) {
    PetscCall(ProbeByIntegrating(body, n, rows));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < n; i++) {
    if (ComplianceKnows(body->compliance->matrices, rows[i])) continue;
    if (shares) PetscCall(ConstrainedSolverExtend(body->solver, rows[i]));
    else PetscCall(ProbeRow(body, rows[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
