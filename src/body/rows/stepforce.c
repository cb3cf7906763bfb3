/* Forces on rows that are the same throughout a controller step, and their effect at its end. Integrators take the force at both ends of a
   substep; what a step begins with is in the acceleration there, which has that of the last step: so the acceleration is changed. */
#include "complianceimpl.h"

/* Lets forces [N] act along the forced rows throughout the controller step, until the next call, BodySave() or BodyDropStartForce().
   `rows`: the near rows that may have a force now or had one in the last call; `last`: forces at the end of the last step along the
   present rows; `none`: zeros for each row. Forces along former rows, see BodyHandOver(), are gone. Collective. */
PetscErrorCode BodySetConstantForces(Body body, PetscInt n, const PetscInt rows[], const PetscReal force[], const PetscReal last[],
                                     const PetscReal none[])
{
  PetscReal   *change = body->rows.excess;
  PetscScalar *values;

  PetscFunctionBegin;
  for (PetscInt level = 0; level <= body->time.substeps; level++) {
    PetscCall(TraceGetLevel(body->traces.force_in, level, &values));
    for (PetscInt k = 0; k < n; k++) values[rows[k]] = force[rows[k]];
  }
  body->rows.idle = (PetscBool)(body->rows.size == 1);
  for (PetscInt k = 0; k < n && body->rows.idle; k++) body->rows.idle = (PetscBool)(force[rows[k]] == 0);
  if (!BodyAnswersByNodes(body)) PetscCall(PetscArrayzero(change, body->rows.local)); /* all rows count there */
  for (PetscInt k = 0; k < n; k++) change[rows[k]] = force[rows[k]] - last[rows[k]];
  if (body->repeats && body->rows.constant && body->integrator->repeats_constant) {
    PetscCall(BodyNoteStart(body)); /* BodyRepeat() moves start and end by what these forces are more than those before */
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  body->rows.constant = PETSC_TRUE;
  PetscCall(BodySetStartForce(body, change, none));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts constant forces as linear ones, that start with `start` more than at the end of the last step and end with `more` more [N]: for
   the reactions of held dofs and the next step. BodyAddImpulses() has to change the acceleration at the end. Before BodySave(). */
PetscErrorCode BodyEndConstantForces(Body body, const PetscScalar start[], const PetscScalar more[])
{
  PetscScalar *end;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(body->traces.force_in, body->time.substeps, &end));
  for (PetscInt i = 0; i < body->rows.local; i++) {
    body->rows.excess[i] = PetscRealPart(start[i]);
    end[i] += more[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacements at the end of the controller step under unit forces on n displacements, global numbers, the same on every rank. `place`:
   of each displacement of all ranks among the known ones, or -1; `matrix`: known by known ones, by columns `leading` apart [m/N], owned
   by the body. Known ones cost nothing; a new one costs a solution, see nodalmatrix.c, or a controller step linearized about the
   undeformed state. More than 100 of a body with one substep are approximate, but for small linear bodies and explicit ones with
   massless contact nodes. Those of a rigid body hold in the middle of the step. Collective. */
PetscErrorCode BodyGetNodalCompliance(Body body, BodyForceShape shape, PetscInt n, const PetscInt dofs[], const PetscInt *place[],
                                      PetscInt *leading, const PetscScalar *matrix[])
{
  struct _BodyCompliance *compliance                                                    = body->compliance;
  Compliance             *nodal                                                         = &compliance->nodal;
  PetscErrorCode (*probe)(Body, BodyForceShape, PetscInt, const PetscInt[], Compliance) = body->integrator->ops.nodalcolumns;
  PetscInt  unknown = n, known = 0;
  PetscBool renewed, follows;

  PetscFunctionBegin;
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
    if (!*nodal) PetscCall(ComplianceCreate(body->state.u, nodal));
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
    else PetscCall(NodalMatrixProbe(body, compliance->nodal_matrix, shape, n, dofs, *nodal));
    PetscCall(PetscLogEventEnd(BODY_Compliance, body, 0, 0, 0));
  }
  ComplianceGetRows(*nodal, NULL, NULL, place);
  ComplianceGetMatrix(*nodal, leading, matrix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodal compliance [m/N] of a body none of whose nodes answers to forces on others in a controller step, owned by the body, else
   NULL. Central differences with a lumped mass in one step move nodes by the forces at its start alone: by dt^2/2 over the mass under
   constant forces, not at all under linear ones. Collective. */
PetscErrorCode BodyGetNodalDiagonal(Body body, BodyForceShape shape, Vec *diagonal)
{
  struct _BodyCompliance *compliance = body->compliance;

  PetscFunctionBegin;
  *diagonal = NULL;
  if (!body->mass.inverse || body->integrator->staggered <= 0 || body->time.substeps > 1 || body->layer.exists)
    PetscFunctionReturn(PETSC_SUCCESS);
  if (!compliance->diagonal) PetscCall(BodyCreateVec(body, &compliance->diagonal));
  PetscCall(VecAXPBY(compliance->diagonal, shape == BODY_FORCE_CONSTANT ? 0.5 * PetscSqr(body->time.step) : 0, 0, body->mass.inverse));
  PetscCall(BodyZeroHeld(body, compliance->diagonal));
  *diagonal = compliance->diagonal;
  PetscFunctionReturn(PETSC_SUCCESS);
}
