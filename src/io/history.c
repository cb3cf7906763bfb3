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
#include <impakt/private/bodymeasures.h>

#define BUFFER_BYTES      ((size_t)1 << 16) /* of records that wait for writing, at first */
#define BUFFER_BYTES_MOST ((size_t)1 << 26) /* at most: then they are written at once */

/* Records are written if the last writing is this many seconds ago, which is what a killed run loses at most; but not before it is
   FLUSH_SHARE times as long ago as it took, so that writing takes at most 2 % of the run */
#define FLUSH_INTERVAL 2.0
#define FLUSH_SHARE    50.0

/* Who has a quantity in a frame */
typedef enum { OF_RUN, OF_PAIR, OF_BODY, OF_CONTACT_POSITION, OF_CONTACT_VELOCITY, OF_SUPPORT, OF_PROBE } Owner;

/* What the owner needs to have a quantity */
enum { SPRINGS = 1, BREAKS = 2, TAKES = 4, FRICTION = 8, IN_PLANE = 16, DAMPED = 32, PLASTIC = 64, HOURGLASSES = 128, RIGID = 256 };

typedef struct {
  const char   *name; /* behind that of its owner */
  UnitDimension dimension;
  PetscInt      components; /* 0: as many as the space of the body has dimensions */
  Owner         owner;
  size_t        offset; /* of the number or numbers in what the owner has in a frame */
  int           needs;
} Quantity;

/* What the history has, in the order of a record */
static const Quantity of_run[] = {
    {"/time", UNIT_TIME, 1, OF_RUN, offsetof(ControllerFrame, time), 0},
    {"/schwarz/iterations", UNIT_ONE, 1, OF_RUN, offsetof(ControllerFrame, sweeps), 0},
    {"/energy/change", UNIT_ENERGY, 1, OF_RUN, offsetof(ControllerFrame, energy_change), 0},
    {"/energy/scale", UNIT_ENERGY, 1, OF_RUN, offsetof(ControllerFrame, energy_scale), 0},
    {"/penalty_energy", UNIT_ENERGY, 1, OF_RUN, offsetof(ControllerFrame, penalty_energy), SPRINGS},
    {"/glue_loss", UNIT_ENERGY, 1, OF_RUN, offsetof(ControllerFrame, glue_loss), BREAKS},
    {"/contact_loss", UNIT_ENERGY, 1, OF_RUN, offsetof(ControllerFrame, contact_loss), TAKES},
};
static const Quantity of_pair[] = {
    {"/force", UNIT_FORCE, 1, OF_PAIR, offsetof(ContactPairState, force), 0},
    {"/gap", UNIT_LENGTH, 1, OF_PAIR, offsetof(ContactPairState, gap), 0},
    {"/active", UNIT_ONE, 1, OF_PAIR, offsetof(ContactPairState, active), 0},
    {"/area", UNIT_AREA, 1, OF_PAIR, offsetof(ContactPairState, area), 0},
    {"/force_vector", UNIT_FORCE, 3, OF_PAIR, offsetof(ContactPairState, force_vector), 0},
    {"/moment", UNIT_MOMENT, 3, OF_PAIR, offsetof(ContactPairState, moment), 0},
    {"/impulse", UNIT_IMPULSE, 3, OF_PAIR, offsetof(ContactPairState, impulse), 0},
    {"/friction_loss", UNIT_ENERGY, 1, OF_PAIR, offsetof(ContactPairState, friction_loss), FRICTION},
    {"/obstacle_work", UNIT_ENERGY, 1, OF_PAIR, offsetof(ContactPairState, obstacle_work), FRICTION},
    {"/sliding", UNIT_ONE, 1, OF_PAIR, offsetof(ContactPairState, sliding), FRICTION},
};
static const Quantity of_body[] = {
    {"/kinetic", UNIT_ENERGY, 1, OF_BODY, offsetof(BodyMeasures, kinetic), 0},
    {"/potential", UNIT_ENERGY, 1, OF_BODY, offsetof(BodyMeasures, potential), 0},
    {"/contact_position", UNIT_LENGTH, 0, OF_CONTACT_POSITION, 0, 0},
    {"/contact_velocity", UNIT_VELOCITY, 0, OF_CONTACT_VELOCITY, 0, 0},
    {"/mean_velocity", UNIT_VELOCITY, 0, OF_BODY, offsetof(BodyMeasures, mean_velocity), 0},
    {"/external_work", UNIT_ENERGY, 1, OF_BODY, offsetof(BodyMeasures, external_work), 0},
    {"/momentum", UNIT_MOMENTUM, 0, OF_BODY, offsetof(BodyMeasures, momentum), 0},
    {"/angular_momentum", UNIT_ANGULAR_MOMENTUM, 3, OF_BODY, offsetof(BodyMeasures, angular_momentum), IN_PLANE},
    {"/damping_work", UNIT_ENERGY, 1, OF_BODY, offsetof(BodyMeasures, damping_work), DAMPED},
    {"/plastic_work", UNIT_ENERGY, 1, OF_BODY, offsetof(BodyMeasures, plastic_work), PLASTIC},
    {"/hourglass_energy", UNIT_ENERGY, 1, OF_BODY, offsetof(BodyMeasures, hourglass_energy), HOURGLASSES},
    {"/centre", UNIT_LENGTH, 0, OF_BODY, offsetof(BodyMeasures, place), RIGID},
    {"/rotation", UNIT_ANGLE, 3, OF_BODY, offsetof(BodyMeasures, orientation), RIGID | IN_PLANE},
    {"/angular_velocity", UNIT_ANGULAR_VELOCITY, 3, OF_BODY, offsetof(BodyMeasures, angular_velocity), RIGID | IN_PLANE},
};
static const Quantity of_support[] = {
    {"/force", UNIT_FORCE, 3, OF_SUPPORT, offsetof(ControllerSupport, force), 0},
    {"/moment", UNIT_MOMENT, 3, OF_SUPPORT, offsetof(ControllerSupport, moment), 0},
};
static const Quantity of_probe[] = {
    {"/position", UNIT_LENGTH, 0, OF_PROBE, offsetof(ControllerProbe, position), 0},
    {"/displacement", UNIT_LENGTH, 0, OF_PROBE, offsetof(ControllerProbe, displacement), 0},
    {"/velocity", UNIT_VELOCITY, 0, OF_PROBE, offsetof(ControllerProbe, velocity), 0},
    {"/stress", UNIT_STRESS, 6, OF_PROBE, offsetof(ControllerProbe, stress), 0},
};

