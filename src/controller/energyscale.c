/* What changes of the energy of all bodies are relative to: in the summary, in the history and on the terminal alike. */
#include "energyscale.h"
#include <impakt/private/bodyrows.h>

/* Of the kinetic energy this part counts even where all bodies move alike: less is round-off of it */
#define ROUND_OFF 1e-9

/* Kinetic energy of the bodies that do not follow a given motion [J]. Where nothing outside holds, loads or stops any of them, that of
   their common motion is left out: so the scale is the same in frames that move, and speed beside the contact hides no error. */
static PetscErrorCode GetKinetic(Controller controller, const ControllerFrame *frame, PetscReal *kinetic)
{
  PetscReal   momentum[3] = {0}, mass = 0, common = 0;
  PetscBool   free = PETSC_TRUE;
  const Body *bodies;

  PetscFunctionBegin;
  *kinetic = 0;
  PetscCall(ControllerGetBodies(controller, NULL, &bodies));
  for (PetscInt b = 0; b < frame->n_bodies; b++) {
    const BodyMeasures *body = &frame->bodies[b];
    PetscReal           of_body;
    PetscBool           led;

    PetscCall(BodyGetLed(bodies[b], NULL, &led));
    PetscCall(BodyGetMass(bodies[b], &of_body));
    /* the staggered energy is round-off of much more, or negative, in the first step of a load that sets in at zero */
    *kinetic += led ? 0 : body->kinetic_unstaggered;
    for (PetscInt d = 0; d < 3; d++) momentum[d] += body->momentum[d];
    mass += of_body;
    free = (PetscBool)(free && !body->loaded);
  }
  for (PetscInt d = 0; d < 3; d++) common += 0.5 * PetscSqr(momentum[d]) / mass;
  if (free) *kinetic = PetscMax(*kinetic - common, ROUND_OFF * *kinetic);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  EnergyScaleAdd - takes note of the state at the end of a controller step; that of step 0 is the start

  Collective

  Input Parameters:
+ scale      - zeros before the first call
. controller - the `Controller`
- frame      - the state of everything; takes the change of the energy and what it is relative to

  Note:
  The scale is the largest so far of kinetic energy, strain energy and work: of loads, held displacements and moving obstacles, or what
  friction, damping and plastic flow have taken. The energy at the start alone says nothing of a body that hardly moves then and is driven
  afterwards, nor does the strain energy of a body that slides for long.
*/
PetscErrorCode EnergyScaleAdd(EnergyScale *scale, Controller controller, ControllerFrame *frame)
{
  PetscReal balance = frame->friction_loss - frame->obstacle_work, kinetic, strain = 0;
  PetscReal done = PetscAbsReal(frame->obstacle_work), taken = frame->friction_loss;

  PetscFunctionBegin;
  PetscCall(GetKinetic(controller, frame, &kinetic));
  for (PetscInt b = 0; b < frame->n_bodies; b++) {
    const BodyMeasures *body = &frame->bodies[b];

    balance += BodyMeasuresGetBalance(body);
    strain += body->potential;
    done += PetscAbsReal(body->external_work);
    taken += body->damping_work + body->plastic_work;
  }
  if (!frame->step) scale->start = balance;
  scale->largest       = PetscMax(scale->largest, PetscMax(PetscMax(kinetic, strain), PetscMax(done, taken)));
  frame->energy_change = balance - scale->start;
  frame->energy_scale  = scale->largest;
  PetscFunctionReturn(PETSC_SUCCESS);
}
