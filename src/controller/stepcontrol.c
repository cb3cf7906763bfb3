/* Controller steps that cannot be made as they are: a step that does not converge, that inverts an element, or in which contact takes or
   brings more energy than it may, is undone and made again in halves, each of which may be cut again. What follows the two halves is a step
   of the size that has been cut: steps hang on the solution alone. Observers see the ends of whole controller steps. */
#include "controllerimpl.h"

/* Part of the stable step up to which explicit steps may be mixed with halves of them */
#define NEAR_STABLE 0.95
/* How often a step may be cut by default; of runs with static bodies, where a cut is one of the load and costs no more than its steps */
#define STEP_CUTS   4
#define STATIC_CUTS 10

/*@
  ControllerSetStepCuts - sets how often a controller step that fails may be cut in halves

  Logically Collective

  Input Parameters:
+ controller - the `Controller`
- cuts       - 0: never, so that a step that fails ends the run; at most `STEP_MAX_CUTS`

  Options Database Key:
. -controller_step_cuts n - the number, 4, with static bodies 10

  Level: intermediate

  Notes:
  A step fails whose outer iteration, active set, Newton's method or massless layer does not converge, that inverts an element, or in which
  contact takes or brings more energy than `-contact_energy_tolerance` allows. It is undone and made again in halves, these again in
halves where they fail, up to so many times. After both halves the next step is one of the size that has been cut, so that each controller
step begins whole. A run that makes cuts ends with the same bits as one that makes these steps without any that fail.

  Each body makes as many substeps to a cut step as to a whole one, which are shorter. Times in the output are the ends of whole controller
  steps.

  Where the last cut does not help the run ends with an error, or -schwarz_unconverged accept takes what has not converged; what changes
energy is accepted, and counted: `ControllerGetCuts()`.

  Forward-increment Lagrange multipliers and the contact-stabilised method change the start of their steps, which are never cut.

.seealso: `Controller`, `ControllerGetCuts()`, `ContactGetTraits()`, `StepConvergedReason`
@*/
PetscErrorCode ControllerSetStepCuts(Controller controller, PetscInt cuts)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscValidLogicalCollectiveInt(controller, cuts, 2);
  PetscCheck(cuts >= 0 && cuts <= STEP_MAX_CUTS, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_OUTOFRANGE,
             "A controller step can be cut in halves 0 to %d times, not %" PetscInt_FMT, STEP_MAX_CUTS, cuts);
  controller->most_cuts = cuts;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerGetCuts - how often controller steps had to be cut in halves so far

  Not Collective

  Input Parameter:
. controller - the `Controller`, set up

  Output Parameter:
. cuts - see `ControllerCuts`

  Level: intermediate

