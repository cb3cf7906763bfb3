/* The state of the method, for checkpoints: what it remembers from step to step, at each level of cut steps apart. */
#include "schwarzimpl.h"
#include <checkpoint/checkpoint.h>

static PetscErrorCode VisitSecants(Secants *secants, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  if (!secants->dx) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitInts(checkpoint, "secants", 1, &secants->n));
  PetscCall(CheckpointVisitInts(checkpoint, "next secant", 1, &secants->next));
  PetscCall(CheckpointVisitBools(checkpoint, "has last", 1, &secants->has_last));
  for (PetscInt i = 0; i < SCHWARZ_MAX_SECANTS; i++) {
    PetscCall(CheckpointVisitVec(checkpoint, "secant dx", secants->dx[i]));
    PetscCall(CheckpointVisitVec(checkpoint, "secant df", secants->df[i]));
  }
  PetscCall(CheckpointVisitVec(checkpoint, "last x", secants->last_x));
  PetscCall(CheckpointVisitVec(checkpoint, "last f", secants->last_f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode VisitJacobian(Contact contact, Jacobian *jacobian, Checkpoint checkpoint)
{
  const Schwarz *schwarz  = (const Schwarz *)contact->data;
  PetscInt       levels   = jacobian->levels;
  PetscBool      flags[3] = {jacobian->chain, jacobian->dense, (PetscBool)(jacobian->rows != NULL)};

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "jacobian", 1, &levels));
  PetscCall(CheckpointVisitBools(checkpoint, "chain", 3, flags));
  PetscCall(CheckpointVisitBytes(checkpoint, "marks", (size_t)contact->rows.n * sizeof(*jacobian->marks), jacobian->marks));
  PetscCall(InterfaceOperatorVisit(jacobian->S, checkpoint));
  if (CheckpointLoads(checkpoint)) {
    jacobian->levels = levels;
    jacobian->chain  = flags[0];
    if (flags[2]) InterfaceOperatorGetRows(jacobian->S, &jacobian->n, &jacobian->rows, &jacobian->dense);
    jacobian->dense = flags[1];
    if (jacobian->dense) PetscCall(SchwarzMakeJacobianRoom(jacobian, jacobian->n * levels, schwarz->dense_limit));
  }
  PetscCall(DenseFactorVisit(&jacobian->chained, schwarz->dense_limit, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is remembered at the present level */
static PetscErrorCode VisitPresent(Contact contact, Checkpoint checkpoint)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n       = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitBools(checkpoint, "stale", 1, &schwarz->stale));
  PetscCall(CheckpointVisitBools(checkpoint, "known", n, schwarz->known));
  PetscCall(CheckpointVisitBools(checkpoint, "solved active", n, schwarz->solved_active));
  PetscCall(VisitJacobian(contact, &schwarz->jacobian, checkpoint));
  PetscCall(VisitSecants(&schwarz->secants, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode VisitTraces(Contact contact, Checkpoint checkpoint)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < 2 * contact->n_pairs; p++)
    if (schwarz->trace[p]) PetscCall(CheckpointVisitTrace(checkpoint, "trace", schwarz->trace[p]));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(CheckpointVisitTrace(checkpoint, "exchange", schwarz->exchange[b]));
  for (PetscInt k = 0; k < 2; k++)
    if (schwarz->rate[k]) PetscCall(CheckpointVisitTrace(checkpoint, "rate", schwarz->rate[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which body of each pair takes displacements; the contact itself loads that of its pairs, and the order of bodies */
static PetscErrorCode VisitSides(Contact contact, Checkpoint checkpoint)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "side", 1, &schwarz->side));
  PetscCall(CheckpointVisitBools(checkpoint, "started", 1, &schwarz->started));
  if (CheckpointLoads(checkpoint)) schwarz->levels = schwarz->side_levels[schwarz->side];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The levels of cut steps that there have been; the one that is present last */
static PetscErrorCode VisitLevels(Contact contact, Checkpoint checkpoint)
{
  Schwarz  *schwarz = (Schwarz *)contact->data;
  PetscInt  present = schwarz->level;
  PetscBool begins;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "level", 1, &present));
  for (PetscInt k = 0; k <= STEP_MAX_CUTS + 1; k++) {
    const PetscInt level  = k <= STEP_MAX_CUTS ? k : present;
    PetscBool      exists = (PetscBool)(level == schwarz->level || schwarz->memory[level].begun);

    if ((level == present) != (k > STEP_MAX_CUTS)) continue;
    PetscCall(CheckpointVisitBools(checkpoint, "level exists", 1, &exists));
    if (!exists) continue;
    if (level != schwarz->level) {
      PetscCall(SchwarzTakeMemory(contact, level, &begins));
      if (begins) PetscCall(SchwarzCreateJacobian(contact));
    }
    PetscCall(VisitPresent(contact, checkpoint));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchwarzVisit(Contact contact, Checkpoint checkpoint)
{
  Schwarz       *schwarz = (Schwarz *)contact->data;
  const PetscInt n       = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(VisitSides(contact, checkpoint));
  schwarz->controller_step = contact->step;
  if (schwarz->weight) PetscCall(CheckpointVisitReals(checkpoint, "weight", n, schwarz->weight));
  PetscCall(VisitLevels(contact, checkpoint));
  PetscCall(CheckpointVisitVec(checkpoint, "outer", schwarz->outer.x));
  PetscCall(CheckpointVisitReals(checkpoint, "damping", 1, &schwarz->damping));
  if (schwarz->last_residual) PetscCall(CheckpointVisitVec(checkpoint, "last residual", schwarz->last_residual));
  PetscCall(VisitTraces(contact, checkpoint));
  PetscCall(RoundsVisit(&schwarz->rounds, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}
