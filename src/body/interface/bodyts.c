/* The time integrator of a body, from the program and from options. */
#include <body/layout/bodyimpl.h>
#include "bodysetup.h"

/* Steps stay as they are. TSALPHA2's own default is the implicit midpoint rule; ours is Newmark's trapezoidal rule. */
static PetscErrorCode SetDefaults(Body body)
{
  PetscBool alpha2;
  TSAdapt   adapt;

  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare((PetscObject)body->ts, TSALPHA2, &alpha2));
  if (alpha2) PetscCall(TSAlpha2SetParams(body->ts, 1, 1, 0.5, 0.25));
  PetscCall(TSGetAdapt(body->ts, &adapt));
  PetscCall(TSAdaptSetType(adapt, TSADAPTNONE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckType(Body body, TSType type)
{
  const char *const known[] = {TSALPHA2, TSCENTRALDIFFERENCE, TSSTATIC};
  PetscBool         same    = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 3 && !same; i++) PetscCall(PetscStrcmp(type, known[i], &same));
  PetscCheck(same, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_UNKNOWN_TYPE,
             "Unknown -%sts_type '%s'; known: alpha2 (implicit), centraldifference (explicit), static (without inertia)",
             ((PetscObject)body)->prefix, type);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetTSType - chooses the time integrator

  Collective

  Input Parameters:
+ body - the `Body`, not yet set up
- type - `TSALPHA2` (implicit, the default: Newmark's trapezoidal rule), `TSCENTRALDIFFERENCE` (explicit), or `TSSTATIC` (without
         inertia)

  Options Database Key:
. -<body>_ts_type (alpha2|centraldifference|static) - the integrator

  Level: beginner

  Note:
  The parameters of `TSALPHA2` may be changed after that: `BodyGetTS()`, `TSAlpha2SetParams()`.

.seealso: `Body`, `BodyGetTS()`, `BodySetTimeStep()`, `TSALPHA2`, `TSCENTRALDIFFERENCE`, `TSSTATIC`
@*/
PetscErrorCode BodySetTSType(Body body, TSType type)
{
  PetscBool same = PETSC_FALSE;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(type, 2);
  PetscCheck(!body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Body '%s': call before BodySetUp()",
             body->hdr.name);
  PetscCall(CheckType(body, type));
  if (body->ts) PetscCall(PetscObjectTypeCompare((PetscObject)body->ts, type, &same));
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->ts) {
    PetscCall(TSCreate(PetscObjectComm((PetscObject)body), &body->ts));
    PetscCall(TSSetOptionsPrefix(body->ts, ((PetscObject)body)->prefix));
  }
  if (body->dm) PetscCall(TSSetDM(body->ts, body->dm));
  PetscCall(TSSetType(body->ts, type));
  PetscCall(SetDefaults(body));
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
  if (!body->ts) PetscCall(BodySetTSType(body, TSALPHA2));
  *ts = body->ts;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetTimeStep - sets the substep

  Logically Collective

  Input Parameters:
+ body - the `Body`, not yet set up
- step - [s], of which the controller step must be a multiple; `PETSC_DETERMINE`: 0.9 of the stable explicit step, or less to divide
         the controller step; 0 (default): the controller step

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
  PetscCheck(!body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Body '%s': call before BodySetUp()",
             body->hdr.name);
  PetscCheck(step >= 0 || step == (PetscReal)PETSC_DETERMINE, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_OUTOFRANGE,
             "Body '%s': a time step of %g s must not be negative", body->hdr.name, (double)step);
  body->requested_step = step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* -<body>_ts_time_step takes a word where PETSc's own option of that name takes a number */
static PetscErrorCode ReadTimeStep(Body body, PetscBool *hidden)
{
  const char *prefix = ((PetscObject)body)->prefix;
  char        text[64], full[160];
  PetscBool   set, is_auto;

  PetscFunctionBegin;
  *hidden = PETSC_FALSE;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-ts_time_step", text, sizeof(text), &set));
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrcasecmp(text, "auto", &is_auto));
  if (is_auto) {
    PetscCall(BodySetTimeStep(body, PETSC_DETERMINE));
    PetscCall(PetscSNPrintf(full, sizeof(full), "-%sts_time_step", prefix));
    PetscCall(PetscOptionsClearValue(NULL, full));
    *hidden = PETSC_TRUE;
  } else {
    PetscReal step = 0;

    PetscCall(PetscOptionsGetReal(NULL, prefix, "-ts_time_step", &step, NULL));
    PetscCheck(step > 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT, "-%sts_time_step %s: a time step must be positive",
               prefix, text);
    PetscCall(BodySetTimeStep(body, step));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Type, substep and parameters; what the program has chosen holds where the options are silent */
PetscErrorCode BodySetTimeFromOptions(Body body)
{
  const char *prefix = ((PetscObject)body)->prefix;
  char        type[64], full[160];
  PetscBool   hidden, set;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-ts_type", type, sizeof(type), &set));
  if (set || !body->ts) PetscCall(BodySetTSType(body, set ? type : TSALPHA2));
  PetscCall(TSSetDM(body->ts, body->dm));
  PetscCall(ReadTimeStep(body, &hidden));
  PetscCall(TSSetFromOptions(body->ts));
  if (hidden) {
    PetscCall(PetscSNPrintf(full, sizeof(full), "-%sts_time_step", prefix));
    PetscCall(PetscOptionsSetValue(NULL, full, "auto"));
    PetscCall(PetscOptionsHasName(NULL, prefix, "-ts_time_step", NULL)); /* it has been used */
  }
  PetscCall(BodySetUpIntegrator(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the TS, of whatever type it has become, means to the body */
PetscErrorCode BodySetUpIntegrator(Body body)
{
  MPI_Comm    comm   = PetscObjectComm((PetscObject)body);
  const char *prefix = ((PetscObject)body)->prefix;
  TSType      type;
  TS          ts = NULL;
  DM          dm;

  PetscFunctionBegin;
  PetscCall(BodyGetTS(body, &ts));
  PetscCall(TSGetType(ts, &type));
  PetscCall(CheckType(body, type));
  PetscCall(TSGetDM(ts, &dm));
  if (dm != body->dm) PetscCall(TSSetDM(ts, body->dm));
  PetscCall(PetscStrcmp(type, TSCENTRALDIFFERENCE, &body->is_explicit));
  PetscCall(PetscStrcmp(type, TSSTATIC, &body->is_static));
  if (body->is_explicit) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TSAlpha2GetParams(ts, &body->alpha_m, &body->alpha_f, &body->gamma, &body->beta));
  if (body->is_static)
    PetscCheck(body->alpha_m == 1 && body->alpha_f == 1, comm, PETSC_ERR_USER_INPUT,
               "-%sts_alpha_...: a static body has no parameters of time integration; leave them out", prefix);
  PetscCheck(body->beta > 0 && body->alpha_f > 0 && body->alpha_m > 0 && body->gamma > 0, comm, PETSC_ERR_USER_INPUT,
             "-%sts_alpha_...: alpha_m %g, alpha_f %g, gamma %g, beta %g must be positive; for the explicit scheme (beta = 0) choose "
             "-%sts_type centraldifference",
             prefix, (double)body->alpha_m, (double)body->alpha_f, (double)body->gamma, (double)body->beta, prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}
