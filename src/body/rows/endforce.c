/* Contact forces that act at the end of a controller step and move nothing in it. */
#include <body/layout/bodyimpl.h>

/*@
  BodyFeelsEndForce - whether displacements at the end of the controller step answer to the contact forces there

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. feels - false for explicit bodies with mass on their contact nodes and one substep to a controller step, where the force at its end goes
          into the acceleration alone

  Level: developer

.seealso: `Body`, `BodyAddEndForce()`
@*/
PetscErrorCode BodyFeelsEndForce(Body body, PetscBool *feels)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  *feels = body->integrator->feels_end_force;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddEndForce - changes the state at the end of the controller step by that of a force on the rows at its end

  Collective

  Input Parameters:
+ body  - a `Body` that does not feel such forces before its next step, integrated
- force - one for each row of this rank [N], to be added to that in its input trace

  Level: developer

  Note:
  The same as to integrate it once more, up to round-off, at the cost of a product with the rows: a += M^{-1} B^T force, v += dt / 2 of
  that.

.seealso: `Body`, `BodyFeelsEndForce()`, `BodyIntegrate()`
@*/
PetscErrorCode BodyAddEndForce(Body body, const PetscScalar force[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodySolveMassOfRows(body, force, body->work.nodes[2]));
  PetscCall(VecAXPY(body->state.a, 1, body->work.nodes[2]));
  PetscCall(VecAXPY(body->state.v, 0.5 * body->time.step, body->work.nodes[2]));
  PetscCall(BodyWriteTraces(body, body->time.substeps));
  body->statistics.substeps += body->time.substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}
