#pragma once
#include <impakt/exact.h>
#include <petsc/private/petscimpl.h>

#define EXACT_QUANTITIES 6 /* members of ExactSolution */

struct _ExactOps {
  PetscErrorCode (*evaluate)(Exact, PetscInt, PetscReal, ExactSolution *);
  PetscErrorCode (*destroy)(Exact);
};

/* A bar in its initial state, along the contact normal */
typedef struct {
  const char *name;
  PetscReal   density, modulus, mass; /* kg/m^3, Pa, kg */
  PetscReal   length;                 /* m */
  PetscReal   lower, upper;           /* its ends as it lies at the start [m] */
  PetscReal   velocity;               /* m/s */
} ExactBar;

/* Between the run and the solution, over the steps so far */
typedef struct {
  PetscReal square, largest;     /* of the solution: sum of its squares, and largest without sign */
  PetscReal error_square, worst; /* the same of the error */
} ExactDistance;

struct _p_Exact {
  PETSCHEADER(struct _ExactOps);
  ExactType type;
  void     *data; /* of the type */
  /* the problem */
  PetscInt  body[2];         /* the bars on the Dirichlet and the Neumann side, among the controller's bodies */
  ExactBar  bars[2];         /* in the same order */
  PetscReal normal[3];       /* of the contact face on the Dirichlet side, outward */
  PetscReal start;           /* s */
  PetscReal frame_velocity;  /* of the centre of mass [m/s] */
  PetscReal impact_position; /* point of impact along the normal, as it lies at the start [m] */
  /* the solution, in short; each type fills it in */
  PetscReal impact, release; /* first contact, end of the last contact [s] */
  PetscReal turn, peak;      /* when the bar on the Dirichlet side has its largest potential energy [s], and that [J] */
  PetscReal force, impulse;  /* mean over the middle three fifths from impact to release [N]; over all of it [N s] */
  /* the run */
  ExactDistance distance[2][EXACT_QUANTITIES]; /* of each bar, of each member of ExactSolution */
  PetscReal     peak_potential;                /* of the bar on the Dirichlet side [J] */
  PetscReal     last_contact, last_time;       /* end of the last step in contact, and of the last step [s] */
};

PETSC_INTERN PetscErrorCode ExactSetUpBars(Exact, Controller);

PETSC_INTERN PetscErrorCode ExactCreate_Impact(Controller, Exact);
PETSC_INTERN PetscErrorCode ExactCreate_Characteristics(Controller, Exact);
