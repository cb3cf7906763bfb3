/* The state of the method, for checkpoints: what it remembers from step to step. */
#include "alternationimpl.h"
#include <checkpoint/checkpoint.h>

/* Which body of each pair takes displacements; the contact itself loads that of its pairs, and the order of bodies */
static PetscErrorCode VisitSides(Contact contact, Checkpoint checkpoint)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "side", 1, &alternation->side));
  PetscCall(CheckpointVisitBools(checkpoint, "started", 1, &alternation->started));
  if (CheckpointLoads(checkpoint)) alternation->levels = alternation->side_levels[alternation->side];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode AlternationVisit(Contact contact, Checkpoint checkpoint)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  PetscCall(VisitSides(contact, checkpoint));
  alternation->controller_step = contact->step;
  if (alternation->weight) PetscCall(CheckpointVisitReals(checkpoint, "weight", contact->rows.n, alternation->weight));
  PetscCall(RoundsVisit(&alternation->rounds, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}
