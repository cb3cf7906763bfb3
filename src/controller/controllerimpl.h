/* Private to src/controller. */
#pragma once
#include <impakt/controller.h>
#include <impakt/private/contactsteps.h>
#include <petsc/private/petscimpl.h>
#include "energyscale.h"

#define MAX_MONITORS 16
/* Most controller steps in a run: they are counted in PetscInt, which has 32 bits */
#define MOST_STEPS 2e9
/* Times whose squares, times the largest modulus or density, are numbers [s] */
#define LONGEST_TIME  1e60
#define SHORTEST_STEP 1e-60
/* If the duration exceeds a whole number of controller steps by no more than this, relative and in steps, no step is added: round-off */
#define STEPS_ROUND_OFF 1e-12
#define STEPS_FLOOR     1e-9

struct _p_Controller {
  PETSCHEADER(int);
  PetscInt  n_bodies;
  Body     *bodies;
  Contact   contact;
  PetscReal time_start, time_end, time_step;
  PetscInt  steps;
  PetscInt  step;             /* controller steps that have been accepted so far */
  PetscBool goes_on;          /* the run has been continued from a checkpoint: its observers know the steps before */
  PetscBool chooses_step;     /* the step is the largest that resolves contact */
  PetscReal resolved_step;    /* that, where it is not chosen [s]; infinity: none */
  char      step_reason[512]; /* what that follows from */
  /* step control */
  PetscInt       parts;     /* of a controller step, see ContactTraits */
  const char    *whole;     /* why steps are not cut, or NULL */
  PetscInt       most_cuts; /* how often a step may be cut in halves */
  ControllerCuts cuts;
  PetscInt       step_cuts, step_sweeps; /* of the controller step under way; the sweeps with those of steps that failed */
  /* observers */
  PetscInt             n_monitors;
  ControllerMonitorFn *monitor[MAX_MONITORS];
  void                *monitor_ctx[MAX_MONITORS];
  PetscErrorCode (*monitor_destroy[MAX_MONITORS])(void **);
  ControllerAfterStepFn *after_step; /* called when all of them have been, or NULL */
  void                  *after_step_ctx;
  /* what they are shown, see ControllerFrame */
  BodyMeasures      *measures;
  PetscReal         *measure_sums; /* work space: `BODY_MEASURE_SUMS` per body */
  PetscReal         *energies;     /* per body: what contact alone is to change [J] */
  PetscBool         *has_obstacle; /* per body: it may touch an obstacle, whose force is one from outside */
  PetscReal         *contact_positions, *contact_velocities;
  ContactPairState  *pair_states;
  PetscInt           n_supports;
  ControllerSupport *supports;
  PetscInt           n_probes;
  ControllerProbe   *probes;
  PetscReal         *probe_values; /* work space: what the points of one body do */
  PetscReal         *reactions;    /* work space: forces and moments of the held surfaces of one body */
  EnergyScale        scale;        /* of the energy's changes */
  /* energy guard */
  struct {
    PetscReal  part;    /* of the energy, that a run may gain; 0: no guard */
    PetscReal *start;   /* energy of each body at the start [J] */
    PetscReal  given;   /* of that, kinetic energy of rigid bodies that are led: no measure of what contact may change [J] */
    PetscReal  largest; /* energy of all bodies so far [J] */
  } guard;
  ControllerCost cost;
  PetscBool      setup;
};

#define ENERGY_GUARD 0.05 /* by default */

/* controller.c calls the others; terminal.c calls monitors.c, which calls guard.c; controllerset.c calls guard.c */
PETSC_INTERN PetscErrorCode ControllerPlaceBodies(Controller, PetscInt);
PETSC_INTERN PetscErrorCode ControllerReadEnergyGuard(Controller);
PETSC_INTERN PetscErrorCode ControllerGuardEnergy(Controller, const ControllerFrame *);
PETSC_INTERN PetscErrorCode ControllerNotify(Controller, PetscInt);
PETSC_INTERN PetscErrorCode ControllerSetUpProbes(Controller);
PETSC_INTERN PetscErrorCode ControllerFindProbes(Controller);
PETSC_INTERN PetscErrorCode ControllerSetUpSupports(Controller);
PETSC_INTERN PetscErrorCode ControllerFindReactions(Controller);
PETSC_INTERN PetscErrorCode ControllerSetUpTerminal(Controller);
/* autostep.c */
PETSC_INTERN PetscErrorCode ControllerChooseStep(Controller);
PETSC_INTERN PetscErrorCode ControllerWarnOfStep(Controller);
/* plausible.c */
PETSC_INTERN PetscErrorCode ControllerWarnOfUnits(Controller);
/* forecast.c */
PETSC_INTERN PetscErrorCode ControllerWarnOfElements(Controller);
/* stepcontrol.c */
PETSC_INTERN PetscErrorCode ControllerReadStepControl(Controller);
PETSC_INTERN PetscErrorCode ControllerSetUpStepControl(Controller);
PETSC_INTERN PetscErrorCode ControllerMakeStep(Controller);
PETSC_INTERN PetscErrorCode ControllerNoteEnergies(Controller);
