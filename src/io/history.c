/* The history of a run: records of all controller steps, collected in memory and added to the file from time to time. */
#define _POSIX_C_SOURCE 200809L
#include "history.h"
#include "hdf5file.h"
#include "outputfile.h"
#include "outputpaths.h"
#include "series.h"
#include <petsctime.h>
#include <stdio.h>
#include <sys/units.h>
#include <unistd.h>

#define BUFFER_BYTES      ((size_t)1 << 16) /* of records that wait for writing, at first */
#define BUFFER_BYTES_MOST ((size_t)1 << 26) /* at most: then they are written at once */

/* Records are written if the last writing is this many seconds ago, which is what a killed run loses at most; but not before it is
   FLUSH_SHARE times as long ago as it took, so that writing takes at most 2 % of the run */
#define FLUSH_INTERVAL 2.0
#define FLUSH_SHARE    50.0

struct _n_History {
  char           path[PETSC_MAX_PATH_LEN];
  PetscBool      writes; /* this is rank 0; the members below are used there alone */
  PetscBool      failed; /* the file could not be written, and is as it was before */
  char          *options;
  PetscInt       n_bodies, *dims; /* space dimension of each body */
  PetscBool     *damped;          /* per body: it has Rayleigh damping */
  PetscBool      friction;        /* contact has friction */
  PetscBool      springs;         /* contact has penalty springs, or glue */
  PetscBool      breaks;          /* glue that may break */
  PetscBool      takes;           /* contact takes energy by its rule */
  PetscBool     *plastic;         /* per body: its material flows */
  PetscBool     *hourglasses;     /* per body: its elements have one point */
  PetscBool     *rigid;           /* per body */
  Units          units;
  PetscInt       n_series, width;
  Series        *series;
  PetscInt       n_records, capacity;
  PetscReal     *records;                /* those that are not in the file yet, `width` numbers each */
  PetscInt64     written;                /* records in the file */
  PetscBool      goes_on;                /* the file is that of the run that is continued, see HistoryTakeUp() */
  int            held;                   /* the file, see OutputFilePlace() */
  PetscLogDouble flushed, flush_seconds; /* when the last flush ended, and how long it took [s] */
};

/* Adds a series, whose numbers come behind those of the others in a record; its name is "<group><of>/<what>" */
static PetscErrorCode AddSeries(History history, const char group[], const char of[], const char what[], UnitDimension dimension,
                                PetscInt components)
{
  Series *series = &history->series[history->n_series++];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(series->name, sizeof(series->name), "%s%s%s%s", group, of, what[0] ? "/" : "", what));
  series->units      = UnitsLabel(history->units, dimension);
  series->column     = history->width;
  series->components = components;
  series->integer    = (PetscBool)(dimension == UNIT_ONE); /* what has no dimension is a count */
  history->width += components;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The series of a run, in the order in which HistoryMonitor() fills a record */
