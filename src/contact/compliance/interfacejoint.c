/*
   What preconditions S between linear bodies: the inverse of the same operator of the first layers of elements beside the surfaces, beyond
   which the bodies move as a coarse grid lets them. With the matrix K of these of all bodies, and C the rows t_b B_b on their dofs,

     P = (C K^{-1} C^T + D)^{-1} = D^{-1} - D^{-1} C (K + C^T D^{-1} C)^{-1} C^T D^{-1}:

   gaps are closed by springs of the compliance D, which is so small that it does not count, and so large that nothing is lost by round-off.
   With them what is factored is positive definite and has no unknowns but displacements, and rows may depend on each other.

   Rows that are not in contact have no spring, so that P is the inverse for those that are: with springs on all of them, and the others
   left out of what goes in and comes out, P would hold the gaps of the others as they are. So it is factored when rows or bodies have
   changed, and when rows join or leave, where that saves more than it takes; else all rows have springs. It hangs on nothing but the
   present matrices and rows. What bodies do beyond the layers is in body/rows/farmotion.c.

   The Dirichlet preconditioner of FETI (C. Farhat, J. Mandel, The two-level FETI method for static and dynamic plate problems, Computer
   Methods in Applied Mechanics and Engineering 155, 1998) adds up what each body answers with by itself. That is the inverse where meshes
   match and bodies are alike; where they do not the answers of both are to be weighted row by row (D. Rixen, C. Farhat, A simple and
   efficient extension of a class of substructure based preconditioners to heterogeneous structural mechanics problems, International
   Journal for Numerical Methods in Engineering 44, 1999), and what short waves find on the coarser side remains. Two cubes of 12 and 10
   hexahedra take 11 iterations with one side, 7 or 8 with both and weights, 3 or 4 with P.

   Most iterations of a step of Newton's method in partial contact where waves cross 3, 10 and 50 elements in a step, and beside them those
   with four layers held on their far side and all rows: cubes of 16 and 12 elements 3, 5 and 6 for 7, 9 and 11; plates of 36 x 36 x 8 and
   32 x 32 x 8 6, 9 and 12 for 6, 10 and 21, in full contact 6 for 15; the upper cube 100 times as stiff 4 for 18, tetrahedra 5 for 11,
   cubes of 24 and 20 6 for 14, elements 13 times as long as they are high 7. The time loop of the cubes takes 1.2, 1.7 and 5.8 s for 3.5,
   3.6 and 12.7 s, of the larger ones 33.6 for 46.2 s, of the plates 23.6 for 32.2 s. Bodies that are whole would leave 3 iterations
   everywhere, with factors of their price; eight layers, held, leave 8. To begin with the projection on the last five solutions (P. F.
   Fischer, Computer Methods in Applied Mechanics and Engineering 163, 1998) saves nothing: between waves in motion it leaves 3 to 60 % of
   the right-hand side.
*/
#include "interfacejoint.h"
#include "interfaceslab.h"
#include <solver/constrainedsolver.h>

/* Compliance of the springs, in parts of a row's as its dofs answer one by one */
#define SPRING_COMPLIANCE 1e-4

/* Factors of three-dimensional slabs of more dofs are made by MUMPS */
#define MAX_SMALL_SIZE 1500

/* P follows the rows that are in where N^(3/2) of what is factored is no more than so many N^(4/3) of the bodies: its factors take the time
   of 4 iterations then, of which they save 2 to 5 for each step of Newton's method in partial contact. Cubes of 16 and 12 or 24 and 20
   elements are at 0.95 and 0.67 and 2 to 3 iterations, plates of 8 layers at 2.5 and 6. */
#define FACTORS_PER_PRODUCT 2

