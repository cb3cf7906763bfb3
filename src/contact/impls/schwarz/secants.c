/*
   What sweeps have shown of the Jacobian of F, on top of the bodies' compliance, for bodies that are not linear. Pairs of changes dx and df
   = J dx of successive sweeps, of this controller step and of those before as long as the active set stays, correct the inverse of the
   Jacobian,

     J^{-1} F ~ J_0^{-1} (F - Y c) + X c,   c = argmin |F - Y c|,   X = (dx_1, dx_2, ...), Y = (df_1, df_2, ...),

   which is the interface quasi-Newton method with reuse (Degroote, Bathe, Vierendeels 2009), with the compliance in place of the identity.
   The newest pairs come first; those that add little to them are left out.
*/
#include "schwarzimpl.h"
#include <petscblaslapack.h>
#include <sys/citations.h>

/* parts of a pair that are orthogonal to the newer ones and smaller than this, relative to the pair, are noise */
#define INDEPENDENT 1e-2
/* where the groups that still move have less than this of a pair, it is of a sweep in which others moved */
#define OF_OTHERS 1e-9

PetscErrorCode SchwarzSetUpSecants(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  Secants *secants = &schwarz->secants;
  PetscInt unknowns;

  PetscFunctionBegin;
  PetscCall(ImpaktCite(CITE_SECANTS));
  PetscCall(VecDuplicateVecs(schwarz->outer.x, SCHWARZ_MAX_SECANTS, &secants->dx));
  PetscCall(VecDuplicateVecs(schwarz->outer.x, SCHWARZ_MAX_SECANTS, &secants->df));
  PetscCall(VecDuplicate(schwarz->outer.x, &secants->last_x));
  PetscCall(VecDuplicate(schwarz->outer.x, &secants->last_f));
  PetscCall(VecDuplicate(schwarz->outer.x, &secants->rest));
  /* a vector makes room for its norms when it gets the first one, which otherwise were in the time loop */
  for (PetscInt i = 0; i < SCHWARZ_MAX_SECANTS; i++) {
    PetscCall(VecZeroEntries(secants->dx[i]));
    PetscCall(VecZeroEntries(secants->df[i]));
  }
  PetscCall(VecGetLocalSize(schwarz->outer.x, &unknowns));
  PetscCall(PetscMalloc2(unknowns, &secants->listed, unknowns, &secants->gathered));
  for (PetscInt i = 0; i < SCHWARZ_MAX_SECANTS; i++) PetscCall(PetscMalloc1(unknowns, &secants->basis[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroySecants(Contact contact)
{
  Secants *secants = &((Schwarz *)contact->data)->secants;

  PetscFunctionBegin;
  PetscCall(VecDestroyVecs(SCHWARZ_MAX_SECANTS, &secants->dx));
  PetscCall(VecDestroyVecs(SCHWARZ_MAX_SECANTS, &secants->df));
  PetscCall(PetscFree2(secants->listed, secants->gathered));
  for (PetscInt i = 0; i < SCHWARZ_MAX_SECANTS; i++) PetscCall(PetscFree(secants->basis[i]));
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

/* Over the unknowns of all ranks that take part */
static PetscErrorCode Dot(Contact contact, PetscInt n, const PetscScalar a[], const PetscScalar b[], PetscScalar *sum)
{
  const PetscBLASInt one = 1;
  PetscBLASInt       size;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &size));
  PetscCallBLAS("BLASdot", *sum = BLASdot_(&size, a, &one, b, &one));
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 1, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* a += s b */
static PetscErrorCode Add(PetscInt n, PetscScalar s, const PetscScalar b[], PetscScalar a[])
{
  const PetscBLASInt one = 1;
  PetscBLASInt       size;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &size));
  PetscCallBLAS("BLASaxpy", BLASaxpy_(&size, &s, b, &one, a, &one));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The unknowns that take part: those of groups that rest, which have nothing to say, are most of those of many bodies */
static PetscErrorCode Gather(const Secants *secants, Vec v, PetscScalar listed[])
{
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(v, &values));
  for (PetscInt i = 0; i < secants->n_listed; i++) listed[i] = values[secants->listed[i]];
  PetscCall(VecRestoreArrayRead(v, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* f -= Y c, and c; `used` of the pairs, `which` of them, take part. Listed unknowns alone. */
static PetscErrorCode Fit(Contact contact, PetscScalar f[])
{
  Secants       *secants = &((Schwarz *)contact->data)->secants;
  const PetscInt size    = secants->n_listed;
  PetscScalar    upper[SCHWARZ_MAX_SECANTS][SCHWARZ_MAX_SECANTS], *c = secants->factors, squares;
  PetscInt       n = 0;

  PetscFunctionBegin;
  for (PetscInt age = 0; age < secants->n; age++) {
    const PetscInt slot   = (secants->next - 1 - age + 2 * SCHWARZ_MAX_SECANTS) % SCHWARZ_MAX_SECANTS;
    PetscScalar   *newest = secants->basis[n];
    PetscReal      whole, left;

    PetscCall(Gather(secants, secants->df[slot], newest));
    PetscCall(Dot(contact, size, newest, newest, &squares));
    whole = PetscSqrtReal(PetscRealPart(squares));
    for (PetscInt i = 0; i < n; i++) {
      PetscCall(Dot(contact, size, newest, secants->basis[i], &upper[i][n]));
      PetscCall(Add(size, -upper[i][n], secants->basis[i], newest));
    }
    PetscCall(Dot(contact, size, newest, newest, &squares));
    left = PetscSqrtReal(PetscRealPart(squares));
    if (whole < OF_OTHERS || left < INDEPENDENT * whole) continue;
    for (PetscInt i = 0; i < size; i++) newest[i] *= 1 / left;
    upper[n][n]         = left;
    secants->which[n++] = slot;
  }
  for (PetscInt i = 0; i < n; i++) {
    PetscCall(Dot(contact, size, f, secants->basis[i], &c[i]));
    PetscCall(Add(size, -c[i], secants->basis[i], f));
  }
  for (PetscInt i = n - 1; i >= 0; i--) {
    for (PetscInt j = i + 1; j < n; j++) c[i] -= upper[i][j] * c[j];
    c[i] /= upper[i][i];
  }
  secants->used = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes what the pairs say of F out of it: the rest is for the compliance, whose answer SchwarzAddSecants() is for */
PetscErrorCode SchwarzApplySecants(Contact contact, Vec F, Vec *rest)
{
  Schwarz     *schwarz = (Schwarz *)contact->data;
  Secants     *secants = &schwarz->secants;
  PetscScalar *values;
  Vec          X;

  PetscFunctionBegin;
  PetscCall(SNESGetSolution(schwarz->outer.snes, &X));
  PetscCall(AddPair(secants, X, F));
  PetscCall(SchwarzListMoving(contact, &secants->n_listed, secants->listed));
  PetscCall(Gather(secants, F, secants->gathered));
  PetscCall(Fit(contact, secants->gathered));
  PetscCall(VecCopy(F, secants->rest));
  PetscCall(VecGetArray(secants->rest, &values));
  for (PetscInt i = 0; i < secants->n_listed; i++) values[secants->listed[i]] = secants->gathered[i];
  PetscCall(VecRestoreArray(secants->rest, &values));
  *rest = secants->rest;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Y += X c on the unknowns that take part */
PetscErrorCode SchwarzAddSecants(Contact contact, Vec Y)
{
  const Secants *secants = &((Schwarz *)contact->data)->secants;
  PetscScalar   *y;

  PetscFunctionBegin;
  PetscCall(VecGetArray(Y, &y));
  for (PetscInt k = 0; k < secants->used; k++) {
    const Vec          of = secants->dx[secants->which[k]];
    const PetscScalar *dx;

    PetscCall(VecGetArrayRead(of, &dx));
    for (PetscInt i = 0; i < secants->n_listed; i++) y[secants->listed[i]] += secants->factors[k] * dx[secants->listed[i]];
    PetscCall(VecRestoreArrayRead(of, &dx));
  }
  PetscCall(VecRestoreArray(Y, &y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A new iteration begins; with another active set what is known is of no use */
void SchwarzResetSecants(Contact contact, PetscBool forget)
{
  Secants *secants = &((Schwarz *)contact->data)->secants;

  secants->has_last = PETSC_FALSE;
  if (forget) secants->n = secants->next = 0;
}
