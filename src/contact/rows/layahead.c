/* Rows that are laid where the step ends. A row is a plane that touches the partner where the node was; as the node slides on, it leaves a
   curved partner. So a step whose nodes in contact end off the partner is made again, with rows laid at the places where the nodes ended,
   until they end on it. This holds for curved obstacles, and between bodies without inertia that have large displacements. */
#include <contact/parts.h>

#define OFF         1e-3 /* planes of nodes in contact end a step at most this far off the partner [edges of the smallest face] */
#define TILT        2e-4 /* and tilted by at most this: the ratio of tangential to normal force is wrong by as much [rad] */
#define MOST_PASSES 10   /* each takes the square of what is left, in parts of the radius */
#define LESS        0.5  /* a pass that leaves more than this part of what was too much is the last one */

/* Whether the rows of a pair can be laid where the step ends. Linear bodies keep rows, and areas of pressure, of their undeformed state. */
static PetscErrorCode LaysAhead(Contact contact, const ContactPair *pair, PetscBool *ahead)
{
  ObstacleType type;

  PetscFunctionBegin;
  *ahead = PETSC_FALSE;
  if (pair->bonded || contact->ahead[pair->body[0]] != 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt side = 0; side < 2 && !pair->obstacle && !*ahead; side++) {
    const Body body = contact->bodies[pair->body[side]];

    if (!BodyDoes(body, BodyIsLinear) && !BodyDoes(body, BodyIsRigid)) *ahead = ContactPairStartsAnew(contact, pair);
  }
  if (!pair->obstacle) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ObstacleGetShape(pair->obstacle, &type, NULL, NULL));
  *ahead = (PetscBool)(type != OBSTACLE_PLANE);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far the planes of this rank's nodes in contact are off a pair's partner at the step's end, and tilted, in parts of what is allowed */
static PetscErrorCode MeasureOff(Contact contact, const ContactPair *pair, PetscReal *off)
{
  PetscReal   *drift = contact->work.drift, *turn = contact->work.tilts;
  TransferRows rows;
  Vec          u[2] = {NULL, NULL};

  PetscFunctionBegin;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++)
    PetscCall(BodyGetSolution(contact->bodies[pair->body[side]], &u[side], NULL, NULL));
  PetscCall(TransferGetDrift(pair->transfer, u[0], u[1], drift, turn));
  PetscCall(TransferGetRows(pair->transfer, &rows));
  for (PetscInt node = 0; node < rows.n; node++)
    if (contact->end.active[pair->begin + node * pair->components])
      *off = PetscMax(*off, PetscMax(PetscAbsReal(drift[node]) / (OFF * rows.size[node]), turn[node] / TILT));
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
  PetscReal *off = contact->work.off, most = 0;
  PetscBool  any = PETSC_FALSE;

  PetscFunctionBegin;
  *again = PETSC_FALSE;
  /* what changes the start of the step cannot be made again */
  if (contact->dim == 1 || ContactAllPairsTie(contact) || contact->attempt.moves_start) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscBool ahead;

    off[p] = 0;
    PetscCall(LaysAhead(contact, &contact->pairs[p], &ahead));
    if (ahead) PetscCall(MeasureOff(contact, &contact->pairs[p], &off[p]));
    any = (PetscBool)(any || ahead);
  }
  if (any) PetscCall(ContactReduce(contact, contact->n_pairs, MPIU_REAL, MPIU_MAX, off));
  for (PetscInt p = 0; p < contact->n_pairs; p++) most = PetscMax(most, off[p]);
  *again = (PetscBool)(most > 1 && pass < MOST_PASSES && (!pass || most < LESS * *last));
  *last  = most;
  for (PetscInt p = 0; p < contact->n_pairs && *again; p++) {
    ContactPair *pair = &contact->pairs[p];

    if (off[p] > 1) pair->ahead = PETSC_TRUE;
    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2) && pair->ahead; side++) { /* those that were laid ahead before are so again */
      Vec u, *end = &contact->ends[pair->body[side]];

      PetscCall(BodyGetSolution(contact->bodies[pair->body[side]], &u, NULL, NULL));
      if (!*end) PetscCall(VecDuplicate(u, end));
      PetscCall(VecCopy(u, *end));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
