/*
   Contact forces at the start of a controller step that differ from those that the last step ended with. A force on rows of a massless
   layer moves the layer, and the layer pulls at the nodes inside: those feel B~^T x with B~^T = -K_IL K_LL^{-1} B^T. So a start under
   forces that are larger by x is one with the acceleration M^{-1} B~^T x on top, displacement and velocity being as they are. The mean
   contact force of the step is then that of the start as given here and of the end, on both bodies, so that momentum is kept.
*/
#include <body/layout/bodyimpl.h>

/* The acceleration that forces on the rows, and those that go over from the rows of the last step, bring to the nodes that have mass */
static PetscErrorCode ComputeChange(Body body, const PetscScalar force[], Vec change)
{
  Vec          f = body->work.nodes[0], du = body->work.nodes[1], pull = body->work.nodes[2];
  PetscBool    layer = (PetscBool)(body->layer.n_dofs > 0);
  PetscScalar *row, *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(body->work.rows[0], &row));
  PetscCall(PetscArraycpy(row, force, body->rows.local));
  PetscCall(VecRestoreArrayWrite(body->work.rows[0], &row));
  PetscCall(MatMultTranspose(body->rows.free_matrix, body->work.rows[0], f));
  PetscCall(BodyAddStoppedHandover(body, f));
  PetscCall(BodyZeroHeld(body, f));
  PetscCall(BodyAnyRank(body, &layer));
  if (layer) {
    PetscCall(BodySolveLayer(body, body->saved.u, f, du, pull));
    PetscCall(VecAXPY(f, 1, pull));
    PetscCall(VecGetArray(f, &values));
    for (PetscInt i = 0; i < body->layer.n_dofs; i++) values[body->layer.dofs[i]] = 0;
    PetscCall(VecRestoreArray(f, &values));
  }
  PetscCall(BodyZeroHeld(body, f));
  PetscCall(BodySolveMass(body, f, change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetStartForce - lets the controller step begin with other contact forces than those that the last one ended with

  Collective

  Input Parameters:
+ body  - the `Body`, saved
. force - by how much more than at the end of the last step acts along each row of this rank [N]
- rest  - for each row of this rank, the part that remains of what goes over from the rows of the last step, see `BodyHandOver()`; `NULL`:
all

  Level: developer

  Notes:
  Holds until the next `BodySave()`, `BodyDropStartForce()`, or the next call. The state goes back to the saved one, whose acceleration
becomes that under the new forces, found with the massless layer in balance with them. A static body has no acceleration, and stays as it
is.

.seealso: `Body`, `BodySave()`, `BodyIntegrate()`
@*/
PetscErrorCode BodySetStartForce(Body body, const PetscScalar force[], const PetscReal rest[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  if (!body->integrator->has_inertia) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->start.a) PetscCall(BodyCreateVec(body, &body->start.a));
  if (body->start.changed) PetscCall(VecCopy(body->start.a, body->saved.a));
  else PetscCall(VecCopy(body->saved.a, body->start.a));
  body->start.changed = PETSC_TRUE;
  PetscCall(BodyRestore(body));
  PetscCall(BodySetHandoverRest(body, rest));
  PetscCall(ComputeChange(body, force, body->state.a));
  PetscCall(VecAXPY(body->saved.a, 1, body->state.a));
  PetscCall(BodyRestore(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyDropStartForce - lets the controller step begin with the contact forces that the last one ended with

  Collective

  Input Parameter:
. body - the `Body`, saved

  Level: developer

.seealso: `Body`, `BodySetStartForce()`, `BodyStepBack()`
@*/
PetscErrorCode BodyDropStartForce(Body body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!body->start.changed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecCopy(body->start.a, body->saved.a));
  PetscCall(BodySetHandoverRest(body, NULL));
  body->start.changed = PETSC_FALSE;
  PetscCall(BodyRestore(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
