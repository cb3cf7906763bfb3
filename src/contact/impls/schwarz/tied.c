/*
   Ties that keep their mass: set-up, and what keeps both sides together over many steps. Newmark's formulas make velocities and
   accelerations from differences of displacements over dt and dt^2. What round-off leaves between the two sides of a tie comes back with
   the other sign in each step, and adds up: after 700 steps contact forces had 1e-9 of themselves in it. So both sides are brought to one
   velocity and one acceleration at the end of each step, by impulses and forces of the size of round-off that act on both alike.
*/
#include "schwarzimpl.h"

/* Differences of velocity or acceleration of both sides of each tie at the end of the step */
static PetscErrorCode GetEndRates(Contact contact, PetscInt order, PetscScalar rates[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscScalar       *end[2];

    for (PetscInt side = 0; side < 2; side++) {
      const BodyTraces *traces = &contact->traces[pair->body[side]];
      const Trace       trace  = order == 1 ? traces->velocity : traces->acceleration;
      PetscInt          levels;

      PetscCall(TraceGetSizes(trace, NULL, &levels));
      PetscCall(TraceGetLevel(trace, levels, &end[side]));
    }
    for (PetscInt i = pair->begin; i < pair->end; i++) rates[i] = end[1][i - pair->shift[1]] - end[0][i - pair->shift[0]];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The end of a controller step of implicit bodies, before the next one starts from it */
PetscErrorCode SchwarzAcceptTied(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  if (!schwarz->tied.any || schwarz->tied.forward) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt order = 1; order <= 2; order++) {
    PetscCall(GetEndRates(contact, order, schwarz->tied.drift));
    PetscCall(InverseMassSolve(contact, &schwarz->tied.inverse, schwarz->tied.drift, schwarz->tied.drift));
    for (PetscInt b = 0; b < contact->n_bodies; b++) {
      InverseMassGetBodyForces(contact, b, schwarz->tied.drift, schwarz->row_work);
      if (order == 1) PetscCall(BodyAddLumpedVelocity(contact->bodies[b], schwarz->row_work));
      else PetscCall(BodyAddLumpedAcceleration(contact->bodies[b], schwarz->row_work));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds out which ties keep their mass, with the rows as they are */
PetscErrorCode SchwarzSetUpTied(Contact contact)
{
  Schwarz  *schwarz = (Schwarz *)contact->data;
  PetscBool is_explicit;

  PetscFunctionBegin;
  if (schwarz->tied.any) PetscCall(InverseMassDestroy(&schwarz->tied.inverse));
  else {
    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      if (!contact->pairs[p].keeps_mass) continue;
      schwarz->tied.any = PETSC_TRUE;
      PetscCall(BodyIsExplicit(contact->bodies[contact->pairs[p].body[0]], &is_explicit));
      schwarz->tied.forward = is_explicit; /* then all are, see ContactChooseTiedMass() */
    }
    if (!schwarz->tied.any) PetscFunctionReturn(PETSC_SUCCESS);
    contact->energy.unlimited = "tied nodes keep their mass, and their forces are not those of massless layers";
    contact->attempt.moves_start =
        schwarz->tied.forward; /* the forces at the end of a step are those that its successor of the same size needs */
    PetscCall(PetscMalloc1(contact->rows.n, &schwarz->tied.drift));
  }
  PetscCall(InverseMassCreate(contact, schwarz->tied.forward ? INVERSE_MASS_ASSEMBLED : INVERSE_MASS_LUMPED, &schwarz->tied.inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroyTied(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  if (!schwarz->tied.any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(InverseMassDestroy(&schwarz->tied.inverse));
  PetscCall(PetscFree(schwarz->tied.drift));
  PetscFunctionReturn(PETSC_SUCCESS);
}
