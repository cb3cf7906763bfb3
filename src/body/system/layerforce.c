/* Forces and stiffness of the elements that touch the massless contact layer: all that its balance takes of a body. */
#include <body/layout/bodyimpl.h>

/* Those elements, numbered on their own, and their nodes: arrays that are short where the layer is */
struct _n_LayerElements {
  Element    element, linearized; /* the latter NULL until BodyPrepareLinearized() */
  PetscInt  *connectivity;
  PetscReal *coordinates;
  PetscInt   n_dofs;  /* of the nodes of these elements */
  PetscInt  *numbers; /* of each: within the layer, over all ranks; -1 for others */
  Vec        u, f;    /* n_dofs each, of this rank alone */
  VecScatter gather;  /* from a vector of the body to u */
  VecScatter add;     /* from f to a vector of the layer */
  PetscInt   n_near;  /* of contact nodes and of the nodes of these elements, on whatever rank the elements are */
  PetscInt  *near;    /* owned ones, rank numbering */
};

/* The number of each dof of this rank's nodes, ghosts too, within the layer; -1 for others */
static PetscErrorCode NumberLayer(Body body, PetscInt **number)
{
  PetscInt           first = body->n_layer_dofs;
  const PetscScalar *read;
  PetscScalar       *write;
  Vec                numbers, local;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Scan(&body->n_layer_dofs, &first, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  first -= body->n_layer_dofs;
  PetscCall(BodyCreateVec(body, &numbers));
  PetscCall(VecSet(numbers, -1));
  PetscCall(VecGetArray(numbers, &write));
  for (PetscInt i = 0; i < body->n_layer_dofs; i++) write[body->layer_dofs[i]] = first + i;
  PetscCall(VecRestoreArray(numbers, &write));
  PetscCall(BodyGetLocalRead(body, numbers, &local, &read));
  PetscCall(PetscMalloc1(body->local_nodes * body->dim, number));
  for (PetscInt i = 0; i < body->local_nodes * body->dim; i++) (*number)[i] = (PetscInt)PetscRealPart(read[i]);
  PetscCall(BodyRestoreLocalRead(body, numbers, &local, &read));
  PetscCall(VecDestroy(&numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool TouchesLayer(Body body, PetscInt e, const PetscInt number[])
{
  const PetscInt *nodes = body->connectivity + e * body->element->nodes;

  for (PetscInt a = 0; a < body->element->nodes; a++)
    for (PetscInt d = 0; d < body->dim; d++)
      if (number[nodes[a] * body->dim + d] >= 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* The elements that touch the layer, their nodes numbered as they come; nodes: the rank's number of each of these, freed by the caller */
static PetscErrorCode SelectElements(Body body, const PetscInt number[], LayerElements layer, PetscInt *count, PetscInt *n_nodes,
                                     PetscInt *nodes[])
{
  const PetscInt n = body->element->nodes;
  PetscInt      *compact;

  PetscFunctionBegin;
  *count = *n_nodes = 0;
  for (PetscInt e = 0; e < body->element->count; e++)
    if (TouchesLayer(body, e, number)) (*count)++;
  PetscCall(PetscMalloc1(*count * n, &layer->connectivity));
  PetscCall(PetscMalloc1(*count * n, nodes));
  PetscCall(PetscMalloc1(body->local_nodes, &compact));
  for (PetscInt node = 0; node < body->local_nodes; node++) compact[node] = -1;
  *count = 0;
  for (PetscInt e = 0; e < body->element->count; e++) {
    if (!TouchesLayer(body, e, number)) continue;
    for (PetscInt a = 0; a < n; a++) {
      const PetscInt node = body->connectivity[e * n + a];

      if (compact[node] < 0) {
        compact[node]          = *n_nodes;
        (*nodes)[(*n_nodes)++] = node;
      }
      layer->connectivity[*count * n + a] = compact[node];
    }
    (*count)++;
  }
  PetscCall(PetscFree(compact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From a vector of the body to the nodes of the elements, and from there to the layer */
static PetscErrorCode CreateScatters(Body body, LayerElements layer, PetscInt n_nodes, const PetscInt nodes[])
{
  const PetscInt dim = body->dim;
  PetscInt       rstart, n = 0, *dofs, *from, *to;
  IS             is, to_is;

  PetscFunctionBegin;
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, layer->n_dofs, &layer->u));
  PetscCall(VecDuplicate(layer->u, &layer->f));
  PetscCall(VecGetOwnershipRange(body->positions, &rstart, NULL));
  PetscCall(PetscMalloc1(layer->n_dofs, &dofs));
  for (PetscInt k = 0; k < n_nodes; k++) {
    const PetscInt first = nodes[k] < body->owned_nodes ? rstart + nodes[k] * dim : body->ghost_dofs[(nodes[k] - body->owned_nodes) * dim];

    for (PetscInt d = 0; d < dim; d++) dofs[k * dim + d] = first + d;
  }
  /* no blocks of `dim`: PETSc takes its type for them apart, and allocates memory, in each scatter */
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, layer->n_dofs, dofs, PETSC_OWN_POINTER, &is));
  PetscCall(VecScatterCreate(body->positions, is, layer->u, NULL, &layer->gather));
  PetscCall(ISDestroy(&is));
  PetscCall(PetscMalloc2(layer->n_dofs, &from, layer->n_dofs, &to));
  for (PetscInt i = 0; i < layer->n_dofs; i++) {
    if (layer->numbers[i] < 0) continue;
    from[n] = i;
    to[n++] = layer->numbers[i];
  }
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, n, from, PETSC_COPY_VALUES, &is));
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, n, to, PETSC_COPY_VALUES, &to_is));
  PetscCall(VecScatterCreate(layer->f, is, body->layer_rhs, to_is, &layer->add));
  PetscCall(ISDestroy(&is));
  PetscCall(ISDestroy(&to_is));
  PetscCall(PetscFree2(from, to));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Needs the scatters */
static PetscErrorCode FindNear(Body body, LayerElements layer)
{
  const PetscInt     n = body->owned_nodes * body->dim;
  const PetscScalar *mark;
  Vec                marks;

  PetscFunctionBegin;
  PetscCall(BodyCreateVec(body, &marks));
  PetscCall(VecZeroEntries(marks));
  PetscCall(VecSet(layer->u, 1));
  PetscCall(VecScatterBegin(layer->gather, layer->u, marks, ADD_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(layer->gather, layer->u, marks, ADD_VALUES, SCATTER_REVERSE));
  PetscCall(VecGetArrayRead(marks, &mark));
  for (PetscInt i = 0; i < n; i++) layer->n_near += PetscRealPart(mark[i]) > 0 || body->in_layer[i / body->dim];
  PetscCall(PetscMalloc1(layer->n_near, &layer->near));
  layer->n_near = 0;
  for (PetscInt i = 0; i < n; i++)
    if (PetscRealPart(mark[i]) > 0 || body->in_layer[i / body->dim]) layer->near[layer->n_near++] = i;
  PetscCall(VecRestoreArrayRead(marks, &mark));
  PetscCall(VecDestroy(&marks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Needs the vectors of the layer */
PetscErrorCode BodySetUpLayerElements(Body body)
{
  const PetscInt dim = body->dim;
  PetscInt       count, n_nodes, *nodes, *number;
  LayerElements  layer;

  PetscFunctionBegin;
  PetscCall(PetscNew(&layer));
  body->layer_elements = layer;
  PetscCall(NumberLayer(body, &number));
  PetscCall(SelectElements(body, number, layer, &count, &n_nodes, &nodes));
  layer->n_dofs = n_nodes * dim;
  PetscCall(PetscMalloc2(layer->n_dofs, &layer->coordinates, layer->n_dofs, &layer->numbers));
  for (PetscInt k = 0; k < n_nodes; k++) {
    PetscCall(PetscArraycpy(layer->coordinates + k * dim, body->coordinates + nodes[k] * dim, dim));
    PetscCall(PetscArraycpy(layer->numbers + k * dim, number + nodes[k] * dim, dim));
  }
  PetscCall(ElementDuplicate(body->element, NULL, &layer->element));
  PetscCall(ElementSetUp(layer->element, count, layer->connectivity, layer->coordinates));
  PetscCall(CreateScatters(body, layer, n_nodes, nodes));
  PetscCall(FindNear(body, layer));
  PetscCall(PetscFree(nodes));
  PetscCall(PetscFree(number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLayerElementsDestroy(LayerElements *layer)
{
  PetscFunctionBegin;
  if (!*layer) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ElementDestroy(&(*layer)->element));
  PetscCall(ElementDestroy(&(*layer)->linearized));
  PetscCall(VecScatterDestroy(&(*layer)->gather));
  PetscCall(VecScatterDestroy(&(*layer)->add));
  PetscCall(VecDestroy(&(*layer)->u));
  PetscCall(VecDestroy(&(*layer)->f));
  PetscCall(PetscFree2((*layer)->coordinates, (*layer)->numbers));
  PetscCall(PetscFree((*layer)->connectivity));
  PetscCall(PetscFree((*layer)->near));
  PetscCall(PetscFree(*layer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The element of linearized forces; `material` is kept by reference */
PetscErrorCode BodyLayerLinearize(Body body, Material material)
{
  LayerElements layer = body->layer_elements;

  PetscFunctionBegin;
  if (!layer || layer->linearized) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ElementDuplicate(layer->element, material, &layer->linearized));
  PetscCall(ElementSetUp(layer->linearized, layer->element->count, layer->connectivity, layer->coordinates));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The owned displacements that the balance of the layer and the rows of contact nodes hang on, rank numbering */
void BodyGetNearLayer(Body body, PetscInt *n, const PetscInt *dofs[])
{
  *n    = body->layer_elements->n_near;
  *dofs = body->layer_elements->near;
}

/* rhs -= internal force of the layer for displacement u of the body [N] */
PetscErrorCode BodySubtractLayerForce(Body body, Vec u, Vec rhs)
{
  LayerElements      layer   = body->layer_elements;
  Element            element = body->linearized && layer->linearized ? layer->linearized : layer->element;
  const PetscScalar *u_array;
  PetscScalar       *f_array;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(BODY_LayerForce, body, 0, 0, 0));
  PetscCall(VecScatterBegin(layer->gather, u, layer->u, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(layer->gather, u, layer->u, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(layer->u, &u_array));
  PetscCall(VecGetArrayWrite(layer->f, &f_array));
  PetscCall(PetscArrayzero(f_array, layer->n_dofs));
  PetscCall((*element->ops->internalforce)(element, u_array, f_array));
  for (PetscInt i = 0; i < layer->n_dofs; i++) f_array[i] = -f_array[i];
  PetscCall(VecRestoreArrayWrite(layer->f, &f_array));
  PetscCall(VecRestoreArrayRead(layer->u, &u_array));
  PetscCall(VecScatterBegin(layer->add, layer->f, rhs, ADD_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(layer->add, layer->f, rhs, ADD_VALUES, SCATTER_FORWARD));
  PetscCall(PetscLogEventEnd(BODY_LayerForce, body, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K = tangent stiffness of the layer at displacement u of the body; NULL: undeformed [N/m] */
PetscErrorCode BodyAssembleLayer(Body body, Vec u, Mat K)
{
  LayerElements      layer = body->layer_elements;
  const PetscInt     nodes = body->element->nodes, n = nodes * body->dim;
  PetscInt           dofs[ELEMENT_MAX_DOFS];
  PetscScalar        element[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];
  const PetscScalar *at;

  PetscFunctionBegin;
  if (u) {
    PetscCall(VecScatterBegin(layer->gather, u, layer->u, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecScatterEnd(layer->gather, u, layer->u, INSERT_VALUES, SCATTER_FORWARD));
  } else PetscCall(VecZeroEntries(layer->u));
  PetscCall(MatZeroEntries(K));
  PetscCall(VecGetArrayRead(layer->u, &at));
  for (PetscInt e = 0; e < layer->element->count; e++) {
    for (PetscInt i = 0; i < n; i++) dofs[i] = layer->numbers[layer->connectivity[e * nodes + i / body->dim] * body->dim + i % body->dim];
    PetscCall((*layer->element->ops->stiffness)(layer->element, e, at, element));
    PetscCall(MatSetValues(K, n, dofs, n, dofs, element, ADD_VALUES)); /* leaves negative numbers out */
  }
  PetscCall(VecRestoreArrayRead(layer->u, &at));
  PetscCall(MatAssemblyBegin(K, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(K, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stiffness matrix of the undeformed layer, held by the rest of the body */
PetscErrorCode BodyCreateLayerMatrix(Body body, Mat *K)
{
  PetscFunctionBegin;
  PetscCall(MatCreate(PetscObjectComm((PetscObject)body), K));
  PetscCall(MatSetSizes(*K, body->n_layer_dofs, body->n_layer_dofs, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(*K, MATAIJ));
  PetscCall(MatSetUp(*K));
  PetscCall(MatSetOption(*K, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(BodyAssembleLayer(body, NULL, *K));
  PetscFunctionReturn(PETSC_SUCCESS);
}
