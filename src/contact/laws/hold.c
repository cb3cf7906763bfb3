/* Surfaces that have met and do not come apart: the rows of a node stay as closed as they are, pushed or pulled. */
#include "rowlaw.h"

PetscErrorCode RowLawCreate_hold(RowLaw *law)
{
  PetscFunctionBegin;
  PetscCall(RowLawCreate_tie(law));
  law->reads = ROW_LAW_READS_CLOSED;
  PetscFunctionReturn(PETSC_SUCCESS);
}
