/*
   S of a controller step with friction, where its rows are too many for a matrix: products, of one solution with the factors of each body,
   what preconditions, and about how large the diagonal is.

   Of the diagonal no more is wanted than its size, with which forces and lengths are compared, and which rows nothing moves. With signs x
   that are taken at random the mean of x_i (S x)_i is that of the diagonal (Hutchinson 1990), and a row that no force moves shows as one
   that stays where it is. So each pair has one number along the normals and one across them, until its rows are built again.
*/
#include "frictionstep.h"

/* Products that the diagonal is found by */
#define PROBES 4
/* What a row has moved by at most that nothing moves, in parts of the others of its node: the compliance of a row goes with the square */
#define HELD 1e-7

/* y = S x */
static PetscErrorCode Multiply(void *data, const PetscScalar x[], PetscScalar y[])
{
  Contact       contact = (Contact)data;
  FrictionStep *step    = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  InterfaceOperatorScatter(step->S, x, step->in);
  PetscCall(InterfaceOperatorMultiply(step->S, INTERFACE_GAP, step->in, step->out));
  for (PetscInt i = 0; i < contact->rows.n; i++) step->out[i] += step->flexibility[i] * step->in[i];
  PetscCall(InterfaceOperatorGather(step->S, step->out, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Choose(void *data, const PetscBool chosen[])
{
  Contact         contact = (Contact)data;
  FrictionStep   *step    = (FrictionStep *)contact->data;
  const PetscInt *rows;
  PetscInt        n;

  PetscFunctionBegin;
  InterfaceOperatorGetRows(step->S, &n, &rows, NULL);
  PetscCall(PetscArrayzero(step->chosen, contact->rows.n));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt mine = rows[i] - contact->rows.begin;

    if (mine >= 0 && mine < contact->rows.n) step->chosen[mine] = chosen[i];
  }
  PetscCall(InterfaceOperatorChoose(step->S, step->chosen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Precondition(void *data, const PetscScalar x[], PetscScalar y[])
{
  Contact       contact = (Contact)data;
  FrictionStep *step    = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  InterfaceOperatorScatter(step->S, x, step->in);
  InterfaceOperatorScatter(step->S, y, step->out);
  PetscCall(InterfaceOperatorPrecondition(step->S, step->in, step->out));
  PetscCall(InterfaceOperatorGather(step->S, step->out, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrictionCreateProducts(Contact contact)
{
  FrictionStep  *step = (FrictionStep *)contact->data;
  const PetscInt n    = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(PetscCalloc6(n, &step->compliance, n, &step->largest, n, &step->in, n, &step->out, n, &step->chosen, 6 * contact->n_pairs,
                         &step->sums));
  step->products = (FrictionProducts){.data = contact, .multiply = Multiply};
  /* with springs P, which is without, would be too stiff */
  if (InterfaceOperatorHasPreconditioner(step->S) && !step->has_springs) {
    step->products.choose       = Choose;
    step->products.precondition = Precondition;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrictionDestroyProducts(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  PetscCall(PetscFree6(step->compliance, step->largest, step->in, step->out, step->chosen, step->sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A sign for row i of all ranks, as if at random: a bit of a multiplicative hash (Knuth) */
static PetscScalar Sign(PetscInt i, PetscInt probe)
{
  PetscInt64 hash = (i * 8 + probe + 1) * 0x9E3779B97F4A7C1LL;

  hash ^= hash >> 29;
  hash *= 0xBF58476D1CE4E5BLL;
  return (hash >> 40) & 1 ? 1 : -1;
}

/* Which place a row has among the sums of its pair: those along normals come first */
static PetscInt GetPlace(Contact contact, PetscInt i)
{
  return 6 * contact->rows.pair[i] + 3 * (i % contact->dim > 0);
}

/* Sums over the rows that are solved for, of each pair: of x_i (S x)_i, of |(S x)_i|, and of ones */
static PetscErrorCode Probe(Contact contact)
{
  FrictionStep  *step = (FrictionStep *)contact->data;
  const PetscInt n    = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(step->largest, n));
  PetscCall(PetscArrayzero(step->sums, 6 * contact->n_pairs));
  for (PetscInt probe = 0; probe < PROBES; probe++) {
    for (PetscInt i = 0; i < n; i++) step->in[i] = step->marks[i] == INTERFACE_SOLVED ? Sign(contact->rows.begin + i, probe) : 0;
    PetscCall(InterfaceOperatorMultiply(step->S, INTERFACE_GAP, step->in, step->out));
    for (PetscInt i = 0; i < n; i++) {
      PetscReal *sums = step->sums + GetPlace(contact, i), moved = PetscAbsScalar(step->out[i]);

      if (step->marks[i] != INTERFACE_SOLVED) continue;
      step->largest[i] = PetscMax(step->largest[i], moved);
      sums[0] += PetscRealPart(step->in[i] * step->out[i]);
      sums[1] += moved;
      sums[2] += 1;
    }
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, step->sums, (PetscMPIInt)(6 * contact->n_pairs), MPIU_REAL, MPIU_SUM,
                               PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* About what S has on the diagonal, of the rows that are solved for */
PetscErrorCode FrictionFindDiagonal(Contact contact)
{
  FrictionStep *step    = (FrictionStep *)contact->data;
  int           unknown = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) unknown |= step->marks[i] == INTERFACE_SOLVED && step->compliance[i] < 0;
  PetscCall(ContactOr(contact, &unknown));
  if (unknown) PetscCall(Probe(contact));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscReal *sums  = step->sums + GetPlace(contact, i);
    const PetscInt   first = i - i % contact->dim;
    PetscReal        most  = 0;

    if (step->marks[i] == INTERFACE_SOLVED && unknown) {
      for (PetscInt k = 0; k < contact->dim; k++) most = PetscMax(most, step->largest[first + k]);
      step->compliance[i] = step->largest[i] > HELD * most ? PetscMax(sums[0], 0.1 * sums[1]) / sums[2] : 0;
    }
    step->mine[i] = step->compliance[i];
  }
  PetscCall(InterfaceOperatorGather(step->S, step->mine, step->problem.diagonal));
  PetscFunctionReturn(PETSC_SUCCESS);
}
