/* All forces on the nodes of an explicit body but the internal ones. */
#include "explicitimpl.h"

/* Whether there are any: from loads or, where it is counted, of contact */
PetscBool BodyHasOutsideForce(Body body, PetscBool contact)
{
  const PetscBool pushed = (PetscBool)(body->rows.n_forced && (!body->rows.idle || body->rows.nodal_force));

  return (PetscBool)(body->loads || (contact && (pushed || BodyHandsOver(body))));
}

/* Force from outside at a time and, if counted, of contact at a position (0 to 1) in the controller step [N]; u: for Robin springs */
PetscErrorCode BodyComputeOutsideForce(Body body, PetscReal time, PetscReal position, PetscBool contact, Vec u, Vec force)
{
  PetscFunctionBegin;
  PetscCall(VecZeroEntries(force));
  PetscCall(BodyAddExternalForce(body, time, 1, force));
  if (contact) PetscCall(BodyAddContactForce(body, position, 1, u, force));
  PetscFunctionReturn(PETSC_SUCCESS);
}
