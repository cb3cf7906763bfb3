/* The energy guard: a run that gains energy ends. */
#include "controllerimpl.h"
#include <impakt/private/bodymesh.h>

/* Energy at the start that is below this part of the largest since then is round-off: all starts at rest without strain */
#define NOTHING_AT_START 1e-9

/*@
  ControllerSetEnergyGuard - sets how much energy a run may gain before it ends with an error

  Logically Collective

  Input Parameters:
+ controller - the `Controller`, not yet set up
- part       - of the energy at the start or, where all starts at rest without strain, of the largest since then, and of the work of loads;
0 for no guard; 0.05 by default

  Options Database Key:
. -energy_guard part - how much

  Level: intermediate

  Note:
  What is compared is kinetic and potential energy of all bodies and energy of penalty springs, less the work of loads and of held
  displacements, at the end of each controller step. There is no guard where nothing can touch, nor where a body is static: what its contact
  forces have done is known up to their lag behind it by a step.

.seealso: `Controller`, `ContactGetTraits()`
@*/
PetscErrorCode ControllerSetEnergyGuard(Controller controller, PetscReal part)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscValidLogicalCollectiveReal(controller, part, 2);
  PetscCheck(!controller->setup, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_WRONGSTATE, "Call before ControllerSetUp()");
  PetscCheck(part >= 0, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_OUTOFRANGE, "The energy guard %g must not be negative",
             (double)part);
  controller->guard.part = part;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ControllerReadEnergyGuard(Controller controller)
{
  PetscReal part = controller->guard.part;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)controller);
  PetscCall(PetscOptionsReal("-energy_guard", "Energy that a run may gain before it ends", "ControllerSetEnergyGuard", part, &part, NULL));
  PetscOptionsEnd();
  PetscCheck(part >= 0, PetscObjectComm((PetscObject)controller), PETSC_ERR_USER_INPUT,
             "-energy_guard %g must not be negative; 0 switches it off", (double)part);
  controller->guard.part = part;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The body that has gained most since the start, and the pair with the largest force, for whoever looks for the cause */
static PetscErrorCode EndRun(Controller controller, const ControllerFrame *frame, PetscReal gain)
{
  PetscInt      body = 0, pair = 0;
  const char   *pair_name = "none", *body_name;
  ContactTraits traits;

  PetscFunctionBegin;
  for (PetscInt b = 1; b < frame->n_bodies; b++)
    if (BodyMeasuresGetBalance(&frame->bodies[b]) - controller->guard.start[b] >
        BodyMeasuresGetBalance(&frame->bodies[body]) - controller->guard.start[body])
      body = b;
  for (PetscInt p = 1; p < frame->n_pairs; p++)
    if (PetscAbsReal(frame->pairs[p].force) > PetscAbsReal(frame->pairs[pair].force)) pair = p;
  if (frame->n_pairs) PetscCall(ContactGetPair(controller->contact, pair, &pair_name, NULL, NULL));
  PetscCall(PetscObjectGetName((PetscObject)controller->bodies[body], &body_name));
  PetscCall(ContactGetTraits(controller->contact, &traits));
  PetscCheck(
      !traits.unlimited, PetscObjectComm((PetscObject)controller), PETSC_ERR_NOT_CONVERGED,
      "The energy has grown by %.3g %% at time %.9g s (controller step %" PetscInt_FMT
      "), most of it in body '%s'; the pair with the largest force is %s. Contact cannot be kept from it here, since %s: let contact "
      "nodes be massless (-<body>_mass_redistribute true), or choose a smaller -time_step; -energy_guard %g ends runs that gain more "
      "than this part of their energy, 0 none",
      (double)(100 * gain), (double)frame->time, frame->step, body_name, pair_name, traits.unlimited, (double)controller->guard.part);
  SETERRQ(PetscObjectComm((PetscObject)controller), PETSC_ERR_NOT_CONVERGED,
          "The energy has grown by %.3g %% at time %.9g s (controller step %" PetscInt_FMT
          "), most of it in body '%s'; the pair with the largest force is %s. Choose a smaller -time_step%s%s; -energy_guard %g ends "
          "runs that gain more than this part of their energy, 0 none",
          (double)(100 * gain), (double)frame->time, frame->step, body_name, pair_name,
          traits.energy_cap ? "" : ", or let -contact_energy_cap be true", traits.balance ? ", or -contact_balance false" : "",
          (double)controller->guard.part);
}

/* Ends the run where the energy of a body is no number: squares of its velocity or displacement are beyond all numbers */
static PetscErrorCode CheckFinite(Controller controller, const ControllerFrame *frame)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < frame->n_bodies; b++) {
    const char *name;

    if (!PetscIsInfOrNanReal(frame->bodies[b].kinetic + frame->bodies[b].potential)) continue;
    PetscCall(PetscObjectGetName((PetscObject)controller->bodies[b], &name));
    SETERRQ(PetscObjectComm((PetscObject)controller), PETSC_ERR_FP,
            "The energy of body '%s' is not a number at time %.9g s (controller step %" PetscInt_FMT
            "): its velocity or displacement is out of all proportion. Check units and formulas of -%s_initial_velocity, "
            "-%s_initial_displacement, and of its loads",
            name, (double)frame->time, frame->step, name, name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends the run where energies have grown beyond the guard; collective, with the same frame on every rank */
PetscErrorCode ControllerGuardEnergy(Controller controller, const ControllerFrame *frame)
{
  PetscReal       start = 0, size = 0, own, scale, work = PetscAbsReal(frame->obstacle_work), unresolved;
  const PetscReal gain = frame->energy_change + frame->uncounted_energy;

  PetscFunctionBegin;
  PetscCall(CheckFinite(controller, frame));
  if (controller->guard.part == 0 || !frame->n_pairs) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < frame->n_bodies; b++) {
    PetscBool without_inertia, given;

    PetscCall(BodyIsStatic(controller->bodies[b], &without_inertia));
    PetscCall(BodyGetLed(controller->bodies[b], NULL, &given));
    if (without_inertia) PetscFunctionReturn(PETSC_SUCCESS);
    if (frame->step == 0) controller->guard.start[b] = BodyMeasuresGetBalance(&frame->bodies[b]);
    if (frame->step == 0 && given) controller->guard.given += frame->bodies[b].kinetic;
    start += controller->guard.start[b];
    work += PetscAbsReal(frame->bodies[b].external_work);
    /* what is staggered may be round-off of much more: all of it in the first step of a load that sets in at zero */
    size += (given ? 0 : frame->bodies[b].kinetic_unstaggered) + frame->bodies[b].potential;
  }
  controller->guard.largest = PetscMax(controller->guard.largest, size);
  own                       = start - controller->guard.given;
  scale                     = (own > NOTHING_AT_START * controller->guard.largest ? own : controller->guard.largest) + work;
  PetscCall(ContactGetUnresolvedEnergy(controller->contact, &unresolved));
  if (gain > controller->guard.part * scale + unresolved) PetscCall(EndRun(controller, frame, gain / scale));
  PetscFunctionReturn(PETSC_SUCCESS);
}
