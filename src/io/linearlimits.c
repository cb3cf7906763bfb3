/* What is too much for a linear material: bodies that turn far, and elements that are turned inside out. */
#include "linearlimits.h"
#include <sys/units.h>
#include <impakt/private/bodymeasures.h>

/* Controller steps from look to look at the elements. A look at each step would cost an explicit body with strong strains 16 to 19 % of its
   time. */
#define LOOK_EVERY 16
/* Bodies of which a run tells while it goes on; the verdict at its end has the number of all */
#define MOST_TOLD 3

/* Whether a run tells of one more body, with so many before it */
static PetscErrorCode Tells(Body body, PetscInt before, PetscBool *tells)
{
  PetscFunctionBegin;
  *tells = (PetscBool)(before < MOST_TOLD);
  if (before == MOST_TOLD)
    PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)body), stderr,
                           "impakt: warning: the same is true of more bodies from now on; their number is told at the end\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes how far a body has turned, and tells where a linear one goes too far; once. `far`: bodies that have. */
static PetscErrorCode CheckRotation(Body body, const ControllerFrame *frame, const PetscReal rotation[3], BodyStatistics *statistics,
                                    PetscInt *far)
{
  const PetscReal angle  = PetscSqrtReal(PetscSqr(rotation[0]) + PetscSqr(rotation[1]) + PetscSqr(rotation[2]));
  const PetscReal before = statistics->rotation_max;
  const char     *name;
  PetscBool       tells;

  PetscFunctionBegin;
  statistics->rotation_max = PetscMax(before, angle);
  if (before > STATISTICS_FAR_TURN || angle <= STATISTICS_FAR_TURN) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Tells(body, (*far)++, &tells));
  if (!tells) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectGetName((PetscObject)body, &name));
  PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)body), stderr,
                         "impakt: warning: body '%s' has turned by %.3g rad at time %g%s: its linear material counts rotations as strains, "
                         "so that energy and angular momentum are wrong by terms of the angle squared; set -%s_material_type "
                         "saint_venant_kirchhoff or neo_hookean\n",
                         name, (double)angle, (double)frame->time, UnitsOf((PetscObject)body, UNIT_TIME), name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells where elements of a linear body are inside out; once. Those of nonlinear ones fail a step. `torn`: bodies of which some are. */
static PetscErrorCode CheckElements(Body body, const ControllerFrame *frame, PetscReal potential, BodyStatistics *statistics,
                                    PetscInt *torn)
{
  PetscReal   centre[3];
  PetscInt    number, before;
  const char *name;
  PetscBool   tells;

  PetscFunctionBegin;
  if (frame->step % LOOK_EVERY && frame->step != frame->steps) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetInverted(body, potential, &number, centre));
  before                   = statistics->inverted_max;
  statistics->inverted_max = PetscMax(before, number);
  if (before || !number) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Tells(body, (*torn)++, &tells));
  if (!tells) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectGetName((PetscObject)body, &name));
  PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)body), stderr,
                         "impakt: warning: body '%s' has %" PetscInt_FMT " element%s inside out at time %g%s, around (%g, %g, %g)%s of the "
                         "undeformed mesh: its strains are far beyond those of its linear material; check units, loads and speeds, or set "
                         "-%s_material_type neo_hookean\n",
                         name, number, number == 1 ? "" : "s", (double)frame->time, UnitsOf((PetscObject)body, UNIT_TIME),
                         (double)centre[0], (double)centre[1], (double)centre[2], UnitsOf((PetscObject)body, UNIT_LENGTH), name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes and tells what is too much for the linear materials of bodies. Collective */
PetscErrorCode LinearLimitsCheck(Controller controller, const ControllerFrame *frame, BodyStatistics statistics[])
{
  const Body *bodies;
  PetscInt    far = 0, torn = 0;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, NULL, &bodies));
  for (PetscInt i = 0; i < frame->n_bodies; i++) {
    far += statistics[i].rotation_max > STATISTICS_FAR_TURN;
    torn += statistics[i].inverted_max > 0;
  }
  for (PetscInt i = 0; i < frame->n_bodies; i++) {
    PetscCall(CheckRotation(bodies[i], frame, frame->bodies[i].rotation, &statistics[i], &far));
    PetscCall(CheckElements(bodies[i], frame, frame->bodies[i].potential, &statistics[i], &torn));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
