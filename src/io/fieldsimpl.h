/* What the sources of the fields share. Private to src/io. */
#pragma once
#include "fields.h"
#include "obstaclegrid.h"
#include "hdf5file.h"
#include <impakt/private/contactsteps.h>

struct _n_Fields {
  MPI_Comm        comm;
  PetscBool       first_rank;
  char            path[PETSC_MAX_PATH_LEN], part[PETSC_MAX_PATH_LEN], xdmf[PETSC_MAX_PATH_LEN];
  OutputPrecision precision;
  PetscInt        interval, n_frames; /* controller steps from frame to frame; frames of the whole run */
  FieldsMesh      mesh;
  FieldsSet       set;                      /* fields of each frame */
  Contact         contact;                  /* borrowed; NULL if no bodies can touch */
  Contact         problem;                  /* has the obstacles; borrowed */
  PetscInt        n_obstacles;              /* that are shown */
  ObstacleGrid   *obstacles;                /* their surfaces; NULL until the file is begun */
  PetscInt        written;                  /* frames in the file */
  PetscInt        goes_on;                  /* frames of the run that is continued, see FieldsTakeUp() */
  PetscReal      *times;                    /* their times [s] */
  PetscReal      *stress;                   /* xx, yy, zz, xy, yz, xz of each cell of this rank [Pa] */
  PetscReal      *plastic;                  /* equivalent plastic strain of each cell of this rank; NULL where nothing flows */
  PetscReal      *nodal;                    /* of each node of this rank, what ContactGetFields() gives */
  void           *buffer;                   /* one field of a frame, in the file's precision */
  hid_t           file;                     /* -1 until it is begun */
  PetscBool       failed;                   /* a frame could not be written */
  int             held;                     /* the file with its final name, see OutputFilePlace(); on the first rank */
  PetscInt        listed;                   /* frames in the XDMF file */
  PetscLogDouble  list_ended, list_seconds; /* when the XDMF file was written last, and how long that took [s] */
};

PETSC_INTERN PetscErrorCode FieldsShareError(Fields, PetscErrorCode);
PETSC_INTERN PetscErrorCode FieldsWriteMesh(Fields);
PETSC_INTERN PetscErrorCode FieldsWriteFrame(Fields, PetscReal);
