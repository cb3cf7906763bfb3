/* What the tests of meshes share: what a mesh is like, and small mesh files. */
#pragma once
#include "support.h"
#include <impakt/private/mesh.h>
#include <netcdf.h>
#include <petscsf.h>

static inline PetscMPIInt rank_of_world(void)
{
  PetscMPIInt rank;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

static inline PetscMPIInt size_of_world(void)
{
  PetscMPIInt size;

  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  return size;
}

static inline PetscReal sum_of_ranks(PetscReal mine)
{
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  return mine;
}

/* Cells of all ranks; each is on one */
static inline PetscInt count_cells(DM dm)
{
  PetscInt start, end;

  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  return (PetscInt)sum_of_ranks((PetscReal)(end - start));
}

/* Vertices of all ranks, shared ones once */
static inline PetscInt count_vertices(DM dm)
{
  PetscSF         sf;
  PetscInt        start, end, n_leaves, n;
  const PetscInt *leaf;

  ok(DMPlexGetDepthStratum(dm, 0, &start, &end));
  ok(DMGetPointSF(dm, &sf));
  ok(PetscSFGetGraph(sf, NULL, &n_leaves, &leaf, NULL));
  n = end - start;
  for (PetscInt i = 0; i < n_leaves; i++)
    if (leaf[i] >= start && leaf[i] < end) n--;
  return (PetscInt)sum_of_ranks((PetscReal)n);
}

/* Volume of all cells, each of which must have a positive Jacobian in its middle */
static inline PetscReal volume_of(DM dm)
{
  PetscInt  start, end;
  PetscReal sum = 0;

  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  for (PetscInt c = start; c < end; c++) {
    PetscReal volume, origin[3], J[9], inverse[9], determinant;

    ok(DMPlexComputeCellGeometryFVM(dm, c, &volume, NULL, NULL));
    ok(DMPlexComputeCellGeometryFEM(dm, c, NULL, origin, J, inverse, &determinant));
    assert_true(determinant > 0);
    sum += volume;
  }
  return sum_of_ranks(sum);
}

typedef struct {
  PetscInt  n;         /* faces of all ranks */
  PetscReal area;      /* theirs */
  PetscReal centre[3]; /* mean of their centres */
} SurfaceFacts;

static inline SurfaceFacts surface_facts(DM dm, const char name[])
{
  SurfaceFacts facts = {0};
  PetscInt     n, *faces, dim;

  ok(DMGetCoordinateDim(dm, &dim));
  ok(MeshGetSurface(dm, name, &n, &faces));
  for (PetscInt f = 0; f < n; f++) {
    PetscReal area = 1, centre[3] = {0};

    if (dim > 1) ok(DMPlexComputeCellGeometryFVM(dm, faces[f], &area, centre, NULL));
    facts.area += area;
    for (PetscInt d = 0; d < dim; d++) facts.centre[d] += centre[d];
    if (f) assert_true(faces[f] > faces[f - 1]);
  }
  ok(PetscFree(faces));
  facts.n    = (PetscInt)sum_of_ranks((PetscReal)n);
  facts.area = sum_of_ranks(facts.area);
  for (PetscInt d = 0; d < 3; d++) facts.centre[d] = sum_of_ranks(facts.centre[d]) / facts.n;
  return facts;
}

/* The position of a vertex */
static inline void position_of(DM dm, PetscInt vertex, PetscReal x[3])
{
  PetscSection       section;
  Vec                coordinates;
  const PetscScalar *values;
  PetscInt           offset, dim;

  ok(DMGetCoordinateDim(dm, &dim));
  ok(DMGetCoordinateSection(dm, &section));
  ok(DMGetCoordinatesLocal(dm, &coordinates));
  ok(PetscSectionGetOffset(section, vertex, &offset));
  ok(VecGetArrayRead(coordinates, &values));
  for (PetscInt d = 0; d < 3; d++) x[d] = d < dim ? PetscRealPart(values[offset + d]) : 0;
  ok(VecRestoreArrayRead(coordinates, &values));
}

/* A node set must be the vertices of this rank, ghosts or not, with coordinate `axis` at `place`; returns how many */
static inline PetscInt check_nodes_at(DM dm, const char name[], PetscInt axis, PetscReal place)
{
  PetscInt n, *vertices, start, end, found = 0;

  ok(MeshGetNodeSet(dm, name, &n, &vertices));
  ok(DMPlexGetDepthStratum(dm, 0, &start, &end));
  for (PetscInt v = start; v < end; v++) {
    PetscReal x[3];

    position_of(dm, v, x);
    if (PetscAbsReal(x[axis] - place) > 1e-12) continue;
    assert_true(found < n);
    assert_int_equal(vertices[found++], v);
  }
  assert_int_equal(found, n);
  ok(PetscFree(vertices));
  return n;
}

/* Makes a mesh from options (printf-like, without the prefix "a_"), all of which must be read */
static inline DM create_mesh(const char format[], ...)
{
  PetscOptions options;
  char         text[1024];
  va_list      args;
  DM           dm;

  va_start(args, format);
  vsnprintf(text, sizeof(text), format, args);
  va_end(args);
  options = options_begin("-prefix_push a_ %s -prefix_pop", text);
  ok(MeshCreate(PETSC_COMM_WORLD, "a_", "box", &dm));
  options_end(options);
  return dm;
}

/* Making a mesh with these options ends with that error and a message with all the words */
#define mesh_refused(code, words, ...)                                                                                                     \
  do {                                                                                                                                     \
    char         text_[1024];                                                                                                              \
    DM           dm_;                                                                                                                      \
    PetscOptions options_;                                                                                                                 \
    (void)snprintf(text_, sizeof(text_), __VA_ARGS__);                                                                                     \
    options_ = options_begin("-prefix_push a_ %s -prefix_pop", text_);                                                                     \
    refused(code, words, MeshCreate(PETSC_COMM_WORLD, "a_", "box", &dm_));                                                                 \
    ok(DMDestroy(&dm_));                                                                                                                   \
    options_drop(options_);                                                                                                                \
  } while (0)

/* A file for all ranks */
static inline void write_file(const char path[], const char text[])
{
  if (!rank_of_world()) {
    FILE *stream = fopen(path, "w");

    assert_non_null(stream);
    assert_int_equal(fputs(text, stream) < 0, 0);
    assert_int_equal(fclose(stream), 0);
  }
  MPI_Barrier(PETSC_COMM_WORLD);
}

/* A row of n hexahedra or tetrahedra (six to a cube), or of quadrilaterals or triangles (two to a square) along x: cubes of
   size 1 that begin at x = 0, with nodes 1, 2, ... of each cross-section one after the other */
typedef struct {
  PetscInt dim, n, corners, per_cell, section; /* corners of an element; elements to a cube; nodes of a cross-section */
  PetscInt elements, nodes;
} Row;

static inline Row row_of(PetscInt dim, PetscInt n, PetscBool simplex)
{
  Row row = {.dim = dim, .n = n};

  row.corners  = simplex ? dim + 1 : dim == 2 ? 4 : 8;
  row.per_cell = !simplex ? 1 : dim == 2 ? 2 : 6;
  row.section  = dim == 2 ? 2 : 4;
  row.elements = n * row.per_cell;
  row.nodes    = (n + 1) * row.section;
  return row;
}

static inline void row_position(const Row *row, PetscInt node, double x[3])
{
  static const double section[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

  x[0] = (double)((node - 1) / row->section);
  x[1] = section[(node - 1) % row->section][0];
  x[2] = section[(node - 1) % row->section][1];
}

/* Right-handed; tetrahedra as in Freudenthal's division, about the diagonal from the first corner to the opposite one */
static inline void row_element(const Row *row, PetscInt element, PetscInt nodes[])
{
  static const int tets[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  static const int tris[2][3] = {{0, 1, 2}, {0, 2, 3}};
  const PetscInt   cell = element / row->per_cell, first = cell * row->section + 1, part = element % row->per_cell;
  PetscInt         corners[8];

  if (row->dim == 2) {
    const PetscInt quad[4] = {first, first + 2, first + 3, first + 1};

    for (PetscInt k = 0; k < 4; k++) corners[k] = quad[k];
  } else {
    /* x is the third axis of the element: base at the cross-section, seen from beyond */
    for (PetscInt k = 0; k < 8; k++) corners[k] = first + k;
  }
  for (PetscInt k = 0; k < row->corners; k++)
    nodes[k] = row->per_cell == 1 ? corners[k] : corners[row->dim == 2 ? tris[part][k] : tets[part][k]];
}
