/* ranks: 1 3 */
/* Gmsh and Exodus II files, read and refused. Other containers and binary files: test_mesh_files.py. */
#include "meshes.h"

#define N_CUBES 6

/* A growing text */
typedef struct {
  size_t length;
  char   text[1 << 16];
} Text;

static void Add(Text *text, const char format[], ...)
{
  va_list args;

  va_start(args, format);
  text->length += (size_t)vsnprintf(text->text + text->length, sizeof(text->text) - text->length, format, args);
  va_end(args);
  assert_true(text->length < sizeof(text->text));
}

/* Nodes of the end of a row, in an order that goes round */
static void AddEnd(Text *text, const Row *row, PetscInt node)
{
  if (row->dim == 2) Add(text, " %d %d\n", (int)node, (int)node + 1);
  else Add(text, " %d %d %d %d\n", (int)node, (int)node + 1, (int)node + 2, (int)node + 3);
}

/* Gmsh's types of elements and of the ends of a row */
static int TypeOf(const Row *row)
{
  if (row->dim == 2) return row->corners == 3 ? 2 : 3;
  return row->corners == 4 ? 4 : 5;
}

/* Groups: "left" (7) and "right" (8) at the ends, "first" (1) for the elements of the first half, "second" (2) for the others.
   Tetrahedra: their ends are two triangles each, cut from the first corner to the third. Node numbers are 10, 20, 30 ... in
   version 4.1, where there is also a node that no element has. */
static void AddNames(Text *text, PetscInt dim)
{
  Add(text, "$PhysicalNames\n4\n%d 7 \"left\"\n%d 8 \"right\"\n%d 1 \"first\"\n%d 2 \"second\"\n$EndPhysicalNames\n", (int)dim - 1,
      (int)dim - 1, (int)dim, (int)dim);
}

static PetscInt EndElements(const Row *row)
{
  return row->dim == 3 && row->corners == 4 ? 2 : 1;
}

static void AddEndElements(Text *text, const Row *row, PetscInt end, PetscInt scale, const char before[])
{
  const PetscInt first = end ? row->n * row->section + 1 : 1;

  if (EndElements(row) == 2) {
    const int triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};

    for (PetscInt t = 0; t < 2; t++) {
      Add(text, "%d%s", (int)(100 + 10 * end + t), before);
      for (PetscInt k = 0; k < 3; k++) Add(text, " %d", (int)(scale * (first + triangles[t][k])));
      Add(text, "\n");
    }
  } else if (scale == 1) {
    Add(text, "%d%s", (int)(100 + 10 * end), before);
    AddEnd(text, row, first);
  } else {
    Add(text, "%d", (int)(100 + 10 * end));
    for (PetscInt k = 0; k < row->section; k++) Add(text, " %d", (int)(scale * (first + k)));
    Add(text, "\n");
  }
}

