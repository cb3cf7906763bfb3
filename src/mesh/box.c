/* Boxes from options: DMPLEX's own, and boxes of triangles and tetrahedra, for which PETSc alone has no generator. */
#include "ballimpl.h"

typedef struct {
  MeshFile      *file;
  const MeshBox *box;
} Division;

static PetscErrorCode ReadCorner(MPI_Comm comm, const char prefix[], const char option[], PetscInt dim, PetscReal corner[3])
{
  PetscInt  n = 3;
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetRealArray(NULL, prefix, option, corner, &n, &set));
  PetscCheck(!set || n == dim, comm, PETSC_ERR_USER_INPUT, "-%s%s has %" PetscInt_FMT " numbers; -%sdm_plex_dim asks for %" PetscInt_FMT,
             prefix, option + 1, n, prefix, dim);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads and checks DMPLEX's options for boxes. Defaults are DMPLEX's, but that cells are quadrilaterals and hexahedra. */
static PetscErrorCode ReadBox(MPI_Comm comm, const char prefix[], MeshBox *box)
{
  char      shape[64], option[128];
  PetscInt  n;
  PetscBool set;

  PetscFunctionBegin;
  *box = (MeshBox){.dim = 2, .lower = {0, 0, 0}, .upper = {1, 1, 1}, .simplex = PETSC_FALSE, .is_box = PETSC_TRUE};
  PetscCall(PetscOptionsGetString(NULL, prefix, "-dm_plex_shape", shape, sizeof(shape), &set));
  if (set) PetscCall(PetscStrcasecmp(shape, "box", &box->is_box));
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-dm_plex_dim", &box->dim, NULL));
  PetscCheck(box->dim >= 1 && box->dim <= 3, comm, PETSC_ERR_USER_INPUT,
             "-%sdm_plex_dim %" PetscInt_FMT ": a body has 1, 2 or 3 dimensions", prefix, box->dim);
  if (!box->is_box) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < box->dim; d++) box->faces[d] = box->dim == 1 ? 1 : 4 - box->dim;
  n = 3;
  PetscCall(PetscOptionsGetIntArray(NULL, prefix, "-dm_plex_box_faces", box->faces, &n, &set));
  PetscCheck(!set || n == box->dim, comm, PETSC_ERR_USER_INPUT,
             "-%sdm_plex_box_faces has %" PetscInt_FMT " numbers; -%sdm_plex_dim asks for %" PetscInt_FMT, prefix, n, prefix, box->dim);
  PetscCall(ReadCorner(comm, prefix, "-dm_plex_box_lower", box->dim, box->lower));
  PetscCall(ReadCorner(comm, prefix, "-dm_plex_box_upper", box->dim, box->upper));
  for (PetscInt d = 0; d < box->dim; d++) {
    PetscCheck(box->faces[d] > 0, comm, PETSC_ERR_USER_INPUT,
               "-%sdm_plex_box_faces: %" PetscInt_FMT " along axis %" PetscInt_FMT " must be positive", prefix, box->faces[d], d + 1);
    PetscCheck(box->upper[d] > box->lower[d], comm, PETSC_ERR_USER_INPUT,
               "-%sdm_plex_box_lower, -%sdm_plex_box_upper: along axis %" PetscInt_FMT " the box ends at %g, not beyond its start at %g",
               prefix, prefix, d + 1, (double)box->upper[d], (double)box->lower[d]);
  }
  PetscCall(PetscOptionsHasName(NULL, prefix, "-dm_plex_simplex", &set));
  /* DMPLEX has no setter for this default: it is put among the options, the same on any number of ranks */
  if (!set && box->dim > 1) {
    PetscCall(PetscSNPrintf(option, sizeof(option), "-%sdm_plex_simplex", prefix));
    PetscCall(PetscOptionsSetValue(NULL, option, "0"));
  }
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-dm_plex_simplex", &box->simplex, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The option, if any, that asks for what PETSc alone does with a box: divide it as a graph, leave it whole, make it periodic, ... */
static PetscErrorCode FindOptionOfGraph(const char prefix[], const char **option)
{
  static const char *const options[] = {"-petscpartitioner_type",   "-dm_distribute",       "-dm_distribute_overlap", "-dm_plex_box_bd",
                                        "-dm_plex_separate_marker", "-dm_plex_interpolate", "-dm_plex_cell",          "-dm_plex_reorder"};
  PetscBool                has       = PETSC_FALSE;

  PetscFunctionBegin;
  *option = NULL;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options) && !has; i++) {
    PetscCall(PetscOptionsHasName(NULL, prefix, options[i], &has));
    if (has) *option = options[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether each rank makes its own brick of the box */
static PetscErrorCode ReadDivision(MPI_Comm comm, const char prefix[], const char name[], MeshBox *box, PetscBool *bricks)
{
  const char *const divisions[] = {"bricks", "graph", "whole"};
  const char       *option;
  PetscInt          division = 0;
  PetscBool         set, balance;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetEList(NULL, prefix, "-mesh_division", divisions, 3, &division, &set));
  PetscCall(FindOptionOfGraph(prefix, &option));
  PetscCheck(!option || !set || division, comm, PETSC_ERR_USER_INPUT, "-%s%s needs -%smesh_division graph", prefix,
             option ? option + 1 : "", prefix);
  *bricks = (PetscBool)(!option && !division);
  PetscCall(MeshBoxMarkContact(comm, prefix, name, box));
  if (*bricks) PetscCall(MeshBricksChoose(box, &balance));
  if (*bricks && !set) *bricks = balance;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fills a file with a box of triangles or tetrahedra, cut all the same way; sides have the numbers that DMPLEX gives to those of its boxes
 */
static PetscErrorCode DivideBox(void *ctx)
{
  static const DMPolytopeType shapes[] = {DM_POLYTOPE_SEGMENT, DM_POLYTOPE_TRIANGLE, DM_POLYTOPE_TETRAHEDRON};
  MeshFile                   *file     = ((Division *)ctx)->file;
  const MeshBox              *box      = ((Division *)ctx)->box;
  const PetscInt              dim = box->dim, all[3] = {0, 1, 2}, begin[3] = {0};
  const Ball                  cuts   = {.dim = dim, .step = 1, .simplex = PETSC_TRUE};
  const BallBlock             block  = {.axis = -1};
  BallGrid                    grid   = {.file = file, .ball = &cuts};
  PetscInt                    end[3] = {1, 1, 1}, nodes[3] = {1, 1, 1}, *stride = grid.stride;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < dim; d++) {
    end[d]   = box->faces[d];
    nodes[d] = end[d] + 1;
  }
  /* the corners of 6 tetrahedra in each cell must be counted in PetscInt */
  PetscCheck((double)nodes[0] * nodes[1] * nodes[2] * 24 < PETSC_INT_MAX, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "a box of simplices of this size is too large");
  stride[0]     = 1;
  stride[1]     = nodes[0];
  stride[2]     = nodes[0] * nodes[1];
  file->n_nodes = stride[2] * nodes[2];
  PetscCall(PetscCalloc1(3 * file->n_nodes, &file->coordinates));
  for (PetscInt node = 0; node < file->n_nodes; node++)
    for (PetscInt d = 0; d < dim; d++) {
      const PetscInt place = node / stride[d] % nodes[d];

      file->coordinates[3 * node + d] = box->lower[d] + (box->upper[d] - box->lower[d]) * place / box->faces[d];
    }
  PetscCall(MeshFileAddRun(file, shapes[dim - 1], PETSC_FALSE, 0, NULL));
  PetscCall(BallAddRange(&grid, &block, dim, all, begin, end));
  for (PetscInt side = 0; side < 2 * dim; side++) {
    PetscInt axes[2] = {0}, from[3] = {0}, to[3], group, n = 0;

    for (PetscInt d = 0; d < dim; d++)
      if (d != side / 2) axes[n++] = d;
    for (PetscInt d = 0; d < 3; d++) to[d] = end[d];
    from[side / 2] = side % 2 ? box->faces[side / 2] : 0;
    to[side / 2]   = from[side / 2] + 1;
    PetscCall(MeshFileAddGroup(file, MESH_SIDE_SET, dim - 1, MeshBoxSideNumber(dim, side), &group));
    /* NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage): boxes of one dimension are made elsewhere */
    PetscCall(MeshFileAddRun(file, shapes[dim - 2], PETSC_FALSE, 1, &group));
    PetscCall(BallAddRange(&grid, &block, dim - 1, axes, from, to));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSimplexBox(MPI_Comm comm, const MeshBox *box, const char prefix[], const char name[], DM *dm)
{
  MeshFile       file;
  Division       division = {&file, box};
  DMLabel        marker;
  char           where[256];
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(MeshFileInitialize(&file, NULL));
  PetscCall(PetscSNPrintf(where, sizeof(where), "Body '%s', -%sdm_plex_box_faces", name, prefix));
  error = MeshOnRank(comm, file.rank, DivideBox, &division, where);
  if (!error) error = MeshBuild(comm, &file, where, dm, NULL);
  PetscCall(MeshFileDestroy(&file));
  PetscCall(error);
  PetscCall(DMCreateLabel(*dm, "marker"));
  PetscCall(DMGetLabel(*dm, "marker", &marker));
  PetscCall(DMPlexMarkBoundaryFaces(*dm, 1, marker));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A box or another of DMPLEX's shapes from options, for these ranks; stage: what there is of the mesh now */
PetscErrorCode MeshCreateBox(MPI_Comm comm, const char prefix[], const char name[], const MeshRanks *ranks, DM *dm, MeshStage *stage)
{
  MeshBox   box;
  PetscBool bricks = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(ReadBox(comm, prefix, &box));
  box.ranks = ranks;
  if (box.is_box && box.dim > 1 && box.simplex) {
    *stage = MESH_ON_ONE_RANK;
    PetscCall(CreateSimplexBox(comm, &box, prefix, name, dm));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (box.is_box) PetscCall(ReadDivision(comm, prefix, name, &box, &bricks));
  *stage = bricks ? MESH_DIVIDED : MESH_TO_BE_MADE;
  if (bricks) {
    PetscCall(MeshCreateBricks(comm, &box, dm));
  } else {
    PetscCall(DMCreate(comm, dm));
    PetscCall(DMSetType(*dm, DMPLEX));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
