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

/* For so many unknowns in the vectors of a fit, which all ranks together may have more of than this one */
static PetscErrorCode MakeRoom(Secants *secants, PetscInt size)
{
  PetscFunctionBegin;
  if (size <= secants->room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(secants->vectors));
  secants->room = PetscMax(size, 2 * secants->room);
  PetscCall(PetscMalloc1((1 + SCHWARZ_MAX_SECANTS) * secants->room, &secants->vectors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
  PetscCall(PetscMalloc2(unknowns, &secants->listed, unknowns, &secants->at));
  PetscCall(MakeRoom(secants, unknowns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroySecants(Contact contact)
{
  Secants *secants = &((Schwarz *)contact->data)->secants;

  PetscFunctionBegin;
  PetscCall(VecDestroyVecs(SCHWARZ_MAX_SECANTS, &secants->dx));
  PetscCall(VecDestroyVecs(SCHWARZ_MAX_SECANTS, &secants->df));
  PetscCall(PetscFree2(secants->listed, secants->at));
  PetscCall(PetscFree(secants->vectors));
  secants->room = 0;
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
static PetscErrorCode Dot(Contact contact, const PetscScalar a[], const PetscScalar b[], PetscScalar *sum)
{
  const Secants     *secants = &((const Schwarz *)contact->data)->secants;
  const PetscBLASInt one     = 1;
  PetscBLASInt       size;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(secants->size, &size));
  PetscCallBLAS("BLASdot", *sum = BLASdot_(&size, a, &one, b, &one));
  if (contact->ranks.size > 1 && !secants->whole)
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

/* Unknowns that take part, of all ranks; those of this one are listed, in the same order */
static void ListOfAllRanks(Contact contact)
{
  const Schwarz  *schwarz  = (const Schwarz *)contact->data;
  const Jacobian *jacobian = &schwarz->jacobian;
  Secants        *secants  = &((Schwarz *)contact->data)->secants;

  secants->size = secants->n_listed = 0;
  for (PetscInt j = 0; j < jacobian->n; j++) {
    const PetscInt p = contact->ranks.row_pair[jacobian->rows[j]], i = jacobian->rows[j] - contact->rows.begin;

    if (!SchwarzPairMoves(contact, p)) continue;
    for (PetscInt k = 0; k < schwarz->room[p]; k++, secants->size++) {
      if (i < 0 || i >= contact->rows.n) continue;
      secants->listed[secants->n_listed] = schwarz->offset[i] + k;
      secants->at[secants->n_listed++]   = secants->size;
    }
  }
}

/* Which unknowns take part: those of groups that rest, which have nothing to say, are most of those of many bodies. With a dense Jacobian
   each rank has what all ranks know of them, which takes one word instead of one for each product. */
static PetscErrorCode ListUnknowns(Contact contact)
{
  Secants *secants = &((Schwarz *)contact->data)->secants;

  PetscFunctionBegin;
  secants->whole = (PetscBool)(contact->ranks.size > 1 && ((const Schwarz *)contact->data)->jacobian.dense);
  if (secants->whole) ListOfAllRanks(contact);
  else {
    PetscCall(SchwarzListMoving(contact, &secants->n_listed, secants->listed));
    secants->size = secants->n_listed;
    for (PetscInt i = 0; i < secants->size; i++) secants->at[i] = i;
  }
  PetscCall(MakeRoom(secants, secants->size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pair that is so many sweeps old */
static PetscInt Slot(const Secants *secants, PetscInt age)
{
  return (secants->next - 1 - age + 2 * SCHWARZ_MAX_SECANTS) % SCHWARZ_MAX_SECANTS;
}

/* What takes part of F and of its changes */
static PetscErrorCode GatherVectors(Contact contact, Vec F)
{
  Secants       *secants = &((Schwarz *)contact->data)->secants;
  const PetscInt n       = (1 + secants->n) * secants->size;

  PetscFunctionBegin;
  if (secants->whole) PetscCall(PetscArrayzero(secants->vectors, n));
  for (PetscInt k = 0; k <= secants->n; k++) {
    const Vec          vec    = k ? secants->df[Slot(secants, k - 1)] : F;
    PetscScalar       *vector = secants->vectors + k * secants->size;
    const PetscScalar *values;

    PetscCall(VecGetArrayRead(vec, &values));
    for (PetscInt i = 0; i < secants->n_listed; i++) vector[secants->at[i]] = values[secants->listed[i]];
    PetscCall(VecRestoreArrayRead(vec, &values));
  }
  if (secants->whole)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, secants->vectors, (PetscMPIInt)n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* F -= Y c, and c; `used` of the pairs, `which` of them, take part. Of the vectors that have been gathered. */
static PetscErrorCode Fit(Contact contact)
{
  Secants       *secants = &((Schwarz *)contact->data)->secants;
  const PetscInt size    = secants->size;
  PetscScalar   *f       = secants->vectors, *basis[SCHWARZ_MAX_SECANTS];
  PetscScalar    upper[SCHWARZ_MAX_SECANTS][SCHWARZ_MAX_SECANTS], *c = secants->factors, squares;
  PetscInt       n = 0;

  PetscFunctionBegin;
  for (PetscInt age = 0; age < secants->n; age++) {
    PetscScalar *newest = f + (1 + age) * size;
    PetscReal    whole, left;

    PetscCall(Dot(contact, newest, newest, &squares));
    whole = PetscSqrtReal(PetscRealPart(squares));
    for (PetscInt i = 0; i < n; i++) {
      PetscCall(Dot(contact, newest, basis[i], &upper[i][n]));
      PetscCall(Add(size, -upper[i][n], basis[i], newest));
    }
    PetscCall(Dot(contact, newest, newest, &squares));
    left = PetscSqrtReal(PetscRealPart(squares));
    if (whole < OF_OTHERS || left < INDEPENDENT * whole) continue;
    for (PetscInt i = 0; i < size; i++) newest[i] *= 1 / left;
    upper[n][n]         = left;
    basis[n]            = newest;
    secants->which[n++] = Slot(secants, age);
  }
  for (PetscInt i = 0; i < n; i++) {
    PetscCall(Dot(contact, f, basis[i], &c[i]));
    PetscCall(Add(size, -c[i], basis[i], f));
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
  PetscCall(ListUnknowns(contact));
  PetscCall(GatherVectors(contact, F));
  PetscCall(Fit(contact));
  PetscCall(VecCopy(F, secants->rest));
  PetscCall(VecGetArray(secants->rest, &values));
  for (PetscInt i = 0; i < secants->n_listed; i++) values[secants->listed[i]] = secants->vectors[secants->at[i]];
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
