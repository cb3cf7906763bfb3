/* What a run was like, gathered step by step. */
#pragma once
#include <checkpoint/checkpoint.h>
#include "contacttimes.h"

/* Mean rotation of a linear body from which on the user is warned [rad]: its material counts 1 - cos of the angle as strain, 0.1 % here */
#define STATISTICS_FAR_TURN 0.05

/* How one pair, or all pairs together, touched. Forces are sums over the nodes along their normals; where these differ, they are more than
   the resultant. Times and forces are not-a-number if there was no contact. */
typedef struct {
  PetscReal first_contact_time;               /* end of the first controller step in contact [s] */
  PetscReal release_time;                     /* end of the last controller step in contact [s] */
  PetscInt  onsets;                           /* how often a step in contact followed one without contact */
  PetscInt  steps_in_contact;                 /* controller steps that end in contact, or have all of it inside */
  PetscReal force_mean, force_std, force_min; /* over the middle 3/5 from first contact to release; minimum: while in contact [N] */
  PetscReal force_peak, tension_max;          /* over the whole run [N] */
  PetscInt  peak_step;                        /* of the steps in contact since bodies touched, the one with the peak, from 1 */
  PetscReal force_final;                      /* at the end [N] */
  PetscReal resultant_mean, resultant_peak;   /* magnitude of the sum of the pair's forces as vectors; as the force's [N] */
  PetscReal impulse;                          /* integral of the force over time, trapezoidal [N s] */
  PetscReal gap_min;                          /* smallest gap at the end of a step; those of rows are means around nodes [m] */
  ContactTimesResults times;                  /* inside controller steps, by interpolation */
  PetscReal           resultant[3];      /* of the forces on the second body of the pair, at the end; of all pairs together: none [N] */
  PetscReal           impulse_vector[3]; /* of the forces on the second body of the pair, at the end; of all pairs together: none [N s] */
  PetscReal           area_max;          /* in contact at the same time [m^2] */
  PetscInt            active_max;        /* nodes in contact at the same time */
  PetscReal           gap_final;         /* smallest gap at the end of the run [m] */
  PetscReal           friction_loss;     /* energy that friction has taken [J] */
  PetscReal           obstacle_work;     /* work of obstacles whose surface moves [J] */
  PetscInt            sliding_max;       /* nodes that slide at the same time, with friction */
} ContactStatistics;

typedef struct {
  PetscReal      kinetic, potential, peak_potential; /* at the end, at the end, largest [J] */
  PetscReal      displacement_error;                 /* at the end, relative L2, against an exact displacement; not-a-number without one */
  PetscReal      external_work;                      /* at the end, by loads [J] */
  PetscReal      hourglass_energy, hourglass_energy_max; /* at the end, largest; 0 but for elements with one point [J] */
  PetscReal      damping_work;                           /* at the end, taken by Rayleigh damping [J] */
  PetscReal      rotation_max;                           /* largest mean rotation of a linear body, 0 for others [rad] */
  PetscInt       inverted_max;                           /* most elements of a linear body that were inside out at a time, 0 for others */
  PetscBool      plastic;                                /* its material flows */
  PetscReal      plastic_work;                           /* at the end, with what hardening stores of it [J] */
  ContactOverlap overlap;                                /* the deepest one that was found, */
  PetscReal      overlap_time;                           /* and when that was [s] */
  PetscReal      energy_error_min,
      energy_error_max; /* of kinetic + potential - external work, relative to its start, or to the system's if that is 0 */
} BodyStatistics;

/* What holds the bodies at a held surface or an obstacle */
typedef struct {
  PetscInt    body;                /* number of the body; -1: an obstacle */
  const char *name;                /* of the surface, or of the obstacle; borrowed */
  PetscReal   force[3], moment[3]; /* at the end; the latter about the origin [N, N m] */
  PetscReal   force_peak;          /* largest magnitude over the whole run [N] */
} SupportStatistics;

typedef struct {
  PetscInt           steps;
  PetscInt           n_pairs, n_bodies;
  ContactStatistics  contact; /* of any pair; forces but for tension are the first pair's */
  ContactStatistics *pairs;
  BodyStatistics    *bodies;
  PetscInt           n_supports;
  SupportStatistics *supports;                                               /* in the order of ControllerGetSupports() */
  PetscInt           max_sweeps;                                             /* in one step */
  PetscReal          mean_sweeps;                                            /* over all steps */
  PetscReal          mean_sweeps_contact;                                    /* over steps that end in contact */
  PetscReal          energy_error_min, energy_error_max, energy_error_final; /* of the system, relative to `energy_scale` */
  PetscReal          energy_scale;                                           /* that of `ControllerFrame` at the end [J] */
  PetscReal
      momentum_error_max; /* relative to the sum of the bodies' initial momenta; absolute if that is 0 [kg m/s]; not-a-number with loads */
  PetscReal momentum_scale;             /* that sum [kg m/s] */
  PetscReal angular_momentum_error_max; /* about the centre of mass of all bodies, relative to the largest of any body about the centre
                                           of any at the start; likewise [kg m^2/s] */
  PetscReal penalty_energy_max;         /* [J] */
  PetscReal uncounted_energy_max;       /* of that part of it which energy errors leave out [J] */
} StatisticsResults;

typedef struct _n_Statistics *Statistics;

static inline PetscReal StatisticsNorm(const PetscReal x[3])
{
  return PetscSqrtReal(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

/* The energy error that is farthest from zero, with its sign */
static inline PetscReal StatisticsGetWorstError(const StatisticsResults *results)
{
  return -results->energy_error_min > results->energy_error_max ? results->energy_error_min : results->energy_error_max;
}

PETSC_INTERN PetscErrorCode      StatisticsCreate(Controller, Statistics *);
PETSC_INTERN ControllerMonitorFn StatisticsMonitor;
PETSC_INTERN PetscErrorCode      StatisticsSetFrames(Statistics, PetscInt);
PETSC_INTERN PetscErrorCode      StatisticsAddOverlaps(Statistics);
PETSC_INTERN PetscErrorCode      StatisticsGetResults(Statistics, const StatisticsResults **);
PETSC_INTERN PetscErrorCode      StatisticsSetDeviation(Statistics, const Body[], const Expression[]);
PETSC_INTERN PetscErrorCode      StatisticsVisit(Statistics, Checkpoint);
PETSC_INTERN PetscErrorCode      StatisticsDestroy(Statistics *);
