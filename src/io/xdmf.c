/* XDMF describes an HDF5 file to ParaView and others (www.xdmf.org, XDMF Model and Format, version 3). Only what meshio and both of VTK's
   readers understand is used: a temporal collection of uniform grids, whole datasets, and no references within the XML. */
#include "xdmf.h"
#include "outputfile.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>

static const char *FileName(const char path[])
{
  const char *slash = strrchr(path, '/');

  return slash ? slash + 1 : path;
}

static PetscBool EndsWith(const char text[], const char end[])
{
  const size_t n = strlen(text), m = strlen(end);

  return (PetscBool)(n > m && !strcmp(text + n - m, end));
}

/* Where the XDMF file of an HDF5 file is, which ends so in place of .h5 */
PetscErrorCode XdmfGetPath(const char fields[], const char ending[], size_t size, char path[])
{
  size_t length = strlen(fields);

  PetscFunctionBegin;
  if (EndsWith(fields, ".h5")) length -= 3;
  else if (EndsWith(fields, ".hdf5")) length -= 5;
  PetscCheck(length + strlen(ending) < size, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "The output path '%s' is too long: %zu characters at most", fields, size - strlen(ending) - 1);
  PetscCall(PetscSNPrintf(path, size, "%.*s%s", (int)length, fields, ending));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* XdmfCheckPath - makes sure that XDMF can name the HDF5 file `path` */
PetscErrorCode XdmfCheckPath(MPI_Comm comm, const char path[])
{
  PetscFunctionBegin;
  PetscCheck(!EndsWith(path, ".xdmf") && !EndsWith(path, ".xmf"), comm, PETSC_ERR_USER_INPUT,
             "-output_fields %s: give the path of the HDF5 file, as in fields.h5; the XDMF file is written beside it", path);
  PetscCheck(
      !EndsWith(path, ".vtu") && !EndsWith(path, ".vtk") && !EndsWith(path, ".pvd") && !EndsWith(path, ".pvtu") && !EndsWith(path, ".csv"),
      comm, PETSC_ERR_USER_INPUT,
      "-output_fields %s: HDF5 is written, with an XDMF file beside it that ParaView and pyvista read; give a path as in fields.h5", path);
  PetscCheck(!strpbrk(FileName(path), ":&<>\"'"), comm, PETSC_ERR_USER_INPUT,
             "-output_fields %s: the XDMF file beside it cannot name a file with any of : & < > \" ' in its name; choose another", path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void WriteItem(FILE *out, const char type[], size_t bytes, hsize_t rows, PetscInt components, const char file[],
                      const char dataset[])
{
  char dimensions[64];

  if (components > 1) snprintf(dimensions, sizeof(dimensions), "%llu %d", (unsigned long long)rows, (int)components);
  else snprintf(dimensions, sizeof(dimensions), "%llu", (unsigned long long)rows);
  fprintf(out, "<DataItem Format=\"HDF\" NumberType=\"%s\" Precision=\"%zu\" Dimensions=\"%s\">%s:%s</DataItem>", type, bytes, dimensions,
          file, dataset);
}

static void WriteMesh(FILE *out, const FieldsMesh *mesh, const char file[])
{
  fprintf(out, "        <Topology TopologyType=\"%s\" NumberOfElements=\"%llu\"", mesh->topology_type,
          (unsigned long long)mesh->cells.total);
  if (!mesh->mixed) fprintf(out, " NodesPerElement=\"%d\"", (int)mesh->cell_nodes);
  fprintf(out, ">");
  WriteItem(out, "Int", sizeof(int), mesh->topology.total, mesh->cell_nodes, file, "/mesh/cells");
  fprintf(out, "</Topology>\n        <Geometry GeometryType=\"XYZ\">");
  WriteItem(out, "Float", sizeof(double), mesh->nodes.total, 3, file, "/mesh/positions");
  fprintf(out, "</Geometry>\n");
}

static void BeginAttribute(FILE *out, const char name[], const char type[], PetscBool on_cells)
{
  fprintf(out, "        <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"%s\">", name, type, on_cells ? "Cell" : "Node");
}

static PetscErrorCode WriteFrame(FILE *out, const FieldsMesh *mesh, FieldsSet set, OutputPrecision precision, PetscInt frame,
                                 PetscReal time, const char file[])
{
  static const char *const fixed[] = {"body", "rank"};
  char                     dataset[64];

  PetscFunctionBegin;
  fprintf(out, "      <Grid Name=\"bodies\" GridType=\"Uniform\">\n        <Time Value=\"%.17g\"/>\n", (double)time);
  WriteMesh(out, mesh, file);
  for (FieldsKind i = 0; i < FIELDS_PER_FRAME; i++) {
    const FieldsField *field = &fields_of_a_frame[i];

    if (!FieldsSetHas(set, i)) continue;
    PetscCall(FieldsFileGetDataset(i, frame, sizeof(dataset), dataset));
    BeginAttribute(out, field->name, field->attribute_type, field->on_cells);
    WriteItem(out, "Float", precision == OUTPUT_DOUBLE ? sizeof(double) : sizeof(float),
              (field->on_cells ? mesh->cells : mesh->nodes).total, field->components, file, dataset);
    fprintf(out, "</Attribute>\n");
  }
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(fixed); i++) {
    snprintf(dataset, sizeof(dataset), "/mesh/%s", fixed[i]);
    BeginAttribute(out, fixed[i], "Scalar", PETSC_TRUE);
    WriteItem(out, "Int", sizeof(int), mesh->cells.total, 1, file, dataset);
    fprintf(out, "</Attribute>\n");
  }
  fprintf(out, "      </Grid>\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  const char       *file; /* name of the HDF5 file */
  const FieldsMesh *mesh;
  FieldsSet         set;
  PetscInt          n_frames;
  OutputPrecision   precision;
  const PetscReal  *times;
} List;

static PetscErrorCode BeginFile(const char part[], const char name[], const char type[], FILE **out)
{
  PetscFunctionBegin;
  *out = fopen(part, "w");
  PetscCheck(*out, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "%s cannot be written: %s", part, strerror(errno));
  fprintf(*out,
          "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n    <Grid Name=\"%s\" GridType=\"Collection\" "
          "CollectionType=\"%s\">\n",
          name, type);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode EndFile(const char part[], FILE *out)
{
  int failed;

  PetscFunctionBegin;
  fprintf(out, "    </Grid>\n  </Domain>\n</Xdmf>\n");
  failed = ferror(out);
  failed = fclose(out) || failed;
  PetscCheck(!failed, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "%s cannot be written; is the disk full?", part);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* See OutputFileWrite() */
static PetscErrorCode WriteList(const char part[], void *ctx)
{
  List *list = (List *)ctx;
  FILE *out;

  PetscFunctionBegin;
  PetscCall(BeginFile(part, "frames", "Temporal", &out));
  for (PetscInt k = 0; k < list->n_frames; k++)
    PetscCall(WriteFrame(out, list->mesh, list->set, list->precision, k, list->times[k], list->file));
  PetscCall(EndFile(part, out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the XDMF file of an HDF5 file of fields, replacing what is there as a whole. `times`: their times [s]. One rank calls it. */
PetscErrorCode XdmfWrite(const char fields[], const FieldsMesh *mesh, FieldsSet set, OutputPrecision precision, PetscInt n_frames,
                         const PetscReal times[])
{
  List list = {FileName(fields), mesh, set, n_frames, precision, times};
  char path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(XdmfGetPath(fields, XDMF_BODIES, sizeof(path), path));
  PetscCall(OutputFileWrite(path, WriteList, &list, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the file of the obstacles lists, see XdmfWriteObstacles() */
typedef struct {
  const char         *file; /* name of the HDF5 file */
  PetscInt            n;
  const ObstacleGrid *grids;
  PetscReal           time;
} ObstacleList;

/* See OutputFileWrite() */
static PetscErrorCode WriteObstacles(const char part[], void *ctx)
{
  const ObstacleList *list = (const ObstacleList *)ctx;
  char                dataset[PETSC_MAX_PATH_LEN];
  FILE               *out;

  PetscFunctionBegin;
  PetscCall(BeginFile(part, "obstacles", "Spatial", &out));
  for (PetscInt i = 0; i < list->n; i++) {
    const ObstacleGrid *grid    = &list->grids[i];
    const hsize_t       n_cells = (hsize_t)ObstacleGridCountCells(grid), n_points = (hsize_t)ObstacleGridCountPoints(grid);

    fprintf(out,
            "      <Grid Name=\"%s\" GridType=\"Uniform\">\n        <Time Value=\"%.17g\"/>\n        <Topology TopologyType=\"%s\" "
            "NumberOfElements=\"%llu\" NodesPerElement=\"%d\">",
            grid->name, (double)list->time, grid->corners == 4 ? "Quadrilateral" : "Polyline", (unsigned long long)n_cells,
            (int)grid->corners);
    PetscCall(PetscSNPrintf(dataset, sizeof(dataset), "/mesh/obstacles/%s/cells", grid->name));
    WriteItem(out, "Int", sizeof(int), n_cells, grid->corners, list->file, dataset);
    fprintf(out, "</Topology>\n        <Geometry GeometryType=\"XYZ\">");
    PetscCall(PetscSNPrintf(dataset, sizeof(dataset), "/mesh/obstacles/%s/points", grid->name));
    WriteItem(out, "Float", sizeof(double), n_points, 3, list->file, dataset);
    fprintf(out, "</Geometry>\n      </Grid>\n");
  }
  PetscCall(EndFile(part, out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the XDMF file of the obstacles, replacing what is there as a whole. `time`: of the first frame: readers want one, and another
   would be a frame of its own in ParaView [s]. One rank calls it. */
PetscErrorCode XdmfWriteObstacles(const char fields[], PetscInt n, const ObstacleGrid grids[], PetscReal time)
{
  ObstacleList list = {FileName(fields), n, grids, time};
  char         path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(XdmfGetPath(fields, XDMF_OBSTACLES, sizeof(path), path));
  PetscCall(OutputFileWrite(path, WriteObstacles, &list, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
