/* Runs whose bodies begin with the state of a checkpoint: displacements, velocities and the history of materials at a new time, under other
   loads, with other integrators, on any number of ranks. Nodes are found by their places in the mesh. */
#include <body/interface/bodyvisit.h>
#include <contact/interface/contactvisit.h>
#include "outputimpl.h"
#include "checkpointfileimpl.h"
#include <sys/units.h>

/* What a checkpoint has of a body, on every rank */
typedef struct {
  const char *body;
  PetscInt    n, dim;
  PetscReal  *u, *v; /* of all nodes; v NULL: the body had no inertia, and its velocities mean nothing */
  Tables      places;
} NodeStates;

/* Whether there is such a group or dataset, on the first rank */
static PetscBool Has(const CheckpointFile *file, const char name[])
{
  return (PetscBool)(H5Lexists(file->file, name, H5P_DEFAULT) > 0);
}

/* A dataset of nodes by dimensions, to every rank; NULL if there is none */
static PetscErrorCode ShareDataset(MPI_Comm comm, const CheckpointFile *file, const char body[], const char what[], PetscInt size[2],
                                   PetscReal **values)
{
  char        group[PETSC_MAX_PATH_LEN], name[PETSC_MAX_PATH_LEN];
  PetscMPIInt rank;

  PetscFunctionBegin;
  *values = NULL;
  size[0] = size[1] = 0;
  PetscCall(PetscSNPrintf(group, sizeof(group), "/bodies/%s", body));
  PetscCall(PetscSNPrintf(name, sizeof(name), "/bodies/%s/%s", body, what));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank && Has(file, "/bodies") && Has(file, group) && Has(file, name)) PetscCall(CheckpointReadArray(file, name, size, values));
  PetscCall(CheckpointShareArray(comm, size, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All nodes of a body, to every rank; n is 0 if the checkpoint does not have it */
static PetscErrorCode ShareNodes(MPI_Comm comm, const CheckpointFile *file, const char body[], NodeStates *nodes)
{
  PetscReal *x, *keys;
  PetscInt   sizes[2];

  PetscFunctionBegin;
  PetscCall(ShareDataset(comm, file, body, "displacement", sizes, &nodes->u));
  PetscCall(ShareDataset(comm, file, body, "velocity", sizes, &nodes->v));
  PetscCall(ShareDataset(comm, file, body, "position", sizes, &x));
  nodes->body = body;
  nodes->n    = sizes[0];
  nodes->dim  = sizes[1];
  PetscCall(PetscMalloc1(nodes->n * TABLES_KEY, &keys));
  for (PetscInt i = 0; i < nodes->n; i++)
    for (PetscInt d = 0; d < TABLES_KEY; d++) keys[i * TABLES_KEY + d] = d < nodes->dim ? x[i * nodes->dim + d] : 0;
  PetscCall(PetscFree(x));
  PetscCall(TablesCreate(comm, &nodes->places));
  PetscCall(TablesShare(nodes->places, body, nodes->n, TABLES_KEY, keys));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyNodes(NodeStates *nodes)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(nodes->u));
  PetscCall(PetscFree(nodes->v));
  PetscCall(TablesDestroy(&nodes->places));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state of the node at a place, for BodySetInitialState() */
static PetscErrorCode FindState(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *context)
{
  const NodeStates *nodes           = (const NodeStates *)context;
  PetscReal         key[TABLES_KEY] = {0};
  PetscInt          row;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(key, x, dim));
  PetscCall(TablesLookFor(nodes->places, nodes->body, key, &row));
  PetscCheck(row >= 0, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "-restart_state: the checkpoint has no node at (%.9g, %.9g, %.9g) m; the meshes must be the same", (double)key[0],
             (double)key[1], (double)key[2]);
  for (PetscInt d = 0; d < dim; d++) {
    u[d] = nodes->u[row * dim + d];
    if (nodes->v) v[d] = nodes->v[row * dim + d];
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
  Tables         tables;
  PetscReal      start;
  PetscInt       n, found = 0;
  char           again[256] = "";

  PetscFunctionBegin;
  PetscCall(CheckpointFileOpen(comm, "-restart_state", path, &file));
  PetscCall(CheckpointFileReadTables(comm, &file, &tables));
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
    if (nodes.n) {
      PetscCall(BodyTakeHistory(bodies[b], tables)); /* first: stresses of the displacements follow from it */
      PetscCall(BodySetInitialState(bodies[b], FindState, &nodes));
      PetscCall(BodyNotePlasticBefore(bodies[b]));
    } else
      PetscCall(
          PetscFPrintf(comm, stderr, "impakt: warning: -restart_state %s has no body '%s', which begins as its options say\n", path, name));
    found += nodes.n > 0;
    PetscCall(DestroyNodes(&nodes));
  }
  PetscCall(TablesDestroy(&tables));
  PetscCheck(found, comm, PETSC_ERR_USER_INPUT, "-restart_state %s has none of the bodies of this run", path);
  PetscCall(ControllerGetContact(output->controller, &contact));
  PetscCall(ContactTakeState(contact));
  PetscCall(ControllerGetTimes(output->controller, &start, NULL, NULL));
  if (start != file.info.time)
    PetscCall(PetscSNPrintf(again, sizeof(again),
                            "; time starts again at %g%s, and so do formulas in t of loads and displacements: a load that is to stay needs "
                            "its value there, or -time_start %.9g, with which formulas go on",
                            (double)start, UnitsOf((PetscObject)output->controller, UNIT_TIME), (double)file.info.time));
  PetscCall(PetscFPrintf(comm, stderr, "impakt: begun with the state of %s, after its controller step %" PetscInt_FMT " at time %g%s%s\n",
                         path, file.info.step, (double)file.info.time, UnitsOf((PetscObject)output->controller, UNIT_TIME), again));
  PetscCall(CheckpointFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}
