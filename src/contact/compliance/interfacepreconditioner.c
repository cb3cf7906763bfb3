/*
   A preconditioner of conjugate gradients for S, where the bodies are linear and have too many rows for a dense matrix: what the Dirichlet
   sides answer with when their rows are moved. Of a body with the effective matrix A, c being the dofs of the surface that its rows are
   on, and j those around them,

     P = R (A_cc - A_cj A_jj^{-1} A_jc) R^T,

   R having the rows of the Dirichlet side alone. With all dofs of the body in j that is the Dirichlet preconditioner of FETI (C. Farhat,
   F.-X. Roux, A method of finite element tearing and interconnecting and its parallel solution algorithm, International Journal for
   Numerical Methods in Engineering 32, 1991; C. Farhat, J. Mandel, The two-level FETI method for static and dynamic plate problems,
   Computer Methods in Applied Mechanics and Engineering 155, 1998), with none its lumped one. What is far from the surface hardly
   counts, so that j has the dofs of the first layers of elements beside c alone, and what takes a solution with the factors of the
   body in the former takes a small part of one here. A massless layer has no j: its P is R K R^T, with its stiffness K.
*/
#include "interfaceimpl.h"
#include <solver/constrainedsolver.h>
#include <sys/petsccompat.h>

/* Layers of elements beside the surface. Two cubes of 20 and 18 hexahedra along an edge, at steps in which waves cross 5 of them, took 27
   iterations without P, 23 with no layer, 16, 13, 12 with one, two, four, and 11 with all. */
#define LAYERS 3

