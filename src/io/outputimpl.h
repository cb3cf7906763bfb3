/* What the files of the class share. Private to src/io. */
#pragma once
#include <impakt/io.h>
#include <petsc/private/petscimpl.h>
#include "checkpoints.h"
#include "fields.h"
#include "history.h"
#include "outputlock.h"
#include "statisticstypes.h"

struct _p_Output {
  PETSCHEADER(int);
  Controller  controller; /* borrowed */
  Statistics  statistics;
  History     history;
  Fields      fields;
  Exact       exact;
  PetscInt    n_displacements;
  Expression *displacements;                    /* exact ones that bodies are compared with: three for each body, NULL if none is given */
  char        summary_path[PETSC_MAX_PATH_LEN]; /* empty: there is none */
  char        history_path[PETSC_MAX_PATH_LEN], fields_path[PETSC_MAX_PATH_LEN];
  OutputLocks locks;
  PetscBool   locked;
  PetscBool   checks; /* -check: the start alone is looked at, and of files the fields alone are written */
  Checkpoints checkpoints;
};

PETSC_INTERN PetscErrorCode OutputCheckPaths(MPI_Comm, const char[], const char[], const char[], const char[]);
PETSC_INTERN PetscErrorCode OutputLock(Output);
PETSC_INTERN PetscErrorCode OutputStartClock(Output);
PETSC_INTERN PetscErrorCode OutputVisitShared(Output, PetscBool, Checkpoint);
PETSC_INTERN PetscErrorCode OutputReadCheckpoints(Output);
PETSC_INTERN PetscErrorCode OutputTakeState(Output, const char[]);
PETSC_INTERN PetscErrorCode OutputCompareOptions(MPI_Comm, const char[], PetscBool, const char[]);