.seealso: `Controller`, `ControllerSetStepCuts()`
@*/
PetscErrorCode ControllerGetCuts(Controller controller, ControllerCuts *cuts)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(cuts, 2);
  *cuts = controller->cuts;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ControllerReadStepControl(Controller controller)
{
  PetscInt  cuts = controller->most_cuts;
  PetscBool set;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)controller);
  PetscCall(PetscOptionsInt("-controller_step_cuts", "How often a controller step that fails is cut in halves", "ControllerSetStepCuts",
                            cuts, &cuts, &set));
  PetscOptionsEnd();
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(cuts >= 0 && cuts <= STEP_MAX_CUTS, PetscObjectComm((PetscObject)controller), PETSC_ERR_USER_INPUT,
             "-controller_step_cuts %" PetscInt_FMT ": a controller step can be cut in halves 0 to %d times", cuts, STEP_MAX_CUTS);
  PetscCall(ControllerSetStepCuts(controller, cuts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a body makes explicit steps so near to the stable one that others among them make it unstable: at 0.999 of it the energy of a bar
   between two walls grows by 10^9 where steps are cut, at 0.9, which is what -<body>_ts_time_step auto takes, it does not. */
static PetscErrorCode IsNearInstability(Body body, PetscBool *near)
{
  PetscReal stable, step;
  PetscBool is_explicit;
  TS        ts;

  PetscFunctionBegin;
  *near = PETSC_FALSE;
  PetscCall(BodyIsExplicit(body, &is_explicit));
  if (!is_explicit) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetStableStep(body, &stable));
  PetscCall(BodyGetTS(body, &ts));
  PetscCall(TSGetTimeStep(ts, &step));
  *near = (PetscBool)(step > NEAR_STABLE * stable);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ControllerSetUpStepControl(Controller controller)
{
  ControllerStatics statics;
  ContactTraits     traits;

  PetscFunctionBegin;
  PetscCall(ContactGetTraits(controller->contact, &traits));
  PetscCall(ControllerGetStatics(controller, &statics));
  if (controller->most_cuts == PETSC_DECIDE) controller->most_cuts = statics.some ? STATIC_CUTS : STEP_CUTS;
  if (!traits.cuts && controller->most_cuts) controller->whole = "the method changes the state that its steps start from";
  for (PetscInt b = 0; b < controller->n_bodies && controller->most_cuts && traits.cuts; b++) {
    PetscBool near;

    PetscCall(IsNearInstability(controller->bodies[b], &near));
    if (near) controller->whole = "an explicit body is too near to its stable step for steps that change";
  }
  if (controller->whole) controller->most_cuts = 0;
  controller->parts              = traits.parts;
  controller->cuts.smallest_step = controller->time_step / (PetscReal)controller->parts;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Hands the energies of the bodies, as their measures have them, to contact: those that the next step starts with */
PetscErrorCode ControllerNoteEnergies(Controller controller)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < controller->n_bodies; b++) controller->energies[b] = BodyMeasuresGetBalance(&controller->measures[b]);
  PetscCall(ContactSetStartEnergies(controller->contact, controller->energies));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Energy that contact may take or bring in a step, part of what the errors of the summary are compared with [J] */
static PetscErrorCode GetMostLoss(Controller controller, PetscReal *most)
{
  ContactTraits traits;

  PetscFunctionBegin;
  PetscCall(ContactGetTraits(controller->contact, &traits));
  *most = traits.energy_tolerance * controller->scale.largest;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One step at a level of cuts; `done`: it has been made, and is not to be cut */
static PetscErrorCode TryStep(Controller controller, PetscInt level, PetscBool *done)
{
  const PetscBool     may_cut = (PetscBool)(level < controller->most_cuts);
  StepConvergedReason reason;
  PetscReal           most = 0, loss = 0;
  PetscBool           changes = PETSC_FALSE;
  ContactCounts       counts;

  PetscFunctionBegin;
  PetscCall(GetMostLoss(controller, &most));
  most /= PetscPowRealInt(2, level); /* halves have half of what the whole controller step may lose */
  PetscCall(ContactTryStep(controller->contact, may_cut, most, &reason));
  PetscCall(ContactGetCounts(controller->contact, &counts));
  controller->step_sweeps += counts.sweeps;
  if (reason < 0 && !may_cut) PetscCall(ContactRaiseFailure(controller->contact, controller->step + 1, level));
  if (reason >= 0 && controller->most_cuts) PetscCall(ContactGetEnergyLoss(controller->contact, &loss));
  changes = (PetscBool)(PetscAbsReal(loss) > most);
  if (changes && !may_cut) controller->cuts.lossy_steps++;
  *done = (PetscBool)(reason >= 0 && !(changes && may_cut));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A step that has been cut so many times, whole or in halves */
static PetscErrorCode MakeStep(Controller controller, PetscInt level)
{
  PetscBool done;

  PetscFunctionBegin;
  if (controller->most_cuts) PetscCall(ContactSetStepLevel(controller->contact, level));
  PetscCall(TryStep(controller, level, &done));
  if (done) {
    PetscCall(ContactAccept(controller->contact));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ContactStepBack(controller->contact));
  controller->step_cuts++;
  controller->cuts.smallest_step = PetscMin(controller->cuts.smallest_step,
                                            controller->time_step / (PetscReal)controller->parts / PetscPowRealInt(2, level + 1));
  for (PetscInt half = 0; half < 2; half++) PetscCall(MakeStep(controller, level + 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A whole controller step, from the state that was accepted last to one that is accepted: each of its parts, see ContactTraits */
PetscErrorCode ControllerMakeStep(Controller controller)
{
  PetscInt most_sweeps = 0;

  PetscFunctionBegin;
  controller->step_cuts = 0;
  for (PetscInt part = 0; part < controller->parts; part++) {
    controller->step_sweeps = 0;
    PetscCall(MakeStep(controller, 0));
    most_sweeps = PetscMax(most_sweeps, controller->step_sweeps);
  }
  controller->step_sweeps = most_sweeps;
  controller->cuts.cuts += controller->step_cuts;
  controller->cuts.steps += controller->step_cuts > 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
