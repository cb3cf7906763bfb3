/* Obstacles of a contact problem. */
#include <impakt/private/contactimpl.h>

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
    PetscCall(ObstacleGetName(contact->obstacles[o], &other));
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
  PetscCall(ObstacleGetName(obstacle, &name));
  PetscCall(ContactCheckObstacleName(contact, name));
  PetscCall(PetscRealloc((size_t)(contact->n_obstacles + 1) * sizeof(*contact->obstacles), &contact->obstacles));
  PetscCall(PetscObjectReference((PetscObject)obstacle));
  contact->obstacles[contact->n_obstacles++] = obstacle;
  PetscFunctionReturn(PETSC_SUCCESS);
}
