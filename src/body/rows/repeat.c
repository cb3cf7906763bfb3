/*
   Sweeps of one controller step integrate a body again and again from one state, with other inputs at its rows. Where it makes one substep,
   its integrator may find what a change of the inputs changes at the end of the step without another whole step.
*/
#include <body/layout/bodyimpl.h>

struct _BodyRepeat {
  PetscScalar *inputs[2], *changes[2]; /* of this rank's rows, at the end of the controller step: force [N], displacement [m] */
};

PetscErrorCode BodyDestroyRepeat(Body body)
{
  PetscFunctionBegin;
  if (!body->repeat) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < 2; k++) PetscCall(PetscFree2(body->repeat->inputs[k], body->repeat->changes[k]));
  PetscCall(PetscFree(body->repeat));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After the integrator and the rows */
PetscErrorCode BodySetUpRepeat(Body body)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(&body->repeat));
  for (PetscInt k = 0; k < 2; k++)
    PetscCall(PetscCalloc2(body->rows.local, &body->repeat->inputs[k], body->rows.local, &body->repeat->changes[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What comes in at the end of the controller step is the present state's from now on; `changes`: by how much that is more than before, on
   the rows that it counts for */
static PetscErrorCode TakeInputs(Body body, PetscBool *any)
{
  const Trace         traces[] = {body->traces.force_in, body->traces.displacement_in};
  struct _BodyRepeat *repeat   = body->repeat;

  PetscFunctionBegin;
  *any = PETSC_FALSE;
  for (PetscInt k = 0; k < 2; k++) {
    PetscScalar *values;

    PetscCall(TraceGetLevel(traces[k], body->time.substeps, &values));
    for (PetscInt i = 0; i < body->rows.local; i++) {
      const BodyCondition condition = body->rows.conditions[i];
      const PetscBool     counts    = (PetscBool)(k ? condition == BODY_PRESCRIBED : condition == BODY_FORCED || condition == BODY_ROBIN);

      repeat->changes[k][i] = counts ? values[i] - repeat->inputs[k][i] : 0;
      repeat->inputs[k][i]  = values[i];
      if (repeat->changes[k][i] != 0) *any = PETSC_TRUE;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A whole integration has just been done */
PetscErrorCode BodyNoteInputs(Body body)
{
  PetscBool any;

  PetscFunctionBegin;
  if (!body->integrator->ops.repeat || !body->rows.global) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TakeInputs(body, &any));
  /* rows of one node that are not orthonormal are prescribed by least squares, which has no simple change */
  body->repeats = (PetscBool)(!body->rows.n_prescribed || (body->integrator->repeats_prescribed && !body->rows.any_oblique));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the end state of this controller step to the inputs as they are now, if that can be done */
PetscErrorCode BodyRepeat(Body body, PetscBool *done)
{
  PetscBool any;

  PetscFunctionBegin;
  *done = body->repeats;
  if (!*done) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TakeInputs(body, &any));
  if (!(BodyStepsAlone(body) && body->rows.at_home)) PetscCall(BodyAnyRank(body, &any));
  /* Without a change the state stays as it is, bit for bit. Prescribed nodes with mass may yet be given another velocity and acceleration,
     which others feel through a mass matrix that is not diagonal alone. */
  if (any || (body->rows.have_mass && body->mass.matrix))
    PetscCall((*body->integrator->ops.repeat)(body, body->repeat->changes[0], body->repeat->changes[1]));
  else if (body->rows.have_mass) {
    PetscCall(BodyPrescribe(body, body->traces.velocity_in, 1, body->state.v));
    PetscCall(BodyPrescribe(body, body->traces.acceleration_in, 1, body->state.a));
  }
  PetscCall(BodyWriteTraces(body, body->time.substeps));
  body->statistics.substeps += body->time.substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}
