/* How far rows in contact are turned from the surfaces, beside what friction can bear.

   A normal force along a row that is turned by an angle has a part along the surface of that angle times the force. Where the angle is not
   small beside mu, what sticks, what slides and what friction takes are those of other surfaces. Rows of bodies with inertia follow the
   surfaces in each step; others stay until the surfaces have turned by -contact_angle_bound. Forces on a linear body, which bears them as
   if it had not turned, are off by the angle by which it has. */
#include <contact/parts.h>

/* The most by which a linear body of a pair has turned [rad] */
static PetscErrorCode GetLinearTurn(Contact contact, const ContactPair *pair, PetscReal *turn)
{
  PetscFunctionBegin;
  *turn = 0;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    BodyMeasures measures;

    PetscCall(BodyGetMeasures(contact->bodies[pair->body[side]], &measures)); /* zero of a nonlinear one */
    *turn = PetscMax(*turn,
                     PetscSqrtReal(PetscSqr(measures.rotation[0]) + PetscSqr(measures.rotation[1]) + PetscSqr(measures.rotation[2])));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes the most by which normal forces along rows are off along the surfaces, in parts of what friction can bear, at the end of the
   accepted step, of pairs of bodies without inertia. Collective; surfaces are moved to where bodies are. */
PetscErrorCode ContactNoteTilt(Contact contact)
{
  PetscBool any = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) any = (PetscBool)(any || contact->pairs[p].rests);
  if (!any || contact->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactMoveSurfaces(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscReal          turn, limit[2], sums[2] = {0, 0}; /* of tilt times normal force, and of what friction can bear [N] */

    if (!pair->rests || pair->law != CONTACT_LAW_FRICTION) continue;
    PetscCall(TransferGetTilts(pair->transfer, contact->work.tilts));
    PetscCall(GetLinearTurn(contact, pair, &turn));
    ContactGetFrictionLimit(contact, pair, 0, limit);
    for (PetscInt first = pair->begin, k = 0; first < pair->end; first += pair->components, k++) {
      if (!(contact->end.force[first] > 0) || !contact->rows.opposite[first]) continue;
      sums[0] += (turn + contact->work.tilts[k]) * contact->end.force[first];
      sums[1] += limit[0] + limit[1] * contact->end.force[first];
    }
    PetscCall(ContactReduce(contact, 2, MPIU_REAL, MPIU_SUM, sums));
    if (sums[1] > 0) contact->counts.friction_tilt = PetscMax(contact->counts.friction_tilt, sums[0] / sums[1]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
