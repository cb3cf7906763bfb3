/* The class: creation, what all types of solution tell, destruction. */
#include "exactimpl.h"
#include <math.h>

static const struct {
  ExactType type;
  PetscErrorCode (*create)(Controller, Exact);
} Types[] = {
    {EXACT_IMPACT, ExactCreate_Impact},
    {EXACT_CHARACTERISTICS, ExactCreate_Characteristics},
};

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
  struct _n_Exact e          = {0}; /* on the stack, so that nothing is left to be freed after an error */
  char            known[256] = "none";
  PetscInt        found      = -1;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(Types); i++) {
    PetscBool same;

    PetscCall(PetscStrcmp(type, Types[i].type, &same));
    if (same) found = i;
    PetscCall(PetscStrlcat(known, " ", sizeof(known)));
    PetscCall(PetscStrlcat(known, Types[i].type, sizeof(known)));
  }
  PetscCheck(found >= 0, PetscObjectComm((PetscObject)controller), PETSC_ERR_USER_INPUT, "Unknown -exact '%s'; known: %s", type, known);
  e.type         = Types[found].type;
  e.last_contact = NAN;
  PetscCall(ExactSetUpBars(&e, controller));
  e.last_time = e.start;
  PetscCall((*Types[found].create)(controller, &e));
  PetscCall(PetscNew(exact));
  **exact = e;
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
  PetscCall((*exact->ops.evaluate)(exact, side, time, solution));
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
  for (PetscInt side = 0; side < 2; side++) names[side] = exact->bars[side].name;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactDestroy - frees the solution

  Not Collective

  Input Parameter:
. exact - the `Exact`, set to `NULL`

  Level: intermediate

.seealso: `Exact`, `ExactCreate()`
@*/
PetscErrorCode ExactDestroy(Exact *exact)
{
  PetscFunctionBegin;
  if (!*exact) PetscFunctionReturn(PETSC_SUCCESS);
  if ((*exact)->ops.destroy) PetscCall((*(*exact)->ops.destroy)(*exact));
  PetscCall(PetscFree(*exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
