/* Numbers of rows: each rank has one for each row that it owns, and all ranks, which all solve the law, get those of touching rows. */
#include "stepimpl.h"

/* Room for the rows that there are */
PetscErrorCode ContactStepperCreateVecs(Contact contact, ContactStepper *stepper)
{
  const PetscInt n_all = PetscMax(contact->rows.n_all, 1), n = PetscMax(contact->rows.n, 1);

  PetscFunctionBegin;
  stepper->contact           = contact;
  stepper->answer            = BodyApplyCompliance;
  stepper->assembly.n_bodies = contact->n_bodies;
  PetscCall(PetscCalloc1(contact->n_bodies, &stepper->assembly.of_body));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    StepperEntries *entries = &stepper->assembly.of_body[b];
    const PetscInt  room    = contact->body_rows[b].n_all;

    PetscCall(PetscMalloc4(room, &entries->rows, room, &entries->places, room + 1, &entries->begin, 2 * room, &entries->product));
  }
  PetscCall(PetscMalloc1(contact->n_pairs, &stepper->laws));
  PetscCall(PetscCalloc4(n, &stepper->touches, n, &stepper->joined, n, &stepper->joins, n, &stepper->grows));
  PetscCall(PetscCalloc7(n, &stepper->last, n, &stepper->rate, n, &stepper->lets, n, &stepper->none, n, &stepper->mine, n, &stepper->before,
                         n, &stepper->given));
  PetscCall(VecCreateMPI(PetscObjectComm((PetscObject)contact), contact->rows.n, PETSC_DETERMINE, &stepper->x));
  PetscCall(PetscMalloc4(n_all, &stepper->rows, n_all, &stepper->gathered, n_all, &stepper->of_assembled, n_all, &stepper->all));
  PetscCall(PetscMalloc2(3 * n_all, &stepper->told, 2 * n_all, &stepper->ends));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperDestroyVecs(ContactStepper *stepper)
{
  PetscFunctionBegin;
  PetscCall(VecDestroy(&stepper->x));
  PetscCall(PetscFree4(stepper->rows, stepper->gathered, stepper->of_assembled, stepper->all));
  PetscCall(PetscFree2(stepper->told, stepper->ends));
  PetscCall(PetscFree4(stepper->touches, stepper->joined, stepper->joins, stepper->grows));
  PetscCall(PetscFree7(stepper->last, stepper->rate, stepper->lets, stepper->none, stepper->mine, stepper->before, stepper->given));
  PetscCall(PetscFree(stepper->laws));
  PetscCall(LawProblemDestroy(&stepper->problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers of the touching rows of all ranks, from those of this rank's rows */
PetscErrorCode ContactStepperGather(Contact contact, ContactStepper *stepper, const PetscReal mine[], PetscScalar all[])
{
  PetscFunctionBegin;
  PetscCall(ContactGatherRows(contact, MPIU_REAL, mine, stepper->all));
  for (PetscInt k = 0; k < stepper->problem.n; k++) all[k] = stepper->all[stepper->rows[k]];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the touching rows of all ranks, by their numbers, and the nodes that have them */
PetscErrorCode ContactStepperListRows(Contact contact, ContactStepper *stepper)
{
  LawProblem      *problem = &stepper->problem;
  const PetscReal *touches = stepper->all;
  PetscInt         n       = 0;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(stepper->mine, contact->rows.n));
  for (PetscInt k = 0; k < contact->rows.n_acting; k++) {
    const PetscInt i = contact->rows.acting[k];

    stepper->mine[i] = stepper->touches[i] ? 1 + contact->rows.tied[ContactFirstRow(contact, i)] : 0; /* which law it has */
  }
  PetscCall(ContactGatherRows(contact, MPIU_REAL, stepper->mine, stepper->all));
  for (PetscInt i = 0; i < contact->rows.n_all; i++) n += touches[i] != 0;
  PetscCall(LawProblemResize(problem, n));
  n = problem->n_nodes = 0;
  for (PetscInt i = 0; i < contact->rows.n_all; i++) {
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[i]];

    if (touches[i] == 0) continue;
    /* the rows of a node follow each other, and touch all together */
    if (!problem->n_nodes || n - problem->begin[problem->n_nodes - 1] == pair->components ||
        contact->ranks.row_pair[i] != contact->ranks.row_pair[stepper->rows[n - 1]]) {
      problem->law[problem->n_nodes]     = touches[i] > 1 ? stepper->laws[contact->ranks.row_pair[i]] : &RowLawUnilateral;
      problem->begin[problem->n_nodes++] = n;
    }
    stepper->rows[n++] = i;
  }
  problem->begin[problem->n_nodes] = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The touching rows of each body, by their numbers among its rows, and their places in the list of all */
PetscErrorCode ContactStepperListBodyRows(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) stepper->assembly.of_body[b].n = 0;
  for (PetscInt k = 0; k < stepper->problem.n; k++) {
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[stepper->rows[k]]];

    for (PetscInt side = 0; side < ContactPairBodies(pair); side++) {
      const ContactBodyRows *of      = &contact->body_rows[pair->body[side]];
      StepperEntries        *entries = &stepper->assembly.of_body[pair->body[side]];

      PetscCall(PetscFindInt(stepper->rows[k], of->n_all, of->all, &entries->rows[entries->n]));
      entries->places[entries->n++] = k;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
