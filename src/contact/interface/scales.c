/* The size of the problem. Tolerances on lengths and forces have defaults in parts of it, so that a problem given in other units, or made
   smaller as a whole, is solved in the same sweeps and steps and has the same figures but for their scale. */
#include <contact/parts.h>
#include <sys/units.h>
#include <impakt/private/bodymesh.h>

/* Diagonal of the box of a body's nodes [m]: the length of a bar, however it lies in space */
static PetscErrorCode GetExtent(Body body, PetscReal *extent)
{
  PetscReal lower[3] = {0}, upper[3] = {0}, square = 0;
  DM        dm;

  PetscFunctionBegin;
  PetscCall(BodyGetDM(body, &dm));
  PetscCall(DMGetBoundingBox(dm, lower, upper));
  for (PetscInt d = 0; d < 3; d++) square += PetscSqr(upper[d] - lower[d]);
  *extent = PetscSqrtReal(square);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Modulus of plane waves times the area of an element's face: of a bar, E A [N] */
static PetscErrorCode GetElementForce(Body body, PetscReal *force)
{
  PetscReal stiffness, size, cross_section;
  PetscInt  dim;

  PetscFunctionBegin;
  PetscCall(BodyGetScale(body, BODY_ELEMENT_STIFFNESS, &stiffness));
  PetscCall(BodyGetScale(body, BODY_ELEMENT_SIZE, &size));
  PetscCall(BodyGetScale(body, BODY_CROSS_SECTION, &cross_section));
  PetscCall(BodyGetDimension(body, &dim));
  *force = stiffness * size; /* of a bar the force already, else a pressure */
  if (dim == 2) *force *= size * cross_section;
  if (dim == 3) *force *= size * size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A larger part of a body as tolerance of gaps would decide contact itself: it is 3e-12 of the largest body, up to 3e7 times this one */
#define LARGEST_TOLERANCE 1e-4

/* The length that default tolerances on gaps and positions are parts of is the size of the smallest body [m]. The force that those on
   contact forces are parts of is the modulus of plane waves times the area of a face of an element of mean size, E A of bars, of all bodies
   the least [N]. Of bodies with meshes and materials, which need not be set up. */
PetscErrorCode ContactSetUpScales(Contact contact)
{
  const PetscReal tolerance = contact->options.tolerance;
  PetscReal       largest   = 0;
  const char     *small = "", *large = "";

  PetscFunctionBegin;
  contact->scale.length = contact->scale.force = PETSC_MAX_REAL;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal extent = 0, force = PETSC_MAX_REAL;

    PetscCall(GetExtent(contact->bodies[b], &extent));
    if (!BodyDoes(contact->bodies[b], BodyIsRigid) || contact->n_bodies == 1) PetscCall(GetElementForce(contact->bodies[b], &force));
    if (extent < contact->scale.length) small = ((PetscObject)contact->bodies[b])->name;
    if (extent > largest) large = ((PetscObject)contact->bodies[b])->name;
    largest               = PetscMax(largest, extent);
    contact->scale.length = PetscMin(contact->scale.length, extent);
    contact->scale.force  = PetscMin(contact->scale.force, force);
  }
  PetscCheck(
      !contact->n_pairs || tolerance <= LARGEST_TOLERANCE * contact->scale.length, PetscObjectComm((PetscObject)contact),
      PETSC_ERR_USER_INPUT,
      "Gaps count as closed to %g%s (-contact_tolerance), but body '%s' is %g%s large altogether, and '%s' %g%s: bodies that meet must "
      "not differ in size so much. Check their units, -%s_scale and -%s_scale",
      (double)tolerance, UnitsOf((PetscObject)contact, UNIT_LENGTH), small, (double)contact->scale.length,
      UnitsOf((PetscObject)contact, UNIT_LENGTH), large, (double)largest, UnitsOf((PetscObject)contact, UNIT_LENGTH), small, large);
  PetscFunctionReturn(PETSC_SUCCESS);
}
