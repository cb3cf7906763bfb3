/*
   The Jacobian of x - G(x) by the interface compliance of the bodies: a sweep is a chain of the responses of each body, so its
   derivative is the same chain with unit vectors put in. Exact for linear bodies where no pair has more than one level; else
   each level is treated as if it were the end of the controller step.
*/
#include "schwarzimpl.h"

/* What the velocity and acceleration that go with a displacement of a prescribed row add to the output of its body */
static PetscErrorCode AddKinematics(Contact contact, PetscInt b, PetscInt row, PetscScalar input)
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  const ContactPair *pair    = &contact->pairs[contact->all_row_pair[row]];
  const PetscInt     n       = contact->n_all_rows;
  const PetscScalar *velocity, *acceleration;
  PetscReal          dv, da, unused;

  PetscFunctionBegin;
  PetscCall(BodyGetNewmark(contact->bodies[pair->body[1]], &dv, &unused, &unused, &da, &unused, &unused));
  PetscCall(BodyGetRateResponse(contact->bodies[b], &velocity, &acceleration));
  for (PetscInt i = 0; i < n; i++) schwarz->out[i] += input * (dv * velocity[row * n + i] + da * acceleration[row * n + i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Column j of dG/dx: a unit displacement on row j goes through the sweep */
static PetscErrorCode LinearSweep(Contact contact, const PetscScalar *responses[], PetscInt j, PetscScalar column[])
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n       = contact->n_all_rows;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(schwarz->traction_in, n));
  PetscCall(PetscArrayzero(column, n));
  for (PetscInt k = 0; k < contact->n_bodies; k++) {
    const PetscInt b = contact->order[k];

    PetscCall(PetscArrayzero(schwarz->out, n));
    for (PetscInt row = 0; row < n; row++) {
      const ContactPair *pair  = &contact->pairs[contact->all_row_pair[row]];
      PetscScalar        input = 0;

      if (!contact->all_active[row]) continue;
      if (pair->body[0] == b) input = row == j;
      else if (pair->body[1] == b) input = schwarz->traction_in[row];
      if (input == 0) continue;
      for (PetscInt i = 0; i < n; i++) schwarz->out[i] += input * responses[b][row * n + i];
      if (pair->body[0] == b && schwarz->kinematic[contact->all_row_pair[row]]) PetscCall(AddKinematics(contact, b, row, input));
    }
    for (PetscInt row = 0; row < n; row++) {
      const ContactPair *pair = &contact->pairs[contact->all_row_pair[row]];

      if (!contact->all_active[row]) continue;
      if (pair->body[0] == b) schwarz->traction_in[row] = -schwarz->out[row];
      if (pair->body[1] == b) column[row] = schwarz->out[row];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* I - dG/dx on active rows, I on the others */
PetscErrorCode SchwarzComputeJacobian(SNES snes, Vec X, Mat J, Mat P, void *ctx)
{
  Contact             contact = (Contact)ctx;
  Schwarz            *schwarz = (Schwarz *)contact->data;
  const PetscInt      n       = contact->n_all_rows;
  const PetscScalar **responses = schwarz->responses;

  PetscFunctionBegin;
  (void)snes;
  (void)X;
  (void)P;
  if (!schwarz->stale) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactGatherActive(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyComputeResponse(contact->bodies[b], &responses[b]));
  for (PetscInt j = 0; j < n; j++) {
    if (contact->all_active[j]) PetscCall(LinearSweep(contact, responses, j, schwarz->gain + j * n));
    else PetscCall(PetscArrayzero(schwarz->gain + j * n, n));
  }
  for (PetscInt local = 0; local < contact->n_rows; local++) {
    const PetscInt i = contact->row_begin + local, levels_i = schwarz->levels[contact->all_row_pair[i]];

    for (PetscInt j = 0; j < n; j++) {
      const PetscInt levels_j = schwarz->levels[contact->all_row_pair[j]];

      for (PetscInt level_i = 0; level_i < levels_i; level_i++)
        for (PetscInt level_j = 0; level_j < levels_j; level_j++) {
          const PetscBool together = (PetscBool)(levels_i == levels_j ? level_i == level_j : level_i == levels_i - 1 && level_j == levels_j - 1);
          const PetscScalar value  = (i == j && level_i == level_j ? 1 : 0) - (together ? schwarz->gain[j * n + i] : 0);

          if (together || value != 0) PetscCall(MatSetValue(J, schwarz->all_offset[i] + level_i, schwarz->all_offset[j] + level_j, value, INSERT_VALUES));
        }
    }
  }
  PetscCall(MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY));
  schwarz->stale = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
