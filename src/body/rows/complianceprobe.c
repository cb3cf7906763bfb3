/* Columns of the interface compliance: a body at rest under a unit force on one row. */
#include "complianceimpl.h"

/* Column of a row at all levels, into the work space `mine`, by making the substeps of a controller step */
static PetscErrorCode IntegrateUnderUnitForce(Body body, PetscInt row)
{
  struct _BodyCompliance *c     = body->compliance;
  const PetscInt          local = row - body->rows.begin;
  PetscScalar            *values;

  PetscFunctionBegin;
  PetscCall(BodySetUnitForce(body, row));
  if (local >= 0 && local < body->rows.local) body->rows.conditions[local] = BODY_FORCED;
  PetscCall(BodyRestore(body));
  PetscCall(BodyIntegrateWindow(body));
  body->statistics.substeps -= body->time.substeps;
  if (local >= 0 && local < body->rows.local) body->rows.conditions[local] = BODY_FREE;
  for (PetscInt k = 0; k < body->time.substeps; k++) {
    PetscCall(TraceGetLevel(body->traces.displacement, k + 1, &values));
    PetscCall(PetscArraycpy(c->mine + k * body->rows.local, values, body->rows.local));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body whose integrator has no column to offer is integrated: at rest, with all rows free but the one in hand */
static PetscErrorCode ProbeByIntegrating(Body body, PetscInt n, const PetscInt rows[])
{
  const PetscInt counts[3] = {body->rows.n_prescribed, body->rows.n_forced, body->rows.n_robin};
  BodyCondition *kept;

  PetscFunctionBegin;
  PetscCall(BodyBeginProbe(body));
  PetscCall(PetscMalloc1(body->rows.local, &kept));
  PetscCall(PetscArraycpy(kept, body->rows.conditions, body->rows.local));
  PetscCall(PetscArrayzero(body->rows.conditions, body->rows.local));
  body->rows.n_prescribed = body->rows.n_robin = 0;
  body->rows.n_forced                          = 1;
  PetscCall(BodySetConstraints(body));
  PetscCall(BodyPrepareLinearized(body));
  body->model.linearized = (PetscBool)!body->model.linear;
  for (PetscInt i = 0; i < n; i++) {
    if (ComplianceKnows(body->compliance->matrices, rows[i])) continue;
    PetscCall(IntegrateUnderUnitForce(body, rows[i]));
    PetscCall(ComplianceSetColumn(body->compliance->matrices, rows[i], body->time.substeps, body->compliance->mine));
  }
  body->model.linearized = PETSC_FALSE;
  PetscCall(BodyEndProbe(body));
  PetscCall(PetscArraycpy(body->rows.conditions, kept, body->rows.local));
  body->rows.n_prescribed = counts[0];
  body->rows.n_forced     = counts[1];
  body->rows.n_robin      = counts[2];
  PetscCall(BodySetConstraints(body));
  PetscCall(PetscFree(kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns of the rows that are not known yet. With one substep the body's solver has them, where its compliance is this one. */
PetscErrorCode BodyProbeCompliance(Body body, PetscInt n, const PetscInt rows[])
{
  const PetscBool shares = (PetscBool)(body->time.substeps == 1 && body->solver && BodyGetSharedCompliance(body));

  PetscFunctionBegin;
  if (!body->integrator->ops.compliancecolumn) {
    PetscCall(ProbeByIntegrating(body, n, rows));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < n; i++) {
    if (ComplianceKnows(body->compliance->matrices, rows[i])) continue;
    if (shares) PetscCall(ConstrainedSolverExtend(body->solver, rows[i]));
    else {
      PetscCall((*body->integrator->ops.compliancecolumn)(body, rows[i], body->compliance->mine));
      PetscCall(ComplianceSetColumn(body->compliance->matrices, rows[i], body->time.substeps, body->compliance->mine));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
