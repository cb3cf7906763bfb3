/* The effective matrix K + shift M + shift_velocity C of a body on TSALPHA2, and its solver: one for each level of cut steps. */
#include "implicitimpl.h"

/* The effective matrix with the artificial springs of a body that contact alone holds; its held dofs eliminated */
static PetscErrorCode AssembleMatrix(Body body, Vec u)
{
  const BodyImplicit  *implicit = (const BodyImplicit *)body->integrator->data;
  const ElementHistory before   = body->model.element->history;
  Mat                  A;

  PetscFunctionBegin;
  PetscCall(BodyBeginAssembly(body, implicit->matrix, &A));
  body->model.element->history.end = NULL;
  PetscCall(BodyAssembleTangent(body, u, NULL, A));
  BodyHistoryLookBack(body, &before);
  if (implicit->shift > 0) PetscCall(BodyAddMassMatrix(body, implicit->shift, A));
  PetscCall(BodyAddDampingMatrix(body, u, implicit->shift_velocity, A));
  PetscCall(BodyAddSpringStiffness(body, A));
  PetscCall(BodyEliminateHeld(body, A));
  PetscCall(BodyEndAssembly(implicit->matrix, A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix and its factors anew, at a displacement of a nonlinear body */
PetscErrorCode BodyImplicitRefactor(Body body, Vec u)
{
  PetscFunctionBegin;
  ((BodyImplicit *)body->integrator->data)->iterated = PETSC_TRUE;
  PetscCall(AssembleMatrix(body, u));
  PetscCall(ConstrainedSolverRefactor(body->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For CG with multigrid: what the body can do without strain */
static PetscErrorCode SetNearNullSpace(Body body, Mat A)
{
  MatNullSpace rigid;
  Vec          coordinates;

  PetscFunctionBegin;
  if (body->mesh.dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDuplicate(body->mesh.positions, &coordinates));
  PetscCall(VecCopy(body->mesh.positions, coordinates));
  PetscCall(VecSetBlockSize(coordinates, body->mesh.dim));
  PetscCall(MatSetBlockSize(A, body->mesh.dim));
  PetscCall(MatNullSpaceCreateRigidBody(coordinates, &rigid));
  PetscCall(MatSetNearNullSpace(A, rigid));
  PetscCall(MatNullSpaceDestroy(&rigid));
  PetscCall(VecDestroy(&coordinates));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much acceleration and velocity at the stage change with the displacement there */
static void SetShifts(Body body)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;

  if (!body->integrator->has_inertia) return;
  implicit->shift          = implicit->alpha_m / (implicit->alpha_f * body->integrator->beta * PetscSqr(body->time.step));
  implicit->shift_velocity = body->integrator->gamma / (body->integrator->beta * body->time.step);
}

/* The factors are there, and what depends on how many numbers they have */
PetscErrorCode BodyEndSolver(Body body)
{
  PetscFunctionBegin;
  if (body->solver_begun) PetscCall(ConstrainedSolverEnd(body->solver));
  body->solver_begun = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The effective matrix at a displacement, with its factors in body->solver, for controller steps of the present level. It is K + alpha_m /
   (alpha_f beta dt^2) M + gamma / (beta dt) C, with the dashpots C, and K alone without inertia. */
PetscErrorCode BodyImplicitCreateSolver(Body body, Vec u)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  SetShifts(body);
  PetscCall(BodyCreateMatrix(body, NULL, &implicit->matrix));
  implicit->matrices[body->time.level] = implicit->matrix;
  PetscCall(AssembleMatrix(body, u));
  PetscCall(SetNearNullSpace(body, implicit->matrix));
  PetscCall(ConstrainedSolverBegin(implicit->matrix, body->rows.free_matrix, body->mesh.dim, ((PetscObject)body)->prefix,
                                   body->model.linear, &body->solver));
  body->solver_begun = PETSC_TRUE;
  if (body->setup) PetscCall(BodyEndSolver(body));
  if (!body->integrator->has_inertia) ConstrainedSolverSetExact(body->solver);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Matrix and solver for controller steps at another level of cuts. That of a linear body without inertia is the same for all steps. */
PetscErrorCode BodyImplicitSetLevel(Body body)
{
  BodyImplicit  *implicit = (BodyImplicit *)body->integrator->data;
  const PetscInt level    = body->time.level;

  PetscFunctionBegin;
  if (!body->integrator->has_inertia && body->model.linear) PetscFunctionReturn(PETSC_SUCCESS);
  if (!implicit->matrices[level]) {
    PetscCall(BodyImplicitCreateSolver(body, body->model.linear ? NULL : body->saved.u));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  implicit->matrix = implicit->matrices[level];
  SetShifts(body);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Factors of the last iteration of Newton's method in a substep of a nonlinear body or, where it took none, those at its start: what is
   made of them depends on that substep alone. Of a local body its rank alone knows of iterations. Collective. */
PetscErrorCode BodyImplicitRenew(Body body)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  if (body->local) PetscCallMPI(MPI_Bcast(&implicit->iterated, 1, MPI_C_BOOL, body->mesh.owner, PetscObjectComm((PetscObject)body)));
  if (!implicit->iterated) PetscCall(BodyImplicitRefactor(body, body->saved.u));
  PetscFunctionReturn(PETSC_SUCCESS);
}
