/*
   A preconditioner of conjugate gradients for S, where the bodies are linear and have too many rows for a dense matrix: what the Dirichlet
   sides answer with when their rows are moved. Of a body with the effective matrix A, c being the dofs that its rows have entries on, and
   j those around them,

     P = R (A_cc - A_cj A_jj^{-1} A_jc) R^T,

   R having the rows of the Dirichlet side alone. With all dofs of the body in j that is the Dirichlet preconditioner of FETI (C. Farhat,
   F.-X. Roux, A method of finite element tearing and interconnecting and its parallel solution algorithm, International Journal for
   Numerical Methods in Engineering 32, 1991; C. Farhat, J. Mandel, The two-level FETI method for static and dynamic plate problems,
   Computer Methods in Applied Mechanics and Engineering 155, 1998), with none its lumped one. What is far from the surface hardly
   counts, so that j has the dofs of the first layers of elements beside c alone, and what takes a solution with the factors of the
   body in the former takes a small part of one here.
*/
#include "interfaceimpl.h"
#include <sys/petsccompat.h>

/* Layers of elements beside the surface. Two cubes of 20 and 18 hexahedra along an edge, at steps in which waves cross 5 of them, took 27
   iterations without P, 23 with no layer, 16, 13, 12 with one, two, four, and 11 with all. */
#define LAYERS 3

/* Of one body: its dofs on the surface, and those in the layers beside it */
typedef struct {
  PetscInt         body;
  PetscObjectId    ids[2]; /* A and B, and their states */
  PetscObjectState states[2];
  IS               surface, layers;
  Mat              R, A_cc, A_cj, A_jc;
  PC               factors; /* of A_jj; NULL where no dofs are beside the surface */
  Vec              moved, force, diagonal, depth[2], rows;
  PetscBool       *moves;   /* per row of this rank that the body has: whether it has a part in R */
  PetscBool       *claimed; /* work space, per dof on the surface */
  PetscReal        mean;    /* of the diagonal of P, which other rows of the Dirichlet side are multiplied with */
} Slab;

struct _n_InterfacePreconditioner {
  PetscInt n;
  Slab    *slabs;
};

