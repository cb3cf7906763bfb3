/* Option hygiene: every option that is given must have been read by somebody. */
#include <impakt.h>
#include "names.h"
#include "optiontable.h"

/* These are read by PETSc when it solves or finalises, so they are unread before the run */
static const char *const late_options[] = {"schwarz_snes_view",
                                           "schwarz_snes_view_pre",
                                           "schwarz_snes_view_solution",
                                           "penalty_snes_view",
                                           "penalty_snes_view_pre",
                                           "penalty_snes_view_solution",
                                           "lagrange_snes_view",
                                           "lagrange_snes_view_pre",
                                           "lagrange_snes_view_solution",
                                           "options_left",
                                           "options_view",
                                           "malloc_dump",
                                           "malloc_view",
                                           "malloc_debug",
                                           "objects_dump",
                                           "memory_view",
                                           "log_view",
                                           "log_trace",
                                           "log_view_memory",
                                           "log_view_gpu_time",
                                           "log_nested",
                                           "get_total_flops",
                                           "mpidump",
                                           "citations",
                                           "petsc_mpi",
                                           "x_virtual",
                                           "on_error_abort",
                                           "on_error_mpiabort"};

/* Levenshtein's distance between two short words */
static PetscInt EditDistance(const char a[], const char b[])
{
  size_t   n, m;
  PetscInt row[129];

  if (PetscStrlen(a, &n) || PetscStrlen(b, &m) || n > 128 || m > 128) return 1000;
  for (size_t j = 0; j <= m; j++) row[j] = (PetscInt)j;
  for (size_t i = 1; i <= n; i++) {
    PetscInt diagonal = row[0];

    row[0] = (PetscInt)i;
    for (size_t j = 1; j <= m; j++) {
      const PetscInt above = row[j];

      row[j]   = PetscMin(PetscMin(row[j] + 1, row[j - 1] + 1), diagonal + (a[i - 1] != b[j - 1]));
      diagonal = above;
    }
  }
  return row[m];
}

/* The options of one kind, each behind a prefix, if one is nearer than what there is */
static PetscErrorCode FindNearestOf(const char name[], OptionOwner owner, const char prefix[], PetscInt *best, char nearest[], size_t size)
{
  const KnownOption *options;
  size_t             n;

  PetscFunctionBegin;
  options = KnownOptionsGet(&n);
  for (size_t i = 0; i < n; i++) {
    char     full[128];
    PetscInt distance;

    if (options[i].owner != owner) continue;
    PetscCall(PetscSNPrintf(full, sizeof(full), "%s%s%s", prefix, prefix[0] ? "_" : "", options[i].name));
    distance = EditDistance(name, full);
    if (distance >= *best) continue;
    *best = distance;
    PetscCall(PetscStrncpy(nearest, full, size));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindNearest(const char name[], PetscInt n_bodies, const char *const bodies[], char nearest[], size_t size)
{
  char   **obstacles;
  PetscInt best = 1000, n;

  PetscFunctionBegin;
  nearest[0] = 0;
  PetscCall(FindNearestOf(name, OPTION_OF_RUN, "", &best, nearest, size));
  for (PetscInt b = 0; b < n_bodies; b++) PetscCall(FindNearestOf(name, OPTION_OF_BODY, bodies[b], &best, nearest, size));
  PetscCall(NamesRead(NULL, "-obstacles", &n, &obstacles, NULL));
  for (PetscInt o = 0; o < n; o++) PetscCall(FindNearestOf(name, OPTION_OF_OBSTACLE, obstacles[o], &best, nearest, size));
  PetscCall(NamesDestroy(n, &obstacles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ImpaktCheckOptions - stops with an error if an option has been given that nobody has read

  Collective on `PETSC_COMM_WORLD`

  Input Parameters:
+ n      - number of bodies
- bodies - their names

  Level: developer

  Note:
  To be called when everything has been set up and nothing been computed. Names the nearest known option.

.seealso: `ImpaktPrintOptions()`
@*/
PetscErrorCode ImpaktCheckOptions(PetscInt n, const char *const bodies[])
{
  PetscInt n_left, unread = 0;
  char   **names, **values, message[1800] = "";

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &n_left, &names, &values));
  for (PetscInt i = 0; i < n_left; i++) {
    PetscBool late = PETSC_FALSE, known;
    char      nearest[128], reason[256], line[512];

    for (size_t k = 0; k < sizeof(late_options) / sizeof(late_options[0]) && !late; k++)
      PetscCall(PetscStrcmp(names[i], late_options[k], &late));
    if (late) continue;
    PetscCall(FindNearest(names[i], n, bodies, nearest, sizeof(nearest)));
    PetscCall(PetscStrcmp(names[i], nearest, &known));
    if (known) PetscCall(PetscSNPrintf(reason, sizeof(reason), "it goes with another method or type than the one chosen"));
    else PetscCall(PetscSNPrintf(reason, sizeof(reason), "the nearest known one is -%s", nearest));
    PetscCall(PetscSNPrintf(line, sizeof(line), "-%s%s%s (%s)", names[i], values[i] ? " " : "", values[i] ? values[i] : "", reason));
    PetscCall(NamesAppend(message, sizeof(message), ", ", line));
    unread++;
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &n_left, &names, &values));
  PetscCheck(!unread, PETSC_COMM_WORLD, PETSC_ERR_USER_INPUT,
             "Unknown option%s, or without effect here: %s. `impakt -help all` lists the options", unread == 1 ? "" : "s", message);
  PetscFunctionReturn(PETSC_SUCCESS);
}
