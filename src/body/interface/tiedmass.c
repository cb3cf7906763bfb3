/* Bodies whose contact nodes keep their mass because they are tied to nodes that move by the same rule. */
#include <body/layout/bodyimpl.h>

/* Whether two bodies with inertia have integrators of one type, equal parameters and equal substeps, which are not automatic; after
   BodySetUpDiscretization() and BodySetControllerStep(). Collective. */
PetscErrorCode BodyIntegratesLike(Body body, Body other, PetscBool *alike)
{
  const Body bodies[2]        = {body, other};
  PetscReal  parameters[2][4] = {{0}}, substeps[2];
  PetscBool  same, newmark;

  PetscFunctionBegin;
  PetscCall(PetscStrcmp(body->integrator->type, other->integrator->type, &same));
  *alike = (PetscBool)(same && body->integrator->has_inertia);
  for (PetscInt k = 0; k < 2 && *alike; k++) {
    const BodyTime *time = &bodies[k]->time;

    if (time->requested_step < 0) *alike = PETSC_FALSE;
    substeps[k] = time->requested_step > 0 ? PetscFloorReal(0.5 + time->controller_step / time->requested_step) : 1;
    PetscCall(PetscObjectTypeCompare((PetscObject)time->ts, TSALPHA2, &newmark));
    if (newmark) PetscCall(TSAlpha2GetParams(time->ts, &parameters[k][0], &parameters[k][1], &parameters[k][2], &parameters[k][3]));
  }
  if (!*alike) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < 4; i++) *alike = (PetscBool)(*alike && parameters[0][i] == parameters[1][i]);
  *alike = (PetscBool)(*alike && substeps[0] == substeps[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the body is to make one substep in a controller step, and that not by automatic choice */
PetscErrorCode BodyRequestsControllerStep(Body body, PetscBool *requests)
{
  const PetscReal step = body->time.requested_step;

  PetscFunctionBegin;
  *requests = (PetscBool)(step == 0 || (step > 0 && PetscFloorReal(0.5 + body->time.controller_step / step) == 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether program or options have set what becomes of the mass of contact nodes, and whether these are to be massless */
PetscErrorCode BodyMassIsChosen(Body body, PetscBool *chosen, PetscBool *redistribute)
{
  PetscFunctionBegin;
  *chosen       = body->mass.chosen;
  *redistribute = body->mass.redistribute;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether prescribed rows take velocity and acceleration from their partner: where contact nodes have mass and are not tied */
PetscErrorCode BodyPrescribesMass(Body body, PetscBool *prescribes)
{
  PetscFunctionBegin;
  *prescribes = (PetscBool)(!body->mass.redistribute && !body->rows.tied_mass && body->integrator->has_inertia);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Declares, before the set-up, that rows on nodes with mass are ties to nodes that move by the same rule: constraints in the equations
   of motion. Velocity and acceleration follow from the prescribed displacement then, and the force has the inertia of the nodes. */
PetscErrorCode BodySetTiedMass(Body body, PetscBool tied)
{
  PetscFunctionBegin;
  BodyCheckNotSetUp(body);
  body->rows.tied_mass = tied;
  PetscFunctionReturn(PETSC_SUCCESS);
}
