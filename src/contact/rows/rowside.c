/* Which body of a pair has the contact rows: a row for each of its nodes. Pairs whose second body has them are turned round here, once and
   for all; what users and files see stays in the order in which the user has named the bodies. */
#include <contact/parts.h>

/* Two surfaces are alike if the ratio of the distances between their nodes is above this, so that round-off does not choose the side */
#define ALIKE 0.999

/* The body that has the rows takes displacements, its partner tractions, whatever their order in ContactAddPair(). Names, forces, moments
   and normals of the pair stay in that order.

   The finer surface is the one whose nodes are closer together by more than a thousandth, as a mean over its faces in the reference
   positions; else, and in one dimension, the first body has the rows. A pair for which that would bring the bodies into a circle, each
   waiting for the reaction of the one before, has them on its first body too. A pair with an obstacle has its rows on the body. */
const char *const ContactRowSides[] = {"first", "second", "finer", "ContactRowSide", "CONTACT_ROW_SIDE_", NULL};

/*@
  ContactGetPairRowSide - which body of a pair has the contact rows

  Not Collective

  Input Parameters:
+ contact - the `Contact`, set up
- pair    - 0 to the number of pairs - 1

  Output Parameter:
. body - 0: the one that `ContactGetPair()` gives first; 1: the second one

  Level: intermediate

.seealso: `Contact`, `ContactGetPair()`, `ContactView()`
@*/
PetscErrorCode ContactGetPairRowSide(Contact contact, PetscInt pair, PetscInt *body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(body, 3);
  ContactCheckPair(contact, pair);
  *body = !contact->neighbours.come_and_go && contact->pairs[pair].turned ? 1 : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mean distance of the nodes of a surface [m]: the root of the area for each node, of which triangles have half as many as quadrilaterals
 */
static PetscErrorCode GetSpacing(Contact contact, Surface surface, PetscReal *spacing)
{
  const SurfaceData *data;
  PetscReal          sums[2] = {0, 0}; /* area, and nodes on it */

  PetscFunctionBegin;
  PetscCall(SurfaceGetData(surface, &data));
  for (PetscInt f = 0; f < data->n_faces; f++) sums[0] += data->face_areas[f];
  sums[1] = data->n_faces * (data->face_nodes == 3 ? 0.5 : 1);
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  *spacing = PetscPowReal(sums[0] / sums[1], 1.0 / (contact->dim - 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns a pair round if its second body is to have the rows. Its surfaces must be known. */
PetscErrorCode ContactChooseRowSide(Contact contact, ContactPair *pair)
{
  PetscReal spacing[2] = {0, 0};

  PetscFunctionBegin;
  if (!pair->own_side) pair->row_side = contact->options.row_side;
  if (pair->obstacle) {
    PetscCall(ContactTurnRigid(contact, pair));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (pair->row_side == CONTACT_ROW_SIDE_FINER && contact->dim > 1)
    for (PetscInt side = 0; side < 2; side++) PetscCall(GetSpacing(contact, pair->surfaces[side], &spacing[side]));
  if (pair->row_side == CONTACT_ROW_SIDE_SECOND || spacing[1] < ALIKE * spacing[0]) ContactTurnPair(pair);
  PetscCall(ContactTurnRigid(contact, pair));
  PetscFunctionReturn(PETSC_SUCCESS);
}
