/* The files of fields: what they hold, what they refuse, that they can be read before the run is over. */
#define _POSIX_C_SOURCE 200809L
#include "simulation.h"
#include <io/fields.h>
#include <hdf5.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH      "fields.h5"
#define XDMF      "fields.xdmf"
#define STEPS     10
#define MAX_NODES 16 /* of one rank in one body */

static PetscBool IsFirst(void)
{
  PetscMPIInt rank;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return (PetscBool)!rank;
}

static PetscBool Exists(const char path[])
{
  MPI_Barrier(PETSC_COMM_WORLD);
  return (PetscBool)!access(path, F_OK);
}

static void Remove(void)
{
  MPI_Barrier(PETSC_COMM_WORLD);
  if (IsFirst()) assert_int_equal(remove(PATH) || remove(XDMF), 0);
}

/* How often a word is in the XDMF file */
static PetscInt CountInXdmf(const char word[])
{
  static const size_t size = 1 << 20;
  FILE               *file;
  char               *text;
  PetscInt            n = 0;

  MPI_Barrier(PETSC_COMM_WORLD);
  file = fopen(XDMF, "r");
  if (!file) return -1;
  text = malloc(size);
  assert_non_null(text);
  text[fread(text, 1, size - 1, file)] = '\0';
  fclose(file);
  for (const char *at = text; (at = strstr(at, word)); at++) n++;
  free(text);
  return n;
}

