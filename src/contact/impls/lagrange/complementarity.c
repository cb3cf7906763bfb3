/* Linear complementarity on the contact rows by a primal-dual active set: the forces of the active rows close their gaps. */
#include "complementarity.h"
#include <checkpoint/checkpoint.h>

/* Above so many active rows forces come from conjugate gradients: on matching or not matching faces with lumped mass they take about 20
   iterations, as long as a factor of 441 rows that is kept through the contact, and half as long as one of 1936 */
#define MAX_DENSE_ROWS 400
/* of the gaps, by conjugate gradients, relative: near what factors leave; and what may be left where round-off keeps them from it */
#define GAP_TOLERANCE 1e-14
#define WORST_GAP     1e-9

PetscErrorCode ComplementarityDestroy(Complementarity *problem)
{
  PetscFunctionBegin;
  PetscCall(InterfaceOperatorDestroy(&problem->S));
  PetscCall(MatDestroy(&problem->compliance));
  PetscCall(PetscFree6(problem->gaps, problem->forces, problem->active, problem->mine, problem->closed, problem->marks));
  PetscCall(RoundsDestroy(&problem->rounds));
  PetscCall(VecDestroy(&problem->force_vec));
  PetscCall(VecDestroy(&problem->gap_vec));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C, with the rows as they are: the sum of what `compute` tells of each body */
PetscErrorCode ComplementaritySetCompliance(Contact contact, PetscErrorCode (*compute)(Body, Mat *), Complementarity *problem)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->compliance));
  PetscCall(ContactCreateRowMatrix(contact, &problem->compliance));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Mat matrix;

    PetscCall((*compute)(contact->bodies[b], &matrix));
    PetscCall(ContactAddBodyMatrix(contact, b, matrix, problem->compliance));
    PetscCall(MatDestroy(&matrix));
  }
  PetscCall(MatAssemblyBegin(problem->compliance, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(problem->compliance, MAT_FINAL_ASSEMBLY));
  PetscCall(InterfaceOperatorSetMatrix(problem->S, problem->compliance));
  problem->current = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The active rows, unless they are those of the last time */
static PetscErrorCode TakeActive(Contact contact, Complementarity *problem)
{
  int differs = !problem->current;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const InterfaceMark mark = problem->active[i] ? INTERFACE_SOLVED : INTERFACE_LEFT_OUT;

    differs |= problem->marks[i] != mark;
    problem->marks[i] = mark;
  }
  PetscCall(ContactOr(contact, &differs));
  if (!differs) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(InterfaceOperatorSetRows(problem->S, problem->marks, 1));
  problem->current = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ComplementarityCreate(Contact contact, Complementarity *problem)
{
  const InterfaceSettings settings = {.prefix      = "lagrange_interface_",
                                      .tolerance   = GAP_TOLERANCE,
                                      .worst       = WORST_GAP,
                                      .dense_limit = MAX_DENSE_ROWS,
                                      .few         = MAX_DENSE_ROWS,
                                      .warm        = PETSC_TRUE};
  const PetscInt          n        = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(PetscCalloc6(n, &problem->gaps, n, &problem->forces, n, &problem->active, n, &problem->mine, n, &problem->closed, n,
                         &problem->marks));
  PetscCall(RoundsCreate(contact, problem->active, problem->forces, problem->closed, &problem->rounds));
  PetscCall(ContactCreateRowVec(contact, &problem->force_vec));
  PetscCall(VecDuplicate(problem->force_vec, &problem->gap_vec));
  PetscCall(InterfaceOperatorCreate(contact, &settings, &problem->S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces that close the gaps of the active rows, zero for the others */
PetscErrorCode ComplementaritySolveActive(Contact contact, Complementarity *problem)
{
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(TakeActive(contact, problem));
  InterfaceOperatorGetRows(problem->S, &n, NULL, NULL);
  if (n) {
    for (PetscInt i = 0; i < contact->rows.n; i++) problem->mine[i] = -problem->gaps[i];
    PetscCall(InterfaceOperatorSolve(problem->S, problem->mine, problem->forces));
  } else PetscCall(PetscArrayzero(problem->forces, contact->rows.n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaps of all rows under the forces, zero being those of active rows but for round-off */
static PetscErrorCode ComputeClosed(Contact contact, Complementarity *problem)
{
  const PetscScalar *moved;
  PetscScalar       *force;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(problem->force_vec, &force));
  PetscCall(PetscArraycpy(force, problem->forces, contact->rows.n));
  PetscCall(VecRestoreArrayWrite(problem->force_vec, &force));
  PetscCall(MatMult(problem->compliance, problem->force_vec, problem->gap_vec));
  PetscCall(VecGetArrayRead(problem->gap_vec, &moved));
  for (PetscInt i = 0; i < contact->rows.n; i++) problem->closed[i] = problem->gaps[i] + moved[i];
  PetscCall(VecRestoreArrayRead(problem->gap_vec, &moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Starts from all negative gaps, and those that are tied; ContactFailed() tells where it does not settle */
PetscErrorCode ComplementaritySolve(Contact contact, PetscReal tolerance, Complementarity *problem)
{
  PetscBool changed = PETSC_TRUE, flips;

  PetscFunctionBegin;
  problem->rounds.tolerance = tolerance;
  PetscCall(RoundsBegin(&problem->rounds));
  for (PetscInt i = 0; i < contact->rows.n; i++) problem->active[i] = (PetscBool)(contact->rows.tied[i] || problem->gaps[i] < 0);
  while (changed) {
    PetscCall(RoundsNext(&problem->rounds));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(ComplementaritySolveActive(contact, problem));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(ComputeClosed(contact, problem));
    PetscCall(RoundsChange(&problem->rounds));
    PetscCall(RoundsHaveChanged(&problem->rounds, &changed));
    if (!changed) break;
    contact->counts.set_changes++;
    PetscCall(RoundsBreakCycle(&problem->rounds, &flips));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces on the rows of a body, as it takes them */
PetscErrorCode ComplementarityGetBodyForces(Contact contact, PetscInt b, const Complementarity *problem, PetscScalar forces[])
{
  const ContactBodyRows *of = &contact->body_rows[b];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < of->n; k++)
    forces[k] = ContactSign(&contact->pairs[contact->rows.pair[of->rows[k]]], b) * problem->forces[of->rows[k]];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint. C is set again before, with the rows as they are. */
PetscErrorCode ComplementarityVisit(Contact contact, Complementarity *problem, Checkpoint checkpoint)
{
  const PetscInt n = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitReals(checkpoint, "gaps", n, problem->gaps));
  PetscCall(CheckpointVisitReals(checkpoint, "forces", n, problem->forces));
  PetscCall(CheckpointVisitReals(checkpoint, "closed", n, problem->closed));
  PetscCall(CheckpointVisitBools(checkpoint, "active", n, problem->active));
  PetscCall(CheckpointVisitBytes(checkpoint, "marks", (size_t)n * sizeof(*problem->marks), problem->marks));
  PetscCall(CheckpointVisitBools(checkpoint, "current", 1, &problem->current));
  PetscCall(InterfaceOperatorVisit(problem->S, checkpoint));
  PetscCall(RoundsVisit(&problem->rounds, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}
