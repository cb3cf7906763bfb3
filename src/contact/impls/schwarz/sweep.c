/*
   One sweep of the alternation, G: displacements x put on the contact rows of the Dirichlet sides -> reactions -> tractions on
   the Neumann sides -> their displacements, G(x). Or, under Robin conditions, the right-hand side x of the first side -> its
   force -> the right-hand side of the second -> its force -> that of the first, G(x). Written as the residual x - G(x) of the
   outer SNES.
*/
#include "schwarzimpl.h"

/* The velocity and acceleration that the Neumann side would have if it were where the unknowns put the Dirichlet side: with the
   inertia of the nodes in the traction, those of its last sweep would be another unknown that the SNES does not see. */
static PetscErrorCode PrescribeKinematics(Contact contact, PetscInt p)
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  const BodyTraces  *from    = &contact->traces[NeumannBody(pair)];
  PetscScalar       *x, *u0, *v0, *a0, *v, *a;
  PetscReal          dv, da, v_v, v_a, a_v, a_a;

  PetscFunctionBegin;
  PetscCall(BodyGetNewmark(contact->bodies[NeumannBody(pair)], &dv, &v_v, &v_a, &da, &a_v, &a_a));
  PetscCall(TraceGetLevel(schwarz->trace[SideIndex(schwarz, p)], 1, &x));
  PetscCall(TraceGetLevel(from->displacement, 0, &u0));
  PetscCall(TraceGetLevel(from->velocity, 0, &v0));
  PetscCall(TraceGetLevel(from->acceleration, 0, &a0));
  PetscCall(TraceGetLevel(schwarz->rate[0], 1, &v));
  PetscCall(TraceGetLevel(schwarz->rate[1], 1, &a));
  for (PetscInt i = pair->begin; i < pair->end; i++) {
    const PetscInt    k     = i - NeumannShift(pair);
    const PetscScalar moved = x[i - pair->begin] - NeumannSign(pair) * SchwarzOffset(contact, i, 1) - u0[k];

    v[i] = dv * moved + v_v * v0[k] + v_a * a0[k];
    a[i] = da * moved + a_v * v0[k] + a_a * a0[k];
  }
  PetscCall(TraceGetLevel(schwarz->rate[0], 0, &v));
  PetscCall(TraceGetLevel(schwarz->rate[1], 0, &a));
  for (PetscInt i = pair->begin; i < pair->end; i++) {
    v[i] = v0[i - NeumannShift(pair)];
    a[i] = a0[i - NeumannShift(pair)];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The unknowns of a pair as a waveform */
static PetscErrorCode CopyUnknowns(Contact contact, PetscInt p, const PetscScalar x[], Trace trace)
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  PetscScalar       *values;

  PetscFunctionBegin;
  for (PetscInt level = 1; level <= schwarz->levels[p]; level++) {
    PetscCall(TraceGetLevel(trace, level, &values));
    for (PetscInt i = pair->begin; i < pair->end; i++) values[i - pair->begin] = x[schwarz->offset[i] + level - 1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the unknowns of a pair on its Dirichlet side, with the velocity and acceleration that the Neumann side has */
static PetscErrorCode PrescribePair(Contact contact, PetscInt p, const PetscScalar x[])
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  const BodyTraces  *to = &contact->traces[DirichletBody(pair)], *from = &contact->traces[NeumannBody(pair)];
  Trace              trace     = schwarz->trace[SideIndex(schwarz, p)];
  const PetscBool    kinematic = schwarz->kinematic[SideIndex(schwarz, p)];
  const PetscInt     n = pair->end - pair->begin, to_begin = pair->begin - DirichletShift(pair);
  const PetscInt     rate_begin = kinematic ? pair->begin : pair->begin - NeumannShift(pair);
  PetscScalar       *start, *values;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(to->displacement, 0, &start));
  PetscCall(TraceGetLevel(trace, 0, &values));
  for (PetscInt k = 0; k < n; k++) values[k] = start[to_begin + k];
  PetscCall(CopyUnknowns(contact, p, x, trace));
  PetscCall(TraceResample(trace, 0, n, 1, to->displacement_in, to_begin));
  if (kinematic) PetscCall(PrescribeKinematics(contact, p));
  PetscCall(TraceResample(kinematic ? schwarz->rate[0] : from->velocity, rate_begin, n, 1, to->velocity_in, to_begin));
  PetscCall(TraceResample(kinematic ? schwarz->rate[1] : from->acceleration, rate_begin, n, 1, to->acceleration_in, to_begin));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows whose unknown is a force: it holds the Dirichlet side */
static PetscErrorCode LoadByForce(Contact contact, PetscInt p, const PetscScalar x[])
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  const BodyTraces  *to      = &contact->traces[DirichletBody(pair)];
  Trace              trace   = schwarz->trace[SideIndex(schwarz, p)];
  PetscScalar       *start, *values;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(to->reaction, 0, &start));
  for (PetscInt i = pair->begin; i < pair->end; i++) {
    const PetscInt k = i - pair->begin, to_row = i - DirichletShift(pair);

    if (!ByForce(contact, i)) continue;
    PetscCall(TraceGetLevel(trace, 0, &values));
    values[k] = start[to_row];
    for (PetscInt level = 1; level <= schwarz->levels[p]; level++) {
      PetscCall(TraceGetLevel(trace, level, &values));
      values[k] = x[schwarz->offset[i] + level - 1] * ContactForceUnit(contact, i);
    }
    PetscCall(TraceResample(trace, k, 1, 1, to->force_in, to_row));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After the body has been integrated: to its partner, that force is as good as a reaction */
PetscErrorCode SchwarzReportByForce(Contact contact, PetscInt b)
{
  const ContactBodyRows *of     = &contact->body_rows[b];
  const BodyTraces      *traces = &contact->traces[b];
  PetscInt               levels;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(traces->reaction, NULL, &levels));
  for (PetscInt level = 1; level <= levels; level++) {
    PetscScalar *reaction, *force;

    PetscCall(TraceGetLevel(traces->reaction, level, &reaction));
    PetscCall(TraceGetLevel(traces->force_in, level, &force));
    for (PetscInt k = 0; k < of->n; k++)
      if (ByForce(contact, of->rows[k]) && DirichletBody(&contact->pairs[contact->rows.pair[of->rows[k]]]) == b) reaction[k] = force[k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The reaction holds the Dirichlet side of a pair; the Neumann side gets its opposite, over other substeps perhaps. Held at F' where the
   partner takes the trapezium of F and F', forces bring more impulse in a step dt of n substeps by (1 - 1/n) (F' - F) dt / 2: ahead by that
   part of the present force, they give it back as it falls. */
static PetscErrorCode HandReactionOn(Contact contact, const ContactPair *pair)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;
  const Trace    from = contact->traces[DirichletBody(pair)].reaction, to = contact->traces[NeumannBody(pair)].force_in;
  const PetscInt begin = pair->begin - DirichletShift(pair), to_begin = pair->begin - NeumannShift(pair), n = pair->end - pair->begin;

  PetscFunctionBegin;
  if (schwarz->waveform == SCHWARZ_WAVEFORM_CONSTANT) PetscCall(TraceResampleConstant(from, begin, n, -1, to, to_begin));
  else PetscCall(TraceResample(from, begin, n, -1, to, to_begin));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Under Robin conditions, the unknowns of a pair are the right-hand side of its Dirichlet side */
static PetscErrorCode LoadDirichlet(Contact contact, PetscInt p, const PetscScalar x[])
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  const BodyTraces  *to      = &contact->traces[DirichletBody(pair)];
  Trace              trace   = schwarz->trace[SideIndex(schwarz, p)];
  PetscScalar       *force, *displacement, *values;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(to->reaction, 0, &force));
  PetscCall(TraceGetLevel(to->displacement, 0, &displacement));
  PetscCall(TraceGetLevel(trace, 0, &values));
  for (PetscInt i = pair->begin; i < pair->end; i++)
    values[i - pair->begin] = force[i - DirichletShift(pair)] + schwarz->weight[i] * displacement[i - DirichletShift(pair)];
  PetscCall(CopyUnknowns(contact, p, x, trace));
  PetscCall(TraceResample(trace, 0, pair->end - pair->begin, 1, to->force_in, pair->begin - DirichletShift(pair)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Right-hand side of the Neumann side from what the Dirichlet side has answered: r' = r - 2 f - s alpha o */
static PetscErrorCode LoadNeumann(Contact contact, PetscInt p)
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  const BodyTraces  *from    = &contact->traces[DirichletBody(pair)];
  Trace              to      = schwarz->exchange[DirichletBody(pair)];
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

      values[k] = r[k] - 2 * f[k] - NeumannSign(pair) * schwarz->weight[i] * SchwarzOffset(contact, i, (PetscReal)level / levels);
    }
  }
  PetscCall(TraceResample(to, pair->begin - DirichletShift(pair), pair->end - pair->begin, 1, contact->traces[NeumannBody(pair)].force_in,
                          pair->begin - NeumannShift(pair)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the rows of a body take in: it is prescribed or loaded by its partners as they are now */
static PetscErrorCode LoadBody(Contact contact, PetscInt b, const PetscScalar x[])
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < contact->body_rows[b].n_pairs; k++) {
    const PetscInt     p    = contact->body_rows[b].pairs[k];
    const ContactPair *pair = &contact->pairs[p];

    if (!SchwarzPairTells(contact, p)) continue;
    if (schwarz->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN) {
      if (DirichletBody(pair) == b) {
        PetscCall(PrescribePair(contact, p, x));
        if (contact->shared.n || pair->by_force) PetscCall(LoadByForce(contact, p, x));
      }
      if (NeumannBody(pair) == b) PetscCall(HandReactionOn(contact, pair));
    } else {
      if (DirichletBody(pair) == b) PetscCall(LoadDirichlet(contact, p, x));
      if (NeumannBody(pair) == b) PetscCall(LoadNeumann(contact, p));
    }
  }
  PetscCall(ContactLoadReleased(contact, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the Dirichlet side of a row has got at a part of the controller step, as far as it answers to its unknown there. One that makes
   fewer substeps than there are unknowns feels the force at the end alone, and the others are on the way there. */
static PetscErrorCode GetAnswer(Contact contact, PetscInt i, PetscReal part, const PetscScalar x[], PetscBool *answers,
                                PetscScalar *position)
{
  const Schwarz     *schwarz = (const Schwarz *)contact->data;
  const PetscInt     p = contact->rows.pair[i], levels = schwarz->levels[p];
  const ContactPair *pair = &contact->pairs[p];
  const BodyTraces  *from = &contact->traces[DirichletBody(pair)];
  PetscInt           substeps;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(from->displacement, NULL, &substeps));
  *answers = (PetscBool)(part == 1 || substeps >= levels);
  if (*answers) {
    PetscCall(TraceInterpolate(from->displacement, part, i - DirichletShift(pair), 1, position));
  } else {
    PetscScalar *start;

    PetscCall(TraceGetLevel(from->reaction, 0, &start));
    *position = (1 - part) * start[i - DirichletShift(pair)] / ContactForceUnit(contact, i) + part * x[schwarz->offset[i] + levels - 1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* f = x - G(x) for the unknowns of a pair, after all bodies have been integrated; zero on rows that are not active */
static PetscErrorCode ComparePair(Contact contact, PetscInt p, const PetscScalar x[], PetscScalar f[])
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[p];
  const BodyTraces  *from    = &contact->traces[NeumannBody(pair)];
  const PetscInt     levels  = schwarz->levels[p];
  const PetscReal    sign    = NeumannSign(pair);
  PetscInt           from_levels;
  PetscBool          answers = PETSC_FALSE;
  PetscScalar       *displacement, *r, *force, position = 0;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(from->displacement, NULL, &from_levels));
  for (PetscInt level = 1; level <= levels; level++) {
    const PetscInt  at   = level * from_levels / levels;
    const PetscReal part = (PetscReal)level / levels;

    PetscCall(TraceGetLevel(from->displacement, at, &displacement));
    PetscCall(TraceGetLevel(from->force_in, at, &r));
    PetscCall(TraceGetLevel(from->reaction, at, &force));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscInt unknown = schwarz->offset[i] + level - 1, k = i - NeumannShift(pair);
      PetscScalar    answer;

      if (schwarz->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN)
        answer = displacement[k] + sign * SchwarzOffset(contact, i, part);
      else answer = r[k] - 2 * force[k] + sign * schwarz->weight[i] * SchwarzOffset(contact, i, part);
      f[unknown] = contact->end.active[i] ? x[unknown] - answer : 0;
      if (!ByForce(contact, i)) continue;
      /* the gap, or what keeps unknowns without an answer in line */
      PetscCall(GetAnswer(contact, i, part, x, &answers, &position));
      f[unknown] = answers ? position - answer : x[unknown] - position;
    }
  }
  for (PetscInt i = pair->begin; i < pair->end; i++)
    for (PetscInt unused = levels; unused < schwarz->room[p]; unused++) f[schwarz->offset[i] + unused] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether what comes in along all rows is known before any body is integrated: of pairs of bodies forces alone are the unknowns */
static PetscBool KnowsInputs(Contact contact)
{
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (!contact->pairs[p].obstacle && !contact->pairs[p].by_force && SchwarzPairTells(contact, p)) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* What a body makes of what comes in along its rows */
static PetscErrorCode Answer(Contact contact, PetscInt b)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  if (schwarz->step == STEP_CONDENSED) PetscCall(BodyRespond(contact->bodies[b]));
  else PetscCall(ContactIntegrateBody(contact, b));
  if (schwarz->has_forces) PetscCall(SchwarzReportByForce(contact, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What all bodies that do not rest make of what comes in by their compliance; what ranks have to know of inputs they tell of all at once */
static PetscErrorCode RespondAtOnce(Contact contact)
{
  const PetscBool *rests = ((const Schwarz *)contact->data)->groups.rests;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    contact->work.words[b].n = 0;
    if (!rests[b]) PetscCall(BodyProposeInputs(contact->bodies[b], &contact->work.words[b]));
  }
  PetscCall(ContactTellWords(contact, contact->work.words));
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (!rests[b]) PetscCall(BodyRespond(contact->bodies[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All bodies that do not rest, of which none waits for another */
static PetscErrorCode AnswerAtOnce(Contact contact)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  if (schwarz->step == STEP_CONDENSED) PetscCall(RespondAtOnce(contact));
  else PetscCall(ContactIntegrateSome(contact, schwarz->groups.rests));
  for (PetscInt b = 0; b < contact->n_bodies && schwarz->has_forces; b++)
    if (!schwarz->groups.rests[b]) PetscCall(SchwarzReportByForce(contact, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All bodies that do not rest, each after those whose answer it waits for */
static PetscErrorCode SweepBodies(Contact contact, const PetscScalar x[])
{
  const PetscBool *rests = ((const Schwarz *)contact->data)->groups.rests;
  const PetscBool  known = KnowsInputs(contact);

  PetscFunctionBegin;
  for (PetscInt k = 0; k < contact->n_bodies; k++) {
    const PetscInt b = contact->order[k];

    if (rests[b]) continue;
    PetscCall(LoadBody(contact, b, x));
    if (known) PetscCall(SchwarzReportByForce(contact, b)); /* to partners that come later */
    else PetscCall(Answer(contact, b));
  }
  if (known) PetscCall(AnswerAtOnce(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* F = x - G(x); not a number where a body's step fails */
PetscErrorCode SchwarzSweep(SNES snes, Vec X, Vec F, void *ctx)
{
  Contact            contact = (Contact)ctx;
  const Schwarz     *schwarz = (const Schwarz *)contact->data;
  const PetscScalar *x;
  PetscScalar       *f;
  PetscLogDouble     begin, end;

  PetscFunctionBegin;
  (void)snes;
  PetscCall(PetscLogEventBegin(CONTACT_Sweep, contact, 0, 0, 0));
  PetscCall(PetscTime(&begin));
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(SweepBodies(contact, x));
  PetscCall(ContactAgree(contact));
  if (ContactFailed(contact)) PetscCall(ContactRejectResidual(F));
  else {
    PetscCall(VecGetArrayWrite(F, &f));
    for (PetscInt p = 0; p < contact->n_pairs; p++)
      if (SchwarzPairMoves(contact, p)) PetscCall(ComparePair(contact, p, x, schwarz->groups.on ? schwarz->groups.residual : f));
    if (schwarz->groups.on) PetscCall(SchwarzCopyResidual(contact, f));
    PetscCall(SchwarzMeasureChange(contact, f));
    PetscCall(VecRestoreArrayWrite(F, &f));
  }
  PetscCall(VecRestoreArrayRead(X, &x));
  contact->counts.sweeps++;
  PetscCall(PetscTime(&end));
  contact->counts.seconds += end - begin;
  PetscCall(PetscLogEventEnd(CONTACT_Sweep, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
