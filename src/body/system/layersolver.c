/* The massless layer of a body under a small force on it, whatever the integrator: with the rest of the body held,

     K_LL du = f_L,   K_LL at the displacement at which it was factored last.

   and what it pulls with at the nodes inside, -K_IL du. Linear explicit bodies have these factors in any case
   (body/integrator/layerbalance.c), others get them when they are asked for the first time. */
#include <body/layout/bodyimpl.h>

struct _n_LayerSolver {
  Vec               point;    /* displacement at which the tangent is taken, on the nodes near the layer; NULL for linear bodies [m] */
  ConstrainedSolver own;      /* factors, where the integrator has none */
  Mat               K;        /* what they are of */
  PetscScalar      *tangents; /* of the elements that touch the layer, at the point; NULL for linear bodies */
  PetscObjectId     of;       /* the displacements that the point was taken of last, their state and the step then: they are asked */
  PetscObjectState  of_state; /* for in each pass over the bodies, and do not change before the next step */
  PetscReal         of_step;
};

/* Factors of a layer whose integrator has none of its own */
static PetscErrorCode CreateFactors(Body body, LayerSolver layer)
{
  char prefix[128];
  Mat  empty;

  PetscFunctionBegin;
  PetscCall(BodyCreateLayerMatrix(body, &layer->K));
  if (!body->model.linear) {
    PetscCall(BodyCreateLayerVec(body, &layer->point));
    PetscCall(PetscMalloc1(BodyCountLayerTangents(body), &layer->tangents));
  }
  PetscCall(MatCreateAIJ(PetscObjectComm((PetscObject)body), 0, body->layer.n_dofs, 0, PETSC_DETERMINE, 0, NULL, 0, NULL, &empty));
  PetscCall(MatAssemblyBegin(empty, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(empty, MAT_FINAL_ASSEMBLY));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%slayer_", ((PetscObject)body)->prefix));
  PetscCall(ConstrainedSolverCreate(layer->K, empty, body->mesh.dim, prefix, PETSC_FALSE, &layer->own));
  PetscCall(MatDestroy(&empty));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Collective; for a body with massless nodes on some rank */
static PetscErrorCode CreateLayerSolver(Body body)
{
  const PetscBool balances = (PetscBool)(body->layer.elements != NULL);

  PetscFunctionBegin;
  PetscCall(PetscNew(&body->layer.solver));
  if (!balances) PetscCall(BodySetUpLayerElements(body));
  if (!balances || !body->model.linear) PetscCall(CreateFactors(body, body->layer.solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the layer's tangent at displacement u for solutions that follow; a linear body's is constant. Collective; needs massless nodes. */
PetscErrorCode BodyPrepareLayer(Body body, Vec u)
{
  LayerSolver      layer = body->layer.solver;
  PetscObjectId    of;
  PetscObjectState state;

  PetscFunctionBegin;
  if (!layer) PetscCall(CreateLayerSolver(body));
  layer = body->layer.solver;
  if (body->model.linear) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectGetId((PetscObject)u, &of));
  PetscCall(PetscObjectStateGet((PetscObject)u, &state));
  if (of == layer->of && state == layer->of_state && body->time.step == layer->of_step) PetscFunctionReturn(PETSC_SUCCESS);
  layer->of       = of;
  layer->of_state = state;
  layer->of_step  = body->time.step;
  PetscCall(BodyGatherLayer(body, u, layer->point));
  PetscCall(BodyAssembleLayer(body, layer->point, NULL, 0, layer->tangents, layer->K));
  PetscCall(ConstrainedSolverRefactor(layer->own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* du = K_LL^{-1} f_L on the layer, zero elsewhere, with the tangent of the last BodyPrepareLayer(). Both on all dofs; f may be du. */
PetscErrorCode BodyApplyLayerCompliance(Body body, Vec f, Vec du)
{
  const BodyLayer *layer = &body->layer;

  PetscFunctionBegin;
  PetscCall(BodyReadLayer(body, f, layer->rhs));
  PetscCall(ConstrainedSolverSolveFree(layer->solver->own ? layer->solver->own : body->solver, layer->rhs, layer->solution));
  PetscCall(VecZeroEntries(du));
  PetscCall(BodyWriteLayer(body, layer->solution, INSERT_VALUES, du));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* du = K_LL^{-1} f_L on the layer, zero elsewhere, and the pull -K du on all nodes, of which those of the layer do not matter: both with
   the tangent at displacement u, so that the pull amounts to the force on the layer. All are laid out as displacements; f is left alone. */
PetscErrorCode BodySolveLayer(Body body, Vec u, Vec f, Vec du, Vec pull)
{
  PetscFunctionBegin;
  PetscCall(BodyPrepareLayer(body, u));
  PetscCall(BodyApplyLayerCompliance(body, f, du));
  if (body->model.linear) PetscCall(BodyComputeInternalForce(body, du, pull));
  else PetscCall(BodyMultiplyLayerTangent(body, body->layer.solver->tangents, du, pull));
  PetscCall(VecScale(pull, -1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLayerSolverDestroy(LayerSolver *layer)
{
  PetscFunctionBegin;
  if (!*layer) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDestroy(&(*layer)->point));
  PetscCall(ConstrainedSolverDestroy(&(*layer)->own));
  PetscCall(MatDestroy(&(*layer)->K));
  PetscCall(PetscFree((*layer)->tangents));
  PetscCall(PetscFree(*layer));
  PetscFunctionReturn(PETSC_SUCCESS);
}
