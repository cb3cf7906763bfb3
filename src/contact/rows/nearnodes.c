/* Bodies of which those contact nodes alone are massless that face a partner at the start (-<body>_mass_redistribute near): which nodes
   these are, that contact comes to no others, and what other bodies would gain by it. */
#include <contact/parts.h>
#include <impakt/private/bodymass.h>
#include <impakt/private/bodymesh.h>

/* Forces on nodes with mass that are smaller, in parts of the largest nodal force, are round-off of the weights */
#define FORCE_ROUND_OFF 1e-9

/* A surface of a pair, and that of its partner, with the faces alone that face the partner at the start; the partner's is NULL for an
 * obstacle */
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
  const PetscInt *vertices;
  PetscInt        n;
  Surface         surfaces[2];

  PetscFunctionBegin;
  PetscCall(ContactCreateFacing(contact, pair, surfaces));
  PetscCall(SurfaceGetVertices(surfaces[side], &n, &vertices));
  PetscCall(BodySetContactNodes(contact->bodies[pair->body[side]], n, vertices));
  for (PetscInt s = 0; s < 2; s++) PetscCall(SurfaceDestroy(&surfaces[s]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if contact forces act on nodes that keep their mass since they faced nothing at the start: the methods count on
   massless nodes, and such nodes would chatter without a word */
PetscErrorCode ContactCheckNear(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool near;
    PetscReal on_mass, largest;

    PetscCall(BodyGetMassRedistributeNear(contact->bodies[b], &near));
    if (!near) continue;
    PetscCall(BodyGetForceOnMass(contact->bodies[b], contact->end.force, &on_mass, &largest));
    PetscCheck(on_mass <= FORCE_ROUND_OFF * largest, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "Contact has come to nodes of body '%s' that faced nothing at the start, where -%s_mass_redistribute near leaves mass (%g "
               "N); set it "
               "to true",
               ((PetscObject)contact->bodies[b])->name, ((PetscObject)contact->bodies[b])->name, (double)on_mass);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What -<body>_mass_redistribute near would change of the moments of inertia that a body turns with, as BodyGetInertiaChange() tells of the
   massless nodes; the same as now where the body has it already, or where pairs come and go, which they do not with it. Collective. */
PetscErrorCode ContactGetNearInertiaChange(Contact contact, PetscInt body, PetscReal *change)
{
  PetscBool near;
  PetscInt  n_all = 0, *all = NULL;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(change, 3);
  PetscCall(BodyGetMassRedistributeNear(contact->bodies[body], &near));
  PetscCall(BodyGetInertiaChange(contact->bodies[body], 0, NULL, change));
  if (near || contact->neighbours.come_and_go) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(1, &all)); /* no NULL, which stands for the nodes as they are */
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const PetscInt    *vertices;
    PetscInt           n;
    Surface            surfaces[2];

    if (pair->keeps_mass || (pair->body[0] != body && (pair->obstacle || pair->body[1] != body))) continue;
    PetscCall(ContactCreateFacing(contact, pair, surfaces));
    PetscCall(SurfaceGetVertices(surfaces[pair->body[0] != body], &n, &vertices));
    PetscCall(PetscRealloc((size_t)(n_all + n + 1) * sizeof(*all), &all));
    PetscCall(PetscArraycpy(all + n_all, vertices, n));
    n_all += n;
    for (PetscInt s = 0; s < 2; s++) PetscCall(SurfaceDestroy(&surfaces[s]));
  }
  PetscCall(BodyGetInertiaChange(contact->bodies[body], n_all, all, change));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}
