/* How rows answer to impulses on them, and forces on nodes with mass. */
#include <body/layout/bodyimpl.h>

/* With more rows no column is made for each of them */
#define MAX_PROBED_ROWS 2000

/* change = M^{-1} B^T force, zero on massless nodes; one force for each row of this rank. By columns, where the solver keeps them. */
PetscErrorCode BodySolveMassOfRows(Body body, const PetscScalar force[], Vec change)
{
  PetscFunctionBegin;
  if (body->mass.solver && !body->layer.exists) {
    PetscCall(ConstrainedSolverBring(body->mass.solver, force));
    PetscCall(ConstrainedSolverCorrect(body->mass.solver, NULL, change));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodySpreadRows(body, body->rows.matrix, force, body->work.nodes[0]));
  PetscCall(BodyZeroHeld(body, body->work.nodes[0]));
  PetscCall(BodySolveMass(body, body->work.nodes[0], change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B D B^T, or B D^{-1} B^T, with a diagonal D that is not negative, without held dofs: sparse */
static PetscErrorCode MultiplyRows(Body body, Vec diagonal, PetscBool inverse, Mat *matrix)
{
  Mat scaled;
  Vec root;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(diagonal, &root));
  PetscCall(VecCopy(diagonal, root));
  if (inverse) PetscCall(VecReciprocal(root)); /* leaves zeros */
  PetscCall(VecSqrtAbs(root));
  PetscCall(MatDuplicate(body->rows.free_matrix, MAT_COPY_VALUES, &scaled));
  PetscCall(MatDiagonalScale(scaled, NULL, root));
  PetscCall(MatMatTransposeMult(scaled, scaled, MAT_INITIAL_MATRIX, PETSC_DETERMINE, matrix));
  PetscCall(MatDestroy(&scaled));
  PetscCall(VecDestroy(&root));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B M^{-1} B^T with a mass matrix that is not diagonal: dense, a solution for each row */
static PetscErrorCode ProbeRows(Body body, Mat matrix)
{
  const BodyRows *rows = &body->rows;
  PetscScalar    *unit, *moved;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(rows->local, &unit, rows->local, &moved));
  for (PetscInt j = 0; j < rows->global; j++) {
    const PetscInt local = j - rows->begin;

    if (local >= 0 && local < rows->local) unit[local] = 1;
    PetscCall(BodyMultiplyInverseMass(body, unit, moved));
    if (local >= 0 && local < rows->local) unit[local] = 0;
    for (PetscInt i = 0; i < rows->local; i++)
      if (moved[i] != 0) PetscCall(MatSetValue(matrix, rows->begin + i, j, moved[i], INSERT_VALUES));
  }
  PetscCall(PetscFree2(unit, moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B M^{-1} B^T of all rows [1/kg], without prescribed rows; zero for massless nodes and static bodies. The caller destroys the matrix.
   Sparse with a lumped mass, where rows couple that share a node; else at most 2000 rows, all coupled. Collective. */
PetscErrorCode BodyComputeInverseMass(Body body, PetscBool lumped, Mat *matrix)
{
  const BodyRows *rows    = &body->rows;
  const PetscBool inertia = body->integrator->has_inertia;
  MPI_Comm        comm    = PetscObjectComm((PetscObject)body);

  PetscFunctionBegin;
  if (inertia && (lumped || body->mass.inverse)) {
    PetscCall(MultiplyRows(body, lumped ? body->mass.row_sum : body->mass.inverse, lumped, matrix));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(!inertia || rows->global <= MAX_PROBED_ROWS, comm, PETSC_ERR_SUP,
             "Body '%s': a mass that is not lumped couples all contact nodes, of which there are %" PetscInt_FMT
             ", more than %d; set -%smass_type lumped, or choose -contact_type schwarz",
             body->hdr.name, rows->global, MAX_PROBED_ROWS, ((PetscObject)body)->prefix);
  PetscCall(MatCreate(comm, matrix));
  PetscCall(MatSetSizes(*matrix, rows->local, rows->local, rows->global, rows->global));
  PetscCall(MatSetType(*matrix, MATAIJ));
  PetscCall(MatSetUp(*matrix));
  if (inertia) PetscCall(ProbeRows(body, *matrix));
  PetscCall(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* velocity = B M^{-1} B^T impulse for the rows of this rank [m/s], [N s]. Collective. */
PetscErrorCode BodyMultiplyInverseMass(Body body, const PetscScalar impulse[], PetscScalar velocity[])
{
  PetscFunctionBegin;
  PetscCall(BodySolveMassOfRows(body, impulse, body->work.nodes[2]));
  PetscCall(BodyReadRows(body, body->rows.matrix, body->work.nodes[2], velocity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the mass matrix is at least, relative to the lumped one: the smallest eigenvalue of any element's pair of them, for linear
   shape functions on lines, simplices, and products of lines */
static PetscReal LeastMass(const struct _p_Body *body)
{
  const PetscBool simplex = (PetscBool)(body->mesh.cell_nodes == body->mesh.dim + 1);
  /* the middle node of composite tetrahedra is a mean: its mass, at most half of the others', counts for nothing where these cancel */
  const PetscReal middle = body->model.element->composite && body->mesh.dim == 3 ? 0.5 : 1;
  const PetscReal least  = simplex ? middle / (body->mesh.dim + 2) : PetscPowRealInt(3, -body->mesh.dim);

  return body->mass.type == BODY_MASS_AVERAGED ? 0.5 * (1 + least) : least;
}

/* Bound of each row's velocity after a unit impulse on it, in an explicit body without massless nodes [1/kg]: the diagonal of
   BodyComputeInverseMass(), or one from eigenvalues of elements' masses where many rows meet a mass that is not lumped. Collective. */
PetscErrorCode BodyBoundInverseMass(Body body, PetscReal bound[])
{
  const PetscBool    lumped = (PetscBool)(!body->mass.inverse && body->rows.global > MAX_PROBED_ROWS);
  const PetscScalar *values;
  Mat                matrix;
  Vec                diagonal;

  PetscFunctionBegin;
  PetscCall(BodyComputeInverseMass(body, lumped, &matrix));
  if (lumped) PetscCall(MatScale(matrix, 1 / LeastMass(body)));
  PetscCall(MatCreateVecs(matrix, NULL, &diagonal));
  PetscCall(MatGetDiagonal(matrix, diagonal));
  PetscCall(VecGetArrayRead(diagonal, &values));
  PetscCall(PetscArraycpy(bound, values, body->rows.local));
  PetscCall(VecRestoreArrayRead(diagonal, &values));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(MatDestroy(&matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest nodal force on a node with mass, and on any, under forces on the rows of this rank [N]. Collective. */
PetscErrorCode BodyGetForceOnMass(Body body, const PetscReal force[], PetscReal *on_mass, PetscReal *largest)
{
  const PetscScalar *nodal;
  PetscReal          most[2] = {0, 0};

  PetscFunctionBegin;
  PetscCall(BodySpreadRows(body, body->rows.matrix, force, body->work.nodes[0]));
  PetscCall(VecGetArrayRead(body->work.nodes[0], &nodal));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++) {
    most[1] = PetscMax(most[1], PetscAbsReal(nodal[i]));
    if (!body->layer.contains[i / body->mesh.dim]) most[0] = PetscMax(most[0], PetscAbsReal(nodal[i]));
  }
  PetscCall(VecRestoreArrayRead(body->work.nodes[0], &nodal));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most, 2, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)body)));
  *on_mass = most[0];
  *largest = most[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}