static PetscErrorCode AddAllSeries(History history, Controller controller)
{
  const Body              *bodies;
  const char              *name, *reason;
  Contact                  contact;
  PetscInt                 n_pairs, n_supports, n_probes;
  const ControllerSupport *supports;
  const ControllerProbe   *probes;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, &history->n_bodies, &bodies));
  PetscCall(ControllerGetSupports(controller, &n_supports, &supports));
  PetscCall(ControllerGetProbes(controller, &n_probes, &probes));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ContactGetNumPairs(contact, &n_pairs));
  PetscCall(PetscMalloc5(history->n_bodies, &history->dims, history->n_bodies, &history->damped, history->n_bodies, &history->plastic,
                         history->n_bodies, &history->hourglasses, history->n_bodies, &history->rigid));
  PetscCall(ContactHasLaw(contact, CONTACT_LAW_FRICTION, &history->friction));
  PetscCall(PetscObjectTypeCompare((PetscObject)contact, CONTACT_PENALTY, &history->springs));
  if (!history->springs) PetscCall(ContactHasLaw(contact, CONTACT_LAW_GLUE, &history->springs));
  PetscCall(ContactGlueBreaks(contact, &history->breaks));
  PetscCall(ContactGetLossReason(contact, &reason));
  history->takes = (PetscBool)(reason != NULL);
  PetscCall(PetscCalloc1(7 + 10 * n_pairs + 14 * history->n_bodies + 2 * n_supports + 4 * n_probes, &history->series));
  PetscCall(AddSeries(history, "/time", "", "", UNIT_TIME, 1));
  PetscCall(AddSeries(history, "/schwarz", "", "iterations", UNIT_ONE, 1));
  PetscCall(AddSeries(history, "/energy", "", "change", UNIT_ENERGY, 1));
  PetscCall(AddSeries(history, "/energy", "", "scale", UNIT_ENERGY, 1));
  if (history->springs) PetscCall(AddSeries(history, "/penalty_energy", "", "", UNIT_ENERGY, 1));
  if (history->breaks) PetscCall(AddSeries(history, "/glue_loss", "", "", UNIT_ENERGY, 1));
  if (history->takes) PetscCall(AddSeries(history, "/contact_loss", "", "", UNIT_ENERGY, 1));
  for (PetscInt i = 0; i < n_pairs; i++) {
    PetscCall(ContactGetPair(contact, i, &name, NULL, NULL));
    PetscCall(AddSeries(history, "/contact/", name, "force", UNIT_FORCE, 1));
    PetscCall(AddSeries(history, "/contact/", name, "gap", UNIT_LENGTH, 1));
    PetscCall(AddSeries(history, "/contact/", name, "active", UNIT_ONE, 1));
    PetscCall(AddSeries(history, "/contact/", name, "area", UNIT_AREA, 1));
    PetscCall(AddSeries(history, "/contact/", name, "force_vector", UNIT_FORCE, 3));
    PetscCall(AddSeries(history, "/contact/", name, "moment", UNIT_MOMENT, 3));
    PetscCall(AddSeries(history, "/contact/", name, "impulse", UNIT_IMPULSE, 3));
    if (!history->friction) continue;
    PetscCall(AddSeries(history, "/contact/", name, "friction_loss", UNIT_ENERGY, 1));
    PetscCall(AddSeries(history, "/contact/", name, "obstacle_work", UNIT_ENERGY, 1));
    PetscCall(AddSeries(history, "/contact/", name, "sliding", UNIT_ONE, 1));
  }
  for (PetscInt i = 0; i < history->n_bodies; i++) {
    PetscInt *dim = &history->dims[i];
    PetscReal mass, stiffness;

    PetscCall(PetscObjectGetName((PetscObject)bodies[i], &name));
    PetscCall(BodyGetDimension(bodies[i], dim));
    PetscCall(AddSeries(history, "/body/", name, "kinetic", UNIT_ENERGY, 1));
    PetscCall(AddSeries(history, "/body/", name, "potential", UNIT_ENERGY, 1));
    PetscCall(AddSeries(history, "/body/", name, "contact_position", UNIT_LENGTH, *dim));
    PetscCall(AddSeries(history, "/body/", name, "contact_velocity", UNIT_VELOCITY, *dim));
    PetscCall(AddSeries(history, "/body/", name, "mean_velocity", UNIT_VELOCITY, *dim));
    PetscCall(AddSeries(history, "/body/", name, "external_work", UNIT_ENERGY, 1));
    PetscCall(AddSeries(history, "/body/", name, "momentum", UNIT_MOMENTUM, *dim));
    if (*dim > 1) PetscCall(AddSeries(history, "/body/", name, "angular_momentum", UNIT_ANGULAR_MOMENTUM, 3));
    PetscCall(BodyGetDamping(bodies[i], &mass, &stiffness));
    history->damped[i] = (PetscBool)(mass > 0 || stiffness > 0);
    if (history->damped[i]) PetscCall(AddSeries(history, "/body/", name, "damping_work", UNIT_ENERGY, 1));
    PetscCall(BodyHasHistory(bodies[i], &history->plastic[i]));
    if (history->plastic[i]) PetscCall(AddSeries(history, "/body/", name, "plastic_work", UNIT_ENERGY, 1));
    PetscCall(BodyHasHourglasses(bodies[i], &history->hourglasses[i]));
    if (history->hourglasses[i]) PetscCall(AddSeries(history, "/body/", name, "hourglass_energy", UNIT_ENERGY, 1));
    PetscCall(BodyIsRigid(bodies[i], &history->rigid[i]));
    if (!history->rigid[i]) continue;
    PetscCall(AddSeries(history, "/body/", name, "centre", UNIT_LENGTH, *dim));
    if (*dim > 1) PetscCall(AddSeries(history, "/body/", name, "rotation", UNIT_ANGLE, 3));
    if (*dim > 1) PetscCall(AddSeries(history, "/body/", name, "angular_velocity", UNIT_ANGULAR_VELOCITY, 3));
  }
  for (PetscInt i = 0; i < n_supports; i++) {
    const ControllerSupport *support = &supports[i];
    char                     group[128];

    if (support->body >= 0) {
      PetscCall(PetscObjectGetName((PetscObject)bodies[support->body], &name));
      PetscCall(PetscSNPrintf(group, sizeof(group), "/body/%s/reaction/", name));
    } else PetscCall(PetscSNPrintf(group, sizeof(group), "/obstacle/"));
    PetscCall(AddSeries(history, group, support->name, support->body >= 0 ? "force" : "reaction/force", UNIT_FORCE, 3));
    PetscCall(AddSeries(history, group, support->name, support->body >= 0 ? "moment" : "reaction/moment", UNIT_MOMENT, 3));
  }
  for (PetscInt i = 0; i < n_probes; i++) {
    const PetscInt dim = history->dims[probes[i].body];
    char           group[128], number[16];

    PetscCall(PetscObjectGetName((PetscObject)bodies[probes[i].body], &name));
    PetscCall(PetscSNPrintf(group, sizeof(group), "/body/%s/probe/", name));
    PetscCall(PetscSNPrintf(number, sizeof(number), "%" PetscInt_FMT, probes[i].number));
    PetscCall(AddSeries(history, group, number, "position", UNIT_LENGTH, dim));
    PetscCall(AddSeries(history, group, number, "displacement", UNIT_LENGTH, dim));
    PetscCall(AddSeries(history, group, number, "velocity", UNIT_VELOCITY, dim));
    PetscCall(AddSeries(history, group, number, "stress", UNIT_STRESS, 6));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  HistoryCreate - a history of a run, with all options of the run

  Collective

  Input Parameters:
+ controller - the `Controller`, set up
- path       - the file to write; an error if that cannot be done, on every rank

  Output Parameter:
. history - the `History`; HistoryMonitor() must be called with it after every step
*/
PetscErrorCode HistoryCreate(Controller controller, const char path[], History *history)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)controller);
  PetscMPIInt rank;
  History     h;

  PetscFunctionBegin;
  PetscCall(OutputFileCheck(comm, "-output_history", path));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscNew(&h));
  h->held   = -1;
  h->writes = rank ? PETSC_FALSE : PETSC_TRUE;
  PetscCall(PetscStrncpy(h->path, path, sizeof(h->path)));
  if (h->writes) {
    PetscCall(PetscOptionsGetAll(NULL, &h->options));
    PetscCall(UnitsGet((PetscObject)controller, &h->units));
    PetscCall(AddAllSeries(h, controller));
    h->capacity = 1 + (PetscInt)(BUFFER_BYTES / (h->width * sizeof(PetscReal)));
    PetscCall(PetscMalloc1(h->capacity * h->width, &h->records));
  }
  *history = h;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the next version of the file, see OutputFileWrite() */
