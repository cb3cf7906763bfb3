/* Substeps, and the TS of a body. */
#include <body/layout/bodyimpl.h>

/* What -<body>_ts_time_step auto takes of the stable step, that of the undeformed body: a nonlinear one may stiffen */
#define SAFETY 0.9
/* Quotients and steps that agree to this part, relative, differ by round-off */
#define ROUND_OFF 1e-12
/* A substep given as 3.333333e-7 for a third of 1e-6 divides the controller step if it misses by this part at most */
#define DIVIDES 1e-6
/* More substeps to a controller step are a mistake, and overflow integers */
#define MAX_SUBSTEPS 1e9
/* For TSSetMaxTime() [s]: no end, since the controller has one; PETSc takes PETSC_MAX_REAL for a time that was not set */
#define NO_END (0.5 * PETSC_MAX_REAL)

/* Whether the body chooses its substep: where told to or, explicit and told nothing, where one step is unstable. A controller step
   between 0.9 times the stable step and the stable step stays one. Ties whose nodes keep their mass have been made for one step. */
static PetscBool ChoosesSubstep(Body body)
{
  if (body->time.requested_step != 0 || body->rows.tied_mass) return (PetscBool)(body->time.requested_step < 0);
  return (PetscBool)(body->integrator->needs_stable_step && body->time.controller_step > body->time.stable_step * (1 + ROUND_OFF));
}

PetscErrorCode BodySetUpSubsteps(Body body)
{
  MPI_Comm    comm   = PetscObjectComm((PetscObject)body);
  const char *prefix = ((PetscObject)body)->prefix;

  PetscFunctionBegin;
  PetscCheck(body->time.controller_step > 0, comm, PETSC_ERR_ARG_WRONGSTATE, "Call BodySetControllerStep() first");
  if (body->integrator->needs_stable_step || body->time.requested_step < 0) PetscCall(BodyComputeStableStep(body));
  if (ChoosesSubstep(body)) {
    PetscCheck(body->time.controller_step / (SAFETY * body->time.stable_step) < MAX_SUBSTEPS, comm, PETSC_ERR_USER_INPUT,
               "The stable step of body '%s', %.6g s, is too small for the controller step -time_step %g s", body->hdr.name,
               (double)body->time.stable_step, (double)body->time.controller_step);
    /* a quotient that is a whole number but for round-off is not rounded up to the next one */
    body->time.substeps = (PetscInt)PetscCeilReal(body->time.controller_step / (SAFETY * body->time.stable_step) * (1 - ROUND_OFF));
  } else {
    const PetscReal step = body->time.requested_step > 0 ? body->time.requested_step : body->time.controller_step;

    PetscCheck(body->time.controller_step / step < MAX_SUBSTEPS, comm, PETSC_ERR_USER_INPUT,
               "-%sts_time_step %g s is too small for the controller step -time_step %g s", prefix, (double)step,
               (double)body->time.controller_step);
    body->time.substeps = (PetscInt)PetscFloorReal(0.5 + body->time.controller_step / step);
    PetscCheck(
        body->time.substeps > 0 &&
            PetscAbsReal(body->time.substeps * step - body->time.controller_step) <= DIVIDES * body->time.controller_step,
        comm, PETSC_ERR_USER_INPUT,
        "-%sts_time_step %g s does not divide the controller step -time_step %g s (ratio %.9g); choose a whole fraction of it, or 'auto'",
        prefix, (double)step, (double)body->time.controller_step, (double)(body->time.controller_step / step));
  }
  body->time.step = body->time.controller_step / body->time.substeps;
  if (body->integrator->needs_stable_step)
    PetscCheck(body->time.step <= body->time.stable_step * (1 + ROUND_OFF), comm, PETSC_ERR_USER_INPUT,
               "-%sts_time_step %g s of the explicit body '%s' is larger than its stable step, %.6g s; choose a smaller one, or 'auto'",
               prefix, (double)body->time.step, body->hdr.name, (double)body->time.stable_step);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The TS, on the state's vectors, at the start time */
PetscErrorCode BodySetUpTime(Body body)
{
  TSAdapt   adapt;
  PetscBool none;

  PetscFunctionBegin;
  PetscCall(TS2SetSolution(body->time.ts, body->state.u, body->state.v));
  PetscCall(TSGetAdapt(body->time.ts, &adapt));
  PetscCall(PetscObjectTypeCompare((PetscObject)adapt, TSADAPTNONE, &none));
  PetscCheck(none, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sts_adapt_type: adaptive substeps within a controller step are not supported; leave it at none",
             ((PetscObject)body)->prefix);
  PetscCall(TSSetMaxTime(body->time.ts, NO_END));
  PetscCall(TSSetExactFinalTime(body->time.ts, TS_EXACTFINALTIME_STEPOVER));
  PetscCall((*body->integrator->ops.setup)(body));
  PetscCall(TSSetUp(body->time.ts));
  body->state.time = body->time.start;
  body->state.step = 0;
  PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  PetscFunctionReturn(PETSC_SUCCESS);
}
