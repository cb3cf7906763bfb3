/* How large the elements of a body are, and how stiff. */
#include "bodyimpl.h"

/* Measure of all cells (length, area or volume), and their number, on all ranks together */
static PetscErrorCode SumCells(Body body, PetscReal sums[2])
{
  PetscInt cstart, cend;

  PetscFunctionBegin;
  sums[0] = 0;
  PetscCall(DMPlexGetHeightStratum(body->dm, 0, &cstart, &cend));
  for (PetscInt cell = cstart; cell < cend; cell++) {
    PetscReal measure;

    PetscCall(DMPlexComputeCellGeometryFVM(body->dm, cell, &measure, NULL, NULL));
    sums[0] += measure;
  }
  sums[1] = cend - cstart;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetElementSize - edge length of the elements, from their mean volume

  Collective

  Input Parameter:
. body - the `Body`, with its mesh

  Output Parameter:
. size - edge of the line, square or cube with the mean volume of the elements; of simplices, of that which holds 2 or 6 of them [m]

  Level: developer

.seealso: `Body`, `BodyGetDM()`
@*/
PetscErrorCode BodyGetElementSize(Body body, PetscReal *size)
{
  PetscReal sums[2];
  PetscBool simplex;
  PetscInt  dim;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(size, 2);
  PetscCall(BodyGetDimension(body, &dim));
  PetscCall(DMPlexIsSimplex(body->dm, &simplex));
  PetscCall(SumCells(body, sums));
  if (simplex && dim > 1) sums[0] *= dim == 3 ? 6 : 2;
  *size = PetscPowReal(sums[0] / sums[1], 1.0 / dim);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetElementStiffness - what an element has to set against pressure

  Collective

  Input Parameter:
. body - the `Body`, with its mesh and material

  Output Parameter:
. stiffness - modulus of plane waves over edge length [N/m^3], times the cross-sectional area in one dimension [N/m]

  Level: developer

.seealso: `Body`, `BodyGetElementSize()`, `BodyGetImpedance()`
@*/
PetscErrorCode BodyGetElementStiffness(Body body, PetscReal *stiffness)
{
  PetscReal impedance, density, size, cross_section;
  PetscInt  dim;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(stiffness, 2);
  PetscCall(BodyGetImpedance(body, &impedance));
  PetscCall(MaterialGetDensity(body->material, &density));
  PetscCall(BodyGetElementSize(body, &size));
  PetscCall(BodyGetCrossSection(body, &cross_section));
  PetscCall(BodyGetDimension(body, &dim));
  *stiffness = PetscSqr(impedance / cross_section) / density / size * (dim == 1 ? cross_section : 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}
