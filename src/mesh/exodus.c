/* Exodus II files (.g, .e, .exo, .ex2) by the NetCDF library: blocks, side sets, node sets. Names of variables, element types
   and the numbers of sides are those of Schoof and Yarberry, "EXODUS II: A Finite Element Data Model", SAND92-2137. */
#include "exodusimpl.h"

/* Reads coordinates, from the variable coord, or from coordx, coordy and coordz */
static PetscErrorCode ReadNodes(Exodus *exodus)
{
  const char *const names[] = {"coordx", "coordy", "coordz"};
  MeshFile         *file    = exodus->file;
  const PetscInt    dim     = exodus->dim;
  const PetscInt    n       = file->n_nodes;
  int               variable;
  const PetscBool   together = (PetscBool)!nc_inq_varid(exodus->id, "coord", &variable);

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * n, &file->coordinates));
  PetscCall(PetscMalloc1(together ? n * dim : n, &exodus->reals));
  if (together) {
    PetscCall(ExodusFindVariable(exodus, "coord", n * dim, &variable));
    NetCDFCall(nc_get_var_double(exodus->id, variable, exodus->reals), "variable 'coord'");
  }
  for (PetscInt d = 0; d < dim; d++) {
    if (!together) {
      PetscCall(ExodusFindVariable(exodus, names[d], n, &variable));
      NetCDFCall(nc_get_var_double(exodus->id, variable, exodus->reals), "variable '%s'", names[d]);
    }
    for (PetscInt i = 0; i < n; i++) file->coordinates[3 * i + d] = exodus->reals[together ? d * n + i : i];
  }
  PetscCall(PetscFree(exodus->reals));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The shape of an element type such as HEX8 or HEX. A number at the end of its name must be that of its nodes. */
