/* What the sources of the statistics share. Private to src/io. */
#pragma once
#include "statisticstypes.h"

/* What is remembered of the last step, for each pair and for all pairs together */
typedef struct {
  PetscBool touches;
  PetscInt  steps;   /* in contact since bodies touched */
  PetscReal impulse; /* until then [N s] */
} ContactMemory;

/* Numbers of a record of the series for each pair */
#define STATISTICS_SERIES 3

struct _n_Statistics {
  StatisticsResults results;
  Contact           contact;  /* the controller's */
  ContactOverlap   *overlaps; /* work space, per body */
  PetscInt          frames;   /* controller steps from one search for overlaps to the next */
  PetscReal         time;     /* at the end of the last step [s] */
  PetscBool         looked;   /* overlaps have been searched for then */
  ContactMemory     any, *pair;
  ContactTimes      times;
  PetscInt          total_sweeps, contact_sweeps;
  PetscReal        *initial_energy; /* of each body [J] */
  PetscReal        *mass;           /* of each body [kg] */
  PetscReal        *gyration;       /* radius of gyration of each body's box [m] */
  PetscReal        *body_change;    /* least and largest change of the energy of each body since the start [J] */
  PetscReal         system_change[2];
  PetscBool         loaded;         /* forces from outside, or held displacements, act on some body */
  PetscReal         momentum[3];    /* of the system at the start [kg m/s] */
  PetscReal         momentum_scale; /* sum of the bodies' initial momenta, each without its sign [kg m/s] */
  PetscReal         angular[3];     /* angular momentum of the system at the start, about its centre of mass [kg m^2/s] */
  PetscReal         angular_scale;  /* the largest of any body about the centre of any at the start, without common motion [kg m^2/s] */
  PetscInt          n_series, capacity;
  PetscReal        *series; /* from first contact on: time, and for each pair force, resultant and nodes in contact */
};

PETSC_INTERN void           StatisticsInitializeContact(Statistics);
PETSC_INTERN PetscErrorCode StatisticsAddContact(Statistics, const ControllerFrame *);
PETSC_INTERN void           StatisticsComputeForces(Statistics, PetscInt);
