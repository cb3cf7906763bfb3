/* -<body>_mass_redistribute near: only contact nodes that face a partner at the start are massless; contact comes to no others. */
#include <contact/parts.h>
#include <impakt/private/bodymass.h>
#include <impakt/private/bodymesh.h>

/* Forces on nodes with mass that are smaller, in parts of the largest nodal force, are round-off of the weights */
#define FORCE_ROUND_OFF 1e-9

/* The surfaces of a pair with those faces that see the partner at the start; the partner's is NULL for an obstacle */
PetscErrorCode ContactCreateFacing(Contact contact, const ContactPair *pair, Surface surfaces[2])
{
  PetscFunctionBegin;
  surfaces[0] = surfaces[1] = NULL;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++)
    PetscCall(ContactCreateSurface(contact, pair->body[side], pair->surface[side], &surfaces[side]));
  PetscCall(SurfaceKeepFacing(surfaces[0], surfaces[1], pair->obstacle, PETSC_TRUE, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells a body whose far nodes keep their mass which of the nodes of a pair may touch: those that face the partner at the start */
PetscErrorCode ContactMarkNearNodes(Contact contact, const ContactPair *pair, PetscInt side)
{
  const SurfaceData *data;
  Surface            surfaces[2];

  PetscFunctionBegin;
  PetscCall(ContactCreateFacing(contact, pair, surfaces));
  PetscCall(SurfaceGetData(surfaces[side], &data));
  PetscCall(BodySetContactNodes(contact->bodies[pair->body[side]], data->n_nodes, data->vertices));
  for (PetscInt s = 0; s < 2; s++) PetscCall(SurfaceDestroy(&surfaces[s]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if contact forces act on nodes that keep their mass, facing nothing at the start: they would chatter */
PetscErrorCode ContactCheckNear(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal on_mass, largest;

    if (!BodyDoes(contact->bodies[b], BodyGetMassRedistributeNear)) continue;
    PetscCall(BodyGetForceOnMass(contact->bodies[b], contact->end.force, &on_mass, &largest));
    PetscCheck(on_mass <= FORCE_ROUND_OFF * largest, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "Contact has come to nodes of body '%s' that faced nothing at the start, where -%s_mass_redistribute near leaves mass (%g "
               "N); set it "
               "to true",
               ((PetscObject)contact->bodies[b])->name, ((PetscObject)contact->bodies[b])->name, (double)on_mass);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
