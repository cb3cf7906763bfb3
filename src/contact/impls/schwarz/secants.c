/*
   What sweeps have shown of the Jacobian of F, on top of the bodies' compliance, for bodies that are not linear. Pairs of changes dx and df
   = J dx of successive sweeps, of this controller step and of those before as long as the active set stays, correct the inverse of the
   Jacobian,

     J^{-1} F ~ J_0^{-1} (F - Y c) + X c,   c = argmin |F - Y c|,   X = (dx_1, dx_2, ...), Y = (df_1, df_2, ...),

   which is the interface quasi-Newton method with reuse (Degroote, Bathe, Vierendeels 2009), with the compliance in place of the identity.
   The newest pairs come first; those that add little to them are left out.
*/
#include "schwarzimpl.h"
#include <sys/citations.h>

/* parts of a pair that are orthogonal to the newer ones and smaller than this are noise */
#define INDEPENDENT 1e-2

PetscErrorCode SchwarzSetUpSecants(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  Secants *secants = &schwarz->secants;

  PetscFunctionBegin;
  PetscCall(ImpaktCite(CITE_SECANTS));
  PetscCall(VecDuplicateVecs(schwarz->outer.x, SCHWARZ_MAX_SECANTS, &secants->dx));
  PetscCall(VecDuplicateVecs(schwarz->outer.x, SCHWARZ_MAX_SECANTS, &secants->df));
  PetscCall(VecDuplicateVecs(schwarz->outer.x, SCHWARZ_MAX_SECANTS, &secants->basis));
  PetscCall(VecDuplicate(schwarz->outer.x, &secants->last_x));
  PetscCall(VecDuplicate(schwarz->outer.x, &secants->last_f));
  PetscCall(VecDuplicate(schwarz->outer.x, &secants->rest));
  /* a vector makes room for its norms when it gets the first one, which otherwise were in the time loop */
  for (PetscInt i = 0; i < SCHWARZ_MAX_SECANTS; i++) {
    PetscCall(VecZeroEntries(secants->dx[i]));
    PetscCall(VecZeroEntries(secants->df[i]));
    PetscCall(VecZeroEntries(secants->basis[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroySecants(Contact contact)
{
  Secants *secants = &((Schwarz *)contact->data)->secants;

  PetscFunctionBegin;
  PetscCall(VecDestroyVecs(SCHWARZ_MAX_SECANTS, &secants->dx));
  PetscCall(VecDestroyVecs(SCHWARZ_MAX_SECANTS, &secants->df));
  PetscCall(VecDestroyVecs(SCHWARZ_MAX_SECANTS, &secants->basis));
  PetscCall(VecDestroy(&secants->last_x));
  PetscCall(VecDestroy(&secants->last_f));
  PetscCall(VecDestroy(&secants->rest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes the sweep at X, which brought F, and the change since the one before it in this iteration */
static PetscErrorCode AddPair(Secants *secants, Vec X, Vec F)
{
  PetscFunctionBegin;
  if (secants->has_last) {
    const PetscInt slot = secants->next;
    PetscReal      norm;

    PetscCall(VecWAXPY(secants->dx[slot], -1, secants->last_x, X));
    PetscCall(VecWAXPY(secants->df[slot], -1, secants->last_f, F));
    PetscCall(VecNorm(secants->df[slot], NORM_2, &norm));
    if (norm > 0) {
      PetscCall(VecScale(secants->dx[slot], 1 / norm));
      PetscCall(VecScale(secants->df[slot], 1 / norm));
      secants->next = (slot + 1) % SCHWARZ_MAX_SECANTS;
      secants->n    = PetscMin(secants->n + 1, SCHWARZ_MAX_SECANTS);
    }
  }
  PetscCall(VecCopy(X, secants->last_x));
  PetscCall(VecCopy(F, secants->last_f));
  secants->has_last = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* rest = F - Y c, and c; `used` of the pairs, `which` of them, take part */
static PetscErrorCode Fit(Secants *secants, Vec F, PetscInt *used, PetscInt which[], PetscScalar c[])
{
  PetscScalar upper[SCHWARZ_MAX_SECANTS][SCHWARZ_MAX_SECANTS];
  PetscInt    n = 0;

  PetscFunctionBegin;
  for (PetscInt age = 0; age < secants->n; age++) {
    const PetscInt slot = (secants->next - 1 - age + 2 * SCHWARZ_MAX_SECANTS) % SCHWARZ_MAX_SECANTS;
    PetscReal      left;

    PetscCall(VecCopy(secants->df[slot], secants->basis[n]));
    for (PetscInt i = 0; i < n; i++) {
      PetscCall(VecDot(secants->basis[n], secants->basis[i], &upper[i][n]));
      PetscCall(VecAXPY(secants->basis[n], -upper[i][n], secants->basis[i]));
    }
    /* a norm that PETSc has kept since the vector was scaled is another one, to the last bit, than that of a vector from a checkpoint */
    PetscCall(PetscObjectStateIncrease((PetscObject)secants->basis[n]));
    PetscCall(VecNorm(secants->basis[n], NORM_2, &left));
    if (left < INDEPENDENT) continue;
    PetscCall(VecScale(secants->basis[n], 1 / left));
    upper[n][n] = left;
    which[n++]  = slot;
  }
  PetscCall(VecCopy(F, secants->rest));
  for (PetscInt i = 0; i < n; i++) {
    PetscCall(VecDot(secants->rest, secants->basis[i], &c[i]));
    PetscCall(VecAXPY(secants->rest, -c[i], secants->basis[i]));
  }
  for (PetscInt i = n - 1; i >= 0; i--) {
    for (PetscInt j = i + 1; j < n; j++) c[i] -= upper[i][j] * c[j];
    c[i] /= upper[i][i];
  }
  *used = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes what the pairs say of F out of it: the rest is for the compliance. `n` pairs `which` with factors `c` are to be added to its
   answer. */
PetscErrorCode SchwarzApplySecants(Contact contact, Vec F, Vec *rest, PetscInt *n, PetscInt which[], PetscScalar c[])
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  Vec      X;

  PetscFunctionBegin;
  PetscCall(SNESGetSolution(schwarz->outer.snes, &X));
  PetscCall(AddPair(&schwarz->secants, X, F));
  PetscCall(Fit(&schwarz->secants, F, n, which, c));
  *rest = schwarz->secants.rest;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A new iteration begins; with another active set what is known is of no use */
void SchwarzResetSecants(Contact contact, PetscBool forget)
{
  Secants *secants = &((Schwarz *)contact->data)->secants;

  secants->has_last = PETSC_FALSE;
  if (forget) secants->n = secants->next = 0;
}
