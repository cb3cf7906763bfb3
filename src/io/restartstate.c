/*
   Runs whose bodies begin with the state of a checkpoint: displacements and velocities at a new time, under other loads, with other
   integrators, on any number of ranks. Nodes are found by their places in the mesh.
*/
#include "outputimpl.h"
#include "checkpointfileimpl.h"

/* What a checkpoint has of a body: numbers of all nodes, on every rank */
typedef struct {
  PetscInt   n, dim;
  PetscReal *x, *u, *v; /* v NULL: the body had no inertia, and its velocities mean nothing */
  PetscInt  *order;     /* of the nodes by their places */
} NodeStates;

/* A dataset of nodes by dimensions, on the first rank; NULL if there is none */
static PetscErrorCode ReadNodes(const CheckpointFile *file, const char body[], const char what[], PetscInt size[2], PetscReal **values)
{
  char    name[PETSC_MAX_PATH_LEN];
  hsize_t length[2] = {0, 0};
  hid_t   dataset, space;

  PetscFunctionBegin;
  *values = NULL;
  PetscCall(PetscSNPrintf(name, sizeof(name), "/bodies/%s", body));
  if (H5Lexists(file->file, "/bodies", H5P_DEFAULT) <= 0 || H5Lexists(file->file, name, H5P_DEFAULT) <= 0)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(name, sizeof(name), "/bodies/%s/%s", body, what));
  if (H5Lexists(file->file, name, H5P_DEFAULT) <= 0) PetscFunctionReturn(PETSC_SUCCESS);
  dataset = H5Dopen2(file->file, name, H5P_DEFAULT);
  PetscCall(HDF5Check(dataset, "open a dataset", file->path));
  space = H5Dget_space(dataset);
  PetscCall(HDF5Check(H5Sget_simple_extent_dims(space, length, NULL), "read a dataset", file->path));
  size[0] = (PetscInt)length[0];
  size[1] = (PetscInt)length[1];
  PetscCall(PetscMalloc1(size[0] * size[1], values));
  PetscCall(HDF5Check(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, *values), "read a dataset", file->path));
  PetscCall(HDF5Check(H5Sclose(space), "close a data space", file->path));
  PetscCall(HDF5Check(H5Dclose(dataset), "read a dataset", file->path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int ComparePlaces(PetscInt dim, const PetscReal a[], const PetscReal b[])
{
  for (PetscInt d = 0; d < dim; d++)
    if (a[d] != b[d]) return a[d] < b[d] ? -1 : 1;
  return 0;
}

static int CompareNodes(const void *a, const void *b, void *context)
{
  const NodeStates *nodes = (const NodeStates *)context;

  return ComparePlaces(nodes->dim, nodes->x + *(const PetscInt *)a * nodes->dim, nodes->x + *(const PetscInt *)b * nodes->dim);
}

/* All numbers of a body, to every rank; n is 0 if the checkpoint does not have it */
static PetscErrorCode ShareNodes(MPI_Comm comm, const CheckpointFile *file, const char body[], NodeStates *nodes)
{
  static const char *const what[]      = {"position", "displacement", "velocity"};
  PetscReal              **values[]    = {&nodes->x, &nodes->u, &nodes->v};
  PetscInt                 sizes[3][2] = {{0}};
  PetscMPIInt              rank;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(nodes, sizeof(*nodes)));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  for (int k = 0; k < 3; k++) {
    if (!rank) PetscCall(ReadNodes(file, body, what[k], sizes[k], values[k]));
    PetscCallMPI(MPI_Bcast(sizes[k], 2, MPIU_INT, 0, comm));
    if (rank && sizes[k][0]) PetscCall(PetscMalloc1(sizes[k][0] * sizes[k][1], values[k]));
    PetscCallMPI(MPI_Bcast(*values[k], (PetscMPIInt)(sizes[k][0] * sizes[k][1]), MPIU_REAL, 0, comm));
  }
  nodes->n   = sizes[0][0];
  nodes->dim = sizes[0][1];
  PetscCall(PetscMalloc1(nodes->n, &nodes->order));
  for (PetscInt i = 0; i < nodes->n; i++) nodes->order[i] = i;
  if (nodes->n > 1) PetscCall(PetscTimSort(nodes->n, nodes->order, sizeof(PetscInt), CompareNodes, nodes));
  for (PetscInt i = 1; i < nodes->n; i++)
    PetscCheck(CompareNodes(nodes->order + i - 1, nodes->order + i, nodes), comm, PETSC_ERR_SUP,
               "-restart_state %s: two nodes of body '%s' lie at one place, and cannot be told from each other", file->path, body);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyNodes(NodeStates *nodes)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(nodes->x));
  PetscCall(PetscFree(nodes->u));
  PetscCall(PetscFree(nodes->v));
  PetscCall(PetscFree(nodes->order));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state of the node at a place, for BodySetInitialState() */
static PetscErrorCode FindState(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *context)
{
  const NodeStates *nodes = (const NodeStates *)context;
  PetscInt          low = 0, high = nodes->n;

  PetscFunctionBegin;
  while (high - low > 1) {
    const PetscInt middle = (low + high) / 2;

    if (ComparePlaces(dim, nodes->x + nodes->order[middle] * dim, x) <= 0) low = middle;
    else high = middle;
  }
  PetscCheck(!ComparePlaces(dim, nodes->x + nodes->order[low] * dim, x), PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "-restart_state: the checkpoint has no node at (%.9g, %.9g, %.9g) m; the meshes must be the same", (double)x[0],
             dim > 1 ? (double)x[1] : 0., dim > 2 ? (double)x[2] : 0.);
  for (PetscInt d = 0; d < dim; d++) {
    u[d] = nodes->u[nodes->order[low] * dim + d];
    if (nodes->v) v[d] = nodes->v[nodes->order[low] * dim + d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The bodies begin with the state of the checkpoint -restart_state, as far as it has them. Collective; before the first step. */
PetscErrorCode OutputTakeState(Output output, const char path[])
{
  MPI_Comm       comm = PetscObjectComm((PetscObject)output);
  CheckpointFile file;
  const Body    *bodies;
  Contact        contact;
  PetscInt       n, found = 0;

  PetscFunctionBegin;
  PetscCall(CheckpointFileOpen(comm, path, &file));
  PetscCall(ControllerGetBodies(output->controller, &n, &bodies));
  for (PetscInt b = 0; b < n; b++) {
    const char *name;
    NodeStates  nodes;
    PetscInt    dim;

    PetscCall(PetscObjectGetName((PetscObject)bodies[b], &name));
    PetscCall(ShareNodes(comm, &file, name, &nodes));
    PetscCall(BodyGetDimension(bodies[b], &dim));
    PetscCheck(!nodes.n || nodes.dim == dim, comm, PETSC_ERR_USER_INPUT,
               "-restart_state %s: body '%s' has %" PetscInt_FMT " dimensions there, and %" PetscInt_FMT " here", path, name, nodes.dim,
               dim);
    if (nodes.n) PetscCall(BodySetInitialState(bodies[b], FindState, &nodes));
    else
      PetscCall(
          PetscFPrintf(comm, stderr, "impakt: warning: -restart_state %s has no body '%s', which begins as its options say\n", path, name));
    found += nodes.n > 0;
    PetscCall(DestroyNodes(&nodes));
  }
  PetscCheck(found, comm, PETSC_ERR_USER_INPUT, "-restart_state %s has none of the bodies of this run", path);
  PetscCall(ControllerGetContact(output->controller, &contact));
  PetscCall(ContactCheckInitialGap(contact));
  PetscCall(PetscFPrintf(comm, stderr, "impakt: begun with the state of %s, after its controller step %" PetscInt_FMT " at time %g s\n",
                         path, file.info.step, (double)file.info.time));
  PetscCall(CheckpointFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}