static PetscErrorCode SlabReset(Slab *slab)
{
  PetscFunctionBegin;
  PetscCall(ISDestroy(&slab->surface));
  PetscCall(ISDestroy(&slab->layers));
  PetscCall(MatDestroy(&slab->R));
  PetscCall(MatDestroy(&slab->A_cc));
  PetscCall(MatDestroy(&slab->A_cj));
  PetscCall(MatDestroy(&slab->A_jc));
  PetscCall(PCDestroy(&slab->factors));
  PetscCall(VecDestroy(&slab->moved));
  PetscCall(VecDestroy(&slab->force));
  PetscCall(VecDestroy(&slab->diagonal));
  PetscCall(VecDestroy(&slab->depth[0]));
  PetscCall(VecDestroy(&slab->depth[1]));
  PetscCall(VecDestroy(&slab->rows));
  PetscCall(PetscFree(slab->moves));
  PetscCall(PetscFree(slab->claimed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* NULL where no body is a Dirichlet side with a matrix that stays as it is */
PetscErrorCode InterfacePreconditionerCreate(InterfaceOperator op, InterfacePreconditioner *preconditioner)
{
  const Contact           contact = op->contact;
  InterfacePreconditioner p;

  PetscFunctionBegin;
  *preconditioner = NULL;
  PetscCall(PetscNew(&p));
  PetscCall(PetscCalloc1(contact->n_bodies, &p->slabs));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool dirichlet = PETSC_FALSE, exact;
    Mat       A;

    for (PetscInt k = 0; k < contact->n_pairs; k++)
      dirichlet = (PetscBool)(dirichlet || contact->pairs[k].body[contact->pairs[k].dirichlet] == b);
    PetscCall(BodyComplianceIsExact(contact->bodies[b], &exact));
    PetscCall(BodyGetComplianceMatrices(contact->bodies[b], &A, NULL));
    if (dirichlet && exact && A && op->feels[b]) p->slabs[p->n++].body = b;
  }
  if (p->n) *preconditioner = p;
  else PetscCall(InterfacePreconditionerDestroy(&p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterfacePreconditionerDestroy(InterfacePreconditioner *preconditioner)
{
  PetscFunctionBegin;
  if (!*preconditioner) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < (*preconditioner)->n; k++) PetscCall(SlabReset(&(*preconditioner)->slabs[k]));
  PetscCall(PetscFree((*preconditioner)->slabs));
  PetscCall(PetscFree(*preconditioner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the k-th row that a body has on this rank is one of its own, as the Dirichlet side */
static PetscBool IsDirichlet(const Contact contact, PetscInt b, PetscInt k)
{
  const ContactPair *pair = &contact->pairs[contact->rows.pair[contact->body_rows[b].rows[k]]];

  return (PetscBool)(pair->body[pair->dirichlet] == b);
}

/* Marks dofs of any rank by the number of their layer, where they have none yet */
static PetscErrorCode Mark(IS dofs, PetscScalar layer, Vec mark, Vec work)
{
  const PetscInt    *dof;
  PetscScalar       *now;
  const PetscScalar *found;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(VecSet(work, -1));
  PetscCall(ISGetLocalSize(dofs, &n));
  PetscCall(ISGetIndices(dofs, &dof));
  for (PetscInt i = 0; i < n; i++) PetscCall(VecSetValue(work, dof[i], layer, INSERT_VALUES));
  PetscCall(ISRestoreIndices(dofs, &dof));
  PetscCall(VecAssemblyBegin(work));
  PetscCall(VecAssemblyEnd(work));
  PetscCall(VecGetLocalSize(work, &n));
  PetscCall(VecGetArrayRead(work, &found));
  PetscCall(VecGetArray(mark, &now));
  for (PetscInt i = 0; i < n; i++)
    if (PetscRealPart(now[i]) < 0) now[i] = found[i];
  PetscCall(VecRestoreArray(mark, &now));
  PetscCall(VecRestoreArrayRead(work, &found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The dofs of this rank in one layer */
static PetscErrorCode ListLayer(Vec mark, PetscReal layer, IS *is)
{
  PetscInt           count = 0, *dofs, begin, n;
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(mark, &n));
  PetscCall(VecGetOwnershipRange(mark, &begin, NULL));
  PetscCall(VecGetArrayRead(mark, &values));
  PetscCall(PetscMalloc1(n, &dofs));
  for (PetscInt i = 0; i < n; i++)
    if (PetscRealPart(values[i]) == layer) dofs[count++] = begin + i;
  PetscCall(VecRestoreArrayRead(mark, &values));
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)mark), count, dofs, PETSC_COPY_VALUES, is));
  PetscCall(PetscFree(dofs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The dofs on which rows of the Dirichlet side have entries, of any rank */
static PetscErrorCode ListSurface(const Contact contact, const Slab *slab, Mat B, IS *is)
{
  const ContactBodyRows *of = &contact->body_rows[slab->body];
  PetscInt               n = 0, room = 0, *dofs = NULL;

  PetscFunctionBegin;
  for (PetscInt pass = 0; pass < 2; pass++) {
    for (PetscInt k = 0; k < of->n; k++) {
      const PetscInt    *columns;
      const PetscScalar *values;
      PetscInt           count;

      if (!IsDirichlet(contact, slab->body, k)) continue;
      PetscCall(MatGetRow(B, of->begin + k, &count, &columns, &values));
      for (PetscInt j = 0; j < count; j++) {
        if (values[j] == 0) continue;
        if (pass) dofs[n++] = columns[j];
        else room++;
      }
      PetscCall(MatRestoreRow(B, of->begin + k, &count, &columns, &values));
    }
    if (!pass) PetscCall(PetscMalloc1(room, &dofs));
  }
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)B), n, dofs, PETSC_OWN_POINTER, is));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which dofs are on the surface and in the layers beside it */
static PetscErrorCode FindDofs(const Contact contact, Slab *slab, Mat A, Mat B)
{
  IS  reach;
  Vec mark, work;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(A, &mark, &work));
  PetscCall(VecSet(mark, -1));
  PetscCall(ListSurface(contact, slab, B, &reach));
  PetscCall(Mark(reach, 0, mark, work));
  PetscCall(ISDestroy(&reach));
  PetscCall(ListLayer(mark, 0, &slab->surface));
  PetscCall(ISDuplicate(slab->surface, &reach));
  PetscCall(MatIncreaseOverlap(A, 1, &reach, LAYERS));
  PetscCall(Mark(reach, 1, mark, work));
  PetscCall(ListLayer(mark, 1, &slab->layers));
  PetscCall(ISDestroy(&reach));
  PetscCall(VecDestroy(&mark));
  PetscCall(VecDestroy(&work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Factors of A_jj, and the matrices beside it */
static PetscErrorCode SlabFactor(Slab *slab, Mat A)
{
  PetscInt n;
  Mat      A_jj;

  PetscFunctionBegin;
  PetscCall(MatCreateSubMatrix(A, slab->surface, slab->surface, MAT_INITIAL_MATRIX, &slab->A_cc));
  PetscCall(MatCreateVecs(slab->A_cc, &slab->moved, &slab->force));
  PetscCall(VecDuplicate(slab->moved, &slab->diagonal));
  PetscCall(MatGetDiagonal(slab->A_cc, slab->diagonal));
  PetscCall(ISGetLocalSize(slab->surface, &n));
  PetscCall(PetscMalloc1(n, &slab->claimed));
  PetscCall(ISGetSize(slab->layers, &n));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateSubMatrix(A, slab->surface, slab->layers, MAT_INITIAL_MATRIX, &slab->A_cj));
  PetscCall(MatCreateSubMatrix(A, slab->layers, slab->surface, MAT_INITIAL_MATRIX, &slab->A_jc));
  PetscCall(MatCreateSubMatrix(A, slab->layers, slab->layers, MAT_INITIAL_MATRIX, &A_jj));
  PetscCall(MatSetOption(A_jj, MAT_SPD, PETSC_TRUE));
  PetscCall(MatCreateVecs(A_jj, &slab->depth[0], &slab->depth[1]));
  PetscCall(PCCreate(PetscObjectComm((PetscObject)A), &slab->factors));
  PetscCall(PCSetOperators(slab->factors, A_jj, A_jj));
  PetscCall(PCSetType(slab->factors, PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(slab->factors, MATSOLVERMUMPS));
  PetscCall(PCSetUp(slab->factors));
  PetscCall(MatDestroy(&A_jj));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of the rows that are in have a part in R: a node that touches two partners has rows with one direction, of which R may have one, or
   P is singular. A row has one if its largest entry is on a dof of this rank that no other has claimed. */
static PetscErrorCode ChooseRows(InterfaceOperator op, Slab *slab)
{
  const Contact      contact = op->contact;
  PetscInt           count   = 0, n, dofs, row, dof; /* the first row and dof of this rank */
  PetscReal          sum     = 0;
  const PetscScalar *diagonal;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(slab->R, &n, &dofs));
  PetscCall(MatGetOwnershipRange(slab->R, &row, NULL));
  PetscCall(MatGetOwnershipRangeColumn(slab->R, &dof, NULL));
  PetscCall(PetscArrayzero(slab->claimed, dofs));
  PetscCall(VecGetArrayRead(slab->diagonal, &diagonal));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           entries, largest = 0, at;

    slab->moves[k] = PETSC_FALSE;
    if (!InterfaceIsIn(op, contact->body_rows[slab->body].rows[k]) || !IsDirichlet(contact, slab->body, k)) continue;
    PetscCall(MatGetRow(slab->R, row + k, &entries, &columns, &values));
    for (PetscInt j = 0; j < entries; j++)
      if (PetscAbsScalar(values[j]) > PetscAbsScalar(values[largest])) largest = j;
    at = entries ? columns[largest] - dof : -1;
    if (at >= 0 && at < dofs && values[largest] != 0 && !slab->claimed[at]) {
      slab->moves[k] = slab->claimed[at] = PETSC_TRUE;
      sum += PetscRealPart(diagonal[at]) * PetscSqr(PetscRealPart(values[largest]));
      count++;
    }
    PetscCall(MatRestoreRow(slab->R, row + k, &entries, &columns, &values));
  }
  slab->mean = count ? sum / count : 1;
  PetscCall(VecRestoreArrayRead(slab->diagonal, &diagonal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the body's matrices as they are: all anew where other dofs are on the surface, or A has changed */
static PetscErrorCode SlabUpdate(const Contact contact, Slab *slab)
{
  Mat       matrices[2];
  PetscBool changed[2], same = PETSC_FALSE;
  IS        surface = slab->surface, all;
  PetscInt  rows, begin;

  PetscFunctionBegin;
  PetscCall(BodyGetComplianceMatrices(contact->bodies[slab->body], &matrices[0], &matrices[1]));
  for (PetscInt m = 0; m < 2; m++) {
    PetscObjectId    id;
    PetscObjectState state;

    PetscCall(PetscObjectGetId((PetscObject)matrices[m], &id));
    PetscCall(PetscObjectStateGet((PetscObject)matrices[m], &state));
    changed[m]      = (PetscBool)(id != slab->ids[m] || state != slab->states[m]);
    slab->ids[m]    = id;
    slab->states[m] = state;
  }
  if (!changed[0] && !changed[1]) PetscFunctionReturn(PETSC_SUCCESS);
  if (surface) {
    PetscCall(PetscObjectReference((PetscObject)surface));
    PetscCall(ISDestroy(&slab->surface));
    PetscCall(ISDestroy(&slab->layers));
  }
  PetscCall(FindDofs(contact, slab, matrices[0], matrices[1]));
  if (surface) PetscCall(ISEqual(surface, slab->surface, &same));
  PetscCall(ISDestroy(&surface));
  if (changed[0] || !same) {
    IS now = slab->surface, layers = slab->layers;

    slab->surface = slab->layers = NULL;
    PetscCall(SlabReset(slab));
    slab->surface = now;
    slab->layers  = layers;
    PetscCall(SlabFactor(slab, matrices[0]));
  }
  PetscCall(MatDestroy(&slab->R));
  PetscCall(VecDestroy(&slab->rows));
  PetscCall(MatGetLocalSize(matrices[1], &rows, NULL));
  PetscCall(MatGetOwnershipRange(matrices[1], &begin, NULL));
  PetscCall(ISCreateStride(PetscObjectComm((PetscObject)matrices[1]), rows, begin, 1, &all));
  PetscCall(MatCreateSubMatrix(matrices[1], all, slab->surface, MAT_INITIAL_MATRIX, &slab->R));
  PetscCall(ISDestroy(&all));
  PetscCall(MatCreateVecs(slab->R, NULL, &slab->rows));
  PetscCall(PetscFree(slab->moves));
  PetscCall(PetscMalloc1(rows, &slab->moves));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* force = (A_cc - A_cj A_jj^{-1} A_jc) moved */
static PetscErrorCode SlabApply(Slab *slab)
{
  PetscFunctionBegin;
  PetscCall(MatMult(slab->A_cc, slab->moved, slab->force));
  if (!slab->factors) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatMult(slab->A_jc, slab->moved, slab->depth[0]));
  PetscCall(PCApply(slab->factors, slab->depth[0], slab->depth[1]));
  PetscCall(VecScale(slab->depth[1], -1));
  PetscCall(MatMultAdd(slab->A_cj, slab->depth[1], slab->force, slab->force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What one body adds to y = P x, on its rows that are in */
static PetscErrorCode AddSlab(InterfaceOperator op, Slab *slab, const PetscScalar x[], PetscScalar y[])
{
  const Contact          contact = op->contact;
  const ContactBodyRows *of      = &contact->body_rows[slab->body];
  const PetscScalar     *out;
  PetscScalar           *in;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(slab->rows, &in));
  for (PetscInt k = 0; k < of->n; k++) in[k] = slab->moves[k] ? x[of->rows[k]] : 0;
  PetscCall(VecRestoreArrayWrite(slab->rows, &in));
  PetscCall(MatMultTranspose(slab->R, slab->rows, slab->moved));
  PetscCall(SlabApply(slab));
  PetscCall(MatMult(slab->R, slab->force, slab->rows));
  PetscCall(VecGetArrayRead(slab->rows, &out));
  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt i = of->rows[k];

    if (InterfaceIsIn(op, i) && IsDirichlet(contact, slab->body, k)) y[i] = slab->moves[k] ? out[k] : slab->mean * x[i];
  }
  PetscCall(VecRestoreArrayRead(slab->rows, &out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the matrices of the bodies as they are now */
PetscErrorCode InterfacePreconditionerUpdate(InterfaceOperator op)
{
  InterfacePreconditioner p = op->preconditioner;

  PetscFunctionBegin;
  for (PetscInt k = 0; p && k < p->n; k++) {
    PetscCall(SlabUpdate(op->contact, &p->slabs[k]));
    PetscCall(ChooseRows(op, &p->slabs[k]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = P x; rows that are not in stay as they are, and so do those whose Dirichlet side has no part in P */
PetscErrorCode InterfacePreconditionerApply(PC pc, Vec x, Vec y)
{
  InterfaceOperator  op;
  const PetscScalar *in;
  PetscScalar       *out;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &op));
  PetscCall(VecCopy(x, y));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArray(y, &out));
  for (PetscInt k = 0; k < op->preconditioner->n; k++) PetscCall(AddSlab(op, &op->preconditioner->slabs[k], in, out));
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}
