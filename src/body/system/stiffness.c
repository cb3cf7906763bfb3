/* Internal force, tangent and stiffness matrix. */
#include <body/layout/bodyimpl.h>

/* The elements that forces and tangents come from */
PetscErrorCode BodyGetElement(Body body, Element *element)
{
  PetscFunctionBegin;
  *element = body->model.element;
  if (!body->model.linearized || body->model.linear) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(body->model.linearized_element, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Body '%s': call BodyPrepareLinearized() before its forces are linearized", body->hdr.name);
  *element = body->model.linearized_element;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* f = internal force for displacement u [N] */
PetscErrorCode BodyComputeInternalForce(Body body, Vec u, Vec f)
{
  const PetscScalar *u_array;
  PetscScalar       *f_array;
  Vec                u_local, f_local;
  Element            element;

  PetscFunctionBegin;
  if (!body->integrator->deforms) {
    PetscCall(VecZeroEntries(f));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyGetElement(body, &element));
  PetscCall(PetscLogEventBegin(BODY_InternalForce, body, 0, 0, 0));
  PetscCall(BodyGetLocalRead(body, u, &u_local, &u_array));
  PetscCall(BodyGetLocalSum(body, f, &f_local, &f_array));
  PetscCall((*element->ops->internalforce)(element, u_array, f_array));
  PetscCall(BodyRestoreLocalSum(body, f, &f_local, &f_array));
  PetscCall(BodyRestoreLocalRead(body, u, &u_local, &u_array));
  PetscCall(BodyHistoryNote(body, u));
  PetscCall(PetscLogEventEnd(BODY_InternalForce, body, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyFindInternalForce - that of the present state, of a body whose integrator leaves it until it is needed. That of the saved state stays
   known until another one is found, so that the next step begins with it. */
PetscErrorCode BodyFindInternalForce(Body body)
{
  PetscFunctionBegin;
  if (body->state.force_known || !body->integrator->leaves_force) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
  body->state.force_known = PETSC_TRUE;
  body->saved.force_known = (PetscBool)(body->state.step == body->saved.step);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyEndHistory - the history of the material at the end of the substep, by another look at the elements where that is not known */
PetscErrorCode BodyEndHistory(Body body)
{
  PetscBool taken;

  PetscFunctionBegin;
  PetscCall(BodyHistoryTakeEnd(body, &taken));
  if (taken) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyComputeInternalForce(body, body->state.u, body->work.nodes[0]));
  PetscCall(BodyHistoryTakeEnd(body, &taken));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The global numbers of an element's displacements, from the numbers of its nodes on this rank */
PetscErrorCode BodyGetElementDofs(Body body, PetscInt e, PetscInt dofs[])
{
  const PetscInt *nodes = body->mesh.connectivity + e * body->model.element->nodes;
  PetscInt        rstart;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(body->mesh.positions, &rstart, NULL));
  for (PetscInt n = 0; n < body->model.element->nodes; n++)
    for (PetscInt d = 0; d < body->mesh.dim; d++)
      dofs[n * body->mesh.dim + d] = nodes[n] < body->mesh.owned_nodes
                                         ? rstart + nodes[n] * body->mesh.dim + d
                                         : body->mesh.ghost_dofs[(nodes[n] - body->mesh.owned_nodes) * body->mesh.dim + d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodes that the mass couples beyond the elements */
static PetscErrorCode AddMassToGraph(Body body, Mat graph)
{
  PetscInt begin, end;

  PetscFunctionBegin;
  if (!body->mass.of_nodes) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatGetOwnershipRange(graph, &begin, &end));
  for (PetscInt row = begin; row < end; row++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(body->mass.of_nodes, row, &n, &columns, &values));
    PetscCall(MatSetValues(graph, 1, &row, n, columns, values, INSERT_VALUES));
    PetscCall(MatRestoreRow(body->mass.of_nodes, row, &n, &columns, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which nodes share an element or mass, of those marked (NULL: all), as a matrix of nodes: far smaller than one of displacements */
PetscErrorCode BodyCreateNodeGraph(Body body, const PetscBool marked[], Mat *graph)
{
  const PetscInt n = body->model.element->nodes;
  PetscScalar    ones[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];
  PetscInt       nodes[ELEMENT_MAX_DOFS], dofs[ELEMENT_MAX_DOFS] = {0};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n * n; i++) ones[i] = 1;
  PetscCall(MatCreate(PetscObjectComm((PetscObject)body), graph));
  PetscCall(MatSetSizes(*graph, body->mesh.owned_nodes, body->mesh.owned_nodes, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(*graph, MATAIJ));
  PetscCall(MatSetUp(*graph));
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    if (marked && !marked[e]) continue;
    PetscCall(BodyGetElementDofs(body, e, dofs));
    for (PetscInt a = 0; a < n; a++) nodes[a] = dofs[a * body->mesh.dim] / body->mesh.dim;
    PetscCall(MatSetValues(*graph, n, nodes, n, nodes, ones, INSERT_VALUES));
  }
  PetscCall(AddMassToGraph(body, *graph));
  PetscCall(MatAssemblyBegin(*graph, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*graph, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Zeros wherever elements or the mass have entries: what has none when a matrix is assembled first loses its room */
static PetscErrorCode FillPattern(Body body, Mat A)
{
  const PetscInt dim = body->mesh.dim, n = body->model.element->nodes * dim;
  PetscInt       dofs[ELEMENT_MAX_DOFS], begin, end;
  PetscScalar    zeros[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS] = {0};

  PetscFunctionBegin;
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    PetscCall(BodyGetElementDofs(body, e, dofs));
    PetscCall(MatSetValues(A, n, dofs, n, dofs, zeros, ADD_VALUES));
  }
  PetscCall(MatGetOwnershipRange(body->mass.matrix, &begin, &end));
  for (PetscInt row = begin; row < end; row++) {
    const PetscInt *columns;
    PetscInt        n_columns;

    PetscCall(MatGetRow(body->mass.matrix, row, &n_columns, &columns, NULL));
    for (PetscInt k = 0; k < n_columns; k++) PetscCall(MatSetValue(A, row, columns[k], 0, ADD_VALUES));
    PetscCall(MatRestoreRow(body->mass.matrix, row, &n_columns, &columns, NULL));
  }
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An empty matrix with room for what elements, of those that are marked (NULL: all), and the mass couple. DMPLEX's own count goes through
   the mesh entity by entity, which takes ten times as long as that of the graph. */
PetscErrorCode BodyCreateMatrix(Body body, const PetscBool marked[], Mat *A)
{
  const PetscInt dim = body->mesh.dim, n = body->mesh.owned_nodes * dim;
  PetscInt       begin, end, *here, *elsewhere;
  Mat            graph;

  PetscFunctionBegin;
  PetscCall(BodyCreateNodeGraph(body, marked, &graph));
  PetscCall(MatGetOwnershipRange(graph, &begin, &end));
  PetscCall(PetscCalloc2(n, &here, n, &elsewhere));
  for (PetscInt row = begin; row < end; row++) {
    const PetscInt *columns;
    PetscInt        n_columns, inside = 0;

    PetscCall(MatGetRow(graph, row, &n_columns, &columns, NULL));
    for (PetscInt k = 0; k < n_columns; k++) inside += columns[k] >= begin && columns[k] < end;
    for (PetscInt d = 0; d < dim; d++) {
      here[(row - begin) * dim + d]      = dim * inside;
      elsewhere[(row - begin) * dim + d] = dim * (n_columns - inside);
    }
    PetscCall(MatRestoreRow(graph, row, &n_columns, &columns, NULL));
  }
  PetscCall(MatDestroy(&graph));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)body), A));
  PetscCall(MatSetSizes(*A, n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetBlockSize(*A, dim));
  PetscCall(MatSetType(*A, MATAIJ));
  PetscCall(MatSeqAIJSetPreallocation(*A, 0, here));
  PetscCall(MatMPIAIJSetPreallocation(*A, 0, here, 0, elsewhere));
  PetscCall(PetscFree2(here, elsewhere));
  PetscCall(MatSetOption(*A, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatSetOption(*A, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  PetscCall(MatSetOption(*A, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  if (body->mass.of_nodes) PetscCall(FillPattern(body, *A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix to put values in: itself or, of a body on one of several ranks, its block, which is assembled without messages */
PetscErrorCode BodyBeginAssembly(Body body, Mat all, Mat *here)
{
  PetscBool assembled = PETSC_FALSE;

  PetscFunctionBegin;
  *here = all;
  if (body->mesh.whole) PetscCall(MatAssembled(all, &assembled));
  if (assembled) PetscCall(MatMPIAIJGetSeqAIJ(all, here, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Solvers see that the matrix has other values */
PetscErrorCode BodyEndAssembly(Mat all, Mat here)
{
  PetscFunctionBegin;
  if (here != all) PetscCall(PetscObjectStateIncrease((PetscObject)all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K = tangent stiffness at displacement u; NULL: undeformed; of the elements that are marked, NULL: all [N/m] */
PetscErrorCode BodyAssembleTangent(Body body, Vec u, const PetscBool marked[], Mat K)
{
  const PetscInt     n = body->model.element->nodes * body->mesh.dim;
  PetscInt           dofs[ELEMENT_MAX_DOFS];
  PetscScalar        tangent[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], *zero = NULL;
  const PetscScalar *array;
  Element            element;
  ElementHistory     before;
  Vec                local;

  PetscFunctionBegin;
  PetscCall(BodyGetElement(body, &element));
  before = body->model.element->history;
  if (!u) BodyHistoryForget(body, &before);
  PetscCall(PetscLogEventBegin(BODY_Tangent, body, 0, 0, 0));
  PetscCall(MatZeroEntries(K));
  if (u) PetscCall(BodyGetLocalRead(body, u, &local, &array));
  else {
    PetscCall(PetscCalloc1(body->mesh.local_nodes * body->mesh.dim, &zero));
    array = zero;
  }
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    if (marked && !marked[e]) continue;
    PetscCall((*element->ops->tangent)(element, e, PETSC_FALSE, array, tangent));
    PetscCall(BodyGetElementDofs(body, e, dofs));
    PetscCall(MatSetValues(K, n, dofs, n, dofs, tangent, ADD_VALUES));
  }
  if (u) PetscCall(BodyRestoreLocalRead(body, u, &local, &array));
  else BodyHistoryLookBack(body, &before);
  PetscCall(PetscFree(zero));
  PetscCall(MatAssemblyBegin(K, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(K, MAT_FINAL_ASSEMBLY));
  PetscCall(PetscLogEventEnd(BODY_Tangent, body, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stiffness matrix of the undeformed body, made when it is first asked for: explicit bodies without contact never need it */
PetscErrorCode BodyGetStiffness(Body body, Mat *K)
{
  PetscFunctionBegin;
  if (!body->model.stiffness) {
    PetscCall(BodyCreateMatrix(body, NULL, &body->model.stiffness));
    PetscCall(BodyAssembleTangent(body, NULL, NULL, body->model.stiffness));
  }
  *K = body->model.stiffness;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From values of each element to those of each cell, in place */
static void SpreadOverCells(Body body, PetscInt n, PetscReal values[])
{
  const PetscInt cells = body->mesh.cells_of_element;

  for (PetscInt c = body->mesh.n_cells - 1; c >= 0 && cells > 1; c--)
    for (PetscInt i = 0; i < n; i++) values[n * c + i] = values[n * (c / cells) + i];
}

/*@
  BodyComputeStress - mean Cauchy stress of each element at the current displacement

  Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. stress - xx, yy, zz, xy, yz, xz for each cell of this rank, in the order of `BodyGetCells()` [Pa]; zero in a rigid body

  Level: intermediate

.seealso: `Body`, `BodyGetCells()`
@*/
PetscErrorCode BodyComputeStress(Body body, PetscReal stress[])
{
  const PetscScalar *u;
  Vec                local;
  ElementHistory     before;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  if (!body->integrator->deforms) {
    PetscCall(PetscArrayzero(stress, 6 * body->mesh.n_cells));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyGetLocalRead(body, body->state.u, &local, &u));
  BodyHistoryLook(body, &before);
  PetscCall((*body->model.element->ops->stress)(body->model.element, u, stress));
  SpreadOverCells(body, 6, stress);
  BodyHistoryLookBack(body, &before);
  PetscCall(BodyRestoreLocalRead(body, body->state.u, &local, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyComputePlasticStrain - mean equivalent plastic strain of each element

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameters:
+ strain - for each cell of this rank, in the order of `BodyGetCells()`; zero where the material is not plastic. May be `NULL`
- work   - plastic work in the elements of this rank, with what hardening stores of it [J]

  Level: intermediate

.seealso: `Body`, `BodyComputeStress()`, `BodyHasHistory()`
@*/
PetscErrorCode BodyComputePlasticStrain(Body body, PetscReal strain[], PetscReal *work)
{
  Element        element = body->model.element;
  ElementHistory before;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(work, 3);
  *work = 0;
  if (strain) PetscCall(PetscArrayzero(strain, body->mesh.n_cells));
  if (!body->history || !element->ops->plastic) PetscFunctionReturn(PETSC_SUCCESS);
  BodyHistoryLook(body, &before);
  PetscCall((*element->ops->plastic)(element, work, strain));
  if (strain) SpreadOverCells(body, 1, strain);
  BodyHistoryLookBack(body, &before);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a material of the body flows plastically */
PetscErrorCode BodyHasHistory(Body body, PetscBool *has)
{
  PetscFunctionBegin;
  *has = (PetscBool)(body->history != NULL);
  PetscFunctionReturn(PETSC_SUCCESS);
}