static PetscErrorCode FindShape(const Exodus *exodus, const char type[], PetscInt nodes, Block *block)
{
  const struct {
    const char    *name;
    DMPolytopeType shape;
    PetscBool      shell;
  } types[] = {
      {"BAR", DM_POLYTOPE_SEGMENT, PETSC_FALSE},           {"BEAM", DM_POLYTOPE_SEGMENT, PETSC_FALSE},
      {"EDGE", DM_POLYTOPE_SEGMENT, PETSC_FALSE},          {"TRUSS", DM_POLYTOPE_SEGMENT, PETSC_FALSE},
      {"TRI", DM_POLYTOPE_TRIANGLE, PETSC_FALSE},          {"TRIANGLE", DM_POLYTOPE_TRIANGLE, PETSC_FALSE},
      {"TRISHELL", DM_POLYTOPE_TRIANGLE, PETSC_TRUE},      {"QUAD", DM_POLYTOPE_QUADRILATERAL, PETSC_FALSE},
      {"SHELL", DM_POLYTOPE_QUADRILATERAL, PETSC_TRUE},    {"TET", DM_POLYTOPE_TETRAHEDRON, PETSC_FALSE},
      {"TETRA", DM_POLYTOPE_TETRAHEDRON, PETSC_FALSE},     {"HEX", DM_POLYTOPE_HEXAHEDRON, PETSC_FALSE},
      {"HEXAHEDRON", DM_POLYTOPE_HEXAHEDRON, PETSC_FALSE},
  };
  char     stem[64];
  PetscInt corners;
  size_t   length;
  long     said;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(stem, type, sizeof(stem)));
  PetscCall(PetscStrlen(stem, &length));
  while (length && ((stem[length - 1] >= '0' && stem[length - 1] <= '9') || stem[length - 1] == ' ')) stem[--length] = 0;
  said         = strtol(type + length, NULL, 10);
  block->shape = DM_POLYTOPE_UNKNOWN;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(types); i++) {
    PetscBool same;

    PetscCall(PetscStrcasecmp(stem, types[i].name, &same));
    if (!same || (said && said != nodes)) continue;
    block->shape = types[i].shape;
    block->shell = types[i].shell;
  }
  if (block->shape == DM_POLYTOPE_QUADRILATERAL && block->shell && nodes == 3) block->shape = DM_POLYTOPE_TRIANGLE;
  block->nodes = nodes;
  corners      = block->shape == DM_POLYTOPE_UNKNOWN ? 0 : DMPolytopeTypeGetNumVertices(block->shape);
  PetscCheck(corners && (nodes == corners || (DMPolytopeTypeGetDim(block->shape) == corners - 1 && nodes == corners * (corners + 1) / 2)),
             PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "block %" PetscInt_FMT " has elements of type '%s' with %" PetscInt_FMT
             " nodes, which are not supported; supported are first-order elements, BAR2, TRI3, QUAD4, TETRA4, HEX8, and TRI6 and TETRA10",
             block->number, type, nodes);
  if (DMPolytopeTypeGetDim(block->shape) == 2 && exodus->dim == 3) block->shell = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadType(const Exodus *exodus, PetscInt i, char type[64])
{
  char   full[64];
  int    variable;
  size_t length = 0;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(type, 64));
  PetscCall(PetscSNPrintf(full, sizeof(full), "connect%" PetscInt_FMT, i + 1));
  PetscCheck(!nc_inq_varid(exodus->id, full, &variable), PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "it has no variable '%s'", full);
  PetscCheck(!nc_inq_attlen(exodus->id, variable, "elem_type", &length) && length < 64, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "variable '%s' has no proper attribute elem_type", full);
  NetCDFCall(nc_get_att_text(exodus->id, variable, "elem_type", type), "attribute elem_type of '%s'", full);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBlock(Exodus *exodus, PetscInt i)
{
  MeshFile  *file  = exodus->file;
  Block     *block = &exodus->blocks[i];
  char       name[MESH_NAME_LENGTH], type[64];
  PetscInt   n_nodes, group;
  PetscBool  wanted;
  const int *connected;

  PetscFunctionBegin;
  block->first      = exodus->n_elements;
  block->first_node = -1;
  PetscCall(ExodusReadNumber(exodus, "eb", i, &block->number));
  PetscCall(ExodusReadName(exodus, "eb", i, name));
  PetscCall(ExodusGetDimensionOf(exodus, "num_el_in_blk", i + 1, &block->n));
  exodus->n_elements += block->n;
  PetscCall(MeshFileAddGroup(file, MESH_BLOCK, exodus->dim, block->number, &group));
  PetscCall(PetscStrncpy(file->groups[group].name, name, MESH_NAME_LENGTH));
  PetscCall(MeshFileWants(file, block->number, name, &wanted));
  if (!block->n || !wanted) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ExodusGetDimensionOf(exodus, "num_nod_per_el", i + 1, &n_nodes));
  PetscCall(ReadType(exodus, i, type));
  PetscCall(FindShape(exodus, type, n_nodes, block));
  PetscCall(ExodusReadInts(exodus, "connect", i + 1, block->n * n_nodes, 0, &connected));
  PetscCall(MeshFileAddRun(file, block->shape, (PetscBool)(n_nodes > DMPolytopeTypeGetNumVertices(block->shape)), 1, &group));
  block->first_node = file->n_element_nodes;
  for (PetscInt e = 0; e < block->n; e++) {
    PetscInt *nodes;

    PetscCall(MeshFileAddElement(file, block->first + e + 1, &nodes));
    for (PetscInt k = 0; k < n_nodes; k++) {
      const int node = connected[e * n_nodes + k];

      PetscCheck(node >= 1 && node <= file->n_nodes, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
                 "element %" PetscInt_FMT " (block %" PetscInt_FMT ") names node %d; the file has nodes 1 to %" PetscInt_FMT,
                 block->first + e + 1, block->number, node, file->n_nodes);
      nodes[k] = node - 1;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Corners, from 1, of a side of a shape, and their number. Of a shell the sides that follow its two faces are meant. */
static PetscInt SideCorners(DMPolytopeType shape, PetscInt side, const int **corners)
{
  static const int bar[2][1] = {{1}, {2}}, tri[3][2] = {{1, 2}, {2, 3}, {3, 1}}, quad[4][2] = {{1, 2}, {2, 3}, {3, 4}, {4, 1}};
  static const int tet[4][3] = {{1, 2, 4}, {2, 3, 4}, {1, 4, 3}, {1, 3, 2}};
  static const int hex[6][4] = {{1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {1, 5, 8, 4}, {1, 4, 3, 2}, {5, 6, 7, 8}};

  *corners = NULL;
  switch (shape) {
  case DM_POLYTOPE_SEGMENT:
    if (side >= 0 && side < 2) *corners = bar[side];
    return 1;
  case DM_POLYTOPE_TRIANGLE:
    if (side >= 0 && side < 3) *corners = tri[side];
    return 2;
  case DM_POLYTOPE_QUADRILATERAL:
    if (side >= 0 && side < 4) *corners = quad[side];
    return 2;
  case DM_POLYTOPE_TETRAHEDRON:
    if (side >= 0 && side < 4) *corners = tet[side];
    return 3;
  default:
    if (side >= 0 && side < 6) *corners = hex[side];
    return 4;
  }
}

static PetscErrorCode ReadSideSet(Exodus *exodus, PetscInt i)
{
  static const DMPolytopeType shapes[] = {DM_POLYTOPE_UNKNOWN, DM_POLYTOPE_POINT, DM_POLYTOPE_SEGMENT, DM_POLYTOPE_TRIANGLE,
                                          DM_POLYTOPE_QUADRILATERAL};
  MeshFile                   *file     = exodus->file;
  PetscInt                    n, number, group, b = 0;
  char                        name[MESH_NAME_LENGTH];
  const int                  *elements, *sides;

  PetscFunctionBegin;
  PetscCall(ExodusReadNumber(exodus, "ss", i, &number));
  PetscCall(ExodusReadName(exodus, "ss", i, name));
  PetscCall(MeshFileAddGroup(file, MESH_SIDE_SET, exodus->dim - 1, number, &group));
  PetscCall(PetscStrncpy(file->groups[group].name, name, MESH_NAME_LENGTH));
  PetscCall(ExodusGetDimensionOf(exodus, "num_side_ss", i + 1, &n));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ExodusReadInts(exodus, "elem_ss", i + 1, n, 0, &elements));
  PetscCall(ExodusReadInts(exodus, "side_ss", i + 1, n, 1, &sides));
  for (PetscInt s = 0; s < n; s++) {
    const int       element = elements[s], side = sides[s];
    const int      *corners;
    const PetscInt *cell;
    PetscInt       *nodes, n_corners;

    PetscCheck(element >= 1 && element <= exodus->n_elements, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "side set %" PetscInt_FMT " names element %d; the file has elements 1 to %" PetscInt_FMT, number, element,
               exodus->n_elements);
    if (element - 1 < exodus->blocks[b].first || element - 1 >= exodus->blocks[b].first + exodus->blocks[b].n)
      for (b = 0; element - 1 >= exodus->blocks[b].first + exodus->blocks[b].n;) b++;
    if (exodus->blocks[b].first_node < 0) continue; /* the element belongs to another body */
    n_corners = SideCorners(exodus->blocks[b].shape, side - (exodus->blocks[b].shell ? 3 : 1), &corners);
    PetscCheck(corners, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "side set %" PetscInt_FMT " names side %d of element %d (%s), which has no such %s", number, side, element,
               DMPolytopeTypes[exodus->blocks[b].shape], exodus->blocks[b].shell ? "edge" : "side");
    PetscCall(MeshFileAddRun(file, shapes[n_corners], PETSC_FALSE, 1, &group));
    PetscCall(MeshFileAddElement(file, element, &nodes));
    cell = file->element_nodes + exodus->blocks[b].first_node + (element - 1 - exodus->blocks[b].first) * exodus->blocks[b].nodes;
    for (PetscInt k = 0; k < n_corners; k++) nodes[k] = cell[corners[k] - 1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNodeSet(Exodus *exodus, PetscInt i)
{
  MeshFile  *file = exodus->file;
  PetscInt   n, number, group;
  char       name[MESH_NAME_LENGTH];
  const int *nodes;

  PetscFunctionBegin;
  PetscCall(ExodusReadNumber(exodus, "ns", i, &number));
  PetscCall(ExodusReadName(exodus, "ns", i, name));
  PetscCall(MeshFileAddGroup(file, MESH_NODE_SET, 0, number, &group));
  PetscCall(PetscStrncpy(file->groups[group].name, name, MESH_NAME_LENGTH));
  PetscCall(ExodusGetDimensionOf(exodus, "num_nod_ns", i + 1, &n));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ExodusReadInts(exodus, "node_ns", i + 1, n, 0, &nodes));
  PetscCall(MeshFileAddRun(file, DM_POLYTOPE_POINT, PETSC_FALSE, 1, &group));
  for (PetscInt k = 0; k < n; k++) {
    PetscInt *node;

    PetscCheck(nodes[k] >= 1 && nodes[k] <= file->n_nodes, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "node set %" PetscInt_FMT " names node %d; the file has nodes 1 to %" PetscInt_FMT, number, nodes[k], file->n_nodes);
    PetscCall(MeshFileAddElement(file, k + 1, &node));
    *node = nodes[k] - 1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadAll(Exodus *exodus)
{
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(ExodusGetDimension(exodus, "num_dim", &exodus->dim));
  PetscCall(ExodusGetDimension(exodus, "num_nodes", &exodus->file->n_nodes));
  PetscCall(ExodusGetDimension(exodus, "num_el_blk", &exodus->n_blocks));
  PetscCheck(exodus->dim >= 1 && exodus->dim <= 3 && exodus->file->n_nodes && exodus->n_blocks, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "it is no Exodus II file with a mesh: num_dim is %" PetscInt_FMT ", num_nodes %" PetscInt_FMT ", num_el_blk %" PetscInt_FMT,
             exodus->dim, exodus->file->n_nodes, exodus->n_blocks);
  PetscCall(ReadNodes(exodus));
  PetscCall(PetscCalloc1(exodus->n_blocks, &exodus->blocks));
  for (PetscInt i = 0; i < exodus->n_blocks; i++) PetscCall(ReadBlock(exodus, i));
  PetscCall(ExodusGetDimension(exodus, "num_elem", &n));
  PetscCheck(n == exodus->n_elements, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "num_elem is %" PetscInt_FMT ", but its blocks have %" PetscInt_FMT " elements", n, exodus->n_elements);
  PetscCall(ExodusGetDimension(exodus, "num_side_sets", &n));
  for (PetscInt i = 0; i < n; i++) PetscCall(ReadSideSet(exodus, i));
  PetscCall(ExodusGetDimension(exodus, "num_node_sets", &n));
  for (PetscInt i = 0; i < n; i++) PetscCall(ReadNodeSet(exodus, i));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MeshReadExodus(MeshFile *file)
{
  Exodus         exodus = {.file = file};
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(MeshCheckNetCDFSize(file->path));
  NetCDFCall(nc_open(file->path, NC_NOWRITE, &exodus.id),
             "it cannot be read as the NetCDF file that an Exodus II file is, or is cut short");
  error = ReadAll(&exodus);
  (void)nc_close(exodus.id);
  PetscCall(PetscFree(exodus.blocks));
  PetscCall(PetscFree(exodus.values[0]));
  PetscCall(PetscFree(exodus.values[1]));
  PetscCall(PetscFree(exodus.reals));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}
