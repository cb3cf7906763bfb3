/* The effective matrix K + shift M + shift_velocity C of a body on TSALPHA2, and the solver with its factors: one for each level of cut
   controller steps. */
#include "implicitimpl.h"
#include <impakt/private/simd.h>

/* Where the matrix of whole controller steps was linearised last, to another vector or back; the first number tells whether it was */
static PetscErrorCode CopyPoint(Body body, PetscBool back, Vec point, PetscReal numbers[2])
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  if (back) {
    /* a displacement of earlier steps goes with the history of these steps, which is not there any more */
    if (numbers[0] != 0) PetscCall(BodyImplicitRefactor(body, body->history ? body->saved.u : point));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  numbers[0] = implicit->deformed[0];
  numbers[1] = 0;
  if (implicit->deformed[0]) PetscCall(VecCopy(implicit->points[0], point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where a local body was linearised last its rank alone knows, and has factors that no column of others is of; before all ranks have rows
   to hold, they all do */
static PetscErrorCode Agree(Body body)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  if (body->model.linear) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Bcast(&implicit->deformed[body->time.level], 1, MPI_C_BOOL, body->mesh.owner, PetscObjectComm((PetscObject)body)));
  PetscCall(ConstrainedSolverForgetColumns(body->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings what BodyImplicitCorrect() needs from ranks with rows */
static PetscErrorCode BringChanges(Body body, const PetscScalar force[])
{
  PetscFunctionBegin;
  PetscCall(ConstrainedSolverBring(body->solver, force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What all integrators on TSALPHA2 have in common */
PetscErrorCode BodyImplicitCreate(BodyIntegrator integrator)
{
  BodyImplicit *implicit;

  PetscFunctionBegin;
  PetscCall(PetscNew(&implicit));
  integrator->data               = implicit;
  integrator->reads_start        = PETSC_TRUE;
  integrator->feels_end_force    = PETSC_TRUE;
  integrator->repeats_prescribed = PETSC_TRUE;
  integrator->ops.bringchanges   = BringChanges;
  integrator->ops.setrows        = BodyImplicitSetRows;
  integrator->ops.setlevel       = BodyImplicitSetLevel;
  integrator->ops.renew          = BodyImplicitRenew;
  integrator->ops.checksubstep   = BodyImplicitCheckSubstep;
  integrator->ops.visit          = BodyImplicitVisit;
  integrator->ops.copypoint      = CopyPoint;
  integrator->ops.agree          = Agree;
  integrator->ops.destroy        = BodyImplicitDestroy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The effective matrix K + shift M + shift_velocity C, with the artificial springs of a body that contact alone holds; its held dofs
 * eliminated */
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
  if (!body->model.linear && implicit->unit_strain == 0) PetscCall(BodyImplicitComputeUnitStrainForce(body));
  PetscCall(AssembleMatrix(body, u));
  PetscCall(SetNearNullSpace(body, implicit->matrix));
  PetscCall(ConstrainedSolverBegin(implicit->matrix, body->rows.free_matrix, body->mesh.dim, ((PetscObject)body)->prefix,
                                   body->model.linear, &body->solver));
  body->solver_begun = PETSC_TRUE;
  if (body->setup) PetscCall(BodyEndSolver(body));
  if (!body->integrator->has_inertia) ConstrainedSolverSetExact(body->solver);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Matrix and solver for controller steps that are cut in halves another number of times. That of a linear body without inertia is the same
   for all steps. */
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

PetscErrorCode BodyImplicitSetRows(Body body, const PetscMPIInt changed[])
{
  PetscFunctionBegin;
  PetscCall(ConstrainedSolverSetRows(body->solver, body->rows.free_matrix, changed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* u, v and a += du times these parts */
SIMD_CLONES static void AddChange(PetscInt n, PetscReal part, PetscReal to_velocity, PetscReal to_acceleration, const PetscScalar du[],
                                  PetscScalar u[], PetscScalar v[], PetscScalar a[])
{
#pragma omp simd
  for (PetscInt i = 0; i < n; i++) {
    u[i] += part * du[i];
    v[i] += part * to_velocity * du[i];
    a[i] += part * to_acceleration * du[i];
  }
}

/* Moves the displacement at the end of the one substep of a linear body: A du = part B^T df with prescribed rows at B du = dx, A being the
   effective matrix; and velocity, acceleration and internal force with it. With a part other than 1 no row is prescribed. */
PetscErrorCode BodyImplicitCorrect(Body body, const PetscScalar displacement[], PetscReal part, PetscReal to_velocity,
                                   PetscReal to_acceleration, Vec du)
{
  const PetscScalar *change;
  PetscScalar       *u, *v, *a;

  PetscFunctionBegin;
  PetscCall(ConstrainedSolverCorrect(body->solver, displacement, du));
  PetscCall(VecGetArrayRead(du, &change));
  PetscCall(VecGetArray(body->state.u, &u));
  PetscCall(VecGetArray(body->state.v, &v));
  PetscCall(VecGetArray(body->state.a, &a));
  AddChange(body->mesh.owned_nodes * body->mesh.dim, part, to_velocity, to_acceleration, change, u, v, a);
  PetscCall(VecRestoreArray(body->state.a, &a));
  PetscCall(VecRestoreArray(body->state.v, &v));
  PetscCall(VecRestoreArray(body->state.u, &u));
  PetscCall(VecRestoreArrayRead(du, &change));
  PetscCall(BodyImplicitNoteForce(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint: where the matrix of a nonlinear body was linearised last, at a level of cut steps. Its factors answer until the
   next iteration of Newton's method. */
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

PetscErrorCode BodyImplicitDestroy(Body body)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;
  Vec *vecs[] = {&implicit->u, &implicit->v, &implicit->a, &implicit->next, &implicit->stage_u, &implicit->stage_v, &implicit->stage_a};

  PetscFunctionBegin;
  for (size_t i = 0; i < sizeof(vecs) / sizeof(vecs[0]); i++) PetscCall(VecDestroy(vecs[i]));
  for (PetscInt k = 0; k < 4; k++) PetscCall(VecDestroy(&implicit->lead[k]));
  PetscCall(BodyImplicitDestroyOwnStep(body));
  for (PetscInt k = 0; k <= STEP_MAX_CUTS; k++) {
    PetscCall(MatDestroy(&implicit->matrices[k]));
    PetscCall(VecDestroy(&implicit->points[k]));
    PetscCall(PetscFree(implicit->memory[k]));
  }
  PetscCall(PetscFree(body->integrator->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}
