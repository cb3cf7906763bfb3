/* A body under TSSTATIC: static balance at the end of each substep. Its velocity, by differences, is for contact; no acceleration. */
#include "implicitimpl.h"

/* F = internal force - forces from outside and of contact, with held dofs and prescribed rows projected out */
static PetscErrorCode ComputeResidual(TS ts, PetscReal t, Vec U, Vec V, Vec A, Vec F, void *ctx)
{
  Body body = (Body)ctx;

  PetscFunctionBegin;
  (void)ts;
  (void)V;
  (void)A;
  if (!body->state.force_known) PetscCall(BodyComputeInternalForce(body, U, body->state.internal_force));
  PetscCall(VecZeroEntries(F));
  PetscCall(BodyAddSpringForce(body, U, F));
  PetscCall(BodyImplicitAddForces(body, t, U, F));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* First iterate of a nonlinear body: the last displacement with held dofs and prescribed rows in place, and what they do to it */
static PetscErrorCode Predict(TS ts, Vec X0, Vec V0, Vec A0, Vec X1, void *ctx)
{
  Body body = (Body)ctx;

  PetscFunctionBegin;
  (void)ts;
  (void)V0;
  ((BodyImplicit *)body->integrator->data)->iterated = PETSC_FALSE;
  PetscCall(VecCopy(body->state.a, A0));
  PetscCall(VecCopy(X0, X1));
  PetscCall(BodyImplicitPrescribe(body, X1));
  PetscCall(BodyImplicitCarry(body, ComputeResidual, X0, X1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A substep of a nonlinear body: with whole steps of Newton's method, or else with steps that make the residual less */
static PetscErrorCode MakeSubstep(Body body)
{
  SNES                snes;
  SNESLineSearch      line_search;
  SNESConvergedReason reason;
  PetscReal           whole;
  PetscBool           backtracks;

  PetscFunctionBegin;
  PetscCall(TSStep(body->time.ts));
  PetscCall(TSGetSNES(body->time.ts, &snes));
  PetscCall(SNESGetConvergedReason(snes, &reason));
  PetscCall(SNESGetLineSearch(snes, &line_search));
  PetscCall(PetscObjectTypeCompare((PetscObject)line_search, SNESLINESEARCHBT, &backtracks));
  if (reason >= 0 || !backtracks || body->time.substeps > 1) PetscFunctionReturn(PETSC_SUCCESS);
  (void)ConstrainedSolverTakeFailure(body->solver);
  StepFailureClear(&body->failure);
  PetscCall(BodyRestore(body));
  PetscCall(BodyHistoryBegin(body));
  PetscCall(SNESLineSearchBTGetAlpha(line_search, &whole));
  PetscCall(SNESLineSearchBTSetAlpha(line_search, BODY_STATIC_DESCENT));
  PetscCall(TSStep(body->time.ts));
  PetscCall(SNESLineSearchBTSetAlpha(line_search, whole));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GetParameters(Body body)
{
  BodyImplicit  *implicit   = (BodyImplicit *)body->integrator->data;
  BodyIntegrator integrator = body->integrator;

  PetscFunctionBegin;
  PetscCall(TSAlpha2GetParams(body->time.ts, &implicit->alpha_m, &implicit->alpha_f, &integrator->gamma, &integrator->beta));
  PetscCheck(implicit->alpha_m == 1 && implicit->alpha_f == 1 && integrator->gamma > 0 && integrator->beta > 0,
             PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sts_alpha_...: a static body has no parameters of time integration; leave them out", ((PetscObject)body)->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp(Body body)
{
  PetscFunctionBegin;
  PetscCheck(!body->springs.n || body->time.substeps == 1, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "Body '%s' is static, and contact or ties alone hold it: they do at the ends of steps that all bodies share, and not in the "
             "course of %" PetscInt_FMT " substeps; set -%sts_time_step to -time_step, or prescribe displacements",
             body->hdr.name, body->time.substeps, ((PetscObject)body)->prefix);
  PetscCall(BodyImplicitSetUp(body, ComputeResidual, Predict));
  if (!body->model.linear) body->integrator->ops.step = MakeSubstep;
  for (PetscInt k = 0; k < 4 && !body->model.linear; k++)
    PetscCall(BodyCreateVec(body, &((BodyImplicit *)body->integrator->data)->lead[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The velocity is the mean of the substep */
static PetscErrorCode FinishSubstep(Body body)
{
  PetscFunctionBegin;
  PetscCall(VecWAXPY(body->state.v, -1, body->substep_start.u, body->state.u));
  PetscCall(VecScale(body->state.v, 1 / body->time.step));
  PetscCall(VecZeroEntries(body->state.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Repeat(Body body, const PetscScalar force[], const PetscScalar displacement[])
{
  PetscFunctionBegin;
  (void)force; /* which the solver has been brought */
  PetscCall(BodyImplicitCorrect(body, displacement, 1, 1 / body->time.step, 0, body->work.nodes[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyIntegratorCreate_Static(BodyIntegrator integrator)
{
  PetscFunctionBegin;
  PetscCall(BodyImplicitCreate(integrator));
  integrator->affine            = PETSC_TRUE;
  integrator->ops.getparameters = GetParameters;
  integrator->ops.setup         = SetUp;
  integrator->ops.finishsubstep = FinishSubstep;
  integrator->ops.repeat        = Repeat;
  integrator->ops.save          = BodyResetSprings; /* they are at rest where the body starts from */
  PetscFunctionReturn(PETSC_SUCCESS);
}
