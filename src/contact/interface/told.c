/* What is told of pairs that come and go. Which of them there are changes from time to time, so that outputs could not name them: they are
   told what each body does to all others together, as a pair BODY:others, and what it does to each obstacle, as a pair BODY:OBSTACLE. */
#include <contact/parts.h>

#define OTHERS "others"

/* The number of a pair with an obstacle among those that are told */
static PetscInt ObstaclePlace(Contact contact, PetscInt body, PetscInt obstacle)
{
  return contact->n_bodies + body * contact->n_obstacles + obstacle;
}

/* Names of what is told, which are the same for the whole run */
PetscErrorCode ContactSetUpTold(Contact contact)
{
  ContactTold   *told = &contact->neighbours.told;
  const PetscInt n    = contact->n_bodies;

  PetscFunctionBegin;
  told->n = n * (1 + contact->n_obstacles);
  PetscCall(PetscCalloc4(told->n, &told->names, CONTACT_IMPULSES * told->n, &told->gone, CONTACT_IMPULSES * told->n, &told->sums,
                         2 * told->n, &told->gone_friction));
  for (PetscInt b = 0; b < n; b++) {
    const char *body = ((PetscObject)contact->bodies[b])->name;
    char        name[256];
    PetscBool   same;

    PetscCall(PetscStrcmp(body, OTHERS, &same));
    for (PetscInt o = -1; o < contact->n_obstacles; o++) {
      const char *other = OTHERS;

      if (o >= 0) {
        PetscBool taken;

        PetscCall(PetscObjectGetName((PetscObject)contact->obstacles[o], &other));
        PetscCall(PetscStrcmp(other, OTHERS, &taken));
        same = (PetscBool)(same || taken);
      }
      PetscCall(PetscSNPrintf(name, sizeof(name), "%s:%s", body, other));
      PetscCall(PetscStrallocpy(name, &told->names[o < 0 ? b : ObstaclePlace(contact, b, o)]));
    }
    PetscCheck(!same, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_pairs auto: with so many bodies outputs have what all others do to a body under the name of the pair BODY:%s; "
               "give the body or obstacle '%s' another name",
               OTHERS, OTHERS);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyTold(Contact contact)
{
  ContactTold *told = &contact->neighbours.told;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < told->n; p++) PetscCall(PetscFree(told->names[p]));
  PetscCall(PetscFree4(told->names, told->gone, told->sums, told->gone_friction));
  PetscCall(PetscFree(told->states));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The impulses of a pair, as AddState() has them */
static void AddImpulses(PetscReal sums[], PetscInt sign, const PetscReal impulses[])
{
  for (PetscInt k = 0; k < 3; k++) sums[k] += sign * impulses[k];
  if (sign < 0) return;
  sums[6] += impulses[6];
  sums[8] += impulses[8];
}

/* A pair goes: what it has done stays with its bodies. `friction`: what that has taken, and the work of an obstacle, of all ranks [J] */
PetscErrorCode ContactTakeLeave(Contact contact, const ContactPair *pair, const PetscReal impulses[], const PetscReal friction[])
{
  PetscReal     *gone  = contact->neighbours.told.gone;
  const PetscInt place = pair->obstacle ? ObstaclePlace(contact, pair->body[0], ContactPairPartner(contact, pair) - contact->n_bodies)
                                        : pair->body[0];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) contact->neighbours.told.gone_friction[2 * place + k] += friction[k];
  if (pair->obstacle) {
    AddImpulses(gone + CONTACT_IMPULSES * place, 1, impulses);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt side = 0; side < 2; side++) AddImpulses(gone + CONTACT_IMPULSES * pair->body[side], side ? -1 : 1, impulses);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the state of a pair to that of what is told. What has no direction counts with the rows' body alone, so that sums are right. */
static void AddState(ContactPairState *sum, PetscInt sign, const ContactPairState *state)
{
  sum->gap     = PetscMin(sum->gap, state->gap);
  sum->tension = PetscMax(sum->tension, state->tension);
  for (PetscInt d = 0; d < 3; d++) {
    sum->force_vector[d] += sign * state->force_vector[d];
    sum->moment[d] += sign * state->moment[d];
    sum->impulse[d] += sign * state->impulse[d];
  }
  if (sign < 0) return;
  sum->force += state->force;
  sum->active += state->active;
  sum->area += state->area;
  sum->normal_impulse += state->normal_impulse;
  sum->beyond_impulse += state->beyond_impulse;
  sum->sliding += state->sliding;
  sum->friction_loss += state->friction_loss;
  sum->obstacle_work += state->obstacle_work;
}

/* What pairs that have gone have done */
static void BeginState(const PetscReal sums[], const PetscReal friction[], ContactPairState *state)
{
  *state = (ContactPairState){.gap            = CONTACT_NO_GAP,
                              .normal_impulse = sums[6],
                              .beyond_impulse = sums[8],
                              .friction_loss  = friction[0],
                              .obstacle_work  = friction[1]};
  for (PetscInt d = 0; d < 3; d++) state->impulse[d] = sums[d];
}

/* States of all that is told; collective */
static PetscErrorCode TellStates(Contact contact, ContactPairState states[])
{
  ContactTold *told = &contact->neighbours.told;

  PetscFunctionBegin;
  if (told->room < contact->n_pairs) {
    told->room = 2 * contact->n_pairs;
    PetscCall(PetscFree(told->states));
    PetscCall(PetscMalloc1(told->room, &told->states));
  }
  PetscCall(ContactComputePairStates(contact, 0, contact->n_pairs, told->states));
  PetscCall(PetscArraycpy(told->sums, told->gone, CONTACT_IMPULSES * told->n));
  PetscCall(ContactReduce(contact, CONTACT_IMPULSES * told->n, MPIU_REAL, MPIU_SUM, told->sums));
  for (PetscInt p = 0; p < told->n; p++) BeginState(told->sums + CONTACT_IMPULSES * p, told->gone_friction + 2 * p, &states[p]);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (pair->obstacle)
      AddState(&states[ObstaclePlace(contact, pair->body[0], ContactPairPartner(contact, pair) - contact->n_bodies)], 1, &told->states[p]);
    for (PetscInt side = 0; side < 2 && !pair->obstacle; side++) AddState(&states[pair->body[side]], side ? -1 : 1, &told->states[p]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The bodies of what is told, and its obstacle, -1 for none: what the others do to a body is between that body and itself */
void ContactGetTold(Contact contact, PetscInt p, PetscInt *body, PetscInt *obstacle)
{
  *body     = p < contact->n_bodies ? p : (p - contact->n_bodies) / contact->n_obstacles;
  *obstacle = p < contact->n_bodies ? -1 : (p - contact->n_bodies) % contact->n_obstacles;
}

/*@
  ContactGetPairState - forces, gap and active nodes of a pair at the end of the last step

  Collective

  Input Parameters:
+ contact - the `Contact`, set up
- pair    - 0 to the number of pairs - 1

  Output Parameter:
. state - see `ContactPairState`

  Level: intermediate

.seealso: `Contact`, `ContactGetPairStates()`, `ContactStep()`
@*/
PetscErrorCode ContactGetPairState(Contact contact, PetscInt pair, ContactPairState *state)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(state, 3);
  ContactCheckPair(contact, pair);
  if (contact->neighbours.come_and_go) {
    ContactPairState *states;

    PetscCall(PetscMalloc1(contact->neighbours.told.n, &states));
    PetscCall(TellStates(contact, states));
    *state = states[pair];
    PetscCall(PetscFree(states));
  } else PetscCall(ContactComputePairStates(contact, pair, pair + 1, state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetPairStates - forces, gaps and active nodes of all pairs at the end of the last step

  Collective

  Input Parameter:
. contact - the `Contact`, set up

  Output Parameter:
. states - see `ContactPairState`; one for each pair

  Level: intermediate

.seealso: `Contact`, `ContactGetPairState()`, `ContactGetNumPairs()`, `ContactStep()`
@*/
PetscErrorCode ContactGetPairStates(Contact contact, ContactPairState states[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  if (contact->n_pairs) PetscAssertPointer(states, 2);
  if (contact->neighbours.come_and_go) PetscCall(TellStates(contact, states));
  else PetscCall(ContactComputePairStates(contact, 0, contact->n_pairs, states));
  PetscFunctionReturn(PETSC_SUCCESS);
}