static void WriteGmsh22(const char path[], const Row *row)
{
  Text      text = {0};
  char      tags[32];
  const int end_type = row->dim == 2 ? 1 : EndElements(row) == 2 ? 2 : 3;

  Add(&text, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
  AddNames(&text, row->dim);
  Add(&text, "$Nodes\n%d\n", (int)row->nodes);
  for (PetscInt i = 1; i <= row->nodes; i++) {
    double x[3];

    row_position(row, i, x);
    Add(&text, "%d %.17g %.17g %.17g\n", (int)i, x[0], x[1], row->dim == 2 ? 0 : x[2]);
  }
  Add(&text, "$EndNodes\n$Elements\n%d\n", (int)(row->elements + 2 * EndElements(row)));
  for (PetscInt end = 0; end < 2; end++) {
    (void)snprintf(tags, sizeof(tags), " %d 2 %d 1", end_type, end ? 8 : 7);
    AddEndElements(&text, row, end, 1, tags);
  }
  for (PetscInt e = 0; e < row->elements; e++) {
    PetscInt nodes[8];

    row_element(row, e, nodes);
    Add(&text, "%d %d 2 %d 1", (int)e + 1, TypeOf(row), 2 * e < row->elements ? 1 : 2);
    for (PetscInt k = 0; k < row->corners; k++) Add(&text, " %d", (int)nodes[k]);
    Add(&text, "\n");
  }
  Add(&text, "$EndElements\n");
  write_file(path, text.text);
}

static void WriteGmsh41(const char path[], const Row *row)
{
  Text           text     = {0};
  const int      end_type = row->dim == 2 ? 1 : EndElements(row) == 2 ? 2 : 3, dim = (int)row->dim;
  const PetscInt half = (row->elements + 1) / 2;

  Add(&text, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
  AddNames(&text, row->dim);
  /* two entities of each dimension that has groups; the second end is turned round */
  Add(&text, "$Entities\n0 %d %d %d\n", dim == 2 ? 2 : 0, 2, dim == 2 ? 0 : 2);
  Add(&text, "1 0 0 0 0 1 1 1 7 0\n2 %d 0 0 %d 1 1 1 -8 0\n", N_CUBES, N_CUBES);
  Add(&text, "1 0 0 0 2 1 1 1 1 2 1 -2\n2 2 0 0 4 1 1 1 2 0\n$EndEntities\n");
  Add(&text, "$Nodes\n2 %d 10 %d\n%d 1 0 %d\n", (int)row->nodes + 1, 10 * (int)row->nodes + 10, dim, (int)row->nodes);
  for (PetscInt i = 1; i <= row->nodes; i++) Add(&text, "%d\n", 10 * (int)i);
  for (PetscInt i = 1; i <= row->nodes; i++) {
    double x[3];

    row_position(row, i, x);
    Add(&text, "%.17g %.17g %.17g\n", x[0], x[1], row->dim == 2 ? 0 : x[2]);
  }
  Add(&text, "%d 2 0 1\n%d\n-5 3 3\n$EndNodes\n", dim, 10 * (int)row->nodes + 10);
  Add(&text, "$Elements\n4 %d 1 200\n", (int)(row->elements + 2 * EndElements(row)));
  for (PetscInt end = 0; end < 2; end++) {
    Add(&text, "%d %d %d %d\n", dim - 1, (int)end + 1, end_type, (int)EndElements(row));
    AddEndElements(&text, row, end, 10, "");
  }
  for (PetscInt e = 0; e < row->elements; e++) {
    PetscInt nodes[8];

    if (!e || e == half) Add(&text, "%d %d %d %d\n", dim, e ? 2 : 1, TypeOf(row), (int)(e ? row->elements - half : half));
    row_element(row, e, nodes);
    Add(&text, "%d", (int)e + 1);
    for (PetscInt k = 0; k < row->corners; k++) Add(&text, " %d", 10 * (int)nodes[k]);
    Add(&text, "\n");
  }
  Add(&text, "$EndElements\n$NodeData\n1\n\"nothing of ours\"\n$EndNodeData\n");
  write_file(path, text.text);
}

/* The row as it was written: volume, groups by name and number, nodes of an end */
static void CheckRow(DM dm, const Row *row, PetscInt per_end)
{
  const char *const left[] = {"left", "7", "xmin"}, *const right[] = {"right", "8", "xmax"};
  DMLabel  blocks, first;
  PetscInt n, found;

  ok(DMGetDimension(dm, &found));
  assert_int_equal(found, row->dim);
  ok(DMGetCoordinateDim(dm, &found));
  assert_int_equal(found, row->dim);
  assert_int_equal(count_cells(dm), row->elements);
  near(volume_of(dm), N_CUBES, 1e-13);
  for (PetscInt i = 0; i < 3; i++) {
    const SurfaceFacts from = surface_facts(dm, left[i]), to = surface_facts(dm, right[i]);

    assert_int_equal(from.n, per_end);
    assert_int_equal(to.n, per_end);
    near(from.area, 1, 1e-14);
    near(to.area, 1, 1e-14);
    near(from.centre[0], 0, 1e-14);
    near(to.centre[0], N_CUBES, 1e-13);
    (void)check_nodes_at(dm, left[i], 0, 0);
    (void)check_nodes_at(dm, right[i], 0, N_CUBES);
  }
  /* a mesh whose elements did not fit would have more: the ends, and 2 or 4 sides of squares, or of two triangles each */
  assert_int_equal(surface_facts(dm, NULL).n, 2 * per_end + 2 * (row->dim - 1) * N_CUBES * per_end);
  ok(DMGetLabel(dm, "Cell Sets", &blocks));
  ok(DMGetLabel(dm, "first", &first));
  assert_non_null(blocks);
  assert_non_null(first);
  for (PetscInt number = 1; number <= 2; number++) {
    ok(DMLabelGetStratumSize(blocks, number, &n));
    assert_true(sum_of_ranks((PetscReal)n) >= row->elements / 2);
  }
  ok(DMLabelGetStratumSize(first, 1, &n));
  assert_int_equal(sum_of_ranks((PetscReal)n), (row->elements + 1) / 2);
}

static void gmsh_files(void **state)
{
  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt simplex = 0; simplex < 2; simplex++)
      for (PetscInt version = 0; version < 2; version++) {
        const Row   row  = row_of(dim, N_CUBES, (PetscBool)simplex);
        const char *path = "row.msh";
        DM          dm;

        if (version) WriteGmsh41(path, &row);
        else WriteGmsh22(path, &row);
        dm = create_mesh("-dm_plex_filename %s -dm_plex_dim %d", path, (int)dim);
        CheckRow(dm, &row, EndElements(&row));
        ok(DMDestroy(&dm));
        dm = create_mesh("-dm_plex_filename %s -scale 0.001 -translate %s", path, dim == 2 ? "1,0" : "1,0,0");
        near(volume_of(dm) / (dim == 2 ? 1e-6 : 1e-9), N_CUBES, 1e-11); /* lengths of 1e-3 near 1 have 13 digits */
        near(surface_facts(dm, "xmax").centre[0], 1.006, 1e-15);
        ok(DMDestroy(&dm));
        MPI_Barrier(PETSC_COMM_WORLD);
      }
}

/* One half of the elements: the common face of the halves is now one of the boundary, and the other half's end is left out */
static void blocks_of_a_file(void **state)
{
  const Row row = row_of(3, N_CUBES, PETSC_TRUE);
  DM        dm;
  PetscInt  n, *points;

  (void)state;
  WriteGmsh22("row.msh", &row);
  dm = create_mesh("-dm_plex_filename row.msh -mesh_blocks second");
  assert_int_equal(count_cells(dm), row.elements / 2);
  near(volume_of(dm), N_CUBES / 2, 1e-14);
  near(surface_facts(dm, "xmin").centre[0], N_CUBES / 2, 1e-14);
  near(surface_facts(dm, "right").centre[0], N_CUBES, 1e-14);
  refused(PETSC_ERR_USER_INPUT, "'box'|'left'|right", MeshGetSurface(dm, "left", &n, &points));
  ok(DMDestroy(&dm));
  dm = create_mesh("-dm_plex_filename row.msh -mesh_blocks 1,second");
  assert_int_equal(count_cells(dm), row.elements);
  ok(DMDestroy(&dm));
  mesh_refused(PETSC_ERR_USER_INPUT, "'box'|row.msh|'third'|-mesh_blocks|first (1), second (2)",
               "-dm_plex_filename row.msh -mesh_blocks second,third");
}

/* A part of a sound file is no sound file */
static void truncated_gmsh_files(void **state)
{
  char   text[1 << 15];
  size_t length = 0;

  (void)state;
  for (PetscInt version = 0; version < 2; version++) {
    const Row row = row_of(3, N_CUBES, PETSC_FALSE);
    FILE     *stream;
    size_t    end;

    if (version) WriteGmsh41("row.msh", &row);
    else WriteGmsh22("row.msh", &row);
    stream = fopen("row.msh", "r");
    assert_non_null(stream);
    length = fread(text, 1, sizeof(text) - 1, stream);
    assert_int_equal(fclose(stream), 0);
    text[length] = 0;
    end          = (size_t)(strstr(text, "$EndElements") - text);
    MPI_Barrier(PETSC_COMM_WORLD);
    for (size_t cut = 0; cut < end + 11; cut += 37) {
      const char kept = text[cut];

      text[cut] = 0;
      write_file("cut.msh", text);
      text[cut] = kept;
      mesh_refused(PETSC_ERR_USER_INPUT, "Body 'box', mesh file 'cut.msh'", "-dm_plex_filename cut.msh");
      MPI_Barrier(PETSC_COMM_WORLD);
    }
  }
}

#define GMSH_BEGIN                                                                                                                         \
  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n$EndNodes\n$Elements\n"
#define GMSH_END "$EndElements\n"

static void bad_gmsh_files(void **state)
{
  const struct {
    const char *text, *words;
  } cases[] = {
      {"", "empty"},
      {"Once upon a time\n", "section|line 1"},
      {"$MeshFormat\n3 0 8\n$EndMeshFormat\n", "version 3|4.1"},
      {"$MeshFormat\n2.2 7 8\n$EndMeshFormat\n", "file type 7"},
      {"$Nodes\n1\n1 0 0 0\n$EndNodes\n", "$MeshFormat"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "$Nodes|cut short"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1000000000\n1 0 0 0\n$EndNodes\n", "1000000000 nodes|line 6"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n-3\n1 0 0 0\n$EndNodes\n", "-3 nodes"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n1 0 0 x\n$EndNodes\n", "number is expected|line 7"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n5 0 0 0\n1 1 0 0\n$EndNodes\n", "node 1 is there twice"},
      {GMSH_BEGIN "1\n1 3 2 0 1 1 2 3 9\n" GMSH_END, "element 1|node 9|not in the file|line 15"},
      {GMSH_BEGIN "1\n1 3 2 0 1 1 2 3 4 5\n" GMSH_END, "$Elements|$EndElements"},
      {GMSH_BEGIN "2\n1 3 2 0 1 1 2 3 4\n" GMSH_END, "whole number|line 16"},
      {GMSH_BEGIN "1\n1 99999 2 0 1 1 2 3 4\n" GMSH_END, "type 99999"},
      {GMSH_BEGIN "1\n1 16 2 0 1 1 2 3 4 5 6 7 8\n" GMSH_END, "element 1|type 16|first-order"},
      {GMSH_BEGIN "1\n1 6 2 0 1 1 2 3 4 5 6\n" GMSH_END, "element 1|prism"},
      {GMSH_BEGIN "2\n1 3 2 0 1 1 2 3 4\n2 2 2 0 1 2 5 6\n" GMSH_END, "mixes|element 1 is a quadrilateral, element 2 a triangle"},
      {GMSH_BEGIN "2\n1 3 2 0 1 1 4 3 2\n2 3 2 0 1 2 5 6 3\n" GMSH_END, "1 of 2 elements is inverted|element 1 at (0.5, 0.5)|area -1"},
      {GMSH_BEGIN "2\n1 3 2 0 1 1 4 3 2\n2 3 2 0 1 2 3 6 5\n" GMSH_END, "all 2 elements are inverted|left-handed|element 1"},
      {GMSH_BEGIN "1\n1 3 2 0 1 1 2 3 3\n" GMSH_END, "element 1|same node|corners 3 and 4"},
      {GMSH_BEGIN "1\n1 2 2 0 1 1 2 5\n" GMSH_END, "element 1|area 0"},
      {GMSH_BEGIN "2\n1 3 2 0 1 1 2 3 4\n7 1 2 3 1 1 5\n" GMSH_END, "element 7|not a face"},
      {GMSH_BEGIN "0\n" GMSH_END, "no elements"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 1 \"depth\"\n$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 "
       "0 1 0\n$EndNodes\n$Elements\n2\n1 3 2 0 1 1 2 3 4\n2 1 2 1 1 1 2\n" GMSH_END,
       "'depth'|rename"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0.5\n4 0 1 0\n$EndNodes\n$Elements\n1\n1 3 2 0 1 1 2 3 "
       "4\n" GMSH_END,
       "node 3|z = 0.5|dimension 2"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 nan 0\n4 0 1 0\n$EndNodes\n$Elements\n1\n1 3 2 0 1 1 2 3 "
       "4\n" GMSH_END,
       "node 3|no number"},
  };
  char words[512];

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    write_file("bad.msh", cases[i].text);
    (void)snprintf(words, sizeof(words), "Body 'box', mesh file 'bad.msh'|%s", cases[i].words);
    mesh_refused(PETSC_ERR_USER_INPUT, words, "-dm_plex_filename bad.msh");
    MPI_Barrier(PETSC_COMM_WORLD);
  }
}