#define COUNT(quantities) ((PetscInt)PETSC_STATIC_ARRAY_LENGTH(quantities))

/* Where a frame has the numbers of a series; apart from their names, since all are looked at in each step */
typedef struct {
  Owner     owner;
  PetscInt  index, components; /* of the owner; of the series */
  size_t    offset;
  PetscBool integer;
} Source;

struct _n_History {
  char           path[PETSC_MAX_PATH_LEN];
  PetscBool      writes; /* this is rank 0; the members below are used there alone */
  PetscBool      failed; /* the file could not be written, and is as it was before */
  char          *options;
  Units          units;
  PetscInt       n_series, width;
  Series        *series;
  Source        *sources; /* of each series */
  PetscInt       n_records, capacity;
  PetscReal     *records;                /* those that are not in the file yet, `width` numbers each */
  PetscInt64     written;                /* records in the file */
  PetscBool      goes_on;                /* the file is that of the run that is continued, see HistoryTakeUp() */
  int            held;                   /* the file, see OutputFilePlace() */
  PetscLogDouble flushed, flush_seconds; /* when the last flush ended, and how long it took [s] */
};

/* Adds those of n quantities that an owner has, behind one another in a record */
static PetscErrorCode AddSeries(History history, const char owner[], PetscInt n, const Quantity quantities[], PetscInt index, PetscInt dim,
                                int has)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    const Quantity *quantity = &quantities[i];
    Series         *series   = &history->series[history->n_series];

    if ((quantity->needs & has) != quantity->needs) continue;
    PetscCall(PetscSNPrintf(series->name, sizeof(series->name), "%s%s", owner, quantity->name));
    series->units      = UnitsLabel(history->units, quantity->dimension);
    series->column     = history->width;
    series->components = quantity->components ? quantity->components : dim;
    series->integer    = (PetscBool)(quantity->dimension == UNIT_ONE); /* what has no dimension is a count */
    history->width += series->components;
    history->sources[history->n_series++] = (Source){quantity->owner, index, series->components, quantity->offset, series->integer};
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What contact has of the quantities that not every run has */
static PetscErrorCode FindContactNeeds(Contact contact, int *has)
{
  ContactTraits traits;
  PetscBool     penalty;

  PetscFunctionBegin;
  PetscCall(ContactGetTraits(contact, &traits));
  PetscCall(PetscObjectTypeCompare((PetscObject)contact, CONTACT_PENALTY, &penalty));
  *has = (traits.friction ? FRICTION : 0) | (penalty || traits.glue ? SPRINGS : 0) | (traits.breaks ? BREAKS : 0) |
         (traits.takes ? TAKES : 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindBodyNeeds(Body body, PetscInt *dim, int *has)
{
  PetscReal mass, stiffness;
  PetscBool plastic, hourglasses, rigid;

  PetscFunctionBegin;
  PetscCall(BodyGetDimension(body, dim));
  PetscCall(BodyGetDamping(body, &mass, &stiffness));
  PetscCall(BodyHasHistory(body, &plastic));
  PetscCall(BodyHasHourglasses(body, &hourglasses));
  PetscCall(BodyIsRigid(body, &rigid));
  *has = (*dim > 1 ? IN_PLANE : 0) | (mass > 0 || stiffness > 0 ? DAMPED : 0) | (plastic ? PLASTIC : 0) | (hourglasses ? HOURGLASSES : 0) |
         (rigid ? RIGID : 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddAllSeries(History history, Controller controller)
{
  const Body              *bodies;
  const char              *name;
  char                     owner[192];
  Contact                  contact;
  PetscInt                 n_bodies, n_pairs, n_supports, n_probes, most, dim;
  const ControllerSupport *supports;
  const ControllerProbe   *probes;
  int                      has = 0;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, &n_bodies, &bodies));
  PetscCall(ControllerGetSupports(controller, &n_supports, &supports));
  PetscCall(ControllerGetProbes(controller, &n_probes, &probes));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ContactGetNumPairs(contact, &n_pairs));
  most = COUNT(of_run) + COUNT(of_pair) * n_pairs + COUNT(of_body) * n_bodies + COUNT(of_support) * n_supports + COUNT(of_probe) * n_probes;
  PetscCall(PetscCalloc2(most, &history->series, most, &history->sources));
  PetscCall(FindContactNeeds(contact, &has));
  PetscCall(AddSeries(history, "", COUNT(of_run), of_run, 0, 1, has));
  for (PetscInt i = 0; i < n_pairs; i++) {
    PetscCall(ContactGetPair(contact, i, &name, NULL, NULL));
    PetscCall(PetscSNPrintf(owner, sizeof(owner), "/contact/%s", name));
    PetscCall(AddSeries(history, owner, COUNT(of_pair), of_pair, i, 3, has));
  }
  for (PetscInt i = 0; i < n_bodies; i++) {
    PetscCall(FindBodyNeeds(bodies[i], &dim, &has));
    PetscCall(PetscObjectGetName((PetscObject)bodies[i], &name));
    PetscCall(PetscSNPrintf(owner, sizeof(owner), "/body/%s", name));
    PetscCall(AddSeries(history, owner, COUNT(of_body), of_body, i, dim, has));
  }
  for (PetscInt i = 0; i < n_supports; i++) {
    const ControllerSupport *support = &supports[i];

    if (support->body >= 0) {
      PetscCall(PetscObjectGetName((PetscObject)bodies[support->body], &name));
      PetscCall(PetscSNPrintf(owner, sizeof(owner), "/body/%s/reaction/%s", name, support->name));
    } else PetscCall(PetscSNPrintf(owner, sizeof(owner), "/obstacle/%s/reaction", support->name));
    PetscCall(AddSeries(history, owner, COUNT(of_support), of_support, i, 3, 0));
  }
  for (PetscInt i = 0; i < n_probes; i++) {
    PetscCall(BodyGetDimension(bodies[probes[i].body], &dim));
    PetscCall(PetscObjectGetName((PetscObject)bodies[probes[i].body], &name));
    PetscCall(PetscSNPrintf(owner, sizeof(owner), "/body/%s/probe/%" PetscInt_FMT, name, probes[i].number));
    PetscCall(AddSeries(history, owner, COUNT(of_probe), of_probe, i, dim, 0));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A history of a run, with all options of the run. Collective */
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

/* Adds what was recorded since the last time to the file, and writes it again where somebody has taken it away. At every moment the file
   is whole: it is the version before or after this call, never something in between */
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

static void FillRecord(const ControllerFrame *frame, History history, PetscReal *next)
{
  const struct {
    const void *first;
    size_t      size;
  } owners[] = {
      [OF_RUN]              = {frame, 0},
      [OF_PAIR]             = {frame->pairs, sizeof(*frame->pairs)},
      [OF_BODY]             = {frame->bodies, sizeof(*frame->bodies)},
      [OF_CONTACT_POSITION] = {frame->contact_positions, 3 * sizeof(PetscReal)},
      [OF_CONTACT_VELOCITY] = {frame->contact_velocities, 3 * sizeof(PetscReal)},
      [OF_SUPPORT]          = {frame->supports, sizeof(*frame->supports)},
      [OF_PROBE]            = {frame->probes, sizeof(*frame->probes)},
  };

  for (PetscInt s = 0; s < history->n_series; s++) {
    const Source *source = &history->sources[s];
    const void   *values = (const char *)owners[source->owner].first + owners[source->owner].size * (size_t)source->index + source->offset;

    for (PetscInt c = 0; c < source->components; c++)
      *next++ = source->integer ? (PetscReal)((const PetscInt *)values)[c] : ((const PetscReal *)values)[c];
  }
}

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

/* Writes all that was recorded, through to the disk */
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

/* Cuts the file of the run that is continued at its checkpoint, once all of that has been loaded. `history`: the `History`, after
   HistoryVisit(); `NULL`: there is none. Does nothing where the history begins with the run */
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

/* The place in the file, to or from a checkpoint; loading, HistoryTakeUp() follows. A history with another path begins anew */
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

/* HistoryDestroy - writes what is left, unless writing has failed before, and frees a history */
PetscErrorCode HistoryDestroy(History *history)
{
  PetscFunctionBegin;
  if (!*history) PetscFunctionReturn(PETSC_SUCCESS);
  if (!(*history)->failed) PetscCall(HistoryFlush(*history));
  PetscCall(PetscFree((*history)->options));
  PetscCall(PetscFree2((*history)->series, (*history)->sources));
  PetscCall(PetscFree((*history)->records));
  PetscCall(OutputFileRelease(&(*history)->held));
  PetscCall(PetscFree(*history));
  PetscFunctionReturn(PETSC_SUCCESS);
}
