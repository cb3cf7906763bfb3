/* What a body knows of its response. Private to response.c, which makes it, and window.c, which adds its columns. */
#pragma once
#include "probe.h"

typedef struct {
  PetscInt     row; /* global */
  InputKind    kind;
  Vec          change[4];  /* of displacement, velocity, acceleration, internal force */
  PetscBool    changes[4]; /* whether they are not zero: a velocity, say, changes little but itself */
  PetscScalar *rows;       /* displacement, velocity, acceleration, reaction: 4 x local rows */
} Column;

struct _BodyResponse {
  PetscBool      made;  /* there is a matrix, for `conditions` */
  PetscBool      valid; /* these are the present conditions */
  BodyCondition *conditions;
  PetscBool      window_valid; /* the present end state came from `inputs` */
  PetscBool      condensed;    /* columns hold states */
  /* all rows by all rows, by columns: reaction of prescribed, displacement of other rows, for displacements and forces */
  PetscScalar *waveform;       /* at the end of each substep, for a hat in the first: substeps of them */
  PetscScalar *matrix;         /* at the end of the controller step, for inputs that rise linearly over it */
  PetscScalar *rate_matrix[2]; /* for velocities and accelerations, with one substep */
  PetscInt     n_columns;
  Column      *columns;             /* at most 3 for each row */
  PetscScalar *inputs, *new_inputs; /* of all rows on every rank, 4 kinds each */
  PetscScalar *mine;
  PetscMPIInt *kinds; /* conditions of all rows */
};
