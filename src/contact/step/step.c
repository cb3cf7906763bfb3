/*
   One controller step of bodies that touch. (1) All bodies are advanced under a guess of the forces of rows; (2) the law of each node's
   rows is solved on what these would read under other forces, y + S dlambda; (3) all are advanced under the solution; (4) what rows read is
   compared with what S told of it. Where they agree the step is made; else S is corrected by the secant, and (2) comes again. (1), (3), (4)
   are one evaluation of the outer SNES, F = lambda - (2)(lambda), and (2) is the SNES of solve/.
*/
#include "stepimpl.h"
#include <contact/laws/friction.h>

static ContactStepper *Stepper(Contact contact)
{
  return (ContactStepper *)contact->data;
}

/* Rates of rows as the step begins */
PetscErrorCode ContactStepperComputeRates(Contact contact, PetscReal rate[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscScalar       *v[2];

    for (PetscInt side = 0; side < 2; side++) PetscCall(TraceGetLevel(contact->traces[pair->body[side]].velocity, 0, &v[side]));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      rate[i] = PetscRealPart(v[1][i - pair->shift[1]] - v[0][i - pair->shift[0]]);
      if (contact->friction.drive) rate[i] += contact->friction.drive[i] / contact->step;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the touching rows of all ranks, by their numbers, and the nodes that have them with their law */
static PetscErrorCode ListRows(Contact contact, ContactStepper *stepper)
{
  LawProblem *problem = &stepper->problem;
  int        *touches = contact->ranks.mine_active, *all = contact->ranks.all_active;
  PetscInt    n = 0, local = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    touches[i] = stepper->touches[i];
    local += stepper->touches[i];
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allgatherv(touches, (PetscMPIInt)contact->rows.n, MPI_INT, all, contact->ranks.counts, contact->ranks.offsets, MPI_INT,
                                PetscObjectComm((PetscObject)contact)));
  else all = touches;
  for (PetscInt i = 0; i < contact->rows.n_all; i++) n += all[i];
  PetscCall(LawProblemResize(problem, n));
  if (n > stepper->room) {
    PetscCall(PetscFree5(stepper->rows, stepper->of_body, stepper->places, stepper->gathered, stepper->of_assembled));
    PetscCall(PetscFree(stepper->told));
    stepper->room = PetscMax(n, 2 * stepper->room);
    PetscCall(PetscMalloc5(stepper->room, &stepper->rows, stepper->room, &stepper->of_body, stepper->room, &stepper->places,
                           3 * stepper->room, &stepper->gathered, stepper->room, &stepper->of_assembled));
    PetscCall(PetscMalloc1(2 * stepper->room, &stepper->told));
    stepper->assembled = -1;
  }
  stepper->n_local = local;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  n = problem->n_nodes = 0;
  for (PetscInt i = 0; i < contact->rows.n_all; i++) {
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[i]];

    if (!all[i]) continue;
    /* the rows of a node follow each other, and touch all together */
    if (!problem->n_nodes || n - problem->begin[problem->n_nodes - 1] == pair->components ||
        contact->ranks.row_pair[i] != contact->ranks.row_pair[stepper->rows[n - 1]])
      problem->begin[problem->n_nodes++] = n;
    stepper->rows[n++] = i;
  }
  problem->begin[problem->n_nodes] = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bounds that the law of friction has for touching nodes, on all ranks */
static PetscErrorCode GetLimits(Contact contact, ContactStepper *stepper)
{
  LawProblem      *problem = &stepper->problem;
  const PetscReal *fields[2];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(problem->limit, 2 * problem->n_nodes));
  if (contact->options.law != CONTACT_LAW_FRICTION) PetscFunctionReturn(PETSC_SUCCESS);
  fields[0] = stepper->mine;
  fields[1] = stepper->before;
  PetscCall(PetscArrayzero(stepper->mine, contact->rows.n));
  PetscCall(PetscArrayzero(stepper->before, contact->rows.n));
  for (PetscInt i = 0; i < contact->rows.n; i += contact->dim)
    (*contact->friction.law.getlimit)(contact, contact->friction.law.data, i, contact->friction.speed[i], &stepper->mine[i],
                                      &stepper->before[i]);
  PetscCall(ContactStepperGather(contact, stepper, 2, fields, stepper->gathered));
  for (PetscInt node = 0; node < problem->n_nodes; node++)
    for (PetscInt k = 0; k < 2; k++) problem->limit[2 * node + k] = PetscRealPart(stepper->gathered[k * problem->n + problem->begin[node]]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether rows touch that were left out, by the rules of their pairs */
static PetscErrorCode FindMore(Contact contact, ContactStepper *stepper, PetscBool *more)
{
  PetscBool mine = PETSC_FALSE;
  int       any;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactRule *rule = ContactStepperRule(stepper, &contact->pairs[p]);

    if (rule->more) PetscCall((*rule->more)(contact, stepper, &contact->pairs[p], &mine));
  }
  any = mine;
  PetscCall(ContactOr(contact, &any));
  *more = (PetscBool)(any > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* States of rows at the end of the step, and what contact has taken */
static PetscErrorCode EndStep(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  stepper->step_loss = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const ContactRule *rule = ContactStepperRule(stepper, pair);

    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscInt first = i - (i - pair->begin) % pair->components;

      contact->end.active[i] = (PetscBool)(contact->rows.tied[first] || contact->end.force[first] > 0);
    }
    if (rule->end) PetscCall((*rule->end)(contact, stepper, pair));
  }
  if (!contact->energy.takes) PetscFunctionReturn(PETSC_SUCCESS);
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &stepper->step_loss, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  /* nobody else sums up what friction takes where the energy is not limited */
  PetscCall(ContactComputeFrictionLoss(contact, contact->start.force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One controller step of all bodies */
PetscErrorCode ContactStepperStep(Contact contact)
{
  ContactStepper *stepper = Stepper(contact);
  PetscBool       more    = PETSC_TRUE;

  PetscFunctionBegin;
  stepper->passes = 0;
  PetscCall(PetscArraycpy(stepper->last, contact->start.force, contact->rows.n));
  PetscCall(PetscArrayzero(stepper->rests, contact->n_bodies));
  PetscCall(ContactStepperComputeRates(contact, stepper->rate));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    PetscCall((*ContactStepperRule(stepper, &contact->pairs[p])->begin)(contact, stepper, &contact->pairs[p]));
  PetscCall(ContactSetConditions(contact, CONDITIONS_FORCES));
  while (more) {
    PetscCall(ListRows(contact, stepper));
    if (stepper->problem.n) {
      PetscCall(GetLimits(contact, stepper));
      PetscCall(ContactStepperAssemble(contact, stepper));
      PetscCall(ContactStepperIterate(contact, stepper));
    } else PetscCall(ContactStepperAdvance(contact, stepper));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(FindMore(contact, stepper, &more));
  }
  PetscCall(EndStep(contact, stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}
