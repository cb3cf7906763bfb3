/* The class and its time loop. */
#include "controllerimpl.h"
#include <sys/names.h>
#include <sys/resource.h>

PetscClassId CONTROLLER_CLASSID = 0;

/*@
  ControllerRegisterAll - registers the class

  Not Collective

  Level: developer

.seealso: `Controller`, `ImpaktInitialize()`
@*/
PetscErrorCode ControllerRegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(PetscClassIdRegister("Controller", &CONTROLLER_CLASSID));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerCreate - creates a simulation, whose times, bodies and contact come from options

  Collective

  Input Parameter:
. comm - communicator

  Output Parameter:
. controller - the `Controller`

  Level: beginner

.seealso: `Controller`, `ControllerSetFromOptions()`, `ControllerSetUp()`, `ControllerSolve()`
@*/
PetscErrorCode ControllerCreate(MPI_Comm comm, Controller *controller)
{
  PetscFunctionBegin;
  PetscCall(PetscHeaderCreate(*controller, CONTROLLER_CLASSID, "Controller", "Controller time stepper", "Controller", comm,
                              ControllerDestroy, ControllerView));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateBodies(Controller controller)
{
  MPI_Comm  comm = PetscObjectComm((PetscObject)controller);
  char    **names;
  PetscInt  n;
  PetscBool set, same;

  PetscFunctionBegin;
  PetscCall(NamesRead(NULL, "-bodies", &n, &names, &set));
  PetscCheck(
      set && n, comm, PETSC_ERR_USER_INPUT,
      "-bodies is missing: name the bodies, as in -bodies left,right, or give an options file with -options_file (options/ has some)");
  controller->n_bodies = n;
  PetscCall(PetscCalloc1(n, &controller->bodies));
  for (PetscInt b = 0; b < n; b++) PetscCall(BodyCreate(comm, names[b], &controller->bodies[b]));
  PetscCall(NamesDestroy(n, &names));
  for (PetscInt b = 0; b < n; b++) {
    for (PetscInt other = 0; other < b; other++) {
      PetscCall(PetscStrcmp(((PetscObject)controller->bodies[b])->name, ((PetscObject)controller->bodies[other])->name, &same));
      PetscCheck(!same, comm, PETSC_ERR_USER_INPUT, "-bodies names '%s' twice", ((PetscObject)controller->bodies[b])->name);
    }
    PetscCall(BodySetFromOptions(controller->bodies[b]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerSetFromOptions - reads times, bodies and contact from the options

  Collective

  Input Parameter:
. controller - the `Controller`

  Options Database Keys:
+ -bodies a,b         - names of the bodies; options of body a begin with -a_
. -time_start t       - [s], default 0
. -time_end t         - [s]; the run ends with the first controller step that reaches it
. -time_step dt       - controller step, at whose ends all bodies are synchronised [s]
. -monitor_interval n - a line on the terminal every n controller steps, 0 (default) for none
- -progress           - a progress bar on standard error, default where that is a terminal

  Level: beginner

.seealso: `Controller`, `BodySetFromOptions()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ControllerSetFromOptions(Controller controller)
{
  MPI_Comm       comm = PetscObjectComm((PetscObject)controller);
  PetscBool      set_end, set_step;
  PetscReal      quotient;
  PetscLogDouble begin, end;

  PetscFunctionBegin;
  PetscCall(PetscTime(&begin));
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscObjectOptionsBegin((PetscObject)controller);
  PetscCall(PetscOptionsReal("-time_start", "Start time [s]", "", controller->time_start, &controller->time_start, NULL));
  PetscCall(PetscOptionsReal("-time_end", "End time [s]", "", controller->time_end, &controller->time_end, &set_end));
  PetscCall(PetscOptionsReal("-time_step", "Controller step [s]", "", controller->time_step, &controller->time_step, &set_step));
  PetscOptionsEnd();
  PetscCall(ControllerSetUpTerminal(controller));
  PetscCall(CreateBodies(controller));
  PetscCheck(set_end && set_step, comm, PETSC_ERR_USER_INPUT, "-time_end and -time_step are needed, in s");
  PetscCheck(controller->time_step > 0, comm, PETSC_ERR_USER_INPUT, "-time_step %g s must be positive", (double)controller->time_step);
  PetscCheck(controller->time_end > controller->time_start, comm, PETSC_ERR_USER_INPUT,
             "-time_end %g s must be later than -time_start %g s", (double)controller->time_end, (double)controller->time_start);
  quotient = (controller->time_end - controller->time_start) / controller->time_step;
  PetscCheck(quotient < MOST_STEPS, comm, PETSC_ERR_USER_INPUT, "-time_step %g s is too small for %g s of simulated time",
             (double)controller->time_step, (double)(controller->time_end - controller->time_start));
  controller->steps = (PetscInt)PetscCeilReal(quotient * (1 - STEPS_ROUND_OFF) - STEPS_FLOOR);
  for (PetscInt b = 0; b < controller->n_bodies; b++)
    PetscCall(BodySetControllerStep(controller->bodies[b], controller->time_start, controller->time_step));
  PetscCall(ContactCreate(comm, &controller->contact));
  PetscCall(ContactSetBodies(controller->contact, controller->n_bodies, controller->bodies));
  PetscCall(ContactSetFromOptions(controller->contact));
  PetscCall(PetscTime(&end));
  controller->setup_seconds = end - begin;
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
  PetscLogDouble begin, end;
  PetscInt       n_pairs, n = controller->n_bodies;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  if (controller->setup) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(controller->contact, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_WRONGSTATE,
             "Call ControllerSetFromOptions() first");
  PetscCall(PetscTime(&begin));
  PetscCall(ContactSetUp(controller->contact));
  PetscCall(ContactGetNumPairs(controller->contact, &n_pairs));
  PetscCall(PetscCalloc5(n, &controller->measures, n, &controller->has_obstacle, 3 * n, &controller->contact_positions, 3 * n,
                         &controller->contact_velocities, n_pairs, &controller->pair_states));
  for (PetscInt p = 0; p < n_pairs; p++) {
    Body first, second;

    PetscCall(ContactGetPair(controller->contact, p, NULL, &first, &second));
    for (PetscInt b = 0; b < n && !second; b++)
      if (controller->bodies[b] == first) controller->has_obstacle[b] = PETSC_TRUE;
  }
  PetscCall(PetscTime(&end));
  controller->setup_seconds += end - begin;
  controller->setup = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CPU time of a process: in its own code, and in the system on its behalf [s] */
static PetscLogDouble Seconds(const struct rusage *usage)
{
  return (PetscLogDouble)(usage->ru_utime.tv_sec + usage->ru_stime.tv_sec) +
         1e-6 * (PetscLogDouble)(usage->ru_utime.tv_usec + usage->ru_stime.tv_usec);
}

/*@
  ControllerSolve - runs all controller steps

  Collective

  Input Parameter:
. controller - the `Controller`, set up

  Level: beginner

.seealso: `Controller`, `ControllerMonitorSet()`
@*/
PetscErrorCode ControllerSolve(Controller controller)
{
  PetscLogDouble wall[2];
  struct rusage  cpu[2];

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscCall(ControllerSetUp(controller));
  PetscCall(PetscTime(&wall[0]));
  getrusage(RUSAGE_SELF, &cpu[0]);
  PetscCall(ControllerNotify(controller, 0));
  for (PetscInt step = 1; step <= controller->steps; step++) {
    PetscCall(ContactStep(controller->contact));
    PetscCall(ContactAccept(controller->contact));
    PetscCall(ControllerNotify(controller, step));
  }
  PetscCall(PetscTime(&wall[1]));
  getrusage(RUSAGE_SELF, &cpu[1]);
  controller->wall_seconds = wall[1] - wall[0];
  controller->cpu_seconds  = Seconds(&cpu[1]) - Seconds(&cpu[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerView - prints times, bodies and contact

  Collective

  Input Parameters:
+ controller - the `Controller`, set up
- viewer     - an ASCII viewer

  Level: beginner

.seealso: `Controller`
@*/
PetscErrorCode ControllerView(Controller controller, PetscViewer viewer)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscCall(PetscViewerASCIIPrintf(viewer, "time %g to %g s, %" PetscInt_FMT " controller steps of %g s\n", (double)controller->time_start,
                                   (double)(controller->time_start + controller->steps * controller->time_step), controller->steps,
                                   (double)controller->time_step));
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
  PetscCall(PetscFree5(c->measures, c->has_obstacle, c->contact_positions, c->contact_velocities, c->pair_states));
  PetscCall(PetscHeaderDestroy(controller));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ControllerGetBodies - the bodies

  Not Collective

  Input Parameter:
. controller - the `Controller`

  Output Parameters:
+ n      - their number
- bodies - the bodies, owned by the controller

  Level: intermediate

.seealso: `Controller`
@*/
PetscErrorCode ControllerGetBodies(Controller controller, PetscInt *n, const Body *bodies[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  if (n) *n = controller->n_bodies;
  if (bodies) *bodies = controller->bodies;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerGetContact - the contact problem

  Not Collective

  Input Parameter:
. controller - the `Controller`

  Output Parameter:
. contact - the `Contact`, owned by the controller

  Level: intermediate

.seealso: `Controller`
@*/
PetscErrorCode ControllerGetContact(Controller controller, Contact *contact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  *contact = controller->contact;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerGetTimes - start, controller step and number of steps

  Not Collective

  Input Parameter:
. controller - the `Controller`

  Output Parameters:
+ start - start time [s], or `NULL`
. step  - controller step [s], or `NULL`
- steps - number of controller steps, or `NULL`

  Level: intermediate

.seealso: `Controller`
@*/
PetscErrorCode ControllerGetTimes(Controller controller, PetscReal *start, PetscReal *step, PetscInt *steps)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  if (start) *start = controller->time_start;
  if (step) *step = controller->time_step;
  if (steps) *steps = controller->steps;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerGetTimings - what the run cost

  Not Collective

  Input Parameter:
. controller - the `Controller`, solved

  Output Parameters:
+ setup - wall time of the set-up, from the meshes on [s]
. wall  - wall time of the time loop [s]
- cpu   - CPU time of this process in the time loop [s]

  Level: intermediate

.seealso: `Controller`
@*/
PetscErrorCode ControllerGetTimings(Controller controller, PetscLogDouble *setup, PetscLogDouble *wall, PetscLogDouble *cpu)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  if (setup) *setup = controller->setup_seconds;
  if (wall) *wall = controller->wall_seconds;
  if (cpu) *cpu = controller->cpu_seconds;
  PetscFunctionReturn(PETSC_SUCCESS);
}
