/* Option hygiene: every option that is given must have been read by somebody. */
#define _POSIX_C_SOURCE 200809L /* strcasecmp() */
#include <impakt.h>
#include <string.h>
#include <strings.h>
#include "names.h"
#include "optionstext.h"
#include "optionwords.h"
#include "overriddenlists.h"
#include "sharedoptions.h"

/* These are read by PETSc when it solves or finalises, so they are unread before the run */
static const char *const late_options[] = {"schwarz_snes_view",
                                           "schwarz_snes_view_pre",
                                           "schwarz_snes_view_solution",
                                           "law_snes_view",
                                           "law_snes_view_pre",
                                           "law_snes_view_solution",
                                           "law_nodes_snes_view",
                                           "law_nodes_snes_view_pre",
                                           "law_nodes_snes_view_solution",
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

/* Options that are gone, accepted for older options files, with what happens instead. Names that end in _ begin those of a solver, and
   names that begin with _ are of a body. */
static const struct {
  const char *name, *now;
} gone_options[] = {
    {"_mesh_bricks", "a box is cut such that a step costs least, as -<body>_mesh_contact_cost weighs its faces"},
    {"contact_friction_dense_limit", "matrices are as the bodies need them"},
    {"contact_surface_view", "-contact_view shows pairs and their rows"},
    {"contact_transfer_view", "-contact_view shows pairs and their rows"},
    {"lagrange_snes_", "forces are found as with -contact_type schwarz, whose options are -schwarz_snes_..."},
    {"penalty_snes_", "forces are found as with -contact_type schwarz, whose options are -schwarz_snes_..."},
    {"schwarz_condense", "sweeps advance the bodies themselves"},
    {"schwarz_convergence", "plain alternation is tested by positions, others by how far both sides are apart"},
    {"schwarz_dense_limit", "matrices are as the bodies need them"},
    {"schwarz_interface_", "there is no such solver"},
    {"schwarz_recheck", "nodes that are pulled always leave contact within the step"},
    {"schwarz_sweep", "in each sweep the second body of a pair takes the reactions of the first, as with multiplicative"},
};

/* Warns of an option that is gone, and counts it as read */
static PetscErrorCode AcceptGone(const char name[], const char value[], PetscBool *gone)
{
  PetscFunctionBegin;
  *gone = PETSC_FALSE;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(gone_options) && !*gone; k++) {
    const size_t length = strlen(gone_options[k].name), whole = strlen(name);
    const char  *at = gone_options[k].name[0] == '_' && whole > length ? name + whole - length : name;
    char         option[PETSC_MAX_OPTION_NAME];

    if (strncasecmp(at, gone_options[k].name, length) != 0 || (at[length] && at[length - 1] != '_')) continue;
    PetscCall(PetscSNPrintf(option, sizeof(option), "-%s", name));
    PetscCall(PetscOptionsHasName(NULL, NULL, option, gone));
    PetscCall(PetscFPrintf(PETSC_COMM_WORLD, stderr, "impakt: warning: %s%s%s has no effect any more: %s; leave it out\n", option,
                           value && value[0] ? " " : "", value ? value : "", gone_options[k].now));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Why nobody has read an option, and what to do */
static PetscErrorCode FindReason(const char name[], PetscInt n, const char *const bodies[], char reason[], size_t size)
{
  char      text[768], need[160], material[128];
  PetscBool known, named = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(OptionsFindOverridden(name, reason, size));
  if (reason[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(OptionsFindNeed(name, need, sizeof(need)));
  PetscCall(OptionsSuggest(name, n, bodies, &known, text, sizeof(text)));
  PetscCall(OptionsFindMaterial(name, material, sizeof(material)));
  if (material[0]) PetscCall(OptionsMaterialIsNamed(material, n, bodies, &named));
  if (!named) PetscCall(PetscSNPrintf(reason, size, "no body names this material, as in -%s_material %s", n ? bodies[0] : "all", material));
  else if (need[0] && (known || strchr(name, ':'))) PetscCall(PetscSNPrintf(reason, size, "needs %s", need)); /* or a pair of contact */
  else if (known) PetscCall(PetscSNPrintf(reason, size, "goes with another method or type than the one chosen"));
  else PetscCall(PetscSNPrintf(reason, size, "the nearest known one is %s", text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Options that nobody has read, as "-a 1, -b 2 (why), -c (why)": one reason at least fits in PETSc's errors of 2048 bytes */
typedef struct {
  PetscInt n;
  char     text[1850];
  char     given[800], reason[900]; /* the options with the reason of the last one */
} Unread;

static PetscErrorCode Close(Unread *unread)
{
  char group[sizeof(unread->given) + sizeof(unread->reason) + 4];

  PetscFunctionBegin;
  if (!unread->given[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(group, sizeof(group), "%s (%s)", unread->given, unread->reason));
  PetscCall(NamesAppend(unread->text, sizeof(unread->text), ", ", group));
  unread->given[0] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Add(Unread *unread, const char name[], const char value[], PetscInt n, const char *const bodies[])
{
  char      reason[sizeof(unread->reason)], given[512];
  PetscBool same;

  PetscFunctionBegin;
  if (unread->n > 100) PetscFunctionReturn(PETSC_SUCCESS); /* more than the message has room for */
  PetscCall(FindReason(name, n, bodies, reason, sizeof(reason)));
  PetscCall(PetscStrcmp(reason, unread->reason, &same));
  if (!same) PetscCall(Close(unread));
  PetscCall(PetscStrncpy(unread->reason, reason, sizeof(unread->reason)));
  PetscCall(PetscSNPrintf(given, sizeof(given), "-%s%s%s", name, value && value[0] ? " " : "", value ? value : ""));
  PetscCall(NamesAppend(unread->given, sizeof(unread->given), ", ", given));
  unread->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The options of all bodies and of materials that have been given to bodies none of which has read them */
static PetscErrorCode AddShared(Unread *unread, PetscInt n, const char *const bodies[])
{
  char       *all, *text;
  const char *name, *value;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  for (text = all; OptionsTextNext(&text, &name, &value);) {
    PetscBool lost = PETSC_FALSE, gone = PETSC_FALSE;

    if (OptionsIsShared(name + 1)) PetscCall(OptionsSharedIsUnread(name + 1, n, bodies, &lost));
    if (lost) PetscCall(AcceptGone(name + 1, value, &gone));
    if (lost && !gone) PetscCall(Add(unread, name + 1, value, n, bodies));
  }
  PetscCall(PetscFree(all));
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
  To be called when everything has been set up and nothing been computed. Names the option that may have been meant, by letters or by
  meaning; what an option needs beside it; and the list that an option is left over from. An option that is gone brings a warning.

.seealso: `ImpaktPrintOptions()`
@*/
PetscErrorCode ImpaktCheckOptions(PetscInt n, const char *const bodies[])
{
  PetscInt n_left;
  char   **names, **values;
  Unread   unread = {.n = 0};

  PetscFunctionBegin;
  PetscCall(AddShared(&unread, n, bodies)); /* before PetscOptionsHasName() below counts options of bodies as read */
  PetscCall(PetscOptionsLeftGet(NULL, &n_left, &names, &values));
  for (PetscInt i = 0; i < n_left; i++) {
    PetscBool late = PETSC_FALSE;
    char      shared[PETSC_MAX_OPTION_NAME];

    for (size_t k = 0; k < sizeof(late_options) / sizeof(late_options[0]) && !late; k++)
      PetscCall(PetscStrcmp(names[i], late_options[k], &late));
    if (late) continue;
    PetscCall(OptionsFindShared(names[i], values[i], shared, sizeof(shared)));
    if (shared[0]) { /* it has been given to all bodies, some of which have no use for it */
      char name[PETSC_MAX_OPTION_NAME];

      PetscCall(PetscSNPrintf(name, sizeof(name), "-%s", names[i]));
      PetscCall(PetscOptionsHasName(NULL, NULL, name, &late));
    } else {
      PetscCall(AcceptGone(names[i], values[i], &late));
      if (!late) PetscCall(Add(&unread, names[i], values[i], n, bodies));
    }
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &n_left, &names, &values));
  PetscCall(Close(&unread));
  PetscCheck(!unread.n, PETSC_COMM_WORLD, PETSC_ERR_USER_INPUT,
             "Unknown option%s, or without effect here: %s. `impakt -help all` lists the options, `impakt -help WORD` those with a word",
             unread.n == 1 ? "" : "s", unread.text);
  PetscFunctionReturn(PETSC_SUCCESS);
}
