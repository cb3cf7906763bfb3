/*
   Glue: springs between both sides of each row, lambda = -k g. As a projection it is the tie, P the identity, of what the foot of the
   spring reads, g + lambda / k, with the gap g on which the force of the step does its work: then the springs take what the bodies give.
*/
#include "rowlaw.h"

static PetscReal Compliance(PetscReal stiffness)
{
  return 1 / stiffness;
}

static PetscReal Stored(PetscReal stiffness, PetscReal gap)
{
  return 0.5 * stiffness * gap * gap;
}

PetscErrorCode RowLawCreate_Spring(RowLaw *law)
{
  PetscFunctionBegin;
  PetscCall(RowLawCreate_Tie(law));
  law->reads      = ROW_LAW_READS_MEAN;
  law->compliance = Compliance;
  law->stored     = Stored;
  PetscFunctionReturn(PETSC_SUCCESS);
}
