/* Complementarity of gaps and forces of rows at one instant: the equations of the laws of rows, with a sparse C in place of S. */
#include "complementarity.h"
#include <contact/rows/inversemass.h>

PetscErrorCode ComplementarityCreate(Contact contact, Complementarity *problem)
{
  const PetscInt n = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(PetscCalloc4(n, &problem->gaps, n, &problem->forces, n, &problem->active, n, &problem->mine));
  PetscCall(PetscMalloc2(contact->rows.n_all, &problem->rows, contact->rows.n_all, &problem->all));
  PetscCall(LawProblemSetUp(&problem->problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ComplementarityDestroy(Complementarity *problem)
{
  PetscFunctionBegin;
  PetscCall(LawProblemDestroy(&problem->problem));
  PetscCall(MatDestroy(&problem->compliance));
  PetscCall(PetscFree4(problem->gaps, problem->forces, problem->active, problem->mine));
  PetscCall(PetscFree2(problem->rows, problem->all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C, with the rows as they are */
PetscErrorCode ComplementaritySetCompliance(Contact contact, Complementarity *problem)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->compliance));
  PetscCall(InverseMassAssemble(contact, PETSC_FALSE, &problem->compliance));
  problem->current = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows that `mine` has a number for, with C of these unless it is there: 1 for rows that push, 2 for rows that pull as well */
static PetscErrorCode TakeRows(Contact contact, Complementarity *problem)
{
  LawProblem      *law  = &problem->problem;
  PetscBool        same = problem->current;
  PetscInt         n    = 0;
  const PetscReal *kind = problem->all;
  IS               rows;
  Mat             *C, S;

  PetscFunctionBegin;
  PetscCall(ContactGatherRows(contact, MPIU_REAL, problem->mine, problem->all));
  for (PetscInt i = 0; i < contact->rows.n_all; i++) {
    if (kind[i] == 0) continue;
    same               = (PetscBool)(same && n < law->n && problem->rows[n] == i);
    problem->rows[n++] = i;
  }
  same = (PetscBool)(same && n == law->n);
  PetscCall(LawProblemResize(law, n));
  law->n_nodes  = n;
  law->begin[n] = n;
  for (PetscInt k = 0; k < n; k++) {
    law->begin[k] = k;
    law->law[k]   = kind[problem->rows[k]] > 1 ? &RowLawTie : &RowLawUnilateral;
  }
  PetscCall(PetscArrayzero(law->limit, 2 * n));
  if (same || !n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, n, problem->rows, PETSC_USE_POINTER, &rows));
  PetscCall(MatCreateSubMatrices(problem->compliance, 1, &rows, &rows, MAT_INITIAL_MATRIX, &C));
  S = C[0];
  PetscCall(PetscObjectReference((PetscObject)S));
  PetscCall(LawProblemTakeS(law, &S, NULL));
  PetscCall(MatDestroySubMatrices(1, &C));
  PetscCall(ISDestroy(&rows));
  problem->current = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces of all rows, of which those that are tied pull as well; or of the active rows alone, which close gaps whatever their signs. Others
   have none; ContactFailed() tells where there are none at all. */
PetscErrorCode ComplementaritySolve(Contact contact, PetscBool active_alone, Complementarity *problem)
{
  LawProblem *law = &problem->problem;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) problem->mine[i] = active_alone ? (problem->active[i] ? 2 : 0) : 1 + contact->rows.tied[i];
  PetscCall(TakeRows(contact, problem));
  PetscCall(PetscArrayzero(problem->forces, contact->rows.n));
  if (!law->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactGatherRows(contact, MPIU_REAL, problem->gaps, problem->all));
  for (PetscInt k = 0; k < law->n; k++) {
    law->read[k] = problem->all[problem->rows[k]];
    law->base[k] = law->force[k] = 0;
  }
  PetscCall(LawProblemSolve(law));
  contact->counts.inner_iterations += law->iterations;
  if (law->solved) ContactPickRows(contact, law->n, problem->rows, law->force, problem->forces);
  else
    PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_ACTIVE_SET, PETSC_ERR_NOT_CONVERGED,
                             "The contact forces of %" PetscInt_FMT " rows that close gaps or their rates at once were not found in "
                             "%" PetscInt_FMT " iterations; choose a smaller -time_step, or raise -law_snes_max_it",
                             law->n, law->iterations));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the effect of the forces to the states of all bodies: so much of their impulse to displacements, velocities and accelerations */
PetscErrorCode ComplementarityApply(Contact contact, Complementarity *problem, BodyStepSide when, const PetscReal parts[3])
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactTakeRows(contact, b, problem->forces, problem->mine);
    PetscCall(BodyAddImpulses(contact->bodies[b], when, PETSC_FALSE, parts, problem->mine));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
