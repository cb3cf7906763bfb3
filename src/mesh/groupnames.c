/* What surfaces and node sets a mesh has, for messages. */
#include "meshimpl.h"
#include <sys/names.h>

/* Labels that PETSc keeps for itself */
PetscErrorCode MeshLabelIsInternal(const char name[], PetscBool *internal)
{
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(PetscStrcmp(name, "depth", internal));
  PetscCall(PetscStrcmp(name, "celltype", &same));
  *internal = (PetscBool)(*internal || same);
  PetscCall(PetscStrcmp(name, MESH_COMPOSITE, &same));
  *internal = (PetscBool)(*internal || same);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether any rank has points from `start` to `end` - 1 in a label */
PetscErrorCode MeshLabelHasPoints(DM dm, DMLabel label, PetscInt start, PetscInt end, PetscBool *has)
{
  PetscInt value, none, any = 0;

  PetscFunctionBegin;
  PetscCall(DMLabelGetDefaultValue(label, &none));
  for (PetscInt p = start; p < end && !any; p++) {
    PetscCall(DMLabelGetValue(label, p, &value));
    any = value != none;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPIU_INT, MPI_MAX, PetscObjectComm((PetscObject)dm)));
  *has = (PetscBool)any;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At most as many numbers of groups are listed in a message */
#define MOST_NUMBERS 32

/* Appends the numbers that a label has on any rank */
static PetscErrorCode ListNumbers(DM dm, const char name[], char list[], size_t size)
{
  PetscInt last = -1;
  DMLabel  label;
  IS       values = NULL;
  PetscInt n      = 0;

  PetscFunctionBegin;
  PetscCall(DMGetLabel(dm, name, &label));
  if (label) {
    PetscCall(DMLabelGetValueIS(label, &values));
    PetscCall(ISGetLocalSize(values, &n));
  }
  for (PetscInt k = 0; k < MOST_NUMBERS; k++) {
    PetscInt        next = PETSC_INT_MAX;
    const PetscInt *value;
    char            text[32];

    if (values) {
      PetscCall(ISGetIndices(values, &value));
      for (PetscInt i = 0; i < n; i++)
        if (value[i] > last) next = PetscMin(next, value[i]);
      PetscCall(ISRestoreIndices(values, &value));
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &next, 1, MPIU_INT, MPI_MIN, PetscObjectComm((PetscObject)dm)));
    if (next == PETSC_INT_MAX) break;
    last = next;
    PetscCall(PetscSNPrintf(text, sizeof(text), "%" PetscInt_FMT, next));
    PetscCall(NamesAppend(list, size, ", ", text));
  }
  PetscCall(ISDestroy(&values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the names of labels with points from `start` to `end` - 1, then the numbers in the label `sets` */
PetscErrorCode MeshListLabels(DM dm, PetscInt start, PetscInt end, const char sets[], char list[], size_t size)
{
  const char *const generic[] = {"Cell Sets", "Face Sets", "Vertex Sets", "marker"};
  PetscInt          n;

  PetscFunctionBegin;
  list[0] = 0;
  PetscCall(DMGetNumLabels(dm, &n));
  for (PetscInt l = 0; l < n; l++) {
    const char *name;
    PetscBool   skip, has;
    DMLabel     label;

    PetscCall(DMGetLabelName(dm, l, &name));
    PetscCall(MeshLabelIsInternal(name, &skip));
    for (PetscInt i = 0; i < 4 && !skip; i++) PetscCall(PetscStrcmp(name, generic[i], &skip));
    if (skip) continue;
    PetscCall(DMGetLabel(dm, name, &label));
    PetscCall(MeshLabelHasPoints(dm, label, start, end, &has));
    if (!has) continue;
    PetscCall(NamesAppend(list, size, ", ", name));
  }
  PetscCall(ListNumbers(dm, sets, list, size));
  PetscFunctionReturn(PETSC_SUCCESS);
}
