/* Creation, set-up and destruction of a body. */
#include <body/layout/bodyimpl.h>
#include <sys/citations.h>
#include "bodysetup.h"

/*@
  BodyCreate - creates a body, which wants a mesh and a material

  Collective

  Input Parameters:
+ comm - communicator
- name - its name; options begin with `-<name>_`

  Output Parameter:
. body - the `Body`

  Level: beginner

.seealso: `Body`, `BodySetDM()`, `BodySetMaterial()`, `BodySetFromOptions()`, `BodySetUp()`, `BodyDestroy()`
@*/
PetscErrorCode BodyCreate(MPI_Comm comm, const char name[], Body *body)
{
  char prefix[128];

  PetscFunctionBegin;
  PetscAssertPointer(name, 2);
  PetscAssertPointer(body, 3);
  PetscCall(BodyInitializePackage());
  PetscCall(PetscHeaderCreate(*body, BODY_CLASSID, "Body", "Deformable body", "Body", comm, BodyDestroy, BodyView));
  PetscCall(PetscObjectSetName((PetscObject)*body, name));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%s_", name));
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)*body, prefix));
  PetscCallMPI(MPI_Comm_size(comm, &(*body)->rows.size));
  (*body)->mass_type         = (BodyMassType)PETSC_DECIDE;
  (*body)->mass_redistribute = PETSC_TRUE;
  PetscCall(ElementCreate(comm, &(*body)->element));
  PetscCall(ElementSetOptionsPrefix((*body)->element, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetControllerStep - sets the start of the simulation and the step at whose ends all bodies are synchronised

  Logically Collective

  Input Parameters:
+ body  - the `Body`
. start - start time [s]
- step  - controller step [s]

  Level: developer

.seealso: `Body`, `BodySetUp()`
@*/
PetscErrorCode BodySetControllerStep(Body body, PetscReal start, PetscReal step)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidLogicalCollectiveReal(body, start, 2);
  PetscValidLogicalCollectiveReal(body, step, 3);
  body->time_start      = start;
  body->controller_step = step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetContactNodes - says which nodes lie on surfaces that may touch something

  Collective

  Input Parameters:
+ body     - the `Body`
. n        - number of vertices
- vertices - points of its `DMPlex`

  Level: developer

  Note:
  With `-<body>_mass_redistribute` these nodes become massless.

.seealso: `Body`, `BodySetUp()`
@*/
PetscErrorCode BodySetContactNodes(Body body, PetscInt n, const PetscInt vertices[])
{
  PetscScalar       *mark;
  const PetscScalar *all;
  Vec                marks, local;
  const PetscBool    ghosted = (PetscBool)(body->rows.size > 1);

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(!body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call before BodySetUp()");
  if (n) PetscAssertPointer(vertices, 3);
  PetscCall(BodySetUpDiscretization(body));
  PetscCall(BodyCreateVec(body, &marks));
  local = marks;
  if (ghosted) PetscCall(VecGhostGetLocalForm(marks, &local));
  PetscCall(VecSet(local, 0));
  PetscCall(VecGetArray(local, &mark));
  for (PetscInt i = 0; i < n; i++) mark[body->node_of_vertex[vertices[i] - body->vertex_start] * body->dim] = 1;
  PetscCall(VecRestoreArray(local, &mark));
  /* a rank may hold a node of the surface without holding a face of it */
  if (ghosted) {
    PetscCall(VecGhostUpdateBegin(marks, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecGhostUpdateEnd(marks, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecGhostUpdateBegin(marks, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecGhostUpdateEnd(marks, INSERT_VALUES, SCATTER_FORWARD));
  }
  PetscCall(VecGetArrayRead(local, &all));
  for (PetscInt node = 0; node < body->local_nodes; node++)
    if (PetscRealPart(all[node * body->dim]) > 0) body->in_layer[node] = PETSC_TRUE;
  PetscCall(VecRestoreArrayRead(local, &all));
  if (ghosted) PetscCall(VecGhostRestoreLocalForm(marks, &local));
  PetscCall(VecDestroy(&marks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateTraces(Body body)
{
  Trace *traces[] = {&body->traces.displacement_in, &body->traces.velocity_in, &body->traces.acceleration_in, &body->traces.force_in,
                     &body->traces.displacement,    &body->traces.velocity,    &body->traces.acceleration,    &body->traces.reaction};

  PetscFunctionBegin;
  for (PetscInt t = 0; t < 8; t++) PetscCall(TraceCreate(body->rows.local, body->substeps, traces[t]));
  PetscCall(PetscCalloc1(4 * body->substeps * body->rows.local, &body->kept_traces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body without contact has an interface without rows */
static PetscErrorCode SetUpRows(Body body)
{
  BodyRows   *rows = &body->rows;
  MPI_Comm    comm = PetscObjectComm((PetscObject)body);
  PetscMPIInt four, total = 0;

  PetscFunctionBegin;
  if (!body->interface) {
    Mat      empty;
    PetscInt n = body->owned_nodes * body->dim;

    PetscCall(MatCreateAIJ(comm, 0, n, 0, PETSC_DETERMINE, 0, NULL, 0, NULL, &empty));
    PetscCall(MatAssemblyBegin(empty, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(empty, MAT_FINAL_ASSEMBLY));
    PetscCall(BodySetInterface(body, empty));
    PetscCall(MatDestroy(&empty));
  }
  PetscCall(MatGetOwnershipRange(body->interface, &rows->begin, NULL));
  PetscCall(PetscMalloc2(rows->size, &rows->counts, rows->size, &rows->offsets));
  PetscCall(PetscMPIIntCast(4 * rows->local, &four));
  PetscCallMPI(MPI_Allgather(&four, 1, MPI_INT, rows->counts, 1, MPI_INT, comm));
  for (PetscMPIInt r = 0; r < rows->size; total += rows->counts[r++]) rows->offsets[r] = total;
  PetscCall(
      PetscCalloc4(rows->local, &body->conditions, rows->local, &body->held, rows->local, &body->flexibility, rows->local, &body->robin));
  for (PetscInt k = 0; k < 3; k++) PetscCall(MatCreateVecs(body->interface, NULL, &body->row_vec[k]));
  body->prescribed_mass = (PetscBool)(rows->global > 0 && !body->mass_redistribute && !body->is_static);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetUp - makes mass, matrices, integrator and initial state

  Collective

  Input Parameter:
. body - the `Body`, with mesh and material

  Level: developer

.seealso: `Body`, `BodySetFromOptions()`, `BodySetInterface()`, `BodySetContactNodes()`, `BodySetControllerStep()`
@*/
PetscErrorCode BodySetUp(Body body)
{
  Vec *always[] = {&body->state.u, &body->state.v,        &body->state.a, &body->saved.u, &body->saved.v,
                   &body->saved.a, &body->internal_force, &body->work[0], &body->work[1], &body->work[2]};
  Vec *sweeps[] = {&body->previous_u, &body->kept[0], &body->kept[1], &body->kept[2], &body->kept[3]};

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (body->setup) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodySetUpDiscretization(body));
  PetscCall(SetUpRows(body));
  if (body->mass_redistribute && body->rows.global) PetscCall(ImpaktCite(CITE_MASS_REDISTRIBUTION));
  for (size_t i = 0; i < sizeof(always) / sizeof(always[0]); i++) PetscCall(BodyCreateVec(body, always[i]));
  if (body->rows.global) {
    for (size_t i = 0; i < sizeof(sweeps) / sizeof(sweeps[0]); i++) PetscCall(BodyCreateVec(body, sweeps[i]));
  }
  PetscCall(BodySetUpFreeRows(body));
  PetscCall(BodySetUpMass(body));
  PetscCall(BodyCheckHeld(body));
  PetscCall(BodySetUpSubsteps(body));
  body->keeps_start = (PetscBool)(!body->is_explicit || body->n_layer_dofs > 0 || body->loads);
  PetscCall(BodyAnyRank(body, &body->keeps_start));
  if (body->keeps_start) {
    PetscCall(BodyCreateVec(body, &body->substep_start.u));
    PetscCall(BodyCreateVec(body, &body->substep_start.v));
  }
  PetscCall(CreateTraces(body));
  PetscCall(BodySetUpTime(body));
  PetscCall(TSViewFromOptions(body->ts, NULL, "-ts_view"));
  PetscCall(MaterialViewFromOptions(body->material, (PetscObject)body, "-material_view"));
  PetscCall(ElementViewFromOptions(body->element, (PetscObject)body, "-element_view"));
  body->setup = PETSC_TRUE;
  PetscCall(BodySetInitialState(body, NULL, NULL));
  PetscCall(BodyViewFromOptions(body, NULL, "-body_view"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyDestroy - frees a body

  Collective

  Input Parameter:
. body - the `Body`, set to `NULL`

  Level: beginner

.seealso: `Body`, `BodyCreate()`
@*/
PetscErrorCode BodyDestroy(Body *body)
{
  Body b = *body;

  PetscFunctionBegin;
  if (!b) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(b, BODY_CLASSID, 1);
  if (--((PetscObject)b)->refct > 0) {
    *body = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  {
    Vec   *vecs[]   = {&b->state.u,         &b->state.v,         &b->state.a,        &b->saved.u,     &b->saved.v,    &b->saved.a,
                       &b->substep_start.u, &b->substep_start.v, &b->internal_force, &b->previous_u,  &b->work[0],    &b->work[1],
                       &b->work[2],         &b->positions,       &b->mass_row_sum,   &b->orphan_mass, &b->applied,    &b->saved_applied,
                       &b->mass_diagonal,   &b->inverse_mass,    &b->row_vec[0],     &b->row_vec[1],  &b->row_vec[2], &b->layer_rhs,
                       &b->layer_solution,  &b->kept[0],         &b->kept[1],        &b->kept[2],     &b->kept[3]};
    Trace *traces[] = {&b->traces.displacement_in, &b->traces.velocity_in, &b->traces.acceleration_in, &b->traces.force_in,
                       &b->traces.displacement,    &b->traces.velocity,    &b->traces.acceleration,    &b->traces.reaction};

    PetscCall(BodyDestroyResponse(b));
    PetscCall(BodyDestroyCompliance(b));
    PetscCall(BodyDestroyProbe(b));
    PetscCall(BodyLoadsDestroy(b));
    for (size_t i = 0; i < sizeof(vecs) / sizeof(vecs[0]); i++) PetscCall(VecDestroy(vecs[i]));
    for (size_t i = 0; i < sizeof(traces) / sizeof(traces[0]); i++) PetscCall(TraceDestroy(traces[i]));
  }
  PetscCall(ConstrainedSolverDestroy(&b->solver));
  PetscCall(ConstrainedSolverDestroy(&b->mass_solver));
  PetscCall(VecScatterDestroy(&b->layer_scatter));
  PetscCall(ISDestroy(&b->layer_is));
  PetscCall(MatDestroy(&b->stiffness));
  PetscCall(MatDestroy(&b->mass_matrix));
  PetscCall(MatDestroy(&b->shifted));
  PetscCall(MatDestroy(&b->interface));
  PetscCall(MatDestroy(&b->free_rows));
  PetscCall(BodyGramDestroy(&b->gram));
  PetscCall(TSDestroy(&b->ts));
  PetscCall(BodyLayerElementsDestroy(&b->layer_elements));
  PetscCall(ElementDestroy(&b->element));
  PetscCall(ElementDestroy(&b->linearized_element));
  PetscCall(MaterialDestroy(&b->material));
  PetscCall(MaterialDestroy(&b->linearized_material));
  PetscCall(PetscFree2(b->rows.counts, b->rows.offsets));
  PetscCall(PetscFree(b->kept_traces));
  PetscCall(PetscFree4(b->conditions, b->held, b->flexibility, b->robin));
  PetscCall(PetscFree(b->layer_dofs));
  PetscCall(PetscFree(b->in_layer));
  PetscCall(PetscFree(b->connectivity));
  PetscCall(PetscFree(b->coordinates));
  PetscCall(PetscFree(b->ghost_dofs));
  PetscCall(PetscFree(b->node_of_vertex));
  PetscCall(DMDestroy(&b->dm));
  PetscCall(PetscHeaderDestroy(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
