#pragma once
#include <impakt/controller.h>
#include <petsc/private/petscimpl.h>

#define MAX_MONITORS 16

struct _p_Controller {
  PETSCHEADER(int);
  PetscInt  n_bodies;
  Body     *bodies;
  Contact   contact;
  PetscReal time_start, time_end, time_step;
  PetscInt  steps;
  /* observers */
  PetscInt             n_monitors;
  ControllerMonitorFn *monitor[MAX_MONITORS];
  void                *monitor_ctx[MAX_MONITORS];
  PetscErrorCode (*monitor_destroy[MAX_MONITORS])(void **);
  /* the frame they see */
  BodyMeasures     *measures;
  PetscBool        *has_obstacle; /* per body: it may touch one, which is something outside */
  PetscReal        *contact_positions, *contact_velocities;
  ContactPairState *pair_states;
  /* cost */
  PetscLogDouble setup_seconds, wall_seconds, cpu_seconds;
  PetscBool      setup;
};

/* controller.c calls terminal.c and monitors.c, terminal.c calls monitors.c */
PETSC_INTERN PetscErrorCode ControllerNotify(Controller, PetscInt);
PETSC_INTERN PetscErrorCode ControllerSetUpTerminal(Controller);
