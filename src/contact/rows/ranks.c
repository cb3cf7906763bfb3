/* What all ranks agree on. */
#include <contact/parts.h>

/* A flag that is 1 on any rank becomes 1 on all ranks; it is 0 or 1 before */
PetscErrorCode ContactOr(Contact contact, int *flag)
{
  PetscFunctionBegin;
  if (contact->ranks.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, flag, 1, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
