/* What part of contact is a rank's own. */
#include <contact/parts.h>

/* How many faces of the surfaces of all pairs, of both sides, and rows of all pairs lie on this rank */
PetscErrorCode ContactGetShare(Contact contact, PetscInt *facets, PetscInt *rows)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(facets, 2);
  PetscAssertPointer(rows, 3);
  *facets = *rows = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt side = 0; side < 2; side++) {
      const SurfaceData *data;

      if (!pair->surfaces[side]) continue;
      PetscCall(SurfaceGetData(pair->surfaces[side], &data));
      *facets += data->n_faces;
    }
    *rows += pair->end - pair->begin;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
