/* Rows that are let go within a controller step, with a force that falls to zero in the course of it. */
#include <contact/parts.h>

/* Whether a row has been let go in this controller step, and its force is not zero all at once. Bodies of one step take it so by the force
   that their acceleration at the start has in it; one that makes substeps would lose it with the first of them, and momentum with it. */
PetscBool ContactRowFades(Contact contact, PetscInt i)
{
  return (PetscBool)(contact->release.fades && !contact->end.active[i] && contact->release.intervals[i]);
}

/* Room for the forces of rows that are let go: of each at the ends of as many intervals as a body makes substeps */
PetscErrorCode ContactSetUpRelease(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt substeps;

    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    contact->release.room = PetscMax(contact->release.room, substeps + 1);
  }
  PetscCall(PetscCalloc2(contact->rows.n, &contact->release.intervals, contact->rows.n * contact->release.room, &contact->release.forces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Force of a row that has been let go at a part (0 to 1) of the controller step */
static PetscReal ReleasedForce(Contact contact, PetscInt i, PetscReal part)
{
  const PetscInt   n     = contact->release.intervals[i];
  const PetscReal *force = contact->release.forces + i * contact->release.room, at = part * n;
  const PetscInt   k = PetscMin((PetscInt)PetscFloorReal(at), n - 1);

  return force[k] + (at - k) * (force[k + 1] - force[k]);
}

/* Sum of the forces of a row that has been let go within a controller step of that many substeps, by the trapezoidal rule of integrators,
   and what it is to be for bodies of other substeps to get the same impulse: that of the force itself, and at least what the force at the
   start brings them */
static PetscErrorCode ReleasedSums(Contact contact, PetscInt i, PetscInt levels, PetscReal *sum, PetscReal *wanted)
{
  const ContactPair *pair  = &contact->pairs[contact->rows.pair[i]];
  const PetscInt     n     = contact->release.intervals[i];
  const PetscReal   *force = contact->release.forces + i * contact->release.room;
  PetscReal          impulse;

  PetscFunctionBegin;
  impulse = 0.5 * (force[0] + force[n]) / n;
  for (PetscInt k = 1; k < n; k++) impulse += force[k] / n;
  for (PetscInt side = 0; side < 2; side++) {
    PetscInt substeps;

    PetscCall(BodyGetSubsteps(contact->bodies[pair->body[side]], &substeps));
    impulse = PetscMax(impulse, 0.5 * force[0] / substeps);
  }
  *sum = 0;
  for (PetscInt level = 1; level < levels; level++) *sum += ReleasedForce(contact, i, (PetscReal)level / levels);
  *wanted = impulse * levels - 0.5 * force[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where substeps of the two bodies differ so that a force at the times of one is not that at the times of the other */
static PetscErrorCode BalanceReleased(Contact contact, PetscInt b)
{
  const ContactBodyRows *of    = &contact->body_rows[b];
  Trace                  trace = contact->traces[b].force_in;
  PetscInt               levels;
  PetscScalar           *force;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(trace, NULL, &levels));
  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt     i    = of->rows[k];
    const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];
    PetscReal          sum = 0, wanted = 0;

    if (!pair->by_force || !ContactRowFades(contact, i)) continue;
    PetscCall(ReleasedSums(contact, i, levels, &sum, &wanted));
    for (PetscInt level = 1; level < levels; level++) {
      PetscCall(TraceGetLevel(trace, level, &force));
      if (sum > 0) force[k] *= wanted / sum;
      else if (level == 1) force[k] = ContactSign(pair, b) * wanted;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces of rows that are let go, over the substeps of a body */
PetscErrorCode ContactLoadReleased(Contact contact, PetscInt b)
{
  const ContactBodyRows *of    = &contact->body_rows[b];
  Trace                  trace = contact->traces[b].force_in;
  PetscScalar           *force;
  PetscInt               levels;

  PetscFunctionBegin;
  if (!contact->release.any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TraceGetSizes(trace, NULL, &levels));
  for (PetscInt level = 0; level <= levels && contact->release.fades; level++) {
    PetscCall(TraceGetLevel(trace, level, &force));
    for (PetscInt k = 0; k < of->n; k++) {
      const PetscInt i = of->rows[k];

      if (ContactRowFades(contact, i))
        force[k] = ContactSign(&contact->pairs[contact->rows.pair[i]], b) * ReleasedForce(contact, i, (PetscReal)level / levels);
    }
  }
  PetscCall(BalanceReleased(contact, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What remains of the forces of a row that leaves, where the step is made again with another force at its start: the part that the row
   starts with, so that a row which starts without force brings no energy in the course of the step */
static PetscReal PartLeft(Contact contact, PetscInt i)
{
  const PetscReal last = contact->energy.last_force ? contact->energy.last_force[i] : 0;

  if (!contact->energy.again) return 1;
  return last > 0 ? PetscMin(PetscMax(contact->start.force[i] / last, 0), 1) : 0;
}

/* A row leaves with the force that held it until it is pulled, where the waveform of the force is known in the course of the step
   (`waveform`); else with one that falls linearly until its end. To go on with that while the row opens would be work out of nothing: with
   ten discs 1.4e-3 of the energy at a step of 4e-4 s. */
PetscErrorCode ContactReleaseRow(Contact contact, PetscInt i, PetscBool waveform)
{
  const ContactPair *pair     = &contact->pairs[contact->rows.pair[i]];
  const Trace        reaction = contact->traces[pair->body[pair->dirichlet]].reaction;
  const PetscReal    part     = PartLeft(contact, i);
  const PetscReal    sign     = pair->dirichlet == 0 ? -1 : 1; /* a reaction holds the Dirichlet side against the contact force */
  PetscReal         *force    = contact->release.forces + i * contact->release.room;
  PetscInt           n        = 1;

  PetscFunctionBegin;
  if (waveform) PetscCall(TraceGetSizes(reaction, NULL, &n));
  force[0]                      = contact->start.active[i] ? PetscMax(contact->start.force[i], 0) : 0;
  force[n]                      = 0;
  contact->release.intervals[i] = force[0] > 0 ? n : 0;
  for (PetscInt k = 1; k < n; k++) {
    PetscScalar *values;

    PetscCall(TraceGetLevel(reaction, k, &values));
    force[k] = k > 1 && force[k - 1] == 0 ? 0 : part * PetscMax(sign * PetscRealPart(values[i - pair->shift[pair->dirichlet]]), 0);
    if (force[k] > 0) contact->release.intervals[i] = n;
  }
  if (contact->release.intervals[i]) contact->release.any = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forgets rows that were let go in the step before, or the attempt before at this one, but those of pairs that are to keep what they have
 */
PetscErrorCode ContactBeginRelease(Contact contact, PetscBool (*keeps)(Contact, PetscInt))
{
  PetscFunctionBegin;
  if (!contact->release.any) PetscFunctionReturn(PETSC_SUCCESS);
  contact->release.any = PETSC_FALSE;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (!(*keeps)(contact, contact->rows.pair[i])) contact->release.intervals[i] = 0;
    else if (contact->release.intervals[i]) contact->release.any = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
