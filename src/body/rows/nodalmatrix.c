/* Displacements of nodes under unit forces on them, at the end of a controller step of one substep, by solutions with a matrix in place of
   controller steps. Which matrix that is:

   - the tangent of the massless layer, of an explicit body whose forces grow from none: exact for linear bodies. Nodes with mass do not
     feel what acts at the end of a step alone;
   - the effective matrix A of an implicit body: exact for linear ones; of nonlinear ones that of the last iteration of Newton's method;
   - that of a slab at the surface and what the body may do beyond it on a coarse grid, P^T A P, undeformed: approximate. Whoever uses it
   corrects it by what the body does;
   - the stiffness of an explicit body with many substeps, for these where forces are felt: exact for linear bodies.

   Under a force f that grows from none an implicit body goes by A^{-1} f. One that is constant acts at the start as well, and the body goes
   twice as far: but massless nodes, which have no start, by the static answer of their layer less. */
#include "complianceimpl.h"
#include <solver/constrainedsolver.h>

#define COLUMNS    64    /* that are solved for together */
#define SHIFT      1e-10 /* what is added to the diagonal of P^T A P, in parts of it */
#define LAYERS     5     /* of elements that a slab has whole: what it lacks is a hundredth of what one of three does */
#define MANY       100   /* displacements, from which on a slab is asked and not controller steps */
#define SMALL_BODY 5000  /* displacements of a body whose own matrix is asked however many they are: a solution costs little then */

typedef enum { BY_STEPS = NODAL_BY_STEPS, BY_BODY, BY_LAYER, BY_SLAB, BY_FRONT } Kind;

struct _NodalMatrix {
  Kind              kind;
  Mat               functions; /* P; NULL: all displacements, one by one */
  ConstrainedSolver solver;    /* that the body has for the matrix; NULL: the following are */
  Mat               matrix;    /* P^T A P, or the stiffness */
  KSP               ksp;
};

