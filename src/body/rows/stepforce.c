/*
   Forces on the rows that are the same throughout a controller step, and what they bring about at its end. Integrators take the force at
   both ends of a substep; what a step begins with is in the acceleration there, which has that of the last step: so the acceleration is
   changed.
*/
#include "complianceimpl.h"

/*@
  BodySetConstantForces - has forces act along the rows throughout the controller step, in place of those that the last one ended with

  Collective

  Input Parameters:
+ body  - the `Body`, saved, whose rows are forced
. n     - number of near rows that may have a force now, or have had one in the last call
. rows  - their numbers
. force - along each row of this rank [N]
. last  - the same at the end of the last step, along the rows as they are now [N]
- none  - zero for each row of this rank

  Level: developer

  Note:
  Holds until the next call, `BodySave()`, or `BodyDropStartForce()`. Forces that act along rows as they were, see `BodyHandOver()`, are
gone.

.seealso: `Body`, `BodySetStartForce()`, `BodyGetNodalCompliance()`
@*/
PetscErrorCode BodySetConstantForces(Body body, PetscInt n, const PetscInt rows[], const PetscReal force[], const PetscReal last[],
                                     const PetscReal none[])
{
  PetscReal   *change = body->compliance->change;
  PetscScalar *values;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (n) {
    PetscAssertPointer(rows, 3);
    PetscAssertPointer(force, 4);
    PetscAssertPointer(last, 5);
  }
  for (PetscInt level = 0; level <= body->time.substeps; level++) {
    PetscCall(TraceGetLevel(body->traces.force_in, level, &values));
    for (PetscInt k = 0; k < n; k++) values[rows[k]] = force[rows[k]];
  }
  body->rows.idle = (PetscBool)(body->rows.size == 1);
  for (PetscInt k = 0; k < n && body->rows.idle; k++) body->rows.idle = (PetscBool)(force[rows[k]] == 0);
  if (!BodyAnswersByNodes(body)) PetscCall(PetscArrayzero(change, body->rows.local)); /* all rows count there */
  for (PetscInt k = 0; k < n; k++) change[rows[k]] = force[rows[k]] - last[rows[k]];
  /* BodyRepeat() moves the end state by what these forces are more than those before */
  if (body->repeats && body->rows.constant && body->integrator->repeats_constant) PetscFunctionReturn(PETSC_SUCCESS);
  body->rows.constant = PETSC_TRUE;
  PetscCall(BodySetStartForce(body, change, none));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyEndConstantForces - has constant forces count as ones that go from those at the start of the controller step to others at its end

  Not Collective

  Input Parameters:
+ body  - the `Body`, integrated under the forces of `BodySetConstantForces()`
. start - for each row of this rank by how much more than at the end of the last step [N]
- more  - by how much more at the end [N]

  Level: developer

  Note:
  For what holds dofs against them, and for the next step, which goes on from the forces at the end. The acceleration that these bring there
  is to be changed with `BodyAddImpulses()`. To be called before `BodySave()`.

.seealso: `Body`, `BodySetConstantForces()`, `BodyAddImpulses()`
@*/
PetscErrorCode BodyEndConstantForces(Body body, const PetscScalar start[], const PetscScalar more[])
{
  PetscScalar *end;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (body->rows.local) {
    PetscAssertPointer(start, 2);
    PetscAssertPointer(more, 3);
  }
  PetscCall(TraceGetLevel(body->traces.force_in, body->time.substeps, &end));
  for (PetscInt i = 0; i < body->rows.local; i++) {
    body->compliance->change[i] = PetscRealPart(start[i]);
    end[i] += more[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyComputeForceChange - how much more constant forces on the rows are at the start of a step than those that the last one ended with, on
   the nodes; `any`: whether the substep that has been made last is the first one of such a step */
PetscErrorCode BodyComputeForceChange(Body body, PetscBool *any, Vec change)
{
  PetscFunctionBegin;
  *any = (PetscBool)(body->rows.constant && body->state.step - body->saved.step == 1);
  if (!*any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecZeroEntries(change));
  PetscCall(BodyAddNearRows(body, body->compliance->change, change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyCreateNodalCompliance - one in which no displacement is known yet */
PetscErrorCode BodyCreateNodalCompliance(Body body, Compliance *nodal)
{
  PetscInt local, begin, all;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(body->state.u, &local));
  PetscCall(VecGetOwnershipRange(body->state.u, &begin, NULL));
  PetscCall(VecGetSize(body->state.u, &all));
  PetscCall(ComplianceCreate(PetscObjectComm((PetscObject)body), local, begin, all, nodal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetNodalCompliance - displacements at the end of the controller step under unit forces on nodes

  Collective

  Input Parameters:
+ body  - the `Body`, set up
. shape - how forces run in the step: from none to 1 N, or 1 N throughout
. n     - number of displacements
- dofs  - their numbers among those of all ranks, the same on every rank; those that are known already cost nothing

  Output Parameters:
+ place   - for each displacement of all ranks its place among the known ones, or -1
. leading - distance between columns
- matrix  - known displacements by known ones, by columns [m/N], owned by the body

  Level: developer

  Note:
  Each new one costs a solution with a matrix where one tells, see nodalmatrix.c, else a controller step of the body, linearized about its
  undeformed state. Where they follow the body, see `BodyNodalComplianceFollows()`, all are found anew in each call, with the matrix of
  the last iteration of Newton's method. Of more than 100 displacements of a body with one substep they are approximate, but for small
linear bodies and explicit ones with massless contact nodes. More than 100 of an explicit body of one rank, with substeps, lumped mass on
all nodes and no dashpots, are found 8 together by these substeps where forces are felt. Those of a rigid body are found where it will be in
the middle of the controller step, anew for each, and cost next to nothing.

.seealso: `Body`, `BodySetConstantForces()`, `BodyNodalComplianceFollows()`
@*/
PetscErrorCode BodyGetNodalCompliance(Body body, BodyForceShape shape, PetscInt n, const PetscInt dofs[], const PetscInt *place[],
                                      PetscInt *leading, const PetscScalar *matrix[])
{
  struct _BodyCompliance *compliance                                                    = body->compliance;
  Compliance             *nodal                                                         = &compliance->nodal;
  PetscErrorCode (*probe)(Body, BodyForceShape, PetscInt, const PetscInt[], Compliance) = body->integrator->ops.nodalcolumns;
  PetscInt  unknown = n, known = 0;
  PetscBool renewed, follows;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(place, 5);
  PetscAssertPointer(leading, 6);
  PetscAssertPointer(matrix, 7);
  PetscCall(BodyNodalComplianceFollows(body, n, &follows));
  if (*nodal && (follows || compliance->nodal_step != body->time.step || compliance->nodal_shape != shape ||
                 (probe && compliance->nodal_time != body->saved.time))) {
    ComplianceClear(*nodal);
    PetscCall(NodalMatrixDestroy(&compliance->nodal_matrix));
  }
  if (*nodal) {
    ComplianceGetRows(*nodal, &known, NULL, NULL);
    unknown = 0;
    for (PetscInt i = 0; i < n; i++) unknown += !ComplianceKnows(*nodal, dofs[i]);
  }
  if (unknown) {
    PetscCall(PetscLogEventBegin(BODY_Compliance, body, 0, 0, 0));
    PetscCall(NodalMatrixRenew(body, shape, known + unknown, n, dofs, &compliance->nodal_kind, &compliance->nodal_matrix, &renewed));
    if (!*nodal) PetscCall(BodyCreateNodalCompliance(body, nodal));
    if (renewed) ComplianceClear(*nodal);
    if (renewed || !known) {
      compliance->nodal_time  = body->saved.time;
      compliance->nodal_step  = body->time.step;
      compliance->nodal_shape = shape;
      unknown                 = n;
    }
    PetscCall(PetscInfo(body, "%" PetscInt_FMT " new columns of the compliance of nodes of body '%s', each a %s\n", unknown,
                        ((PetscObject)body)->name, NodalMatrixDescribe(compliance->nodal_matrix)));
    PetscCall(ComplianceReserve(*nodal, unknown));
    if (probe) PetscCall((*probe)(body, shape, n, dofs, *nodal));
    else if (compliance->nodal_matrix) PetscCall(NodalMatrixProbe(body, compliance->nodal_matrix, n, dofs, *nodal));
    else PetscCall(BodyProbeNodes(body, shape, n, dofs, *nodal));
    PetscCall(PetscLogEventEnd(BODY_Compliance, body, 0, 0, 0));
  }
  ComplianceGetRows(*nodal, NULL, NULL, place);
  ComplianceGetMatrix(*nodal, leading, matrix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetNodalDiagonal - the nodal compliance of a body none of whose nodes answers to forces on others within a controller step

  Collective

  Input Parameters:
+ body  - the `Body`, set up
- shape - how forces run in the step

  Output Parameter:
. diagonal - displacement of each node along each axis at the end of the step under unit forces there [m/N], owned by the body; `NULL` where
             nodes answer to each other

  Level: developer

  Note:
  Central differences with lumped mass in one step move nodes by the forces at its start alone: dt^2/2 over the mass, whatever the
  material; forces that grow from none do not move them.

.seealso: `Body`, `BodyGetNodalCompliance()`
@*/
PetscErrorCode BodyGetNodalDiagonal(Body body, BodyForceShape shape, Vec *diagonal)
{
  struct _BodyCompliance *compliance = body->compliance;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(diagonal, 3);
  *diagonal = NULL;
  if (!body->mass.inverse || body->integrator->staggered <= 0 || body->time.substeps > 1 || body->layer.exists)
    PetscFunctionReturn(PETSC_SUCCESS);
  if (!compliance->diagonal || compliance->diagonal_step != body->time.step || compliance->diagonal_shape != shape) {
    if (!compliance->diagonal) PetscCall(BodyCreateVec(body, &compliance->diagonal));
    PetscCall(VecCopy(body->mass.inverse, compliance->diagonal));
    PetscCall(VecScale(compliance->diagonal, shape == BODY_FORCE_CONSTANT ? 0.5 * PetscSqr(body->time.step) : 0));
    PetscCall(BodyZeroHeld(body, compliance->diagonal));
    compliance->diagonal_step  = body->time.step;
    compliance->diagonal_shape = shape;
  }
  *diagonal = compliance->diagonal;
  PetscFunctionReturn(PETSC_SUCCESS);
}
