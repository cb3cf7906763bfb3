/* The forces that a nonlinear body would have if it were linear: what its responses are probed with. */
#include <body/layout/bodyimpl.h>

/*@
  BodyPrepareLinearized - makes the elements of the linear body that a nonlinear one is at small displacements

  Collective

  Input Parameter:
. body - the `Body`, set up

  Level: developer

  Notes:
  The same mesh, cross-section or thickness, with the linear elastic material of `MaterialLinearize()`. Internal forces and tangents
  come from there while `body->linearized` is set. A linear body is its own.

  The second call and later ones cost nothing.

.seealso: `Body`, `MaterialLinearize()`
@*/
PetscErrorCode BodyPrepareLinearized(Body body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  if (body->linear || body->linearized_element) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MaterialLinearize(body->material, &body->linearized_material));
  PetscCall(ElementDuplicate(body->element, body->linearized_material, &body->linearized_element));
  PetscCall(ElementSetUp(body->linearized_element, body->element->count, body->connectivity, body->coordinates));
  PetscCall(BodyLayerLinearize(body, body->linearized_material));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The elements that forces and tangents come from */
PetscErrorCode BodyGetElement(Body body, Element *element)
{
  PetscFunctionBegin;
  *element = body->element;
  if (!body->linearized || body->linear) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(body->linearized_element, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Body '%s': call BodyPrepareLinearized() before its forces are linearized", body->hdr.name);
  *element = body->linearized_element;
  PetscFunctionReturn(PETSC_SUCCESS);
}
