/* The state of the method, for checkpoints: what it remembers from step to step. */
#include "schwarzimpl.h"
#include <checkpoint/checkpoint.h>

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

PetscErrorCode SchwarzVisit(Contact contact, Checkpoint checkpoint)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(VisitSides(contact, checkpoint));
  schwarz->controller_step = contact->step;
  if (schwarz->weight) PetscCall(CheckpointVisitReals(checkpoint, "weight", contact->rows.n, schwarz->weight));
  PetscCall(RoundsVisit(&schwarz->rounds, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}
