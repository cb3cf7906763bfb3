/* The class and its time loop. */
#include "controllerimpl.h"
#include <impakt/private/bodymeasures.h>
#include <impakt/private/bodystep.h>
#include <sys/largepages.h>
#include <sys/optionstext.h>
#include <sys/resource.h>
#include <sys/stages.h>
#include <sys/units.h>

/* From so many bodies on their memory is on large pages */
#define MANY_BODIES 16

/*@
  ControllerCreate - creates a simulation without bodies

  Collective

  Input Parameter:
. comm - communicator

  Output Parameter:
. controller - the `Controller`

  Level: beginner

.seealso: `Controller`, `ControllerAddBody()`, `ControllerSetTimes()`, `ControllerSetFromOptions()`, `ControllerSetUp()`,
          `ControllerSolve()`
@*/
PetscErrorCode ControllerCreate(MPI_Comm comm, Controller *controller)
{
  struct rusage usage;

  PetscFunctionBegin;
  PetscAssertPointer(controller, 2);
  PetscCall(ControllerInitializePackage());
  PetscCall(PetscHeaderCreate(*controller, CONTROLLER_CLASSID, "Controller", "Controller time stepper", "Controller", comm,
                              ControllerDestroy, ControllerView));
  (*controller)->guard.part = ENERGY_GUARD;
  (*controller)->most_cuts  = PETSC_DECIDE;
  if (!getrusage(RUSAGE_SELF, &usage)) (*controller)->cost.memory = 1024 * (PetscLogDouble)usage.ru_maxrss; /* Linux counts kB */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerSetUp - sets up bodies and contact

  Collective

  Input Parameter:
. controller - the `Controller`

  Level: beginner

.seealso: `Controller`, `ControllerSolve()`
@*/
PetscErrorCode ControllerSetUp(Controller controller)
{
  MPI_Comm       comm = PetscObjectComm((PetscObject)controller);
  PetscLogDouble begin, end;
  PetscInt       n_pairs, n = controller->n_bodies;
  PetscBool      logged;
  Contact        contact;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  if (controller->setup) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(n, comm, PETSC_ERR_ARG_WRONGSTATE, "There are no bodies: call ControllerAddBody() or ControllerSetFromOptions() first");
  PetscCheck(controller->time_step > 0 || controller->chooses_step, comm, PETSC_ERR_ARG_WRONGSTATE,
             "There are no times: call ControllerSetTimes() or ControllerSetFromOptions() first");
  PetscCall(StageBegin(STAGE_SETUP, &logged));
  PetscCall(PetscTime(&begin));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ContactSetUpSurfaces(contact));
  PetscCall(ControllerWarnOfUnits(controller)); /* before the checks that numbers in wrong units fail */
  PetscCall(ControllerChooseStep(controller));
  for (PetscInt b = 0; b < n; b++) PetscCall(BodySetControllerStep(controller->bodies[b], controller->time_start, controller->time_step));
  PetscCall(ContactSetUp(contact));
  PetscCall(BodyRefuseNewtonOptions(n, controller->bodies));
  PetscCall(ControllerSetUpStepControl(controller));
  PetscCall(ControllerWarnOfStep(controller));
  PetscCall(ControllerWarnOfElements(controller));
  PetscCall(ContactGetNumPairs(controller->contact, &n_pairs));
  PetscCall(PetscCalloc5(n, &controller->measures, n, &controller->has_obstacle, 3 * n, &controller->contact_positions, 3 * n,
                         &controller->contact_velocities, n_pairs, &controller->pair_states));
  PetscCall(PetscCalloc3(n, &controller->guard.start, n, &controller->energies, BODY_MEASURE_SUMS * n, &controller->measure_sums));
  for (PetscInt p = 0; p < n_pairs; p++) {
    Body first, second;

    PetscCall(ContactGetPair(controller->contact, p, NULL, &first, &second));
    for (PetscInt b = 0; b < n && !second; b++)
      if (controller->bodies[b] == first) controller->has_obstacle[b] = PETSC_TRUE;
  }
  PetscCall(ControllerSetUpSupports(controller));
  PetscCall(ControllerSetUpProbes(controller));
  if (n >= MANY_BODIES) UseLargePages();
  PetscCall(PetscTime(&end));
  controller->cost.setup += end - begin;
  controller->setup = PETSC_TRUE;
  PetscCall(StageEnd(logged));
  PetscCall(PetscObjectViewFromOptions((PetscObject)controller, NULL, "-controller_view"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CPU time of a process: in its own code, and in the system on its behalf [s] */
static PetscLogDouble Seconds(const struct rusage *usage)
{
  return (PetscLogDouble)(usage->ru_utime.tv_sec + usage->ru_stime.tv_sec) +
         1e-6 * (PetscLogDouble)(usage->ru_utime.tv_usec + usage->ru_stime.tv_usec);
}

static PetscErrorCode AfterStep(Controller controller, PetscBool *stop)
{
  PetscFunctionBegin;
  if (controller->after_step) PetscCall((*controller->after_step)(controller, controller->step, controller->after_step_ctx, stop));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether options ask to see anything of solvers, some of which read their options within a step */
static PetscErrorCode AsksForViews(PetscBool *asks)
{
  const char *const of[] = {"view", "monitor", "snes_", "ksp_", "pc_"};

  PetscFunctionBegin;
  *asks = PETSC_FALSE;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(of) && !*asks; k++) PetscCall(OptionsTextHas(of[k], asks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* PETSc looks for views by their names in each solution, of which a step has many: an eighth of a run of small bodies */
static PetscErrorCode MakeStepWithoutViews(Controller controller)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscOptionsPushCreateViewerOff(PETSC_TRUE));
  error = ControllerMakeStep(controller);
  PetscCall(PetscOptionsPopCreateViewerOff());
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerSolve - runs all controller steps that are left

  Collective

  Input Parameter:
. controller - the `Controller`, set up

  Level: beginner

  Note:
  Ends early where the function of `ControllerSetAfterStep()` says so.

.seealso: `Controller`, `ControllerMonitorSet()`, `ControllerGetStep()`
@*/
PetscErrorCode ControllerSolve(Controller controller)
{
  PetscLogDouble wall[2];
  struct rusage  cpu[2];
  PetscBool      stop = PETSC_FALSE, views = PETSC_FALSE;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscCall(ControllerSetUp(controller));
  PetscCall(AsksForViews(&views));
  PetscCall(PetscTime(&wall[0]));
  getrusage(RUSAGE_SELF, &cpu[0]);
  if (!controller->goes_on) PetscCall(ControllerNotify(controller, 0));
  if (!controller->goes_on) PetscCall(AfterStep(controller, &stop));
  while (controller->step < controller->steps && !stop) {
    PetscCall(views ? ControllerMakeStep(controller) : MakeStepWithoutViews(controller));
    PetscCall(ControllerNotify(controller, ++controller->step));
    PetscCall(AfterStep(controller, &stop));
  }
  PetscCall(PetscTime(&wall[1]));
  getrusage(RUSAGE_SELF, &cpu[1]);
  controller->cost.wall = wall[1] - wall[0];
  controller->cost.cpu  = Seconds(&cpu[1]) - Seconds(&cpu[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerView - prints times, bodies and contact

  Collective

  Input Parameters:
+ controller - the `Controller`, set up
- viewer     - an ASCII viewer, `NULL` for standard output

  Level: beginner

.seealso: `Controller`
@*/
PetscErrorCode ControllerView(Controller controller, PetscViewer viewer)
{
  PetscBool ascii;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)controller), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(controller->setup, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_WRONGSTATE, "Call ControllerSetUp() first");
  PetscCall(PetscViewerASCIIPrintf(viewer, "time %g to %g%s, %" PetscInt_FMT " controller steps of %g%s\n", (double)controller->time_start,
                                   (double)(controller->time_start + controller->steps * controller->time_step),
                                   UnitsOf((PetscObject)controller, UNIT_TIME), controller->steps, (double)controller->time_step,
                                   UnitsOf((PetscObject)controller, UNIT_TIME)));
  if (controller->whole) PetscCall(PetscViewerASCIIPrintf(viewer, "  steps that fail are not cut in halves: %s\n", controller->whole));
  if (controller->chooses_step)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  the largest step that resolves contact: %s\n", controller->step_reason));
  for (PetscInt b = 0; b < controller->n_bodies; b++) PetscCall(BodyView(controller->bodies[b], viewer));
  PetscCall(ContactView(controller->contact, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerDestroy - frees a simulation

  Collective

  Input Parameter:
. controller - the `Controller`, set to `NULL`

  Level: beginner

.seealso: `Controller`, `ControllerCreate()`
@*/
PetscErrorCode ControllerDestroy(Controller *controller)
{
  Controller c = *controller;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(c, CONTROLLER_CLASSID, 1);
  if (--((PetscObject)c)->refct > 0) {
    *controller = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < c->n_monitors; i++)
    if (c->monitor_destroy[i]) PetscCall((*c->monitor_destroy[i])(&c->monitor_ctx[i]));
  PetscCall(ContactDestroy(&c->contact));
  for (PetscInt b = 0; b < c->n_bodies; b++) PetscCall(BodyDestroy(&c->bodies[b]));
  PetscCall(PetscFree(c->bodies));
  PetscCall(PetscFree3(c->guard.start, c->energies, c->measure_sums));
  PetscCall(PetscFree2(c->supports, c->reactions));
  PetscCall(PetscFree2(c->probes, c->probe_values));
  PetscCall(PetscFree5(c->measures, c->has_obstacle, c->contact_positions, c->contact_velocities, c->pair_states));
  PetscCall(PetscHeaderDestroy(controller));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ControllerGetCost(Controller controller, ControllerCost *cost)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(cost, 2);
  *cost = controller->cost;
  PetscFunctionReturn(PETSC_SUCCESS);
}