static void bad_files(void **state)
{
  const Row row = row_of(2, N_CUBES, PETSC_FALSE);

  (void)state;
  mesh_refused(PETSC_ERR_FILE_OPEN, "'box'|nowhere.msh|no such file", "-dm_plex_filename nowhere.msh");
  mesh_refused(PETSC_ERR_FILE_OPEN, "'box'|directory", "-dm_plex_filename /");
  write_file("row.stl", "solid");
  mesh_refused(PETSC_ERR_USER_INPUT, "'box'|row.stl|.msh|.exo", "-dm_plex_filename row.stl");
  WriteGmsh22("row.msh", &row);
  mesh_refused(PETSC_ERR_USER_INPUT, "'box'|row.msh|dimension 2|-a_dm_plex_dim|3", "-dm_plex_filename row.msh -dm_plex_dim 3");
}

/* Bars of a line, some from right to left: the same from either end */
static void bars_of_a_file(void **state)
{
  DM dm;

  (void)state;
  write_file("line.msh",
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n0 5 \"tip\"\n$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 3 0 "
             "0\n4 6 0 0\n$EndNodes\n$Elements\n4\n1 1 2 1 1 1 2\n2 1 2 1 1 3 2\n3 1 2 1 1 3 4\n4 15 2 5 1 4\n$EndElements\n");
  dm = create_mesh("-dm_plex_filename line.msh");
  assert_int_equal(count_cells(dm), 3);
  near(volume_of(dm), 6, 1e-14);
  (void)check_nodes_at(dm, "tip", 0, 6);
  assert_int_equal(surface_facts(dm, "tip").n, 1);
  ok(DMDestroy(&dm));
}