PetscErrorCode NodalMatrixDestroy(NodalMatrix *nodal)
{
  PetscFunctionBegin;
  if (!*nodal) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*nodal)->functions));
  PetscCall(MatDestroy(&(*nodal)->matrix));
  PetscCall(KSPDestroy(&(*nodal)->ksp));
  PetscCall(PetscFree(*nodal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether each BodyGetNodalCompliance() of n displacements gives others: of nonlinear implicit bodies with one substep and factors of
   the last iteration of Newton's method, but for more than 100 displacements of a body of more than 5000 */
PetscErrorCode BodyNodalComplianceFollows(Body body, PetscInt n, PetscBool *follows)
{
  PetscInt all;

  PetscFunctionBegin;
  PetscCall(VecGetSize(body->state.u, &all));
  *follows = (PetscBool)(body->integrator->uses_newton && body->time.substeps == 1 && (n <= MANY || all <= SMALL_BODY) &&
                         ConstrainedSolverIsDirect(body->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What tells how n displacements answer */
static PetscErrorCode Choose(Body body, BodyForceShape shape, PetscInt n, Kind *kind)
{
  const PetscBool is_explicit = (PetscBool)(body->integrator->staggered > 0), inertia = body->integrator->has_inertia;
  const PetscBool lumped  = (PetscBool)(body->mass.inverse && !body->layer.exists && !body->damping);
  PetscBool       follows = PETSC_FALSE;
  PetscInt        all;

  PetscFunctionBegin;
  *kind = BY_STEPS;
  if (!body->integrator->deforms) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->time.substeps > 1) {
    if (body->rows.size == 1 && is_explicit && n > MANY && lumped) *kind = BY_FRONT;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!body->solver) PetscFunctionReturn(PETSC_SUCCESS);
  if (is_explicit) {
    if (shape == BODY_FORCE_LINEAR && body->layer.exists) *kind = BY_LAYER;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecGetSize(body->state.u, &all));
  PetscCall(BodyNodalComplianceFollows(body, n, &follows));
  if (follows || (body->model.linear && (n <= MANY || all <= SMALL_BODY || !inertia))) *kind = BY_BODY;
  else if (body->model.linear || (inertia && n > MANY)) *kind = BY_SLAB;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The effective matrix of the whole undeformed body */
static PetscErrorCode GetMatrix(Body body, Mat *A)
{
  PetscFunctionBegin;
  if (body->model.linear) {
    PetscCall(ConstrainedSolverGetMatrices(body->solver, A, NULL));
    PetscCall(PetscObjectReference((PetscObject)*A));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyCreateMatrix(body, NULL, A));
  PetscCall(BodyAssembleTangent(body, NULL, NULL, *A));
  PetscCall(BodyAddMassMatrix(body, 4 / PetscSqr(body->time.step), *A));
  PetscCall(BodyAddSpringStiffness(body, *A));
  PetscCall(BodyEliminateHeld(body, *A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Factor(Body body, NodalMatrix nodal, Mat A)
{
  Vec diagonal;
  PC  pc;

  PetscFunctionBegin;
  PetscCall(MatPtAP(A, nodal->functions, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &nodal->matrix));
  PetscCall(MatProductClear(nodal->matrix)); /* which would keep A */
  PetscCall(MatCreateVecs(nodal->matrix, &diagonal, NULL));
  PetscCall(MatGetDiagonal(nodal->matrix, diagonal));
  PetscCall(VecScale(diagonal, SHIFT));
  PetscCall(MatDiagonalSet(nodal->matrix, diagonal, ADD_VALUES));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)body), &nodal->ksp));
  PetscCall(KSPSetType(nodal->ksp, KSPPREONLY));
  PetscCall(KSPGetPC(nodal->ksp, &pc));
  PetscCall(KSPSetOperators(nodal->ksp, nodal->matrix, nodal->matrix));
  PetscCall(ConstrainedSolverChooseMUMPS(pc));
  PetscCall(KSPSetUp(nodal->ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* NodalMatrixRenew - the matrix that tells how some displacements answer, of n in all, in place of an old one; NULL: controller steps have
   to. `kind`: of the columns that are known, NODAL_BY_STEPS if by controller steps; `renewed`: they are of another one. */
PetscErrorCode NodalMatrixRenew(Body body, BodyForceShape shape, PetscInt n, PetscInt n_dofs, const PetscInt dofs[], PetscInt *kind,
                                NodalMatrix *nodal, PetscBool *renewed)
{
  Kind chosen;
  Mat  A;

  PetscFunctionBegin;
  PetscCall(Choose(body, shape, n, &chosen));
  *renewed = (PetscBool)(*kind != (PetscInt)chosen);
  if (*renewed) PetscCall(NodalMatrixDestroy(nodal));
  *kind = chosen;
  if (chosen == BY_BODY && body->integrator->uses_newton) PetscCall((*body->integrator->ops.renew)(body));
  if (chosen == BY_STEPS || *nodal) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscNew(nodal));
  (*nodal)->kind = chosen;
  if (chosen == BY_BODY) (*nodal)->solver = body->solver;
  if (chosen == BY_FRONT) PetscCall(FrontCreateMatrix(body, &(*nodal)->matrix));
  if (chosen != BY_SLAB) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GetMatrix(body, &A));
  PetscCall(BodyCreateSlabFunctions(body, A, n_dofs, dofs, LAYERS, &(*nodal)->functions));
  PetscCall(Factor(body, *nodal, A));
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Unit forces on some displacements, in terms of P: columns of a dense matrix, or rows of a sparse one */
static PetscErrorCode FillForces(Body body, const NodalMatrix nodal, PetscInt n, const PetscInt dofs[], PetscBool sparse, Mat forces)
{
  const PetscScalar one = 1;
  PetscInt          begin, end;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(body->state.u, &begin, &end));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt    *columns = &dofs[k];
    const PetscScalar *values  = &one;
    PetscInt           entries = 1;

    if (dofs[k] < begin || dofs[k] >= end) continue;
    if (nodal->functions) PetscCall(MatGetRow(nodal->functions, dofs[k], &entries, &columns, &values));
    if (sparse) PetscCall(MatSetValues(forces, 1, &k, entries, columns, values, INSERT_VALUES));
    else PetscCall(MatSetValues(forces, entries, columns, 1, &k, values, INSERT_VALUES));
    if (nodal->functions) PetscCall(MatRestoreRow(nodal->functions, dofs[k], &entries, &columns, &values));
  }
  PetscCall(MatAssemblyBegin(forces, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(forces, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By factors of MUMPS on one rank: forward solutions begin where forces are, which halves their cost */
static PetscErrorCode SolveSparse(Body body, const NodalMatrix nodal, PetscInt n, const PetscInt dofs[], Mat factors, Mat answers)
{
  PetscInt all;
  Mat      forces;

  PetscFunctionBegin;
  PetscCall(MatGetSize(answers, &all, NULL));
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, n, all, nodal->functions ? PETSC_DEFAULT : 1, NULL, &forces));
  PetscCall(MatSetOption(forces, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  PetscCall(FillForces(body, nodal, n, dofs, PETSC_TRUE, forces));
  PetscCall(MatMatTransposeSolve(factors, forces, answers));
  PetscCall(MatDestroy(&forces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacements under unit forces on some of them, at most COLUMNS, in terms of P */
static PetscErrorCode Solve(Body body, const NodalMatrix nodal, PetscInt n, const PetscInt dofs[], Mat *answers)
{
  MPI_Comm    comm    = PetscObjectComm((PetscObject)body);
  Mat         factors = NULL, forces;
  PetscInt    local;
  PetscMPIInt size;
  PC          pc;

  PetscFunctionBegin;
  if (nodal->functions) PetscCall(MatGetLocalSize(nodal->functions, NULL, &local));
  else PetscCall(VecGetLocalSize(body->state.u, &local));
  PetscCall(MatCreateDense(comm, local, PETSC_DECIDE, PETSC_DETERMINE, n, NULL, answers));
  if (nodal->solver) PetscCall(ConstrainedSolverGetMUMPS(nodal->solver, &factors));
  else {
    PetscCall(KSPGetPC(nodal->ksp, &pc));
    PetscCall(PCFactorGetMatrix(pc, &factors));
  }
  PetscCallMPI(MPI_Comm_size(comm, &size));
  if (factors && size == 1) {
    PetscCall(SolveSparse(body, nodal, n, dofs, factors, *answers));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatDuplicate(*answers, MAT_DO_NOT_COPY_VALUES, &forces));
  PetscCall(FillForces(body, nodal, n, dofs, PETSC_FALSE, forces));
  if (nodal->solver) {
    KSPConvergedReason reason;

    PetscCall(ConstrainedSolverSolveFreeColumns(nodal->solver, forces, *answers));
    reason = ConstrainedSolverTakeFailure(nodal->solver);
    PetscCheck(reason >= 0, comm, PETSC_ERR_NOT_CONVERGED,
               "The linear solver of body '%s' did not converge at time %.9g s (its step %" PetscInt_FMT
               "): %s; allow more iterations (-%sksp_max_it), or choose another preconditioner or a direct solver (-%spc_type cholesky)",
               ((PetscObject)body)->name, (double)(body->saved.time + body->time.step), body->saved.step + 1, KSPConvergedReasons[reason],
               ((PetscObject)body)->prefix, ((PetscObject)body)->prefix);
  } else PetscCall(MatMatSolve(factors, forces, *answers));
  PetscCall(MatDestroy(&forces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns of some displacements, at most COLUMNS */
static PetscErrorCode SolveColumns(Body body, const NodalMatrix nodal, BodyForceShape shape, PetscInt n, const PetscInt dofs[],
                                   Compliance compliance)
{
  const Vec          column = body->work.nodes[0], of_layer = body->work.nodes[1];
  const PetscBool    layer = (PetscBool)(nodal->kind == BY_LAYER || (shape == BODY_FORCE_CONSTANT && body->layer.exists));
  const PetscScalar *values;
  Mat                answers = NULL;
  Vec                answer;

  PetscFunctionBegin;
  if (nodal->kind != BY_LAYER) PetscCall(Solve(body, nodal, n, dofs, &answers));
  if (answers && layer) { /* undeformed */
    PetscCall(VecZeroEntries(of_layer));
    PetscCall(BodyPrepareLayer(body, of_layer));
  }
  for (PetscInt k = 0; k < n; k++) {
    PetscCall(VecZeroEntries(column));
    if (answers) {
      PetscCall(MatDenseGetColumnVecRead(answers, k, &answer));
      if (nodal->functions) PetscCall(MatMult(nodal->functions, answer, column));
      else PetscCall(VecCopy(answer, column));
      PetscCall(MatDenseRestoreColumnVecRead(answers, k, &answer));
      PetscCall(VecScale(column, shape == BODY_FORCE_CONSTANT ? 2 : 1));
    }
    if (layer) {
      PetscCall(ComplianceSetUnit(of_layer, dofs[k]));
      /* an explicit body has the factors of its layer's balance */
      if (answers) PetscCall(BodyApplyLayerCompliance(body, of_layer, of_layer));
      else {
        PetscCall(BodyReadLayer(body, of_layer, body->layer.rhs));
        PetscCall(ConstrainedSolverSolveFree(body->solver, body->layer.rhs, body->layer.solution));
        PetscCall(VecZeroEntries(of_layer));
        PetscCall(BodyWriteLayer(body, body->layer.solution, INSERT_VALUES, of_layer));
      }
      PetscCall(VecAXPY(column, answers ? -1 : 1, of_layer));
    }
    PetscCall(BodyZeroHeld(body, column)); /* the matrix has some stiffness there */
    PetscCall(VecGetArrayRead(column, &values));
    PetscCall(ComplianceSetColumn(compliance, dofs[k], values));
    PetscCall(VecRestoreArrayRead(column, &values));
  }
  PetscCall(MatDestroy(&answers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* NodalMatrixProbe - columns of displacements, by their numbers on all ranks; NULL: by controller steps */
PetscErrorCode NodalMatrixProbe(Body body, const NodalMatrix nodal, BodyForceShape shape, PetscInt n, const PetscInt dofs[],
                                Compliance compliance)
{
  PetscInt some[COLUMNS], count = 0;

  PetscFunctionBegin;
  if (!nodal) {
    PetscCall(BodyProbeNodes(body, shape, n, dofs, compliance));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (nodal->kind == BY_FRONT) {
    PetscCall(FrontProbe(body, nodal->matrix, shape, n, dofs, compliance));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < n; i++) {
    if (!ComplianceKnows(compliance, dofs[i])) some[count++] = dofs[i];
    if (!count || (count < COLUMNS && i < n - 1)) continue;
    PetscCall(SolveColumns(body, nodal, shape, count, some, compliance));
    count = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How a column is found, for those who look */
const char *NodalMatrixDescribe(const NodalMatrix nodal)
{
  const char *const names[] = {"solution with its own matrix", "solution with the massless layer", "solution with a slab at the surface",
                               "controller step where forces are felt"};

  return nodal ? names[nodal->kind] : "controller step";
}
