/* Obstacles of a contact problem. */
#include <contact/parts.h>
#include <impakt/private/mesh.h>
#include <sys/units.h>

/* Pairs find bodies and obstacles by their names */
PetscErrorCode ContactCheckObstacleName(Contact contact, const char name[])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)contact);
  const char *other;
  PetscBool   same;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(PetscStrcmp(name, ((PetscObject)contact->bodies[b])->name, &same));
    PetscCheck(!same, comm, PETSC_ERR_USER_INPUT, "-obstacles: '%s' is the name of a body already", name);
  }
  for (PetscInt o = 0; o < contact->n_obstacles; o++) {
    PetscCall(PetscObjectGetName((PetscObject)contact->obstacles[o], &other));
    PetscCall(PetscStrcmp(name, other, &same));
    PetscCheck(!same, comm, PETSC_ERR_USER_INPUT, "-obstacles: '%s' is the name of an obstacle already", name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactAddObstacle - adds a rigid obstacle that bodies may touch

  Logically Collective

  Input Parameters:
+ contact  - the `Contact`, with its bodies, not yet set up
- obstacle - the `Obstacle`, complete

  Options Database Key:
. -obstacles o,p - names of obstacles, with options of their own

  Level: beginner

  Note:
  A pair of a body and the obstacle makes that body touch it: `ContactAddPair()` with "body:obstacle".

.seealso: `Contact`, `ObstacleCreate()`, `ContactAddPair()`
@*/
PetscErrorCode ContactAddObstacle(Contact contact, Obstacle obstacle)
{
  const char *name;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 2);
  ContactCheckNotSetUp(contact);
  PetscCall(ObstacleSetUp(obstacle));
  PetscCall(PetscObjectGetName((PetscObject)obstacle, &name));
  PetscCall(ContactCheckObstacleName(contact, name));
  PetscCall(PetscRealloc((size_t)(contact->n_obstacles + 1) * sizeof(*contact->obstacles), &contact->obstacles));
  PetscCall(PetscObjectReference((PetscObject)obstacle));
  contact->obstacles[contact->n_obstacles++] = obstacle;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The obstacles, in the order in which they were added, and their number; `obstacles` may be NULL, and belong to the contact */
PetscErrorCode ContactGetObstacles(Contact contact, PetscInt *n, const Obstacle *obstacles[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(n, 2);
  *n = contact->n_obstacles;
  if (obstacles) *obstacles = contact->obstacles;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The options by which a user moves a body at the start; `nodes`, or NULL: of a ball or a rod whose nodes lie outside its radius, that they
   do, of other bodies nothing */
PetscErrorCode ContactDescribeMoves(Contact contact, PetscInt body, char moves[CONTACT_MOVES], char nodes[CONTACT_MOVES])
{
  const char *prefix = ((PetscObject)contact->bodies[body])->prefix, *option, *keeps;

  PetscFunctionBegin;
  PetscCall(MeshGetPlaceOption(prefix, &option, &keeps));
  PetscCall(PetscSNPrintf(moves, CONTACT_MOVES, "-%s%s, -%sinitial_displacement", prefix, option, prefix));
  if (nodes) nodes[0] = 0;
  if (nodes && keeps)
    PetscCall(PetscSNPrintf(nodes, CONTACT_MOVES,
                            "; nodes of '%s' lie outside its radius, for the mesh to have its volume: with -%s%s false they lie at it",
                            ((PetscObject)contact->bodies[body])->name, prefix, keeps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What may be wrong where a body is on the wrong side of an obstacle */
static PetscErrorCode AdviseObstacle(const ContactPair *pair, size_t size, char advice[])
{
  const char  *name;
  ObstacleType type;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetName((PetscObject)pair->obstacle, &name));
  PetscCall(ObstacleGetShape(pair->obstacle, &type, NULL, NULL));
  if (type == OBSTACLE_PLANE)
    PetscCall(PetscSNPrintf(advice, size, "-%s_normal may point the wrong way (it points from what is solid to where bodies are)", name));
  else PetscCall(PetscSNPrintf(advice, size, "what is solid is the inside, so that a body cannot be in '%s'", name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The error of a body that is inside an obstacle at the start */
PetscErrorCode ContactRefuseInside(Contact contact, const ContactPair *pair, PetscReal depth)
{
  char advice[512], moves[CONTACT_MOVES], nodes[CONTACT_MOVES];

  PetscFunctionBegin;
  PetscCall(AdviseObstacle(pair, sizeof(advice), advice));
  PetscCall(ContactDescribeMoves(contact, pair->body[0], moves, nodes));
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
          "-contact_pairs %s: the body is %g%s inside the obstacle at the start; move the body (%s) or the obstacle, or look whether it is "
          "on the wrong side: %s%s",
          pair->name, (double)depth, UnitsOf((PetscObject)contact, UNIT_LENGTH), moves, advice, nodes);
}

/* The error of a surface that looks away from the obstacle it is to touch */
PetscErrorCode ContactRefuseTurned(Contact contact, const ContactPair *pair)
{
  char advice[512];

  PetscFunctionBegin;
  PetscCall(AdviseObstacle(pair, sizeof(advice), advice));
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
          "-contact_pairs %s: no face of the body's surface faces the obstacle; %s", pair->name, advice);
}

PetscErrorCode ContactWarnOfObstacles(Contact contact)
{
  PetscFunctionBegin;
  if (contact->neighbours.come_and_go) PetscFunctionReturn(PETSC_SUCCESS); /* whoever comes near will */
  for (PetscInt o = 0; o < contact->n_obstacles; o++) {
    PetscInt    pairs = 0;
    PetscBool   rows  = PETSC_FALSE;
    const char *name;

    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      if (contact->pairs[p].obstacle != contact->obstacles[o]) continue;
      pairs++;
      if (contact->pairs[p].end > contact->pairs[p].begin) rows = PETSC_TRUE;
    }
    PetscCall(ContactOr(contact, &rows));
    if (rows) continue;
    PetscCall(PetscObjectGetName((PetscObject)contact->obstacles[o], &name));
    PetscCall(PetscFPrintf(
        PetscObjectComm((PetscObject)contact), stderr, "impakt: warning: no body can touch the obstacle '%s': %s\n", name,
        pairs ? "no face of any body faces it; is it, or its normal, where it should be?" : "it is in no pair of -contact_pairs"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