/* What is wrong with an Exodus file on purpose */
typedef enum {
  SOUND,
  NODE_OUT_OF_RANGE,
  ELEMENT_OF_SIDE_SET,
  SIDE_OF_SIDE_SET,
  NODE_OF_NODE_SET,
  WRONG_TYPE,
  NO_CONNECTIVITY,
  SHORT_COORDINATES,
  WRONG_COUNT,
  LEFT_HANDED,
  N_FAULTS,
} Fault;

#define nc(...) assert_int_equal(__VA_ARGS__, NC_NOERR)

static int Dimension(int id, const char name[], PetscInt length)
{
  int dimension;

  nc(nc_def_dim(id, name, (size_t)length, &dimension));
  return dimension;
}

static int Variable(int id, const char name[], nc_type type, int rank, int first, int second)
{
  const int dimensions[2] = {first, second};
  int       variable;

  nc(nc_def_var(id, name, type, rank, dimensions, &variable));
  return variable;
}

static void WriteText(int id, int variable, size_t i, const char text[])
{
  const size_t start[2] = {i, 0}, count[2] = {1, strlen(text) + 1};

  nc(nc_put_vara_text(id, variable, start, count, text));
}

/* A row in two blocks, 10 "first" and 20 "second"; side sets 7 "left" and 8, without a name, at its ends; node set 3 "corner"
   of its first node. In two dimensions, coordinates are one array. */
