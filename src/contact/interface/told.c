/* What is told of pairs that come and go. Which of them there are changes from time to time, so that outputs could not name them: they are
   told what each body does to all others together, as a pair BODY:others, and what it does to each obstacle, as a pair BODY:OBSTACLE. */
#include <contact/parts.h>

#define OTHERS "others"

/* The number of a pair with an obstacle among those that are told */
static PetscInt ObstaclePlace(Contact contact, PetscInt body, PetscInt obstacle)
{
  return contact->n_bodies + body * contact->n_obstacles + obstacle;
}

/* Names and bodies of what is told, which are the same for the whole run: what the others do to a body is between that body and itself */
PetscErrorCode ContactSetUpTold(Contact contact)
{
  ContactTold   *told = &contact->neighbours.told;
  const PetscInt n    = contact->n_bodies;

  PetscFunctionBegin;
  told->n = n * (1 + contact->n_obstacles);
  PetscCall(PetscCalloc2(told->n, &told->pairs, told->n, &told->gone));
  for (PetscInt b = 0; b < n; b++) {
    const char *body = ((PetscObject)contact->bodies[b])->name;
    char        name[256];
    PetscBool   same;

    PetscCall(PetscStrcmp(body, OTHERS, &same));
    for (PetscInt o = -1; o < contact->n_obstacles; o++) {
      ContactPair *pair  = &told->pairs[o < 0 ? b : ObstaclePlace(contact, b, o)];
      const char  *other = OTHERS;

      *pair = (ContactPair){.body = {b, b}, .chosen = PETSC_TRUE};
      if (o >= 0) {
        PetscBool taken;

        pair->obstacle = contact->obstacles[o];
        pair->body[1]  = n;
        PetscCall(PetscObjectGetName((PetscObject)contact->obstacles[o], &other));
        PetscCall(PetscStrcmp(other, OTHERS, &taken));
        same = (PetscBool)(same || taken);
      }
      PetscCall(PetscSNPrintf(name, sizeof(name), "%s:%s", body, other));
      PetscCall(PetscStrallocpy(name, &pair->name));
    }
    PetscCheck(!same, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_pairs auto: with so many bodies outputs have what all others do to a body under the name of the pair BODY:%s; "
               "give the body or obstacle '%s' another name",
               OTHERS, OTHERS);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the state of a pair to those that are told of its bodies, or of its body and the obstacle. What has no direction counts with the
   rows' body alone, so that sums are right. */
void ContactTell(Contact contact, const ContactPair *pair, const ContactPairState *state, ContactPairState told[])
{
  if (pair->obstacle)
    ContactAddPairState(&told[ObstaclePlace(contact, pair->body[0], ContactPairPartner(contact, pair) - contact->n_bodies)], 1, state);
  for (PetscInt side = 0; side < 2 && !pair->obstacle; side++) ContactAddPairState(&told[pair->body[side]], side ? -1 : 1, state);
}

/* States of all that is told; collective */
static PetscErrorCode TellStates(Contact contact, ContactPairState states[])
{
  const ContactTold *told = &contact->neighbours.told;

  PetscFunctionBegin;
  PetscCall(ContactComputePairStates(contact, contact->resultants.states));
  PetscCall(PetscArraycpy(states, told->gone, told->n));
  for (PetscInt p = 0; p < told->n; p++) states[p].gap = CONTACT_NO_GAP;
  for (PetscInt p = 0; p < contact->n_pairs; p++) ContactTell(contact, &contact->pairs[p], &contact->resultants.states[p], states);
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

.seealso: `Contact`, `ContactGetNumPairs()`, `ContactStep()`
@*/
PetscErrorCode ContactGetPairStates(Contact contact, ContactPairState states[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  if (contact->n_pairs) PetscAssertPointer(states, 2);
  if (contact->neighbours.come_and_go) PetscCall(TellStates(contact, states));
  else PetscCall(ContactComputePairStates(contact, states));
  PetscFunctionReturn(PETSC_SUCCESS);
}
