/* The rule `linear`, for contact nodes without mass. The force of a row goes linearly from that which the last step has ended with to that
   at the end of this one, where a closed row has no gap. Rows are laid as bodies are at the start of the step. */
#include <contact/step/stepimpl.h>
#include <impakt/private/bodyforces.h>

/* Rows that were in contact, or would be at the end as bodies move; others, and those that keep a part of their gap, join when inside. */
static PetscErrorCode Begin(Contact contact, ContactStepper *stepper, const ContactPair *pair)
{
  const PetscReal keeps = ContactStepperKeeps(contact, stepper, (PetscInt)(pair - contact->pairs));

  PetscFunctionBegin;
  for (PetscInt first = pair->begin; first < pair->end; first += pair->components) {
    const PetscReal end     = contact->start.gap[first] + (keeps > 0 ? 0 : contact->step * stepper->rate[first]);
    const PetscBool carried = (PetscBool)(contact->rows.tied[first] || contact->start.active[first]);
    const PetscBool touches = (PetscBool)(carried || (contact->rows.opposite[first] && end <= -contact->options.tolerance));

    for (PetscInt i = first; i < first + pair->components; i++) {
      stepper->touches[i] = touches;
      stepper->joins[i]   = (PetscBool)(touches && !carried);
      stepper->lets[i]    = i == first ? -(1 - keeps) * contact->start.gap[i] : 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Load(Contact contact, ContactStepper *stepper, PetscInt b)
{
  PetscFunctionBegin;
  (void)stepper;
  PetscCall(ContactLoadRows(contact, b, contact->end.force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode More(Contact contact, ContactStepper *stepper, const ContactPair *pair, PetscBool *more)
{
  PetscFunctionBegin;
  for (PetscInt first = pair->begin; first < pair->end; first += pair->components) {
    if (stepper->touches[first] || !contact->rows.opposite[first] || contact->end.gap[first] >= -contact->options.tolerance) continue;
    for (PetscInt i = first; i < first + pair->components; i++) stepper->touches[i] = stepper->joins[i] = PETSC_TRUE;
    *more = PETSC_TRUE;
  }
  if (*more) PetscCall(PetscInfo(contact, "rule linear: rows of %s that end inside their partner join\n", pair->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const ContactRule ContactRuleLinear = {.name = "linear", .begin = Begin, .load = Load, .shape = BODY_FORCE_LINEAR, .more = More};
