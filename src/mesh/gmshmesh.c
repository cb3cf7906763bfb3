/* Nodes and elements of Gmsh's files. */
#include "gmshimpl.h"

static PetscErrorCode AllocateNodes(Gmsh *gmsh, PetscInt n)
{
  PetscFunctionBegin;
  GmshCheck(gmsh, !gmsh->file->coordinates, "the section is there twice");
  PetscCall(PetscMalloc1(3 * n, &gmsh->file->coordinates));
  PetscCall(PetscMalloc1(n, &gmsh->file->node_numbers));
  gmsh->file->n_nodes = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GmshReadNodes22(Gmsh *gmsh)
{
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(GmshReadCount(gmsh, "nodes", gmsh->binary ? 28 : 8, &n));
  PetscCall(AllocateNodes(gmsh, n));
  for (PetscInt i = 0; i < n; i++) {
    PetscInt64 number;

    PetscCall(GmshReadInts(gmsh, 1, &number));
    PetscCall(GmshCheckNumber(gmsh, number, &gmsh->file->node_numbers[i]));
    PetscCall(GmshReadReals(gmsh, 3, gmsh->file->coordinates + 3 * i));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads nodes in blocks: first their numbers, then their coordinates, which coordinates on the entity may follow */
PetscErrorCode GmshReadNodes41(Gmsh *gmsh)
{
  PetscInt64 header[4], entity[3], count;
  PetscInt   n_blocks, n, done = 0;

  PetscFunctionBegin;
  PetscCall(GmshReadWords(gmsh, 4, header));
  PetscCall(GmshCheckCount(gmsh, "blocks of nodes", header[0], 8, &n_blocks));
  PetscCall(GmshCheckCount(gmsh, "nodes", header[1], gmsh->binary ? 28 : 8, &n));
  PetscCall(AllocateNodes(gmsh, n));
  for (PetscInt b = 0; b < n_blocks; b++) {
    PetscInt in_block;

    PetscCall(GmshReadInts(gmsh, 3, entity));
    PetscCall(GmshReadWords(gmsh, 1, &count));
    GmshCheck(gmsh, entity[0] >= 0 && entity[0] <= 3, "nodes of an entity of dimension %" PetscInt64_FMT, entity[0]);
    GmshCheck(gmsh, count >= 0 && count <= n - done,
              "a block has %" PetscInt64_FMT " nodes, where %" PetscInt_FMT " are left of the %" PetscInt_FMT " that were announced", count,
              n - done, n);
    in_block = (PetscInt)count;
    for (PetscInt i = 0; i < in_block; i++) {
      PetscInt64 number;

      PetscCall(GmshReadWords(gmsh, 1, &number));
      PetscCall(GmshCheckNumber(gmsh, number, &gmsh->file->node_numbers[done + i]));
    }
    for (PetscInt i = 0; i < in_block; i++) {
      double parameters[3];

      PetscCall(GmshReadReals(gmsh, 3, gmsh->file->coordinates + 3 * (done + i)));
      if (entity[2]) PetscCall(GmshReadReals(gmsh, (PetscInt)entity[0], parameters));
    }
    done += in_block;
  }
  GmshCheck(gmsh, done == n, "%" PetscInt_FMT " nodes were announced, %" PetscInt_FMT " are there", n, done);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Second-order elements have a node in the middle of each edge */
static PetscErrorCode FindShape(Gmsh *gmsh, PetscInt64 type, PetscInt64 element, DMPolytopeType *shape, PetscBool *second_order)
{
  static const struct {
    PetscInt64     type;
    DMPolytopeType shape;
    PetscBool      second_order;
  } types[] = {
      {1, DM_POLYTOPE_SEGMENT, PETSC_FALSE},     {8, DM_POLYTOPE_SEGMENT, PETSC_TRUE},        {2, DM_POLYTOPE_TRIANGLE, PETSC_FALSE},
      {9, DM_POLYTOPE_TRIANGLE, PETSC_TRUE},     {3, DM_POLYTOPE_QUADRILATERAL, PETSC_FALSE}, {4, DM_POLYTOPE_TETRAHEDRON, PETSC_FALSE},
      {11, DM_POLYTOPE_TETRAHEDRON, PETSC_TRUE}, {5, DM_POLYTOPE_HEXAHEDRON, PETSC_FALSE},    {15, DM_POLYTOPE_POINT, PETSC_FALSE}};

  PetscFunctionBegin;
  *shape        = DM_POLYTOPE_UNKNOWN;
  *second_order = PETSC_FALSE;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(types); i++) {
    if (types[i].type != type) continue;
    *shape        = types[i].shape;
    *second_order = types[i].second_order;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(type != 6 && type != 7, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "element %" PetscInt64_FMT " is a %s (Gmsh's type %" PetscInt64_FMT
             "), which is not supported; supported: lines, triangles, quadrilaterals, tetrahedra, hexahedra, one shape in a body",
             element, type == 6 ? "prism" : "pyramid", type);
  GmshCheck(gmsh, type > 0 && type <= 140, "element %" PetscInt64_FMT " has type %" PetscInt64_FMT ", which Gmsh does not have", element,
            type);
  SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
          "element %" PetscInt64_FMT " has Gmsh's type %" PetscInt64_FMT
          ", which is not supported; supported are first-order elements: lines, triangles, quadrilaterals, tetrahedra, hexahedra (gmsh "
          "-order 1), and triangles and tetrahedra of second order (gmsh -order 2)",
          element, type);
}

static PetscInt CountNodes(DMPolytopeType shape, PetscBool second_order)
{
  const PetscInt corners = DMPolytopeTypeGetNumVertices(shape);

  return second_order ? corners * (corners + 1) / 2 : corners;
}

/* Adds an element, whose nodes are given by their numbers in the file */
static PetscErrorCode AddElement(Gmsh *gmsh, PetscInt64 number, PetscInt n, const PetscInt64 numbers[])
{
  PetscInt element, *nodes, last;

  PetscFunctionBegin;
  PetscCall(GmshCheckNumber(gmsh, number, &element));
  PetscCall(MeshFileAddElement(gmsh->file, element, &nodes));
  for (PetscInt k = 0; k < n; k++) {
    nodes[k] = -1;
    if (numbers[k] >= 0 && numbers[k] < PETSC_INT_MAX) PetscCall(MeshFileFindNode(gmsh->file, (PetscInt)numbers[k], &nodes[k]));
    GmshCheck(gmsh, nodes[k] >= 0, "element %" PetscInt_FMT " names node %" PetscInt64_FMT ", which is not in the file", element,
              numbers[k]);
  }
  if (n == 10) { /* Gmsh has the middle of edge 23 before that of edge 13 */
    last     = nodes[9];
    nodes[9] = nodes[8];
    nodes[8] = last;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads elements: one by one in ASCII files, in blocks of type and number of tags in binary ones. First tag: the physical group or 0. */
PetscErrorCode GmshReadElements22(Gmsh *gmsh)
{
  PetscInt n, done = 0;

  PetscFunctionBegin;
  PetscCall(GmshReadCount(gmsh, "elements", gmsh->binary ? 8 : 6, &n));
  while (done < n) {
    PetscInt64     header[3], count = 1, number = 0, values[10], tag = 0;
    DMPolytopeType shape;
    PetscBool      second_order;

    if (gmsh->binary) {
      PetscCall(GmshReadInts(gmsh, 3, header));
      count = header[1];
    } else {
      PetscCall(GmshReadInts(gmsh, 1, &number));
      PetscCall(GmshReadInts(gmsh, 1, header));
      PetscCall(GmshReadInts(gmsh, 1, header + 2));
    }
    PetscCall(FindShape(gmsh, header[0], gmsh->binary ? done + 1 : number, &shape, &second_order));
    GmshCheck(gmsh, count > 0 && count <= n - done,
              "a block has %" PetscInt64_FMT " elements, where %" PetscInt_FMT " are left of the %" PetscInt_FMT " that were announced",
              count, n - done, n);
    GmshCheck(gmsh, header[2] >= 0 && header[2] < 1000, "an element has %" PetscInt64_FMT " tags", header[2]);
    for (PetscInt i = 0; i < count; i++) {
      const PetscInt nodes = CountNodes(shape, second_order);
      PetscInt       group = 0;

      if (gmsh->binary) PetscCall(GmshReadInts(gmsh, 1, &number));
      for (PetscInt t = 0; t < header[2]; t++) {
        PetscInt64 value;

        PetscCall(GmshReadInts(gmsh, 1, &value));
        if (!t) tag = value < 0 ? -value : value;
      }
      PetscCall(GmshReadInts(gmsh, nodes, values));
      if (tag) {
        PetscCall(GmshCheckNumber(gmsh, tag, &group));
        PetscCall(MeshFileAddGroup(gmsh->file, MESH_UNDECIDED, DMPolytopeTypeGetDim(shape), group, &group));
      }
      PetscCall(MeshFileAddRun(gmsh->file, shape, second_order, tag ? 1 : 0, &group));
      PetscCall(AddElement(gmsh, number, nodes, values));
    }
    done += (PetscInt)count;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads elements in blocks, each of one entity */
PetscErrorCode GmshReadElements41(Gmsh *gmsh)
{
  PetscInt64 header[4], entity[3], count, values[11];
  PetscInt   n_blocks, n, done = 0;

  PetscFunctionBegin;
  PetscCall(GmshReadWords(gmsh, 4, header));
  PetscCall(GmshCheckCount(gmsh, "blocks of elements", header[0], 8, &n_blocks));
  PetscCall(GmshCheckCount(gmsh, "elements", header[1], gmsh->binary ? 8 : 4, &n));
  for (PetscInt b = 0; b < n_blocks; b++) {
    DMPolytopeType shape;
    PetscBool      second_order;
    PetscInt       nodes, e = 0;

    PetscCall(GmshReadInts(gmsh, 3, entity));
    PetscCall(GmshReadWords(gmsh, 1, &count));
    GmshCheck(gmsh, count >= 0 && count <= n - done,
              "a block has %" PetscInt64_FMT " elements, where %" PetscInt_FMT " are left of the %" PetscInt_FMT " that were announced",
              count, n - done, n);
    PetscCall(FindShape(gmsh, entity[2], done + 1, &shape, &second_order));
    nodes = CountNodes(shape, second_order);
    GmshCheck(gmsh, entity[0] == DMPolytopeTypeGetDim(shape),
              "elements of type %" PetscInt64_FMT " on an entity of dimension %" PetscInt64_FMT, entity[2], entity[0]);
    while (e < gmsh->n_entities && (gmsh->entities[e][0] != entity[0] || gmsh->entities[e][1] != entity[1])) e++;
    GmshCheck(gmsh, e < gmsh->n_entities || !gmsh->entities,
              "elements of an entity %" PetscInt64_FMT " of dimension %" PetscInt64_FMT ", which is not in $Entities", entity[1],
              entity[0]);
    if (gmsh->entities)
      PetscCall(MeshFileAddRun(gmsh->file, shape, second_order, gmsh->entities[e][3], gmsh->groups + gmsh->entities[e][2]));
    else PetscCall(MeshFileAddRun(gmsh->file, shape, second_order, 0, NULL));
    for (PetscInt i = 0; i < count; i++) {
      PetscCall(GmshReadWords(gmsh, nodes + 1, values));
      PetscCall(AddElement(gmsh, values[0], nodes, values + 1));
    }
    done += (PetscInt)count;
  }
  GmshCheck(gmsh, done == n, "%" PetscInt_FMT " elements were announced, %" PetscInt_FMT " are there", n, done);
  PetscFunctionReturn(PETSC_SUCCESS);
}
