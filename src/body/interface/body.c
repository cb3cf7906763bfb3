/* Creation, set-up and destruction of a body. */
#include <body/layout/bodyimpl.h>
#include <sys/citations.h>
#include "bodysetup.h"

/*@
  BodyCreate - creates a body, whose mesh, material and integrator come from the program or from options that begin with its name

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
  (*body)->mass.type         = (BodyMassType)PETSC_DECIDE;
  (*body)->mass.redistribute = PETSC_TRUE;
  (*body)->mass.automatic    = PETSC_TRUE;
  (*body)->mass.moments      = BODY_MASS_INERTIA;
  (*body)->springs.part      = PETSC_DECIDE;
  PetscCall(ElementCreate(comm, &(*body)->model.element));
  PetscCall(PetscObjectSetName((PetscObject)(*body)->model.element, name)); /* of what warnings speak */
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)(*body)->model.element, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The start of the simulation, and the step at whose ends all bodies are synchronised [s]. Logically collective. */
PetscErrorCode BodySetControllerStep(Body body, PetscReal start, PetscReal step)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidLogicalCollectiveReal(body, start, 2);
  PetscValidLogicalCollectiveReal(body, step, 3);
  body->time.start           = start;
  body->time.controller_step = step;
  body->time.whole_step      = step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds vertices (points of the DM) that lie on contact surfaces; with `-<body>_mass_redistribute` these become massless. Collective. */
