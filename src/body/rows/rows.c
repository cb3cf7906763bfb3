/* The rows of the interface, B u, as one body sees them: prescribing them, loading them, reporting them. */
#include <body/layout/bodyimpl.h>

const char *const BodyTractionTypes[] = {"internal", "reaction", "BodyTractionType", "BODY_TRACTION_", NULL};

/* Sets the rows B: all rows of the interface, those of other bodies empty, times the displacements of the body. A row that may be
   prescribed is a vector on one node of this rank, a unit vector but for held dofs. Rows of one node may have any directions; of
   dependent ones see BodySetRowWeights(). Collective. */
PetscErrorCode BodySetInterface(Body body, Mat B)
{
  BodyRows *rows = &body->rows;

  PetscFunctionBegin;
  BodyCheckNotSetUp(body);
  PetscCall(PetscObjectReference((PetscObject)B));
  PetscCall(MatDestroy(&body->rows.matrix));
  body->rows.matrix = B;
  PetscCall(MatGetLocalSize(B, &rows->local, NULL));
  PetscCall(MatGetSize(B, &rows->global, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of the interface without held dofs, which no contact force moves */
PetscErrorCode BodySetUpFreeRows(Body body)
{
  BodyRows *rows = &body->rows;

  PetscFunctionBegin;
  PetscCall(MatDestroy(&rows->free_matrix));
  if (!body->held.any) {
    PetscCall(PetscObjectReference((PetscObject)rows->matrix));
    rows->free_matrix = rows->matrix;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!rows->free_dofs) {
    PetscCall(VecDuplicate(body->state.u, &rows->free_dofs));
    PetscCall(VecSet(rows->free_dofs, 1));
    PetscCall(BodyZeroHeld(body, rows->free_dofs));
  }
  PetscCall(MatDuplicate(rows->matrix, MAT_COPY_VALUES, &rows->free_matrix));
  PetscCall(MatDiagonalScale(rows->free_matrix, NULL, rows->free_dofs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Chooses the nodal force that is reported for prescribed rows; on massless nodes both types are the same */
PetscErrorCode BodySetTractionType(Body body, BodyTractionType type)
{
  PetscFunctionBegin;
  body->rows.traction = type;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Weights, positive on prescribed rows of this rank, by which dependent rows of a node share displacement and force; else equal. */
PetscErrorCode BodySetRowWeights(Body body, const PetscReal weights[])
{
  PetscFunctionBegin;
  body->rows.weights = weights;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stiffness of Robin rows' springs, per row of this rank [N/m], before BodySetConditions(): the force is r - stiffness B u, r the input */
PetscErrorCode BodySetRobin(Body body, const PetscReal stiffness[])
{
  PetscFunctionBegin;
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  PetscCall(PetscArraycpy(body->rows.robin, stiffness, body->rows.local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the condition of each row of this rank; no matrix is factored again. Collective. */
PetscErrorCode BodySetConditions(Body body, const BodyCondition conditions[])
{
  PetscInt counts[] = {0, 0, 0, 0}; /* prescribed rows, forced and Robin rows, Robin rows; ranks on which any is another one */

  PetscFunctionBegin;
  for (PetscInt i = 0; i < body->rows.local; i++) {
    if (conditions[i] != body->rows.conditions[i]) counts[3] = 1;
    body->rows.conditions[i] = conditions[i];
    counts[0] += conditions[i] == BODY_PRESCRIBED;
    counts[1] += conditions[i] == BODY_FORCED || conditions[i] == BODY_ROBIN;
    counts[2] += conditions[i] == BODY_ROBIN;
  }
  if (body->rows.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, 4, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  if (!counts[3]) PetscFunctionReturn(PETSC_SUCCESS);
  body->rows.n_prescribed = counts[0];
  body->rows.n_forced     = counts[1];
  body->rows.n_robin      = counts[2];
  body->repeats           = PETSC_FALSE;
  PetscCall(BodySetConstraints(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyFreeRows - all rows free, so that no solver has rows to hold: conditions come with the next step */
PetscErrorCode BodyFreeRows(Body body)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(body->rows.conditions, body->rows.local));
  body->rows.n_prescribed = body->rows.n_forced = body->rows.n_robin = 0;
  body->repeats                                                      = PETSC_FALSE;
  PetscCall(BodySetConstraints(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodySetConstraints(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyUpdateGram(body));
  for (PetscInt i = 0; i < body->rows.local; i++) {
    body->rows.constrained[i] = (PetscBool)(body->rows.conditions[i] == BODY_PRESCRIBED || body->rows.conditions[i] == BODY_ROBIN);
    body->rows.flexibility[i] = body->rows.conditions[i] == BODY_ROBIN ? 1 / body->rows.robin[i] : 0;
  }
  BodyUnmarkDependent(body, body->rows.constrained);
  if (body->solver && !body->rows.n_prescribed && !body->rows.n_robin) PetscCall(ConstrainedSolverFreeRows(body->solver));
  else if (body->solver) {
    if (body->local && body->integrator->ops.agree) PetscCall((*body->integrator->ops.agree)(body));
    if (body->integrator->ops.setrows) PetscCall((*body->integrator->ops.setrows)(body));
    PetscCall(ConstrainedSolverSetConstraints(body->solver, body->rows.constrained, body->rows.flexibility));
  }
  if (body->mass.solver && body->integrator->divides_by_mass && body->rows.have_mass) {
    for (PetscInt i = 0; i < body->rows.local; i++) body->rows.constrained[i] = (PetscBool)(body->rows.conditions[i] == BODY_PRESCRIBED);
    BodyUnmarkDependent(body, body->rows.constrained);
    PetscCall(ConstrainedSolverSetConstraints(body->mass.solver, body->rows.constrained, NULL));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* vec += B^T G^{-1} (x - B vec) on prescribed rows, with x from the trace at that position (0 to 1) of the controller step; held dofs are
   in place, and stay there. Without a trace `vec` is a force, and its part along the rows, what holds dofs left aside, becomes zero. */
PetscErrorCode BodyPrescribe(Body body, Trace trace, PetscReal position, Vec vec)
{
  PetscScalar *row, *target;

  PetscFunctionBegin;
  if (!body->rows.n_prescribed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatMult(trace ? body->rows.matrix : body->rows.free_matrix, vec, body->work.rows[0]));
  PetscCall(VecGetArray(body->work.rows[0], &row));
  if (trace) {
    PetscCall(VecGetArrayWrite(body->work.rows[1], &target));
    PetscCall(TraceInterpolate(trace, position, 0, body->rows.local, target));
    for (PetscInt i = 0; i < body->rows.local; i++) row[i] = body->rows.conditions[i] == BODY_PRESCRIBED ? target[i] - row[i] : 0;
    PetscCall(VecRestoreArrayWrite(body->work.rows[1], &target));
  } else {
    for (PetscInt i = 0; i < body->rows.local; i++) row[i] = body->rows.conditions[i] == BODY_PRESCRIBED ? -row[i] : 0;
  }
  BodyDivideByGram(body, row);
  PetscCall(VecRestoreArray(body->work.rows[0], &row));
  PetscCall(MatMultTransposeAdd(body->rows.free_matrix, body->work.rows[0], vec, vec));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* f += scale B^T lambda on forced and Robin rows, with the force trace at that position of the controller step and the springs of
   Robin rows at displacement u; and what goes over from the rows as they were */
PetscErrorCode BodyAddContactForce(Body body, PetscReal position, PetscScalar scale, Vec u, Vec f)
{
  const PetscScalar *at = NULL;
  PetscScalar       *row;

  PetscFunctionBegin;
  PetscCall(BodyAddHandover(body, position, scale, f));
  if (!body->rows.n_forced) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->rows.nodal_force) {
    PetscCall(VecAXPY(f, body->rows.nodal_shape == BODY_FORCE_LINEAR ? scale * position : scale, body->rows.nodal_force));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (body->rows.idle) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->rows.exchange.open) {
    PetscCall(VecAXPY(f, scale, body->rows.exchange.force));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecGetArrayWrite(body->work.rows[2], &row));
  PetscCall(TraceInterpolate(body->traces.force_in, position, 0, body->rows.local, row));
  if (body->rows.n_robin) {
    PetscCall(MatMult(body->rows.matrix, u, body->work.rows[1]));
    PetscCall(VecGetArrayRead(body->work.rows[1], &at));
    for (PetscInt i = 0; i < body->rows.local; i++)
      if (body->rows.conditions[i] == BODY_ROBIN) row[i] -= body->rows.robin[i] * at[i];
    PetscCall(VecRestoreArrayRead(body->work.rows[1], &at));
  }
  for (PetscInt k = 0; k < body->rows.near.n; k++) {
    const PetscInt i = body->rows.near.numbers[k];

    row[i] = body->rows.conditions[i] == BODY_FORCED || body->rows.conditions[i] == BODY_ROBIN ? scale * row[i] : 0;
  }
  PetscCall(BodyAddNearRows(body, row, f));
  PetscCall(VecRestoreArrayWrite(body->work.rows[2], &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}