static void WriteExodus(const char path[], const Row *row, int mode, Fault fault)
{
  const PetscInt    half = row->elements / 2, dim = row->dim, per_end = EndElements(row);
  const char *const type = fault == WRONG_TYPE ? "HEX20"
                           : dim == 2          ? (row->corners == 3 ? "TRI3" : "QUAD")
                           : row->corners == 4 ? "TETRA4"
                                               : "hex8";
  int               id, coordinates[3], ids[3], names[2], connect[2], elements[2], sides[2], nodes, numbers[2] = {10, 20}, one = 1;

  if (!rank_of_world()) {
    const int d_dim   = (nc(nc_create(path, NC_CLOBBER | mode, &id)), Dimension(id, "num_dim", dim));
    const int d_nodes = Dimension(id, "num_nodes", row->nodes), d_length = Dimension(id, "len_name", 33);
    const int d_blocks = Dimension(id, "num_el_blk", 2), d_sets = Dimension(id, "num_side_sets", 2),
              d_node_sets = Dimension(id, "num_node_sets", 1);
    const int d_in[2]     = {Dimension(id, "num_el_in_blk1", half), Dimension(id, "num_el_in_blk2", row->elements - half)};
    const int d_per[2]    = {Dimension(id, "num_nod_per_el1", row->corners), Dimension(id, "num_nod_per_el2", row->corners)};
    const int d_set[2]    = {Dimension(id, "num_side_ss1", per_end), Dimension(id, "num_side_ss2", per_end)},
              d_node_set  = Dimension(id, "num_nod_ns1", 1);
    const int d_short     = Dimension(id, "short", row->nodes - 1);

    (void)Dimension(id, "num_elem", fault == WRONG_COUNT ? row->elements + 1 : row->elements);
    if (dim == 2) coordinates[0] = Variable(id, "coord", NC_DOUBLE, 2, d_dim, d_nodes);
    else
      for (PetscInt d = 0; d < 3; d++)
        coordinates[d] = Variable(id,
                                  d == 0   ? "coordx"
                                  : d == 1 ? "coordy"
                                           : "coordz",
                                  NC_DOUBLE, 1, fault == SHORT_COORDINATES && d == 2 ? d_short : d_nodes, 0);
    ids[0]   = Variable(id, "eb_prop1", NC_INT, 1, d_blocks, 0);
    ids[1]   = Variable(id, "ss_prop1", NC_INT, 1, d_sets, 0);
    ids[2]   = Variable(id, "ns_prop1", NC_INT, 1, d_node_sets, 0);
    names[0] = Variable(id, "eb_names", NC_CHAR, 2, d_blocks, d_length);
    names[1] = Variable(id, "ss_names", NC_CHAR, 2, d_sets, d_length);
    for (PetscInt b = 0; b < 2; b++) {
      char name[32];

      (void)snprintf(name, sizeof(name), "connect%d", (int)b + 1);
      connect[b] = Variable(id, fault == NO_CONNECTIVITY && b ? "nothing" : name, NC_INT, 2, d_in[b], d_per[b]);
      nc(nc_put_att_text(id, connect[b], "elem_type", strlen(type), type));
      (void)snprintf(name, sizeof(name), "elem_ss%d", (int)b + 1);
      elements[b] = Variable(id, name, NC_INT, 1, d_set[b], 0);
      (void)snprintf(name, sizeof(name), "side_ss%d", (int)b + 1);
      sides[b] = Variable(id, name, NC_INT, 1, d_set[b], 0);
    }
    nodes = Variable(id, "node_ns1", NC_INT, 1, d_node_set, 0);
    nc(nc_enddef(id));
    for (PetscInt i = 1; i <= row->nodes; i++) {
      double x[3];

      row_position(row, i, x);
      for (PetscInt d = 0; d < dim; d++) {
        const size_t at[2] = {(size_t)(dim == 2 ? d : i - 1), (size_t)i - 1};

        if (fault == SHORT_COORDINATES && d == 2 && i == row->nodes) continue;
        nc(nc_put_var1_double(id, coordinates[dim == 2 ? 0 : d], at, &x[d]));
      }
    }
    for (PetscInt e = 0; e < row->elements; e++) {
      const PetscInt block    = e >= half;
      const size_t   start[2] = {(size_t)(e - block * half), 0}, count[2] = {1, (size_t)row->corners};
      PetscInt       at[8];
      int            values[8];

      row_element(row, e, at);
      for (PetscInt k = 0; k < row->corners; k++) values[k] = (int)at[k];
      if (fault == LEFT_HANDED)
        for (PetscInt k = 0; k < 4; k++) {
          values[k]     = (int)at[k + 4];
          values[k + 4] = (int)at[k];
        }
      if (fault == NODE_OUT_OF_RANGE && e == 2) values[5] = (int)row->nodes + 1;
      nc(nc_put_vara_int(id, connect[block], start, count, values));
    }
    {
      const int left[2] = {7, 0}, right = fault == ELEMENT_OF_SIDE_SET ? (int)row->elements + 1 : (int)row->elements;
      int       set_numbers[2] = {left[0], 8}, element[2][2] = {{1, 2}, {right, right - 1}}, side[2][2] = {{4, 4}, {2, 2}};

      if (dim == 3 && row->corners == 8) side[0][0] = 5, side[1][0] = 6; /* base and top */
      if (dim == 3 && row->corners == 4) { /* triangles 1 2 3 and 1 3 4 of the base, 7 8 5 and 5 6 7 of the top */
        element[0][0] = 1, side[0][0] = 4, element[0][1] = 2, side[0][1] = 4;
        element[1][0] = (int)row->elements - 2, side[1][0] = 2, element[1][1] = (int)row->elements - 1, side[1][1] = 2;
      }
      if (dim == 2 && row->corners == 3) element[0][0] = 2, side[0][0] = 3, element[1][0] = (int)row->elements - 1, side[1][0] = 2;
      if (fault == SIDE_OF_SIDE_SET) side[0][0] = 7;
      nc(nc_put_var_int(id, ids[0], numbers));
      nc(nc_put_var_int(id, ids[1], set_numbers));
      set_numbers[0] = 3;
      nc(nc_put_var_int(id, ids[2], set_numbers));
      for (PetscInt b = 0; b < 2; b++) {
        nc(nc_put_var_int(id, elements[b], element[b]));
        nc(nc_put_var_int(id, sides[b], side[b]));
        WriteText(id, names[0], (size_t)b, b ? "second" : "first");
        WriteText(id, names[1], (size_t)b, b ? "" : "left");
      }
    }
    if (fault == NODE_OF_NODE_SET) one = 0;
    nc(nc_put_var_int(id, nodes, &one));
    nc(nc_close(id));
  }
  MPI_Barrier(PETSC_COMM_WORLD);
}

