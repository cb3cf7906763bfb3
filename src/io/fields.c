/* Writes displacement, velocity, stress and contact of all bodies, every so many controller steps. */
#define _POSIX_C_SOURCE 200809L
#include "fieldsimpl.h"
#include "outputfile.h"
#include "outputpaths.h"
#include "xdmf.h"
#include <petsctime.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <impakt/private/bodymeasures.h>

/* Most frames in a run whose options do not say how often */
#define DEFAULT_FRAMES 100

/* The whole XDMF file is written with a frame after this many times as long as writing took: at most 2 % of the run */
#define XDMF_SHARE 50.0

static PetscInt CountFrames(PetscInt steps, PetscInt interval)
{
  return 1 + steps / interval + (steps % interval ? 1 : 0);
}

/* The least interval that makes at most so many frames */
static PetscInt LeastInterval(PetscInt steps, PetscInt n_frames)
{
  return PetscMax(1, steps / (n_frames - 1) + (steps % (n_frames - 1) ? 1 : 0));
}

static PetscErrorCode SetInterval(Fields fields, PetscInt steps, PetscInt interval)
{
  PetscFunctionBegin;
  PetscCheck(interval >= 0, fields->comm, PETSC_ERR_USER_INPUT,
             "-output_fields_interval %" PetscInt_FMT
             " must be a number of controller steps, 1 or more; or 0 for one that makes at most %d frames",
             interval, DEFAULT_FRAMES);
  fields->interval = interval ? interval : LeastInterval(steps, DEFAULT_FRAMES);
  fields->n_frames = CountFrames(steps, fields->interval);
  PetscCheck(fields->n_frames <= FIELDS_MAX_FRAMES, fields->comm, PETSC_ERR_USER_INPUT,
             "-output_fields_interval %" PetscInt_FMT " makes %" PetscInt_FMT " frames in this run of %" PetscInt_FMT
             " controller steps, and %d is the limit; give %" PetscInt_FMT " or more",
             fields->interval, fields->n_frames, steps, FIELDS_MAX_FRAMES, LeastInterval(steps, FIELDS_MAX_FRAMES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if the frames of the whole run would not fit on the disk, the space of a file that they replace included */
static PetscErrorCode CheckSpace(Fields fields)
{
  const double needed = (double)FieldsFileGetSize(&fields->mesh, fields->set, fields->n_frames, fields->precision);
  double       space  = 0;

  PetscFunctionBegin;
  if (fields->first_rank) {
    const char    *slash = strrchr(fields->path, '/');
    char           folder[PETSC_MAX_PATH_LEN];
    struct statvfs system;
    struct stat    old;

    PetscCall(PetscStrncpy(folder, slash ? fields->path : ".", slash ? (size_t)(slash - fields->path) + 2 : 2));
    if (statvfs(folder, &system) || !system.f_blocks) space = PETSC_MAX_REAL; /* it does not tell */
    else space = (double)system.f_bavail * (double)system.f_frsize + (stat(fields->path, &old) ? 0 : 512. * (double)old.st_blocks);
  }
  PetscCallMPI(MPI_Bcast(&space, 1, MPI_DOUBLE, 0, fields->comm));
  PetscCheck(needed <= space, fields->comm, PETSC_ERR_USER_INPUT,
             "-output_fields %s will have %" PetscInt_FMT
             " frames, %.3g GB in all, and there is room for %.3g GB; write fewer of them with -output_fields_interval",
             fields->path, fields->n_frames, 1e-9 * needed, 1e-9 * space);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateBuffers(Fields fields)
{
  const FieldsMesh *mesh   = &fields->mesh;
  size_t            length = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < FIELDS_PER_FRAME; i++)
    length = PetscMax(length,
                      (size_t)fields_of_a_frame[i].components * (size_t)(fields_of_a_frame[i].on_cells ? mesh->cells : mesh->nodes).local);
  PetscCall(PetscMalloc(PetscMax(1, length * (fields->precision == OUTPUT_DOUBLE ? sizeof(double) : sizeof(float))), &fields->buffer));
  PetscCall(PetscMalloc1((size_t)mesh->cells.local * 6, &fields->stress));
  if (FieldsSetHas(fields->set, FIELDS_PLASTIC_STRAIN)) PetscCall(PetscMalloc1((size_t)mesh->cells.local, &fields->plastic));
  if (fields->contact) PetscCall(PetscMalloc1((size_t)mesh->nodes.local * CONTACT_FIELDS_SIZE, &fields->nodal));
  PetscCall(PetscMalloc1(fields->n_frames, &fields->times));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fields of a run, in an HDF5 file with an XDMF file beside it. `interval`: a frame every so many controller steps, and at the end; 0: at
   most 100 frames, and it becomes what that takes. Collective */
PetscErrorCode FieldsCreate(Controller controller, const char path[], PetscInt *interval, OutputPrecision precision, Fields *fields)
{
  const Body   *bodies;
  Contact       contact;
  PetscInt      steps, n_bodies, n_pairs;
  PetscMPIInt   rank;
  PetscBool     plastic = PETSC_FALSE, blocks = PETSC_FALSE;
  ContactTraits traits;
  Fields        f;

  PetscFunctionBegin;
  PetscCall(PetscNew(&f));
  *fields = f;
  f->comm = PetscObjectComm((PetscObject)controller);
  f->file = -1;
  f->held = -1;
  PetscCallMPI(MPI_Comm_rank(f->comm, &rank));
  f->first_rank = rank ? PETSC_FALSE : PETSC_TRUE;
  f->precision  = precision;
  PetscCall(XdmfCheckPath(f->comm, path));
  PetscCall(OutputFileCheck(f->comm, "-output_fields", path));
  PetscCall(PetscStrncpy(f->path, path, sizeof(f->path)));
  if (f->first_rank) PetscCall(OutputFileGetPart(path, sizeof(f->part), f->part));
  PetscCallMPI(MPI_Bcast(f->part, (PetscMPIInt)sizeof(f->part), MPI_CHAR, 0, f->comm));
  PetscCall(XdmfGetPath(path, XDMF_BODIES, sizeof(f->xdmf), f->xdmf));
  PetscCall(OutputFileCheck(f->comm, "-output_fields, beside it,", f->xdmf));
  PetscCall(ControllerGetTimes(controller, NULL, NULL, &steps));
  PetscCall(SetInterval(f, steps, *interval));
  *interval = f->interval;
  PetscCall(ControllerGetBodies(controller, &n_bodies, &bodies));
  PetscCall(FieldsMeshCreate(n_bodies, bodies, &f->mesh));
  PetscCall(ControllerGetContact(controller, &contact));
  f->problem = contact;
  PetscCall(FieldsObstaclesCheckPath(contact, path));
  PetscCall(ContactGetNumPairs(contact, &n_pairs));
  PetscCall(ContactGetTraits(contact, &traits));
  f->set = (1u << (!n_pairs ? FIELDS_FIRST_OF_CONTACT : traits.friction ? FIELDS_PER_FRAME : FIELDS_FIRST_OF_FRICTION)) - 1;
  for (PetscInt i = 0; i < n_bodies && !plastic; i++) PetscCall(BodyHasHistory(bodies[i], &plastic));
  if (!plastic) f->set &= ~(1u << FIELDS_PLASTIC_STRAIN);
  for (PetscInt i = 0; i < n_bodies && !blocks; i++) {
    PetscInt n;

    PetscCall(BodyGetBlocks(bodies[i], &n, NULL, NULL));
    blocks = (PetscBool)(n > 0);
  }
  if (!blocks) f->set &= ~(1u << FIELDS_BLOCK);
  PetscCall(CheckSpace(f));
  if (n_pairs) f->contact = contact;
  PetscCall(CreateBuffers(f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* FieldsKeepFirst - the file has room for the frame of the start alone; before it is written */
void FieldsKeepFirst(Fields fields)
{
  fields->n_frames = 1;
}

/* Gives the file its final name, with the XDMF file of the obstacles beside it; that of the frames of an earlier run is removed */
static PetscErrorCode TakePlace(Fields fields)
{
  PetscBool placed = PETSC_TRUE;
  char      xdmf[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  if (fields->first_rank) {
    PetscCall(OutputPathResolve(fields->xdmf, sizeof(xdmf), xdmf)); /* a link stays, and is written through */
    (void)remove(xdmf);
    PetscCall(OutputFilePlace(fields->part, fields->path, &fields->held, &placed));
    if (placed) PetscCall(XdmfWriteObstacles(fields->path, fields->n_obstacles, fields->obstacles, fields->times[0]));
  }
  PetscCheck(placed, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "%s has vanished while it was written", fields->part);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the frames in the XDMF file: `always`, or only if the last writing is long enough ago */
static PetscErrorCode List(Fields fields, PetscBool always)
{
  PetscLogDouble begin;

  PetscFunctionBegin;
  PetscCall(PetscTime(&begin));
  if (!fields->first_rank || fields->listed == fields->written) PetscFunctionReturn(PETSC_SUCCESS);
  if (!always && begin - fields->list_ended < XDMF_SHARE * fields->list_seconds) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(XdmfWrite(fields->path, &fields->mesh, fields->set, fields->precision, fields->written, fields->times));
  PetscCall(PetscTime(&fields->list_ended));
  fields->list_seconds = fields->list_ended - begin;
  fields->listed       = fields->written;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteFrame(Fields fields, PetscReal time)
{
  const PetscBool begins = (PetscBool)(fields->file < 0);

  PetscFunctionBegin;
  if (begins) PetscCall(FieldsWriteMesh(fields));
  PetscCall(FieldsWriteFrame(fields, time));
  if (begins) PetscCall(FieldsShareError(fields, TakePlace(fields)));
  PetscCall(FieldsShareError(fields, List(fields, PETSC_FALSE)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes a frame at every interval and at the end. Collective */
PetscErrorCode FieldsMonitor(Controller controller, const ControllerFrame *frame, void *context)
{
  Fields         fields = (Fields)context;
  PetscErrorCode error;
  HDF5Silence    silence;

  PetscFunctionBegin;
  (void)controller;
  if (frame->step % fields->interval && frame->step != frame->steps) PetscFunctionReturn(PETSC_SUCCESS);
  HDF5SilenceBegin(&silence);
  error          = WriteFrame(fields, frame->time);
  fields->failed = (PetscBool)(error != PETSC_SUCCESS);
  if (error && !fields->written && fields->first_rank) (void)remove(fields->part);
  PetscCall(error);
  HDF5SilenceEnd(&silence);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Closes the file after the last frame, with all frames listed in the XDMF file. Collective */
PetscErrorCode FieldsFinish(Fields fields)
{
  PetscErrorCode error;
  int            closed;

  PetscFunctionBegin;
  if (fields->first_rank && access(fields->xdmf, F_OK)) fields->listed = -1; /* somebody has moved or deleted it */
  error          = FieldsShareError(fields, List(fields, PETSC_TRUE));
  fields->failed = (PetscBool)(error != PETSC_SUCCESS); /* FieldsDestroy() does not tell it again */
  PetscCall(error);
  if (fields->file < 0) PetscFunctionReturn(PETSC_SUCCESS);
  closed       = H5Fclose(fields->file) < 0 ? 0 : 1;
  fields->file = -1;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &closed, 1, MPI_INT, MPI_MIN, fields->comm));
  PetscCheck(closed, fields->comm, PETSC_ERR_FILE_WRITE, "HDF5 cannot close %s; is the disk full?", fields->path);
  PetscCall(FieldsShareError(fields, OutputFileRestore(fields->held, fields->path)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* FieldsSync - has all frames so far written through to the disk; Collective */
PetscErrorCode FieldsSync(Fields fields)
{
  int flushed;

  PetscFunctionBegin;
  if (fields->file < 0) PetscFunctionReturn(PETSC_SUCCESS);
  flushed = H5Fflush(fields->file, H5F_SCOPE_GLOBAL) < 0 ? 0 : 1;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &flushed, 1, MPI_INT, MPI_MIN, fields->comm));
  PetscCheck(flushed, fields->comm, PETSC_ERR_FILE_WRITE, "%s cannot be written; is the disk full?", fields->path);
  PetscCall(FieldsShareError(fields, OutputFileSync(fields->held, fields->path)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes up the file of the run that is continued, with the frames before its checkpoint, once all of that has been loaded. `fields`: the
   `Fields`, after FieldsVisit(); `NULL`: there are none. Nothing where fields begin with the run. Collective */
PetscErrorCode FieldsTakeUp(Fields fields)
{
  const PetscInt written = fields ? fields->goes_on : 0;
  PetscErrorCode error   = PETSC_SUCCESS;
  HDF5Silence    silence;

  PetscFunctionBegin;
  if (!written) PetscFunctionReturn(PETSC_SUCCESS);
  fields->goes_on = 0;
  HDF5SilenceBegin(&silence);
  if (fields->first_rank) error = FieldsFileCut(fields->path, fields->n_frames, written, fields->times);
  PetscCall(FieldsShareError(fields, error));
  PetscCallMPI(MPI_Bcast(fields->times, (PetscMPIInt)fields->n_frames, MPIU_REAL, 0, fields->comm));
  PetscCall(FieldsFileOpen(fields->comm, fields->path, &fields->file));
  HDF5SilenceEnd(&silence);
  fields->written = written;
  if (fields->first_rank) error = OutputFileHold(fields->path, &fields->held);
  PetscCall(FieldsShareError(fields, error));
  fields->listed = -1;
  PetscCall(FieldsShareError(fields, List(fields, PETSC_TRUE)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The place in the file, to or from a checkpoint; loading, FieldsTakeUp() is to follow. `fields`: the `Fields`; `NULL`: there are none;
   `same_ranks`: it is continued on as many ranks as before, by which the numbers in the file are ordered. Fields whose path is not that
   of the run that is continued begin with the restart. Collective */
PetscErrorCode FieldsVisit(Fields fields, MPI_Comm comm, PetscBool same_ranks, Checkpoint checkpoint)
{
  PetscInt  numbers[3] = {fields ? fields->written : 0, fields ? fields->n_frames : 0, fields ? fields->interval : 0};
  PetscBool same;
  int       all_same; /* as the first rank, which writes, sees the file system */

  PetscFunctionBegin;
  PetscCall(OutputPathVisit(fields ? fields->path : NULL, "fields", checkpoint, &same));
  PetscCall(CheckpointVisitInts(checkpoint, "fields frames", 3, numbers));
  if (!CheckpointLoads(checkpoint) || !fields || !numbers[0]) PetscFunctionReturn(PETSC_SUCCESS);
  all_same = same;
  PetscCallMPI(MPI_Bcast(&all_same, 1, MPI_INT, 0, comm));
  if (!all_same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(
      same_ranks, comm, PETSC_ERR_USER_INPUT,
      "-output_fields %s: the file is ordered by the ranks of the run that is continued, and these are more or fewer; give another path, "
      "where the fields begin with the restart",
      fields->path);
  PetscCheck(numbers[1] == fields->n_frames && numbers[2] == fields->interval, comm, PETSC_ERR_USER_INPUT,
             "-output_fields %s has places for %" PetscInt_FMT " frames, one every %" PetscInt_FMT
             " steps, and this run wants %" PetscInt_FMT ", one every %" PetscInt_FMT
             "; give another path, where the fields begin with the restart, or the same -output_fields_interval and -time_end",
             fields->path, numbers[1], numbers[2], fields->n_frames, fields->interval);
  fields->goes_on = numbers[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Frees the fields. After an error, which may be one of this rank alone, FieldsFinish() is not called, and the file is left as it is. The
   frames in it can be read, and the XDMF file lists them */
PetscErrorCode FieldsDestroy(Fields *fields)
{
  Fields         f = *fields;
  PetscErrorCode error;

  PetscFunctionBegin;
  if (!f) PetscFunctionReturn(PETSC_SUCCESS);
  if (f->failed) PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL)); /* the failure has been told */
  error = List(f, PETSC_TRUE);
  if (f->failed) PetscCall(PetscPopErrorHandler());
  if (!f->failed) PetscCall(error);
  PetscCall(OutputFileRelease(&f->held));
  PetscCall(FieldsMeshDestroy(&f->mesh));
  PetscCall(PetscFree(f->obstacles));
  PetscCall(PetscFree(f->times));
  PetscCall(PetscFree(f->stress));
  PetscCall(PetscFree(f->nodal));
  PetscCall(PetscFree(f->plastic));
  PetscCall(PetscFree(f->buffer));
  PetscCall(PetscFree(*fields));
  PetscFunctionReturn(PETSC_SUCCESS);
}
