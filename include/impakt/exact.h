/* Exact solutions to compare a run with. */
#pragma once
#include <impakt/controller.h>

/* The exact solution for two elastic bars that hit each other, and a run's distance from it. All is along the outward normal of the contact
   face on the Dirichlet side of the contact pair: that of the left bar of Hoy, Tezaur, Mota, section 4.2. The bars may move along together,
   lie anywhere, and point in any direction. */
typedef struct _p_Exact *Exact;

PETSC_EXTERN PetscClassId EXACT_CLASSID;

/*J
   ExactType - kind of exact solution

   Values:
+  `EXACT_CHARACTERISTICS` - the method of characteristics, for two bars of any lengths, materials and cross-sections
-  `EXACT_IMPACT`          - the same by the name that it has for equal bars: Hoy, Tezaur, Mota, eqs. (4.1) to (4.7)

   Options Database Key:
.  -exact (none|impact|characteristics) - compare the run with it

   Level: intermediate

.seealso: `OutputSetExact()`
J*/
typedef const char *ExactType;
#define EXACT_IMPACT          "impact"
#define EXACT_CHARACTERISTICS "characteristics"

/* The state of one bar at one time */
typedef struct {
  PetscReal contact_position; /* of the contact face along the normal [m] */
  PetscReal contact_velocity; /* [m/s] */
  PetscReal contact_force;    /* compression positive [N] */
  PetscReal kinetic;          /* J */
  PetscReal potential;        /* J */
  PetscReal mean_velocity;    /* mass-averaged [m/s] */
} ExactSolution;

/* Of the solution, see ExactGetFigures() */
typedef struct {
  PetscReal impact, release, force, impulse;
} ExactFigures;

/* Of one bar: relative L2 norms in time, as in ExactErrors, and largest error in time / largest exact value in time */
typedef struct {
  PetscReal kinetic, potential, mean_velocity;
  PetscReal kinetic_max, potential_max;
} ExactBodyErrors;

/* How far a run is from the exact solution; not-a-number where the run does not tell. Of the bar on the Dirichlet side, but for `bodies`.
   The first six are relative L2 norms in time over all controller steps, sqrt(sum (x - x_exact)^2 / sum x_exact^2); the contact position is
   measured from the point of impact, which moves with the centre of mass of both bars. `peak_potential` = (peak - exact peak) / exact peak;
   `release_time` = (release - t_release) / (t_release - t_impact), release being the end of the last controller step in contact, and
   t_release that of the last contact force. */
typedef struct {
  PetscReal       contact_position, contact_velocity, contact_force, kinetic, potential, mean_velocity;
  PetscReal       peak_potential, release_time;
  ExactBodyErrors bodies[2]; /* on the Dirichlet side, and its partner */
} ExactErrors;

PETSC_EXTERN PetscErrorCode      ExactInitializePackage(void);
PETSC_EXTERN PetscErrorCode      ExactCreate(Controller, ExactType, Exact *);
PETSC_EXTERN PetscErrorCode      ExactEvaluate(Exact, PetscInt, PetscReal, ExactSolution *);
PETSC_EXTERN PetscErrorCode      ExactGetFigures(Exact, ExactFigures *);
PETSC_EXTERN PetscErrorCode      ExactGetBodies(Exact, const char *[]);
PETSC_EXTERN ControllerMonitorFn ExactMonitor;
PETSC_EXTERN PetscErrorCode      ExactGetErrors(Exact, ExactErrors *);
PETSC_EXTERN PetscErrorCode      ExactView(Exact, PetscViewer);
PETSC_EXTERN PetscErrorCode      ExactDestroy(Exact *);
