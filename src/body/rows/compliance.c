/*
   The interface compliance of a body: what its rows' displacements do in the course of one controller step under contact forces on the
   rows. A force enters as a hat in the first substep, of 1 N at its end; since the body does not change with time, what comes out k
   substeps later is the same wherever the hat stands. The matrix of each level is symmetric (Maxwell, Betti), so that a row which becomes
   known later brings its own column only.

   It is exact for linear bodies. For nonlinear ones it is that of the last effective matrix, or of the undeformed body.
*/
#include "complianceimpl.h"
#include <sys/stages.h>

PetscErrorCode BodyDestroyCompliance(Body body)
{
  struct _BodyCompliance *c = body->compliance;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree2(c->mine, c->unknown));
  PetscCall(ComplianceDestroy(&c->matrices));
  PetscCall(ComplianceDestroy(&c->nodal));
  PetscCall(NodalMatrixDestroy(&c->nodal_matrix));
  PetscCall(VecDestroy(&c->diagonal));
  PetscCall(PetscFree(c->change));
  PetscCall(PetscFree(body->compliance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Before the solvers of the body are made, since that of a linear body keeps the compliance of prescribed rows in the same place */
PetscErrorCode BodyCreateCompliance(Body body)
{
  const BodyRows         *rows = &body->rows;
  struct _BodyCompliance *c;

  PetscFunctionBegin;
  PetscCall(PetscNew(&body->compliance));
  c             = body->compliance;
  c->nodal_kind = NODAL_BY_STEPS;
  PetscCall(
      ComplianceCreate(PetscObjectComm((PetscObject)body), rows->local, rows->begin, rows->global, body->time.substeps, &c->matrices));
  PetscCall(PetscMalloc2(body->time.substeps * rows->local, &c->mine, rows->global, &c->unknown));
  PetscCall(PetscCalloc1(rows->local, &c->change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where a solver of the body keeps the compliance of rows that it constrains: with the others while its matrix is constant, else apart,
   since the outer iteration wants one that stays as it is from sweep to sweep */
Compliance BodyGetSharedCompliance(Body body)
{
  return body->model.linear ? body->compliance->matrices : NULL;
}

/* Whether the body's solver has the columns: with one substep, where its compliance is this one */
static PetscBool SolverHasColumns(Body body)
{
  return (PetscBool)(body->time.substeps == 1 && body->solver && !body->integrator->ops.compliancecolumns && BodyGetSharedCompliance(body));
}

/* Those of some rows that are not known yet */
static PetscInt ListUnknown(struct _BodyCompliance *c, PetscInt n, const PetscInt rows[])
{
  PetscInt count = 0;

  for (PetscInt i = 0; i < n; i++)
    if (!ComplianceKnows(c->matrices, rows[i])) c->unknown[count++] = rows[i];
  return count;
}

/* Columns of the rows that are not known yet */
static PetscErrorCode ProbeCompliance(Body body, PetscInt n, const PetscInt rows[])
{
  struct _BodyCompliance *c = body->compliance;
  PetscInt                count;

  PetscFunctionBegin;
  if (body->integrator->ops.compliancecolumns) {
    PetscCall((*body->integrator->ops.compliancecolumns)(body, n, rows, c->matrices));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  count = ListUnknown(c, n, rows);
  if (SolverHasColumns(body)) {
    PetscCall(ConstrainedSolverExtend(body->solver, count, c->unknown));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < count; i++) {
    PetscCall((*body->integrator->ops.compliancecolumn)(body, c->unknown[i], c->mine));
    PetscCall(ComplianceSetColumn(c->matrices, c->unknown[i], body->time.substeps, c->mine));
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
  Each new row costs one solution with factored matrices: of the whole body, if it is implicit, of its massless layer, if it is explicit;
  for each substep, and of explicit bodies with substeps these themselves.

.seealso: `Body`, `BodyGetCompliance()`
@*/
PetscErrorCode BodyExtendCompliance(Body body, PetscInt n, const PetscInt rows[])
{
  BodyWord word;

  PetscFunctionBegin;
  PetscCall(BodyProposeCompliance(body, n, rows, &word));
  if (word.n)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, word.values, (PetscMPIInt)word.n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscCall(BodyTakeCompliance(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyPrepareCompliance - brings what `BodyExtendCompliance()` or `BodyProposeCompliance()` needs of other ranks

  Collective

  Input Parameters:
+ body - the `Body`, set up
. n    - number of rows
- rows - rows of any rank, the same on every rank, and those of the call that follows

  Level: developer

  Note:
  Called for all bodies before the first of these calls, it lets ranks that have a body each find its columns at the same time. It may be
  left out.

.seealso: `Body`, `BodyExtendCompliance()`, `BodyProposeCompliance()`
@*/
PetscErrorCode BodyPrepareCompliance(Body body, PetscInt n, const PetscInt rows[])
{
  PetscInt count;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->compliance, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  if (!SolverHasColumns(body)) PetscFunctionReturn(PETSC_SUCCESS);
  count = ListUnknown(body->compliance, n, rows);
  PetscCall(ConstrainedSolverBringRows(body->solver, count, body->compliance->unknown));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyProposeCompliance - the part of `BodyExtendCompliance()` before ranks tell each other, which callers do for many bodies at once

  Collective

  Input Parameters:
+ body - the `Body`, set up
. n    - number of rows
- rows - rows of any rank, the same on every rank; those that are known already cost nothing

  Output Parameter:
. word - what ranks have to add up before `BodyTakeCompliance()`, columns of the compliance [m/N]; it stays with the body

  Level: developer

.seealso: `Body`, `BodyExtendCompliance()`, `BodyTakeCompliance()`
@*/
PetscErrorCode BodyProposeCompliance(Body body, PetscInt n, const PetscInt rows[], BodyWord *word)
{
  PetscInt  count = 0;
  PetscBool logged;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(word, 4);
  PetscCheck(body->compliance, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  word->n = 0;
  for (PetscInt i = 0; i < n; i++) count += !ComplianceKnows(body->compliance->matrices, rows[i]);
  if (!count) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(StageBegin(STAGE_INTERFACE, &logged));
  PetscCall(PetscLogEventBegin(BODY_Compliance, body, 0, 0, 0));
  PetscCall(ComplianceReserve(body->compliance->matrices, count));
  ComplianceWait(body->compliance->matrices);
  PetscCall(ProbeCompliance(body, n, rows));
  ComplianceGetWaiting(body->compliance->matrices, &word->n, &word->values);
  PetscCall(PetscLogEventEnd(BODY_Compliance, body, 0, 0, 0));
  PetscCall(StageEnd(logged));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyTakeCompliance - the rest of `BodyExtendCompliance()`, after `BodyProposeCompliance()`, the word of which has been added up

  Not Collective

  Input Parameter:
. body - the `Body`

  Level: developer

.seealso: `Body`, `BodyExtendCompliance()`, `BodyProposeCompliance()`
@*/
PetscErrorCode BodyTakeCompliance(Body body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (body->compliance) ComplianceTakeWaiting(body->compliance->matrices);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyForgetCompliance - makes rows unknown again

  Collective

  Input Parameters:
+ body    - the `Body`, set up
- changed - for each row of all ranks, whether it is no more what it was

  Level: developer

.seealso: `Body`, `BodyExtendCompliance()`
@*/
PetscErrorCode BodyForgetCompliance(Body body, const PetscMPIInt changed[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (body->compliance) PetscCall(ComplianceForget(body->compliance->matrices, changed));
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
  PetscAssertPointer(place, 3);
  PetscAssertPointer(leading, 4);
  PetscAssertPointer(matrix, 5);
  PetscCheck(c, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodyExtendCompliance() first");
  PetscCheck(level >= -1 && level < body->time.substeps, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_OUTOFRANGE,
             "Level %" PetscInt_FMT " of a body with %" PetscInt_FMT " substeps", level, body->time.substeps);
  ComplianceGetRows(c->matrices, NULL, NULL, place);
  if (level < 0) PetscCall(ComplianceGetRamp(c->matrices, leading, matrix));
  else ComplianceGetMatrix(c->matrices, level, leading, matrix);
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

.seealso: `Body`, `BodyGetCompliance()`
@*/
PetscErrorCode BodyComplianceIsExact(Body body, PetscBool *exact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(exact, 2);
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
  PetscBool logged;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(StageBegin(STAGE_INTERFACE, &logged));
  PetscCall(PetscLogEventBegin(BODY_Compliance, body, 0, 0, 0));
  if (body->integrator->ops.applycompliance) PetscCall((*body->integrator->ops.applycompliance)(body, force, displacement));
  else if (body->solver) PetscCall(ConstrainedSolverApplyCompliance(body->solver, force, displacement));
  else PetscCall(VecZeroEntries(displacement));
  PetscCall(PetscLogEventEnd(BODY_Compliance, body, 0, 0, 0));
  PetscCall(StageEnd(logged));
  PetscFunctionReturn(PETSC_SUCCESS);
}
