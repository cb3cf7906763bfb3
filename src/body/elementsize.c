/* How large the elements of a body are. */
#include "bodyimpl.h"

/*@
  BodyGetElementSize - edge length of the elements, from their mean volume

  Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. size - edge of the line, square or cube with the mean volume of the elements; of simplices, of that which holds 2 or 6 of them [m]

  Level: developer

.seealso: `Body`, `BodyGetMass()`
@*/
PetscErrorCode BodyGetElementSize(Body body, PetscReal *size)
{
  const PetscBool simplex = (PetscBool)(body->element->nodes == body->dim + 1);
  PetscReal       density, volume;
  PetscInt        count = body->element->count;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  PetscCall(MaterialGetDensity(body->material, &density));
  volume = body->total_mass / (density * body->element->cross_section * count);
  if (simplex) volume *= body->dim == 3 ? 6 : body->dim;
  *size = PetscPowReal(volume, 1.0 / body->dim);
  PetscFunctionReturn(PETSC_SUCCESS);
}
