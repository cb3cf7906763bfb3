/* Which bodies are near each other, and near which obstacles. Of many pairs that the program has chosen those alone have rows whose bodies
   are near: pairs come and go. Boxes about all bodies are sorted along x and compared with those that they overlap there, so that nobody
   looks at all pairs. That is done again when the bodies may have used up the distance up to which pairs were taken, by the way
   that the two fastest of them can make towards each other. */
#include <contact/parts.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodystep.h>
#include <impakt/private/bodymass.h>

/* Boxes that are closer than this, beyond the reach of a controller step, must have rows [edges of the larger contact elements] */
#define NEAR 0.25
/* Pairs are taken whose boxes are closer than this [edges], and dropped where they are farther apart than DROPPED */
#define TAKEN   0.75
#define DROPPED 1.25
/* Why the pairs of a body stay */
#define HELD "has prescribed displacements"

/* What keeps all bodies together from having pairs that come and go, by an option; NULL: nothing */
static const char *FindUnsuited(Contact contact)
{
  if (contact->options.facing) return "sides are faces that see another body: -contact_facing false lets pairs come and go";
  for (ContactLaw law = CONTACT_LAW_TIED; law < CONTACT_LAW_FRICTION; law = (ContactLaw)(law + 1))
    if (ContactAnyPairHas(contact, law)) return "-contact_law ties or bonds them";
  if (contact->options.balance) return "of -contact_balance";
  if (contact->options.rows_second) return "of -contact_rows, which is not first";
  if (contact->options.stabilization != CONTACT_STABILIZATION_NONE) return "of -contact_stabilization";
  if (!contact->ops->reset || (contact->ops->mayreplacerows && !(*contact->ops->mayreplacerows)(contact)))
    return "the contact method cannot begin anew in a run";
  return NULL;
}