/* A dataset of some shape, in the precision it should have, with its units */
static void Read(hid_t file, const char name[], hid_t type, hsize_t rows, hsize_t columns, const char units[], hid_t memory, void *values)
{
  hid_t   dataset = H5Dopen2(file, name, H5P_DEFAULT), space, attribute, text_type, stored;
  hsize_t size[2] = {0, 1};
  char    text[16];

  if (dataset < 0) print_error("there is no dataset %s\n", name);
  assert_true(dataset >= 0);
  space = H5Dget_space(dataset);
  assert_int_equal(H5Sget_simple_extent_dims(space, size, NULL), columns > 1 ? 2 : 1);
  assert_int_equal(size[0], rows);
  assert_int_equal(size[1], columns);
  stored = H5Dget_type(dataset);
  assert_true(H5Tequal(stored, type) > 0);
  attribute = H5Aopen(dataset, "units", H5P_DEFAULT);
  text_type = H5Aget_type(attribute);
  assert_true(H5Tget_size(text_type) < sizeof(text));
  assert_true(H5Aread(attribute, text_type, text) >= 0);
  assert_string_equal(text, units);
  assert_true(H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  H5Tclose(stored);
  H5Tclose(text_type);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Dclose(dataset);
}

/* What this rank has seen */
typedef struct {
  PetscReal times[STEPS + 1], u[STEPS + 1][2][MAX_NODES], v[STEPS + 1][2][MAX_NODES], stress[STEPS + 1][2][6 * MAX_NODES];
} Record;

static PetscErrorCode Note(Controller controller, const ControllerFrame *frame, void *ctx)
{
  Record     *record = (Record *)ctx;
  const Body *bodies;

  PetscFunctionBegin;
  record->times[frame->step] = frame->time;
  PetscCall(ControllerGetBodies(controller, NULL, &bodies));
  for (PetscInt b = 0; b < 2; b++) {
    const PetscScalar *values;
    PetscInt           n;
    Vec                u, v;

    PetscCall(BodyGetSolution(bodies[b], &u, &v, NULL));
    PetscCall(VecGetLocalSize(u, &n));
    PetscCheck(n <= MAX_NODES, PETSC_COMM_SELF, PETSC_ERR_PLIB, "MAX_NODES is too small");
    PetscCall(VecGetArrayRead(u, &values));
    PetscCall(PetscArraycpy(record->u[frame->step][b], values, n));
    PetscCall(VecRestoreArrayRead(u, &values));
    PetscCall(VecGetArrayRead(v, &values));
    PetscCall(PetscArraycpy(record->v[frame->step][b], values, n));
    PetscCall(VecRestoreArrayRead(v, &values));
    PetscCall(BodyComputeStress(bodies[b], record->stress[frame->step][b]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void CreateRun(Simulation *simulation, PetscInt interval, OutputPrecision precision, Fields *fields, Record *record)
{
  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  ok(FieldsCreate(simulation->controller, PATH, interval, precision, fields));
  ok(ControllerMonitorSet(simulation->controller, Note, record, NULL));
  ok(ControllerMonitorSet(simulation->controller, FieldsMonitor, *fields, NULL));
}

/* 4 and 3 elements, 5 and 4 nodes: those of the second body begin behind those of the first */
#define NODES 9
#define CELLS 7

/* Numbers of the file that are this rank's are those noted, bit for bit in the file's precision; cells have the stress of their
   nodes' displacements (E = 1) wherever they are */
static void CheckFrame(hid_t file, Simulation *simulation, const Record *record, PetscInt frame, PetscInt step, OutputPrecision precision)
{
  const hid_t type = precision == OUTPUT_DOUBLE ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
  double      u[NODES][3], v[NODES][3], stress[CELLS][9], von_mises[CELLS], x[NODES][3];
  int         cells[CELLS][2], ranks[CELLS], bodies[CELLS];
  char        name[64];

  snprintf(name, sizeof(name), "/displacement/%04d", (int)frame);
  Read(file, name, type, NODES, 3, "m", H5T_NATIVE_DOUBLE, u);
  snprintf(name, sizeof(name), "/velocity/%04d", (int)frame);
  Read(file, name, type, NODES, 3, "m/s", H5T_NATIVE_DOUBLE, v);
  snprintf(name, sizeof(name), "/stress/%04d", (int)frame);
  Read(file, name, type, CELLS, 9, "Pa", H5T_NATIVE_DOUBLE, stress);
  snprintf(name, sizeof(name), "/von_mises/%04d", (int)frame);
  Read(file, name, type, CELLS, 1, "Pa", H5T_NATIVE_DOUBLE, von_mises);
  Read(file, "/mesh/positions", H5T_IEEE_F64LE, NODES, 3, "m", H5T_NATIVE_DOUBLE, x);
  Read(file, "/mesh/cells", H5T_STD_I32LE, CELLS, 2, "1", H5T_NATIVE_INT, cells);
  Read(file, "/mesh/rank", H5T_STD_I32LE, CELLS, 1, "1", H5T_NATIVE_INT, ranks);
  Read(file, "/mesh/body", H5T_STD_I32LE, CELLS, 1, "1", H5T_NATIVE_INT, bodies);
  for (PetscInt b = 0; b < 2; b++) {
    const PetscInt     first = b ? 5 : 0, first_cell = b ? 4 : 0, n_cells = b ? 3 : 4;
    const PetscScalar *positions;
    PetscInt           begin, end, mine = 0;
    PetscMPIInt        rank;
    Vec                reference;

    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    ok(BodyGetReferencePositions(simulation->bodies[b], &reference));
    ok(VecGetOwnershipRange(reference, &begin, &end));
    ok(VecGetArrayRead(reference, &positions));
    for (PetscInt i = begin; i < end; i++) {
      const PetscReal ui = record->u[step][b][i - begin], vi = record->v[step][b][i - begin];

      near(x[first + i][0], positions[i - begin], 0);
      near(u[first + i][0], precision == OUTPUT_DOUBLE ? ui : (double)(float)ui, 0);
      near(v[first + i][0], precision == OUTPUT_DOUBLE ? vi : (double)(float)vi, 0);
      for (PetscInt d = 1; d < 3; d++) assert_true(x[first + i][d] == 0 && u[first + i][d] == 0 && v[first + i][d] == 0);
    }
    ok(VecRestoreArrayRead(reference, &positions));
    for (PetscInt c = first_cell; c < first_cell + n_cells; c++) {
      const int       p = cells[c][0], q = cells[c][1];
      const PetscReal strain = (u[q][0] - u[p][0]) / (x[q][0] - x[p][0]);

      assert_int_equal(bodies[c], b);
      assert_in_range(p, first, first + n_cells);
      assert_in_range(q, first, first + n_cells);
      near(PetscAbsReal(x[q][0] - x[p][0]), 0.999 / n_cells, 1e-15); /* neighbours: bars of 1 m less half the gap */
      near(stress[c][0], strain,
           precision == OUTPUT_DOUBLE ? 1e-15 : 1e-8); /* displacements of 0.02 m, rounded to 1e-9 m in single precision, over 1/4 m */
      near(von_mises[c], PetscAbsReal(stress[c][0]), 0);
      for (PetscInt i = 1; i < 9; i++) assert_true(stress[c][i] == 0);
      if (ranks[c] != rank) continue;
      near(stress[c][0], precision == OUTPUT_DOUBLE ? record->stress[step][b][6 * mine] : (double)(float)record->stress[step][b][6 * mine],
           0);
      mine++;
    }
  }
}

/* Frames are steps 0, interval, 2 interval, ..., and the last */
static void CheckFile(Simulation *simulation, const Record *record, PetscInt interval, OutputPrecision precision)
{
  const PetscInt n    = 1 + (STEPS + interval - 1) / interval;
  hid_t          file = H5Fopen(PATH, H5F_ACC_RDONLY, H5P_DEFAULT);
  double         times[STEPS + 1];

  assert_true(file >= 0);
  assert_true(H5Aexists(file, "version") > 0 && H5Aexists(file, "-time_step") > 0);
  Read(file, "/time", H5T_IEEE_F64LE, (hsize_t)n, 1, "s", H5T_NATIVE_DOUBLE, times);
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt step = PetscMin(k * interval, STEPS);

    near(times[k], record->times[step], 0);
    CheckFrame(file, simulation, record, k, step, precision);
  }
  H5Fclose(file);
  assert_int_equal(CountInXdmf("<Time Value="), n);
}

static void RunAndCheck(Simulation *simulation, PetscInt interval, OutputPrecision precision)
{
  Fields      fields;
  Record      record;
  const char *path, *xdmf;

  CreateRun(simulation, interval, precision, &fields, &record);
  assert_false(Exists(PATH));
  ok(ControllerSolve(simulation->controller));
  ok(FieldsFinish(fields));
  ok(FieldsFinish(fields)); /* nothing is left to do */
  ok(FieldsGetPaths(fields, &path, &xdmf));
  assert_string_equal(path, PATH);
  assert_string_equal(xdmf, XDMF);
  ok(FieldsDestroy(&fields));
  assert_null(fields);
  CheckFile(simulation, &record, interval ? interval : 1, precision);
  assert_false(Exists(PATH ".part") || Exists(XDMF ".part"));
  Remove();
}

static void single_precision_at_every_step(void **state)
{
  RunAndCheck((Simulation *)*state, 0, OUTPUT_SINGLE);
}

/* 0, 4, 8, 10 */
static void double_precision_now_and_then(void **state)
{
  RunAndCheck((Simulation *)*state, 4, OUTPUT_DOUBLE);
}

/* 0 and 10 */
static void first_and_last_at_least(void **state)
{
  RunAndCheck((Simulation *)*state, 1000, OUTPUT_DOUBLE);
}

/* The file in the middle of the run, as another program reads it: by a copy, for HDF5 has the file itself open in here */
static PetscErrorCode ReadOnTheWay(Controller controller, const ControllerFrame *frame, void *ctx)
{
  static const size_t size = 1 << 20;
  double              times[STEPS + 1];
  char               *text;
  FILE               *from, *to;
  hid_t               file;

  PetscFunctionBegin;
  (void)controller;
  (void)ctx;
  if (frame->step != 0 && frame->step != 5) PetscFunctionReturn(PETSC_SUCCESS);
  between(CountInXdmf("<Time Value="), 1, frame->step + 1); /* not necessarily all of them at once */
  if (!IsFirst()) PetscFunctionReturn(PETSC_SUCCESS);
  text = malloc(size);
  assert_non_null(text);
  from = fopen(PATH, "r");
  to   = fopen("copy.h5", "w");
  assert_true(from && to);
  for (size_t n; (n = fread(text, 1, size, from));) assert_int_equal(fwrite(text, 1, n, to), n);
  fclose(from);
  fclose(to);
  free(text);
  file = H5Fopen("copy.h5", H5F_ACC_RDONLY, H5P_DEFAULT);
  assert_true(file >= 0);
  Read(file, "/time", H5T_IEEE_F64LE, STEPS + 1, 1, "s", H5T_NATIVE_DOUBLE, times);
  for (PetscInt k = 0; k <= STEPS; k++) assert_true(k <= frame->step ? PetscAbsReal(times[k] - 0.02 * k) < 1e-14 : isnan(times[k]));
  H5Fclose(file);
  remove("copy.h5");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void readable_at_any_time(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Fields      fields;
  Record      record;

  CreateRun(simulation, 1, OUTPUT_SINGLE, &fields, &record);
  ok(ControllerMonitorSet(simulation->controller, ReadOnTheWay, NULL, NULL));
  ok(ControllerSolve(simulation->controller));
  ok(FieldsFinish(fields));
  ok(FieldsDestroy(&fields));
  CheckFile(simulation, &record, 1, OUTPUT_SINGLE);
  Remove();
}

/* What an earlier run has left stays until there is a frame of this one */
static void earlier_files_stay(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Fields      fields;
  Record      record;

  if (IsFirst()) {
    FILE *file = fopen(XDMF, "w");

    assert_non_null(file);
    fputs("<Time Value=", file);
    fclose(file);
    file = fopen(PATH, "w");
    assert_non_null(file);
    fclose(file);
  }
  CreateRun(simulation, 1, OUTPUT_SINGLE, &fields, &record);
  assert_int_equal(CountInXdmf("<Time Value="), 1);
  ok(ControllerSolve(simulation->controller));
  ok(FieldsFinish(fields));
  ok(FieldsDestroy(&fields));
  CheckFile(simulation, &record, 1, OUTPUT_SINGLE);
  Remove();
}

static void what_is_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Fields      fields;

  AddCollision(4, 3, 0);
  AddOptions("-time_end 400"); /* 20000 steps */
  ok(SimulationCreate(simulation));
  if (IsFirst()) assert_int_equal(mkdir("folder", 0777) || mkdir("other.xdmf", 0777), 0);
#define refuse(code, words, path, interval)                                                                                                \
  do {                                                                                                                                     \
    fields = NULL;                                                                                                                         \
    refused(code, words, FieldsCreate(simulation->controller, path, interval, OUTPUT_SINGLE, &fields));                                    \
    ok(FieldsDestroy(&fields));                                                                                                            \
  } while (0)
  MPI_Barrier(PETSC_COMM_WORLD);
  refuse(PETSC_ERR_FILE_WRITE, "-output_fields folder cannot be written", "folder", 0);
  refuse(PETSC_ERR_FILE_WRITE, "-output_fields, beside it, other.xdmf cannot be written", "other.h5", 0);
  refuse(PETSC_ERR_USER_INPUT, "-output_fields needs the path", "", 0);
  refuse(PETSC_ERR_USER_INPUT, "give the path of the HDF5 file", "f.xdmf", 0);
  refuse(PETSC_ERR_USER_INPUT, "a:b.h5|choose another", "a:b.h5", 0);
  refuse(PETSC_ERR_USER_INPUT, "-output_fields_interval -1 must be", PATH, -1);
  refuse(PETSC_ERR_USER_INPUT, "-output_fields_interval 2 makes 10001 frames in this run of 20000 |10000 is the limit; give 3 or more",
         PATH, 2);
  assert_false(Exists(PATH) || Exists(XDMF) || Exists("folder.part"));
  ok(FieldsCreate(simulation->controller, PATH, 3, OUTPUT_SINGLE, &fields)); /* 6668 frames */
  ok(FieldsDestroy(&fields));
  assert_false(Exists(PATH)); /* it has seen no frame */
  if (IsFirst()) assert_int_equal(rmdir("folder") || rmdir("other.xdmf"), 0);
}

/* A body of quadrilaterals and one of triangles: a list that says each cell's shape, 5 and 4 in XDMF's count */
static void several_shapes(void **state)
{
  Body       bodies[2];
  FieldsMesh mesh;
  int       *entries, sums[3] = {0};
  PetscInt   n = 0;

  (void)state;
  AddOptions("-quads_dm_plex_dim 2 -quads_dm_plex_simplex 0 -quads_dm_plex_box_faces 3,2 -quads_density 1 -quads_youngs_modulus 1");
  AddOptions("-tris_dm_plex_dim 2 -tris_dm_plex_simplex 1 -tris_dm_plex_box_faces 2,2 -tris_density 1 -tris_youngs_modulus 1");
  for (PetscInt b = 0; b < 2; b++) {
    ok(BodyCreate(PETSC_COMM_WORLD, b ? "tris" : "quads", &bodies[b]));
    ok(BodySetFromOptions(bodies[b]));
    ok(BodySetControllerStep(bodies[b], 0, 1e-3));
    ok(BodySetUp(bodies[b]));
  }
  ok(FieldsMeshCreate(2, bodies, &mesh));
  assert_true(mesh.mixed);
  assert_string_equal(mesh.topology_type, "Mixed");
  assert_int_equal(mesh.nodes.total, 12 + 9);
  assert_int_equal(mesh.cells.total, 6 + 8);
  assert_int_equal(mesh.topology.total, 6 * 5 + 8 * 4);
  entries = malloc(sizeof(int) * (size_t)(mesh.topology.local + 1));
  assert_non_null(entries);
  ok(FieldsMeshGetTopology(&mesh, entries));
  while (n < (PetscInt)mesh.topology.local) {
    const int shape = entries[n], nodes = shape == 5 ? 4 : 3;

    assert_true(shape == 5 || shape == 4);
    for (int i = 1; i <= nodes; i++) assert_in_range(entries[n + i], shape == 5 ? 0 : 12, shape == 5 ? 11 : 20);
    sums[shape - 4]++;
    n += 1 + nodes;
  }
  assert_int_equal(n, mesh.topology.local);
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  assert_int_equal(sums[1], 6);
  assert_int_equal(sums[0], 8);
  free(entries);
  ok(FieldsMeshDestroy(&mesh));
  for (PetscInt b = 0; b < 2; b++) ok(BodyDestroy(&bodies[b]));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(single_precision_at_every_step),
      simulation_test(double_precision_now_and_then),
      simulation_test(first_and_last_at_least),
      simulation_test(readable_at_any_time),
      simulation_test(earlier_files_stay),
      simulation_test(what_is_refused),
      simulation_test(several_shapes),
  };

  return impakt_main(argc, argv, tests);
}
