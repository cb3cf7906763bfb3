/* What follows from mesh and material alone: mass, size, stiffness and wave impedance. */
#include <body/layout/bodyimpl.h>

/*@
  BodyGetDimension - dimension of the space that the body lies in

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. dim - 1, 2 or 3: displacements of a node

  Level: intermediate

.seealso: `Body`, `BodyGetDM()`
@*/
PetscErrorCode BodyGetDimension(Body body, PetscInt *dim)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(dim, 2);
  PetscCheck(body->mesh.dm, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Body '%s' has no mesh yet", body->hdr.name);
  PetscCall(DMGetCoordinateDim(body->mesh.dm, dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetMass - the mass of the body

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. mass - [kg]

  Level: intermediate

.seealso: `Body`
@*/
PetscErrorCode BodyGetMass(Body body, PetscReal *mass)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(mass, 2);
  *mass = body->mass.total;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetInertia - centre of mass and inertia tensor of the undeformed body, with all mass where the mesh has it

  Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameters:
+ centre  - centre of mass, zeros beyond the space dimension [m]
- inertia - tensor about it, rows along x, y, z; of plane bodies about the third axis alone, zero of bars and of rings, which do not turn
            [kg m^2]

  Level: intermediate

  Note:
  The consistent mass of the mesh whatever the mass matrix of the body is, so that a brick has the moments of a brick.

.seealso: `Body`, `BodyGetMass()`, `BodyGetMassRedistribution()`
@*/
PetscErrorCode BodyGetInertia(Body body, PetscReal centre[3], PetscReal inertia[9])
{
  const PetscInt nodes = body->model.element->nodes, dim = body->mesh.dim;
  PetscScalar    M[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES];
  PetscReal      sums[9] = {0}, trace;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(centre, 2);
  PetscAssertPointer(inertia, 3);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  PetscCall(PetscArraycpy(centre, body->mass.centre, 3));
  PetscCall(PetscArrayzero(inertia, 9));
  if (dim == 1 || body->model.element->axisymmetric) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt pass = 0; pass < 2; pass++) { /* first moments give the centre, second moments about it the tensor */
    PetscCall(PetscArrayzero(sums, 9));
    for (PetscInt e = 0; e < body->model.element->count; e++) {
      PetscReal r[ELEMENT_MAX_NODES][3] = {{0}};

      PetscCall((*body->model.element->ops->mass)(body->model.element, e, M));
      for (PetscInt a = 0; a < nodes; a++)
        for (PetscInt d = 0; d < dim; d++) r[a][d] = body->mesh.coordinates[body->mesh.connectivity[e * nodes + a] * dim + d] - centre[d];
      for (PetscInt i = 0; i < nodes * nodes; i++)
        for (PetscInt k = 0; k < (pass ? 9 : dim); k++)
          sums[k] += M[i] * (pass ? r[i / nodes][k / 3] * r[i % nodes][k % 3] : r[i / nodes][k]);
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 9, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
    for (PetscInt d = 0; d < dim && !pass; d++) centre[d] += sums[d] / body->mass.total;
  }
  trace = sums[0] + sums[4] + sums[8];
  for (PetscInt k = 0; k < 9; k++) inertia[k] = (k % 4 ? 0 : trace) - sums[k];
  for (PetscInt k = 0; k < 8 && dim == 2; k++) inertia[k] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetMassRedistribution - what a massless contact layer has changed

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameters:
+ least   - smallest factor on the masses that are left, 1 if no node is massless, or `NULL`
. largest - largest factor, or `NULL`
. shift   - how far the centre of mass is off that of the full mass, `dim` values, 0: it is kept [m]; or `NULL`
- inertia - largest change of a moment of inertia about an axis through the centre of mass, relative to it, 0: all are kept; or `NULL`

  Level: intermediate

  Note:
  The total mass is always kept.

.seealso: `Body`, `BodySetMassRedistribute()`, `BodyView()`
@*/
PetscErrorCode BodyGetMassRedistribution(Body body, PetscReal *least, PetscReal *largest, PetscReal shift[], PetscReal *inertia)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  if (least) *least = body->mass.least_factor > 0 ? body->mass.least_factor : 1; /* also where this rank has no node */
  if (largest) *largest = body->mass.least_factor > 0 ? body->mass.largest_factor : 1;
  for (PetscInt d = 0; shift && d < body->mesh.dim; d++) shift[d] = body->mass.shift[d];
  if (inertia) *inertia = body->mass.inertia_error;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What lengths and points of the mesh are multiplied by to give areas: the cross-section of bars [m^2], the thickness of plane bodies
   [m], else 1 */
PetscErrorCode BodyGetCrossSection(Body body, PetscReal *cross_section)
{
  PetscFunctionBegin;
  *cross_section = body->model.element->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Measure of all cells (length, area or volume), their number, and how many are simplices, on all ranks together: a rank without cells does
   not know their shape */
static PetscErrorCode SumCells(Body body, PetscReal sums[3])
{
  PetscBool simplex;
  PetscInt  cstart, cend;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(sums, body->mesh.cells, 3));
  if (sums[1] > 0) PetscFunctionReturn(PETSC_SUCCESS);
  sums[0] = 0;
  PetscCall(DMPlexGetHeightStratum(body->mesh.dm, 0, &cstart, &cend));
  for (PetscInt cell = cstart; cell < cend; cell++) {
    PetscReal measure;

    PetscCall(DMPlexComputeCellGeometryFVM(body->mesh.dm, cell, &measure, NULL, NULL));
    sums[0] += measure;
  }
  PetscCall(DMPlexIsSimplex(body->mesh.dm, &simplex));
  sums[1] = cend - cstart;
  sums[2] = simplex ? cend - cstart : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscCall(PetscArraycpy(body->mesh.cells, sums, 3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Edge of the line, square or cube with the mean volume of the elements; of simplices, of that which holds 2 or 6 of them [m].
   Collective. */
PetscErrorCode BodyGetElementSize(Body body, PetscReal *size)
{
  PetscReal sums[3];
  PetscInt  dim;

  PetscFunctionBegin;
  PetscCall(BodyGetDimension(body, &dim));
  PetscCall(SumCells(body, sums));
  if (sums[2] > 0 && dim > 1) sums[0] *= dim == 3 ? 6 : 2;
  *size = PetscPowReal(sums[0] / sums[1], 1.0 / dim);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyGetElementSize() of the elements with a contact node, or of all where there are none. Collective. */
PetscErrorCode BodyGetContactElementSize(Body body, PetscReal *size)
{
  const PetscInt nodes   = body->mesh.cell_nodes;
  PetscReal      sums[3] = {0}; /* as those of SumCells() */
  PetscInt       dim, cstart, cend;
  PetscBool      simplex;

  PetscFunctionBegin;
  *size = body->layer.edge;
  if (*size > 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetDimension(body, &dim));
  PetscCall(DMPlexIsSimplex(body->mesh.dm, &simplex));
  PetscCall(DMPlexGetHeightStratum(body->mesh.dm, 0, &cstart, &cend));
  for (PetscInt e = 0; e < cend - cstart; e++) {
    PetscBool touches = PETSC_FALSE;
    PetscReal measure;

    for (PetscInt a = 0; a < nodes && !touches; a++) touches = body->layer.contains[body->mesh.cell_connectivity[e * nodes + a]];
    if (!touches) continue;
    PetscCall(DMPlexComputeCellGeometryFVM(body->mesh.dm, cstart + e, &measure, NULL, NULL));
    sums[0] += measure;
    sums[1]++;
    if (simplex) sums[2]++;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  if (!(sums[1] > 0)) PetscCall(SumCells(body, sums));
  if (sums[2] > 0 && dim > 1) sums[0] *= dim == 3 ? 6 : 2;
  *size = body->layer.edge = PetscPowReal(sums[0] / sums[1], 1.0 / dim);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Force for a unit velocity of a plane wave, for each unit of area: sqrt((lambda + 2 mu) rho) [N s/m^3]; of a bar sqrt(E rho) times its
   cross-section [N s/m]. Of BodyGetSurfaceMaterial(). */
PetscErrorCode BodyGetImpedance(Body body, PetscReal *impedance)
{
  PetscReal density, modulus;
  Material  material;

  PetscFunctionBegin;
  PetscCall(BodyGetSurfaceMaterial(body, &material));
  PetscCall(MaterialGetDensity(material, &density));
  if (body->mesh.dim == 1) PetscCall(MaterialGetUniaxialModulus(material, &modulus));
  else PetscCall(MaterialGetWaveModulus(material, &modulus));
  *impedance = PetscSqrtReal(modulus * density) * body->model.element->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stiffness of an element against pressure on a face: modulus of plane waves over edge length [N/m^3], times the cross-section in one
   dimension [N/m]. Of BodyGetSurfaceMaterial(). */
PetscErrorCode BodyGetElementStiffness(Body body, PetscReal *stiffness)
{
  PetscReal impedance, density, size, cross_section;
  Material  material;
  PetscInt  dim;

  PetscFunctionBegin;
  PetscCall(BodyGetImpedance(body, &impedance));
  PetscCall(BodyGetSurfaceMaterial(body, &material));
  PetscCall(MaterialGetDensity(material, &density));
  PetscCall(BodyGetElementSize(body, &size));
  PetscCall(BodyGetCrossSection(body, &cross_section));
  PetscCall(BodyGetDimension(body, &dim));
  *stiffness = PetscSqr(impedance / cross_section) / density / size * (dim == 1 ? cross_section : 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}