static void exodus_files(void **state)
{
  const int modes[] = {0, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4};

  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt simplex = 0; simplex < 2; simplex++)
      for (PetscInt mode = 0; mode < 4; mode++) {
        const Row row = row_of(dim, N_CUBES, (PetscBool)simplex);
        DM        dm;
        DMLabel   first;
        PetscInt  n, *vertices;

        WriteExodus("row.exo", &row, modes[mode], SOUND);
        dm = create_mesh("-dm_plex_filename row.exo -dm_plex_dim %d", (int)dim);
        assert_int_equal(count_cells(dm), row.elements);
        near(volume_of(dm), N_CUBES, 1e-13);
        assert_int_equal(surface_facts(dm, "left").n, EndElements(&row));
        near(surface_facts(dm, "left").area, 1, 1e-14);
        near(surface_facts(dm, "7").centre[0], 0, 1e-14);
        near(surface_facts(dm, "8").area, 1, 1e-14);
        near(surface_facts(dm, "8").centre[0], N_CUBES, 1e-13);
        (void)check_nodes_at(dm, "left", 0, 0);
        ok(DMGetLabel(dm, "first", &first));
        ok(DMLabelGetStratumSize(first, 1, &n));
        assert_int_equal(sum_of_ranks((PetscReal)n), row.elements / 2);
        ok(MeshGetNodeSet(dm, "3", &n, &vertices));
        for (PetscInt i = 0; i < n; i++) {
          PetscReal x[3];

          position_of(dm, vertices[i], x);
          near(x[0] * x[0] + x[1] * x[1] + x[2] * x[2], 0, 0);
        }
        assert_true(n <= 1 && sum_of_ranks((PetscReal)n) >= 1);
        ok(PetscFree(vertices));
        ok(DMDestroy(&dm));
        dm = create_mesh("-dm_plex_filename row.exo -mesh_blocks 20");
        assert_int_equal(count_cells(dm), row.elements / 2);
        near(surface_facts(dm, "xmin").centre[0], N_CUBES / 2, 1e-14);
        near(surface_facts(dm, "8").centre[0], N_CUBES, 1e-13);
        refused(PETSC_ERR_USER_INPUT, "'box'|'left'|8", MeshGetSurface(dm, "left", &n, &vertices));
        ok(DMDestroy(&dm));
        MPI_Barrier(PETSC_COMM_WORLD);
      }
}

