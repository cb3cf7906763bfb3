/* The forces that a nonlinear body would have if it were linear: what its responses are probed with. */
#include <body/layout/bodyimpl.h>

/* Makes the elements of the linear body that a nonlinear one is at small displacements: the same mesh, with the linear elastic material of
   `MaterialLinearize()`. Internal forces and tangents come from there while `body->model.linearized` is set. A linear body is its own. */
PetscErrorCode BodyPrepareLinearized(Body body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  if (body->model.linear || body->model.linearized_element) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ElementCreateSelection(body->model.element, PETSC_TRUE, body->model.element->count, NULL, body->mesh.connectivity,
                                   body->mesh.coordinates, &body->model.linearized_element));
  PetscCall(BodyLayerLinearize(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
