/* Rods from options: a disc, or a half or a quarter of it, drawn out along z, of hexahedra or tetrahedra. */
#include "ballimpl.h"

typedef struct {
  Ball      disc;
  PetscInt  elements; /* along the axis */
  PetscReal length;   /* [m] */
  MeshFile *file;     /* of the rod */
} Rod;

PetscErrorCode MeshIsRod(const char prefix[], PetscBool *rod)
{
  char shape[64] = "";

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-dm_plex_shape", shape, sizeof(shape), NULL));
  PetscCall(PetscStrcasecmp(shape, "rod", rod));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadLength(MPI_Comm comm, const char prefix[], const char option[], PetscReal *value)
{
  PetscReal values[4];
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(MeshReadNumbers(comm, prefix, option, 1, "a length [m]", values, &set));
  if (set) *value = values[0];
  PetscCheck(*value > 0, comm, PETSC_ERR_USER_INPUT, "-%s%s %g: must be positive", prefix, option + 1, (double)*value);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadCount(MPI_Comm comm, const char prefix[], const char option[], PetscInt *value)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsGetInt(NULL, prefix, option, value, NULL));
  PetscCheck(*value >= 1, comm, PETSC_ERR_USER_INPUT, "-%s%s %" PetscInt_FMT ": there must be at least 1", prefix, option + 1, *value);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadPart(MPI_Comm comm, const char prefix[], Ball *disc)
{
  const char *const parts[] = {"full", "half", "quarter"};
  PetscInt          part    = 0;
  PetscBool         set;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetEList(NULL, prefix, "-rod_part", parts, 3, &part, &set));
  disc->n_cuts = part;
  PetscCheck(!part || disc->divisions % 2 == 0, comm, PETSC_ERR_USER_INPUT,
             "-%srod_divisions %" PetscInt_FMT ": must be even for -%srod_part %s, which cuts the central block in its middle", prefix,
             disc->divisions, prefix, parts[part]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadRod(MPI_Comm comm, const char prefix[], Rod *rod)
{
  PetscInt dim = 3;

  PetscFunctionBegin;
  rod->disc     = (Ball){.dim = 2, .divisions = 4, .radius = 1, .grading = 1, .keep_volume = PETSC_TRUE, .pole = {0, -1, 0}};
  rod->elements = 10;
  rod->length   = 1;
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-dm_plex_dim", &dim, NULL));
  PetscCheck(dim == 3, comm, PETSC_ERR_USER_INPUT, "-%sdm_plex_dim %" PetscInt_FMT ": -%sdm_plex_shape rod has 3 dimensions", prefix, dim,
             prefix);
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-dm_plex_simplex", &rod->disc.simplex, NULL));
  PetscCall(ReadLength(comm, prefix, "-rod_radius", &rod->disc.radius));
  PetscCall(ReadLength(comm, prefix, "-rod_length", &rod->length));
  PetscCall(ReadCount(comm, prefix, "-rod_divisions", &rod->disc.divisions));
  rod->disc.layers = (rod->disc.divisions + 1) / 2;
  PetscCall(ReadCount(comm, prefix, "-rod_layers", &rod->disc.layers));
  PetscCall(ReadCount(comm, prefix, "-rod_elements", &rod->elements));
  PetscCall(ReadPart(comm, prefix, &rod->disc));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-rod_keep_volume", &rod->disc.keep_volume, NULL));
  PetscCall(BallChooseOrder(prefix, &rod->disc));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The node of the rod in a section of its nodes: that of a corner of an element of the disc, or in the middle between two of its corners */
static PetscInt NodeAbove(const MeshFile *disc, const MeshRun *run, const PetscInt flat[], PetscInt a, PetscInt b, PetscInt section)
{
  PetscInt node = flat[a];

  for (PetscInt k = 0; k < run->nodes - run->corners; k++) {
    const PetscInt *ends = MeshSimplexEdges[k];

    if ((a == ends[0] && b == ends[1]) || (a == ends[1] && b == ends[0])) node = flat[run->corners + k];
  }
  return section * disc->n_nodes + node;
}

/* Adds the simplices that fill what a triangle or a line of the disc becomes from one section of nodes on: diagonals of its sides lead from
   the node with the lower number below to that with the higher one above, so that neighbours cut their common side alike */
static PetscErrorCode AddSimplices(const Rod *rod, const MeshFile *disc, const MeshRun *run, const PetscInt flat[], PetscInt lower)
{
  static const PetscInt parts[2][3][4] = {{{0, 1, 3}, {0, 3, 2}}, {{0, 1, 2, 5}, {1, 0, 4, 5}, {0, 3, 4, 5}}};
  const PetscInt        n = run->corners, step = rod->disc.step;
  PetscInt              sorted[3];
  PetscBool             mirrored = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCheck(n == 2 || n == 3, PETSC_COMM_SELF, PETSC_ERR_PLIB, "%" PetscInt_FMT " nodes are those of no line or triangle", n);
  for (PetscInt a = 0; a < n; a++) sorted[a] = a;
  for (PetscInt a = 1; a < n; a++)
    for (PetscInt k = a; k > 0 && flat[sorted[k - 1]] > flat[sorted[k]]; k--) {
      const PetscInt corner = sorted[k];

      sorted[k]     = sorted[k - 1];
      sorted[k - 1] = corner;
      mirrored      = (PetscBool)!mirrored;
    }
  for (PetscInt part = 0; part < n; part++) {
    PetscInt *nodes, corner[4], section[4];

    PetscCall(MeshFileAddElement(rod->file, rod->file->n_elements + 1, &nodes));
    for (PetscInt k = 0; k <= n; k++) {
      const PetscInt from = parts[n - 2][part][k], to = mirrored && k < 2 ? 1 - k : k;

      corner[to]  = sorted[from % n];
      section[to] = lower + step * (from / n);
    }
    for (PetscInt k = 0; k <= n; k++) nodes[k] = NodeAbove(disc, run, flat, corner[k], corner[k], section[k]);
    for (PetscInt k = 0; k < n * (n + 1) / 2 && step == 2; k++) {
      const PetscInt a = MeshSimplexEdges[k][0], b = MeshSimplexEdges[k][1];

      nodes[n + 1 + k] = NodeAbove(disc, run, flat, corner[a], corner[b], (section[a] + section[b]) / 2);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The run of the rod with what a run of the disc becomes: cells of cells, sides of edges */
static PetscErrorCode DrawOut(const Rod *rod, const MeshFile *disc, PetscInt r)
{
  const MeshRun *run = &disc->runs[r];
  PetscInt       group;

  PetscFunctionBegin;
  if (run->dim == 1) {
    const MeshGroup *of_disc = &disc->groups[disc->run_groups[run->first_group]];

    PetscCall(MeshFileAddGroup(rod->file, MESH_SIDE_SET, 2, of_disc->number, &group));
    PetscCall(PetscStrncpy(rod->file->groups[group].name, of_disc->name, sizeof(rod->file->groups[group].name)));
    PetscCall(BallAddRun(rod->file, &rod->disc, 2, 1, &group));
  } else PetscCall(BallAddRun(rod->file, &rod->disc, 3, 0, NULL));
  for (PetscInt k = 0; k < rod->elements; k++)
    for (PetscInt e = 0; e < run->n; e++) {
      const PetscInt *flat  = disc->element_nodes + run->first_node + e * run->nodes;
      const PetscInt  lower = k * disc->n_nodes, upper = lower + disc->n_nodes; /* of hexahedra */
      PetscInt       *nodes;

      if (rod->disc.simplex) {
        PetscCall(AddSimplices(rod, disc, run, flat, rod->disc.step * k));
        continue;
      }
      PetscCall(MeshFileAddElement(rod->file, rod->file->n_elements + 1, &nodes));
      for (PetscInt a = 0; a < run->corners; a++) {
        nodes[a]                                          = lower + flat[a];
        nodes[run->corners + (run->dim == 1 ? 1 - a : a)] = upper + flat[a];
      }
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FillRod(void *ctx)
{
  const Rod     *rod = (const Rod *)ctx;
  MeshFile       disc;
  BallGrid       grid     = {.file = &disc, .ball = &rod->disc};
  const PetscInt sections = rod->disc.step * rod->elements + 1; /* of nodes */
  char           back[]   = "back";

  PetscFunctionBegin;
  PetscCall(MeshFileInitialize(&disc, NULL));
  PetscCall(MeshFillBall(&grid));
  rod->file->n_nodes = disc.n_nodes * sections;
  PetscCall(PetscMalloc1(3 * rod->file->n_nodes, &rod->file->coordinates));
  for (PetscInt k = 0; k < sections; k++)
    for (PetscInt i = 0; i < disc.n_nodes; i++) {
      PetscReal *x = rod->file->coordinates + 3 * (k * disc.n_nodes + i);

      x[0] = disc.coordinates[3 * i];
      x[1] = disc.coordinates[3 * i + 1];
      x[2] = rod->length * (PetscReal)k / (PetscReal)(sections - 1);
    }
  for (PetscInt r = 0; r < disc.n_runs; r++) {
    const MeshRun *run  = &disc.runs[r];
    PetscBool      same = PETSC_FALSE;

    if (run->dim == 1) PetscCall(PetscStrcmp(disc.groups[disc.run_groups[run->first_group]].name, back, &same));
    if (!same) PetscCall(DrawOut(rod, &disc, r)); /* a rod has no pole, and no back to it */
  }
  PetscCall(PetscFree(grid.rim));
  PetscCall(MeshFileDestroy(&disc));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A rod from options, along z from 0, all of it on a rank; `PETSC_DECIDE`: on the first one. And where the nodes in the middle of its edges
   are, if it has some */
PetscErrorCode MeshCreateRod(MPI_Comm comm, const char prefix[], const char name[], PetscMPIInt rank, DM *dm, MeshMiddles *middles)
{
  Rod            rod;
  MeshFile       file;
  char           where[256];
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(ReadRod(comm, prefix, &rod));
  PetscCall(MeshFileInitialize(&file, NULL));
  file.rank = PetscMax(rank, 0);
  rod.file  = &file;
  PetscCall(PetscSNPrintf(where, sizeof(where), "Body '%s', -%sdm_plex_shape rod", name, prefix));
  error = MeshOnRank(comm, file.rank, FillRod, &rod, where);
  if (!error) error = MeshBuild(comm, &file, where, dm, middles);
  PetscCall(MeshFileDestroy(&file));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}
