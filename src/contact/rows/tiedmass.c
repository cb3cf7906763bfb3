/* Ties between bodies that move by the same rule keep the mass of their nodes: with lambda as the force of a tie, the equations

     M a + internal force = forces + B^T lambda,   B_N u_N - B_D u_D = what it was at the start

   are those of the uncut body, and one rule in time takes both sides through the same displacements. So velocities and accelerations agree
   in all steps if they do in the first state: what bodies start with is projected there, by impulses and forces of the ties. Between bodies
   with other integrators or steps tied nodes are massless. */
#include <contact/rows/inversemass.h>
#include <impakt/private/bodyforces.h>
#include <impakt/private/bodymass.h>

/* Whether both bodies of a pair would have one rule for all their tied nodes, and nobody has asked for massless ones */
static PetscErrorCode CanKeepMass(Contact contact, const ContactPair *pair, PetscBool *can)
{
  PetscFunctionBegin;
  *can = PETSC_FALSE;
  if (pair->obstacle || pair->law != CONTACT_LAW_TIED) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyIntegratesLike(contact->bodies[pair->body[0]], contact->bodies[pair->body[1]], can));
  for (PetscInt side = 0; side < 2; side++) {
    PetscBool chosen, massless;

    PetscCall(BodyMassIsChosen(contact->bodies[pair->body[side]], &chosen, &massless));
    if (chosen && massless) *can = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces of explicit bodies act in the step that follows: methods that find forces solve their ties at once, or nodes are massless */
static PetscErrorCode LeaveOutExplicit(Contact contact)
{
  PetscBool suits = contact->sideless;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs && suits; p++) {
    const Body body = contact->bodies[contact->pairs[p].body[0]];

    suits = (PetscBool)(contact->pairs[p].keeps_mass && BodyDoes(body, BodyIsExplicit) && BodyDoes(body, BodyRequestsControllerStep));
  }
  for (PetscInt p = 0; p < contact->n_pairs && !suits; p++)
    if (BodyDoes(contact->bodies[contact->pairs[p].body[0]], BodyIsExplicit)) contact->pairs[p].keeps_mass = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In each set of bodies all pairs keep their mass, or none: nodes of a body go by one rule, whoever its partners are */
static PetscErrorCode LeaveOutSets(Contact contact)
{
  PetscInt  *set;
  PetscBool *all;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(contact->n_bodies, &set, contact->n_bodies, &all));
  ContactFindSets(contact, set);
  for (PetscInt b = 0; b < contact->n_bodies; b++) all[b] = PETSC_TRUE;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (!contact->pairs[p].keeps_mass) all[set[contact->pairs[p].body[0]]] = PETSC_FALSE;
  for (PetscInt p = 0; p < contact->n_pairs; p++) contact->pairs[p].keeps_mass = all[set[contact->pairs[p].body[0]]];
  PetscCall(PetscFree2(set, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds out which pairs keep the mass of their nodes. Before the nodes of the others are made massless, and before bodies are set up. */
PetscErrorCode ContactChooseTiedMass(Contact contact)
{
  PetscFunctionBegin;
  if (!ContactAllPairsTie(contact) || !(contact->prescribes || contact->impulses)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CanKeepMass(contact, &contact->pairs[p], &contact->pairs[p].keeps_mass));
  PetscCall(LeaveOutExplicit(contact));
  PetscCall(LeaveOutSets(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt side = 0; side < 2 && contact->pairs[p].keeps_mass; side++)
      PetscCall(BodySetTiedMass(contact->bodies[contact->pairs[p].body[side]], PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells the bodies which rows act by their mean force, see BodySetMeanForces(), with the ties as they are now */
PetscErrorCode ContactSetMeanForces(Contact contact)
{
  PetscBool *by_mean;

  PetscFunctionBegin;
  if (!contact->ties.by_mean) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(contact->rows.n, &by_mean));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const ContactBodyRows *of = &contact->body_rows[b];

    for (PetscInt k = 0; k < of->n; k++) {
      const PetscInt     i    = of->rows[k];
      const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];

      by_mean[k] = (PetscBool)(contact->rows.tied[i] && pair->law == CONTACT_LAW_TIED && !pair->keeps_mass);
    }
    PetscCall(BodySetMeanForces(contact->bodies[b], by_mean));
  }
  PetscCall(PetscFree(by_mean));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One velocity and acceleration of both sides of ties that keep their mass, in the first state, and the forces that this takes */
PetscErrorCode ContactStartTies(Contact contact)
{
  PetscScalar *change[2], *reaction; /* impulses, forces */
  InverseMass  inverse;
  PetscBool    any = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) any = (PetscBool)(any || contact->pairs[p].keeps_mass);
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc2(contact->rows.n, &change[0], contact->rows.n, &change[1]));
  PetscCall(InverseMassCreate(contact, INVERSE_MASS_ONCE, &inverse));
  PetscCall(InverseMassAlign(contact, &inverse, BODY_AT_START, change));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodyWriteStartTraces(contact->bodies[b]));
    PetscCall(TraceGetLevel(contact->traces[b].reaction, 0, &reaction));
    ContactTakeRows(contact, b, change[1], reaction);
  }
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (!inverse.takes_part[i]) continue;
    contact->start.force[i] = contact->end.force[i] = PetscRealPart(change[1][i]);
    contact->start.active[i] = contact->end.active[i] = PETSC_TRUE;
  }
  PetscCall(ContactStartImpulses(contact));
  PetscCall(InverseMassDestroy(&inverse));
  PetscCall(PetscFree2(change[0], change[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
