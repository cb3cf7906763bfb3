#pragma once
#include <exact.h>

#define EXACT_QUANTITIES 6 /* members of ExactSolution */

struct _n_ExactImpact {
  /* the problem */
  PetscInt  body;                  /* the bar on the Dirichlet side, among the controller's bodies */
  PetscReal normal[3];             /* of its contact face, outward */
  PetscReal start;                 /* s */
  PetscReal speed;                 /* half the speed of approach [m/s] */
  PetscReal frame_velocity;        /* mean of both bars [m/s] */
  PetscReal impact_position;       /* point of impact along the normal, as it lies at the start [m] */
  PetscReal mass, force;           /* of one bar [kg]; during contact [N] */
  PetscReal impact, turn, release; /* first contact, all energy potential, last contact [s] */
  /* the run */
  PetscReal squares[EXACT_QUANTITIES], errors[EXACT_QUANTITIES]; /* sums of the squares of the solution and of the error */
  PetscReal peak_potential;                                      /* J */
  PetscReal last_contact, last_time;                             /* end of the last step in contact, and of the last step [s] */
};
