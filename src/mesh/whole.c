/* Meshes that lie whole on one rank: of which size and where they will be, as options tell before there is a mesh. */
#include "meshimpl.h"

/* Cells of a section of an O-grid, a disc or that of a rod: the central block, and the four around it */
static PetscInt SectionCells(PetscInt divisions, PetscInt layers)
{
  return divisions * (divisions + 4 * layers);
}

/* Divisions and layers of an O-grid; nothing is checked, which is for those who make the mesh */
static PetscErrorCode GetGrid(const char prefix[], const char shape[], PetscInt *divisions, PetscInt *layers)
{
  char option[64];

  PetscFunctionBegin;
  *divisions = 4;
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%s_divisions", shape));
  PetscCall(PetscOptionsGetInt(NULL, prefix, option, divisions, NULL));
  *layers = (*divisions + 1) / 2;
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%s_layers", shape));
  PetscCall(PetscOptionsGetInt(NULL, prefix, option, layers, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode EstimateBox(const char prefix[], PetscInt dim, PetscInt *cells, PetscReal centre[3])
{
  PetscInt  faces[3] = {1, 1, 1}, n = 3;
  PetscReal lower[3] = {0, 0, 0}, upper[3] = {1, 1, 1};

  PetscFunctionBegin;
  for (PetscInt d = 0; d < dim; d++) faces[d] = dim == 1 ? 1 : 4 - dim;
  PetscCall(PetscOptionsGetIntArray(NULL, prefix, "-dm_plex_box_faces", faces, &n, NULL));
  n = 3;
  PetscCall(PetscOptionsGetRealArray(NULL, prefix, "-dm_plex_box_lower", lower, &n, NULL));
  n = 3;
  PetscCall(PetscOptionsGetRealArray(NULL, prefix, "-dm_plex_box_upper", upper, &n, NULL));
  *cells = 1;
  for (PetscInt d = 0; d < dim; d++) {
    *cells    = faces[d] > 0 && faces[d] < PETSC_INT_MAX / *cells ? *cells * faces[d] : PETSC_INT_MAX;
    centre[d] = 0.5 * (lower[d] + upper[d]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many cells a mesh will have, and where it will be, by its options, before it is made. `centre`: about where its middle is, three
   numbers [m]. To choose the rank on which a mesh is to lie whole: rotations and parts of balls do not count, and nothing is an error */
PetscErrorCode MeshEstimate(const char prefix[], PetscInt *cells, PetscReal centre[3])
{
  PetscReal shift[3] = {0, 0, 0}, scale = 1;
  PetscInt  dim = 2, divisions, layers, n = 3;
  PetscBool file, ball, rod, simplex      = PETSC_FALSE;

  PetscFunctionBegin;
  PetscAssertPointer(cells, 2);
  PetscAssertPointer(centre, 3);
  *cells = 0;
  for (PetscInt d = 0; d < 3; d++) centre[d] = 0;
  PetscCall(PetscOptionsHasName(NULL, prefix, "-dm_plex_filename", &file));
  PetscCall(MeshHasShape(prefix, "ball", &ball));
  PetscCall(MeshHasShape(prefix, "rod", &rod));
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-dm_plex_dim", &dim, NULL));
  dim = PetscMin(PetscMax(dim, 1), 3);
  if (ball) {
    PetscCall(GetGrid(prefix, "ball", &divisions, &layers));
    *cells = SectionCells(divisions, layers);
    if (dim == 3) *cells = divisions * divisions * (divisions + 6 * layers);
    PetscCall(PetscOptionsGetRealArray(NULL, prefix, "-ball_centre", centre, &n, NULL));
  } else if (rod) {
    PetscInt elements = 10;

    dim = 3;
    PetscCall(GetGrid(prefix, "rod", &divisions, &layers));
    PetscCall(PetscOptionsGetInt(NULL, prefix, "-rod_elements", &elements, NULL));
    *cells = elements * SectionCells(divisions, layers);
  } else if (!file) PetscCall(EstimateBox(prefix, dim, cells, centre));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-dm_plex_simplex", &simplex, NULL));
  if (simplex && dim > 1 && *cells < PETSC_INT_MAX / 6) *cells *= dim == 2 ? 2 : 6;
  n = 3;
  PetscCall(PetscOptionsGetReal(NULL, prefix, "-scale", &scale, NULL));
  PetscCall(PetscOptionsGetRealArray(NULL, prefix, "-translate", shift, &n, NULL));
  for (PetscInt d = 0; d < 3; d++) centre[d] = scale * centre[d] + shift[d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether options leave it open how a mesh is divided among ranks, or ask for it to be whole. `may`: no option asks for a division, or says
   which ranks have the mesh; `asks`: -<body>_mesh_division whole, and no option says which rank has it */
PetscErrorCode MeshMayBeWhole(MPI_Comm comm, const char prefix[], PetscBool *may, PetscBool *asks)
{
  static const char *const options[]   = {"-petscpartitioner_type", "-dm_distribute", "-dm_distribute_overlap", "-mesh_contact_surfaces",
                                          "-mesh_contact_cost"};
  const char *const        divisions[] = {"bricks", "graph", "whole"};
  PetscInt                 division    = 0;
  PetscBool                has         = PETSC_FALSE, set, file, ball, rod, placed;

  PetscFunctionBegin;
  PetscAssertPointer(may, 3);
  PetscAssertPointer(asks, 4);
  PetscCall(PetscOptionsHasName(NULL, prefix, "-dm_plex_filename", &file));
  PetscCall(MeshHasShape(prefix, "ball", &ball));
  PetscCall(MeshHasShape(prefix, "rod", &rod));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-petscpartitioner_type", &has));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options) && !has; i++) PetscCall(PetscOptionsHasName(NULL, prefix, options[i], &has));
  PetscCall(PetscOptionsGetEList(NULL, prefix, "-mesh_division", divisions, 3, &division, &set));
  PetscCheck(!set || division || !(file || ball || rod), comm, PETSC_ERR_USER_INPUT,
             "-%smesh_division bricks: boxes alone are made of bricks; choose graph or whole, or leave the option out", prefix);
  PetscCall(PetscOptionsHasName(NULL, prefix, "-ranks", &placed));
  *asks = (PetscBool)(set && division == 2);
  PetscCheck(!*asks || !has, comm, PETSC_ERR_USER_INPUT,
             "-%smesh_division whole: another option divides the mesh (petscpartitioner_type, dm_distribute, mesh_contact_surfaces, ...); "
             "leave one of them out",
             prefix);
  if (placed) *asks = PETSC_FALSE;
  *may = (PetscBool) !(has || set || placed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The labels of a mesh that was made on one rank, on the others too, which have nothing of it: groups have the same names on all ranks */
PetscErrorCode MeshTellLabels(PetscMPIInt rank, DM dm)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)dm);
  PetscMPIInt mine;
  PetscInt    n;
  char (*names)[MESH_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &mine));
  PetscCall(DMGetNumLabels(dm, &n));
  PetscCallMPI(MPI_Bcast(&n, 1, MPIU_INT, rank, comm));
  PetscCall(PetscMalloc1(n, &names));
  for (PetscInt l = 0; l < n && mine == rank; l++) {
    const char *name;

    PetscCall(DMGetLabelName(dm, l, &name));
    PetscCall(PetscStrncpy(names[l], name, sizeof(names[l])));
  }
  PetscCallMPI(MPI_Bcast(names, (PetscMPIInt)(n * (PetscInt)sizeof(names[0])), MPI_CHAR, rank, comm));
  for (PetscInt l = 0; l < n; l++) PetscCall(DMCreateLabel(dm, names[l])); /* does nothing where there is one */
  PetscCall(PetscFree(names));
  PetscFunctionReturn(PETSC_SUCCESS);
}