/* The same of one body, as this rank knows it: of held displacements those with the nodes do */
static PetscErrorCode FindUnsuitedBody(Body body, const char **why)
{
  const PetscInt *held;
  PetscInt        n;

  PetscFunctionBegin;
  PetscCall(BodyGetHeldDofs(body, &n, &held));
  *why = BodyDoes(body, BodyIsStatic)                  ? "is static"
         : BodyDoes(body, BodyGetMassRedistributeNear) ? "has -mass_redistribute near"
         : n                                           ? HELD
                                                       : NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether pairs may come and go: all bodies must move by their inertia, so that the way that they make in a step is known, with surfaces
   that are the same whoever the partner is, and nothing may be merged, tied or remembered across pairs. Notes what is against it. */
PetscErrorCode ContactSuitsNeighbours(Contact contact, PetscBool *suits)
{
  ContactNeighbours *neighbours = &contact->neighbours;
  const char        *why = FindUnsuited(contact), *of_body = NULL;
  PetscInt           first = contact->n_bodies; /* body that does not suit */

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && !of_body && !why; b++) {
    PetscCall(FindUnsuitedBody(contact->bodies[b], &of_body));
    if (of_body) first = b;
  }
  PetscCall(ContactReduce(contact, 1, MPIU_INT, MPI_MIN, &first));
  *suits = (PetscBool)(!why && first == contact->n_bodies);
  if (why) PetscCall(PetscStrncpy(neighbours->stay, why, sizeof(neighbours->stay)));
  else if (!*suits) {
    PetscCall(FindUnsuitedBody(contact->bodies[first], &of_body));
    PetscCall(PetscSNPrintf(neighbours->stay, sizeof(neighbours->stay), "body '%s' %s", ((PetscObject)contact->bodies[first])->name,
                            of_body ? of_body : HELD));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes a pair whose boxes are near enough, `edge` being that of its larger contact elements [m] */
static PetscErrorCode Consider(Contact contact, PetscInt first, PetscInt second, PetscReal distance, PetscReal near, PetscReal edge,
                               PetscInt *n)
{
  ContactNeighbours *neighbours = &contact->neighbours;
  const PetscInt     number     = ContactNumberPair(contact, first, second);
  PetscInt           place;

  PetscFunctionBegin;
  PetscCall(PetscFindInt(number, neighbours->n_living, neighbours->living, &place));
  if (distance > near + (place < 0 ? TAKEN : DROPPED) * edge) PetscFunctionReturn(PETSC_SUCCESS);
  if (*n == neighbours->room) {
    neighbours->room = 2 * neighbours->room + 16;
    PetscCall(PetscRealloc((size_t)neighbours->room * sizeof(PetscInt), &neighbours->found));
  }
  neighbours->found[(*n)++] = number;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes which pairs have rows from now on, in order */
PetscErrorCode ContactNoteNeighbours(Contact contact, PetscInt n, const PetscInt numbers[])
{
  ContactNeighbours *neighbours = &contact->neighbours;

  PetscFunctionBegin;
  PetscCall(PetscRealloc((size_t)(n + 1) * sizeof(PetscInt), &neighbours->living));
  PetscCall(PetscArraycpy(neighbours->living, numbers, n));
  neighbours->n_living = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindBodies(Contact contact, PetscReal near, PetscInt *n)
{
  ContactNeighbours *neighbours = &contact->neighbours;
  PetscReal          largest    = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    neighbours->lower[b]  = neighbours->boxes[6 * b];
    neighbours->sorted[b] = b;
    largest               = PetscMax(largest, neighbours->edge[b]);
  }
  PetscCall(PetscSortRealWithArrayInt(contact->n_bodies, neighbours->lower, neighbours->sorted));
  for (PetscInt k = 0; k < contact->n_bodies; k++) {
    const PetscInt  a     = neighbours->sorted[k];
    const PetscReal until = -neighbours->boxes[6 * a + 3] + near + DROPPED * largest;

    for (PetscInt l = k + 1; l < contact->n_bodies && neighbours->lower[l] <= until; l++) {
      const PetscInt  b = neighbours->sorted[l], first = neighbours->place[a] < neighbours->place[b] ? a : b, second = a + b - first;
      const PetscReal edge     = PetscMax(neighbours->edge[a], neighbours->edge[b]);
      const PetscReal distance = BoxesDistance(neighbours->boxes + 6 * a, neighbours->boxes + 6 * b);

      PetscCall(Consider(contact, first, second, distance, near, edge, n));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaps of two points differ by their distance at most, so that a box is nearer than its middle by its radius at most */
static PetscErrorCode FindObstacles(Contact contact, PetscReal near, PetscInt *n)
{
  ContactNeighbours *neighbours = &contact->neighbours;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const PetscReal *box = neighbours->boxes + 6 * b;
    PetscReal        centre[3], normal[3], radius = 0;

    for (PetscInt d = 0; d < 3; d++) {
      centre[d] = 0.5 * (box[d] - box[3 + d]);
      radius += PetscSqr(0.5 * (-box[3 + d] - box[d]));
    }
    for (PetscInt o = 0; o < contact->n_obstacles; o++) {
      PetscReal gap;

      PetscCall(ObstacleGetGap(contact->obstacles[o], centre, &gap, normal));
      PetscCall(Consider(contact, b, contact->n_bodies + o, gap - PetscSqrtReal(radius), near, neighbours->edge[b], n));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The numbers of the near pairs, in order, into neighbours->found; `near`: how far apart bodies may be that touch next [m] */
PetscErrorCode ContactFindNeighbours(Contact contact, PetscReal near, PetscInt *n)
{
  ContactNeighbours *neighbours = &contact->neighbours;
  PetscReal          least      = PETSC_MAX_REAL;

  PetscFunctionBegin;
  *n = 0;
  PetscCall(BodyGetAllBoxes(contact->n_bodies, contact->bodies, neighbours->boxes));
  PetscCall(FindBodies(contact, near, n));
  PetscCall(FindObstacles(contact, near, n));
  PetscCall(PetscSortInt(*n, neighbours->found));
  for (PetscInt b = 0; b < contact->n_bodies; b++) least = PetscMin(least, neighbours->edge[b]);
  neighbours->room_left = (TAKEN - NEAR) * least; /* what is taken at least beyond `near`, of all pairs */
  neighbours->near      = near;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for what is kept of each body, once discretizations are known */
PetscErrorCode ContactSetUpNeighbours(Contact contact)
{
  ContactNeighbours *neighbours = &contact->neighbours;
  const PetscInt     n          = contact->n_bodies;

  PetscFunctionBegin;
  PetscCheck(PetscSqr((PetscInt64)(n + contact->n_obstacles)) <= PETSC_INT_MAX, PetscObjectComm((PetscObject)contact), PETSC_ERR_SUP,
             "%" PetscInt_FMT " bodies and obstacles are too many for pairs that come and go; take a PETSc with indices of 64 bits",
             n + contact->n_obstacles);
  neighbours->come_and_go = PETSC_TRUE;
  PetscCall(
      PetscMalloc5(6 * n, &neighbours->boxes, n, &neighbours->edge, n, &neighbours->lower, n, &neighbours->sorted, n, &neighbours->place));
  for (PetscInt b = 0; b < n; b++) PetscCall(BodyExpectRows(contact->bodies[b]));
  PetscCall(ContactSetUpTold(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyNeighbours(Contact contact)
{
  ContactNeighbours *neighbours = &contact->neighbours;

  PetscFunctionBegin;
  PetscCall(PetscFree5(neighbours->boxes, neighbours->edge, neighbours->lower, neighbours->sorted, neighbours->place));
  PetscCall(PetscFree(neighbours->preferences));
  PetscCall(PetscFree(neighbours->found));
  PetscCall(PetscFree(neighbours->living));
  for (PetscInt p = 0; p < neighbours->told.n; p++) PetscCall(PetscFree(neighbours->told.pairs[p].name));
  PetscCall(PetscFree2(neighbours->told.pairs, neighbours->told.gone));
  PetscFunctionReturn(PETSC_SUCCESS);
}
