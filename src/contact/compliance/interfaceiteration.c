/* Newton's step on interfaces with more rows than a dense matrix is good for: conjugate gradients, with one solution of each body for a
   product. */
#include <contact/impls/schwarz/schwarzimpl.h>

/* of the residual: a step of Newton's method that leaves so much takes one more sweep at most */
#define FORCE_TOLERANCE 1e-9

/* How forces on active rows open their gaps or, if `dirichlet`, move the Dirichlet sides; sides are never swapped here */
static PetscErrorCode MultiplyBodies(Contact contact, PetscBool dirichlet, Vec x, Vec y)
{
  PetscFunctionBegin;
  PetscCall(ContactMultiplyCompliance(contact, contact->active, dirichlet, ((Schwarz *)contact->data)->problem.work, x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Multiply(Mat shell, Vec x, Vec y)
{
  Contact contact;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &contact));
  PetscCall(MultiplyBodies(contact, PETSC_FALSE, x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateIterative(Contact contact)
{
  InterfaceProblem *problem = &((Schwarz *)contact->data)->problem;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(contact->interfaces[0], NULL, &problem->force_vec));
  PetscCall(VecDuplicate(problem->force_vec, &problem->residual_vec));
  for (PetscInt k = 0; k < 2; k++) PetscCall(VecDuplicate(problem->force_vec, &problem->work[k]));
  PetscCall(ContactCreateRowSolver(contact, "schwarz_interface_", FORCE_TOLERANCE, Multiply, contact, &problem->iterative));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The level of a pair's unknowns that belongs to level `k` of those of the pair with most, or less than 0: they end together */
static PetscInt LevelOfPair(const Schwarz *schwarz, PetscInt p, PetscInt most, PetscInt k)
{
  return k - (most - schwarz->levels[p]);
}

/* Level `k` of Y from that of F: the forces that close it, then what they do to the Dirichlet sides */
static PetscErrorCode SolveLevel(Contact contact, PetscInt most, PetscInt k, Vec F, Vec Y)
{
  Schwarz           *schwarz = (Schwarz *)contact->data;
  InterfaceProblem  *problem = &schwarz->problem;
  PetscInt           iterations;
  const PetscScalar *f, *moved, *force;
  PetscScalar       *residual, *y;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(F, &f));
  PetscCall(VecGetArrayWrite(problem->residual_vec, &residual));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const PetscInt level = LevelOfPair(schwarz, contact->row_pair[i], most, k);

    residual[i] = contact->active[i] && level >= 0 ? f[schwarz->offset[i] + level] : 0;
  }
  PetscCall(VecRestoreArrayWrite(problem->residual_vec, &residual));
  PetscCall(VecRestoreArrayRead(F, &f));
  PetscCall(KSPSolve(problem->iterative, problem->residual_vec, problem->force_vec));
  PetscCall(KSPGetIterationNumber(problem->iterative, &iterations));
  contact->counts_made.inner_iterations += iterations;
  PetscCall(MultiplyBodies(contact, PETSC_TRUE, problem->force_vec, problem->residual_vec));
  PetscCall(VecGetArrayRead(problem->residual_vec, &moved));
  PetscCall(VecGetArrayRead(problem->force_vec, &force));
  PetscCall(VecGetArray(Y, &y));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const PetscInt level = LevelOfPair(schwarz, contact->row_pair[i], most, k);

    if (level >= 0) y[schwarz->offset[i] + level] = ByForce(contact, i) ? force[i] / ContactForceUnit(contact, i) : moved[i];
  }
  PetscCall(VecRestoreArray(Y, &y));
  PetscCall(VecRestoreArrayRead(problem->force_vec, &force));
  PetscCall(VecRestoreArrayRead(problem->residual_vec, &moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same by conjugate gradients, level by level: what the force at one time does later is left to the next sweep, so that with equal
   substeps the last level is right after as many sweeps as there are levels, and to secants */
PetscErrorCode SchwarzSolveIteratively(Contact contact, Vec F, Vec Y)
{
  Schwarz          *schwarz = (Schwarz *)contact->data;
  InterfaceProblem *problem = &schwarz->problem;
  PetscInt          most    = 1;

  PetscFunctionBegin;
  if (!problem->iterative) PetscCall(CreateIterative(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) most = PetscMax(most, schwarz->levels[p]);
  PetscCall(VecZeroEntries(Y));
  for (PetscInt k = 0; k < most; k++) PetscCall(SolveLevel(contact, most, k, F, Y));
  PetscFunctionReturn(PETSC_SUCCESS);
}
