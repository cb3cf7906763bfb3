/* The forces with which the first pass of a step begins: of rows that touch those at the end of the last step. Under a force that is
   constant in the step, the first step in contact is a blow, which tells nothing of the steps after it: then none. Forces along
   normals alone go on by as much as in the last step, where a body of the pair has no inertia or both solve for their steps by Newton's
   method: a pass less. Linear bodies need two whatever the guess. Under forces that go on a massless layer of an explicit body that
   yields may flow away. Of forces across normals, which may balance in many ways, those of the last step stay.

   Another guess is another body of this function: the law of rows is solved whatever it is, and passes tell how good it was
   (-contact_monitor). It takes what the step begins with, contact->start, and writes contact->end. */
#include "stepimpl.h"

/* Whether forces along the normals of a pair go on as in the last step */
static PetscBool GoesOn(Contact contact, const ContactPair *pair)
{
  PetscBool newton = PETSC_TRUE;

  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    const Body body = contact->bodies[pair->body[side]];

    newton = (PetscBool)(newton && !BodyDoes(body, BodyIsLinear) && !BodyDoes(body, BodyIsExplicit));
  }
  return (PetscBool)(pair->components == 1 && (pair->rests || newton));
}

PetscErrorCode ContactStepperGuess(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair     = &contact->pairs[p];
    const PetscBool    constant = (PetscBool)(ContactStepperRule(stepper, pair)->shape == BODY_FORCE_CONSTANT);
    const PetscBool    goes_on  = GoesOn(contact, pair);

    for (PetscInt k = pair->acts_begin; k < pair->acts_end; k++) {
      const PetscInt  i     = contact->rows.acting[k];
      const PetscBool known = (PetscBool)(stepper->touches[i] && !stepper->joins[i] && !(constant && stepper->joined[i]));

      contact->end.force[i] = known ? contact->start.force[i] + (goes_on ? stepper->grows[i] : 0) : 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
