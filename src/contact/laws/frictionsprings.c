/* Springs between both sides of each row, which penalty methods have: forces stretch them, along the normals and across. */
#include "frictionstep.h"
#include <checkpoint/checkpoint.h>
#include <sys/units.h>

/* Stiffness of springs from the areas of the rows as they are */
PetscErrorCode FrictionSetUpSprings(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs && step->has_springs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscReal          parameter, scale;

    PetscCall((*step->springs.getparameter)(contact, pair, step->springs.penalty, step->springs.scale, &parameter, &scale));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscReal stiffness = parameter * contact->rows.area[i] * contact->resultants.cross_section[p];

      step->flexibility[i] = stiffness > 0 ? 1 / stiffness : 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Energy of the spring of a row [J]. One across the normal has no gap, and its force tells; a gap below 0 of it is how far it is stretched.
 */
PetscReal FrictionStoredEnergy(Contact contact, PetscInt i, PetscReal gap)
{
  const FrictionStep *step = (const FrictionStep *)contact->data;

  if (!(step->flexibility[i] > 0)) return 0;
  if (gap < 0) return 0.5 * PetscSqr(gap) / step->flexibility[i];
  return ContactRowRubs(contact, i) ? 0.5 * step->flexibility[i] * PetscSqr(contact->end.force[i]) : 0;
}

/* By how much a spring has given since it had the force of the multiplier [m] */
PetscReal FrictionGive(Contact contact, PetscInt i)
{
  const FrictionStep *step = (const FrictionStep *)contact->data;

  return step->flexibility[i] * (contact->end.force[i] - step->multiplier[i]);
}

/* Slips over the controller step of what springs across the normals hold on to */
PetscErrorCode FrictionComputeSlips(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactComputeSlips(contact));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (ContactRowRubs(contact, i)) contact->friction.slip[i] += FrictionGive(contact, i);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nothing is remembered from step to step but what contact itself has in a checkpoint, springs as the rows had them, and what is known of
   the compliance of rows that are too many for a matrix */
PetscErrorCode FrictionVisit(Contact contact, Checkpoint checkpoint)
{
  FrictionStep *step = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  if (step->has_springs) PetscCall(CheckpointVisitReals(checkpoint, "flexibility", contact->rows.n, step->flexibility));
  PetscCall(CheckpointVisitReals(checkpoint, "compliance", contact->rows.n, step->compliance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Springs, and by how much they may be stretched in the end */
PetscErrorCode FrictionViewSprings(Contact contact, PetscViewer viewer)
{
  const FrictionStep *step = (const FrictionStep *)contact->data;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscReal parameter, scale;

    PetscCall((*step->springs.getparameter)(contact, &contact->pairs[p], step->springs.penalty, step->springs.scale, &parameter, &scale));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  penalty parameter of %s %g%s, along the normals and across them\n", contact->pairs[p].name,
                                     (double)parameter, UnitsOf((PetscObject)contact, UNIT_STIFFNESS_ON_AREA)));
  }
  if (step->springs.max_it)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  augmented until gaps and slips are within %g%s\n", (double)step->springs.tolerance,
                                     UnitsOf((PetscObject)contact, UNIT_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
