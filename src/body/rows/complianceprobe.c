/* Columns of the interface compliance: a body at rest under a unit force on one row. */
#include "complianceimpl.h"

/* By making the substeps of a controller step */
static PetscErrorCode ProbeByIntegrating(Body body, PetscInt row)
{
  struct _BodyCompliance *c     = body->compliance;
  const PetscInt          local = row - body->rows.begin;
  PetscScalar            *values;

  PetscFunctionBegin;
  PetscCall(BodySetUnitInput(body, row, INPUT_FORCE));
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

/* Bodies whose integrator has no column to offer are probed by integrating them: at rest, with all rows free but the one in hand */
PetscErrorCode BodyProbeCompliance(Body body, PetscInt first)
{
  struct _BodyCompliance *c          = body->compliance;
  const PetscBool         integrates = (PetscBool)(body->integrator->ops.compliancecolumn == NULL);
  const PetscInt          counts[3]  = {body->rows.n_prescribed, body->rows.n_forced, body->rows.n_robin};
  BodyCondition          *kept       = NULL;

  PetscFunctionBegin;
  if (integrates) {
    PetscCall(BodyBeginProbe(body));
    PetscCall(PetscMalloc1(body->rows.local, &kept));
    PetscCall(PetscArraycpy(kept, body->rows.conditions, body->rows.local));
    PetscCall(PetscArrayzero(body->rows.conditions, body->rows.local));
    body->rows.n_prescribed = body->rows.n_robin = 0;
    body->rows.n_forced                          = 1;
    PetscCall(BodySetConstraints(body));
    PetscCall(BodyPrepareLinearized(body));
    body->model.linearized = (PetscBool)!body->model.linear;
  }
  for (PetscInt j = first; j < c->n; j++) {
    if (integrates) PetscCall(ProbeByIntegrating(body, c->rows[j]));
    else PetscCall((*body->integrator->ops.compliancecolumn)(body, c->rows[j], c->mine));
    PetscCall(BodyGatherKnown(body, c->mine, c->displacement));
    for (PetscInt k = 0; k < body->time.substeps; k++) {
      PetscScalar *matrix = c->levels + k * c->capacity * c->capacity;

      for (PetscInt i = 0; i < c->n; i++) matrix[j * c->capacity + i] = c->displacement[k * c->n + i];
      for (PetscInt i = 0; i < first; i++) matrix[i * c->capacity + j] = c->displacement[k * c->n + i];
    }
  }
  if (integrates) {
    body->model.linearized = PETSC_FALSE;
    PetscCall(BodyEndProbe(body));
    PetscCall(PetscArraycpy(body->rows.conditions, kept, body->rows.local));
    body->rows.n_prescribed = counts[0];
    body->rows.n_forced     = counts[1];
    body->rows.n_robin      = counts[2];
    PetscCall(BodySetConstraints(body));
    PetscCall(PetscFree(kept));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Values of this rank's rows, for each substep, on the known rows of every rank */
PetscErrorCode BodyGatherKnown(Body body, const PetscScalar mine[], PetscScalar all[])
{
  const struct _BodyCompliance *c    = body->compliance;
  const BodyRows               *rows = &body->rows;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < body->time.substeps; k++)
    for (PetscInt i = 0; i < c->n; i++) {
      const PetscInt local = c->rows[i] - rows->begin;

      all[k * c->n + i] = local >= 0 && local < rows->local ? mine[k * rows->local + local] : 0;
    }
  if (rows->size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all, (PetscMPIInt)(body->time.substeps * c->n), MPIU_SCALAR, MPIU_SUM,
                               PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