static PetscErrorCode WritePart(const char part[], void *ctx)
{
  History history = (History)ctx;

  PetscFunctionBegin;
  if (history->written) PetscCall(OutputFileCopy(history->held, part));
  else PetscCall(SeriesFileCreate(part, history->n_series, history->series, history->options));
  if (access(part, F_OK)) PetscFunctionReturn(PETSC_SUCCESS); /* it has vanished */
  PetscCall(
      SeriesFileAppend(part, history->n_series, history->series, history->written, history->n_records, history->width, history->records));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  HistoryFlush - adds what was recorded since the last time to the file, and writes it again where somebody has taken it away

  Not Collective

  Input Parameter:
. history - the `History`

  Note:
  At every moment the file is whole: it is the version before or after this call, never something in between.
*/
PetscErrorCode HistoryFlush(History history)
{
  PetscErrorCode error;
  PetscLogDouble begin;
  HDF5Silence    silence;

  PetscFunctionBegin;
  if (!history->writes) PetscFunctionReturn(PETSC_SUCCESS);
  if (!history->n_records) {
    PetscCall(OutputFileRestore(history->held, history->path));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscTime(&begin));
  HDF5SilenceBegin(&silence);
  error           = OutputFileWrite(history->path, WritePart, history, &history->held);
  history->failed = (PetscBool)(error != PETSC_SUCCESS);
  PetscCall(error);
  HDF5SilenceEnd(&silence);
  history->written += history->n_records;
  history->n_records = 0;
  PetscCall(PetscTime(&history->flushed));
  history->flush_seconds = history->flushed - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for one more record: enlarges the buffer, or empties it */
static PetscErrorCode MakeRoom(History history)
{
  const size_t record = (size_t)history->width * sizeof(PetscReal);

  PetscFunctionBegin;
  if ((size_t)history->capacity * record < BUFFER_BYTES_MOST) {
    history->capacity *= 2;
    PetscCall(PetscRealloc((size_t)history->capacity * record, &history->records));
  } else PetscCall(HistoryFlush(history));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fills a record, in the order of AddAllSeries() */
static void FillRecord(const ControllerFrame *frame, History history, PetscReal *next)
{
  *next++ = frame->time;
  *next++ = (PetscReal)frame->sweeps;
  *next++ = frame->energy_change;
  *next++ = frame->energy_scale;
  if (history->springs) *next++ = frame->penalty_energy;
  if (history->breaks) *next++ = frame->glue_loss;
  if (history->takes) *next++ = frame->contact_loss;
  for (PetscInt i = 0; i < frame->n_pairs; i++) {
    *next++ = frame->pairs[i].force;
    *next++ = frame->pairs[i].gap;
    *next++ = (PetscReal)frame->pairs[i].active;
    *next++ = frame->pairs[i].area;
    for (PetscInt d = 0; d < 3; d++) *next++ = frame->pairs[i].force_vector[d];
    for (PetscInt d = 0; d < 3; d++) *next++ = frame->pairs[i].moment[d];
    for (PetscInt d = 0; d < 3; d++) *next++ = frame->pairs[i].impulse[d];
    if (!history->friction) continue;
    *next++ = frame->pairs[i].friction_loss;
    *next++ = frame->pairs[i].obstacle_work;
    *next++ = (PetscReal)frame->pairs[i].sliding;
  }
  for (PetscInt i = 0; i < frame->n_bodies; i++) {
    *next++ = frame->bodies[i].kinetic;
    *next++ = frame->bodies[i].potential;
    for (PetscInt d = 0; d < history->dims[i]; d++) *next++ = frame->contact_positions[3 * i + d];
    for (PetscInt d = 0; d < history->dims[i]; d++) *next++ = frame->contact_velocities[3 * i + d];
    for (PetscInt d = 0; d < history->dims[i]; d++) *next++ = frame->bodies[i].mean_velocity[d];
    *next++ = frame->bodies[i].external_work;
    for (PetscInt d = 0; d < history->dims[i]; d++) *next++ = frame->bodies[i].momentum[d];
    for (PetscInt d = 0; d < 3 && history->dims[i] > 1; d++) *next++ = frame->bodies[i].angular_momentum[d];
    if (history->damped[i]) *next++ = frame->bodies[i].damping_work;
    if (history->plastic[i]) *next++ = frame->bodies[i].plastic_work;
    if (history->hourglasses[i]) *next++ = frame->bodies[i].hourglass_energy;
    if (!history->rigid[i]) continue;
    for (PetscInt d = 0; d < history->dims[i]; d++) *next++ = frame->bodies[i].place[d];
    for (PetscInt d = 0; d < 3 && history->dims[i] > 1; d++) *next++ = frame->bodies[i].orientation[d];
    for (PetscInt d = 0; d < 3 && history->dims[i] > 1; d++) *next++ = frame->bodies[i].angular_velocity[d];
  }
  for (PetscInt i = 0; i < frame->n_supports; i++) {
    for (PetscInt d = 0; d < 3; d++) *next++ = frame->supports[i].force[d];
    for (PetscInt d = 0; d < 3; d++) *next++ = frame->supports[i].moment[d];
  }
  for (PetscInt i = 0; i < frame->n_probes; i++) {
    const ControllerProbe *probe = &frame->probes[i];

    for (PetscInt d = 0; d < history->dims[probe->body]; d++) *next++ = probe->position[d];
    for (PetscInt d = 0; d < history->dims[probe->body]; d++) *next++ = probe->displacement[d];
    for (PetscInt d = 0; d < history->dims[probe->body]; d++) *next++ = probe->velocity[d];
    for (PetscInt k = 0; k < 6; k++) *next++ = probe->stress[k];
  }
}

/*
  HistoryMonitor - records a controller step, and from time to time writes to the file

  Logically Collective

  Input Parameters:
+ controller - the `Controller`
. frame      - the state of everything
- context    - the `History`
*/
PetscErrorCode HistoryMonitor(Controller controller, const ControllerFrame *frame, void *context)
{
  History        history = (History)context;
  PetscLogDouble now;

  PetscFunctionBegin;
  (void)controller;
  if (!history->writes) PetscFunctionReturn(PETSC_SUCCESS);
  if (history->n_records == history->capacity) PetscCall(MakeRoom(history));
  FillRecord(frame, history, history->records + history->n_records * history->width);
  history->n_records++;
  PetscCall(PetscTime(&now));
  if (!history->written || now - history->flushed > PetscMax(FLUSH_INTERVAL, FLUSH_SHARE * history->flush_seconds))
    PetscCall(HistoryFlush(history));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  HistorySync - writes all that was recorded, through to the disk

  Not Collective

  Input Parameter:
. history - the `History`
*/
PetscErrorCode HistorySync(History history)
{
  PetscFunctionBegin;
  PetscCall(HistoryFlush(history));
  PetscCall(OutputFileSync(history->held, history->path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes what there was at the checkpoint of a file that has more, see OutputFileWrite() */
static PetscErrorCode WriteCut(const char part[], void *ctx)
{
  History history = (History)ctx;

  PetscFunctionBegin;
  PetscCall(OutputFileCopy(history->held, part));
  PetscCall(SeriesFileCut(part, history->n_series, history->series, history->written));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  HistoryTakeUp - cuts the file of the run that is continued at its checkpoint, once all of that has been loaded

  Not Collective

  Input Parameter:
. history - the `History`, after HistoryVisit(); `NULL`: there is none

  Note:
  Does nothing where the history begins with the run.
*/
PetscErrorCode HistoryTakeUp(History history)
{
  HDF5Silence silence;

  PetscFunctionBegin;
  if (!history || !history->goes_on) PetscFunctionReturn(PETSC_SUCCESS);
  history->goes_on = PETSC_FALSE;
  PetscCheck(!access(history->path, F_OK), PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN,
             "-output_history %s: the run that is continued has written it, and it is gone; bring it back, or give another path, where the "
             "history begins with the restart",
             history->path);
  PetscCall(OutputFileHold(history->path, &history->held));
  HDF5SilenceBegin(&silence);
  PetscCall(OutputFileWrite(history->path, WriteCut, history, &history->held));
  HDF5SilenceEnd(&silence);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  HistoryVisit - the place in the file, to or from a checkpoint; loading, HistoryTakeUp() is to follow

  Not Collective

  Input Parameters:
+ history    - the `History`; writing, after HistorySync()
- checkpoint - the `Checkpoint`

  Note:
  A history whose path is not that of the run that is continued begins with the restart.
*/
PetscErrorCode HistoryVisit(History history, Checkpoint checkpoint)
{
  PetscInt64 written = history ? history->written : 0;
  PetscBool  same;

  PetscFunctionBegin;
  PetscCall(OutputPathVisit(history ? history->path : NULL, "history", checkpoint, &same));
  PetscCall(CheckpointVisitInt64s(checkpoint, "history records", 1, &written));
  if (!CheckpointLoads(checkpoint) || !history || !history->writes || !same) PetscFunctionReturn(PETSC_SUCCESS);
  history->written = written;
  history->goes_on = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* HistoryGetPath - where the file is */
PetscErrorCode HistoryGetPath(History history, const char *path[])
{
  PetscFunctionBegin;
  *path = history->path;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* HistoryDestroy - writes what is left, unless writing has failed before, and frees a history */
PetscErrorCode HistoryDestroy(History *history)
{
  PetscFunctionBegin;
  if (!*history) PetscFunctionReturn(PETSC_SUCCESS);
  if (!(*history)->failed) PetscCall(HistoryFlush(*history));
  PetscCall(PetscFree((*history)->options));
  PetscCall(PetscFree5((*history)->dims, (*history)->damped, (*history)->plastic, (*history)->hourglasses, (*history)->rigid));
  PetscCall(PetscFree((*history)->series));
  PetscCall(PetscFree((*history)->records));
  PetscCall(OutputFileRelease(&(*history)->held));
  PetscCall(PetscFree(*history));
  PetscFunctionReturn(PETSC_SUCCESS);
}
