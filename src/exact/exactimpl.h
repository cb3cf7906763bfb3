/* What the exact solutions share. Private to src/exact. */
#pragma once
#include <impakt/exact.h>
#include <petsc/private/petscimpl.h>

#define EXACT_QUANTITIES 6 /* members of ExactSolution */

/* A bar in its initial state, along the contact normal */
typedef struct {
  const char *name;
  PetscReal   density, modulus, mass; /* kg/m^3, Pa, kg */
  PetscReal   length;                 /* m */
  PetscReal   lower, upper;           /* its ends as it lies at the start [m] */
  PetscReal   velocity;               /* m/s */
} ExactBar;

/* How far one quantity of the run is from the solution, over the steps so far */
typedef struct {
  PetscReal square, largest;     /* sum of the squares of the exact values, and the largest of them without sign */
  PetscReal error_square, worst; /* the same of the errors */
} ExactDistance;

struct _p_Exact {
  PETSCHEADER(int);
  ExactType type;
  void     *data; /* of the method of characteristics */
  /* the problem */
  PetscInt  body[2];         /* the bars on the Dirichlet and the Neumann side, among the controller's bodies */
  ExactBar  bars[2];         /* in the same order */
  PetscReal normal[3];       /* of the contact face on the Dirichlet side, outward */
  PetscReal start;           /* s */
  PetscReal frame_velocity;  /* of the centre of mass [m/s] */
  PetscReal impact_position; /* where the bars meet, along the normal, as seen from the centre of mass at the start [m] */
  /* figures of the solution */
  PetscReal impact, release; /* first contact, end of the last contact [s] */
  PetscReal turn, peak;      /* when the potential energy of the bar on the Dirichlet side is largest [s], and how large it is then [J] */
  PetscReal force, impulse;  /* mean force over the middle three fifths of the time from impact to release [N]; impulse of the run [N s] */
  /* the run */
  ExactDistance distance[2][EXACT_QUANTITIES]; /* of each bar, of each member of ExactSolution */
  PetscReal     peak_potential;                /* of the bar on the Dirichlet side [J] */
  PetscReal     last_contact, last_time;       /* end of the last step in contact, and of the last step [s] */
};

PETSC_INTERN PetscErrorCode ExactSetUpBars(Exact, Controller);
PETSC_INTERN PetscErrorCode ExactSetUpCharacteristics(Exact, Controller);
PETSC_INTERN PetscErrorCode ExactDestroyCharacteristics(Exact);
