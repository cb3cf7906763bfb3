/* Sweeps of one controller step integrate a body again and again from one state, with other inputs at its rows. Where it makes one substep,
   its integrator may find what a change of the inputs changes at the end of the step without another whole step. */
#include <body/layout/bodyimpl.h>

/* Whether a row takes in a force (0) or a displacement (1) */
static PetscBool Counts(Body body, PetscInt input, PetscInt row)
{
  const BodyCondition condition = body->rows.conditions[row];

  return (PetscBool)(input ? condition == BODY_PRESCRIBED : condition == BODY_FORCED || condition == BODY_ROBIN);
}

/* Changes of the inputs at the end of the controller step from the present state's, on rows they count for; `any`: on this rank. `takes`:
   what comes in is the present state's from now on. */
static PetscErrorCode CompareInputs(Body body, PetscBool takes, PetscBool *any)
{
  const Trace    traces[] = {body->traces.force_in, body->traces.displacement_in};
  BodyRows      *rows     = &body->rows;
  const RowList *read     = &rows->near;

  PetscFunctionBegin;
  *any = PETSC_FALSE;
  for (PetscInt k = 0; k < 2; k++) {
    PetscScalar *values;

    PetscCall(TraceGetLevel(traces[k], body->time.substeps, &values));
    for (PetscInt j = 0; j < read->n; j++) {
      const PetscInt i = read->numbers[j];

      rows->changes[k][i] = Counts(body, k, i) ? values[i] - rows->inputs[k][i] : 0;
      if (rows->changes[k][i] != 0) *any = PETSC_TRUE;
      if (takes) rows->inputs[k][i] = values[i];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings the changes that the next BodyRepeat() makes to the rank that has the body */
PetscErrorCode BodyBringChanges(Body body)
{
  PetscBool any;

  PetscFunctionBegin;
  PetscCall(CompareInputs(body, PETSC_FALSE, &any));
  PetscCall(ConstrainedSolverBring(body->solver, body->rows.changes[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyNoteInputs(Body body)
{
  PetscBool any;

  PetscFunctionBegin;
  if (!body->integrator->ops.repeat || !body->rows.global) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CompareInputs(body, PETSC_TRUE, &any));
  /* rows of one node that are not orthonormal are prescribed by least squares, which has no simple change */
  body->repeats = (PetscBool)(!body->rows.n_prescribed || (body->integrator->repeats_prescribed && !body->rows.any_oblique));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the end state of this controller step to the inputs as they are now, if that can be done */
PetscErrorCode BodyRepeat(Body body, PetscBool *done)
{
  PetscScalar *const *changes = body->rows.changes;
  PetscBool           any;

  PetscFunctionBegin;
  *done = body->repeats;
  if (!*done) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CompareInputs(body, PETSC_TRUE, &any));
  /* where rows of other ranks count, their inputs may have changed */
  if (body->rows.size > 1 && !(BodyStepsAlone(body) && body->rows.at_home)) any = PETSC_TRUE;
  /* Without a change a state in balance stays as it is, bit for bit. Prescribed nodes with mass may yet be given another velocity and
     acceleration, which others feel through a mass matrix that is not diagonal alone. */
  if (any || (body->rows.have_mass && body->mass.matrix)) {
    if (body->integrator->repeats_by_solver && !body->rows.exchange.open) PetscCall(ConstrainedSolverBring(body->solver, changes[0]));
    PetscCall((*body->integrator->ops.repeat)(body, changes[0], changes[1]));
  } else if (body->rows.have_mass) {
    PetscCall(BodyPrescribe(body, body->traces.velocity_in, 1, body->state.v));
    PetscCall(BodyPrescribe(body, body->traces.acceleration_in, 1, body->state.a));
  }
  PetscCall(BodyWriteTraces(body, body->time.substeps));
  body->statistics.substeps += body->time.substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}
