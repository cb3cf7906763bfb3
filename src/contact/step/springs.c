/* Springs and dampers between both sides of each row: the penalty method, and the augmented Lagrangian. For the law of rows they are one
   more body between the surfaces, which is soft: a row with a force has

     g_1 - theta g_0 + (lambda - m) / K = 0,   K = (tau + c / dt) A,   theta = (c / dt) / (tau + c / dt)

   with the gaps g_0, g_1 at the ends of the step, the area A of its node, a spring tau, a damper c, or both. So S has 1/K on its diagonal
   beside the blocks of bodies, and rows read (lambda - m) / K more. m is zero along a normal; across it is the force with which the step
   begins: friction goes on from where the spring is, and its slip is that of the spring's foot (Wriggers 2006, section 5.2).

   The augmented Lagrangian (Uzawa's iteration) has the forces of the last solution of the law as m, until springs give by no more than a
   tolerance. Each such round makes what they give smaller by 1 / (1 + K W), with the compliance W of the bodies, and has springs ten times
   as stiff as the last, so that few rounds are enough where W is small for some mode of the rows, or the springs are soft. */
#include "stepimpl.h"

#define STIFFER 10 /* springs in the next round */

/* Stiffness of dampers over a step, on a unit of area [N/m^3] */
static PetscReal OfDampers(Contact contact, const ContactStepper *stepper)
{
  return contact->options.constraint == CONTACT_CONSTRAINT_GAP ? 0 : stepper->penalty.damping / contact->step;
}

/* ContactStepperKeeps - theta of a pair: part of the first gap that a closed row keeps. Without springs and dampers 1 (gap rates), or 0. */
PetscReal ContactStepperKeeps(Contact contact, const ContactStepper *stepper, PetscInt p)
{
  const PetscReal damper = OfDampers(contact, stepper);

  if (!stepper->penalty.any) return contact->options.constraint == CONTACT_CONSTRAINT_GAP_RATE ? 1 : 0;
  return damper / (stepper->springs.stiffness[p] + damper);
}

/* ContactStepperGetSpring - the stiffnesses of spring and damper of a row of this rank [N/m], [N s/m] */
void ContactStepperGetSpring(Contact contact, const ContactStepper *stepper, PetscInt i, PetscReal *spring, PetscReal *damper)
{
  const PetscInt  p    = contact->rows.pair[i];
  const PetscReal area = contact->dim == 1 ? 1 : contact->rows.area[i] * contact->resultants.cross_section[p];

  *spring = area * stepper->springs.stiffness[p];
  *damper = area * OfDampers(contact, stepper) * contact->step;
}

/* 1/K of a row of this rank [m/N] */
static PetscReal Softness(Contact contact, const ContactStepper *stepper, PetscInt i)
{
  PetscReal spring, damper;

  ContactStepperGetSpring(contact, stepper, i, &spring, &damper);
  return spring + damper > 0 ? 1 / (spring + damper / contact->step) : 0;
}

/* Energy of the spring of a row [J]. One across a normal has no gap: its force counts; a gap below 0 is how far it is stretched. */
static PetscReal StoredEnergy(Contact contact, PetscInt i, PetscReal gap)
{
  PetscReal spring, damper;

  ContactStepperGetSpring(contact, Stepper(contact), i, &spring, &damper);
  if (gap < 0 || (contact->rows.tied[i] && !ContactRowRubs(contact, i))) return 0.5 * spring * PetscSqr(gap);
  return ContactRowRubs(contact, i) && spring > 0 ? 0.5 * PetscSqr(contact->end.force[i]) / spring : 0;
}

PetscErrorCode ContactStepperSetUpSprings(Contact contact, ContactStepper *stepper)
{
  StepperSprings *springs = &stepper->springs;
  const PetscInt  n       = contact->rows.n_all;

  PetscFunctionBegin;
  if (!stepper->penalty.any) PetscFunctionReturn(PETSC_SUCCESS);
  stepper->problem.regular = PETSC_TRUE;
  if (!stepper->penalty.rounds) contact->ops->stored = StoredEnergy;
  PetscCall(PetscCalloc3(contact->n_pairs, &springs->stiffness, n, &springs->softness, n, &springs->multiplier));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings softness and m of the touching rows to all ranks, as a step begins */
PetscErrorCode ContactStepperListSprings(Contact contact, ContactStepper *stepper)
{
  StepperSprings *springs = &stepper->springs;

  PetscFunctionBegin;
  springs->rounds = 0;
  springs->give   = 0;
  if (stepper->penalty.rounds) stepper->assembled = -1; /* the last step has left it with stiffer ones */
  for (PetscInt k = 0; k < 2 && stepper->penalty.any; k++) {
    for (PetscInt j = 0; j < contact->rows.n_acting; j++) {
      const PetscInt  i       = contact->rows.acting[j];
      const PetscBool goes_on = (PetscBool)(stepper->penalty.rounds || ContactRowRubs(contact, i));

      stepper->mine[i] = !k ? Softness(contact, stepper, i) : goes_on ? stepper->last[i] : 0;
    }
    PetscCall(ContactStepperGather(contact, stepper, stepper->mine, k ? springs->multiplier : springs->softness));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds 1/K to the diagonal of S, or of a matrix near it */
PetscErrorCode ContactStepperAddSprings(const ContactStepper *stepper, Mat S)
{
  PetscFunctionBegin;
  if (!stepper->penalty.any) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < stepper->problem.n; i++) PetscCall(MatSetValue(S, i, i, stepper->springs.softness[i], ADD_VALUES));
  PetscCall(MatAssemblyBegin(S, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(S, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After a pass: rows read what their springs give under its forces */
void ContactStepperReadSprings(ContactStepper *stepper)
{
  const StepperSprings *springs = &stepper->springs;

  for (PetscInt i = 0; i < stepper->problem.n && stepper->penalty.any; i++)
    stepper->problem.read[i] += springs->softness[i] * (stepper->problem.base[i] - springs->multiplier[i]);
}

/* After the law has been solved: whether it is to be solved again, with the forces found as m */
PetscErrorCode ContactStepperImproveSprings(ContactStepper *stepper, PetscBool *again)
{
  LawProblem     *problem = &stepper->problem;
  StepperSprings *springs = &stepper->springs;

  PetscFunctionBegin;
  *again        = PETSC_FALSE;
  springs->give = 0;
  if (!stepper->penalty.rounds || !problem->solved) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < problem->n; i++)
    springs->give = PetscMax(springs->give, PetscAbsScalar(springs->softness[i] * (problem->force[i] - springs->multiplier[i])));
  if (springs->give <= stepper->penalty.tolerance || springs->rounds >= stepper->penalty.rounds - 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < problem->n; i++) {
    problem->read[i] -= springs->softness[i] * (problem->base[i] - springs->multiplier[i]);
    springs->multiplier[i] = problem->force[i];
    springs->softness[i] /= STIFFER;
  }
  ContactStepperReadSprings(stepper);
  stepper->assembled = -1;
  springs->rounds++;
  *again = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the end of a step: the slips of the feet of springs, and what springs store */
PetscErrorCode ContactStepperEndSprings(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  if (!stepper->penalty.any) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < contact->rows.n_acting && !stepper->penalty.rounds; k++) {
    const PetscInt i = contact->rows.acting[k];

    if (ContactRowRubs(contact, i)) contact->friction.slip[i] += Softness(contact, stepper, i) * (contact->end.force[i] - stepper->last[i]);
  }
  PetscCall(ContactSumStored(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
