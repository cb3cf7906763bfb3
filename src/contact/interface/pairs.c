/* Contact pairs: from their names to surfaces of bodies; all bodies with each other. */
#include <contact/parts.h>
#include <sys/names.h>
#include <impakt/private/bodystep.h>

/* Up to so many pairs of bodies that the program has chosen all of them are there all the time */
#define MANY_PAIRS 100

/* Finds body and surface of one side of a pair by its name. The second side may be an obstacle: its body is one past the last. */
static PetscErrorCode ParseSide(Contact contact, const char pair[], const char side[], PetscInt *body, char **surface, Obstacle *obstacle)
{
  char     *dot;
  char      name[256], known[1024] = "";
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(name, side, sizeof(name)));
  PetscCall(PetscStrchr(name, '.', &dot));
  *surface = NULL;
  if (dot) {
    *dot = 0;
    PetscCall(PetscStrallocpy(dot + 1, surface));
  }
  *body = -1;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(PetscStrcmp(((PetscObject)contact->bodies[b])->name, name, &same));
    if (same) *body = b;
    PetscCall(NamesAppend(known, sizeof(known), ", ", ((PetscObject)contact->bodies[b])->name));
  }
  if (contact->n_obstacles) PetscCall(NamesAppend(known, sizeof(known), "", "; -obstacles has"));
  for (PetscInt o = 0; o < contact->n_obstacles; o++) {
    const char *other;

    PetscCall(PetscObjectGetName((PetscObject)contact->obstacles[o], &other));
    PetscCall(NamesAppend(known, sizeof(known), o ? ", " : " ", other));
    PetscCall(PetscStrcmp(other, name, &same));
    if (!same || !obstacle || dot || *body >= 0) continue;
    *body     = contact->n_bodies;
    *obstacle = contact->obstacles[o];
  }
  PetscCheck(*body >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: there is no body '%s'; -bodies has %s%s", pair, name, known,
             contact->n_obstacles ? " (obstacles stand second, without a surface)" : "");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AppendPair(Contact contact, const char name[], ContactPair **pair)
{
  PetscFunctionBegin;
  PetscCall(PetscRealloc((size_t)(contact->n_pairs + 1) * sizeof(ContactPair), &contact->pairs));
  *pair = &contact->pairs[contact->n_pairs++];
  PetscCall(PetscMemzero(*pair, sizeof(**pair)));
  PetscCall(PetscStrallocpy(name, &(*pair)->name));
  (*pair)->law   = contact->options.law;
  (*pair)->named = contact->options.named;
  for (PetscInt k = 0; k < CONTACT_LAW_PARAMETERS; k++) (*pair)->parameters[k] = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns a pair that is given with a tilde, whose sides are the user's, to have the side first that is better */
static PetscErrorCode OrderSides(Contact contact, ContactPair *pair, const char left[], const char right[])
{
  const ContactPreference *preferences;
  const PetscInt           body[2]    = {pair->body[0], pair->body[1]};
  char *const              surface[2] = {pair->surface[0], pair->surface[1]};
  PetscBool                turn       = PETSC_FALSE;
  char                     ordered[512];

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetUpDiscretization(contact->bodies[b]));
  PetscCall(ContactGetPreferences(contact, &preferences));
  pair->why = "obstacle second";
  if (!pair->obstacle) turn = ContactChooseSides(&preferences[body[0]], &preferences[body[1]], &pair->why);
  for (PetscInt side = 0; side < 2; side++) {
    pair->body[side]    = body[turn ? 1 - side : side];
    pair->surface[side] = surface[turn ? 1 - side : side];
  }
  PetscCall(PetscSNPrintf(ordered, sizeof(ordered), "%s:%s", turn ? right : left, turn ? left : right));
  PetscCall(PetscFree(pair->name));
  PetscCall(PetscStrallocpy(ordered, &pair->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactAddPair - adds a pair of bodies that may touch

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, with its bodies
- pair    - names of two bodies, Dirichlet side first, `left:right`; or of their surfaces, `left.top:right.bottom`, which may be two of one
            body, `clip.upper:clip.lower`; or of a body and an obstacle that has been added, `ball:floor`; with a tilde, `left~right`, in
the order that is better

  Options Database Key:
. -contact_pairs a:b,b~c - pairs

  Level: beginner

  Note:
  With a tilde for the colon the first side is the implicit body; of explicit bodies the one that makes fewer substeps, as far as the
controller step is known; then the one with the finer mesh; then the one that is named first. The pair has the name in this order, and
`ContactView()` says why. All bodies must have their meshes.

.seealso: `Contact`, `ContactSetBodies()`, `ContactAddObstacle()`, `SurfaceCreate()`
@*/
PetscErrorCode ContactAddPair(Contact contact, const char pair[])
{
  ContactPair *p;
  char         text[512], *between;
  PetscBool    tilde;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(pair, 2);
  ContactCheckNotSetUp(contact);
  PetscCall(PetscStrncpy(text, pair, sizeof(text)));
  PetscCall(PetscStrchr(text, ':', &between));
  tilde = (PetscBool)!between;
  if (tilde) PetscCall(PetscStrchr(text, '~', &between));
  PetscCheck(between, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: a pair is two bodies with a colon between them, Dirichlet side first, as in left:right, or with a tilde, "
             "which leaves the "
             "order to the program",
             pair);
  *between = 0;
  PetscCall(AppendPair(contact, pair, &p));
  PetscCall(ParseSide(contact, pair, text, &p->body[0], &p->surface[0], NULL));
  PetscCall(ParseSide(contact, pair, between + 1, &p->body[1], &p->surface[1], &p->obstacle));
  PetscCheck(p->body[0] != p->body[1] || (p->surface[0] && p->surface[1]), PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: name the two surfaces by which the body touches itself, as in clip.upper:clip.lower", pair);
  if (tilde) PetscCall(OrderSides(contact, p, text, between + 1));
  for (PetscInt other = 0; other < contact->n_pairs - 1; other++) {
    PetscBool same;

    PetscCall(PetscStrcmp(p->name, contact->pairs[other].name, &same));
    PetscCheck(!same, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_pairs: pair %s is given twice", p->name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyPair(ContactPair *pair)
{
  PetscFunctionBegin;
  PetscCall(TransferDestroy(&pair->transfer));
  for (PetscInt side = 0; side < 2; side++) {
    PetscCall(SurfaceDestroy(&pair->surfaces[side]));
    PetscCall(PetscFree(pair->surface[side]));
  }
  PetscCall(PetscFree(pair->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyPairs(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(ContactDestroyPair(&contact->pairs[p]));
  for (PetscInt s = 0; s < contact->n_surfaces; s++) PetscCall(SurfaceDestroy(&contact->surfaces[s].surface));
  PetscCall(PetscFree(contact->surfaces));
  for (PetscInt o = 0; o < contact->n_obstacles; o++) PetscCall(ObstacleDestroy(&contact->obstacles[o]));
  PetscCall(PetscFree(contact->obstacles));
  PetscCall(PetscFree(contact->pairs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a pair of whole bodies that the user has not named; `second`: a body, or the number of bodies and that of an obstacle; `why`: the
   first one takes displacements */
static PetscErrorCode AppendChosen(Contact contact, PetscInt first, PetscInt second, const char why[], ContactPair **pair)
{
  const PetscInt o    = second - contact->n_bodies;
  const char    *name = NULL;
  char           names[256];

  PetscFunctionBegin;
  if (o >= 0) PetscCall(PetscObjectGetName((PetscObject)contact->obstacles[o], &name));
  else name = ((PetscObject)contact->bodies[second])->name;
  PetscCall(PetscSNPrintf(names, sizeof(names), "%s:%s", ((PetscObject)contact->bodies[first])->name, name));
  PetscCall(AppendPair(contact, names, pair));
  (*pair)->body[0]  = first;
  (*pair)->body[1]  = PetscMin(second, contact->n_bodies);
  (*pair)->obstacle = o >= 0 ? contact->obstacles[o] : NULL;
  (*pair)->chosen   = PETSC_TRUE;
  (*pair)->why      = why;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far the middle of a body in one dimension is from that of another, with a sign, or from an obstacle [m] */
static PetscErrorCode GetDistance(Contact contact, PetscInt body, PetscInt other, Obstacle obstacle, PetscReal *distance)
{
  PetscReal middle[2][3] = {{0}}, normal[3];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < (obstacle ? 1 : 2); k++) {
    PetscReal lower[3], upper[3];
    DM        dm;

    PetscCall(BodyGetDM(contact->bodies[k ? other : body], &dm));
    PetscCall(DMGetBoundingBox(dm, lower, upper));
    middle[k][0] = 0.5 * (lower[0] + upper[0]);
  }
  *distance = middle[0][0] - middle[1][0];
  if (obstacle) PetscCall(ObstacleGetGap(obstacle, middle[0], distance, normal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether another body keeps body `a` from ever touching body `b`, or an obstacle: in one dimension a body that lies between them does */
static PetscErrorCode IsHidden(Contact contact, PetscInt a, PetscInt b, Obstacle obstacle, PetscBool *hidden)
{
  PetscReal distance, between;

  PetscFunctionBegin;
  *hidden = PETSC_FALSE;
  if (contact->dim > 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GetDistance(contact, a, b, obstacle, &distance));
  for (PetscInt c = 0; c < contact->n_bodies; c++) {
    if (c == a || c == b) continue;
    PetscCall(GetDistance(contact, c, b, obstacle, &between));
    if (between * distance > 0 && PetscAbsReal(between) < PetscAbsReal(distance)) *hidden = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest dimension of all bodies. Set-up refuses bodies of another one. */
PetscErrorCode ContactFindDimension(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt dim;

    PetscCall(BodyGetDimension(contact->bodies[b], &dim));
    contact->dim = PetscMax(contact->dim, dim);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All bodies with each other and with all obstacles. If these are many it is left to the set-up whether they come and go. */
PetscErrorCode ContactAddAllPairs(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetUpDiscretization(contact->bodies[b]));
  PetscCall(ContactFindDimension(contact));
  contact->neighbours.all = (PetscBool)(!contact->n_pairs && contact->dim > 1 &&
                                        contact->n_bodies * (contact->n_bodies - 1) / 2 > MANY_PAIRS);
  if (!contact->neighbours.all) PetscCall(ContactAddEachPair(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the program is to choose all pairs, and there are many: those that are near, if pairs can come and go, or all */
PetscErrorCode ContactChooseAllPairs(Contact contact)
{
  const ContactPreference *preferences;
  PetscBool                suits;

  PetscFunctionBegin;
  if (!contact->neighbours.all) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactSuitsNeighbours(contact, &suits));
  if (!suits || contact->n_pairs) {
    PetscCall(ContactAddEachPair(contact));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  contact->neighbours.all = PETSC_FALSE;
  PetscCall(ContactGetPreferences(contact, &preferences));
  PetscCall(ContactSetUpNeighbours(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a pair that is near. The first body comes before the second in the order of the bodies. */
PetscErrorCode ContactAppendNeighbours(Contact contact, PetscInt number, ContactPair **pair)
{
  const PetscInt           first = number / ContactNumberPair(contact, 1, 0), second = number % ContactNumberPair(contact, 1, 0);
  const ContactPreference *preferences = contact->neighbours.preferences;
  const char              *why         = NULL;

  PetscFunctionBegin;
  if (second < contact->n_bodies) (void)ContactChooseSides(&preferences[first], &preferences[second], &why);
  PetscCall(AppendChosen(contact, first, second, why, pair));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All bodies with each other and with all obstacles, for the whole run */
PetscErrorCode ContactAddEachPair(Contact contact)
{
  const ContactPreference *preferences;
  ContactPair             *pair;
  PetscBool                hidden;

  PetscFunctionBegin;
  contact->neighbours.all = PETSC_FALSE;
  PetscCall(ContactGetPreferences(contact, &preferences));
  for (PetscInt a = 0; a < contact->n_bodies; a++)
    for (PetscInt b = a + 1; b < contact->n_bodies; b++) {
      const char     *why;
      const PetscBool turn = ContactChooseSides(&preferences[a], &preferences[b], &why);

      PetscCall(IsHidden(contact, a, b, NULL, &hidden));
      if (!hidden) PetscCall(AppendChosen(contact, turn ? b : a, turn ? a : b, why, &pair));
    }
  for (PetscInt a = 0; a < contact->n_bodies; a++)
    for (PetscInt o = 0; o < contact->n_obstacles; o++) {
      PetscCall(IsHidden(contact, a, -1, contact->obstacles[o], &hidden));
      if (!hidden) PetscCall(AppendChosen(contact, a, contact->n_bodies + o, NULL, &pair));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}
