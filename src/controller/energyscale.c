/* What changes of the energy of all bodies are relative to. */
#include "energyscale.h"
#include <impakt/private/bodyrows.h>

/* A body starts at rest if no node is faster than this part of its wave speed, and without strain if its energy is below that of this
   strain everywhere: both are round-off of what the user gave, of velocities by formulas and of displacements that move the body as a whole
 */
#define NO_SPEED  1e-14
#define NO_STRAIN 1e-10

/* Whether a body starts at rest and without strain, or with a motion that is given to it for good */
static PetscErrorCode StartsFromRest(Body body, const BodyMeasures *measures, PetscBool *rest)
{
  PetscReal density, modulus, mass, speed;
  Material  material;
  Vec       v;

  PetscFunctionBegin;
  PetscCall(BodyGetLed(body, NULL, rest));
  if (*rest) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetSurfaceMaterial(body, &material));
  PetscCall(MaterialGetDensity(material, &density));
  PetscCall(MaterialGetWaveModulus(material, &modulus));
  PetscCall(BodyGetMass(body, &mass));
  PetscCall(BodyGetSolution(body, NULL, &v, NULL));
  PetscCall(VecNorm(v, NORM_INFINITY, &speed));
  *rest = (PetscBool)(speed <= NO_SPEED * PetscSqrtReal(modulus / density) &&
                      measures->potential <= 0.5 * modulus * mass / density * PetscSqr(NO_STRAIN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  EnergyScaleAdd - takes note of the state at the end of a controller step; that of step 0 is the start

  Collective

  Input Parameters:
+ scale      - zeros before the first call
. controller - the `Controller`
- frame      - the state of everything
*/
PetscErrorCode EnergyScaleAdd(EnergyScale *scale, Controller controller, const ControllerFrame *frame)
{
  const Body *bodies;
  PetscReal   size = 0;
  PetscBool   rest;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, NULL, &bodies));
  if (!frame->step) scale->from_rest = PETSC_TRUE;
  for (PetscInt b = 0; b < frame->n_bodies; b++) {
    const BodyMeasures *body = &frame->bodies[b];

    PetscCall(BodyGetLed(bodies[b], NULL, &rest));
    size += (rest ? 0 : body->kinetic) + body->potential + PetscAbsReal(body->external_work);
    if (frame->step) continue;
    scale->start += BodyMeasuresGetBalance(body);
    PetscCall(StartsFromRest(bodies[b], body, &rest));
    scale->from_rest = (PetscBool)(scale->from_rest && rest);
    if (rest) scale->given += body->kinetic;
  }
  scale->largest = PetscMax(scale->largest, size + PetscAbsReal(frame->obstacle_work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What changes are relative to: the energy at the start. Only where there is none it is the largest so far, for an energy that grows must
   not raise what it is compared with. */
PetscReal EnergyScaleGet(const EnergyScale *scale)
{
  const PetscReal start = scale->start - scale->given;

  return scale->from_rest || start <= 0 ? scale->largest : start;
}

/* By how much there is more energy in a frame than at the start, with what friction has taken since, and without the work of moving
   obstacles [J] */
PetscReal EnergyScaleChange(const EnergyScale *scale, const ControllerFrame *frame)
{
  PetscReal energy = frame->friction_loss - frame->obstacle_work;

  for (PetscInt b = 0; b < frame->n_bodies; b++) energy += BodyMeasuresGetBalance(&frame->bodies[b]);
  return energy - scale->start;
}
