/* Velocities of massless contact nodes that follow those of the nodes with mass (inner nodes): v = E v_inner, the affine extrapolation of
   the nearest of them. With the full mass M the mass of the body is E^T M E. It has the kinetic energy of each field of velocities that is
   affine around every contact node, rigid motions among them: total mass, centre and moments of inertia are exact. It is positive definite
   on inner nodes whatever the weights are, since M is.

   The weights of a contact node are those of least sum w^2 / omega that satisfy sum w = 1, sum w (x - x_node) = 0, with omega = 1 /
   distance^4. Where the neighbouring inner nodes lie in a plane, or nearly so, there are no such weights, or only large ones: there the
   inner nodes do not span the body, as in sheets of one or two elements. */
#include <body/layout/bodyimpl.h>
#include <petscblaslapack.h>

/* Inner nodes are looked for within so many elements, in two at first */
#define LEAST_RINGS 2
#define MOST_RINGS  3
/* Nodes at distances that differ by less than this part are taken or left together, so that symmetric meshes have symmetric weights */
#define EQUAL_DISTANCE 1e-6
/* A direction in which the neighbours extend less than this part of what they do in the largest is one that they do not span */
#define FLAT 1e-4
/* Weights are exact to this */
#define EXACT      1e-10
#define MAX_FIELDS 4

typedef struct {
  PetscInt  dim, n_wanted; /* inner nodes for one contact node at first: those of a regular mesh within one element, and one more */
  PetscReal largest_sum;   /* of the absolute weights of one node */
  IS        nodes;         /* global numbers, ascending */
  Mat      *graph;         /* of these */
  Vec       positions;
  Vec       marks; /* 1: massless, in the first component of a node */
  const PetscScalar *x, *massless;
  /* work space */
  PetscInt   n_found, *found, *ring; /* inner nodes around a contact node; per node: elements to it, -1: further away */
  PetscReal *distance, *weights;
  PetscInt  *queue;
  PetscBool *moves; /* which of the nodes that this rank owns are to move as inner nodes do */
} Surroundings;

/* An inner node is as far from the surface as two of them are from each other in a regular mesh. Extrapolation by three times that distance
   in each direction has this sum of absolute weights: 1 + a at the nearest node, -a at its neighbour, a = 3 for each direction. */
static PetscReal LargestSum(PetscInt dim)
{
  return 1 + 6 * dim;
}

static PetscErrorCode Gather(Vec from, IS dofs, Vec *to)
{
  VecScatter scatter;
  PetscInt   n;

  PetscFunctionBegin;
  PetscCall(ISGetLocalSize(dofs, &n));
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, n, to));
  PetscCall(VecScatterCreate(from, dofs, *to, NULL, &scatter));
  PetscCall(BodyUseScatter(scatter, from, *to));
  PetscCall(VecScatterDestroy(&scatter));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The elements that are looked through: those within MOST_RINGS of contact nodes */
