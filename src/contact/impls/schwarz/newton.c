/*
   The Jacobian of x - G(x) by the interface compliance of the bodies: a sweep is a chain of the responses of each body, so its
   derivative is the same chain with unit waveforms put in. Exact for linear bodies, but for the velocity and acceleration of
   nodes with mass that are prescribed in several substeps.
*/
#include "schwarzimpl.h"

/* Waveforms of all rows at the substeps of each body, and of each pair at its unknowns, for the chain */
PetscErrorCode SchwarzSetUpNewton(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(PetscCalloc5(contact->n_bodies, &schwarz->responses, contact->n_bodies, &schwarz->body_in, contact->n_bodies,
                         &schwarz->body_out, contact->n_bodies, &schwarz->body_exchange, 2 * contact->n_pairs, &schwarz->unit));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt substeps;

    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    PetscCall(TraceCreate(contact->n_all_rows, substeps, &schwarz->body_in[b]));
    PetscCall(TraceCreate(contact->n_all_rows, substeps, &schwarz->body_out[b]));
    PetscCall(TraceCreate(contact->n_all_rows, substeps, &schwarz->body_exchange[b]));
  }
  for (PetscInt side = 0; side <= (schwarz->swap ? 1 : 0); side++)
    for (PetscInt p = 0; p < contact->n_pairs; p++)
      PetscCall(TraceCreate(contact->n_all_rows, schwarz->side_levels[side][p], &schwarz->unit[2 * p + side]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzDestroyNewton(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  if (!schwarz->responses) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(TraceDestroy(&schwarz->body_in[b]));
    PetscCall(TraceDestroy(&schwarz->body_out[b]));
    PetscCall(TraceDestroy(&schwarz->body_exchange[b]));
  }
  for (PetscInt p = 0; p < 2 * contact->n_pairs; p++) PetscCall(TraceDestroy(&schwarz->unit[p]));
  PetscCall(PetscFree5(schwarz->responses, schwarz->body_in, schwarz->body_out, schwarz->body_exchange, schwarz->unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the velocity and acceleration that go with a displacement of a prescribed row add to the output of its body */
static PetscErrorCode AddKinematics(Contact contact, PetscInt b, PetscInt row, PetscScalar input, PetscScalar out[])
{
  const ContactPair *pair = &contact->pairs[contact->all_row_pair[row]];
  const PetscInt     n    = contact->n_all_rows;
  const PetscScalar *velocity, *acceleration;
  PetscReal          dv, da, unused;

  PetscFunctionBegin;
  PetscCall(BodyGetNewmark(contact->bodies[NeumannBody(pair)], &dv, &unused, &unused, &da, &unused, &unused));
  PetscCall(BodyGetRateResponse(contact->bodies[b], &velocity, &acceleration));
  for (PetscInt i = 0; i < n; i++) out[i] += input * (dv * velocity[row * n + i] + da * acceleration[row * n + i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Output of a body at rest for the input waveforms of its active rows */
static PetscErrorCode Respond(Contact contact, PetscInt b)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n       = contact->n_all_rows;
  PetscInt       substeps;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(schwarz->body_in[b], NULL, &substeps));
  PetscCall(TraceZero(schwarz->body_out[b]));
  for (PetscInt l = 1; l <= substeps; l++) {
    PetscScalar *in, *out;

    PetscCall(TraceGetLevel(schwarz->body_in[b], l, &in));
    for (PetscInt row = 0; row < n; row++) {
      const PetscInt p = contact->all_row_pair[row];

      if (in[row] == 0) continue;
      for (PetscInt k = l; k <= substeps; k++) {
        const PetscScalar *matrix = schwarz->responses[b] + (k - l) * n * n;

        PetscCall(TraceGetLevel(schwarz->body_out[b], k, &out));
        for (PetscInt i = 0; i < n; i++) out[i] += in[row] * matrix[row * n + i];
        if (DirichletBody(&contact->pairs[p]) == b && schwarz->kinematic[SideIndex(schwarz, p)])
          PetscCall(AddKinematics(contact, b, row, in[row], out));
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a body at rest hands to its partners in a row: its reaction, or under Robin conditions r - 2 f */
static PetscErrorCode Exchange(Contact contact, PetscInt b, PetscInt row, PetscScalar scale)
{
  Schwarz     *schwarz = (Schwarz *)contact->data;
  PetscInt     levels;
  PetscScalar *r, *f, *exchange;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(schwarz->body_out[b], NULL, &levels));
  for (PetscInt level = 0; level <= levels; level++) {
    PetscCall(TraceGetLevel(schwarz->body_in[b], level, &r));
    PetscCall(TraceGetLevel(schwarz->body_out[b], level, &f));
    PetscCall(TraceGetLevel(schwarz->body_exchange[b], level, &exchange));
    if (schwarz->transmission == TRANSMISSION_DIRICHLET_NEUMANN) exchange[row] = scale * f[row];
    else exchange[row] = r[row] - 2 * f[row];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A unit at one level of row j goes through the sweep; the result is left in what the Neumann sides hand on */
static PetscErrorCode LinearSweep(Contact contact, PetscInt j, PetscInt level)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n       = contact->n_all_rows;
  PetscScalar   *unit;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(TraceZero(schwarz->unit[SideIndex(schwarz, p)]));
  PetscCall(TraceGetLevel(schwarz->unit[SideIndex(schwarz, contact->all_row_pair[j])], level, &unit));
  unit[j] = 1;
  for (PetscInt k = 0; k < contact->n_bodies; k++) {
    const PetscInt b = contact->order[k];

    PetscCall(TraceZero(schwarz->body_in[b]));
    for (PetscInt row = 0; row < n; row++) {
      const PetscInt     p    = contact->all_row_pair[row];
      const ContactPair *pair = &contact->pairs[p];

      if (!contact->all_active[row]) continue;
      if (DirichletBody(pair) == b) PetscCall(TraceResample(schwarz->unit[SideIndex(schwarz, p)], row, row + 1, 1, schwarz->body_in[b]));
      if (NeumannBody(pair) == b)
        PetscCall(SchwarzResampleForce(schwarz, schwarz->body_exchange[DirichletBody(pair)], row, row + 1, 1, schwarz->body_in[b]));
    }
    PetscCall(Respond(contact, b));
    for (PetscInt row = 0; row < n; row++) {
      const ContactPair *pair = &contact->pairs[contact->all_row_pair[row]];

      if (contact->all_active[row] && (pair->body[0] == b || pair->body[1] == b))
        PetscCall(Exchange(contact, b, row, DirichletBody(pair) == b ? -1 : 1));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Column of I - dG/dx for row j at a level: the rows of this rank. Unknowns beyond the levels of a pair stay as they are. */
static PetscErrorCode SetColumn(Contact contact, PetscInt j, PetscInt level, Mat J)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt column  = schwarz->all_offset[j] + level - 1;
  const PetscInt used    = schwarz->levels[contact->all_row_pair[j]];

  PetscFunctionBegin;
  for (PetscInt local = 0; local < contact->n_rows; local++) {
    const PetscInt i = contact->row_begin + local, p = contact->all_row_pair[i], levels = schwarz->levels[p];
    const PetscInt body = NeumannBody(&contact->pairs[p]);
    Trace          from = body < contact->n_bodies ? schwarz->body_exchange[body] : contact->traces[body].displacement;
    PetscInt       from_levels, at = contact->pairs[p].obstacle ? 0 : i; /* an obstacle answers with zeros */
    PetscScalar   *out;

    PetscCall(TraceGetSizes(from, NULL, &from_levels));
    for (PetscInt k = 1; k <= schwarz->room[p]; k++) {
      const PetscBool both = (PetscBool)(k <= levels && level <= used && contact->all_active[i] && contact->all_active[j]);

      PetscCall(TraceGetLevel(from, levels == 1 || k > from_levels ? from_levels : k, &out));
      PetscCall(
          MatSetValue(J, schwarz->all_offset[i] + k - 1, column, (i == j && k == level ? 1 : 0) - (both ? out[at] : 0), INSERT_VALUES));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* I - dG/dx on active rows, I on the others */
PetscErrorCode SchwarzComputeJacobian(SNES snes, Vec X, Mat J, Mat P, void *ctx)
{
  Contact  contact = (Contact)ctx;
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  (void)snes;
  (void)X;
  (void)P;
  if (!schwarz->stale) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactGatherActive(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodyComputeResponse(contact->bodies[b], &schwarz->responses[b]));
    PetscCall(BodyGetWaveformResponse(contact->bodies[b], &schwarz->responses[b]));
  }
  for (PetscInt j = 0; j < contact->n_all_rows; j++)
    for (PetscInt level = 1; level <= schwarz->room[contact->all_row_pair[j]]; level++) {
      if (contact->all_active[j] && level <= schwarz->levels[contact->all_row_pair[j]]) PetscCall(LinearSweep(contact, j, level));
      PetscCall(SetColumn(contact, j, level, J));
    }
  PetscCall(MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY));
  schwarz->stale = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
