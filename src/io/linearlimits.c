/* What is too much for a linear material: bodies that turn far, and elements that are turned inside out. */
#include "linearlimits.h"
#include <sys/units.h>
#include <impakt/private/bodymeasures.h>

/* Controller steps between looks at the elements: in each step a look takes 16 to 19 % of the time of a strongly strained explicit body. */
#define LOOK_EVERY 16

/* Tells that a linear body has turned too far */
static PetscErrorCode TellRotation(Body body, PetscReal angle, PetscReal time)
{
  const char *name;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetName((PetscObject)body, &name));
  PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)body), stderr,
                         "impakt: warning: body '%s' has turned by %.3g rad at time %g%s: its linear material counts rotations as strains, "
                         "so that energy and angular momentum are wrong by terms of the angle squared; set -%s_material_type "
                         "saint_venant_kirchhoff or neo_hookean\n",
                         name, (double)angle, (double)time, UnitsOf((PetscObject)body, UNIT_TIME), name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells that elements of a linear body are inside out. Those of nonlinear ones fail a step. */
static PetscErrorCode TellElements(Body body, PetscInt number, const PetscReal centre[3], PetscReal time)
{
  const char *name;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetName((PetscObject)body, &name));
  PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)body), stderr,
                         "impakt: warning: body '%s' has %" PetscInt_FMT " element%s inside out at time %g%s, around (%g, %g, %g)%s of the "
                         "undeformed mesh: its strains are far beyond those of its linear material; check units, loads and speeds, or set "
                         "-%s_material_type neo_hookean\n",
                         name, number, number == 1 ? "" : "s", (double)time, UnitsOf((PetscObject)body, UNIT_TIME), (double)centre[0],
                         (double)centre[1], (double)centre[2], UnitsOf((PetscObject)body, UNIT_LENGTH), name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes what is too much for the linear materials of bodies, and tells of the first body that it is; the verdict at the end of the run has
   all. Collective */
PetscErrorCode LinearLimitsCheck(Controller controller, const ControllerFrame *frame, BodyStatistics statistics[])
{
  const PetscBool looks = (PetscBool)(frame->step % LOOK_EVERY == 0 || frame->step == frame->steps);
  const Body     *bodies;
  PetscBool       far = PETSC_FALSE, torn = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, NULL, &bodies));
  for (PetscInt i = 0; i < frame->n_bodies; i++) {
    far  = (PetscBool)(far || statistics[i].rotation_max > STATISTICS_FAR_TURN);
    torn = (PetscBool)(torn || statistics[i].inverted_max > 0);
  }
  for (PetscInt i = 0; i < frame->n_bodies; i++) {
    const PetscReal angle = StatisticsNorm(frame->bodies[i].rotation);
    PetscReal       centre[3];
    PetscInt        number = 0;

    if (angle > STATISTICS_FAR_TURN && !far) PetscCall(TellRotation(bodies[i], angle, frame->time));
    far                        = (PetscBool)(far || angle > STATISTICS_FAR_TURN);
    statistics[i].rotation_max = PetscMax(statistics[i].rotation_max, angle);
    if (looks) PetscCall(BodyGetInverted(bodies[i], frame->bodies[i].potential, &number, centre));
    if (number && !torn) PetscCall(TellElements(bodies[i], number, centre, frame->time));
    torn                       = (PetscBool)(torn || number);
    statistics[i].inverted_max = PetscMax(statistics[i].inverted_max, number);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
