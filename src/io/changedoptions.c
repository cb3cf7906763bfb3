/* Which options of a run differ from those of the run that it continues. */
#include "outputimpl.h"
#include <string.h>
#include <sys/optionstext.h>

/* Options that change what is written, shown or read, how long the run is, and nothing else: by how they begin, without the dash. Options
   of all bodies and of materials are among those of the bodies too, as -left_density, where they are compared. */
static const char *const free_options[] = {
    "output_", "checkpoint", "restart",     "max_wall_time", "monitor_interval", "progress", "time_end",          "options_", "log_",
    "info",    "malloc",     "memory_view", "citations",     "skip_petscrc",     "on_error", "no_signal_handler", "all_",     "material_"};

typedef struct {
  const char *name, *value;
} Setting;

static PetscBool IsFree(const char name[])
{
  const size_t length = strlen(name);

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(free_options); i++)
    if (!strncmp(name + 1, free_options[i], strlen(free_options[i]))) return PETSC_TRUE;
  return (PetscBool)(length > 5 && !strcmp(name + length - 5, "_view"));
}

/* Names and values of all options in a text, see OptionsTextNext() */
static PetscErrorCode Split(char text[], PetscInt *n, Setting *settings[])
{
  PetscInt room = 1;

  PetscFunctionBegin;
  for (const char *c = text; *c; c++) room += *c == ' ';
  PetscCall(PetscMalloc1(room, settings));
  for (*n = 0; OptionsTextNext(&text, &(*settings)[*n].name, &(*settings)[*n].value); (*n)++);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char *Find(PetscInt n, const Setting settings[], const char name[])
{
  for (PetscInt i = 0; i < n; i++)
    if (!strcmp(settings[i].name, name)) return settings[i].value;
  return NULL;
}

/* Adds what differs in one list from the other; in the second pass only what is not in the first list at all */
static PetscErrorCode AddDifferences(PetscInt n, const Setting from[], PetscInt m, const Setting to[], PetscBool back, size_t size,
                                     char text[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    const char  *other = Find(m, to, from[i].name);
    const size_t used  = strlen(text);

    if (IsFree(from[i].name) || (other && (back || !strcmp(other, from[i].value)))) continue;
    if (back) PetscCall(PetscSNPrintf(text + used, size - used, "%s%s %s (it had none)", used ? ", " : "", from[i].name, from[i].value));
    else if (other)
      PetscCall(PetscSNPrintf(text + used, size - used, "%s%s %s (it had %s)", used ? ", " : "", from[i].name, other, from[i].value));
    else
      PetscCall(PetscSNPrintf(text + used, size - used, "%sno %s (it had %s)", used ? ", " : "", from[i].name,
                              from[i].value[0] ? from[i].value : "it"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error that names the options of this run which differ from those of the run that it continues. Collective */
PetscErrorCode OutputCompareOptions(MPI_Comm comm, const char before[], PetscBool allow, const char path[])
{
  char    *texts[2], differences[2048] = "";
  Setting *settings[2];
  PetscInt n[2];

  PetscFunctionBegin;
  PetscCall(PetscStrallocpy(before, &texts[0]));
  PetscCall(PetscOptionsGetAll(NULL, &texts[1]));
  for (int k = 0; k < 2; k++) PetscCall(Split(texts[k], &n[k], &settings[k]));
  PetscCall(AddDifferences(n[0], settings[0], n[1], settings[1], PETSC_FALSE, sizeof(differences), differences));
  PetscCall(AddDifferences(n[1], settings[1], n[0], settings[0], PETSC_TRUE, sizeof(differences), differences));
  for (int k = 0; k < 2; k++) {
    PetscCall(PetscFree(settings[k]));
    PetscCall(PetscFree(texts[k]));
  }
  PetscCheck(!differences[0] || allow, comm, PETSC_ERR_USER_INPUT,
             "-restart %s is of a run with other options: %s; give the same ones, or -restart_allow_changes; -restart_state in place of "
             "-restart begins a new run with the state of that one",
             path, differences);
  if (differences[0])
    PetscCall(PetscFPrintf(comm, stderr, "impakt: warning: the run that is continued had other options: %s\n", differences));
  PetscFunctionReturn(PETSC_SUCCESS);
}
