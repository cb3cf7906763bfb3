/* What changes of the energy of all bodies are relative to: in the summary, in the history and on the terminal alike. */
#include "energyscale.h"
#include <impakt/private/bodymeasures.h>

/* Takes note of the state at the end of a controller step; that of step 0 is the start. `scale`: zeros before the first call. The scale
   is the largest so far of kinetic energy, strain energy and work: of loads, held displacements and moving obstacles, or what friction,
   damage of glue, damping and plastic flow have taken. The energy at the start alone says nothing of a body that hardly moves then and is
   driven afterwards, nor does the strain energy of a body that slides for long. Collective */
PetscErrorCode EnergyScaleAdd(EnergyScale *scale, const Body bodies[], ControllerFrame *frame)
{
  const PetscReal glue  = frame->penalty_energy - frame->uncounted_energy;
  PetscReal       taken = frame->friction_loss + frame->glue_loss, done = PetscAbsReal(frame->obstacle_work);
  PetscReal       balance = taken - frame->obstacle_work + glue, kinetic, strain = glue;

  PetscFunctionBegin;
  PetscCall(BodyGetOwnKinetic(frame->n_bodies, bodies, frame->bodies, &kinetic));
  for (PetscInt b = 0; b < frame->n_bodies; b++) {
    const BodyMeasures *body = &frame->bodies[b];

    balance += BodyMeasuresGetBalance(body);
    strain += body->potential;
    done += PetscAbsReal(body->external_work);
    taken += body->damping_work + body->plastic_work;
  }
  if (!frame->step) scale->start = balance;
  if (frame->step == 1) {
    PetscReal held;

    PetscCall(BodySumStartEnergies(frame->n_bodies, bodies, &held));
    scale->start += held;
  }
  scale->largest       = PetscMax(scale->largest, PetscMax(PetscMax(kinetic, strain), PetscMax(done, taken)));
  frame->energy_change = balance - scale->start;
  frame->energy_scale  = scale->largest;
  PetscFunctionReturn(PETSC_SUCCESS);
}
