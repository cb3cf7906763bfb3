/* Surfaces of bodies that pairs have: how they are made, and where they are now. */
#include <contact/parts.h>

/* A surface of a body; `name` NULL: the whole of it */
PetscErrorCode ContactCreateSurface(Contact contact, PetscInt body, const char name[], Surface *surface)
{
  PetscBool axisymmetric;
  DM        dm;

  PetscFunctionBegin;
  PetscCall(BodyGetDM(contact->bodies[body], &dm));
  PetscCall(SurfaceCreate(dm, name, surface));
  PetscCall(BodyGetAxisymmetric(contact->bodies[body], &axisymmetric));
  if (axisymmetric) PetscCall(SurfaceSetAxisymmetric(*surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The displacement of a body with which rows are laid, unless those of a pair are laid elsewhere, see ContactPair's `ahead` */
PetscErrorCode ContactGetRowPlace(Contact contact, PetscInt b, Vec *u)
{
  PetscFunctionBegin;
  if (contact->at_end[b]) *u = contact->ends[b];
  else PetscCall(BodyGetSolution(contact->bodies[b], u, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactMoveSurfaces(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt s = 0; s < contact->n_surfaces; s++) {
    Vec u;

    PetscCall(ContactGetRowPlace(contact, contact->surfaces[s].body, &u));
    PetscCall(SurfaceMove(contact->surfaces[s].surface, u));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
