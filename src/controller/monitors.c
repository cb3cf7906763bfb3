/* The observers of a run: who they are, and what they are told after each accepted controller step. */
#include "controllerimpl.h"
#include <impakt/private/bodymeasures.h>
#include <sys/stages.h>

/*@C
  ControllerMonitorSet - adds an observer, called at the start and after every accepted controller step

  Logically Collective

  Input Parameters:
+ controller - the `Controller`
. monitor    - function (controller, frame, ctx)
. ctx        - its context
- destroy    - frees the context with the controller, or `NULL`

  Level: intermediate

.seealso: `Controller`, `ControllerFrame`
@*/
PetscErrorCode ControllerMonitorSet(Controller controller, ControllerMonitorFn *monitor, void *ctx, PetscErrorCode (*destroy)(void **))
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscCheck(monitor, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_NULL, "The monitor is no function");
  PetscCheck(controller->n_monitors < MAX_MONITORS, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_OUTOFRANGE,
             "Too many monitors, at most %d", MAX_MONITORS);
  controller->monitor[controller->n_monitors]           = monitor;
  controller->monitor_ctx[controller->n_monitors]       = ctx;
  controller->monitor_destroy[controller->n_monitors++] = destroy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gathers the state at the end of an accepted step, 0 for the start, and hands it to every observer */
PetscErrorCode ControllerNotify(Controller controller, PetscInt step)
{
  ControllerFrame frame = {.step               = step,
                           .steps              = controller->steps,
                           .n_bodies           = controller->n_bodies,
                           .bodies             = controller->measures,
                           .contact_positions  = controller->contact_positions,
                           .contact_velocities = controller->contact_velocities,
                           .pairs              = controller->pair_states,
                           .n_supports         = controller->n_supports,
                           .supports           = controller->supports,
                           .n_probes           = controller->n_probes,
                           .probes             = controller->probes};
  ContactCounts   counts;
  PetscBool       logged;
  ContactTraits   traits;

  PetscFunctionBegin;
  PetscCall(StageBegin(STAGE_OUTPUT, &logged));
  /* not summed up, so that round-off does not pile up over many steps */
  frame.time = controller->time_start + step * controller->time_step;
  PetscCall(ContactGetNumPairs(controller->contact, &frame.n_pairs));
  PetscCall(BodyGetAllMeasures(controller->n_bodies, controller->bodies, controller->measure_sums, controller->measures));
  for (PetscInt b = 0; b < controller->n_bodies; b++)
    if (controller->has_obstacle[b]) controller->measures[b].loaded = PETSC_TRUE;
  PetscCall(ContactGetBodyTraces(controller->contact, controller->contact_positions, controller->contact_velocities));
  PetscCall(ControllerNoteEnergies(controller));
  PetscCall(ContactGetPairStates(controller->contact, controller->pair_states));
  PetscCall(ControllerFindReactions(controller));
  PetscCall(ControllerFindProbes(controller));
  frame.sweeps    = step ? controller->step_sweeps : 0;
  frame.step_cuts = step ? controller->step_cuts : 0;
  PetscCall(ContactGetCounts(controller->contact, &counts));
  frame.penalty_energy = counts.spring_energy;
  PetscCall(ContactGetTraits(controller->contact, &traits));
  frame.uncounted_energy = traits.glue ? 0 : frame.penalty_energy;
  frame.friction_loss    = counts.friction_loss;
  frame.obstacle_work    = counts.obstacle_work;
  frame.contact_loss     = counts.contact_loss;
  frame.glue_loss        = counts.glue_loss;
  PetscCall(EnergyScaleAdd(&controller->scale, controller->bodies, &frame));
  PetscCall(ControllerGuardEnergy(controller, &frame));
  for (PetscInt i = 0; i < controller->n_monitors; i++)
    PetscCall((*controller->monitor[i])(controller, &frame, controller->monitor_ctx[i]));
  PetscCall(StageEnd(logged));
  PetscFunctionReturn(PETSC_SUCCESS);
}