static void bad_exodus_files(void **state)
{
  const char *const words[N_FAULTS] = {"",
                                       "element 3 (block 10)|node 29|1 to 28",
                                       "side set 8|element 7|1 to 6",
                                       "side set 7|side 7 of element 1",
                                       "node set 3|node 0",
                                       "block 10|'HEX20'|HEX8",
                                       "connect2",
                                       "coordz|27 values|28",
                                       "num_elem|7|6",
                                       "all 6 elements are inverted|left-handed"};
  const Row         row             = row_of(3, N_CUBES, PETSC_FALSE);
  char              expected[512];

  (void)state;
  for (Fault fault = SOUND + 1; fault < N_FAULTS; fault++)
    for (PetscInt netcdf4 = 0; netcdf4 < 2; netcdf4++) {
      WriteExodus("bad.g", &row, netcdf4 ? NC_NETCDF4 : NC_64BIT_OFFSET, fault);
      (void)snprintf(expected, sizeof(expected), "Body 'box', mesh file 'bad.g'|%s", words[fault]);
      mesh_refused(PETSC_ERR_USER_INPUT, expected, "-dm_plex_filename bad.g");
      MPI_Barrier(PETSC_COMM_WORLD);
    }
  write_file("bad.g", "CDF is what I am not");
  mesh_refused(PETSC_ERR_USER_INPUT, "bad.g|NetCDF", "-dm_plex_filename bad.g");
  write_file("bad.g", "");
  mesh_refused(PETSC_ERR_USER_INPUT, "bad.g|NetCDF", "-dm_plex_filename bad.g");
}