struct _n_InterfaceJoint {
  PetscInt       n;
  InterfaceSlab *slabs;
  PetscBool     *pairs;      /* per pair: its rows are among those of P */
  PetscBool     *springs_on; /* per row of this rank: it has a spring */
  PetscBool      follows;    /* P is made again where other rows are in; else all rows have springs */
  PetscInt      *shift;      /* per slab and rank: a dof of the slab on that rank, and this, are its number in K */
  Mat            K, C;
  Mat            scaled, springs, M; /* D^{-1} C, with work space in between; C^T D^{-1} C; K with it */
  Vec            stiffness, rows;    /* of the springs, none on rows without entries; work space */
  Vec            load, moved;        /* work space */
  KSP            factors;            /* of K + C^T D^{-1} C */
};

/* Whether a body answers by a matrix that stays as it is, and whether this is that of its massless layer alone */
static PetscErrorCode LookAt(InterfaceOperator op, PetscInt b, PetscBool *linear, PetscBool *layer)
{
  const Body body = op->contact->bodies[b];
  Mat        A, K;
  PetscBool  exact;

  PetscFunctionBegin;
  PetscCall(BodyComplianceIsExact(body, &exact));
  PetscCall(BodyGetComplianceMatrices(body, &A, NULL));
  PetscCall(BodyGetLayerMatrices(body, &K, NULL));
  *linear = (PetscBool)(exact && A && op->feels[b]);
  *layer  = (PetscBool)(K != NULL);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* NULL where no pair has a linear body with mass next to a Dirichlet side that is linear: rows of the other side alone may depend on each
   other, and massless layers alone have something cheaper */
PetscErrorCode InterfaceJointCreate(InterfaceOperator op, InterfaceJoint *joint)
{
  const Contact  contact = op->contact;
  InterfaceJoint j;
  PetscBool      any = PETSC_FALSE;

  PetscFunctionBegin;
  *joint = NULL;
  PetscCall(PetscNew(&j));
  PetscCall(PetscCalloc4(contact->n_bodies, &j->slabs, contact->n_pairs, &j->pairs, contact->n_bodies * contact->ranks.size, &j->shift,
                         contact->rows.n, &j->springs_on));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair      = &contact->pairs[p];
    PetscBool          linear[2] = {PETSC_FALSE, PETSC_FALSE}, layer[2];

    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) PetscCall(LookAt(op, pair->body[side], &linear[side], &layer[side]));
    for (PetscInt side = 0; side < 2 && linear[pair->dirichlet]; side++)
      if (linear[side] && !layer[side]) j->pairs[p] = any = PETSC_TRUE;
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool linear, layer, has = PETSC_FALSE;

    for (PetscInt k = 0; k < contact->body_rows[b].n_pairs; k++) has = (PetscBool)(has || j->pairs[contact->body_rows[b].pairs[k]]);
    PetscCall(LookAt(op, b, &linear, &layer));
    if (has && linear) j->slabs[j->n++] = (InterfaceSlab){.body = b, .is_layer = layer};
  }
  if (any && contact->ranks.size > 1) contact->parallel_factors = PETSC_TRUE;
  if (any) *joint = j;
  else PetscCall(InterfaceJointDestroy(&j));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Reset(InterfaceJoint j)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&j->K));
  PetscCall(MatDestroy(&j->C));
  PetscCall(MatDestroy(&j->scaled));
  PetscCall(MatDestroy(&j->springs));
  PetscCall(MatDestroy(&j->M));
  PetscCall(VecDestroy(&j->stiffness));
  PetscCall(VecDestroy(&j->rows));
  PetscCall(VecDestroy(&j->load));
  PetscCall(VecDestroy(&j->moved));
  PetscCall(KSPDestroy(&j->factors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterfaceJointDestroy(InterfaceJoint *joint)
{
  PetscFunctionBegin;
  if (!*joint) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Reset(*joint));
  for (PetscInt k = 0; k < (*joint)->n; k++) PetscCall(InterfaceSlabReset(&(*joint)->slabs[k]));
  PetscCall(PetscFree4((*joint)->slabs, (*joint)->pairs, (*joint)->shift, (*joint)->springs_on));
  PetscCall(PetscFree(*joint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether P has the rows of a pair */
PetscBool InterfaceJointHasPair(InterfaceJoint joint, PetscInt p)
{
  return (PetscBool)(joint && joint->pairs[p]);
}

/* K: on each rank the dofs of all slabs come one after the other */
static PetscErrorCode JoinSlabs(const Contact contact, InterfaceJoint j)
{
  const PetscMPIInt ranks = contact->ranks.size;
  PetscInt          begin = 0;
  Mat              *blocks, nest;

  PetscFunctionBegin;
  for (PetscMPIInt r = 0; r < ranks; r++)
    for (PetscInt k = 0; k < j->n; k++) {
      const PetscInt *ranges;

      PetscCall(MatGetOwnershipRanges(j->slabs[k].K, &ranges));
      j->shift[k * ranks + r] = begin - ranges[r];
      begin += ranges[r + 1] - ranges[r];
    }
  PetscCall(PetscCalloc1(j->n * j->n, &blocks));
  for (PetscInt k = 0; k < j->n; k++) blocks[k * j->n + k] = j->slabs[k].K;
  PetscCall(MatCreateNest(PetscObjectComm((PetscObject)contact), j->n, NULL, j->n, NULL, blocks, &nest));
  PetscCall(MatConvert(nest, MATAIJ, MAT_INITIAL_MATRIX, &j->K));
  PetscCall(MatDestroy(&nest));
  PetscCall(PetscFree(blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The entries of one row of a slab; zeros are left out, so that nothing hangs on where entries have been before */
static PetscErrorCode JoinRow(const Contact contact, InterfaceJoint j, PetscInt k, PetscInt row, PetscInt i, PetscInt sign)
{
  const PetscInt    *columns;
  const PetscScalar *values;
  PetscLayout        layout;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(MatGetLayouts(j->slabs[k].K, &layout, NULL));
  PetscCall(MatGetRow(j->slabs[k].rows, row, &n, &columns, &values));
  for (PetscInt l = 0; l < n; l++) {
    PetscInt number = 0;

    if (values[l] == 0) continue;
    PetscCall(InterfaceFindNumber(layout, j->shift + k * contact->ranks.size, contact->ranks.rank, columns[l], &number));
    PetscCall(MatSetValue(j->C, contact->rows.begin + i, number, sign * values[l], INSERT_VALUES));
  }
  PetscCall(MatRestoreRow(j->slabs[k].rows, row, &n, &columns, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C */
static PetscErrorCode JoinRows(const Contact contact, InterfaceJoint j)
{
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(j->K, &n, NULL));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)contact), &j->C));
  PetscCall(MatSetSizes(j->C, contact->rows.n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(j->C, MATAIJ));
  PetscCall(MatSetUp(j->C));
  for (PetscInt k = 0; k < j->n; k++) {
    const ContactBodyRows *of = &contact->body_rows[j->slabs[k].body];

    for (PetscInt l = 0; l < of->n; l++) {
      const PetscInt i = of->rows[l], p = contact->rows.pair[i];

      if (!j->pairs[p]) continue;
      PetscCall(JoinRow(contact, j, k, of->begin + l, i, InterfaceSide(&contact->pairs[p], j->slabs[k].body)));
    }
  }
  PetscCall(MatAssemblyBegin(j->C, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(j->C, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* D^{-1}, from what the dofs of each row answer with one by one: C diag(K)^{-1} C^T */
static PetscErrorCode MakeSprings(InterfaceJoint j)
{
  PetscScalar *stiffness;
  PetscInt     begin, end;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(j->C, &j->load, &j->stiffness));
  PetscCall(VecDuplicate(j->load, &j->moved));
  PetscCall(VecDuplicate(j->stiffness, &j->rows));
  PetscCall(MatGetDiagonal(j->K, j->load));
  PetscCall(VecSqrtAbs(j->load));
  PetscCall(VecReciprocal(j->load));
  PetscCall(MatDuplicate(j->C, MAT_COPY_VALUES, &j->scaled));
  PetscCall(MatDiagonalScale(j->scaled, NULL, j->load));
  PetscCall(MatGetOwnershipRange(j->scaled, &begin, &end));
  PetscCall(VecGetArrayWrite(j->stiffness, &stiffness));
  for (PetscInt i = begin; i < end; i++) {
    const PetscScalar *values;
    PetscInt           n;
    PetscReal          compliance = 0;

    PetscCall(MatGetRow(j->scaled, i, &n, NULL, &values));
    for (PetscInt l = 0; l < n; l++) compliance += PetscSqr(PetscRealPart(values[l]));
    PetscCall(MatRestoreRow(j->scaled, i, &n, NULL, &values));
    stiffness[i - begin] = compliance > 0 ? 1 / (SPRING_COMPLIANCE * compliance) : 0;
  }
  PetscCall(VecRestoreArrayWrite(j->stiffness, &stiffness));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C^T D^{-1} C with the springs there are */
static PetscErrorCode AddSprings(InterfaceOperator op, InterfaceJoint j, MatReuse reuse)
{
  const PetscScalar *stiffness;
  PetscScalar       *present;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(j->stiffness, &stiffness));
  PetscCall(VecGetArrayWrite(j->rows, &present));
  for (PetscInt i = 0; i < op->contact->rows.n; i++) present[i] = j->springs_on[i] ? stiffness[i] : 0;
  PetscCall(VecRestoreArrayWrite(j->rows, &present));
  PetscCall(VecRestoreArrayRead(j->stiffness, &stiffness));
  PetscCall(MatCopy(j->C, j->scaled, SAME_NONZERO_PATTERN));
  PetscCall(MatDiagonalScale(j->scaled, j->rows, NULL));
  PetscCall(MatTransposeMatMult(j->C, j->scaled, reuse, PETSC_DETERMINE, &j->springs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Factors of K + C^T D^{-1} C. Slabs are thin: factors fill in as those of a mesh in the plane do, whatever the dimension, but for the
   coarse dofs that all of them are next to. PETSc's own take 27 times as long then with 10^4 dofs as those of MUMPS. */
static PetscErrorCode Factor(InterfaceOperator op, InterfaceJoint j)
{
  const Contact contact = op->contact;
  PetscInt      size;
  PC            pc;

  PetscFunctionBegin;
  PetscCall(AddSprings(op, j, MAT_INITIAL_MATRIX));
  PetscCall(MatDuplicate(j->springs, MAT_COPY_VALUES, &j->M));
  PetscCall(MatAXPY(j->M, 1, j->K, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatSetOption(j->M, MAT_SPD, PETSC_TRUE));
  PetscCall(MatGetSize(j->M, &size, NULL));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)contact), &j->factors));
  PetscCall(KSPSetOperators(j->factors, j->M, j->M));
  PetscCall(KSPSetType(j->factors, KSPPREONLY));
  PetscCall(KSPGetPC(j->factors, &pc));
  if (contact->dim == 3 && size > MAX_SMALL_SIZE) PetscCall(ConstrainedSolverChooseMUMPS(pc));
  else PetscCall(ConstrainedSolverChoose(j->factors, j->M, PetscMin(contact->dim, 2)));
  PetscCall(KSPSetUp(j->factors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same where other rows are in: the order of the elimination stays */
static PetscErrorCode FactorAgain(InterfaceOperator op, InterfaceJoint j)
{
  PetscFunctionBegin;
  PetscCall(AddSprings(op, j, MAT_REUSE_MATRIX));
  PetscCall(MatZeroEntries(j->M));
  PetscCall(MatAXPY(j->M, 1, j->K, SUBSET_NONZERO_PATTERN));
  PetscCall(MatAXPY(j->M, 1, j->springs, SUBSET_NONZERO_PATTERN));
  PetscCall(KSPSetUp(j->factors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether factors for the rows that are in are worth their price, by sizes alone, so that it is the same on any number of ranks: factors of
   a mesh of N dofs that is thin take operations as N^(3/2) does, and solutions of the bodies, as which they have more entries, as N^(4/3).
   In the plane slabs are strips, whose factors are cheap. */
static PetscErrorCode LookAtPrice(InterfaceOperator op, InterfaceJoint j)
{
  PetscReal product = 0;
  PetscInt  size;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < j->n; k++) {
    Mat A;

    PetscCall(BodyGetComplianceMatrices(op->contact->bodies[j->slabs[k].body], &A, NULL));
    PetscCall(MatGetSize(A, &size, NULL));
    product += PetscPowReal((PetscReal)size, 4. / 3);
  }
  PetscCall(MatGetSize(j->K, &size, NULL));
  j->follows = (PetscBool)(op->contact->dim < 3 || PetscPowReal((PetscReal)size, 1.5) <= FACTORS_PER_PRODUCT * product);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives springs to the rows that are to have them; whether these are others than before, on any rank */
static PetscErrorCode TakeRows(InterfaceOperator op, InterfaceJoint j, PetscBool *others)
{
  PetscFunctionBegin;
  *others = PETSC_FALSE;
  for (PetscInt i = 0; i < op->contact->rows.n; i++) {
    const PetscBool springs = (PetscBool)(!j->follows || InterfaceIsIn(op, i));

    if (j->springs_on[i] != springs) *others = PETSC_TRUE;
    j->springs_on[i] = springs;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, others, 1, MPI_C_BOOL, MPI_LOR, PetscObjectComm((PetscObject)op->contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Join(InterfaceOperator op, InterfaceJoint j)
{
  PetscFunctionBegin;
  PetscCall(Reset(j));
  PetscCall(JoinSlabs(op->contact, j));
  PetscCall(JoinRows(op->contact, j));
  PetscCall(MakeSprings(j));
  PetscCall(LookAtPrice(op, j));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the matrices of the bodies and the rows that are in as they are now */
PetscErrorCode InterfaceJointUpdate(InterfaceOperator op, InterfaceJoint j)
{
  PetscBool changed = PETSC_FALSE, others;

  PetscFunctionBegin;
  if (!j) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < j->n; k++) PetscCall(InterfaceSlabUpdate(op->contact, &j->slabs[k], &changed));
  if (changed) PetscCall(Join(op, j));
  PetscCall(TakeRows(op, j, &others));
  if (changed) PetscCall(Factor(op, j));
  else if (others) PetscCall(FactorAgain(op, j));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = P x on the rows that P has and that are in */
PetscErrorCode InterfaceJointApply(InterfaceOperator op, InterfaceJoint j, const PetscScalar x[], PetscScalar y[])
{
  const PetscScalar *stiffness, *moved;
  PetscScalar       *force;

  PetscFunctionBegin;
  if (!j) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(j->stiffness, &stiffness));
  PetscCall(VecGetArrayWrite(j->rows, &force));
  for (PetscInt i = 0; i < op->contact->rows.n; i++) force[i] = InterfaceIsIn(op, i) ? stiffness[i] * x[i] : 0;
  PetscCall(VecRestoreArrayWrite(j->rows, &force));
  PetscCall(MatMultTranspose(j->C, j->rows, j->load));
  PetscCall(KSPSolve(j->factors, j->load, j->moved));
  PetscCall(MatMult(j->C, j->moved, j->rows));
  PetscCall(VecGetArrayRead(j->rows, &moved));
  for (PetscInt i = 0; i < op->contact->rows.n; i++)
    if (InterfaceIsIn(op, i) && stiffness[i] != 0) y[i] = stiffness[i] * (x[i] - moved[i]);
  PetscCall(VecRestoreArrayRead(j->rows, &moved));
  PetscCall(VecRestoreArrayRead(j->stiffness, &stiffness));
  PetscFunctionReturn(PETSC_SUCCESS);
}
