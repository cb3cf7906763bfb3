/* What is in the file of the fields: the mesh of all bodies, and the fields of a frame. */
#include "fieldsimpl.h"
#include "outputfile.h"

/* Makes the file, with its mesh, under the name that it has until it has a frame */
PetscErrorCode FieldsWriteMesh(Fields fields)
{
  const FieldsMesh *mesh  = &fields->mesh;
  PetscErrorCode    error = PETSC_SUCCESS;
  PetscMPIInt       rank;
  PetscReal        *positions;
  char             *options;
  int              *numbers;

  PetscFunctionBegin;
  PetscCall(FieldsObstaclesFind(fields->problem, mesh->n_bodies, mesh->bodies, &fields->n_obstacles, &fields->obstacles));
  if (fields->first_rank) {
    PetscCall(PetscOptionsGetAll(NULL, &options));
    error = OutputFileMakeParents(fields->part); /* which may be gone since they were checked */
    if (!error) error = FieldsFileCreate(fields->part, mesh, fields->set, fields->n_frames, fields->precision, options);
    if (!error) error = FieldsObstaclesWrite(fields->part, fields->n_obstacles, fields->obstacles);
    PetscCall(PetscFree(options));
  }
  PetscCall(FieldsShareError(fields, error));
  PetscCall(FieldsFileOpen(fields->comm, fields->part, &fields->file));
  PetscCall(PetscMalloc1(3 * (size_t)mesh->nodes.local, &positions));
  PetscCall(FieldsMeshGetNodes(mesh, positions));
  PetscCall(FieldsFileWrite(fields->comm, fields->file, "/mesh/positions", &mesh->nodes, 3, H5T_NATIVE_DOUBLE, positions));
  PetscCall(PetscFree(positions));
  PetscCall(PetscMalloc1(PetscMax((size_t)mesh->topology.local * (size_t)mesh->cell_nodes, (size_t)mesh->cells.local), &numbers));
  PetscCall(FieldsMeshGetTopology(mesh, numbers));
  PetscCall(FieldsFileWrite(fields->comm, fields->file, "/mesh/cells", &mesh->topology, mesh->cell_nodes, H5T_NATIVE_INT, numbers));
  PetscCallMPI(MPI_Comm_rank(fields->comm, &rank));
  for (hsize_t i = 0; i < mesh->cells.local; i++) numbers[i] = rank;
  PetscCall(FieldsFileWrite(fields->comm, fields->file, "/mesh/rank", &mesh->cells, 1, H5T_NATIVE_INT, numbers));
  for (PetscInt b = 0, next = 0; b < mesh->n_bodies; b++)
    for (hsize_t i = 0; i < mesh->cells.count[b]; i++) numbers[next++] = (int)b;
  PetscCall(FieldsFileWrite(fields->comm, fields->file, "/mesh/body", &mesh->cells, 1, H5T_NATIVE_INT, numbers));
  PetscCall(PetscFree(numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FieldsShareError(Fields fields, PetscErrorCode error)
{
  PetscFunctionBegin;
  PetscCall(OutputFileShareError(fields->comm, error, "-output_fields", fields->path, "write"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline void Store(Fields fields, size_t i, PetscReal value)
{
  if (fields->precision == OUTPUT_DOUBLE) ((double *)fields->buffer)[i] = value;
  else ((float *)fields->buffer)[i] = (float)value;
}

static PetscErrorCode WriteField(Fields fields, FieldsKind kind)
{
  const FieldsField *field = &fields_of_a_frame[kind];
  char               name[64];

  PetscFunctionBegin;
  PetscCall(FieldsFileGetDataset(kind, fields->written, sizeof(name), name));
  PetscCall(FieldsFileWrite(fields->comm, fields->file, name, field->on_cells ? &fields->mesh.cells : &fields->mesh.nodes,
                            field->components, fields->precision == OUTPUT_DOUBLE ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT, fields->buffer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes displacement or velocity, with zeros beyond the dimension of space */
static PetscErrorCode WriteNodes(Fields fields, FieldsKind kind)
{
  const FieldsMesh *mesh = &fields->mesh;
  size_t            next = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    const PetscScalar *values;
    PetscInt           dim;
    Vec                u, v;

    PetscCall(BodyGetDimension(mesh->bodies[b], &dim));
    PetscCall(BodyGetSolution(mesh->bodies[b], &u, &v, NULL));
    PetscCall(VecGetArrayRead(kind == FIELDS_VELOCITY ? v : u, &values));
    for (PetscInt i = 0; i < (PetscInt)mesh->nodes.count[b]; i++)
      for (PetscInt d = 0; d < 3; d++) Store(fields, next++, d < dim ? PetscRealPart(values[i * dim + d]) : 0);
    PetscCall(VecRestoreArrayRead(kind == FIELDS_VELOCITY ? v : u, &values));
  }
  PetscCall(WriteField(fields, kind));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal VonMises(const PetscReal s[])
{
  const PetscReal a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];

  return PetscSqrtReal((a * a + b * b + c * c) / 2 + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

static PetscErrorCode WriteStress(Fields fields)
{
  static const int  tensor[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2}; /* place of each entry, row by row, among xx, yy, zz, xy, yz, xz */
  const FieldsMesh *mesh      = &fields->mesh;
  const size_t      n         = (size_t)mesh->cells.local;
  size_t            first     = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    PetscCall(BodyComputeStress(mesh->bodies[b], fields->stress + 6 * first));
    first += (size_t)mesh->cells.count[b];
  }
  for (size_t i = 0; i < n; i++)
    for (size_t c = 0; c < 9; c++) Store(fields, 9 * i + c, fields->stress[6 * i + (size_t)tensor[c]]);
  PetscCall(WriteField(fields, FIELDS_STRESS));
  for (size_t i = 0; i < n; i++) Store(fields, i, VonMises(fields->stress + 6 * i));
  PetscCall(WriteField(fields, FIELDS_VON_MISES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WritePlasticStrain(Fields fields)
{
  const FieldsMesh *mesh  = &fields->mesh;
  size_t            first = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    PetscReal work;

    PetscCall(BodyComputePlasticStrain(mesh->bodies[b], fields->plastic + first, &work));
    first += (size_t)mesh->cells.count[b];
  }
  for (size_t i = 0; i < first; i++) Store(fields, i, fields->plastic[i]);
  PetscCall(WriteField(fields, FIELDS_PLASTIC_STRAIN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of each cell's block within its body; 0 in bodies of one material */
static PetscErrorCode WriteBlocks(Fields fields)
{
  const FieldsMesh *mesh  = &fields->mesh;
  size_t            first = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    const PetscInt *blocks;

    PetscCall(BodyGetCellBlocks(mesh->bodies[b], &blocks));
    for (size_t i = 0; i < (size_t)mesh->cells.count[b]; i++) Store(fields, first + i, blocks ? (PetscReal)blocks[i] : 0);
    first += (size_t)mesh->cells.count[b];
  }
  PetscCall(WriteField(fields, FIELDS_BLOCK));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteContact(Fields fields)
{
  static const PetscInt begin[FIELDS_PER_FRAME] = {[FIELDS_CONTACT_FORCE]     = CONTACT_FIELDS_FORCE,
                                                   [FIELDS_CONTACT_PRESSURE]  = CONTACT_FIELDS_PRESSURE,
                                                   [FIELDS_CONTACT_GAP]       = CONTACT_FIELDS_GAP,
                                                   [FIELDS_CONTACT_ACTIVE]    = CONTACT_FIELDS_ACTIVE,
                                                   [FIELDS_FRICTION_TRACTION] = CONTACT_FIELDS_TRACTION,
                                                   [FIELDS_CONTACT_SLIDING]   = CONTACT_FIELDS_SLIDING,
                                                   [FIELDS_SLIP_DISTANCE]     = CONTACT_FIELDS_SLIP_DISTANCE,
                                                   [FIELDS_FRICTION_LOSS]     = CONTACT_FIELDS_FRICTION_LOSS};
  const FieldsMesh     *mesh                    = &fields->mesh;
  size_t                first                   = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    PetscCall(ContactGetFields(fields->contact, b, fields->nodal + CONTACT_FIELDS_SIZE * first));
    first += (size_t)mesh->nodes.count[b];
  }
  for (FieldsKind kind = FIELDS_FIRST_OF_CONTACT; kind < FIELDS_PER_FRAME; kind++) {
    const size_t n = (size_t)fields_of_a_frame[kind].components;

    if (!FieldsSetHas(fields->set, kind)) break;
    for (size_t i = 0; i < first; i++)
      for (size_t c = 0; c < n; c++) Store(fields, n * i + c, fields->nodal[CONTACT_FIELDS_SIZE * i + (size_t)begin[kind] + c]);
    PetscCall(WriteField(fields, kind));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteTime(Fields fields, PetscReal time)
{
  hsize_t    begin = (hsize_t)fields->written, count = fields->first_rank ? 1 : 0;
  FieldsRows rows = {1, (hsize_t)fields->n_frames, &begin, &count, count};

  PetscFunctionBegin;
  PetscCall(FieldsFileWrite(fields->comm, fields->file, "/time", &rows, 1, H5T_NATIVE_DOUBLE, &time));
  fields->times[fields->written++] = time;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A frame: its fields, and its time, which tells readers that the frame is whole */
PetscErrorCode FieldsWriteFrame(Fields fields, PetscReal time)
{
  PetscFunctionBegin;
  PetscCall(WriteNodes(fields, FIELDS_DISPLACEMENT));
  PetscCall(WriteNodes(fields, FIELDS_VELOCITY));
  PetscCall(WriteStress(fields));
  if (fields->plastic) PetscCall(WritePlasticStrain(fields));
  if (FieldsSetHas(fields->set, FIELDS_BLOCK)) PetscCall(WriteBlocks(fields));
  if (fields->contact) PetscCall(WriteContact(fields));
  PetscCall(WriteTime(fields, time));
  PetscFunctionReturn(PETSC_SUCCESS);
}
