/* Which options of a run differ from those of the run that it continues. */
#include "outputimpl.h"
#include <string.h>
#include <sys/optionstext.h>

/* Options that change what is written, shown or read, how long the run is, and nothing else: by how they begin, without the dash. Options
   of all bodies and of materials are among those of the bodies too, as -left_density, where they are compared. */
static const char *const free_options[] = {
    "output_", "checkpoint", "restart",     "max_wall_time", "monitor_interval", "progress", "time_end",          "options_", "log_",
    "info",    "malloc",     "memory_view", "citations",     "skip_petscrc",     "on_error", "no_signal_handler", "all_",     "material_"};

static PetscBool IsFree(const char name[])
{
  const size_t length = strlen(name);

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(free_options); i++)
    if (!strncmp(name + 1, free_options[i], strlen(free_options[i]))) return PETSC_TRUE;
  return (PetscBool)(length > 5 && !strcmp(name + length - 5, "_view"));
}

/* Adds what one of two sets of options has differently from the other, or in the second pass, `back`, alone */
static PetscErrorCode AddDifferences(PetscOptions from, PetscOptions to, PetscBool back, size_t size, char differences[])
{
  char       *all, *text;
  const char *name, *value, *other;
  PetscBool   has;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(from, &all));
  for (text = all; OptionsTextNext(&text, &name, &value);) {
    const size_t used = strlen(differences);

    if (IsFree(name)) continue;
    PetscCall(PetscOptionsFindPair(to, NULL, name, &other, &has));
    if (has && (back || !strcmp(other ? other : "", value))) continue;
    PetscCall(PetscSNPrintf(differences + used, size - used, "%s%s%s%s%s (it had %s)", used ? ", " : "", back || has ? "" : "no ", name,
                            back || has ? " " : "",
                            back  ? value
                            : has ? other
                                  : "",
                            back       ? "none"
                            : value[0] ? value
                                       : "it"));
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error that names the options of this run which differ from those of the run that it continues. Collective */
PetscErrorCode OutputCompareOptions(MPI_Comm comm, const char before[], PetscBool allow, const char path[])
{
  char        *texts[2], differences[2048] = "";
  PetscOptions options[2]; /* not the database itself, which would count all as read */

  PetscFunctionBegin;
  PetscCall(PetscStrallocpy(before, &texts[0]));
  PetscCall(PetscOptionsGetAll(NULL, &texts[1]));
  for (int k = 0; k < 2; k++) {
    char       *text = texts[k];
    const char *name, *value;

    PetscCall(PetscOptionsCreate(&options[k]));
    while (OptionsTextNext(&text, &name, &value)) PetscCall(PetscOptionsSetValue(options[k], name, value));
    PetscCall(PetscFree(texts[k]));
  }
  for (int k = 0; k < 2; k++) PetscCall(AddDifferences(options[k], options[1 - k], k == 1, sizeof(differences), differences));
  for (int k = 0; k < 2; k++) PetscCall(PetscOptionsDestroy(&options[k]));
  PetscCheck(!differences[0] || allow, comm, PETSC_ERR_USER_INPUT,
             "-restart %s is of a run with other options: %s; give the same ones, or -restart_allow_changes; -restart_state in place of "
             "-restart begins a new run with the state of that one",
             path, differences);
  if (differences[0])
    PetscCall(PetscFPrintf(comm, stderr, "impakt: warning: the run that is continued had other options: %s\n", differences));
  PetscFunctionReturn(PETSC_SUCCESS);
}
