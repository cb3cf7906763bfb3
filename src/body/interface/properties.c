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

/* Edge of the elements with a contact node, or of all, from their mean volume, see BodyScale. Ranks may have no cells. */
static PetscErrorCode MeasureEdge(Body body, PetscBool contact, PetscReal *edge)
{
  const PetscInt nodes   = body->mesh.cell_nodes;
  PetscReal      sums[3] = {0}; /* volume of cells, their number, and how many are simplices */
  PetscInt       dim, cstart, cend;
  PetscBool      simplex;

  PetscFunctionBegin;
  if (*edge > 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetDimension(body, &dim));
  PetscCall(DMPlexIsSimplex(body->mesh.dm, &simplex));
  PetscCall(DMPlexGetHeightStratum(body->mesh.dm, 0, &cstart, &cend));
  for (PetscInt e = 0; e < cend - cstart; e++) {
    PetscBool counts = (PetscBool)!contact;
    PetscReal measure;

    for (PetscInt a = 0; a < nodes && !counts; a++) counts = body->layer.contains[body->mesh.cell_connectivity[e * nodes + a]];
    if (!counts) continue;
    PetscCall(DMPlexComputeCellGeometryFVM(body->mesh.dm, cstart + e, &measure, NULL, NULL));
    sums[0] += measure;
    sums[1]++;
    if (simplex) sums[2]++;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  if (contact && !(sums[1] > 0)) {
    PetscCall(MeasureEdge(body, PETSC_FALSE, &body->mesh.edge));
    *edge = body->mesh.edge;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (sums[2] > 0 && dim > 1) sums[0] *= dim == 3 ? 6 : 2;
  *edge = PetscPowReal(sums[0] / sums[1], 1.0 / dim);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A length, stiffness or impedance by which contact scales what it does to a body; collective where sizes of elements are in it */
PetscErrorCode BodyGetScale(Body body, BodyScale scale, PetscReal *value)
{
  const PetscReal cross_section = body->model.element->cross_section;
  PetscReal       density, modulus;
  PetscInt        dim;
  Material        material;

  PetscFunctionBegin;
  if (scale == BODY_CROSS_SECTION) {
    *value = cross_section;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (scale == BODY_CONTACT_ELEMENT_SIZE) {
    PetscCall(MeasureEdge(body, PETSC_TRUE, &body->layer.edge));
    *value = body->layer.edge;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (scale != BODY_IMPEDANCE) PetscCall(MeasureEdge(body, PETSC_FALSE, &body->mesh.edge));
  if (scale == BODY_ELEMENT_SIZE) {
    *value = body->mesh.edge;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyGetDimension(body, &dim));
  PetscCall(BodyGetSurfaceMaterial(body, &material));
  PetscCall(MaterialGetDensity(material, &density));
  if (dim == 1) PetscCall(MaterialGetUniaxialModulus(material, &modulus));
  else PetscCall(MaterialGetWaveModulus(material, &modulus));
  *value = scale == BODY_IMPEDANCE ? PetscSqrtReal(modulus * density) * cross_section
                                   : modulus / body->mesh.edge * (dim == 1 ? cross_section : 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyIsExplicit - whether the body's substeps are bounded by a stable step, as those of central differences are

  Not Collective

  Input Parameter:
. body - the `Body`, after `BodySetFromOptions()`

  Output Parameter:
. is_explicit - `PETSC_TRUE` if so

  Level: intermediate

.seealso: `Body`, `BodyGetStableStep()`, `TSCENTRALDIFFERENCE`
@*/
PetscErrorCode BodyIsExplicit(Body body, PetscBool *is_explicit)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(is_explicit, 2);
  *is_explicit = body->integrator ? body->integrator->needs_stable_step : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
