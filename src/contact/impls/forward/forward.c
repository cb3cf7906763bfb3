/* Forward-increment Lagrange multipliers (Carpenter, Taylor, Katona 1991): the contact forces at t_n are those that close the
   gaps at t_{n+1}. With central differences a force lambda that acts at t_n moves the gaps at t_{n+1} by C lambda,
   C = dt^2 sum_bodies B M^{-1} B^T, so that after a free trial step with gaps g

     g + C lambda >= 0,   lambda >= 0,   lambda . (g + C lambda) = 0.

   All is divided by dt^2: so the same matrix finds the impulses that close the rate beside the gap. */
#include "forwardimpl.h"
#include <sys/citations.h>
#include <impakt/private/bodyforces.h>

/* Part of a penetration at the start of a step that is taken back in it. Where rows are built again on surfaces that have slid, gaps jump
   by a small part of an element; to close that within one explicit step would take velocities that have nothing to do with the impact. */
#define RECOVERY 0.02

/* What is to be closed of the gap at the end of a free step */
static PetscReal GapToClose(Contact contact, PetscInt i)
{
  const PetscReal start   = contact->start.gap[i];
  const PetscBool touches = (PetscBool)(contact->start.active[i] || contact->end.gap[i] < -contact->options.tolerance);

  /* a gap that is left as it is when the bodies meet stays so */
  if (contact->options.constraint == CONTACT_CONSTRAINT_GAP_RATE) return contact->end.gap[i] - (touches ? start : 0);
  return contact->end.gap[i] - (start < -contact->options.tolerance ? (1 - RECOVERY) * start : 0);
}

static PetscErrorCode ContactStep_ForwardLagrange(Contact contact)
{
  const PetscReal  parts[] = {0, 0.5 * contact->step, 1};
  Complementarity *problem = (Complementarity *)contact->data;
  PetscBool        penetrating;
  PetscLogDouble   begin, end;
  PetscBool        any = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(ContactIntegrateFree(contact, &penetrating));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    problem->gaps[i] = (contact->rows.tied[i] ? contact->end.gap[i] : GapToClose(contact, i)) / PetscSqr(contact->step);
    if (contact->rows.tied[i] || (problem->gaps[i] < 0 && (penetrating || contact->start.active[i]))) any = PETSC_TRUE;
  }
  PetscCall(ContactOr(contact, &any));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscTime(&begin));
  PetscCall(ComplementaritySolve(contact, PETSC_FALSE, problem));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ComplementarityApply(contact, problem, BODY_AT_START, parts));
  PetscCall(ContactIntegrateBodies(contact));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    contact->end.force[i]  = problem->forces[i];
    contact->end.active[i] = (PetscBool)(contact->rows.tied[i] || contact->end.force[i] > 0);
  }
  if (!ContactFailed(contact)) PetscCall(ContactComputeGaps(contact));
  contact->counts.sweeps = 1;
  PetscCall(PetscTime(&end));
  contact->counts.seconds += end - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Velocities lack the force that begins at the end of the step: much of it is in these impulses, told with the force of the step */
static PetscErrorCode ContactAccept_ForwardLagrange(Contact contact)
{
  Complementarity *problem = (Complementarity *)contact->data;

  PetscFunctionBegin;
  PetscCall(LagrangeCloseRate(contact, PETSC_TRUE, problem));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (contact->end.active[i]) contact->end.force[i] += problem->forces[i] / contact->step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactRowsChanged_ForwardLagrange(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ComplementaritySetCompliance(contact, (Complementarity *)contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactDestroy_ForwardLagrange(Contact contact)
{
  Complementarity *problem = (Complementarity *)contact->data;

  PetscFunctionBegin;
  PetscCall(ComplementarityDestroy(problem));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For bodies that have been found to be explicit, with one step and mass on their contact nodes */
PetscErrorCode LagrangeSetUpForward(Contact contact)
{
  Complementarity *problem;

  PetscFunctionBegin;
  PetscCall(ImpaktCite(CITE_FORWARD_LAGRANGE));
  PetscCall(PetscNew(&problem));
  contact->data                = problem;
  contact->attempt.moves_start = PETSC_TRUE;
  contact->ops->step           = ContactStep_ForwardLagrange;
  contact->ops->rowschanged    = ContactRowsChanged_ForwardLagrange;
  contact->ops->destroy        = ContactDestroy_ForwardLagrange;
  if (contact->options.constraint == CONTACT_CONSTRAINT_BOTH) contact->ops->accept = ContactAccept_ForwardLagrange;
  PetscCall(LagrangeSetUpImpulses(contact, "-contact_constraint both", problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}
