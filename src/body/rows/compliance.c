/*
   The interface compliance of a body: what its rows' displacements do in the course of one controller step under contact forces on the
   rows. A force enters as a hat in the first substep, of 1 N at its end; since the body does not change with time, what comes out k
   substeps later is the same wherever the hat stands. The matrix of each level is symmetric (Maxwell, Betti), so that a row which becomes
   known later brings its own column only.

   It is exact for linear bodies. For nonlinear ones it is that of the last effective matrix, or of the undeformed body.
*/
#include "complianceimpl.h"

PetscErrorCode BodyDestroyCompliance(Body body)
{
  struct _BodyCompliance *c = body->compliance;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
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
  PetscCall(PetscCalloc6(rows->global, &c->place, rows->local, &c->roles, body->time.substeps * rows->local, &c->mine,
                         body->time.substeps * rows->local, &c->base_displacement, body->time.substeps * rows->local, &c->base_force,
                         rows->global, &c->all_roles));
  for (PetscInt i = 0; i < rows->global; i++) c->place[i] = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for more known rows; what is known stays */
static PetscErrorCode Grow(Body body, PetscInt n)
{
  struct _BodyCompliance *c   = body->compliance;
  const PetscInt          old = c->capacity, s = body->time.substeps;
  PetscInt                capacity = PetscMin(body->rows.global, PetscMax(n, 2 * old)), *rows, *prescribed;
  PetscScalar            *levels, *ramp, *factor;
  PetscBLASInt           *pivots;

  PetscFunctionBegin;
  if (n <= old) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc3(capacity, &rows, capacity, &prescribed, capacity, &pivots));
  PetscCall(PetscMalloc3(s * capacity * capacity, &levels, capacity * capacity, &ramp, capacity * capacity, &factor));
  PetscCall(PetscArraycpy(rows, c->rows, c->n));
  for (PetscInt k = 0; k < s; k++)
    for (PetscInt j = 0; j < c->n; j++)
      PetscCall(PetscArraycpy(levels + (k * capacity + j) * capacity, c->levels + (k * old + j) * old, c->n));
  PetscCall(PetscFree3(c->rows, c->prescribed, c->pivots));
  PetscCall(PetscFree3(c->levels, c->ramp, c->factor));
  PetscCall(PetscFree6(c->known_displacement, c->known_force, c->input, c->force, c->displacement, c->rhs));
  PetscCall(PetscMalloc6(s * capacity, &c->known_displacement, s * capacity, &c->known_force, s * capacity, &c->input, s * capacity,
                         &c->force, s * capacity, &c->displacement, capacity, &c->rhs));
  c->rows       = rows;
  c->prescribed = prescribed;
  c->pivots     = pivots;
  c->levels     = levels;
  c->ramp       = ramp;
  c->factor     = factor;
  c->capacity   = capacity;
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
  Each new row costs one solution with factored matrices: of the whole body, if it is implicit, of its massless layer, if it is explicit;
  for each substep, and of explicit bodies with substeps these themselves.

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
  PetscCall(BodyProbeCompliance(body, first));
  c->ramp_valid = c->base_gathered = c->factored = PETSC_FALSE;
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
  for (PetscInt k = 0; k < body->time.substeps; k++) {
    PetscScalar *matrix = c->levels + k * c->capacity * c->capacity;

    for (PetscInt j = 0; j < n; j++)
      for (PetscInt i = 0; i < n; i++) matrix[j * c->capacity + i] = matrix[from[j] * c->capacity + from[i]];
  }
  for (PetscInt j = 0; j < n; j++) {
    c->rows[j]           = c->rows[from[j]];
    c->place[c->rows[j]] = j;
  }
  c->n          = n;
  c->ramp_valid = c->base_gathered = c->factored = PETSC_FALSE;
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

      for (PetscInt l = 1; l <= body->time.substeps; l++)
        sum += (PetscReal)l / body->time.substeps * c->levels[((body->time.substeps - l) * c->capacity + j) * c->capacity + i];
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
  PetscCheck(level >= -1 && level < body->time.substeps, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_OUTOFRANGE,
             "Level %" PetscInt_FMT " of a body with %" PetscInt_FMT " substeps", level, body->time.substeps);
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
  *exact = (PetscBool)(body->model.linear && body->integrator->affine);
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
  PetscCall(PetscLogEventBegin(BODY_Response, body, 0, 0, 0));
  if (body->solver) PetscCall(ConstrainedSolverApplyCompliance(body->solver, force, displacement));
  else PetscCall(VecZeroEntries(displacement));
  PetscCall(PetscLogEventEnd(BODY_Response, body, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
