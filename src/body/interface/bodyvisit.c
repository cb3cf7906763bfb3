/* The state of a body, for checkpoints: what the next controller step begins with, bit for bit. Beside displacement, velocity and
   acceleration these are the waveforms at its rows, what its solvers hold, where the matrix of a layer was linearised, and the compliance
   that is known, level by level of cut steps. The rows themselves are loaded before, by those who own their matrices. */
#include <petscsf.h>
#include <body/rows/complianceimpl.h>
#include <sys/bytesum.h>
#include "bodyvisit.h"

/* The saved state is the present one too */
static PetscErrorCode VisitHistory(Body body, Checkpoint checkpoint)
{
  size_t     size;
  PetscReal *saved = BodyHistoryGetSaved(body, &size);

  PetscFunctionBegin;
  if (saved) PetscCall(CheckpointVisitReals(checkpoint, "history", (PetscInt)size, saved));
  if (CheckpointLoads(checkpoint)) BodyHistoryRestore(body);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the rows mean, and the solvers that hold them know in VisitSolver() */
static PetscErrorCode VisitConditions(Body body, Checkpoint checkpoint)
{
  BodyRows *rows = &body->rows;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitBytes(checkpoint, "conditions", (size_t)rows->local * sizeof(*rows->conditions), rows->conditions));
  PetscCall(CheckpointVisitBools(checkpoint, "constrained", rows->local, rows->constrained));
  PetscCall(CheckpointVisitReals(checkpoint, "flexibility", rows->local, rows->flexibility));
  PetscCall(CheckpointVisitReals(checkpoint, "robin", rows->local, rows->robin));
  PetscCall(CheckpointVisitInts(checkpoint, "n_prescribed", 1, &rows->n_prescribed));
  PetscCall(CheckpointVisitInts(checkpoint, "n_forced", 1, &rows->n_forced));
  PetscCall(CheckpointVisitInts(checkpoint, "n_robin", 1, &rows->n_robin));
  PetscCall(CheckpointVisitVec(checkpoint, "stage balance", rows->stage_balance));
  if (!CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyUpdateGram(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns are known in the order in which they have been asked for, and their last bits with them */
static PetscErrorCode VisitNodal(Body body, struct _BodyCompliance *compliance, Checkpoint checkpoint)
{
  PetscBool has   = (PetscBool)(compliance->nodal != NULL);
  PetscInt  shape = compliance->nodal_shape;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitBools(checkpoint, "nodal", 1, &has));
  if (CheckpointLoads(checkpoint)) {
    PetscCall(ComplianceDestroy(&compliance->nodal));
    PetscCall(NodalMatrixDestroy(&compliance->nodal_matrix));
  }
  if (!has) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitInts(checkpoint, "nodal kind", 1, &compliance->nodal_kind));
  PetscCall(CheckpointVisitInts(checkpoint, "nodal shape", 1, &shape));
  PetscCall(CheckpointVisitReals(checkpoint, "nodal step", 1, &compliance->nodal_step));
  PetscCall(CheckpointVisitReals(checkpoint, "nodal time", 1, &compliance->nodal_time));
  compliance->nodal_shape = (BodyForceShape)shape;
  if (!compliance->nodal) PetscCall(ComplianceCreate(body->state.u, &compliance->nodal));
  PetscCall(ComplianceVisit(compliance->nodal, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compliance and solver of a level of cut steps: the body itself has those of the present one */
static BodyLevel GetLevel(Body body, PetscInt k)
{
  return k == body->time.level ? (BodyLevel){body->compliance, body->solver} : body->levels[k];
}

/* One level of cut steps; loading, it becomes the present one. What it shares with the first level has been visited with that. */
static PetscErrorCode VisitLevel(Body body, PetscInt k, Checkpoint checkpoint)
{
  BodyLevel level, first;

  PetscFunctionBegin;
  if (CheckpointLoads(checkpoint) && k != body->time.level) PetscCall(BodyTakeLevel(body, k));
  level = GetLevel(body, k);
  first = GetLevel(body, 0);
  if (body->integrator->ops.visit) PetscCall((*body->integrator->ops.visit)(body, k, checkpoint));
  if (k == 0 || level.compliance != first.compliance) PetscCall(VisitNodal(body, level.compliance, checkpoint));
  if (level.solver && (k == 0 || level.solver != first.solver)) PetscCall(ConstrainedSolverVisit(level.solver, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All levels that there have been; then the one that was present is present again */
static PetscErrorCode VisitLevels(Body body, Checkpoint checkpoint)
{
  PetscInt present = body->time.level;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "level", 1, &present));
  for (PetscInt k = 0; k <= STEP_MAX_CUTS; k++) {
    PetscBool exists = (PetscBool)(k == present || body->levels[k].compliance);

    PetscCall(CheckpointVisitBools(checkpoint, "level exists", 1, &exists));
    if (exists) PetscCall(VisitLevel(body, k, checkpoint));
  }
  if (CheckpointLoads(checkpoint) && present != body->time.level) PetscCall(BodyTakeLevel(body, present));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode VisitMassSolver(Body body, Checkpoint checkpoint)
{
  PetscBool has = (PetscBool)(body->mass.solver != NULL);

  PetscFunctionBegin;
  PetscCall(CheckpointVisitBools(checkpoint, "mass solver", 1, &has));
  if (!has) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->mass.solver) PetscCall(BodySetUpMassSolver(body));
  PetscCall(ConstrainedSolverVisit(body->mass.solver, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes sure that the mesh is that of the checkpoint, on the same ranks */
PetscErrorCode BodyVisitMesh(Body body, Checkpoint checkpoint)
{
  const PetscInt     sizes[] = {body->mesh.dim, body->mesh.owned_nodes, body->mesh.local_nodes};
  const PetscScalar *positions;
  PetscInt           sum;

  PetscFunctionBegin;
  PetscCall(CheckpointBegin(checkpoint, body->hdr.name));
  PetscCall(CheckpointCheckInts(checkpoint, "dimensions, nodes and nodes with ghosts", PETSC_STATIC_ARRAY_LENGTH(sizes), sizes));
  PetscCall(VecGetArrayRead(body->mesh.positions, &positions));
  sum = (PetscInt)(ByteSum(BYTE_SUM_BEGIN, (size_t)(body->mesh.owned_nodes * body->mesh.dim) * sizeof(*positions), positions) & 0x7fffffff);
  PetscCall(VecRestoreArrayRead(body->mesh.positions, &positions));
  PetscCall(CheckpointCheckInts(checkpoint, "sum over the positions of nodes", 1, &sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state of a body after an accepted controller step, to or from a checkpoint; loading: in its first state, with rows. Collective. */
PetscErrorCode BodyVisit(Body body, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointBegin(checkpoint, body->hdr.name));
  PetscCall(BodyFindInternalForce(body));
  for (PetscInt k = 0; k < STATE_VECS; k++) PetscCall(CheckpointVisitVec(checkpoint, "state", body->state.vecs[k]));
  if (CheckpointLoads(checkpoint)) PetscCall(BodyStateCopy(body, &body->state, &body->saved));
  PetscCall(VisitHistory(body, checkpoint));
  PetscCall(VisitLevels(body, checkpoint));
  for (PetscInt t = 0; t < BODY_TRACES; t++) PetscCall(CheckpointVisitTrace(checkpoint, "trace", body->traces.all[t]));
  PetscCall(VisitConditions(body, checkpoint));
  PetscCall(VisitMassSolver(body, checkpoint));
  if (!CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyResetSprings(body));
  PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  PetscCall(BodyHandoverEnd(body));
  body->start.changed = body->iterate.known = body->repeats = PETSC_FALSE;
  body->state.force_known = body->saved.force_known = body->integrator->leaves_force;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a node of a body lies on three ranks or more: PETSc adds what two other ranks have for a matrix as it comes */
static PetscErrorCode SumsAsItComes(Body body, PetscBool *does)
{
  PetscSF         sf;
  const PetscInt *degrees;
  PetscInt        start, end;

  PetscFunctionBegin;
  *does = PETSC_FALSE;
  if (body->rows.size < 3) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMGetPointSF(body->mesh.dm, &sf));
  PetscCall(DMPlexGetDepthStratum(body->mesh.dm, 0, &start, &end));
  PetscCall(PetscSFComputeDegreeBegin(sf, &degrees));
  PetscCall(PetscSFComputeDegreeEnd(sf, &degrees));
  for (PetscInt p = start; p < end && !*does; p++) *does = (PetscBool)(degrees[p] > 1);
  PetscCall(BodyAnyRank(body, does));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyRepeatsBits - whether the matrices of a body and their solvers find the same to the last bit in another run; Collective */
PetscErrorCode BodyRepeatsBits(Body body, PetscBool *repeats)
{
  const ConstrainedSolver solvers[] = {body->solver, body->mass.solver};
  PetscBool               sums;

  PetscFunctionBegin;
  *repeats = PETSC_TRUE;
  for (int k = 0; k < 2 && *repeats; k++)
    if (solvers[k]) PetscCall(ConstrainedSolverRepeats(solvers[k], repeats));
  PetscCall(SumsAsItComes(body, &sums));
  if (sums) *repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
