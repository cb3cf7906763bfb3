/*
   Forward-increment Lagrange multipliers (Carpenter, Taylor, Katona 1991): the contact forces at t_n are those that close the
   gaps at t_{n+1}. With central differences a force lambda that acts at t_n moves the gaps at t_{n+1} by C lambda,
   C = dt^2 sum_bodies B M^{-1} B^T, so that after a free trial step with gaps g

     g + C lambda >= 0,   lambda >= 0,   lambda . (g + C lambda) = 0.
*/
#include "lagrangeimpl.h"
#include "complementarity.h"

typedef struct {
  Complementarity forces; /* C: [m/N] */
} ForwardLagrange;

static PetscErrorCode ContactStep_ForwardLagrange(Contact contact)
{
  ForwardLagrange *lagrange = (ForwardLagrange *)contact->data;
  PetscBool        penetrating;
  PetscLogDouble   begin, end;
  int              any = 0;

  PetscFunctionBegin;
  PetscCall(ContactIntegrateFree(contact, &penetrating));
  for (PetscInt i = 0; i < contact->n_rows; i++) any |= contact->gap[i] < 0 && (penetrating || contact->saved_active[i]);
  PetscCall(ContactOr(contact, &any));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscTime(&begin));
  PetscCall(ComplementarityGather(contact, contact->gap, &lagrange->forces));
  PetscCall(ComplementaritySolve(contact, contact->tolerance, &lagrange->forces));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(ComplementarityGetBodyForces(contact, b, &lagrange->forces, lagrange->forces.mine));
    PetscCall(BodyAddImpulse(contact->bodies[b], lagrange->forces.mine));
    PetscCall(BodyIntegrate(contact->bodies[b]));
  }
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    contact->force[i]  = lagrange->forces.forces[contact->row_begin + i];
    contact->active[i] = (PetscBool)(contact->force[i] > 0);
  }
  PetscCall(ContactComputeGaps(contact));
  contact->counts_made.sweeps = 1;
  PetscCall(PetscTime(&end));
  contact->counts_made.seconds += end - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactDestroy_ForwardLagrange(Contact contact)
{
  ForwardLagrange *lagrange = (ForwardLagrange *)contact->data;

  PetscFunctionBegin;
  PetscCall(ComplementarityDestroy(&lagrange->forces));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For bodies that have been found to be explicit, with one step and mass on their contact nodes */
PetscErrorCode LagrangeSetUpForward(Contact contact)
{
  ForwardLagrange *lagrange;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lagrange));
  contact->data         = lagrange;
  contact->ops->step    = ContactStep_ForwardLagrange;
  contact->ops->destroy = ContactDestroy_ForwardLagrange;
  PetscCall(ComplementarityCreate(contact, &lagrange->forces));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscScalar *body;

    PetscCall(BodyComputeForwardCompliance(contact->bodies[b], &body));
    PetscCall(ContactAddCompliance(contact, b, body, lagrange->forces.compliance));
    PetscCall(PetscFree(body));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