static PetscErrorCode MarkElements(Body body, PetscBool near[])
{
  const PetscInt     n = body->model.element->nodes, dim = body->mesh.dim;
  PetscBool         *reached;
  PetscScalar       *sum;
  const PetscScalar *sums;
  Vec                counts, local;

  PetscFunctionBegin;
  PetscCall(BodyCreateVec(body, &counts));
  PetscCall(PetscMalloc1(body->mesh.local_nodes, &reached));
  PetscCall(PetscArraycpy(reached, body->layer.contains, body->mesh.local_nodes));
  for (PetscInt ring = 0; ring < MOST_RINGS; ring++) {
    PetscCall(BodyGetLocalSum(body, counts, &local, &sum));
    for (PetscInt e = 0; e < body->model.element->count; e++) {
      const PetscInt *nodes = body->mesh.connectivity + e * n;

      for (PetscInt a = 0; a < n; a++)
        if (reached[nodes[a]]) near[e] = PETSC_TRUE;
      for (PetscInt a = 0; a < n && near[e]; a++) sum[nodes[a] * dim] += 1;
    }
    PetscCall(BodyRestoreLocalSum(body, counts, &local, &sum));
    PetscCall(BodyGetLocalRead(body, counts, &local, &sums));
    for (PetscInt i = 0; i < body->mesh.local_nodes; i++) reached[i] = (PetscBool)(PetscRealPart(sums[i * dim]) > 0);
    PetscCall(BodyRestoreLocalRead(body, counts, &local, &sums));
  }
  PetscCall(PetscFree(reached));
  PetscCall(VecDestroy(&counts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Contact nodes but those that are held in all directions: where these are is known, as it is of inner nodes */
static PetscErrorCode FindMoving(Body body, PetscBool **moves)
{
  const PetscInt dim = body->mesh.dim;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(body->mesh.owned_nodes, moves));
  PetscCall(PetscArraycpy(*moves, body->layer.contains, body->mesh.owned_nodes));
  for (PetscInt i = 0; i + dim <= body->held.n; i++) { /* ascending */
    const PetscInt dof = body->held.dofs[i];

    if (dof % dim == 0 && body->held.dofs[i + dim - 1] == dof + dim - 1) (*moves)[dof / dim] = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSurroundings(Body body, Surroundings *around)
{
  const PetscInt  dim = body->mesh.dim;
  const PetscInt *indices;
  PetscInt        n = 0, begin, *layer;
  PetscBool      *near;
  PetscScalar    *mark;
  Vec             marks;
  Mat             graph;
  IS              dofs;

  PetscFunctionBegin;
  *around = (Surroundings){.dim = dim, .n_wanted = 1 + (dim > 2 ? 9 : dim > 1 ? 3 : 1), .largest_sum = LargestSum(dim)};
  PetscCall(PetscCalloc1(body->model.element->count, &near));
  PetscCall(MarkElements(body, near));
  PetscCall(BodyCreateNodeGraph(body, near, &graph));
  PetscCall(PetscFree(near));
  PetscCall(MatGetOwnershipRange(graph, &begin, NULL));
  PetscCall(BodyCreateVec(body, &marks));
  PetscCall(VecZeroEntries(marks));
  PetscCall(VecGetArray(marks, &mark));
  PetscCall(FindMoving(body, &around->moves));
  PetscCall(PetscMalloc1(body->mesh.owned_nodes, &layer));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    if (!around->moves[node]) continue;
    layer[n++]       = begin + node;
    mark[node * dim] = 1;
  }
  PetscCall(VecRestoreArray(marks, &mark));
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, n, layer, PETSC_OWN_POINTER, &around->nodes));
  PetscCall(MatIncreaseOverlap(graph, 1, &around->nodes, MOST_RINGS));
  PetscCall(ISSort(around->nodes));
  PetscCall(MatCreateSubMatrices(graph, 1, &around->nodes, &around->nodes, MAT_INITIAL_MATRIX, &around->graph));
  PetscCall(MatDestroy(&graph));
  PetscCall(ISGetLocalSize(around->nodes, &n));
  PetscCall(ISGetIndices(around->nodes, &indices));
  PetscCall(ISCreateBlock(PETSC_COMM_SELF, dim, n, indices, PETSC_COPY_VALUES, &dofs));
  PetscCall(ISRestoreIndices(around->nodes, &indices));
  PetscCall(Gather(body->mesh.positions, dofs, &around->positions));
  PetscCall(Gather(marks, dofs, &around->marks));
  PetscCall(ISDestroy(&dofs));
  PetscCall(VecDestroy(&marks));
  PetscCall(VecGetArrayRead(around->positions, &around->x));
  PetscCall(VecGetArrayRead(around->marks, &around->massless));
  PetscCall(PetscMalloc5(n, &around->found, n, &around->ring, n, &around->queue, n, &around->distance, n, &around->weights));
  for (PetscInt i = 0; i < n; i++) around->ring[i] = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroySurroundings(Surroundings *around)
{
  PetscFunctionBegin;
  PetscCall(PetscFree5(around->found, around->ring, around->queue, around->distance, around->weights));
  PetscCall(PetscFree(around->moves));
  PetscCall(VecRestoreArrayRead(around->marks, &around->massless));
  PetscCall(VecRestoreArrayRead(around->positions, &around->x));
  PetscCall(VecDestroy(&around->marks));
  PetscCall(VecDestroy(&around->positions));
  PetscCall(MatDestroySubMatrices(1, &around->graph));
  PetscCall(ISDestroy(&around->nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The inner nodes within so many elements of a node, by their distance from it */
static PetscErrorCode FindInner(Surroundings *around, PetscInt node, PetscInt rings)
{
  PetscInt n_queue = 1;

  PetscFunctionBegin;
  around->n_found    = 0;
  around->queue[0]   = node;
  around->ring[node] = 0;
  for (PetscInt k = 0; k < n_queue; k++) {
    const PetscInt  at = around->queue[k];
    const PetscInt *columns;
    PetscInt        n_columns;

    if (around->massless[at * around->dim] == 0) around->found[around->n_found++] = at;
    if (around->ring[at] == rings) continue;
    PetscCall(MatGetRow(around->graph[0], at, &n_columns, &columns, NULL));
    for (PetscInt c = 0; c < n_columns; c++) {
      if (around->ring[columns[c]] >= 0) continue;
      around->ring[columns[c]] = around->ring[at] + 1;
      around->queue[n_queue++] = columns[c];
    }
    PetscCall(MatRestoreRow(around->graph[0], at, &n_columns, &columns, NULL));
  }
  for (PetscInt k = 0; k < n_queue; k++) around->ring[around->queue[k]] = -1;
  for (PetscInt k = 0; k < around->n_found; k++) {
    PetscReal square = 0;

    for (PetscInt d = 0; d < around->dim; d++)
      square += PetscSqr(PetscRealPart(around->x[around->found[k] * around->dim + d] - around->x[node * around->dim + d]));
    around->distance[k] = PetscSqrtReal(square);
  }
  PetscCall(PetscSortRealWithArrayInt(around->n_found, around->distance, around->found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The weights of the first n inner nodes, and the sum of their absolute values; 0: there are no such weights. With the fields 1 and x -
   x_node, in units of the largest distance, as the columns of A, and W = diag(omega): w = W A (A^T W A)^-1 e_1. */
static PetscErrorCode FindWeights(Surroundings *around, PetscInt node, PetscInt n, PetscReal *sum)
{
  const PetscInt  dim = around->dim, m = dim + 1;
  const PetscReal size                            = around->distance[n - 1];
  PetscReal       normal[MAX_FIELDS * MAX_FIELDS] = {0}, values[MAX_FIELDS], work[4 * MAX_FIELDS], coefficients[MAX_FIELDS] = {0};
  PetscReal       missing[MAX_FIELDS] = {-1};
  PetscBLASInt    order = (PetscBLASInt)m, lwork = 4 * MAX_FIELDS, info;

  PetscFunctionBegin;
  for (PetscInt pass = 0; pass < 2; pass++) {
    *sum = 0;
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal omega           = PetscSqr(PetscSqr(around->distance[0] / around->distance[k]));
      PetscReal       phi[MAX_FIELDS] = {1};

      for (PetscInt d = 0; d < dim; d++)
        phi[1 + d] = PetscRealPart(around->x[around->found[k] * dim + d] - around->x[node * dim + d]) / size;
      if (!pass)
        for (PetscInt i = 0; i < m * m; i++) normal[i] += omega * phi[i / m] * phi[i % m];
      else {
        around->weights[k] = 0;
        for (PetscInt i = 0; i < m; i++) around->weights[k] += omega * coefficients[i] * phi[i];
        for (PetscInt i = 0; i < m; i++) missing[i] += around->weights[k] * phi[i];
        *sum += PetscAbsReal(around->weights[k]);
      }
    }
    if (pass) break;
    PetscCallBLAS("LAPACKsyev", LAPACKsyev_("V", "L", &order, normal, &order, values, work, &lwork, &info));
    PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK syev info %d", (int)info);
    for (PetscInt j = 0; j < m; j++) {
      if (values[j] <= PetscSqr(FLAT) * values[m - 1]) continue;
      for (PetscInt i = 0; i < m; i++) coefficients[i] += normal[j * m + i] * normal[j * m] / values[j];
    }
  }
  for (PetscInt i = 0; i < m; i++)
    if (PetscAbsReal(missing[i]) > EXACT) *sum = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The weights of a contact node: of the nearest inner nodes, of more of them where these do not span. n is their number; 0: none do. */
static PetscErrorCode Extrapolate(Surroundings *around, PetscInt node, PetscInt *n, PetscReal *sum)
{
  PetscFunctionBegin;
  for (PetscInt rings = LEAST_RINGS; rings <= MOST_RINGS; rings++) {
    PetscCall(FindInner(around, node, rings));
    *n = 0;
    for (PetscInt wanted = around->n_wanted; *n < around->n_found; wanted *= 2) {
      *n = PetscMin(PetscMax(*n, wanted), around->n_found);
      while (*n < around->n_found && around->distance[*n] <= (1 + EQUAL_DISTANCE) * around->distance[*n - 1]) (*n)++;
      PetscCall(FindWeights(around, node, *n, sum));
      if (*sum > 0 && *sum <= around->largest_sum) PetscFunctionReturn(PETSC_SUCCESS);
    }
  }
  *n   = 0;
  *sum = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* E, and which of this rank's contact nodes have no weights: they have the identity in E */
static PetscErrorCode FillExtrapolation(Body body, Surroundings *around, PetscBool keeps[])
{
  const PetscInt *numbers;
  const PetscReal one = 1;
  PetscInt        begin;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(body->mass.extrapolation, &begin, NULL));
  PetscCall(ISGetIndices(around->nodes, &numbers));
  for (PetscInt i = 0; i < body->mesh.owned_nodes; i++) {
    const PetscInt row = begin + i;
    PetscInt       n   = 0, node;
    PetscReal      sum = 0;

    if (around->moves[i]) {
      PetscCall(ISLocate(around->nodes, row, &node));
      PetscCall(Extrapolate(around, node, &n, &sum));
      keeps[i]                   = (PetscBool)(n == 0);
      body->mass.extrapolated_by = PetscMax(body->mass.extrapolated_by, sum);
      for (PetscInt k = 0; k < n; k++)
        PetscCall(MatSetValue(body->mass.extrapolation, row, numbers[around->found[k]], around->weights[k], INSERT_VALUES));
    }
    if (!n) PetscCall(MatSetValues(body->mass.extrapolation, 1, &row, 1, &row, &one, INSERT_VALUES));
  }
  PetscCall(ISRestoreIndices(around->nodes, &numbers));
  PetscCall(MatAssemblyBegin(body->mass.extrapolation, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(body->mass.extrapolation, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CountNodes(Body body, const PetscBool keeps[])
{
  PetscInt all[2] = {0};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < body->mesh.owned_nodes; i++) {
    all[0] += body->layer.contains[i] ? 1 : 0;
    all[1] += keeps[i] ? 1 : 0;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all, 2, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  body->mass.n_contact = all[0];
  body->mass.n_keep    = all[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the first of the contact nodes is that keep their mass, of the rank that has any; ranks agree on the place */
static PetscErrorCode NotePlace(Body body, const PetscBool keeps[])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)body);
  PetscMPIInt rank, first;
  PetscInt    node = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  while (node < body->mesh.owned_nodes && !keeps[node]) node++;
  first = node < body->mesh.owned_nodes ? rank : PETSC_MPI_INT_MAX;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm));
  if (first == PETSC_MPI_INT_MAX) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < body->mesh.dim && rank == first; d++) body->mass.keeps_at[d] = body->mesh.coordinates[node * body->mesh.dim + d];
  PetscCallMPI(MPI_Bcast(body->mass.keeps_at, 3, MPIU_REAL, first, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* E, if inner nodes span the body around all contact nodes; and around how many they do not, nearly in a plane */
PetscErrorCode BodyFindExtrapolation(Body body)
{
  const PetscInt n    = body->mesh.owned_nodes;
  MPI_Comm       comm = PetscObjectComm((PetscObject)body);
  Surroundings   around;
  PetscBool     *keeps;

  PetscFunctionBegin;
  PetscCall(MatCreate(comm, &body->mass.extrapolation));
  PetscCall(MatSetSizes(body->mass.extrapolation, n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(body->mass.extrapolation, MATAIJ));
  PetscCall(MatSetUp(body->mass.extrapolation));
  PetscCall(PetscCalloc1(n, &keeps));
  PetscCall(CreateSurroundings(body, &around));
  PetscCall(FillExtrapolation(body, &around, keeps));
  PetscCall(DestroySurroundings(&around));
  PetscCall(CountNodes(body, keeps));
  PetscCall(NotePlace(body, keeps));
  PetscCall(PetscFree(keeps));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &body->mass.extrapolated_by, 1, MPIU_REAL, MPIU_MAX, comm));
  if (body->mass.n_keep) PetscCall(MatDestroy(&body->mass.extrapolation));
  PetscFunctionReturn(PETSC_SUCCESS);
}
