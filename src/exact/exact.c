/* The class: package, creation, what all types of solution tell, view, destruction. */
#include "exactimpl.h"
#include "exactvisit.h"
#include <sys/package.h>
#include <math.h>
#include <sys/names.h>
#include <sys/units.h>

PetscClassId EXACT_CLASSID = 0;

static const struct {
  ExactType type;
  PetscErrorCode (*create)(Controller, Exact);
} Types[] = {
    {EXACT_IMPACT, ExactCreate_Impact},
    {EXACT_CHARACTERISTICS, ExactCreate_Characteristics},
};

PetscErrorCode ExactInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Exact", &EXACT_CLASSID, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactCreate - an exact solution for the bodies of a controller, in their initial state

  Collective

  Input Parameters:
+ controller - the `Controller`, set up, before its first step
- type       - its name, see `ExactType`

  Output Parameter:
. exact - the solution

  Options Database Key:
. -exact (none|impact|characteristics) - compare the run with it

  Level: intermediate

  Note:
  Ends with an error that gives the reason if it is not the solution for these bodies: if there are more than two, if they do not approach
  each other or are deformed at the start, or if they do not meet what the type demands.

.seealso: `Exact`, `ExactEvaluate()`, `ExactMonitor()`
@*/
PetscErrorCode ExactCreate(Controller controller, ExactType type, Exact *exact)
{
  MPI_Comm       comm       = PetscObjectComm((PetscObject)controller);
  char           known[256] = "none";
  PetscInt       found      = -1;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(type, 2);
  PetscAssertPointer(exact, 3);
  PetscCall(ExactInitializePackage());
  for (PetscInt i = 0; i < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(Types); i++) {
    PetscBool same;

    PetscCall(PetscStrcmp(type, Types[i].type, &same));
    if (same) found = i;
    PetscCall(NamesAppend(known, sizeof(known), " ", Types[i].type));
  }
  PetscCheck(found >= 0, comm, PETSC_ERR_USER_INPUT, "Unknown -exact '%s'; known: %s", type, known);
  PetscCall(PetscHeaderCreate(*exact, EXACT_CLASSID, "Exact", "Exact solution", "Exact", comm, ExactDestroy, ExactView));
  PetscCall(PetscObjectChangeTypeName((PetscObject)*exact, Types[found].type));
  (*exact)->type         = Types[found].type;
  (*exact)->last_contact = NAN;
  error                  = ExactSetUpBars(*exact, controller);
  if (!error) {
    (*exact)->last_time = (*exact)->start;
    error               = (*Types[found].create)(controller, *exact);
  }
  if (error) (void)ExactDestroy(exact); /* nothing is left to be freed by the caller */
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactGetType - the kind of exact solution

  Not Collective

  Input Parameter:
. exact - the `Exact`

  Output Parameter:
. type - its name

  Level: intermediate

.seealso: `Exact`, `ExactType`
@*/
PetscErrorCode ExactGetType(Exact exact, ExactType *type)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(type, 2);
  *type = exact->type;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactEvaluate - the exact solution at one time

  Not Collective

  Input Parameters:
+ exact - the `Exact`
. side  - 0 for the bar on the Dirichlet side, 1 for its partner
- time  - any time of the run [s]; at a jump, or within round-off of one, the value before it is given

  Output Parameter:
. solution - see `ExactSolution`

  Level: intermediate

.seealso: `Exact`, `ExactGetTimes()`
@*/
PetscErrorCode ExactEvaluate(Exact exact, PetscInt side, PetscReal time, ExactSolution *solution)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(solution, 4);
  PetscUseTypeMethod(exact, evaluate, side, time, solution);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactGetTimes - when the bars push each other

  Not Collective

  Input Parameter:
. exact - the `Exact`

  Output Parameters:
+ impact  - first contact [s]
- release - end of the last contact force [s]; not-a-number where the run does not last until then

  Level: intermediate

.seealso: `Exact`, `ExactGetForce()`
@*/
PetscErrorCode ExactGetTimes(Exact exact, PetscReal *impact, PetscReal *release)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(impact, 2);
  PetscAssertPointer(release, 3);
  *impact  = exact->impact;
  *release = exact->release;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactGetForce - the mean of the contact force over the middle three fifths from first contact to release

  Not Collective

  Input Parameter:
. exact - the `Exact`

  Output Parameter:
. force - compression positive [N]

  Level: intermediate

.seealso: `Exact`, `ExactGetTimes()`, `ExactGetImpulse()`
@*/
PetscErrorCode ExactGetForce(Exact exact, PetscReal *force)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(force, 2);
  *force = exact->force;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactGetImpulse - the contact force integrated over time

  Not Collective

  Input Parameter:
. exact - the `Exact`

  Output Parameter:
. impulse - [N s]

  Level: intermediate

.seealso: `Exact`, `ExactGetForce()`
@*/
PetscErrorCode ExactGetImpulse(Exact exact, PetscReal *impulse)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(impulse, 2);
  *impulse = exact->impulse;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ExactGetBodies - names of the two bars

  Not Collective

  Input Parameter:
. exact - the `Exact`

  Output Parameter:
. names - two: of the bar on the Dirichlet side, and of its partner; owned by the bodies

  Level: intermediate

.seealso: `Exact`, `ExactGetErrors()`
@*/
PetscErrorCode ExactGetBodies(Exact exact, const char *names[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(names, 2);
  for (PetscInt side = 0; side < 2; side++) names[side] = exact->bars[side].name;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactView - prints the exact solution in short

  Collective

  Input Parameters:
+ exact  - the `Exact`
- viewer - an ASCII viewer, `NULL` for standard output

  Level: intermediate

.seealso: `Exact`, `ExactViewFromOptions()`
@*/
PetscErrorCode ExactView(Exact exact, PetscViewer viewer)
{
  PetscBool ascii;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)exact), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "exact solution (%s): contact of %s and %s from %g to %g%s, mean force %g%s, impulse %g%s\n",
                                   exact->type, exact->bars[0].name, exact->bars[1].name, (double)exact->impact, (double)exact->release,
                                   UnitsOf((PetscObject)exact, UNIT_TIME), (double)exact->force, UnitsOf((PetscObject)exact, UNIT_FORCE),
                                   (double)exact->impulse, UnitsOf((PetscObject)exact, UNIT_IMPULSE)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactViewFromOptions - prints the exact solution where an option asks for it

  Collective

  Input Parameters:
+ exact  - the `Exact`
. object - has the prefix of the option, `NULL` for the solution
- name   - the option

  Options Database Key:
. -exact_view - print the solution that a run is compared with

  Level: intermediate

.seealso: `Exact`, `ExactView()`, `PetscObjectViewFromOptions()`
@*/
PetscErrorCode ExactViewFromOptions(Exact exact, PetscObject object, const char name[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscCall(PetscObjectViewFromOptions((PetscObject)exact, object, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactDestroy - frees the solution

  Collective

  Input Parameter:
. exact - the `Exact`, set to `NULL`

  Level: intermediate

.seealso: `Exact`, `ExactCreate()`
@*/
PetscErrorCode ExactDestroy(Exact *exact)
{
  PetscFunctionBegin;
  if (!*exact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*exact, EXACT_CLASSID, 1);
  if (--((PetscObject)*exact)->refct > 0) {
    *exact = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscTryTypeMethod(*exact, destroy);
  PetscCall(PetscHeaderDestroy(exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ExactVisit - how far the run has been from the solution so far, to or from a checkpoint */
PetscErrorCode ExactVisit(Exact exact, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointVisitBytes(checkpoint, "distance", sizeof(exact->distance), exact->distance));
  PetscCall(CheckpointVisitReals(checkpoint, "peak potential", 1, &exact->peak_potential));
  PetscCall(CheckpointVisitReals(checkpoint, "last contact", 1, &exact->last_contact));
  PetscCall(CheckpointVisitReals(checkpoint, "last time", 1, &exact->last_time));
  PetscFunctionReturn(PETSC_SUCCESS);
}
