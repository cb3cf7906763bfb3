/* Where a body's mesh lies: scale, rotation and translation from options. */
#include "meshimpl.h"
#include <sys/units.h>

/* A mesh that is smaller than this part of its distance from the origin has lost the digits that its coordinates need */
#define SMALLEST_EXTENT 1e-9
/* Sines of larger angles have lost digits [degrees] */
#define LARGEST_ANGLE 1e6
/* No solid is smaller than an atom, 1e-10 m, or larger than a star, 1e12 m, of which those who compute in kilometres or in nanometres give
   1e-13 and 1e21. What lies beyond is a mistake, with which the run would go through in figures without a sense: gaps are 1e30 where
   nothing lies opposite, and products of volumes of elements leave the range of double precision from 1e-45 m on. */
#define SMALLEST_SIZE 1e-15
#define LARGEST_SIZE  1e22

typedef struct {
  PetscReal scale, rotation[3][3];
  PetscReal centre[3], shift[3]; /* [m] */
} Motion;

/* Reads an option that must have as many numbers as expected, at most four; `values` must have room for four */
PetscErrorCode MeshReadNumbers(MPI_Comm comm, const char prefix[], const char option[], PetscInt expected, const char meaning[],
                               PetscReal values[], PetscBool *set)
{
  PetscInt n = 4;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetRealArray(NULL, prefix, option, values, &n, set));
  PetscCheck(!*set || n == expected, comm, PETSC_ERR_USER_INPUT,
             "-%s%s has %" PetscInt_FMT " numbers, where %" PetscInt_FMT " are expected: %s", prefix, option + 1, n, expected, meaning);
  for (PetscInt i = 0; *set && i < n; i++)
    PetscCheck(!PetscIsInfOrNanReal(values[i]), comm, PETSC_ERR_USER_INPUT, "-%s%s: %g is no finite number", prefix, option + 1,
               (double)values[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rodrigues' formula: R = cos I + sin [a]x + (1 - cos) a a^T, with the unit vector a of the axis */
static void Rotation(const PetscReal axis[3], PetscReal degrees, PetscReal R[3][3])
{
  const PetscReal angle = degrees * PETSC_PI / 180, size = PetscSqrtReal(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  const PetscReal a[3] = {axis[0] / size, axis[1] / size, axis[2] / size}, c = PetscCosReal(angle), s = PetscSinReal(angle);
  const PetscReal w[3][3] = {{0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};

  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) R[i][j] = (i == j ? c : 0) + s * w[i][j] + (1 - c) * a[i] * a[j];
}

static PetscErrorCode ReadMotion(MPI_Comm comm, const char prefix[], const char name[], PetscInt dim, Motion *motion, PetscBool *moves)
{
  PetscReal values[4], axis[3] = {0, 0, 1};
  PetscBool scale, rotate, centre, translate;

  PetscFunctionBegin;
  *motion = (Motion){.scale = 1, .rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  PetscCall(MeshReadNumbers(comm, prefix, "-scale", 1, "a factor for all coordinates", values, &scale));
  if (scale) motion->scale = values[0];
  PetscCheck(motion->scale > 0, comm, PETSC_ERR_USER_INPUT, "-%sscale %g: the factor must be positive", prefix, (double)motion->scale);
  PetscCall(MeshReadNumbers(comm, prefix, "-rotate", dim == 3 ? 4 : 1, dim == 3 ? "axis and degrees" : "degrees", values, &rotate));
  PetscCheck(!rotate || dim > 1, comm, PETSC_ERR_USER_INPUT, "-%srotate: body '%s' is one-dimensional and cannot be rotated", prefix, name);
  if (rotate) {
    if (dim == 3)
      for (PetscInt d = 0; d < 3; d++) axis[d] = values[d];
    PetscCheck(axis[0] != 0 || axis[1] != 0 || axis[2] != 0, comm, PETSC_ERR_USER_INPUT,
               "-%srotate: the axis is (0, 0, 0), which has no direction", prefix);
    PetscCheck(PetscAbsReal(values[dim == 3 ? 3 : 0]) <= LARGEST_ANGLE, comm, PETSC_ERR_USER_INPUT,
               "-%srotate: %g degrees are out of all proportion; give an angle between -360 and 360", prefix,
               (double)values[dim == 3 ? 3 : 0]);
    Rotation(axis, values[dim == 3 ? 3 : 0], motion->rotation);
  }
  PetscCall(MeshReadNumbers(comm, prefix, "-rotate_centre", dim, "a point [m]", motion->centre, &centre));
  PetscCheck(!centre || rotate, comm, PETSC_ERR_USER_INPUT, "-%srotate_centre without -%srotate has no effect", prefix, prefix);
  PetscCall(MeshReadNumbers(comm, prefix, "-translate", dim, "one for each dimension of the body [m]", motion->shift, &translate));
  *moves = (PetscBool)(scale || rotate || translate);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a mesh has a size and a place that can be; blames the placement for what that does to it, rather than the mesh later on */
static PetscErrorCode CheckPlace(DM dm, const char prefix[], const char name[], const Motion *motion, Vec coordinates)
{
  MPI_Comm           comm       = PetscObjectComm((PetscObject)dm);
  PetscReal          extreme[6] = {PETSC_MIN_REAL, PETSC_MIN_REAL, PETSC_MIN_REAL, PETSC_MIN_REAL, PETSC_MIN_REAL, PETSC_MIN_REAL};
  PetscReal          size = 0, distance = 0;
  const PetscScalar *x;
  PetscInt           n, dim;

  PetscFunctionBegin;
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(VecGetLocalSize(coordinates, &n));
  PetscCall(VecGetArrayRead(coordinates, &x));
  for (PetscInt i = 0; i < n; i++) {
    extreme[i % dim]     = PetscMax(extreme[i % dim], PetscRealPart(x[i]));
    extreme[3 + i % dim] = PetscMax(extreme[3 + i % dim], -PetscRealPart(x[i]));
  }
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, extreme, 6, MPIU_REAL, MPI_MAX, comm));
  for (PetscInt d = 0; d < dim; d++) {
    size     = PetscMax(size, extreme[d] + extreme[3 + d]);
    distance = PetscMax(distance, PetscMax(PetscAbsReal(extreme[d]), PetscAbsReal(extreme[3 + d])));
  }
  PetscCheck(
      size >= SMALLEST_EXTENT * distance, comm, PETSC_ERR_USER_INPUT,
      "Body '%s' is %g%s large and lies %g%s from the origin, also by -%stranslate and -%srotate_centre: so far away its coordinates do "
      "not have the digits that its elements need",
      name, (double)size, UnitsOf((PetscObject)dm, UNIT_LENGTH), (double)distance, UnitsOf((PetscObject)dm, UNIT_LENGTH), prefix, prefix);
  PetscCheck((size >= SMALLEST_SIZE && size <= LARGEST_SIZE) || motion->scale == 1, comm, PETSC_ERR_USER_INPUT,
             "Body '%s' is %g%s large after -%sscale %g: choose a factor that leaves it between %g and %g%s", name, (double)size,
             UnitsOf((PetscObject)dm, UNIT_LENGTH), prefix, (double)motion->scale, SMALLEST_SIZE, LARGEST_SIZE,
             UnitsOf((PetscObject)dm, UNIT_LENGTH));
  PetscCheck(size >= SMALLEST_SIZE && size <= LARGEST_SIZE, comm, PETSC_ERR_USER_INPUT,
             "Body '%s' is %g%s large: its mesh must be between %g and %g%s, also by -%sscale", name, (double)size,
             UnitsOf((PetscObject)dm, UNIT_LENGTH), SMALLEST_SIZE, LARGEST_SIZE, UnitsOf((PetscObject)dm, UNIT_LENGTH), prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Move(const Motion *motion, PetscInt dim, Vec coordinates)
{
  PetscScalar *x;
  PetscInt     n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(coordinates, &n));
  PetscCall(VecGetArray(coordinates, &x));
  for (PetscInt p = 0; p < n; p += dim) {
    PetscReal arm[3] = {0};

    for (PetscInt d = 0; d < dim; d++) arm[d] = motion->scale * PetscRealPart(x[p + d]) - motion->centre[d];
    for (PetscInt d = 0; d < dim; d++) {
      PetscReal sum = motion->centre[d] + motion->shift[d];

      for (PetscInt k = 0; k < dim; k++) sum += motion->rotation[d][k] * arm[k];
      x[p + d] = sum;
    }
  }
  PetscCall(VecRestoreArray(coordinates, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Scales a mesh about the origin, then rotates it about its centre of rotation, then shifts it */
PetscErrorCode MeshPlace(DM dm, const char prefix[], const char name[])
{
  Motion    motion;
  PetscInt  dim;
  PetscBool moves = PETSC_FALSE;
  Vec       coordinates;

  PetscFunctionBegin;
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(ReadMotion(PetscObjectComm((PetscObject)dm), prefix, name, dim, &motion, &moves));
  PetscCall(DMGetCoordinatesLocal(dm, &coordinates));
  if (moves) PetscCall(Move(&motion, dim, coordinates));
  PetscCall(CheckPlace(dm, prefix, name, &motion, coordinates));
  if (!moves) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMSetCoordinatesLocal(dm, coordinates)); /* this drops the global coordinates, which have not been moved */
  PetscCall(DMGetCellCoordinatesLocal(dm, &coordinates));
  if (coordinates) {
    PetscCall(Move(&motion, dim, coordinates));
    PetscCall(DMSetCellCoordinatesLocal(dm, coordinates));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The option, without dash and prefix, by which a user moves the mesh of a body, for messages: `translate` of a mesh from a file, of a
   rod, and of any mesh that has been scaled, rotated or translated; `ball_centre` of a ball; `dm_plex_box_lower` of a box; or NULL.
   `keeps`: the option by which nodes of a ball or a rod lie outside its radius, so that its mesh has its volume; or NULL */
PetscErrorCode MeshGetPlaceOption(const char prefix[], const char *option[], const char *keeps[])
{
  const char *const placed[]  = {"-dm_plex_filename", "-scale", "-rotate", "-translate"}, *volume;
  PetscBool         is_placed = PETSC_FALSE, is_rod, is_ball, keeps_it = PETSC_TRUE;
  char              name[32];

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(placed) && !is_placed; i++)
    PetscCall(PetscOptionsHasName(NULL, prefix, placed[i], &is_placed));
  PetscCall(MeshHasShape(prefix, "rod", &is_rod));
  PetscCall(MeshHasShape(prefix, "ball", &is_ball));
  if (option) *option = is_placed || is_rod ? "translate" : is_ball ? "ball_centre" : "dm_plex_box_lower";
  if (!keeps) PetscFunctionReturn(PETSC_SUCCESS);
  volume = is_rod ? "rod_keep_volume" : "ball_keep_volume";
  PetscCall(PetscSNPrintf(name, sizeof(name), "-%s", volume));
  PetscCall(PetscOptionsGetBool(NULL, prefix, name, &keeps_it, NULL));
  *keeps = (is_rod || is_ball) && keeps_it ? volume : NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MeshHasShape(const char prefix[], const char shape[], PetscBool *has)
{
  char given[64] = "";

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-dm_plex_shape", given, sizeof(given), NULL));
  PetscCall(PetscStrcasecmp(given, shape, has));
  PetscFunctionReturn(PETSC_SUCCESS);
}
