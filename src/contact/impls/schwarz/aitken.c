/* Aitken's relaxation for nrichardson, as a line search: x <- x - theta F with theta from the last two residuals. */
#include "schwarzimpl.h"

static PetscErrorCode ApplyAitken(SNESLineSearch line_search, void *ctx)
{
  Contact   contact = (Contact)ctx;
  Schwarz  *schwarz = (Schwarz *)contact->data;
  PetscReal first, fnorm, xnorm, ynorm;
  Vec       X, F, Y, W;
  SNES      snes;
  PetscInt  it;

  PetscFunctionBegin;
  PetscCall(SNESLineSearchGetVecs(line_search, &X, &F, &Y, &W, NULL));
  PetscCall(SNESLineSearchGetSNES(line_search, &snes));
  PetscCall(SNESLineSearchGetDamping(line_search, &first));
  PetscCall(SNESGetIterationNumber(snes, &it));
  if (it == 0) schwarz->damping = first;
  else {
    PetscScalar dot, square;

    PetscCall(VecAYPX(schwarz->last_residual, -1, F)); /* F - last F */
    PetscCall(VecDot(schwarz->last_residual, schwarz->last_residual, &square));
    PetscCall(VecCopy(F, W));
    PetscCall(VecAXPY(W, -1, schwarz->last_residual)); /* last F */
    PetscCall(VecDot(W, schwarz->last_residual, &dot));
    if (square > 0) schwarz->damping *= -dot / square;
    if (schwarz->damping == 0) schwarz->damping = first;
  }
  PetscCall(VecCopy(F, schwarz->last_residual));
  PetscCall(VecNorm(Y, NORM_2, &ynorm));
  PetscCall(VecAXPY(X, -schwarz->damping, Y));
  PetscCall(SNESComputeFunction(snes, X, F));
  PetscCall(VecNorm(F, NORM_2, &fnorm));
  PetscCall(VecNorm(X, NORM_2, &xnorm));
  PetscCall(SNESLineSearchSetNorms(line_search, xnorm, fnorm, PetscAbsReal(schwarz->damping) * ynorm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts Aitken's relaxation in place of the fixed one */
PetscErrorCode SchwarzSetUpAitken(Contact contact)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  SNESLineSearch line_search;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(schwarz->outer.x, &schwarz->last_residual));
  PetscCall(SNESGetLineSearch(schwarz->outer.snes, &line_search));
  PetscCall(SNESLineSearchSetType(line_search, SNESLINESEARCHSHELL));
  PetscCall(SNESLineSearchShellSetApply(line_search, ApplyAitken, contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
