/* Closed-form solutions to compare a run with. */
#pragma once
#include <controller.h>

/*S
   ExactImpact - the closed-form solution for two equal elastic bars that hit each other, and a run's distance from it

   Level: intermediate

   Note:
   Everything is told of the bar on the Dirichlet side of the contact pair, along the outward normal of its contact face: the left
   bar of Hoy, Tezaur, Mota, section 4.2. The bars may move along together, lie anywhere, and point in any direction.

.seealso: `ExactImpactCreate()`, `ExactImpactEvaluate()`, `ExactImpactMonitor()`
S*/
typedef struct _n_ExactImpact *ExactImpact;

/*S
   ExactSolution - the state of the bar on the Dirichlet side at one time

   Level: intermediate

.seealso: `ExactImpactEvaluate()`
S*/
typedef struct {
  PetscReal contact_position; /* of the contact face along the normal [m] */
  PetscReal contact_velocity; /* [m/s] */
  PetscReal contact_force;    /* compression positive [N] */
  PetscReal kinetic;          /* J */
  PetscReal potential;        /* J */
  PetscReal mean_velocity;    /* mass-averaged [m/s] */
} ExactSolution;

/*S
   ExactErrors - how far a run is from the closed-form solution; not-a-number where the run does not tell

   Level: intermediate

   Notes:
   The first six are relative L2 norms in time over all controller steps, sqrt(sum (x - x_exact)^2 / sum x_exact^2). The contact
   position is measured from the point of impact, which moves with the mean velocity of both bars: the origin of the coordinates
   has no say.

   `peak_potential` = (peak - exact peak) / exact peak. `release_time` = (release - t_release) / (t_release - t_impact), release
   being the end of the last controller step in contact.

.seealso: `ExactImpactGetErrors()`
S*/
typedef struct {
  PetscReal contact_position, contact_velocity, contact_force, kinetic, potential, mean_velocity;
  PetscReal peak_potential, release_time;
} ExactErrors;

PETSC_EXTERN PetscErrorCode      ExactImpactCreate(Controller, ExactImpact *);
PETSC_EXTERN PetscErrorCode      ExactImpactEvaluate(ExactImpact, PetscReal, ExactSolution *);
PETSC_EXTERN PetscErrorCode      ExactImpactGetTimes(ExactImpact, PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode      ExactImpactGetForce(ExactImpact, PetscReal *);
PETSC_EXTERN ControllerMonitorFn ExactImpactMonitor;
PETSC_EXTERN PetscErrorCode      ExactImpactGetErrors(ExactImpact, ExactErrors *);
PETSC_EXTERN PetscErrorCode      ExactImpactDestroy(ExactImpact *);
