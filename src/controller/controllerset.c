/* What programs and options set of a simulation: bodies and times; and the package of the class. */
#include "controllerimpl.h"
#include <impakt/private/bodystep.h>
#include <sys/names.h>
#include <sys/sharedoptions.h>
#include <sys/package.h>
#include <sys/statusline.h>
#include <sys/stages.h>
#include <sys/units.h>

PetscClassId CONTROLLER_CLASSID = 0;

PetscErrorCode ControllerInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Controller", &CONTROLLER_CLASSID, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerAddBody - adds a body to the simulation

  Logically Collective

  Input Parameters:
+ controller - the `Controller`
- body       - the `Body`, not yet set up, of a name that no other body has

  Options Database Key:
. -bodies a,b - names of bodies that are made from options

  Level: beginner

  Note:
  The body reads no options by this: where it is to, call `BodySetFromOptions()` for it before.

.seealso: `Controller`, `BodyCreate()`, `ControllerGetBodies()`, `ControllerGetContact()`
@*/
PetscErrorCode ControllerAddBody(Controller controller, Body body)
{
  MPI_Comm  comm;
  PetscBool same;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscValidHeaderSpecific(body, BODY_CLASSID, 2);
  comm = PetscObjectComm((PetscObject)controller);
  PetscCheck(!controller->contact, comm, PETSC_ERR_ARG_WRONGSTATE,
             "Add all bodies before ControllerGetContact(), ControllerSetFromOptions() and ControllerSetUp()");
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    PetscCall(PetscStrcmp(((PetscObject)controller->bodies[b])->name, ((PetscObject)body)->name, &same));
    PetscCheck(!same, comm, PETSC_ERR_USER_INPUT, "-bodies names '%s' twice", ((PetscObject)body)->name);
  }
  PetscCall(PetscRealloc((size_t)(controller->n_bodies + 1) * sizeof(*controller->bodies), &controller->bodies));
  PetscCall(PetscObjectReference((PetscObject)body));
  controller->bodies[controller->n_bodies++] = body;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBodies(Controller controller)
{
  MPI_Comm       comm  = PetscObjectComm((PetscObject)controller);
  PetscErrorCode error = PETSC_SUCCESS;
  char         **names;
  PetscInt       n, first = controller->n_bodies;
  PetscBool      set;

  PetscFunctionBegin;
  PetscCall(NamesRead(NULL, "-bodies", &n, &names, &set));
  PetscCheck(
      (set && n) || first, comm, PETSC_ERR_USER_INPUT,
      "-bodies is missing: name the bodies, as in -bodies left,right, or give an options file with -options_file (options/ has some)");
  for (PetscInt b = 0; b < n && !error; b++) error = OptionsCheckName(comm, "bodies", names[b]);
  if (!error) error = OptionsExpandShared(comm, n, names);
  for (PetscInt b = 0; b < n && !error; b++) {
    Body body = NULL;

    error = BodyCreate(comm, names[b], &body);
    if (!error) error = ControllerAddBody(controller, body);
    PetscCall(BodyDestroy(&body));
  }
  PetscCall(NamesDestroy(n, &names));
  PetscCall(error);
  PetscCall(ControllerPlaceBodies(controller, first));
  for (PetscInt b = first; b < controller->n_bodies; b++) {
    StatusLineTell("mesh of body %s", ((PetscObject)controller->bodies[b])->name);
    PetscCall(BodySetFromOptions(controller->bodies[b]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckTimes(Controller controller, PetscErrorCode code, PetscReal start, PetscReal end, PetscReal step)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)controller);
  const char *unit = UnitsOf((PetscObject)controller, UNIT_TIME);

  PetscFunctionBegin;
  PetscCheck(step > 0 || step == (PetscReal)PETSC_DETERMINE, comm, code, "-time_step %g%s must be positive", (double)step, unit);
  PetscCheck(end > start, comm, code, "-time_end %g%s must be later than -time_start %g%s", (double)end, unit, (double)start, unit);
  PetscCheck(PetscAbsReal(start) <= LONGEST_TIME && end <= LONGEST_TIME, comm, code,
             "-time_start %g%s and -time_end %g%s must lie between -%g and %g%s: beyond them, squares of times are not numbers",
             (double)start, unit, (double)end, unit, LONGEST_TIME, LONGEST_TIME, unit);
  PetscCheck(step < 0 || (step >= SHORTEST_STEP && step <= LONGEST_TIME), comm, code,
             "-time_step %g%s must lie between %g and %g%s: beyond them, its square divides by zero or by infinity", (double)step, unit,
             SHORTEST_STEP, LONGEST_TIME, unit);
  PetscCheck(step < 0 || (end - start) / step < MOST_STEPS, comm, code, "-time_step %g%s is too small for %g%s of simulated time",
             (double)step, unit, (double)(end - start), unit);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerSetTimes - sets start, end and controller step

  Logically Collective

  Input Parameters:
+ controller - the `Controller`, not yet set up
. start      - [s]
. end        - [s]; the run ends with the first controller step that reaches it
- step       - controller step, at whose ends all bodies are synchronised [s]; `PETSC_DETERMINE`: the largest that resolves contact, see
               `ContactGetResolvedStep()`, made smaller to divide the duration, or a multiple of the longest substep that a body has been
               given; explicit bodies without one get a stable substep

  Options Database Keys:
+ -time_start t - the start, default 0
. -time_end t   - the end
- -time_step (auto|dt) - the controller step

  Level: beginner

.seealso: `Controller`, `ControllerGetTimes()`, `BodySetTimeStep()`
@*/
PetscErrorCode ControllerSetTimes(Controller controller, PetscReal start, PetscReal end, PetscReal step)
{
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscValidLogicalCollectiveReal(controller, start, 2);
  PetscValidLogicalCollectiveReal(controller, end, 3);
  PetscValidLogicalCollectiveReal(controller, step, 4);
  comm = PetscObjectComm((PetscObject)controller);
  PetscCheck(!controller->setup, comm, PETSC_ERR_ARG_WRONGSTATE, "Call before ControllerSetUp()");
  PetscCall(CheckTimes(controller, PETSC_ERR_ARG_OUTOFRANGE, start, end, step));
  controller->time_start = start;
  controller->time_end   = end;
  if (step < 0) {
    controller->chooses_step = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  controller->time_step = step;
  controller->steps     = (PetscInt)PetscCeilReal((end - start) / step * (1 - STEPS_ROUND_OFF) - STEPS_FLOOR);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* -time_step takes a word where others take a number */
static PetscErrorCode ReadTimeStep(Controller controller, PetscReal *step, PetscBool *set)
{
  char      text[64] = "";
  PetscBool is_auto  = PETSC_FALSE;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)controller);
  PetscCall(PetscOptionsString("-time_step", "Controller step [s], or auto", "ControllerSetTimes", "", text, sizeof(text), set));
  PetscOptionsEnd();
  if (!*set) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrcasecmp(text, "auto", &is_auto));
  if (is_auto) *step = PETSC_DETERMINE;
  else PetscCall(PetscOptionsGetReal(NULL, ((PetscObject)controller)->prefix, "-time_step", step, NULL));
  PetscCheck(is_auto || *step > 0, PetscObjectComm((PetscObject)controller), PETSC_ERR_USER_INPUT, "-time_step %g%s must be positive",
             (double)*step, UnitsOf((PetscObject)controller, UNIT_TIME));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadTimes(Controller controller)
{
  MPI_Comm        comm  = PetscObjectComm((PetscObject)controller);
  const PetscBool known = (PetscBool)(controller->time_step > 0 || controller->chooses_step);
  PetscReal       start = controller->time_start, end = controller->time_end;
  PetscReal       step = controller->chooses_step ? (PetscReal)PETSC_DETERMINE : controller->time_step;
  PetscBool       set_end, set_step;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)controller);
  PetscCall(PetscOptionsReal("-time_start", "Start time [s]", "ControllerSetTimes", start, &start, NULL));
  PetscCall(PetscOptionsReal("-time_end", "End time [s]", "ControllerSetTimes", end, &end, &set_end));
  PetscOptionsEnd();
  PetscCall(ReadTimeStep(controller, &step, &set_step));
  PetscCheck(set_end || known, comm, PETSC_ERR_USER_INPUT, "-time_end is missing; give the time at which the run ends");
  PetscCheck(set_step || known, comm, PETSC_ERR_USER_INPUT,
             "-time_step is missing; give the controller step, or -time_step auto, which takes the largest that resolves contact");
  PetscCall(CheckTimes(controller, PETSC_ERR_USER_INPUT, start, end, step));
  controller->chooses_step = PETSC_FALSE;
  PetscCall(ControllerSetTimes(controller, start, end, step));
  PetscCall(ControllerReadEnergyGuard(controller));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Labels are made of -units where they are printed, see UnitsGet() */
static PetscErrorCode ReadUnits(Controller controller)
{
  Units units = UNITS_SI;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)controller);
  PetscCall(PetscOptionsEnum("-units", "Units of the user's numbers, for labels and plausibility", "ControllerSetFromOptions", UnitsNames,
                             (PetscEnum)units, (PetscEnum *)&units, NULL));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerSetFromOptions - reads times, bodies and contact from the options

  Collective

  Input Parameter:
. controller - the `Controller`

  Options Database Keys:
+ -bodies a,b         - names of the bodies; options of body a begin with -a_
. -all_gravity g, ... - an option of each of these bodies that has none of that name, nor by its material
. -a_material steel   - body a has the options that begin with -material_steel_, but for those that it has itself
- -time_step, ...     - times, steps, terminal and units, with defaults in options/README.md, which `impakt -help` prints too

  Level: beginner

  Note:
  What the program has set before holds where the options are silent; bodies of the options come after those that it has added.

.seealso: `Controller`, `ControllerAddBody()`, `ControllerSetTimes()`, `BodySetFromOptions()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ControllerSetFromOptions(Controller controller)
{
  PetscLogDouble begin, end;
  PetscBool      logged;
  Contact        contact;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscCall(StageBegin(STAGE_SETUP, &logged));
  PetscCall(PetscTime(&begin));
  PetscCall(ReadUnits(controller));
  PetscCall(ControllerSetUpTerminal(controller));
  if (!controller->contact) PetscCall(ReadBodies(controller));
  PetscCall(ReadTimes(controller));
  PetscCall(ControllerReadStepControl(controller));
  /* pairs choose their sides by it */
  for (PetscInt b = 0; b < controller->n_bodies && !controller->chooses_step; b++)
    PetscCall(BodySetControllerStep(controller->bodies[b], controller->time_start, controller->time_step));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ContactSetFromOptions(contact));
  PetscCall(PetscTime(&end));
  controller->cost.setup = end - begin;
  PetscCall(StageEnd(logged));
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

.seealso: `Controller`, `ControllerAddBody()`
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
  ControllerGetContact - the contact problem between the bodies

  Collective the first time, when it is made

  Input Parameter:
. controller - the `Controller`

  Output Parameter:
. contact - the `Contact`, owned by the controller; no body can be added after that

  Level: intermediate

.seealso: `Controller`, `ControllerAddBody()`, `ContactAddPair()`, `ContactSetType()`
@*/
PetscErrorCode ControllerGetContact(Controller controller, Contact *contact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(contact, 2);
  if (!controller->contact) {
    PetscCheck(controller->n_bodies, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_WRONGSTATE,
               "There are no bodies: call ControllerAddBody() or ControllerSetFromOptions() first");
    PetscCall(ContactCreate(PetscObjectComm((PetscObject)controller), &controller->contact));
    PetscCall(ContactSetBodies(controller->contact, controller->n_bodies, controller->bodies));
  }
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

.seealso: `Controller`, `ControllerSetTimes()`
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
