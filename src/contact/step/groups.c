/* Sets, groups, and which bodies rest. A set are bodies that pairs connect, directly or by others: one rule holds in it. A group are those
   of a set that touch in a step. Groups have nothing to do with each other but share the passes of a step: one that is within the tolerance
   keeps its forces to the last bit, and a body rests, where the forces on its rows are those that it was advanced under. */
#include "stepimpl.h"
#include <impakt/private/bodyforces.h>

/* The rule of each set: contact nodes without mass have no impulse to lose; those with mass would swing if their gap were closed */
PetscErrorCode ContactStepperSetUpRules(Contact contact, ContactStepper *stepper)
{
  PetscInt  *set = stepper->group; /* until the first step */
  PetscBool *impulse, *mass, limited = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(contact->n_bodies, &impulse, contact->n_bodies, &mass));
  ContactFindSets(contact, set);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const PetscInt s = set[b];

    if (!contact->neighbours.come_and_go && !contact->body_rows[b].n_all) continue;
    impulse[s] = (PetscBool)(impulse[s] || ContactNeedsImpulse(contact, b));
    mass[s]    = (PetscBool)(mass[s] || ContactBodyHasMass(contact->bodies[b]));
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) /* rigid bodies among those without inertia */
    if (BodyDoes(contact->bodies[b], BodyIsStatic) && !mass[set[b]]) impulse[set[b]] = PETSC_FALSE;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const char *name = ((PetscObject)contact->bodies[b])->name;

    stepper->rules[b] = stepper->asked ? stepper->asked : impulse[set[b]] ? &ContactRuleImpulse : &ContactRuleLinear;
    if (!contact->neighbours.come_and_go && !contact->body_rows[b].n_all) continue;
    PetscCall(ContactRefuseUnstable(contact,
                                    (PetscBool)(mass[set[b]] && contact->impulses && stepper->rules[b]->shape == BODY_FORCE_LINEAR),
                                    "-contact_rule linear: contact nodes with mass whose gaps are closed at the ends of steps swing and "
                                    "gain energy; choose impulse, or set -<body>_mass_redistribute true"));
    PetscCheck(!BodyDoes(contact->bodies[b], BodyIsStatic) || stepper->rules[b]->shape == BODY_FORCE_LINEAR,
               PetscObjectComm((PetscObject)contact), PETSC_ERR_SUP,
               "-contact_rule impulse is about velocities, and body '%s' is static; set -<body>_mass_redistribute true for the bodies that "
               "it may touch, or give '%s' inertia (-%s_ts_type alpha2)",
               name, name, name);
    if (stepper->rules[b]->takes) contact->energy.takes = stepper->rules[b]->takes;
    else limited = PETSC_TRUE;
  }
  if (!limited) contact->energy.unlimited = "contact gains none by its rule";
  PetscCall(PetscFree2(impulse, mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The group of a touching row, by its place among those of all ranks */
PetscInt ContactStepperGroup(Contact contact, const ContactStepper *stepper, PetscInt place)
{
  return stepper->group[contact->pairs[contact->ranks.row_pair[stepper->rows[place]]].body[0]];
}

/* Which bodies touch by the rows listed. What has been found of groups before is for groups that stay as they are. */
PetscErrorCode ContactStepperFindGroups(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) stepper->group[b] = b;
  for (PetscInt place = 0; place < stepper->problem.n; place++) {
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[stepper->rows[place]]];

    if (!pair->obstacle) ContactJoinGroups(stepper->group, pair->body[0], pair->body[1]);
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    stepper->group[b] = ContactGroupOf(stepper->group, b);
    stepper->done[b]  = PETSC_FALSE;
    stepper->scale[b] = stepper->off[b] = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bodies under the forces contact->end.force, those that do not rest; gaps and slips of all rows */
PetscErrorCode ContactStepperAdvance(Contact contact, ContactStepper *stepper)
{
  int *moves = stepper->moves;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const ContactBodyRows *of = &contact->body_rows[b];

    moves[b] = !stepper->rests[b];
    for (PetscInt k = 0; k < of->n_acting && !moves[b]; k++) {
      const PetscInt i = of->rows[of->acting[k]];

      moves[b] = contact->end.force[i] != stepper->given[i];
    }
  }
  PetscCall(ContactReduce(contact, contact->n_bodies, MPI_INT, MPI_MAX, moves));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    stepper->rests[b] = (PetscBool)!moves[b];
    if (moves[b]) PetscCall((*stepper->rules[b]->load)(contact, stepper, b));
  }
  PetscCall(ContactIntegrateSome(contact, stepper->rests));
  PetscCall(ContactAgree(contact));
  if (stepper->problem.n) contact->counts.sweeps++; /* else nothing touches */
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < contact->rows.n_acting; k++)
    stepper->given[contact->rows.acting[k]] = contact->end.force[contact->rows.acting[k]];
  for (PetscInt b = 0; b < contact->n_bodies; b++) stepper->rests[b] = PETSC_TRUE;
  PetscCall(ContactComputeGaps(contact));
  if (contact->friction.slip) PetscCall(ContactComputeSlips(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
