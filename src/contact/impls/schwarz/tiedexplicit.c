/*
   Ties of explicit bodies that keep their mass, all with the controller step as their step. Under central differences a force at the end
   of a step moves nothing in it, but goes into the acceleration there. So the forces of the ties follow at once from the condition that the
   next step leaves the ties as they are,

     g + dt g' + dt^2/2 g'' = 0   after a change of the forces that changes g'' by C and g' by dt/2 C,   C = sum_bodies B M^{-1} B^T,

   with the gaps g of the ties. Where g = 0, this is one acceleration of both sides, as the uncut body has it. Nothing is to be iterated.
*/
#include "schwarzimpl.h"

/* What the next step would make of the gaps of the ties, over dt^2: the change of acceleration that keeps them */
static PetscErrorCode GetDrift(Contact contact, PetscScalar drift[])
{
  const PetscReal dt = contact->step;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscScalar       *velocity[2], *acceleration[2];

    for (PetscInt side = 0; side < 2; side++) {
      PetscCall(TraceGetLevel(contact->traces[pair->body[side]].velocity, 1, &velocity[side]));
      PetscCall(TraceGetLevel(contact->traces[pair->body[side]].acceleration, 1, &acceleration[side]));
    }
    for (PetscInt i = pair->begin; i < pair->end; i++)
      drift[i] = contact->end.gap[i] / PetscSqr(dt) + (velocity[1][i - pair->shift[1]] - velocity[0][i - pair->shift[0]]) / dt +
                 0.5 * (acceleration[1][i - pair->shift[1]] - acceleration[0][i - pair->shift[0]]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All bodies to the end of the controller step under the forces of the ties there */
static PetscErrorCode Integrate(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscScalar *force;

    PetscCall(TraceGetLevel(contact->traces[b].force_in, 1, &force));
    InverseMassGetBodyForces(contact, b, contact->end.force, force);
    PetscCall(BodyIntegrate(contact->bodies[b]));
  }
  PetscCall(ContactComputeGaps(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzStepTied(Contact contact)
{
  PetscScalar *const drift = ((Schwarz *)contact->data)->tied.drift[0];
  PetscLogDouble     begin, end;

  PetscFunctionBegin;
  PetscCall(PetscTime(&begin));
  PetscCall(PetscArraycpy(contact->end.active, contact->rows.tied, contact->rows.n));
  PetscCall(ContactSetConditions(contact, CONDITIONS_ACTIVE_FORCES));
  PetscCall(PetscArraycpy(contact->end.force, contact->start.force, contact->rows.n));
  PetscCall(Integrate(contact));
  PetscCall(GetDrift(contact, drift));
  PetscCall(InverseMassSolve(contact, contact->ties.inverse, drift, drift));
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->end.force[i] += PetscRealPart(drift[i]);
  PetscCall(Integrate(contact));
  contact->counts.sweeps++;
  PetscCall(PetscTime(&end));
  contact->counts.seconds += end - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The end of a controller step of implicit bodies, before the next one starts from it */
PetscErrorCode SchwarzAcceptTied(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  if (schwarz->tied.any && !schwarz->tied.forward) PetscCall(ContactAlignTies(contact, schwarz->tied.drift));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzSetUpTied(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(ContactSetUpTiedEnds(contact));
  if (!contact->ties.inverse || schwarz->tied.any) PetscFunctionReturn(PETSC_SUCCESS);
  schwarz->tied.any         = PETSC_TRUE;
  schwarz->tied.forward     = contact->ties.all_explicit;
  contact->energy.unlimited = "tied nodes keep their mass, and their forces are not those of massless layers";
  contact->attempt.moves_start =
      schwarz->tied.forward; /* the forces at the end of a step are those that its successor of the same size needs */
  PetscCall(PetscMalloc2(contact->rows.n, &schwarz->tied.drift[0], contact->rows.n, &schwarz->tied.drift[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroyTied(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(ContactDestroyTiedEnds(contact));
  PetscCall(PetscFree2(schwarz->tied.drift[0], schwarz->tied.drift[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
