/*
   Pairs that the program has chosen, of all bodies with each other, are mostly far apart. While the boxes about both surfaces are farther
   from each other than bodies can come in the next controller steps, their rows have no partner: they are neither built again nor looked
   at, and nothing is put aside of them.
*/
#include <contact/parts.h>
#include <impakt/private/bodymesh.h>

/* Boxes that are farther apart, beyond the reach of a controller step, are far [edges of the contact elements] */
#define FAR 4
/* Up to so many such pairs all have their rows always, and gaps are those of the surfaces however far they are apart */
#define FEW_PAIRS 16

/* Boxes of all surfaces where they are, of all ranks */
static PetscErrorCode GetBoxes(Contact contact)
{
  PetscReal         *boxes;
  const SurfaceData *data;

  PetscFunctionBegin;
  if (!contact->work.boxes) PetscCall(PetscMalloc1(6 * contact->n_surfaces, &contact->work.boxes));
  boxes = contact->work.boxes;
  for (PetscInt s = 0; s < contact->n_surfaces; s++) {
    PetscCall(SurfaceGetData(contact->surfaces[s].surface, &data));
    BoxFind(data->n_owned, data->positions, boxes + 6 * s);
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, boxes, (PetscMPIInt)(6 * contact->n_surfaces), MPIU_REAL, MPIU_MIN,
                               PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which pairs are far. `near`: surfaces that far apart may touch in the next controller step [m]. Call with the surfaces where they are.
   Where pairs come and go, all pairs are of bodies that are near; those with an edge between them still need no partners. */
PetscErrorCode ContactFindFarPairs(Contact contact, PetscReal near)
{
  const PetscBool  come_and_go = contact->neighbours.come_and_go;
  const PetscReal *edge        = contact->neighbours.edge;
  PetscReal        largest     = 0;
  PetscInt         chosen      = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs && chosen <= FEW_PAIRS; p++) chosen += contact->pairs[p].chosen && !contact->pairs[p].obstacle;
  if (!come_and_go && chosen <= FEW_PAIRS) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies && !come_and_go; b++) {
    PetscReal size;

    PetscCall(BodyGetScale(contact->bodies[b], BODY_CONTACT_ELEMENT_SIZE, &size));
    largest = PetscMax(largest, size);
  }
  PetscCall(GetBoxes(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];

    if (!pair->chosen || pair->obstacle || pair->bonded) continue;
    pair->distance = ContactBoxDistance(contact->work.boxes + 6 * pair->place[0], contact->work.boxes + 6 * pair->place[1]);
    pair->far = (PetscBool)(pair->distance > near + (come_and_go ? PetscMax(edge[pair->body[0]], edge[pair->body[1]]) : FAR * largest));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