PetscErrorCode BodySetContactNodes(Body body, PetscInt n, const PetscInt vertices[])
{
  PetscFunctionBegin;
  BodyCheckNotSetUp(body);
  PetscCheck(!body->mass.decided, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call before BodyChooseMass()");
  PetscCall(BodySetUpDiscretization(body));
  PetscCall(BodyMarkNodes(body, n, vertices, body->layer.contains));
  body->layer.edge = 0;
  PetscCall(BodyNoteSurfaceMaterial(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body without contact has an interface without rows */
static PetscErrorCode SetUpRows(Body body)
{
  BodyRows *rows = &body->rows;
  MPI_Comm  comm = PetscObjectComm((PetscObject)body);

  PetscFunctionBegin;
  if (!body->rows.matrix) {
    Mat      empty;
    PetscInt n = body->mesh.owned_nodes * body->mesh.dim;

    PetscCall(MatCreateAIJ(comm, 0, n, 0, PETSC_DETERMINE, 0, NULL, 0, NULL, &empty));
    PetscCall(MatAssemblyBegin(empty, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(empty, MAT_FINAL_ASSEMBLY));
    PetscCall(BodySetInterface(body, empty));
    PetscCall(MatDestroy(&empty));
  }
  PetscCall(BodyCreateRowArrays(body));
  body->rows.have_mass = (PetscBool)((rows->global > 0 || rows->expected) && !body->mass.redistribute && !body->rows.tied_mass &&
                                     body->integrator->has_inertia);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first part of BodySetUp(): makes the mass, on which stable steps depend, and chooses the number of substeps. Collective. */
PetscErrorCode BodySetUpSteps(Body body)
{
  PetscReal free[BODY_MAX_RIGID * BODY_MAX_RIGID];
  PetscInt  n_free;
  PetscBool keeps;

  PetscFunctionBegin;
  if (body->time.substeps) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyChooseMass(body, 0, NULL, &keeps));
  if (keeps) PetscCall(BodyKeepMass(body));
  PetscCall(SetUpRows(body));
  if (body->mass.redistribute && (body->rows.global || body->rows.expected)) PetscCall(ImpaktCite(CITE_MASS_REDISTRIBUTION));
  PetscCall(BodyStateCreate(body, PETSC_TRUE, &body->state));
  PetscCall(BodyStateCreate(body, PETSC_FALSE, &body->saved));
  for (PetscInt k = 0; k < 3; k++) PetscCall(BodyCreateVec(body, &body->work.nodes[k]));
  if (body->rows.global || body->rows.expected) PetscCall(BodyCreateVec(body, &body->iterate.u)); /* else nobody repeats a step */
  PetscCall(BodySetUpFreeRows(body));
  PetscCall(BodySetUpMass(body));
  PetscCall(BodyCheckHeld(body, &n_free, free));
  PetscCall(BodySetUpSprings(body, n_free, free));
  body->time.shared = 1;
  PetscCall(BodySetUpSubsteps(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Divides the controller step into n parts at whose ends all bodies have a common time, after BodySetUpSteps() and before BodySetUp().
   From then on BodyIntegrate() advances the body by one part, and BodyGetSubsteps() counts the substeps of one. */
PetscErrorCode BodyShareControllerStep(Body body, PetscInt n)
{
  PetscFunctionBegin;
  PetscCheck(!body->setup && n > 0 && body->time.substeps % n == 0, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Body '%s': %" PetscInt_FMT " substeps cannot be divided into %" PetscInt_FMT " parts", body->hdr.name, body->time.substeps,
             n);
  body->time.shared *= n;
  body->time.substeps /= n;
  body->time.controller_step /= n;
  body->time.whole_step /= n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A substep starts from the saved state where it is the only one of a controller step */
static PetscErrorCode SetUpSubstepStart(Body body)
{
  BodyState *start = &body->substep_start;

  PetscFunctionBegin;
  if (body->time.substeps > 1) {
    PetscCall(BodyCreateVec(body, &start->u));
    PetscCall(BodyCreateVec(body, &start->v));
  } else {
    PetscCall(PetscObjectReference((PetscObject)body->saved.u));
    PetscCall(PetscObjectReference((PetscObject)body->saved.v));
    start->u = body->saved.u;
    start->v = body->saved.v;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of BodySetUp() before matrices are factored. Called for all bodies before BodyFactor() lets ranks factor at once. Collective. */
PetscErrorCode BodyBeginSetUp(Body body)
{
  PetscFunctionBegin;
  if (body->begun) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodySetUpSteps(body));
  PetscCall(BodyCreateTraces(body));
  PetscCall(BodySetUpHistory(body));
  PetscCall(BodyCreateCompliance(body));
  PetscCall(BodySetUpDamping(body));
  PetscCall(BodySetUpPoints(body));
  PetscCall(BodySetUpTime(body));
  body->local = (PetscBool)(body->mesh.whole && body->integrator->is_local);
  body->begun = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Factors the matrix of a body on the one of several ranks that has it, after BodyBeginSetUp() */
PetscErrorCode BodyFactor(Body body)
{
  PetscFunctionBegin;
  if (body->solver_begun) PetscCall(ConstrainedSolverFactor(body->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes mass, matrices, integrator and initial state of a body that has mesh and material. Collective. */
PetscErrorCode BodySetUp(Body body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (body->setup) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyBeginSetUp(body));
  PetscCall(BodyEndSolver(body));
  if (body->integrator->reads_start || body->loads || BodyIsDamped(body)) PetscCall(SetUpSubstepStart(body));
  if (BodyIsDamped(body)) PetscCall(BodyCreateVec(body, &body->substep_start.damping));
  PetscCall(TSViewFromOptions(body->time.ts, NULL, "-ts_view"));
  if (!body->model.blocks.n) PetscCall(PetscObjectViewFromOptions((PetscObject)body->model.material, (PetscObject)body, "-material_view"));
  for (PetscInt k = 0; k < body->model.blocks.n; k++)
    PetscCall(PetscObjectViewFromOptions((PetscObject)body->model.blocks.materials[k], (PetscObject)body, "-material_view"));
  PetscCall(PetscObjectViewFromOptions((PetscObject)body->model.element, (PetscObject)body, "-element_view"));
  body->setup = PETSC_TRUE;
  PetscCall(BodySetInitialState(body, NULL, NULL));
  PetscCall(PetscObjectViewFromOptions((PetscObject)body, NULL, "-body_view"));
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
    Vec *vecs[] = {&b->start.a,      &b->iterate.u,     &b->rows.stage_balance, &b->mesh.positions, &b->mass.row_sum, &b->mass.diagonal,
                   &b->mass.inverse, &b->work.nodes[0], &b->work.nodes[1],      &b->work.nodes[2],  &b->start.change};
    BodyState *states[] = {&b->state, &b->saved, &b->substep_start};

    PetscCall(BodyDestroyHistory(b));
    PetscCall(BodyDestroyContactNodes(b));
    PetscCall(BodyIntegratorDestroy(b));
    PetscCall(BodyDestroyLevels(b));
    PetscCall(BodyLoadsDestroy(b));
    PetscCall(BodyDestroyDamping(b));
    PetscCall(BodyDestroyPoints(b));
    for (size_t i = 0; i < sizeof(vecs) / sizeof(vecs[0]); i++) PetscCall(VecDestroy(vecs[i]));
    for (size_t i = 0; i < sizeof(states) / sizeof(states[0]); i++) PetscCall(BodyStateDestroy(states[i]));
    PetscCall(BodyDestroyTraces(b));
    PetscCall(BodyDestroyRowArrays(b));
  }
  PetscCall(ConstrainedSolverDestroy(&b->mass.solver));
  PetscCall(BodyDestroyMassBlocks(&b->mass.blocks));
  PetscCall(MatDestroy(&b->model.stiffness));
  PetscCall(MatDestroy(&b->mass.matrix));
  PetscCall(MatDestroy(&b->mass.product));
  PetscCall(MatDestroy(&b->mass.of_nodes));
  PetscCall(MatDestroy(&b->mass.extrapolation));
  PetscCall(PetscFree(b->mass.diagonals));
  PetscCall(MatDestroy(&b->rows.matrix));
  PetscCall(VecDestroy(&b->rows.free_dofs));
  PetscCall(TSDestroy(&b->time.ts));
  PetscCall(BodyLayerSolverDestroy(&b->layer.solver));
  PetscCall(BodyLayerElementsDestroy(&b->layer));
  PetscCall(ElementDestroy(&b->model.element));
  PetscCall(ElementDestroy(&b->model.linearized_element));
  PetscCall(MaterialDestroy(&b->model.material));
  PetscCall(BodyDestroyBlocks(b));
  PetscCall(PetscFree(b->mass.factor));
  PetscCall(PetscFree(b->layer.dofs));
  PetscCall(PetscFree(b->layer.contains));
  if (b->mesh.connectivity != b->mesh.cell_connectivity) PetscCall(PetscFree(b->mesh.connectivity));
  PetscCall(PetscFree(b->mesh.cell_connectivity));
  PetscCall(PetscFree(b->mesh.coordinates));
  PetscCall(PetscFree(b->mesh.on_axis));
  PetscCall(PetscFree(b->mesh.ghost_dofs));
  PetscCall(PetscFree(b->mesh.ranks));
  PetscCall(PetscFree(b->mesh.node_of_vertex));
  PetscCall(DMDestroy(&b->mesh.dm));
  PetscCall(PetscHeaderDestroy(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
