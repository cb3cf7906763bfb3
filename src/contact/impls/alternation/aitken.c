/* Aitken's relaxation for nrichardson, as a line search: x <- x - theta F with theta from the last two residuals. */
#include "alternationimpl.h"

static PetscErrorCode ApplyAitken(SNESLineSearch line_search, void *ctx)
{
  Contact      contact     = (Contact)ctx;
  Alternation *alternation = (Alternation *)contact->data;
  PetscReal    first, fnorm, xnorm, ynorm;
  Vec          X, F, Y, W;
  SNES         snes;
  PetscInt     it;

  PetscFunctionBegin;
  PetscCall(SNESLineSearchGetVecs(line_search, &X, &F, &Y, &W, NULL));
  PetscCall(SNESLineSearchGetSNES(line_search, &snes));
  PetscCall(SNESLineSearchGetDamping(line_search, &first));
  PetscCall(SNESGetIterationNumber(snes, &it));
  if (it == 0) alternation->damping = first;
  else {
    PetscScalar dot, square;

    PetscCall(VecAYPX(alternation->last_residual, -1, F)); /* F - last F */
    PetscCall(VecDot(alternation->last_residual, alternation->last_residual, &square));
    PetscCall(VecCopy(F, W));
    PetscCall(VecAXPY(W, -1, alternation->last_residual)); /* last F */
    PetscCall(VecDot(W, alternation->last_residual, &dot));
    if (square > 0) alternation->damping *= -dot / square;
    if (alternation->damping == 0) alternation->damping = first;
  }
  PetscCall(VecCopy(F, alternation->last_residual));
  PetscCall(VecNorm(Y, NORM_2, &ynorm));
  PetscCall(VecAXPY(X, -alternation->damping, Y));
  PetscCall(SNESComputeFunction(snes, X, F));
  PetscCall(VecNorm(F, NORM_2, &fnorm));
  PetscCall(VecNorm(X, NORM_2, &xnorm));
  PetscCall(SNESLineSearchSetNorms(line_search, xnorm, fnorm, PetscAbsReal(alternation->damping) * ynorm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts Aitken's relaxation in place of the fixed one */
PetscErrorCode AlternationSetUpAitken(Contact contact)
{
  Alternation   *alternation = (Alternation *)contact->data;
  SNESLineSearch line_search;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(alternation->x, &alternation->last_residual));
  PetscCall(SNESGetLineSearch(alternation->snes, &line_search));
  PetscCall(SNESLineSearchSetType(line_search, SNESLINESEARCHSHELL));
  PetscCall(SNESLineSearchShellSetApply(line_search, ApplyAitken, contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
