/* The effective matrix K + shift M + shift_velocity C of a body on TSALPHA2, and its solver: one for each level of cut steps. */
#include "implicitimpl.h"

/* The effective matrix with the artificial springs of a body that contact alone holds; its held dofs eliminated */
static PetscErrorCode AssembleMatrix(Body body, Vec u)
{
  BodyImplicit  *implicit = (BodyImplicit *)body->integrator->data;
  const PetscInt level    = body->time.level;
  const Vec      point    = implicit->points[level];
  ElementHistory before;
  Mat            A;

  PetscFunctionBegin;
  PetscCall(BodyBeginAssembly(body, implicit->matrix, &A));
  implicit->deformed[level] = (PetscBool)(u != NULL);
  if (u && u != point) PetscCall(VecCopy(u, point));
  if (u && u != point && body->history) PetscCall(BodyHistoryCopyStart(body, implicit->history[level], &implicit->history_step[level]));
  if (u && body->history) BodyHistoryUse(body, implicit->history[level], implicit->history_step[level], &before);
  PetscCall(BodyAssembleTangent(body, u, NULL, A));
  if (u && body->history) BodyHistoryLookBack(body, &before);
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
  implicit->shift          = implicit->alpha_m / (implicit->alpha_f * implicit->beta * PetscSqr(body->time.step));
  implicit->shift_velocity = implicit->gamma / (implicit->beta * body->time.step);
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
  if (!body->model.linear) PetscCall(BodyCreateVec(body, &implicit->points[body->time.level]));
  if (body->history) {
    PetscInt size;

    PetscCall(BodyHistoryCreateBuffer(body, body->model.element->count, &size, &implicit->memory[body->time.level],
                                      &implicit->history[body->time.level]));
  }
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

/* Matrix and factors of a nonlinear body anew, at the saved displacement */
PetscErrorCode BodyImplicitRenew(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyImplicitRefactor(body, body->saved.u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For a checkpoint: where a nonlinear body's matrix, in use until Newton's next iteration, was linearised, at a level of cut steps */
PetscErrorCode BodyImplicitVisit(Body body, PetscInt level, Checkpoint checkpoint)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;
  PetscBool     deformed = implicit->deformed[level];

  PetscFunctionBegin;
  PetscCall(CheckpointVisitBools(checkpoint, "linearised", 1, &deformed));
  if (!deformed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitVec(checkpoint, "linearised at", implicit->points[level]));
  if (body->history) {
    size_t size;

    (void)BodyHistoryGetSaved(body, &size);
    PetscCall(CheckpointVisitReals(checkpoint, "linearised from", (PetscInt)size, implicit->history[level]));
    PetscCall(CheckpointVisitReals(checkpoint, "linearised step", 1, &implicit->history_step[level]));
  }
  if (!CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyImplicitRefactor(body, implicit->points[level]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
