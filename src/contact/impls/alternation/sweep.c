/* One sweep of the alternation, G: displacements x put on the contact rows of the Dirichlet sides -> reactions -> tractions on the Neumann
   sides -> their displacements, G(x). Or, under Robin conditions, the right-hand side x of the first side -> its force -> the right-hand
   side of the second -> its force -> that of the first, G(x). Written as the residual x - G(x) of the outer SNES. */
#include "alternationimpl.h"
#include <impakt/private/bodysweeps.h>

/* The velocity and acceleration that the Neumann side would have if it were where the unknowns put the Dirichlet side: with the
   inertia of the nodes in the traction, those of its last sweep would be another unknown that the SNES does not see. */
static PetscErrorCode PrescribeKinematics(Contact contact, PetscInt p)
{
  Alternation       *alternation = (Alternation *)contact->data;
  const ContactPair *pair        = &contact->pairs[p];
  const BodyTraces  *from        = &contact->traces[NeumannBody(pair)];
  PetscScalar       *x, *u0, *v0, *a0, *v, *a;
  PetscReal          dv, da, v_v, v_a, a_v, a_a;

  PetscFunctionBegin;
  PetscCall(BodyGetNewmark(contact->bodies[NeumannBody(pair)], &dv, &v_v, &v_a, &da, &a_v, &a_a));
  PetscCall(TraceGetLevel(alternation->trace[SideIndex(contact, p)], 1, &x));
  PetscCall(TraceGetLevel(from->displacement, 0, &u0));
  PetscCall(TraceGetLevel(from->velocity, 0, &v0));
  PetscCall(TraceGetLevel(from->acceleration, 0, &a0));
  PetscCall(TraceGetLevel(alternation->rate[0], 1, &v));
  PetscCall(TraceGetLevel(alternation->rate[1], 1, &a));
  for (PetscInt i = pair->begin; i < pair->end; i++) {
    const PetscInt    k     = i - NeumannShift(pair);
    const PetscScalar moved = -x[i - pair->begin] - AlternationOffset(contact, i, 1) - u0[k];

    v[i] = -(dv * moved + v_v * v0[k] + v_a * a0[k]);
    a[i] = -(da * moved + a_v * v0[k] + a_a * a0[k]);
  }
  PetscCall(TraceGetLevel(alternation->rate[0], 0, &v));
  PetscCall(TraceGetLevel(alternation->rate[1], 0, &a));
  for (PetscInt i = pair->begin; i < pair->end; i++) {
    v[i] = -v0[i - NeumannShift(pair)];
    a[i] = -a0[i - NeumannShift(pair)];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the unknowns of a pair on its Dirichlet side: displacements or, under Robin conditions, right-hand sides */
static PetscErrorCode PutUnknowns(Contact contact, PetscInt p, const PetscScalar x[], PetscBool robin)
{
  Alternation       *alternation = (Alternation *)contact->data;
  const ContactPair *pair        = &contact->pairs[p];
  const BodyTraces  *to          = &contact->traces[DirichletBody(pair)];
  Trace              trace       = alternation->trace[SideIndex(contact, p)];
  const PetscInt     to_begin    = pair->begin - DirichletShift(pair);
  PetscScalar       *force, *displacement, *values;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(to->reaction, 0, &force));
  PetscCall(TraceGetLevel(to->displacement, 0, &displacement));
  PetscCall(TraceGetLevel(trace, 0, &values));
  for (PetscInt i = pair->begin; i < pair->end; i++) {
    const PetscInt k = i - DirichletShift(pair);

    values[i - pair->begin] = robin ? force[k] + alternation->weight[i] * displacement[k] : displacement[k];
  }
  for (PetscInt level = 1; level <= alternation->levels[pair->dirichlet][p]; level++) {
    PetscCall(TraceGetLevel(trace, level, &values));
    for (PetscInt i = pair->begin; i < pair->end; i++) values[i - pair->begin] = x[alternation->offset[i] + level - 1];
  }
  PetscCall(TraceResample(trace, 0, pair->end - pair->begin, 1, robin ? to->force_in : to->displacement_in, to_begin));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the velocity and acceleration that the Neumann side has on the Dirichlet side of a pair */
static PetscErrorCode PrescribeRates(Contact contact, PetscInt p)
{
  Alternation       *alternation = (Alternation *)contact->data;
  const ContactPair *pair        = &contact->pairs[p];
  const BodyTraces  *to = &contact->traces[DirichletBody(pair)], *from = &contact->traces[NeumannBody(pair)];
  const PetscBool    kinematic = alternation->kinematic[SideIndex(contact, p)];
  const PetscInt     n = pair->end - pair->begin, to_begin = pair->begin - DirichletShift(pair);
  const PetscInt     begin = kinematic ? pair->begin : pair->begin - NeumannShift(pair);
  const PetscReal    sign  = kinematic ? 1 : -1;

  PetscFunctionBegin;
  if (kinematic) PetscCall(PrescribeKinematics(contact, p));
  PetscCall(TraceResample(kinematic ? alternation->rate[0] : from->velocity, begin, n, sign, to->velocity_in, to_begin));
  PetscCall(TraceResample(kinematic ? alternation->rate[1] : from->acceleration, begin, n, sign, to->acceleration_in, to_begin));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The force along rows that holds the Dirichlet side of a pair goes to the Neumann side, over other substeps perhaps. Held at F' where the
   partner takes the trapezium of F and F', forces bring more impulse in a step dt of n substeps by (1 - 1/n) (F' - F) dt / 2: ahead by that
   part of the present force, they give it back as it falls. */
static PetscErrorCode HandReactionOn(Contact contact, const ContactPair *pair)
{
  const Alternation *alternation = (const Alternation *)contact->data;
  const Trace        from = contact->traces[DirichletBody(pair)].reaction, to = contact->traces[NeumannBody(pair)].force_in;
  const PetscInt     begin = pair->begin - DirichletShift(pair), to_begin = pair->begin - NeumannShift(pair), n = pair->end - pair->begin;

  PetscFunctionBegin;
  if (alternation->waveform == SCHWARZ_WAVEFORM_CONSTANT) PetscCall(TraceResampleConstant(from, begin, n, 1, to, to_begin));
  else PetscCall(TraceResample(from, begin, n, 1, to, to_begin));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Right-hand side of the Neumann side from what the Dirichlet side has answered: r' = 2 f - r - alpha o */
static PetscErrorCode LoadNeumann(Contact contact, PetscInt p)
{
  Alternation       *alternation = (Alternation *)contact->data;
  const ContactPair *pair        = &contact->pairs[p];
  const BodyTraces  *from        = &contact->traces[DirichletBody(pair)];
  Trace              to          = alternation->exchange[DirichletBody(pair)];
  PetscInt           levels;
  PetscScalar       *values, *r, *f;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(to, NULL, &levels));
  for (PetscInt level = 0; level <= levels; level++) {
    PetscCall(TraceGetLevel(from->force_in, level, &r));
    PetscCall(TraceGetLevel(from->reaction, level, &f));
    PetscCall(TraceGetLevel(to, level, &values));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscInt k = i - DirichletShift(pair);

      values[k] = 2 * f[k] - r[k] - alternation->weight[i] * AlternationOffset(contact, i, (PetscReal)level / levels);
    }
  }
  PetscCall(TraceResample(to, pair->begin - DirichletShift(pair), pair->end - pair->begin, 1, contact->traces[NeumannBody(pair)].force_in,
                          pair->begin - NeumannShift(pair)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the rows of a body take in: it is prescribed or loaded by its partners as they are now */
static PetscErrorCode LoadBody(Contact contact, PetscInt b, const PetscScalar x[])
{
  const PetscBool robin = (PetscBool)(((Alternation *)contact->data)->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN);

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (DirichletBody(pair) == b) {
      PetscCall(PutUnknowns(contact, p, x, robin));
      if (!robin) PetscCall(PrescribeRates(contact, p));
    }
    if (NeumannBody(pair) == b) PetscCall(robin ? LoadNeumann(contact, p) : HandReactionOn(contact, pair));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* f = x - G(x) for the unknowns of a pair, after all bodies have been integrated; zero on rows that are not active */
static PetscErrorCode ComparePair(Contact contact, PetscInt p, const PetscScalar x[], PetscScalar f[])
{
  Alternation       *alternation = (Alternation *)contact->data;
  const ContactPair *pair        = &contact->pairs[p];
  const BodyTraces  *from        = &contact->traces[NeumannBody(pair)];
  const PetscInt     levels      = alternation->levels[contact->pairs[p].dirichlet][p];
  PetscInt           from_levels;
  PetscScalar       *displacement, *r, *force;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(from->displacement, NULL, &from_levels));
  for (PetscInt level = 1; level <= levels; level++) {
    const PetscInt  at   = level * from_levels / levels;
    const PetscReal part = (PetscReal)level / levels;

    PetscCall(TraceGetLevel(from->displacement, at, &displacement));
    PetscCall(TraceGetLevel(from->force_in, at, &r));
    PetscCall(TraceGetLevel(from->reaction, at, &force));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscInt unknown = alternation->offset[i] + level - 1, k = i - NeumannShift(pair);
      PetscScalar    answer;

      if (alternation->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN)
        answer = -displacement[k] - AlternationOffset(contact, i, part);
      else answer = 2 * force[k] - r[k] - alternation->weight[i] * AlternationOffset(contact, i, part);
      f[unknown] = contact->end.active[i] ? x[unknown] - answer : 0;
    }
  }
  for (PetscInt i = pair->begin; i < pair->end; i++)
    for (PetscInt unused = levels; unused < alternation->room[p]; unused++) f[alternation->offset[i] + unused] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* F = x - G(x); not a number where a body's step fails */
PetscErrorCode AlternationSweep(SNES snes, Vec X, Vec F, void *ctx)
{
  Contact            contact = (Contact)ctx;
  const PetscScalar *x;
  PetscScalar       *f;
  PetscLogDouble     begin, end;

  PetscFunctionBegin;
  (void)snes;
  PetscCall(PetscLogEventBegin(CONTACT_Sweep, contact, 0, 0, 0));
  PetscCall(PetscTime(&begin));
  PetscCall(VecGetArrayRead(X, &x));
  for (PetscInt k = 0; k < contact->n_bodies; k++) {
    PetscCall(LoadBody(contact, contact->order[k], x));
    PetscCall(ContactIntegrateBody(contact, contact->order[k]));
  }
  PetscCall(ContactAgree(contact));
  if (ContactFailed(contact)) PetscCall(VecSet(F, NAN)); /* ends the iteration, whatever its type */
  else {
    PetscCall(VecGetArrayWrite(F, &f));
    for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(ComparePair(contact, p, x, f));
    PetscCall(AlternationMeasureChange(contact, f));
    PetscCall(VecRestoreArrayWrite(F, &f));
  }
  PetscCall(VecRestoreArrayRead(X, &x));
  contact->counts.sweeps++;
  PetscCall(PetscTime(&end));
  contact->counts.seconds += end - begin;
  PetscCall(PetscLogEventEnd(CONTACT_Sweep, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
