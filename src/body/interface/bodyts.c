/* The time integrator of a body, from the program and from options. */
#include <body/layout/bodyimpl.h>
#include "bodysetup.h"
#include <sys/optionstext.h>
#include <sys/sharedoptions.h>
#include <strings.h>

/* Stable step of a body over the time of a plane wave through its mean element: 0.77 of cubes and squares with Poisson's ratio 0.25 */
#define STABLE_PART 0.77

/*@
  BodySetTSType - chooses the time integrator

  Collective

  Input Parameters:
+ body - the `Body`, not yet set up
- type - `TSALPHA2` (implicit, the default: Newmark's trapezoidal rule), `TSCENTRALDIFFERENCE` (explicit), `TSSTATIC` (without
         inertia), or `TSRIGID` (see `BodySetRigid()`)

  Options Database Key:
. -<body>_ts_type (alpha2|centraldifference|static|rigid) - the integrator

  Level: beginner

  Note:
  The parameters of `TSALPHA2` may be changed after that: `BodyGetTS()`, `TSAlpha2SetParams()`.

.seealso: `Body`, `BodyGetTS()`, `BodySetTimeStep()`, `TSALPHA2`, `TSCENTRALDIFFERENCE`, `TSSTATIC`
@*/
PetscErrorCode BodySetTSType(Body body, TSType type)
{
  PetscBool same = PETSC_FALSE;
  TSAdapt   adapt;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(type, 2);
  BodyCheckNotSetUp(body);
  if (body->time.ts) PetscCall(PetscObjectTypeCompare((PetscObject)body->time.ts, type, &same));
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyIntegratorCreate(body, type));
  if (!body->time.ts) {
    PetscCall(TSCreate(PetscObjectComm((PetscObject)body), &body->time.ts));
    PetscCall(TSSetOptionsPrefix(body->time.ts, ((PetscObject)body)->prefix));
  }
  if (body->mesh.dm) PetscCall(TSSetDM(body->time.ts, body->mesh.dm));
  PetscCall(TSSetType(body->time.ts, type));
  PetscCall(TSGetAdapt(body->time.ts, &adapt));
  PetscCall(TSAdaptSetType(adapt, TSADAPTNONE)); /* substeps stay as they are */
  if (body->integrator->ops.setdefaults) PetscCall((*body->integrator->ops.setdefaults)(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetTS - the time integrator

  Collective where the body has none yet

  Input Parameter:
. body - the `Body`

  Output Parameter:
. ts - its `TS`, owned by the body; until it is set up, its parameters may be changed

  Level: intermediate

.seealso: `Body`, `BodySetTSType()`
@*/
PetscErrorCode BodyGetTS(Body body, TS *ts)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(ts, 2);
  if (!body->time.ts) PetscCall(BodySetTSType(body, TSALPHA2));
  *ts = body->time.ts;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetTimeStep - sets the substep

  Logically Collective

  Input Parameters:
+ body - the `Body`, not yet set up
- step - [s], of which the controller step must be a multiple; `PETSC_DETERMINE`: 0.9 of the stable explicit step, or less to divide
         the controller step; 0 (default): the controller step, but as `PETSC_DETERMINE` for an explicit body that is unstable in it

  Options Database Key:
. -<body>_ts_time_step (auto|dt) - the substep

  Level: beginner

.seealso: `Body`, `BodyGetSubsteps()`, `BodyGetStableStep()`, `ControllerSetTimes()`
@*/
PetscErrorCode BodySetTimeStep(Body body, PetscReal step)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidLogicalCollectiveReal(body, step, 2);
  BodyCheckNotSetUp(body);
  PetscCheck(step >= 0 || step == (PetscReal)PETSC_DETERMINE, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_OUTOFRANGE,
             "Body '%s': a time step of %g s must not be negative", body->hdr.name, (double)step);
  body->time.requested_step = step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The time of the saved state [s] */
PetscErrorCode BodyGetStartTime(Body body, PetscReal *time)
{
  PetscFunctionBegin;
  *time = body->saved.time;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetTimeStep - the substep that has been asked for

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. step - as given to `BodySetTimeStep()` [s]

  Level: intermediate

.seealso: `Body`, `BodySetTimeStep()`, `BodyGetSubsteps()`
@*/
PetscErrorCode BodyGetTimeStep(Body body, PetscReal *step)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(step, 2);
  *step = body->time.requested_step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Expected substeps of an explicit body in a controller step; 1 for others. `transit`: of a plane wave through its mean element [s]. */
PetscErrorCode BodyEstimateSubsteps(Body body, PetscReal transit, PetscReal step, PetscInt *substeps)
{
  PetscBool is_explicit;
  PetscReal substep;

  PetscFunctionBegin;
  *substeps = 1;
  PetscCall(BodyIsExplicit(body, &is_explicit));
  if (!is_explicit || !(transit > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  substep = body->time.requested_step;
  if (substep <= 0) substep = step <= STABLE_PART * transit && substep == 0 ? step : 0.9 * STABLE_PART * transit;
  if (step / substep < 0.5 * PETSC_INT_MAX) *substeps = PetscMax(1, (PetscInt)PetscCeilReal(step / substep * (1 - 1e-6)));
  else *substeps = PETSC_INT_MAX / 2;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As given to BodySetControllerStep() [s]; 0: not yet known */
PetscErrorCode BodyGetControllerStep(Body body, PetscReal *step)
{
  PetscFunctionBegin;
  *step = body->time.whole_step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a body without Newton's method has the option as all bodies have it, some of which make one */
static PetscErrorCode IsForOthers(PetscInt n, const Body bodies[], const char name[], const char value[], const char rest[],
                                  PetscBool *others)
{
  char shared[PETSC_MAX_OPTION_NAME];

  PetscFunctionBegin;
  *others = PETSC_FALSE;
  PetscCall(OptionsFindShared(name + 1, value, shared, sizeof(shared)));
  for (PetscInt b = 0; b < n && shared[0] && !*others; b++) {
    char option[PETSC_MAX_OPTION_NAME];

    PetscCall(PetscSNPrintf(option, sizeof(option), "-%s", rest));
    if (bodies[b]->integrator->uses_newton) PetscCall(PetscOptionsHasName(NULL, ((PetscObject)bodies[b])->prefix, option, others));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error if the option is one of Newton's method of a body that makes none. Bodies are looked at for such options alone. */
static PetscErrorCode CheckNewtonOption(PetscInt n, const Body bodies[], const char name[], const char value[])
{
  char lower[PETSC_MAX_OPTION_NAME], *found;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(lower, name, sizeof(lower)));
  PetscCall(PetscStrtolower(lower));
  PetscCall(PetscStrstr(lower, "snes_", &found));
  if (!found) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < n; b++) {
    Body        body   = bodies[b];
    const char *prefix = ((PetscObject)body)->prefix;
    char        first[128];
    PetscBool   others;

    PetscCall(PetscSNPrintf(first, sizeof(first), "-%ssnes_", prefix));
    if (body->integrator->uses_newton || strncasecmp(name, first, strlen(first)) != 0) continue;
    PetscCall(IsForOthers(n, bodies, name, value, name + 1 + strlen(prefix), &others));
    PetscCheck(others, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
               "%s has no effect: body '%s' is explicit, rigid or of a linear material, and needs no Newton's method in its steps; leave "
               "it out, or choose -%smaterial_type neo_hookean and -%sts_type alpha2",
               name, body->hdr.name, prefix, prefix);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes an error of options of Newton's method that bodies have no use for: a TS reads the options of its SNES in any case. All bodies
   are checked together, since PetscOptionsGetAll() takes time in proportion to the square of the number of options. Collective. */
PetscErrorCode BodyRefuseNewtonOptions(PetscInt n, const Body bodies[])
{
  const char *name, *value;
  char       *all, *text;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  for (text = all; OptionsTextNext(&text, &name, &value);) PetscCall(CheckNewtonOption(n, bodies, name, value));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The integrator for the TS, whose type and parameters the program may have changed, with these parameters */
PetscErrorCode BodySetUpIntegrator(Body body)
{
  PetscBool same;
  TSType    type;
  TS        ts = NULL;
  DM        dm;

  PetscFunctionBegin;
  PetscCall(BodyGetTS(body, &ts));
  PetscCall(TSGetType(ts, &type));
  PetscCall(PetscStrcmp(type, body->integrator->type, &same));
  if (!same) PetscCall(BodyIntegratorCreate(body, type));
  PetscCall(TSGetDM(ts, &dm));
  if (dm != body->mesh.dm) PetscCall(TSSetDM(ts, body->mesh.dm));
  if (body->integrator->ops.getparameters) PetscCall((*body->integrator->ops.getparameters)(body));
  if (body->model.material) PetscCall(BodyIsLinear(body, &body->model.linear));
  PetscFunctionReturn(PETSC_SUCCESS);
}
