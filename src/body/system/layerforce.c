/* Forces and stiffness of the elements that touch the massless contact layer: its balance depends on no others. */
#include <body/layout/bodyimpl.h>

/* Those elements and their nodes, numbered anew, so that loops and scatters cost what the layer has, not what the body has */
struct _n_LayerElements {
  Element    element, linearized; /* the latter NULL until BodyPrepareLinearized() */
  PetscInt  *connectivity;
  PetscReal *coordinates;
  PetscInt   n_dofs;  /* of the nodes of these elements */
  PetscInt  *numbers; /* of each: within the layer, over all ranks; -1 for others */
  Vec        u, f;    /* n_dofs each, of this rank alone */
  VecScatter gather;  /* from a vector of the body to u */
  VecScatter add;     /* from f to a vector of the layer */
  PetscInt  *of_body; /* the number of each element in the body */
  char      *memory;  /* of the history that these elements begin the substep with, NULL where the material has none */
  PetscReal *history;
  PetscInt   history_size; /* numbers of that */
  PetscInt   epoch;        /* of the substep */
};

/* The number of each dof of this rank's nodes, ghosts too, within the layer; -1 for others */
static PetscErrorCode NumberLayer(Body body, PetscInt **number)
{
  PetscInt           first = body->layer.n_dofs;
  const PetscScalar *read;
  PetscScalar       *write;
  Vec                numbers, local;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Scan(&body->layer.n_dofs, &first, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  first -= body->layer.n_dofs;
  PetscCall(BodyCreateVec(body, &numbers));
  PetscCall(VecSet(numbers, -1));
  PetscCall(VecGetArray(numbers, &write));
  for (PetscInt i = 0; i < body->layer.n_dofs; i++) write[body->layer.dofs[i]] = first + i;
  PetscCall(VecRestoreArray(numbers, &write));
  PetscCall(BodyGetLocalRead(body, numbers, &local, &read));
  PetscCall(PetscMalloc1(body->mesh.local_nodes * body->mesh.dim, number));
  for (PetscInt i = 0; i < body->mesh.local_nodes * body->mesh.dim; i++) (*number)[i] = (PetscInt)PetscRealPart(read[i]);
  PetscCall(BodyRestoreLocalRead(body, numbers, &local, &read));
  PetscCall(VecDestroy(&numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool TouchesLayer(Body body, PetscInt e, const PetscInt number[])
{
  const PetscInt *nodes = body->mesh.connectivity + e * body->model.element->nodes;

  for (PetscInt a = 0; a < body->model.element->nodes; a++)
    for (PetscInt d = 0; d < body->mesh.dim; d++)
      if (number[nodes[a] * body->mesh.dim + d] >= 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* The elements that touch the layer, their nodes numbered as they come; nodes: the rank's number of each of these, freed by the caller */
static PetscErrorCode SelectElements(Body body, const PetscInt number[], LayerElements layer, PetscInt *count, PetscInt *n_nodes,
                                     PetscInt *nodes[])
{
  const PetscInt n = body->model.element->nodes;
  PetscInt      *compact;

  PetscFunctionBegin;
  *count = *n_nodes = 0;
  for (PetscInt e = 0; e < body->model.element->count; e++)
    if (TouchesLayer(body, e, number)) (*count)++;
  PetscCall(PetscMalloc1(*count * n, &layer->connectivity));
  PetscCall(PetscMalloc1(*count, &layer->of_body));
  PetscCall(PetscMalloc1(*count * n, nodes));
  PetscCall(PetscMalloc1(body->mesh.local_nodes, &compact));
  for (PetscInt node = 0; node < body->mesh.local_nodes; node++) compact[node] = -1;
  *count = 0;
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    if (!TouchesLayer(body, e, number)) continue;
    for (PetscInt a = 0; a < n; a++) {
      const PetscInt node = body->mesh.connectivity[e * n + a];

      if (compact[node] < 0) {
        compact[node]          = *n_nodes;
        (*nodes)[(*n_nodes)++] = node;
      }
      layer->connectivity[*count * n + a] = compact[node];
    }
    layer->of_body[*count] = e;
    (*count)++;
  }
  PetscCall(PetscFree(compact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From a vector of the body to the nodes of the elements, and from there to the layer */
static PetscErrorCode CreateScatters(Body body, LayerElements layer, PetscInt n_nodes, const PetscInt nodes[])
{
  const PetscInt dim = body->mesh.dim;
  PetscInt       rstart, n = 0, *dofs, *from, *to;
  IS             is, to_is;

  PetscFunctionBegin;
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, layer->n_dofs, &layer->u));
  PetscCall(VecDuplicate(layer->u, &layer->f));
  PetscCall(VecGetOwnershipRange(body->mesh.positions, &rstart, NULL));
  PetscCall(PetscMalloc1(layer->n_dofs, &dofs));
  for (PetscInt k = 0; k < n_nodes; k++) {
    const PetscInt first = nodes[k] < body->mesh.owned_nodes ? rstart + nodes[k] * dim
                                                             : body->mesh.ghost_dofs[(nodes[k] - body->mesh.owned_nodes) * dim];

    for (PetscInt d = 0; d < dim; d++) dofs[k * dim + d] = first + d;
  }
  /* no blocks of `dim`: PETSc takes its type for them apart, and allocates memory, in each scatter */
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, layer->n_dofs, dofs, PETSC_OWN_POINTER, &is));
  PetscCall(VecScatterCreate(body->mesh.positions, is, layer->u, NULL, &layer->gather));
  PetscCall(BodyUseScatter(layer->gather, body->mesh.positions, layer->u));
  PetscCall(ISDestroy(&is));
  PetscCall(PetscMalloc2(layer->n_dofs, &from, layer->n_dofs, &to));
  for (PetscInt i = 0; i < layer->n_dofs; i++) {
    if (layer->numbers[i] < 0) continue;
    from[n] = i;
    to[n++] = layer->numbers[i];
  }
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, n, from, PETSC_COPY_VALUES, &is));
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, n, to, PETSC_COPY_VALUES, &to_is));
  PetscCall(VecScatterCreate(layer->f, is, body->layer.rhs, to_is, &layer->add));
  PetscCall(BodyUseScatter(layer->add, layer->f, body->layer.rhs));
  PetscCall(ISDestroy(&is));
  PetscCall(ISDestroy(&to_is));
  PetscCall(PetscFree2(from, to));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyLayerCreateHistory - room for the history of the elements that touch the layer; of no size where the material has none */
PetscErrorCode BodyLayerCreateHistory(Body body, PetscInt *size, char **memory, PetscReal **history)
{
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(BodyHistoryCreateBuffer(body, body->layer.elements->element->count, &n, memory, history));
  if (size) *size = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Elements answer for a substep from its start, even if the body is at rest in its state: the layer's end of a step is sought */
static void PrepareHistory(Body body)
{
  LayerElements layer = body->layer.elements;

  if (!layer->history) return;
  if (layer->epoch != BodyHistoryGetEpoch(body)) BodyHistoryGather(body, PETSC_FALSE, layer->element, layer->of_body, layer->history);
  layer->epoch                  = BodyHistoryGetEpoch(body);
  layer->element->history.start = layer->history;
  layer->element->history.end   = NULL;
  layer->element->history.step  = body->time.step;
}

/* BodyLayerCopyHistory - what these elements answer from at present, and how long their step is */
PetscErrorCode BodyLayerCopyHistory(Body body, PetscReal history[], PetscReal *step)
{
  LayerElements layer = body->layer.elements;

  PetscFunctionBegin;
  *step = body->time.step;
  if (!layer->history) PetscFunctionReturn(PETSC_SUCCESS);
  PrepareHistory(body);
  PetscCall(PetscArraycpy(history, layer->history, layer->history_size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Vectors of the layer, one number for each of its dofs */
static PetscErrorCode CreateVectors(Body body)
{
  MPI_Comm   comm  = PetscObjectComm((PetscObject)body);
  BodyLayer *layer = &body->layer;
  PetscInt   rstart, *global;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(body->mesh.positions, &rstart, NULL));
  PetscCall(PetscMalloc1(layer->n_dofs, &global));
  for (PetscInt i = 0; i < layer->n_dofs; i++) global[i] = rstart + layer->dofs[i];
  PetscCall(ISCreateGeneral(comm, layer->n_dofs, global, PETSC_OWN_POINTER, &layer->global));
  PetscCall(VecCreate(comm, &layer->rhs));
  PetscCall(VecSetSizes(layer->rhs, layer->n_dofs, PETSC_DETERMINE));
  PetscCall(VecSetType(layer->rhs, VECSTANDARD));
  PetscCall(VecDuplicate(layer->rhs, &layer->solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The elements that touch the layer, and vectors of it. Collective. */
PetscErrorCode BodySetUpLayerElements(Body body)
{
  const PetscInt dim = body->mesh.dim;
  PetscInt       count, n_nodes, *nodes, *number;
  LayerElements  layer;

  PetscFunctionBegin;
  PetscCall(PetscNew(&layer));
  body->layer.elements = layer;
  PetscCall(CreateVectors(body));
  PetscCall(NumberLayer(body, &number));
  PetscCall(SelectElements(body, number, layer, &count, &n_nodes, &nodes));
  layer->n_dofs = n_nodes * dim;
  PetscCall(PetscMalloc2(layer->n_dofs, &layer->coordinates, layer->n_dofs, &layer->numbers));
  for (PetscInt k = 0; k < n_nodes; k++) {
    PetscCall(PetscArraycpy(layer->coordinates + k * dim, body->mesh.coordinates + nodes[k] * dim, dim));
    PetscCall(PetscArraycpy(layer->numbers + k * dim, number + nodes[k] * dim, dim));
  }
  PetscCall(ElementCreateSelection(body->model.element, PETSC_FALSE, count, layer->of_body, layer->connectivity, layer->coordinates,
                                   &layer->element));
  PetscCall(BodyLayerCreateHistory(body, &layer->history_size, &layer->memory, &layer->history));
  layer->epoch = -1;
  PetscCall(CreateScatters(body, layer, n_nodes, nodes));
  PetscCall(PetscFree(nodes));
  PetscCall(PetscFree(number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLayerElementsDestroy(BodyLayer *of_body)
{
  LayerElements layer = of_body->elements;

  PetscFunctionBegin;
  if (!layer) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ISDestroy(&of_body->global));
  PetscCall(VecDestroy(&of_body->rhs));
  PetscCall(VecDestroy(&of_body->solution));
  PetscCall(ElementDestroy(&layer->element));
  PetscCall(ElementDestroy(&layer->linearized));
  PetscCall(VecScatterDestroy(&layer->gather));
  PetscCall(VecScatterDestroy(&layer->add));
  PetscCall(VecDestroy(&layer->u));
  PetscCall(VecDestroy(&layer->f));
  PetscCall(PetscFree2(layer->coordinates, layer->numbers));
  PetscCall(PetscFree(layer->connectivity));
  PetscCall(PetscFree(layer->of_body));
  PetscCall(PetscFree(layer->memory));
  PetscCall(PetscFree(of_body->elements));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From a vector of the body to one of the layer: a rank has the same dofs of both */
PetscErrorCode BodyReadLayer(Body body, Vec u, Vec layer)
{
  const PetscScalar *from;
  PetscScalar       *to;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(u, &from));
  PetscCall(VecGetArrayWrite(layer, &to));
  for (PetscInt i = 0; i < body->layer.n_dofs; i++) to[i] = from[body->layer.dofs[i]];
  PetscCall(VecRestoreArrayWrite(layer, &to));
  PetscCall(VecRestoreArrayRead(u, &from));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The way back; on other dofs u stays as it is */
PetscErrorCode BodyWriteLayer(Body body, Vec layer, InsertMode mode, Vec u)
{
  const PetscScalar *from;
  PetscScalar       *to;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(layer, &from));
  PetscCall(VecGetArray(u, &to));
  for (PetscInt i = 0; i < body->layer.n_dofs; i++) {
    const PetscInt dof = body->layer.dofs[i];

    to[dof] = mode == ADD_VALUES ? to[dof] + from[i] : from[i];
  }
  PetscCall(VecRestoreArray(u, &to));
  PetscCall(VecRestoreArrayRead(layer, &from));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The element of linearized forces */
PetscErrorCode BodyLayerLinearize(Body body)
{
  LayerElements layer = body->layer.elements;

  PetscFunctionBegin;
  if (!layer || layer->linearized) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ElementCreateSelection(layer->element, PETSC_TRUE, layer->element->count, NULL, layer->connectivity, layer->coordinates,
                                   &layer->linearized));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* rhs -= internal force of the layer for displacement u of the body [N] */
PetscErrorCode BodySubtractLayerForce(Body body, Vec u, Vec rhs)
{
  LayerElements      layer   = body->layer.elements;
  Element            element = body->model.linearized && layer->linearized ? layer->linearized : layer->element;
  const PetscScalar *u_array;
  PetscScalar       *f_array;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(BODY_LayerForce, body, 0, 0, 0));
  PrepareHistory(body);
  PetscCall(BodyGatherLayer(body, u, layer->u));
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

/* A vector for BodyGatherLayer(), of this rank alone */
PetscErrorCode BodyCreateLayerVec(Body body, Vec *near)
{
  PetscFunctionBegin;
  PetscCall(VecDuplicate(body->layer.elements->u, near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* near = what a vector of the body is on the nodes of the elements that touch the layer */
PetscErrorCode BodyGatherLayer(Body body, Vec u, Vec near)
{
  PetscFunctionBegin;
  PetscCall(VecScatterBegin(body->layer.elements->gather, u, near, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(body->layer.elements->gather, u, near, INSERT_VALUES, SCATTER_FORWARD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The way back: u gets the values of these nodes, and others stay. Ranks that have a node in common have the same values of it. */
PetscErrorCode BodySpreadLayer(Body body, Vec near, Vec u)
{
  PetscFunctionBegin;
  PetscCall(VecScatterBegin(body->layer.elements->gather, near, u, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(body->layer.elements->gather, near, u, INSERT_VALUES, SCATTER_REVERSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K = tangent stiffness of the layer at a displacement that BodyGatherLayer() has made [N/m], from a history that BodyLayerCopyHistory()
   has given, with its step; NULL: that of the present substep. `tangents`: those of the elements that touch the layer, one after the
   other, if not NULL. The first time collective; then, where one rank has the body, of that alone. */
PetscErrorCode BodyAssembleLayer(Body body, Vec near, const PetscReal history[], PetscReal step, PetscScalar tangents[], Mat K)
{
  LayerElements      layer = body->layer.elements;
  const PetscInt     nodes = body->model.element->nodes, n = nodes * body->mesh.dim;
  PetscInt           dofs[ELEMENT_MAX_DOFS];
  PetscScalar        one[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS] = {0};
  const PetscScalar *at;
  Mat                all = K;

  PetscFunctionBegin;
  PetscCall(BodyBeginAssembly(body, all, &K));
  PrepareHistory(body);
  if (layer->history && history) {
    layer->element->history.start = history;
    layer->element->history.step  = step;
  }
  PetscCall(MatZeroEntries(K));
  PetscCall(VecGetArrayRead(near, &at));
  for (PetscInt e = 0; e < layer->element->count; e++) {
    PetscScalar *element = tangents ? tangents + e * n * n : one;

    for (PetscInt i = 0; i < n; i++)
      dofs[i] = layer->numbers[layer->connectivity[e * nodes + i / body->mesh.dim] * body->mesh.dim + i % body->mesh.dim];
    PetscCall((*layer->element->ops->tangent)(layer->element, e, PETSC_FALSE, at, element));
    PetscCall(MatSetValues(K, n, dofs, n, dofs, element, ADD_VALUES)); /* leaves negative numbers out */
  }
  PetscCall(VecRestoreArrayRead(near, &at));
  PetscCall(MatAssemblyBegin(K, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(K, MAT_FINAL_ASSEMBLY));
  PetscCall(BodyEndAssembly(all, K));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many numbers the tangents of all elements that touch the layer are */
PetscInt BodyCountLayerTangents(Body body)
{
  return body->layer.elements->element->count * PetscSqr(body->model.element->nodes * body->mesh.dim);
}

/* f = tangent stiffness of the elements that touch the layer (BodyAssembleLayer()) times du; on all dofs, du zero but on the layer [N] */
PetscErrorCode BodyMultiplyLayerTangent(Body body, const PetscScalar tangents[], Vec du, Vec f)
{
  LayerElements      layer = body->layer.elements;
  const PetscInt     nodes = body->model.element->nodes, dim = body->mesh.dim, n = nodes * dim;
  PetscScalar       *product;
  const PetscScalar *change;

  PetscFunctionBegin;
  PetscCall(BodyGatherLayer(body, du, layer->u));
  PetscCall(VecGetArrayRead(layer->u, &change));
  PetscCall(VecGetArrayWrite(layer->f, &product));
  PetscCall(PetscArrayzero(product, layer->n_dofs));
  for (PetscInt e = 0; e < layer->element->count; e++) {
    const PetscInt    *node = layer->connectivity + e * nodes;
    const PetscScalar *K    = tangents + e * n * n;

    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++) product[node[i / dim] * dim + i % dim] += K[i * n + j] * change[node[j / dim] * dim + j % dim];
  }
  PetscCall(VecRestoreArrayWrite(layer->f, &product));
  PetscCall(VecRestoreArrayRead(layer->u, &change));
  PetscCall(VecZeroEntries(f));
  PetscCall(VecScatterBegin(layer->gather, layer->f, f, ADD_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(layer->gather, layer->f, f, ADD_VALUES, SCATTER_REVERSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stiffness matrix of the undeformed layer, held by the rest of the body */
PetscErrorCode BodyCreateLayerMatrix(Body body, Mat *K)
{
  PetscFunctionBegin;
  PetscCall(MatCreate(PetscObjectComm((PetscObject)body), K));
  PetscCall(MatSetSizes(*K, body->layer.n_dofs, body->layer.n_dofs, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(*K, MATAIJ));
  PetscCall(MatSetUp(*K));
  PetscCall(MatSetOption(*K, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(VecZeroEntries(body->layer.elements->u));
  PetscCall(BodyAssembleLayer(body, body->layer.elements->u, NULL, 0, NULL, *K));
  PetscFunctionReturn(PETSC_SUCCESS);
}
