/*
   Rows that are laid where the step ends. A row against a curved obstacle is a plane that touches the obstacle where the node was when the
   row was laid; as the node slides on, the plane leaves the obstacle. So a step whose nodes in contact end off the obstacle is made again,
   with rows laid at the places where they ended, until they end on it.
*/
#include <contact/parts.h>

#define OFF         1e-3 /* planes of nodes in contact end a step at most this far off the obstacle [edges of the smallest face] */
#define TILT        2e-4 /* and tilted by at most this: the ratio of tangential to normal force is wrong by as much [rad] */
#define MOST_PASSES 10   /* each takes the square of what is left, in parts of the radius */
#define LESS        0.5  /* a pass that leaves more than this part of what was too much is the last one */

/* Whether the rows of a pair can be laid where the step ends */
static PetscErrorCode LaysAhead(const ContactPair *pair, PetscBool *ahead)
{
  ObstacleType type;

  PetscFunctionBegin;
  *ahead = PETSC_FALSE;
  if (!pair->obstacle || pair->bonded) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ObstacleGetType(pair->obstacle, &type));
  *ahead = (PetscBool)(type != OBSTACLE_PLANE);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far the planes of nodes of this rank in contact are off the obstacle of a pair where these end the step, and tilted, in parts of what
   is allowed */
static PetscErrorCode MeasureOff(Contact contact, const ContactPair *pair, PetscReal *off)
{
  const SurfaceData *data;
  Vec                u;

  PetscFunctionBegin;
  PetscCall(BodyGetSolution(contact->bodies[pair->body[0]], &u, NULL, NULL));
  PetscCall(SurfaceUpdate(pair->surfaces[0], u));
  PetscCall(SurfaceGetData(pair->surfaces[0], &data));
  for (PetscInt i = pair->begin; i < pair->end; i += pair->components) {
    const PetscInt node = (i - pair->begin) / pair->components;
    PetscReal      distance, normal[3], chord = 0, length = 0;

    if (!contact->end.active[i]) continue;
    PetscCall(ObstacleGetGap(pair->obstacle, data->positions + 3 * node, &distance, normal));
    *off = PetscMax(*off, PetscAbsReal(distance - contact->end.gap[i]) / (OFF * data->sizes[node]));
    for (PetscInt d = 0; d < contact->dim; d++) length += PetscSqr(normal[d]);
    for (PetscInt d = 0; d < contact->dim; d++) chord += PetscSqr(normal[d] / PetscSqrtReal(length) + contact->rows.normal[3 * i + d]);
    *off = PetscMax(*off, PetscSqrtReal(chord) / TILT);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For each pair, how far its planes are off in parts of what is allowed; 0: none of its nodes is in contact */
static PetscErrorCode MeasurePairs(Contact contact, PetscReal off[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscBool ahead;

    off[p] = 0;
    PetscCall(LaysAhead(&contact->pairs[p], &ahead));
    if (ahead) PetscCall(MeasureOff(contact, &contact->pairs[p], &off[p]));
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, off, (PetscMPIInt)contact->n_pairs, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* No rows are laid ahead: at the start of a step */
void ContactForgetAhead(Contact contact)
{
  for (PetscInt p = 0; p < contact->n_pairs; p++) contact->pairs[p].ahead = PETSC_FALSE;
}

/* After an attempt at a step: whether it is to be made again with rows laid where nodes in contact have ended. `pass`: how often that has
   been done; `last`: by how much it was too much then, in parts of what is allowed, becomes that of now. */
PetscErrorCode ContactLayAhead(Contact contact, PetscInt pass, PetscReal *last, PetscBool *again)
{
  PetscBool  any = PETSC_FALSE;
  PetscReal *off = contact->work.off, most = 0;

  PetscFunctionBegin;
  *again = PETSC_FALSE;
  /* what changes the start of the step cannot be made again */
  if (contact->dim == 1 || contact->options.law == CONTACT_LAW_TIED || contact->attempt.moves_start) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs && !any; p++) PetscCall(LaysAhead(&contact->pairs[p], &any));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MeasurePairs(contact, off));
  for (PetscInt p = 0; p < contact->n_pairs; p++) most = PetscMax(most, off[p]);
  *again = (PetscBool)(most > 1 && pass < MOST_PASSES && (!pass || most < LESS * *last));
  *last  = most;
  for (PetscInt p = 0; p < contact->n_pairs && *again; p++) {
    ContactPair *pair = &contact->pairs[p];
    Vec          u, *end = &contact->ends[pair->body[0]];

    if (off[p] > 1) pair->ahead = PETSC_TRUE;
    if (!pair->ahead) continue; /* those that were laid ahead before are so again */
    PetscCall(BodyGetSolution(contact->bodies[pair->body[0]], &u, NULL, NULL));
    if (!*end) PetscCall(VecDuplicate(u, end));
    PetscCall(VecCopy(u, *end));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