/* Of one body: its dofs on the surfaces of which it is the Dirichlet side, and those in the layers beside them */
typedef struct {
  PetscInt         body;
  PetscObjectId    id; /* of A, and its state, when it was factored */
  PetscObjectState state;
  Mat              B; /* the rows as they are; borrowed */
  IS               surface, layers;
  Mat              A_cc, A_cj, A_jc;
  KSP              factors; /* of A_jj; NULL where no dofs are beside the surface */
  VecScatter       gather;  /* from all dofs to those on the surface */
  Vec              rows, dofs, moved, force, diagonal, depth[2];
  PetscBool        is_layer; /* A is that of a massless layer, which has the surface alone */
  PetscBool       *moves;    /* per row of this rank that the body has: whether it has a part in R */
  PetscBool       *claimed;  /* work space, per dof of this rank */
  PetscReal        mean;     /* of the diagonal of P, which other rows of the Dirichlet side are multiplied with */
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
  PetscCall(MatDestroy(&slab->A_cc));
  PetscCall(MatDestroy(&slab->A_cj));
  PetscCall(MatDestroy(&slab->A_jc));
  PetscCall(KSPDestroy(&slab->factors));
  PetscCall(VecScatterDestroy(&slab->gather));
  PetscCall(VecDestroy(&slab->rows));
  PetscCall(VecDestroy(&slab->dofs));
  PetscCall(VecDestroy(&slab->moved));
  PetscCall(VecDestroy(&slab->force));
  PetscCall(VecDestroy(&slab->diagonal));
  PetscCall(VecDestroy(&slab->depth[0]));
  PetscCall(VecDestroy(&slab->depth[1]));
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
    Mat       A, layer;

    for (PetscInt k = 0; k < contact->n_pairs; k++)
      dirichlet = (PetscBool)(dirichlet || contact->pairs[k].body[contact->pairs[k].dirichlet] == b);
    PetscCall(BodyComplianceIsExact(contact->bodies[b], &exact));
    PetscCall(BodyGetComplianceMatrices(contact->bodies[b], &A, NULL));
    PetscCall(BodyGetLayerMatrices(contact->bodies[b], &layer, NULL));
    if (!dirichlet || !A || !op->feels[b]) continue;
    /* with a massless layer the surface is all that there is, and a product with K takes next to nothing */
    if (!layer && !exact) continue;
    p->slabs[p->n++] = (Slab){.body = b, .is_layer = (PetscBool)(layer != NULL)};
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

/* The dofs of the surfaces of which the body is the Dirichlet side, of any rank and perhaps more than once */
static PetscErrorCode ListSurface(const Contact contact, const Slab *slab, IS *is)
{
  PetscInt n = 0, room = 0, *dofs;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const SurfaceData *data;

    if (pair->body[pair->dirichlet] != slab->body) continue;
    PetscCall(SurfaceGetData(pair->surfaces[pair->dirichlet], &data));
    room += data->n_nodes * data->dim;
  }
  PetscCall(PetscMalloc1(room, &dofs));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const SurfaceData *data;

    if (pair->body[pair->dirichlet] != slab->body) continue;
    PetscCall(SurfaceGetData(pair->surfaces[pair->dirichlet], &data));
    for (PetscInt i = 0; i < data->n_nodes * data->dim; i++) dofs[n++] = data->dofs[i / data->dim] + i % data->dim;
  }
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)contact->bodies[slab->body]), n, dofs, PETSC_OWN_POINTER, is));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which dofs are on the surface and in the layers beside it; those of a massless layer are numbered by themselves, and all are on it */
static PetscErrorCode FindDofs(const Contact contact, Slab *slab, Mat A)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)A);
  IS             reach;
  Vec            mark, work;

  PetscFunctionBegin;
  if (slab->is_layer) {
    PetscInt n, begin;

    PetscCall(MatGetLocalSize(A, &n, NULL));
    PetscCall(MatGetOwnershipRange(A, &begin, NULL));
    PetscCall(ISCreateStride(comm, n, begin, 1, &slab->surface));
    PetscCall(ISCreateStride(comm, 0, 0, 1, &slab->layers));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatCreateVecs(A, &mark, &work));
  PetscCall(VecSet(mark, -1));
  PetscCall(ListSurface(contact, slab, &reach));
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
static PetscErrorCode SlabFactor(Slab *slab, PetscInt dim, Mat A)
{
  PetscInt n;
  Mat      A_jj;

  PetscFunctionBegin;
  PetscCall(MatCreateSubMatrix(A, slab->surface, slab->surface, MAT_INITIAL_MATRIX, &slab->A_cc));
  PetscCall(MatCreateVecs(slab->A_cc, &slab->moved, &slab->force));
  PetscCall(ISGetSize(slab->layers, &n));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateSubMatrix(A, slab->surface, slab->layers, MAT_INITIAL_MATRIX, &slab->A_cj));
  PetscCall(MatCreateSubMatrix(A, slab->layers, slab->surface, MAT_INITIAL_MATRIX, &slab->A_jc));
  PetscCall(MatCreateSubMatrix(A, slab->layers, slab->layers, MAT_INITIAL_MATRIX, &A_jj));
  PetscCall(MatSetOption(A_jj, MAT_SPD, PETSC_TRUE));
  PetscCall(MatCreateVecs(A_jj, &slab->depth[0], &slab->depth[1]));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)A), &slab->factors));
  PetscCall(KSPSetOperators(slab->factors, A_jj, A_jj));
  PetscCall(ConstrainedSolverChoose(slab->factors, A_jj, dim));
  PetscCall(KSPSetUp(slab->factors));
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
  PetscCall(MatGetLocalSize(slab->B, &n, &dofs));
  PetscCall(MatGetOwnershipRange(slab->B, &row, NULL));
  PetscCall(MatGetOwnershipRangeColumn(slab->B, &dof, NULL));
  PetscCall(PetscArrayzero(slab->claimed, dofs));
  PetscCall(VecGetArrayRead(slab->diagonal, &diagonal));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           entries, largest = 0, at;

    slab->moves[k] = PETSC_FALSE;
    if (!InterfaceIsIn(op, contact->body_rows[slab->body].rows[k]) || !IsDirichlet(contact, slab->body, k)) continue;
    PetscCall(MatGetRow(slab->B, row + k, &entries, &columns, &values));
    for (PetscInt j = 0; j < entries; j++)
      if (PetscAbsScalar(values[j]) > PetscAbsScalar(values[largest])) largest = j;
    at = entries ? columns[largest] - dof : -1;
    if (at >= 0 && at < dofs && values[largest] != 0 && !slab->claimed[at]) {
      slab->moves[k] = slab->claimed[at] = PETSC_TRUE;
      sum += PetscRealPart(diagonal[at]) * PetscSqr(PetscRealPart(values[largest]));
      count++;
    }
    PetscCall(MatRestoreRow(slab->B, row + k, &entries, &columns, &values));
  }
  slab->mean = count ? sum / count : 1;
  PetscCall(VecRestoreArrayRead(slab->diagonal, &diagonal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the body's matrices as they are: the rows change often, A hardly ever */
static PetscErrorCode SlabUpdate(const Contact contact, Slab *slab)
{
  Mat              A;
  PetscObjectId    id;
  PetscObjectState state;
  PetscInt         rows, dofs;

  PetscFunctionBegin;
  PetscCall(BodyGetComplianceMatrices(contact->bodies[slab->body], &A, &slab->B));
  PetscCall(PetscObjectGetId((PetscObject)A, &id));
  PetscCall(PetscObjectStateGet((PetscObject)A, &state));
  if (id == slab->id && state == slab->state) PetscFunctionReturn(PETSC_SUCCESS);
  slab->id    = id;
  slab->state = state;
  PetscCall(SlabReset(slab));
  PetscCall(FindDofs(contact, slab, A));
  PetscCall(SlabFactor(slab, contact->dim, A));
  PetscCall(MatCreateVecs(slab->B, &slab->dofs, &slab->rows));
  PetscCall(VecDuplicate(slab->dofs, &slab->diagonal));
  PetscCall(MatGetDiagonal(A, slab->diagonal));
  PetscCall(VecScatterCreate(slab->dofs, slab->surface, slab->moved, NULL, &slab->gather));
  PetscCall(MatGetLocalSize(slab->B, &rows, &dofs));
  PetscCall(PetscMalloc1(rows, &slab->moves));
  PetscCall(PetscMalloc1(dofs, &slab->claimed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* force = (A_cc - A_cj A_jj^{-1} A_jc) moved */
static PetscErrorCode SlabApply(Slab *slab)
{
  PetscFunctionBegin;
  PetscCall(MatMult(slab->A_cc, slab->moved, slab->force));
  if (!slab->factors) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatMult(slab->A_jc, slab->moved, slab->depth[0]));
  PetscCall(KSPSolve(slab->factors, slab->depth[0], slab->depth[1]));
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
  PetscCall(MatMultTranspose(slab->B, slab->rows, slab->dofs));
  PetscCall(VecScatterBegin(slab->gather, slab->dofs, slab->moved, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(slab->gather, slab->dofs, slab->moved, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(SlabApply(slab));
  PetscCall(VecZeroEntries(slab->dofs));
  PetscCall(VecScatterBegin(slab->gather, slab->force, slab->dofs, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(slab->gather, slab->force, slab->dofs, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(MatMult(slab->B, slab->dofs, slab->rows));
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

/* Whether P is there, for some row */
PetscBool InterfaceOperatorHasPreconditioner(InterfaceOperator op)
{
  return (PetscBool)(op->preconditioner != NULL);
}

/* From now on P is for the rows of this rank that are `in`, with the matrices of the bodies as they are */
PetscErrorCode InterfaceOperatorChoose(InterfaceOperator op, const PetscBool in[])
{
  PetscFunctionBegin;
  PetscCall(InterfaceOperatorFactor(op, in, NULL));
  PetscCall(InterfacePreconditionerUpdate(op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = P x on these; elsewhere, and where the Dirichlet side has no part in P, y stays as it comes in */
PetscErrorCode InterfaceOperatorPrecondition(InterfaceOperator op, const PetscScalar x[], PetscScalar y[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; op->preconditioner && k < op->preconditioner->n; k++) PetscCall(AddSlab(op, &op->preconditioner->slabs[k], x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}