/* The library itself reads zeros where a classic file ends too early */
static void truncated_exodus_files(void **state)
{
  const int modes[] = {0, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4};
  const Row row     = row_of(3, N_CUBES, PETSC_FALSE);
  char     *bytes;

  (void)state;
  ok(PetscMalloc1(1 << 20, &bytes));
  for (PetscInt mode = 0; mode < 4; mode++) {
    FILE  *stream;
    size_t length;

    WriteExodus("row.g", &row, modes[mode], SOUND);
    stream = fopen("row.g", "rb");
    assert_non_null(stream);
    length = fread(bytes, 1, 1 << 20, stream);
    assert_int_equal(fclose(stream), 0);
    assert_true(length < 1 << 20);
    MPI_Barrier(PETSC_COMM_WORLD);
    for (PetscInt cut = 0; cut < 24; cut++) {
      /* all lengths at the end of a file, where nothing but the last numbers is missing; data are padded to four bytes */
      const size_t kept = cut < 20 ? length * (size_t)cut / 20 : length - 4 * (size_t)(cut - 19);

      if (!rank_of_world()) {
        stream = fopen("cut.g", "wb");
        assert_non_null(stream);
        assert_int_equal(fwrite(bytes, 1, kept, stream), kept);
        assert_int_equal(fclose(stream), 0);
      }
      MPI_Barrier(PETSC_COMM_WORLD);
      mesh_refused(PETSC_ERR_USER_INPUT, "Body 'box', mesh file 'cut.g'", "-dm_plex_filename cut.g");
      MPI_Barrier(PETSC_COMM_WORLD);
    }
  }
  ok(PetscFree(bytes));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(gmsh_files),     cmocka_unit_test(blocks_of_a_file), cmocka_unit_test(truncated_gmsh_files),
      cmocka_unit_test(bad_gmsh_files), cmocka_unit_test(bad_files),        cmocka_unit_test(bars_of_a_file),
      cmocka_unit_test(exodus_files),   cmocka_unit_test(bad_exodus_files), cmocka_unit_test(truncated_exodus_files),
  };

  return impakt_main(argc, argv, tests);
}
