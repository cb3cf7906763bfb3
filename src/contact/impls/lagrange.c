/*
   Forward-increment Lagrange multipliers (Carpenter, Taylor, Katona 1991): the contact forces at t_n are those that close the
   gaps at t_{n+1}. With central differences a force lambda that acts at t_n moves the gaps at t_{n+1} by C lambda,
   C = dt^2 sum_bodies B M^{-1} B^T, so that after a free trial step with gaps g

     g + C lambda >= 0,   lambda >= 0,   lambda . (g + C lambda) = 0.
*/
#include "../contactimpl.h"
#include <petscblaslapack.h>

typedef struct {
  PetscScalar  *compliance; /* C: all rows by all rows, by columns [m/N] */
  PetscScalar  *gaps, *forces, *matrix, *rhs;
  PetscBLASInt *pivots;
  PetscBool    *active;
  PetscScalar  *impulse;
} Lagrange;

static PetscErrorCode CheckBodies(Contact contact)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const char *name = ((PetscObject)contact->bodies[b])->name;
    PetscBool   is_explicit, redistributed;
    PetscInt    substeps;

    PetscCall(BodyIsExplicit(contact->bodies[b], &is_explicit));
    PetscCheck(is_explicit, comm, PETSC_ERR_USER_INPUT, "-contact_type lagrange works with explicit bodies only, and body '%s' is implicit; give it -%s_ts_type centraldifference, or choose -contact_type schwarz or penalty", name, name);
    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    PetscCheck(substeps == 1, comm, PETSC_ERR_USER_INPUT, "-contact_type lagrange needs one step for all bodies, and body '%s' makes %" PetscInt_FMT " substeps; set -%s_ts_time_step to -time_step", name, substeps, name);
    PetscCall(BodyIsRedistributed(contact->bodies[b], &redistributed));
    PetscCheck(!redistributed, comm, PETSC_ERR_USER_INPUT, "-contact_type lagrange moves the contact nodes through their mass, and those of body '%s' have none; set -%s_mass_redistribute false", name, name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactSetUp_Lagrange(Contact contact)
{
  Lagrange      *lagrange = (Lagrange *)contact->data;
  const PetscInt n        = contact->n_all_rows;

  PetscFunctionBegin;
  PetscCall(CheckBodies(contact));
  PetscCall(PetscCalloc7(n * n, &lagrange->compliance, n, &lagrange->gaps, n, &lagrange->forces, n * n, &lagrange->matrix, n, &lagrange->rhs, n, &lagrange->pivots, n, &lagrange->active));
  PetscCall(PetscMalloc1(contact->n_rows, &lagrange->impulse));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscScalar *body;

    PetscCall(BodyComputeForwardCompliance(contact->bodies[b], &body));
    PetscCall(ContactAddCompliance(contact, b, body, lagrange->compliance));
    PetscCall(PetscFree(body));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* lambda for the active rows, zero for the others */
static PetscErrorCode SolveForces(Contact contact)
{
  Lagrange      *lagrange = (Lagrange *)contact->data;
  const PetscInt n        = contact->n_all_rows;
  PetscInt       k        = 0;
  PetscBLASInt   size, one = 1, info;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < n; j++) {
    PetscInt l = 0, count = 0;

    if (!lagrange->active[j]) continue;
    for (PetscInt i = 0; i < n; i++) count += lagrange->active[i];
    for (PetscInt i = 0; i < n; i++)
      if (lagrange->active[i]) lagrange->matrix[k * count + l++] = lagrange->compliance[j * n + i];
    lagrange->rhs[k++] = -lagrange->gaps[j];
  }
  PetscCall(PetscArrayzero(lagrange->forces, n));
  if (!k) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscBLASIntCast(k, &size));
  PetscCallBLAS("LAPACKgesv", LAPACKgesv_(&size, &one, lagrange->matrix, &size, lagrange->pivots, lagrange->rhs, &size, &info));
  PetscCheck(info == 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_LIB, "The matrix of the Lagrange multipliers is singular (LAPACK gesv info %d): contact constraints depend on each other", (int)info);
  for (PetscInt i = 0, l = 0; i < n; i++)
    if (lagrange->active[i]) lagrange->forces[i] = lagrange->rhs[l++];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Primal-dual active set, on every rank alike: rows that penetrate join, rows that are pulled leave */
static PetscErrorCode SolveComplementarity(Contact contact)
{
  Lagrange      *lagrange = (Lagrange *)contact->data;
  const PetscInt n        = contact->n_all_rows;
  PetscBool      changed  = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) lagrange->active[i] = (PetscBool)(lagrange->gaps[i] < 0);
  for (PetscInt round = 0; changed; round++) {
    PetscCheck(round < 100, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED, "The active set of the Lagrange multipliers has changed 100 times in one step");
    PetscCall(SolveForces(contact));
    changed = PETSC_FALSE;
    for (PetscInt i = 0; i < n; i++) {
      PetscReal gap = lagrange->gaps[i];

      for (PetscInt j = 0; j < n; j++) gap += lagrange->compliance[j * n + i] * lagrange->forces[j];
      if (lagrange->active[i] ? lagrange->forces[i] < 0 : gap < -contact->tolerance) {
        lagrange->active[i] = (PetscBool)!lagrange->active[i];
        changed             = PETSC_TRUE;
      }
    }
    if (changed) contact->counts_made.set_changes++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactStep_Lagrange(Contact contact)
{
  Lagrange      *lagrange = (Lagrange *)contact->data;
  PetscBool      penetrating;
  PetscLogDouble begin, end;
  int            any = 0;

  PetscFunctionBegin;
  PetscCall(ContactIntegrateFree(contact, &penetrating));
  for (PetscInt i = 0; i < contact->n_rows; i++) any |= contact->gap[i] < 0 && (penetrating || contact->saved_active[i]);
  PetscCall(ContactOr(contact, &any));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscTime(&begin));
  PetscCallMPI(MPI_Allgatherv(contact->gap, (PetscMPIInt)contact->n_rows, MPIU_SCALAR, lagrange->gaps, contact->counts, contact->offsets, MPIU_SCALAR, PetscObjectComm((PetscObject)contact)));
  PetscCall(SolveComplementarity(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    for (PetscInt i = 0; i < contact->n_rows; i++) {
      const ContactPair *pair = &contact->pairs[contact->row_pair[i]];

      lagrange->impulse[i] = ((pair->body[1] == b) - (pair->body[0] == b)) * lagrange->forces[contact->row_begin + i];
    }
    PetscCall(BodyAddImpulse(contact->bodies[b], lagrange->impulse));
    PetscCall(BodyIntegrate(contact->bodies[b]));
  }
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    contact->force[i]  = lagrange->forces[contact->row_begin + i];
    contact->active[i] = (PetscBool)(contact->force[i] > 0);
  }
  PetscCall(ContactComputeGaps(contact));
  contact->counts_made.sweeps = 1;
  PetscCall(PetscTime(&end));
  contact->counts_made.seconds += end - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactDestroy_Lagrange(Contact contact)
{
  Lagrange *lagrange = (Lagrange *)contact->data;

  PetscFunctionBegin;
  PetscCall(PetscFree7(lagrange->compliance, lagrange->gaps, lagrange->forces, lagrange->matrix, lagrange->rhs, lagrange->pivots, lagrange->active));
  PetscCall(PetscFree(lagrange->impulse));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   CONTACT_LAGRANGE - forward-increment Lagrange multipliers, for explicit bodies with one step and mass on their contact nodes

   Level: beginner

   Note:
   The velocities reported at the end of a step do not have the force yet that begins there.

   Reference:
.  * - N. J. Carpenter, R. L. Taylor, M. G. Katona, Lagrange constraints for transient finite element surface contact, IJNME 32
       (1991) 103-128

.seealso: `ContactSetType()`, `CONTACT_SCHWARZ`, `CONTACT_PENALTY`
M*/
PetscErrorCode ContactCreate_Lagrange(Contact contact)
{
  Lagrange *lagrange;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lagrange));
  contact->data         = lagrange;
  contact->ops->setup   = ContactSetUp_Lagrange;
  contact->ops->step    = ContactStep_Lagrange;
  contact->ops->destroy = ContactDestroy_Lagrange;
  PetscFunctionReturn(PETSC_SUCCESS);
}
