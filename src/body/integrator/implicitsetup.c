/* What all integrators on TSALPHA2 have in common: their operations, set-up, and what is put aside for steps that are made again. */
#include "implicitimpl.h"

/* Its rank alone knows which factors a local body has; before all ranks hold rows, all do */
static PetscErrorCode Agree(Body body)
{
  PetscFunctionBegin;
  if (!body->model.linear) PetscCall(ConstrainedSolverForgetColumns(body->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyImplicitCreate(BodyIntegrator integrator)
{
  BodyImplicit *implicit;

  PetscFunctionBegin;
  PetscCall(PetscNew(&implicit));
  integrator->data               = implicit;
  integrator->reads_start        = PETSC_TRUE;
  integrator->repeats_prescribed = PETSC_TRUE;
  integrator->repeats_by_solver  = PETSC_TRUE;
  integrator->ops.setlevel       = BodyImplicitSetLevel;
  integrator->ops.renew          = BodyImplicitRenew;
  integrator->ops.checksubstep   = BodyImplicitCheckSubstep;
  integrator->ops.agree          = Agree;
  integrator->ops.destroy        = BodyImplicitDestroy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A controller step made again has to begin with the same Jacobian: lagging it, or its factors, between substeps is refused */
static PetscErrorCode RefuseLagBetweenSubsteps(Body body)
{
  static const char *const options[] = {"-snes_lag_jacobian_persists", "-snes_lag_preconditioner_persists"};
  const char              *prefix    = ((PetscObject)body)->prefix;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 2; i++) {
    PetscBool persists = PETSC_FALSE;

    PetscCall(PetscOptionsGetBool(NULL, prefix, options[i], &persists, NULL));
    PetscCheck(!persists, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
               "-%s%s: steps are made several times, and each time must begin with the Jacobian of its own start; leave it out, since "
               "-%ssnes_lag_jacobian alone lags within a step",
               prefix, options[i] + 1, prefix);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The effective matrix and its factors, which a linear body keeps for good, and how the TS makes its steps */
PetscErrorCode BodyImplicitSetUp(Body body, BodyResidualFn *residual, BodyPredictorFn *predictor)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;
  Vec                 vec;

  PetscFunctionBegin;
  PetscCall(BodyImplicitCreateSolver(body, NULL));
  if (!body->model.linear) PetscCall(BodyImplicitComputeUnitStrainForce(body));
  PetscCall(BodyCreateVec(body, &vec));
  PetscCall(TSSetI2Function(body->time.ts, vec, residual, body));
  PetscCall(VecDestroy(&vec));
  PetscCall(TSSetErrorIfStepFails(body->time.ts, PETSC_FALSE));
  if (!body->model.linear || !body->integrator->affine || body->time.substeps > 1) body->integrator->ops.repeat = NULL;
  if (body->model.linear) PetscCall(BodyImplicitSetUpLinear(body));
  else {
    body->integrator->uses_newton = PETSC_TRUE;
    PetscCall(RefuseLagBetweenSubsteps(body));
    PetscCall(BodyImplicitSetUpNewton(body, body->time.ts, implicit->matrix, predictor));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyImplicitDestroy(Body body)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;
  Vec          *vecs[]   = {&implicit->stage_u, &implicit->stage_v, &implicit->stage_a, &implicit->stiffness};

  PetscFunctionBegin;
  for (size_t i = 0; i < sizeof(vecs) / sizeof(vecs[0]); i++) PetscCall(VecDestroy(vecs[i]));
  for (PetscInt k = 0; k < 4; k++) PetscCall(VecDestroy(&implicit->lead[k]));
  PetscCall(BodyImplicitDestroyOwnStep(body));
  for (PetscInt k = 0; k <= STEP_MAX_CUTS; k++) PetscCall(MatDestroy(&implicit->matrices[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
