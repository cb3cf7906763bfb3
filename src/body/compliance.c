/*
   The interface compliance of a body: what its rows' displacements do in the course of one controller step under contact forces on the
   rows. A force enters as a hat in the first substep, of 1 N at its end; since the body does not change with time, what comes out k substeps
   later is the same wherever the hat stands. The matrix of each level is symmetric (Maxwell, Betti), so that a row which becomes known
   later brings its own column only.

   It is exact for linear bodies. For nonlinear ones it is that of the last effective matrix, or of the undeformed body.
*/
#include "complianceimpl.h"

PetscErrorCode BodyDestroyCompliance(Body body)
{
  struct _BodyCompliance *c = body->compliance;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < 4; k++) PetscCall(VecDestroy(&c->work[k]));
  PetscCall(PetscFree6(c->place, c->roles, c->mine, c->base_displacement, c->base_force, c->all_roles));
  PetscCall(PetscFree3(c->rows, c->prescribed, c->pivots));
  PetscCall(PetscFree3(c->levels, c->ramp, c->factor));
  PetscCall(PetscFree6(c->known_displacement, c->known_force, c->input, c->force, c->displacement, c->rhs));
  PetscCall(PetscFree(body->compliance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyCreateCompliance(Body body)
{
  const BodyRows         *rows = &body->rows;
  struct _BodyCompliance *c;

  PetscFunctionBegin;
  if (body->compliance) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscNew(&body->compliance));
  c = body->compliance;
  PetscCall(PetscCalloc6(rows->global, &c->place, rows->local, &c->roles, body->substeps * rows->local, &c->mine, body->substeps * rows->local, &c->base_displacement, body->substeps * rows->local, &c->base_force, rows->global, &c->all_roles));
  for (PetscInt i = 0; i < rows->global; i++) c->place[i] = -1;
  if (!body->is_explicit)
    for (PetscInt k = 0; k < 4; k++) PetscCall(VecDuplicate(body->state.u, &c->work[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for more known rows; what is known stays */
static PetscErrorCode Grow(Body body, PetscInt n)
{
  struct _BodyCompliance *c   = body->compliance;
  const PetscInt          old = c->capacity, s = body->substeps;
  PetscInt                capacity = PetscMin(body->rows.global, PetscMax(n, 2 * old)), *rows, *prescribed;
  PetscScalar            *levels, *ramp, *factor;
  PetscBLASInt           *pivots;

  PetscFunctionBegin;
  if (n <= old) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc3(capacity, &rows, capacity, &prescribed, capacity, &pivots));
  PetscCall(PetscMalloc3(s * capacity * capacity, &levels, capacity * capacity, &ramp, capacity * capacity, &factor));
  PetscCall(PetscArraycpy(rows, c->rows, c->n));
  for (PetscInt k = 0; k < s; k++)
    for (PetscInt j = 0; j < c->n; j++) PetscCall(PetscArraycpy(levels + (k * capacity + j) * capacity, c->levels + (k * old + j) * old, c->n));
  PetscCall(PetscFree3(c->rows, c->prescribed, c->pivots));
  PetscCall(PetscFree3(c->levels, c->ramp, c->factor));
  PetscCall(PetscFree6(c->known_displacement, c->known_force, c->input, c->force, c->displacement, c->rhs));
  PetscCall(PetscMalloc6(s * capacity, &c->known_displacement, s * capacity, &c->known_force, s * capacity, &c->input, s * capacity, &c->force, s * capacity, &c->displacement, capacity, &c->rhs));
  c->rows       = rows;
  c->prescribed = prescribed;
  c->pivots     = pivots;
  c->levels     = levels;
  c->ramp       = ramp;
  c->factor     = factor;
  c->capacity   = capacity;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Values of this rank's rows, for each substep, on the known rows of every rank */
PetscErrorCode BodyGatherKnown(Body body, const PetscScalar mine[], PetscScalar all[])
{
  const struct _BodyCompliance *c    = body->compliance;
  const BodyRows               *rows = &body->rows;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < body->substeps; k++)
    for (PetscInt i = 0; i < c->n; i++) {
      const PetscInt local = c->rows[i] - rows->begin;

      all[k * c->n + i] = local >= 0 && local < rows->local ? mine[k * rows->local + local] : 0;
    }
  if (rows->size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all, (PetscMPIInt)(body->substeps * c->n), MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newmark's recursion from rest, with the effective matrix as it is factored; the hat is over after the first substep */
static PetscErrorCode ProbeImplicit(Body body, PetscInt row)
{
  struct _BodyCompliance *c  = body->compliance;
  const PetscReal         dt = body->time_step, c2 = 1 / (body->beta * dt * dt), c1 = c2 * dt, c0 = (1 - 2 * body->beta) / (2 * body->beta);
  const PetscInt          n = body->owned_nodes * body->dim, local = body->rows.local;
  const Vec               u = c->work[0], v = c->work[1], a = c->work[2], next = c->work[3];

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
  PetscCall(BodySetUnitInput(body, row, INPUT_FORCE));
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

/* Explicit bodies with substeps are probed by integrating them: at rest, with all rows free but the one in hand */
static PetscErrorCode ProbeAll(Body body, PetscInt first)
{
  struct _BodyCompliance *c          = body->compliance;
  const PetscBool         integrates = (PetscBool)(body->is_explicit && body->substeps > 1);
  const PetscInt          counts[3]  = {body->n_prescribed, body->n_forced, body->n_robin};
  BodyCondition          *kept       = NULL;

  PetscFunctionBegin;
  if (integrates) {
    PetscCall(BodyBeginProbe(body));
    PetscCall(PetscMalloc1(body->rows.local, &kept));
    PetscCall(PetscArraycpy(kept, body->conditions, body->rows.local));
    PetscCall(PetscArrayzero(body->conditions, body->rows.local));
    body->n_prescribed = body->n_robin = 0;
    body->n_forced                     = 1;
    PetscCall(BodySetConstraints(body));
    PetscCall(BodyPrepareLinearized(body));
    body->linearized = (PetscBool)!body->linear;
  }
  for (PetscInt j = first; j < c->n; j++) {
    if (body->is_explicit) PetscCall(ProbeExplicit(body, c->rows[j]));
    else PetscCall(ProbeImplicit(body, c->rows[j]));
    PetscCall(BodyGatherKnown(body, c->mine, c->displacement));
    for (PetscInt k = 0; k < body->substeps; k++) {
      PetscScalar *matrix = c->levels + k * c->capacity * c->capacity;

      for (PetscInt i = 0; i < c->n; i++) matrix[j * c->capacity + i] = c->displacement[k * c->n + i];
      for (PetscInt i = 0; i < first; i++) matrix[i * c->capacity + j] = c->displacement[k * c->n + i];
    }
  }
  if (integrates) {
    body->linearized = PETSC_FALSE;
    PetscCall(BodyEndProbe(body));
    PetscCall(PetscArraycpy(body->conditions, kept, body->rows.local));
    body->n_prescribed = counts[0];
    body->n_forced     = counts[1];
    body->n_robin      = counts[2];
    PetscCall(BodySetConstraints(body));
    PetscCall(PetscFree(kept));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyExtendCompliance - makes rows known to the interface compliance

  Collective

  Input Parameters:
+ body - the `Body`, set up
. n    - number of rows
- rows - rows of any rank, the same on every rank; those that are known already cost nothing

  Level: developer

  Notes:
  Each new row costs one solution with factored matrices: of the whole body, if it is implicit, of its massless layer, if it is explicit; for each
  substep, and of explicit bodies with substeps these themselves.

.seealso: `Body`, `BodyGetCompliance()`, `BodyRespond()`
@*/
PetscErrorCode BodyExtendCompliance(Body body, PetscInt n, const PetscInt rows[])
{
  struct _BodyCompliance *c;
  PetscInt                first, count = 0;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodyCreateCompliance(body));
  c = body->compliance;
  for (PetscInt i = 0; i < n; i++) count += c->place[rows[i]] < 0;
  if (!count) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(BODY_Response, body, 0, 0, 0));
  PetscCall(Grow(body, c->n + count));
  first = c->n;
  for (PetscInt i = 0; i < n; i++) {
    if (c->place[rows[i]] >= 0) continue;
    c->place[rows[i]] = c->n;
    c->rows[c->n++]   = rows[i];
  }
  PetscCall(ProbeAll(body, first));
  c->ramp_valid = c->base_gathered = PETSC_FALSE;
  PetscCall(PetscLogEventEnd(BODY_Response, body, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyForgetCompliance - makes rows unknown again

  Collective

  Input Parameters:
+ body    - the `Body`, set up
- changed - for each row of all ranks, whether it is no more what it was

  Level: developer

.seealso: `Body`, `BodyExtendCompliance()`, `BodyUpdateInterface()`
@*/
PetscErrorCode BodyForgetCompliance(Body body, const PetscMPIInt changed[])
{
  struct _BodyCompliance *c = body->compliance;
  PetscInt                n = 0, *from;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(c->n, &from));
  for (PetscInt j = 0; j < c->n; j++) {
    if (changed[c->rows[j]]) c->place[c->rows[j]] = -1;
    else from[n++] = j;
  }
  for (PetscInt k = 0; k < body->substeps; k++) {
    PetscScalar *matrix = c->levels + k * c->capacity * c->capacity;

    for (PetscInt j = 0; j < n; j++)
      for (PetscInt i = 0; i < n; i++) matrix[j * c->capacity + i] = matrix[from[j] * c->capacity + from[i]];
  }
  for (PetscInt j = 0; j < n; j++) {
    c->rows[j]           = c->rows[from[j]];
    c->place[c->rows[j]] = j;
  }
  c->n          = n;
  c->ramp_valid = c->base_gathered = PETSC_FALSE;
  PetscCall(PetscFree(from));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums of hats that rise linearly over the controller step */
static PetscErrorCode ComputeRamp(Body body)
{
  struct _BodyCompliance *c = body->compliance;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < c->n; j++)
    for (PetscInt i = 0; i < c->n; i++) {
      PetscScalar sum = 0;

      for (PetscInt l = 1; l <= body->substeps; l++) sum += (PetscReal)l / body->substeps * c->levels[((body->substeps - l) * c->capacity + j) * c->capacity + i];
      c->ramp[j * c->capacity + i] = sum;
    }
  c->ramp_valid = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetCompliance - displacements of known rows under unit forces on them

  Not Collective

  Input Parameters:
+ body  - the `Body`, after `BodyExtendCompliance()`
- level - k: at the end of a substep for a force at the end of the k-th substep before it, a hat; -1: at the end of the controller step, for
          forces that rise linearly over it

  Output Parameters:
+ place   - for each row of all ranks its place among the known ones, or -1
. leading - distance between columns
- matrix  - known rows by known rows, by columns [m/N], owned by the body

  Level: developer

.seealso: `Body`, `BodyExtendCompliance()`
@*/
PetscErrorCode BodyGetCompliance(Body body, PetscInt level, const PetscInt *place[], PetscInt *leading, const PetscScalar *matrix[])
{
  struct _BodyCompliance *c = body->compliance;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(c, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodyExtendCompliance() first");
  PetscCheck(level >= -1 && level < body->substeps, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_OUTOFRANGE, "Level %" PetscInt_FMT " of a body with %" PetscInt_FMT " substeps", level, body->substeps);
  if (level < 0 && !c->ramp_valid) PetscCall(ComputeRamp(body));
  *place   = c->place;
  *leading = c->capacity;
  *matrix  = level < 0 ? c->ramp : c->levels + level * c->capacity * c->capacity;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyComplianceIsExact - whether the displacements of the rows are affine in the contact forces at the ends of the substeps

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. exact - true for linear bodies, if implicit then under Newmark's method

  Level: developer

.seealso: `Body`, `BodyRespond()`
@*/
PetscErrorCode BodyComplianceIsExact(Body body, PetscBool *exact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  *exact = (PetscBool)(body->linear && (body->is_explicit || body->is_static || (body->alpha_f == 1 && body->alpha_m == 1)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyApplyCompliance - displacements of all rows, at the end of a substep, under forces on them at its end

  Collective

  Input Parameters:
+ body  - the `Body`, set up
- force - one for each row [N]

  Output Parameter:
. displacement - one for each row [m]

  Level: developer

  Note:
  One solution with factored matrices, for interfaces with too many rows to know each of them.

.seealso: `Body`, `BodyExtendCompliance()`
@*/
PetscErrorCode BodyApplyCompliance(Body body, Vec force, Vec displacement)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (body->solver) PetscCall(ConstrainedSolverApplyCompliance(body->solver, force, displacement));
  else PetscCall(VecZeroEntries(displacement));
  PetscFunctionReturn(PETSC_SUCCESS);
}
