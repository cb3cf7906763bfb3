/* Surfaces of bodies that pairs have: how they are made, and where they are now. */
#include <contact/parts.h>

/* A surface of a body; `name` NULL: the whole of it */
PetscErrorCode ContactCreateSurface(Contact contact, PetscInt body, const char name[], Surface *surface)
{
  DM dm;

  PetscFunctionBegin;
  PetscCall(BodyGetDM(contact->bodies[body], &dm));
  PetscCall(SurfaceCreate(dm, name, surface));
  if (BodyDoes(contact->bodies[body], BodyGetAxisymmetric)) PetscCall(SurfaceSetAxisymmetric(*surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The displacement of a body with which rows are laid, unless those of a pair are laid elsewhere, see ContactPair's `ahead` */
PetscErrorCode ContactGetRowPlace(Contact contact, PetscInt b, Vec *u)
{
  Vec v;

  PetscFunctionBegin;
  PetscCall(BodyGetSolution(contact->bodies[b], u, &v, NULL));
  if (contact->ahead[b] == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecWAXPY(contact->ends[b], contact->ahead[b], v, *u));
  *u = contact->ends[b];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All surfaces to where rows are laid: their own nodes alone */
PetscErrorCode ContactMoveSurfaces(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt s = 0; s < contact->n_surfaces; s++) {
    const PetscInt b = contact->surfaces[s].body;
    Vec            u, v;

    PetscCall(BodyGetSolution(contact->bodies[b], &u, &v, NULL));
    PetscCall(SurfaceMove(contact->surfaces[s].surface, u, contact->ahead[b], contact->ahead[b] != 0 ? v : NULL));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
