/* Substeps of a nonlinear body that one of several ranks makes without the others.

   Norms in Newton's method take all ranks of the body's communicator: bodies on different ranks would be integrated one after the other. So
   the rank that has the body has a TSALPHA2 of its own, with the same equations and options. Its vectors lend their arrays to vectors laid
   out as the body's. Numbers, and their order, are those of the TS of the body.

   The TS of the body makes the first substep, in which PETSc makes what takes all ranks, and those in which rows are prescribed, or in
   which other ranks have rows and forces have not been brought before the step (body/rows/exchange.c). */
#include "implicitimpl.h"

#define LENT 4 /* at most so many vectors at a time */

struct _BodyOwnStep {
  TS               ts;         /* NULL on ranks that have nothing of the body */
  Vec              u, v;       /* what it steps, with the arrays of the state */
  Vec              lent[LENT]; /* laid out as those of the body */
  BodyResidualFn  *residual;
  BodyPredictorFn *predictor;
};

/* The arrays of n vectors of this rank, to vectors laid out as those of the body; those from `written` on are to be written too */
static PetscErrorCode Lend(struct _BodyOwnStep *own, PetscInt n, PetscInt written, const Vec vecs[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    const PetscScalar *read  = NULL;
    PetscScalar       *write = NULL;

    if (k < written) PetscCall(VecGetArrayRead(vecs[k], &read));
    else PetscCall(VecGetArray(vecs[k], &write));
    PetscCall(VecPlaceArray(own->lent[k], write ? write : read));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TakeBack(struct _BodyOwnStep *own, PetscInt n, PetscInt written, const Vec vecs[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    PetscCall(VecResetArray(own->lent[k]));
    if (k < written) PetscCall(VecRestoreArrayRead(vecs[k], NULL));
    else PetscCall(VecRestoreArray(vecs[k], NULL));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static struct _BodyOwnStep *OwnStep(Body body)
{
  return ((BodyImplicit *)body->integrator->data)->own;
}

static PetscErrorCode ComputeResidual(TS ts, PetscReal t, Vec U, Vec V, Vec A, Vec F, void *ctx)
{
  struct _BodyOwnStep *own    = OwnStep((Body)ctx);
  Vec                  vecs[] = {U, V, A, F};

  PetscFunctionBegin;
  PetscCall(Lend(own, LENT, 1, vecs));
  PetscCall((*own->residual)(ts, t, own->lent[0], own->lent[1], own->lent[2], own->lent[3], ctx));
  PetscCall(TakeBack(own, LENT, 1, vecs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Predict(TS ts, Vec X0, Vec V0, Vec A0, Vec X1, void *ctx)
{
  struct _BodyOwnStep *own    = OwnStep((Body)ctx);
  Vec                  vecs[] = {X0, V0, A0, X1};

  PetscFunctionBegin;
  PetscCall(Lend(own, LENT, 2, vecs));
  PetscCall((*own->predictor)(ts, own->lent[0], own->lent[1], own->lent[2], own->lent[3], ctx));
  PetscCall(TakeBack(own, LENT, 2, vecs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyImplicitRefactor() at a displacement of the present TS, the body's or that of this rank */
PetscErrorCode BodyImplicitLinearize(Body body, Vec U)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  if (!implicit->alone) {
    PetscCall(BodyImplicitRefactor(body, U));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Lend(implicit->own, 1, 1, &U));
  PetscCall(BodyImplicitRefactor(body, implicit->own->lent[0]));
  PetscCall(TakeBack(implicit->own, 1, 1, &U));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplySolver(PC pc, Vec b, Vec x)
{
  const Vec            vecs[] = {b, x};
  struct _BodyOwnStep *own;
  Body                 body;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &body));
  own = OwnStep(body);
  PetscCall(Lend(own, 2, 1, vecs));
  PetscCall(ConstrainedSolverSolve(body->solver, own->lent[0], own->lent[1]));
  PetscCall(TakeBack(own, 2, 1, vecs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The integrator of the rank that has the body, as that of the body is */
static PetscErrorCode CreateTS(Body body, BodyNewtonFn *newton)
{
  const BodyImplicit  *implicit = (const BodyImplicit *)body->integrator->data;
  struct _BodyOwnStep *own      = implicit->own;
  const PetscInt       n        = body->mesh.owned_nodes * body->mesh.dim;
  TSAdapt              adapt;
  PetscReal            end;
  SNES                 snes;
  KSP                  ksp;
  PC                   pc;
  Mat                  J;

  PetscFunctionBegin;
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, body->mesh.dim, n, NULL, &own->u));
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, body->mesh.dim, n, NULL, &own->v));
  PetscCall(TSCreate(PETSC_COMM_SELF, &own->ts));
  PetscCall(TSSetOptionsPrefix(own->ts, ((PetscObject)body)->prefix));
  PetscCall(TSSetType(own->ts, TSALPHA2));
  PetscCall(TSAlpha2SetParams(own->ts, implicit->alpha_m, implicit->alpha_f, body->integrator->gamma, body->integrator->beta));
  PetscCall(TSGetAdapt(own->ts, &adapt));
  PetscCall(TSAdaptSetType(adapt, TSADAPTNONE));
  PetscCall(TS2SetSolution(own->ts, own->u, own->v));
  PetscCall(TSGetMaxTime(body->time.ts, &end));
  PetscCall(TSSetMaxTime(own->ts, end));
  PetscCall(TSSetExactFinalTime(own->ts, TS_EXACTFINALTIME_STEPOVER));
  PetscCall(TSSetI2Function(own->ts, NULL, ComputeResidual, body));
  PetscCall(TSSetErrorIfStepFails(own->ts, PETSC_FALSE));
  /* its solver is a shell: of the matrix it takes the size */
  PetscCall(MatMPIAIJGetSeqAIJ(implicit->matrix, &J, NULL, NULL));
  PetscCall((*newton)(body, own->ts, J, Predict));
  PetscCall(TSGetSNES(own->ts, &snes));
  PetscCall(SNESGetKSP(snes, &ksp));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCShellSetApply(pc, ApplySolver));
  PetscCall(TSSetUp(own->ts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the next substep is one rank's alone, as all ranks know */
static PetscBool IsAlone(Body body)
{
  return (PetscBool)(BodyStepsAlone(body) && body->time.stepped && (body->rows.at_home || !body->rows.global || body->rows.exchange.open));
}

/* In place of TSStep() */
static PetscErrorCode MakeStep(Body body)
{
  BodyImplicit        *implicit = (BodyImplicit *)body->integrator->data;
  struct _BodyOwnStep *own      = implicit->own;
  PetscScalar         *u, *v;

  PetscFunctionBegin;
  implicit->alone = IsAlone(body);
  if (!implicit->alone) {
    PetscCall(TSStep(body->time.ts));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!own->ts) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArray(body->state.u, &u));
  PetscCall(VecGetArray(body->state.v, &v));
  PetscCall(VecPlaceArray(own->u, u));
  PetscCall(VecPlaceArray(own->v, v));
  PetscCall(TSSecondOrderSetState(own->ts, body->state.time, body->time.step, body->state.step));
  PetscCall(TSStep(own->ts));
  PetscCall(VecResetArray(own->v));
  PetscCall(VecResetArray(own->u));
  PetscCall(VecRestoreArray(body->state.v, &v));
  PetscCall(VecRestoreArray(body->state.u, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For a body with factors of one of several ranks, whose equations `newton` sets up; collective */
PetscErrorCode BodyImplicitSetUpOwnStep(Body body, BodyResidualFn *residual, BodyPredictorFn *predictor, BodyNewtonFn *newton)
{
  BodyImplicit  *implicit = (BodyImplicit *)body->integrator->data;
  const PetscInt n        = body->mesh.owned_nodes * body->mesh.dim;

  PetscFunctionBegin;
  PetscCall(PetscNew(&implicit->own));
  implicit->own->residual  = residual;
  implicit->own->predictor = predictor;
  for (PetscInt k = 0; k < LENT; k++)
    PetscCall(VecCreateMPIWithArray(PetscObjectComm((PetscObject)body), body->mesh.dim, n, PETSC_DETERMINE, NULL, &implicit->own->lent[k]));
  if (body->mesh.is_owner) PetscCall(CreateTS(body, newton));
  body->integrator->ops.step = MakeStep;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* That which has made the last substep, or has tried; NULL where it was another rank's */
PetscErrorCode BodyImplicitGetSNES(Body body, SNES *snes)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  *snes = NULL;
  if (!implicit->alone) PetscCall(TSGetSNES(body->time.ts, snes));
  else if (implicit->own->ts) PetscCall(TSGetSNES(implicit->own->ts, snes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyImplicitDestroyOwnStep(Body body)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  if (!implicit->own) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TSDestroy(&implicit->own->ts));
  PetscCall(VecDestroy(&implicit->own->u));
  PetscCall(VecDestroy(&implicit->own->v));
  for (PetscInt k = 0; k < LENT; k++) PetscCall(VecDestroy(&implicit->own->lent[k]));
  PetscCall(PetscFree(implicit->own));
  PetscFunctionReturn(PETSC_SUCCESS);
}
