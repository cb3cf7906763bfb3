/* The motion that the user prescribes on held dofs, put into vectors, and the inertia that comes with it. */
#include <body/layout/bodyimpl.h>

/* Sets the held dofs of any of u [m], v [m/s], a [m/s^2] to what is prescribed at time t; all to zero while the body is probed */
PetscErrorCode BodyPrescribeHeld(Body body, PetscReal t, Vec u, Vec v, Vec a)
{
  PetscFunctionBegin;
  if (!body->loads) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->unloaded) {
    if (u) PetscCall(BodyZeroHeld(body, u));
    if (v) PetscCall(BodyZeroHeld(body, v));
    if (a) PetscCall(BodyZeroHeld(body, a));
  } else PetscCall(BodyLoadsPrescribe(body, t, u, v, a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A mass matrix that is not diagonal couples held dofs, whose acceleration a at time t is given, with the others: subtracts their inertia
   M a from the force f on the others. Held dofs of f become their acceleration itself, for the factored matrix has rows of the identity
   there. `work` and body->work.nodes[2] are overwritten. */
PetscErrorCode BodySubtractHeldInertia(Body body, PetscReal t, Vec f, Vec work)
{
  PetscFunctionBegin;
  if (!body->held.any || body->mass.diagonal || !body->integrator->has_inertia) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecZeroEntries(body->work.nodes[2]));
  PetscCall(BodyPrescribeHeld(body, t, NULL, NULL, body->work.nodes[2]));
  PetscCall(MatMult(body->mass.matrix, body->work.nodes[2], work));
  PetscCall(VecAXPY(f, -1, work));
  PetscCall(BodyCopyHeld(body, body->work.nodes[2], f));
  PetscFunctionReturn(PETSC_SUCCESS);
}
