/*
   The size of the problem. Tolerances on lengths and forces have defaults in parts of it, so that a problem given in other units, or made
   smaller as a whole, is solved in the same sweeps and steps and has the same figures but for their scale.
*/
#include <impakt/private/contactimpl.h>

/* Longest edge of the box about a body's mesh [m] */
static PetscErrorCode GetExtent(Body body, PetscReal *extent)
{
  PetscReal lower[3] = {0}, upper[3] = {0};
  PetscInt  dim;
  DM        dm;

  PetscFunctionBegin;
  PetscCall(BodyGetDM(body, &dm));
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(DMGetBoundingBox(dm, lower, upper));
  *extent = 0;
  for (PetscInt d = 0; d < dim; d++) *extent = PetscMax(*extent, upper[d] - lower[d]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Modulus of plane waves times the area of an element's face: of a bar, E A [N] */
static PetscErrorCode GetElementForce(Body body, PetscReal *force)
{
  PetscReal stiffness, size, cross_section;
  PetscInt  dim;

  PetscFunctionBegin;
  PetscCall(BodyGetElementStiffness(body, &stiffness));
  PetscCall(BodyGetElementSize(body, &size));
  PetscCall(BodyGetCrossSection(body, &cross_section));
  PetscCall(BodyGetDimension(body, &dim));
  *force = stiffness * size; /* of a bar the force already, else a pressure */
  if (dim == 2) *force *= size * cross_section;
  if (dim == 3) *force *= size * size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of bodies with meshes and materials, which need not be set up. The smallest values of all bodies: what is small beside the least of them
   is small beside the others. */
PetscErrorCode ContactSetUpScales(Contact contact)
{
  PetscFunctionBegin;
  contact->length_scale = contact->force_scale = PETSC_MAX_REAL;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal extent = 0, force = 0;

    PetscCall(GetExtent(contact->bodies[b], &extent));
    PetscCall(GetElementForce(contact->bodies[b], &force));
    contact->length_scale = PetscMin(contact->length_scale, extent);
    contact->force_scale  = PetscMin(contact->force_scale, force);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetLengthScale - the length that default tolerances on gaps and positions are parts of

  Not Collective

  Input Parameter:
. contact - the `Contact`, in or after `ContactSetUp()`

  Output Parameter:
. length - size of the smallest body: of each body the longest edge of the box about its mesh at the start, of all bodies the least [m]

  Level: developer

.seealso: `Contact`, `ContactGetForceScale()`
@*/
PetscErrorCode ContactGetLengthScale(Contact contact, PetscReal *length)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  *length = contact->length_scale;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetForceScale - the force that default tolerances on contact forces are parts of

  Not Collective

  Input Parameter:
. contact - the `Contact`, in or after `ContactSetUp()`

  Output Parameter:
. force - modulus of plane waves times the area of a face of an element of mean size, of all bodies the least; E A of bars [N]

  Level: developer

.seealso: `Contact`, `ContactGetLengthScale()`
@*/
PetscErrorCode ContactGetForceScale(Contact contact, PetscReal *force)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  *force = contact->force_scale;
  PetscFunctionReturn(PETSC_SUCCESS);
}
