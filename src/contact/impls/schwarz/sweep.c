/*
   One sweep of the alternation, G: displacements x put on the contact rows of the Dirichlet sides -> reactions -> tractions on
   the Neumann sides -> their displacements, G(x). Written as the residual x - G(x) of the outer SNES.
*/
#include "schwarzimpl.h"
#include <sys/petsccompat.h>

/* Before the first sweep of a step everything is as it was at its start ("last" predictor) */
PetscErrorCode SchwarzStartTraces(Contact contact)
{
  Schwarz     *schwarz = (Schwarz *)contact->data;
  PetscScalar *x;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyResetTraces(contact->bodies[b]));
  PetscCall(VecGetArrayWrite(schwarz->outer.x, &x));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const PetscInt p = contact->row_pair[i], levels = schwarz->levels[p];
    PetscScalar   *start;

    /* a gap that is open at the start closes linearly over the step */
    PetscCall(TraceGetLevel(contact->traces[contact->pairs[p].body[1]].displacement, 0, &start));
    for (PetscInt level = 1; level <= levels; level++) x[schwarz->offset[i] + level - 1] = start[i] + contact->initial_gap[i] - contact->saved_gap[i] * (1 - (PetscReal)level / levels);
  }
  PetscCall(VecRestoreArrayWrite(schwarz->outer.x, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The velocity and acceleration that the Neumann side would have if it were where the unknowns put the Dirichlet side: with the
   inertia of the nodes in the traction, those of its last sweep would be another unknown that the SNES does not see. */
static PetscErrorCode PrescribeKinematics(Contact contact, PetscInt p)
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  const BodyTraces  *from    = &contact->traces[pair->body[1]];
  PetscScalar       *x, *u0, *v0, *a0, *v, *a;
  PetscReal          dv, da, v_v, v_a, a_v, a_a;

  PetscFunctionBegin;
  PetscCall(BodyGetNewmark(contact->bodies[pair->body[1]], &dv, &v_v, &v_a, &da, &a_v, &a_a));
  PetscCall(TraceGetLevel(schwarz->trace[p], 1, &x));
  PetscCall(TraceGetLevel(from->displacement, 0, &u0));
  PetscCall(TraceGetLevel(from->velocity, 0, &v0));
  PetscCall(TraceGetLevel(from->acceleration, 0, &a0));
  PetscCall(TraceGetLevel(schwarz->rate[0], 1, &v));
  PetscCall(TraceGetLevel(schwarz->rate[1], 1, &a));
  for (PetscInt i = pair->begin; i < pair->end; i++) {
    const PetscScalar moved = x[i] - contact->initial_gap[i] - u0[i];

    v[i] = dv * moved + v_v * v0[i] + v_a * a0[i];
    a[i] = da * moved + a_v * v0[i] + a_a * a0[i];
  }
  PetscCall(TraceGetLevel(schwarz->rate[0], 0, &v));
  PetscCall(TraceGetLevel(schwarz->rate[1], 0, &a));
  for (PetscInt i = pair->begin; i < pair->end; i++) {
    v[i] = v0[i];
    a[i] = a0[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the unknowns of a pair on its Dirichlet side, with the velocity and acceleration that the Neumann side has */
static PetscErrorCode PrescribePair(Contact contact, PetscInt p, const PetscScalar x[])
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  const BodyTraces  *to = &contact->traces[pair->body[0]], *from = &contact->traces[pair->body[1]];
  PetscScalar       *start, *values;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(to->displacement, 0, &start));
  PetscCall(TraceGetLevel(schwarz->trace[p], 0, &values));
  for (PetscInt i = pair->begin; i < pair->end; i++) values[i] = start[i];
  for (PetscInt level = 1; level <= schwarz->levels[p]; level++) {
    PetscCall(TraceGetLevel(schwarz->trace[p], level, &values));
    for (PetscInt i = pair->begin; i < pair->end; i++) values[i] = x[schwarz->offset[i] + level - 1];
  }
  PetscCall(TraceResample(schwarz->trace[p], pair->begin, pair->end, 1, to->displacement_in));
  if (schwarz->kinematic[p]) PetscCall(PrescribeKinematics(contact, p));
  PetscCall(TraceResample(schwarz->kinematic[p] ? schwarz->rate[0] : from->velocity, pair->begin, pair->end, 1, to->velocity_in));
  PetscCall(TraceResample(schwarz->kinematic[p] ? schwarz->rate[1] : from->acceleration, pair->begin, pair->end, 1, to->acceleration_in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The body with the largest change of position in comparison with the tolerances */
static PetscErrorCode MeasureChange(Contact contact, const PetscScalar f[])
{
  Schwarz  *schwarz = (Schwarz *)contact->data;
  PetscReal worst   = -1;

  PetscFunctionBegin;
  schwarz->converged = PETSC_TRUE;
  if (schwarz->convergence == CONVERGENCE_MISMATCH) {
    PetscReal sums[2] = {0, 0};

    for (PetscInt i = 0; i < contact->n_rows; i++) {
      const PetscInt last = schwarz->offset[i] + schwarz->levels[contact->row_pair[i]] - 1;
      PetscScalar   *start;

      if (!contact->active[i]) continue;
      for (PetscInt k = schwarz->offset[i]; k <= last; k++) sums[0] += PetscSqr(f[k]);
      PetscCall(TraceGetLevel(contact->traces[contact->pairs[contact->row_pair[i]].body[0]].displacement_in, 0, &start));
      sums[1] += PetscSqr(start[i]);
    }
    if (contact->size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
    schwarz->change    = PetscSqrtReal(sums[0]);
    schwarz->position  = PetscSqrtReal(sums[1]);
    schwarz->converged = (PetscBool)(schwarz->change <= schwarz->atol || schwarz->change <= schwarz->rtol * schwarz->position);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal change, position;

    PetscCall(BodyGetPositionChange(contact->bodies[b], &change, &position));
    if (!(change < schwarz->atol || change < schwarz->rtol * position)) schwarz->converged = PETSC_FALSE;
    if (change <= worst) continue;
    worst             = change;
    schwarz->change   = change;
    schwarz->position = position;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* F = x - G(x); zero on rows that are not active */
PetscErrorCode SchwarzSweep(SNES snes, Vec X, Vec F, void *ctx)
{
  Contact            contact = (Contact)ctx;
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const PetscScalar *x;
  PetscScalar       *f;
  PetscLogDouble     begin, end;

  PetscFunctionBegin;
  (void)snes;
  PetscCall(PetscLogEventBegin(CONTACT_Sweep, contact, 0, 0, 0));
  PetscCall(PetscTime(&begin));
  PetscCall(VecGetArrayRead(X, &x));
  for (PetscInt k = 0; k < contact->n_bodies; k++) {
    const PetscInt b = contact->order[k];

    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      const ContactPair *pair = &contact->pairs[p];

      if (pair->body[0] == b) PetscCall(PrescribePair(contact, p, x));
      /* the reaction holds the Dirichlet side; the Neumann side gets its opposite */
      if (pair->body[1] == b) PetscCall(TraceResample(contact->traces[pair->body[0]].reaction, pair->begin, pair->end, -1, contact->traces[b].force_in));
    }
    PetscCall(BodyIntegrate(contact->bodies[b]));
  }
  PetscCall(VecGetArrayWrite(F, &f));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair   = &contact->pairs[p];
    const PetscInt     levels = schwarz->levels[p];
    Trace              from   = contact->traces[pair->body[1]].displacement;
    PetscInt           from_levels;
    PetscScalar       *values;

    PetscCall(TraceGetSizes(from, NULL, &from_levels));
    for (PetscInt level = 1; level <= levels; level++) {
      const PetscReal left = 1 - (PetscReal)level / levels;

      PetscCall(TraceGetLevel(from, levels == 1 ? from_levels : level, &values));
      for (PetscInt i = pair->begin; i < pair->end; i++) {
        const PetscInt unknown = schwarz->offset[i] + level - 1;

        f[unknown] = contact->active[i] ? x[unknown] - (values[i] + contact->initial_gap[i] - contact->saved_gap[i] * left) : 0;
      }
    }
  }
  PetscCall(MeasureChange(contact, f));
  PetscCall(VecRestoreArrayWrite(F, &f));
  PetscCall(VecRestoreArrayRead(X, &x));
  contact->counts_made.sweeps++;
  PetscCall(PetscTime(&end));
  contact->counts_made.seconds += end - begin;
  PetscCall(PetscLogEventEnd(CONTACT_Sweep, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stops on the change of position that the last sweep brought, as the paper does; the norm of F serves for NaN only */
PetscErrorCode SchwarzTestConvergence(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm, SNESConvergedReason *reason, void *ctx)
{
  const Schwarz *schwarz = (const Schwarz *)((Contact)ctx)->data;

  PetscFunctionBegin;
  (void)snes;
  (void)it;
  (void)xnorm;
  (void)gnorm;
  *reason = SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_NAN;
  else if (schwarz->converged) *reason = SNES_CONVERGED_FNORM_ABS;
  PetscFunctionReturn(PETSC_SUCCESS);
}
