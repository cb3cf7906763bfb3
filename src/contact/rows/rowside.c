/* Which body of a pair has the contact rows: a row for each of its nodes. Pairs whose second body has them are turned round here, once and
   for all; what users and files see stays in the order in which the user has named the bodies. */
#include <contact/parts.h>

/* Two surfaces are alike if the ratio of the distances between their nodes is above this, so that round-off does not choose the side */
#define ALIKE 0.999

/* The body that has the rows takes displacements, its partner tractions, whatever their order in ContactAddPair(). Names, forces, moments
   and normals of the pair stay in that order.

   The finer surface is the one whose nodes are closer together by more than a thousandth where the two may touch; else the first body has
   the rows. That distance is the mean over those faces of each surface, in the reference positions, that lie within the box around the
   other one; along an axis on which the boxes are apart all do. It is the same on any number of ranks. In one dimension the first body has
   the rows. A pair for which that would bring the bodies into a circle, each waiting for the reaction of the one before, has them on its
   first body too. A pair with an obstacle has its rows on the body. */
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

/* The box about the nodes of a surface on all ranks */
static PetscErrorCode GetBox(Contact contact, Surface surface, PetscReal box[6])
{
  const SurfaceData *data;

  PetscFunctionBegin;
  PetscCall(SurfaceGetData(surface, &data));
  BoxFind(data->n_nodes, data->reference, box);
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, box, 6, MPIU_REAL, MPIU_MIN, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a face reaches into a box; axes that do not count are passed over */
static PetscBool IsWithin(const SurfaceData *data, PetscInt f, const PetscBool counts[3], const PetscReal box[6])
{
  for (PetscInt d = 0; d < 3; d++) {
    PetscReal least = PETSC_MAX_REAL, most = -PETSC_MAX_REAL;

    for (PetscInt k = 0; k < data->face_nodes; k++) {
      const PetscReal x = data->reference[3 * data->faces[data->face_nodes * f + k] + d];

      least = PetscMin(least, x);
      most  = PetscMax(most, x);
    }
    if (counts[d] && (most < box[d] || least > -box[3 + d])) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Mean distance of the nodes of a surface, on the faces that reach into a box [m], zero if none does: the root of the area for each node,
   of which triangles have half as many as quadrilaterals */
static PetscErrorCode GetSpacing(Contact contact, Surface surface, const PetscBool counts[3], const PetscReal box[6], PetscReal *spacing)
{
  const SurfaceData *data;
  PetscReal          sums[2] = {0, 0}; /* area, and nodes on it */

  PetscFunctionBegin;
  PetscCall(SurfaceGetData(surface, &data));
  for (PetscInt f = 0; f < data->n_faces; f++) {
    if (!IsWithin(data, f, counts, box)) continue;
    sums[0] += data->face_areas[f];
    sums[1] += data->face_nodes == 3 ? 0.5 : 1;
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  *spacing = sums[1] > 0 ? sums[0] / sums[1] : 0;
  if (contact->dim == 3) *spacing = PetscSqrtReal(*spacing);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the second surface of a pair is the finer one where the two may touch */
static PetscErrorCode SecondIsFiner(Contact contact, const ContactPair *pair, PetscBool *finer)
{
  const PetscBool everywhere[3] = {PETSC_FALSE, PETSC_FALSE, PETSC_FALSE};
  PetscReal       boxes[2][6], spacing[2];
  PetscBool       counts[3];

  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) PetscCall(GetBox(contact, pair->surfaces[side], boxes[side]));
  for (PetscInt d = 0; d < 3; d++) counts[d] = (PetscBool)(boxes[0][d] <= -boxes[1][3 + d] && boxes[1][d] <= -boxes[0][3 + d]);
  for (PetscInt side = 0; side < 2; side++) PetscCall(GetSpacing(contact, pair->surfaces[side], counts, boxes[1 - side], &spacing[side]));
  for (PetscInt side = 0; side < 2; side++) /* curved surfaces may pass by the place where the boxes meet */
    if (spacing[side] == 0) PetscCall(GetSpacing(contact, pair->surfaces[side], everywhere, boxes[side], &spacing[side]));
  *finer = (PetscBool)(spacing[1] < ALIKE * spacing[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Swap(void *a, void *b, size_t size)
{
  char held[sizeof(void *)];

  memcpy(held, a, size);
  memcpy(a, b, size);
  memcpy(b, held, size);
}

/* Turns a pair round, before it has a transfer */
void ContactTurnPair(ContactPair *pair)
{
  Swap(&pair->body[0], &pair->body[1], sizeof(pair->body[0]));
  Swap((void *)&pair->surface[0], (void *)&pair->surface[1], sizeof(pair->surface[0]));
  Swap((void *)&pair->surfaces[0], (void *)&pair->surfaces[1], sizeof(pair->surfaces[0]));
  Swap(&pair->place[0], &pair->place[1], sizeof(pair->place[0]));
  pair->turned = (PetscBool)!pair->turned;
}

/* Turns a pair round if its second body is to have the rows. Its surfaces must be known. */
PetscErrorCode ContactChooseRowSide(Contact contact, ContactPair *pair)
{
  PetscBool second = PETSC_FALSE;

  PetscFunctionBegin;
  if (!pair->own_side) pair->row_side = contact->options.row_side;
  if (pair->obstacle) {
    PetscCall(ContactTurnRigid(contact, pair));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (pair->row_side == CONTACT_ROW_SIDE_SECOND) second = PETSC_TRUE;
  if (pair->row_side == CONTACT_ROW_SIDE_FINER && contact->dim > 1) PetscCall(SecondIsFiner(contact, pair, &second));
  if (second) ContactTurnPair(pair);
  PetscCall(ContactTurnRigid(contact, pair));
  PetscFunctionReturn(PETSC_SUCCESS);
}
