/* The SNES of the sweeps: a fixed-point iteration, accelerated or relaxed. */
#include "alternationimpl.h"

/* Most iterations: plain alternation of impedance conditions takes up to 41 in the paper's impacts; and evaluations, more than needed. */
#define MAX_ITERATIONS  50
#define MAX_EVALUATIONS 1000000
/* Relative tolerance on positions: round-off of their sums, so that it is the absolute one that counts but far from the origin */
#define POSITION_RTOL 1e-15

/* Type and relaxation, as the options have them. Anderson's mixing 1/2 and eight vectors suit an iteration with a gain of about -1, which
   is that of the Dirichlet-Neumann alternation between equal bodies. PETSc has no setter: they are options for a while. */
static PetscErrorCode SetFromOptions(Contact contact, SNES snes)
{
  static const char *const defaults[][2] = {{"-schwarz_snes_anderson_beta", "0.5"}, {"-schwarz_snes_anderson_m", "8"}};
  PetscBool                given[PETSC_STATIC_ARRAY_LENGTH(defaults)];

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(defaults); i++) {
    PetscCall(PetscOptionsHasName(NULL, NULL, defaults[i][0], &given[i]));
    if (!given[i]) PetscCall(PetscOptionsSetValue(NULL, defaults[i][0], defaults[i][1]));
  }
  PetscCall(ContactSetOuterFromOptions(contact, snes, SNESANDERSON));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(defaults); i++)
    if (!given[i]) PetscCall(PetscOptionsClearValue(NULL, defaults[i][0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Aitken's relaxation for nrichardson, as a line search: x <- x - theta F with theta from the last two residuals */
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

/* The outer iteration, of so many unknowns on this rank */
PetscErrorCode AlternationSetUpOuterSolver(Contact contact, PetscInt unknowns)
{
  Alternation   *alternation = (Alternation *)contact->data;
  MPI_Comm       comm        = PetscObjectComm((PetscObject)contact);
  PetscBool      richardson, damping_set;
  SNESLineSearch line_search;

  PetscFunctionBegin;
  PetscCall(VecCreate(comm, &alternation->x));
  PetscCall(VecSetSizes(alternation->x, unknowns, PETSC_DETERMINE));
  PetscCall(VecSetType(alternation->x, VECSTANDARD));
  PetscCall(VecDuplicate(alternation->x, &alternation->residual));
  PetscCall(SNESCreate(comm, &alternation->snes));
  PetscCall(SNESSetFunction(alternation->snes, alternation->residual, AlternationSweep, contact));
  PetscCall(SNESSetTolerances(alternation->snes, CONTACT_POSITION_TOLERANCE * contact->scale.length, POSITION_RTOL, 0, MAX_ITERATIONS,
                              MAX_EVALUATIONS));
  PetscCall(SetFromOptions(contact, alternation->snes));
  PetscCall(SNESGetTolerances(alternation->snes, &alternation->atol, &alternation->rtol, NULL, NULL, NULL));
  PetscCall(SNESSetConvergenceTest(alternation->snes, AlternationTestConvergence, contact, NULL));
  PetscCall(PetscObjectTypeCompare((PetscObject)alternation->snes, SNESNRICHARDSON, &richardson));
  if (alternation->relaxation == SCHWARZ_RELAXATION_AITKEN) {
    PetscCheck(richardson, comm, PETSC_ERR_USER_INPUT, "-schwarz_relaxation aitken goes with -schwarz_snes_type nrichardson only");
    PetscCall(PetscOptionsHasName(NULL, "schwarz_", "-snes_linesearch_damping", &damping_set));
    PetscCall(VecDuplicate(alternation->x, &alternation->last_residual));
    PetscCall(SNESGetLineSearch(alternation->snes, &line_search));
    PetscCall(SNESLineSearchSetType(line_search, SNESLINESEARCHSHELL));
    PetscCall(SNESLineSearchShellSetApply(line_search, ApplyAitken, contact));
    if (!damping_set) PetscCall(SNESLineSearchSetDamping(line_search, 0.5));
  }
  alternation->by_mismatch = (PetscBool)(!richardson || alternation->relaxation != SCHWARZ_RELAXATION_FIXED);
  PetscFunctionReturn(PETSC_SUCCESS);
}
