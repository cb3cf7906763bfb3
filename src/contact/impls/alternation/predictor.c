/* Where the first sweep of a controller step starts from. */
#include "alternationimpl.h"
#include <impakt/private/bodysweeps.h>

/* What a closed gap has beside the displacements of both sides along the row at a part (0 to 1) of the controller step: a gap that is open
   at its start closes linearly over it, or stays as it is if only its rate is constrained */
PetscReal AlternationOffset(Contact contact, PetscInt i, PetscReal part)
{
  const PetscReal left = contact->options.constraint == CONTACT_CONSTRAINT_GAP_RATE ? 1 : 1 - part;

  return contact->rows.initial_gap[i] - contact->start.gap[i] * left;
}

/* Predicted displacement of the Neumann side of row i, at a time in the step */
static PetscErrorCode PredictNeumann(Contact contact, PetscInt i, PetscReal time, PetscScalar *displacement)
{
  const Alternation *alternation = (const Alternation *)contact->data;
  const ContactPair *pair        = &contact->pairs[contact->rows.pair[i]];
  const BodyTraces  *neumann = &contact->traces[NeumannBody(pair)], *dirichlet = &contact->traces[DirichletBody(pair)];
  const PetscInt     k = i - NeumannShift(pair);
  PetscScalar       *u, *v, *other;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(neumann->displacement, 0, &u));
  PetscCall(TraceGetLevel(neumann->velocity, 0, &v));
  PetscCall(TraceGetLevel(dirichlet->velocity, 0, &other));
  *displacement = u[k];
  if (pair->obstacle) PetscFunctionReturn(PETSC_SUCCESS);
  if (alternation->predictor == SCHWARZ_PREDICTOR_INELASTIC) {
    const PetscReal m_d = alternation->mass[pair->dirichlet][i], m_n = alternation->mass[1 - pair->dirichlet][i];

    *displacement += time * (m_n * v[k] - m_d * other[i - DirichletShift(pair)]) / (m_d + m_n);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Start of the outer iteration, and inputs of the first sweep */
PetscErrorCode AlternationPredict(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;
  PetscScalar *x;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyResetTraces(contact->bodies[b]));
  PetscCall(VecZeroEntries(alternation->x));
  PetscCall(VecGetArray(alternation->x, &x));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscInt     p = contact->rows.pair[i], levels = alternation->levels[contact->pairs[p].dirichlet][p];
    const ContactPair *pair  = &contact->pairs[p];
    const PetscReal    width = alternation->controller_step / levels, force = contact->start.force[i];
    PetscScalar       *unknown = x + alternation->offset[i], *reaction;

    for (PetscInt level = 1; level <= levels; level++) {
      const PetscReal part     = (PetscReal)level / levels;
      PetscScalar     position = 0;

      PetscCall(PredictNeumann(contact, i, level * width, &position));
      position = -position - AlternationOffset(contact, i, part);
      if (alternation->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN) unknown[level - 1] = position;
      else unknown[level - 1] = force + alternation->weight[i] * position;
    }
    /* what has been a Neumann side until now has no reaction yet */
    PetscCall(TraceGetLevel(contact->traces[DirichletBody(pair)].reaction, 0, &reaction));
    reaction[i - DirichletShift(pair)] = force;
    if (alternation->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN) continue;
    PetscCall(TraceGetLevel(contact->traces[NeumannBody(pair)].reaction, 0, &reaction));
    reaction[i - NeumannShift(pair)] = force;
  }
  PetscCall(VecRestoreArray(alternation->x, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}
