/* What a program sets of a body beside its options: mesh, material, elements, mass. */
#include <body/layout/bodyimpl.h>
#include "bodysetup.h"

/* What is set here has to be known before the mesh is numbered and the elements are made */
#define CheckNotNumbered(body)                                                                                                             \
  PetscCheck(                                                                                                                              \
      !(body)->mesh.positions, PetscObjectComm((PetscObject)(body)), PETSC_ERR_ARG_WRONGSTATE,                                             \
      "Body '%s': its elements have been made; call %s() after BodyCreate(), before BodySetFromOptions(), BodySetUp() and functions "      \
      "that look at the mesh",                                                                                                             \
      (body)->hdr.name, PETSC_FUNCTION_NAME)

/*@
  BodySetDM - sets the mesh of a body

  Collective

  Input Parameters:
+ body - the `Body`, before `BodySetFromOptions()`
- dm   - a `DMPLEX` with vertices, edges and faces, distributed over the ranks of the body; of one to three dimensions, which are those of
         space too, and with cells of one shape

  Level: beginner

  Notes:
  The mesh is cloned (`DMClone()`): sections and callbacks of the body do not touch `dm`, and one mesh may serve several bodies.

  Surfaces go by the names of labels, by numbers of "Face Sets", or by xmin, xmax, ymin, ..., the sides of the bounding box; see
  `MeshGetSurface()`.

.seealso: `Body`, `BodyGetDM()`, `BodySetMaterial()`, `BodySetFromOptions()`, `MeshCreate()`
@*/
PetscErrorCode BodySetDM(Body body, DM dm)
{
  MPI_Comm    comm;
  PetscBool   plex;
  PetscInt    dim, coordinate_dim, depth;
  PetscMPIInt same;
  DM          clone;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidHeaderSpecific(dm, DM_CLASSID, 2);
  comm = PetscObjectComm((PetscObject)body);
  CheckNotNumbered(body);
  PetscCallMPI(MPI_Comm_compare(comm, PetscObjectComm((PetscObject)dm), &same));
  PetscCheck(same == MPI_IDENT || same == MPI_CONGRUENT, comm, PETSC_ERR_ARG_NOTSAMECOMM,
             "Body '%s': the mesh is on other ranks than the body", body->hdr.name);
  PetscCall(PetscObjectTypeCompare((PetscObject)dm, DMPLEX, &plex));
  PetscCheck(plex, comm, PETSC_ERR_ARG_WRONG, "Body '%s': the mesh must be a DMPLEX", body->hdr.name);
  PetscCall(DMGetDimension(dm, &dim));
  PetscCall(DMGetCoordinateDim(dm, &coordinate_dim));
  PetscCheck(dim >= 1 && dim <= 3 && dim == coordinate_dim, comm, PETSC_ERR_ARG_OUTOFRANGE,
             "Body '%s': the mesh has %" PetscInt_FMT " dimensions in a space of %" PetscInt_FMT
             "; a body fills its space, which has one to three",
             body->hdr.name, dim, coordinate_dim);
  PetscCall(DMPlexGetDepth(dm, &depth));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &depth, 1, MPIU_INT, MPI_MAX, comm)); /* ranks without cells do not know */
  PetscCheck(depth == dim, comm, PETSC_ERR_ARG_WRONG, "Body '%s': the mesh has no faces or edges; call DMPlexInterpolate() before",
             body->hdr.name);
  PetscCall(DMClone(dm, &clone));
  PetscCall(DMCopyDisc(dm, clone));
  PetscCall(PetscObjectSetName((PetscObject)clone, body->hdr.name)); /* of what messages about its surfaces speak */
  PetscCall(DMDestroy(&body->mesh.dm));
  body->mesh.dm   = clone;
  body->mesh.edge = 0;
  body->mesh.dim  = dim;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetMaterial - sets the material of a body

  Collective

  Input Parameters:
+ body     - the `Body`, before `BodySetFromOptions()`
- material - its `Material`, with type and constants

  Level: beginner

  Note:
  Several bodies may have the same material, as long as all of them are in plane stress, or none is.

.seealso: `Body`, `BodyGetMaterial()`, `BodySetDM()`, `MaterialCreate()`, `MaterialSetType()`
@*/
PetscErrorCode BodySetMaterial(Body body, Material material)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 2);
  CheckNotNumbered(body);
  PetscCall(PetscObjectReference((PetscObject)material));
  PetscCall(MaterialDestroy(&body->model.material));
  body->model.material = material;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetCrossSection - sets the cross-sectional area of a body of bars

  Logically Collective

  Input Parameters:
+ body - the `Body`, before `BodySetFromOptions()`
- area - [m^2], 1 by default

  Options Database Key:
. -<body>_cross_section A - the area

  Level: beginner

.seealso: `Body`, `BodySetThickness()`
@*/
PetscErrorCode BodySetCrossSection(Body body, PetscReal area)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  CheckNotNumbered(body);
  PetscCall(ElementSetCrossSection(body->model.element, area));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetThickness - sets the thickness of a plane body

  Logically Collective

  Input Parameters:
+ body      - the `Body`, before `BodySetFromOptions()`
- thickness - [m], 1 by default

  Options Database Key:
. -<body>_thickness h - the thickness

  Level: beginner

.seealso: `Body`, `BodySetPlaneStress()`
@*/
PetscErrorCode BodySetThickness(Body body, PetscReal thickness)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  CheckNotNumbered(body);
  PetscCall(ElementSetThickness(body->model.element, thickness));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetAxisymmetric - whether a body is made of rings about the axis x = 0

  Not Collective

  Input Parameter:
. body - the `Body`, after `BodySetFromOptions()`

  Output Parameter:
. axisymmetric - `PETSC_TRUE` if so

  Level: intermediate

.seealso: `Body`, `BodySetFromOptions()`
@*/
PetscErrorCode BodyGetAxisymmetric(Body body, PetscBool *axisymmetric)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(axisymmetric, 2);
  PetscCall(ElementGetAxisymmetric(body->model.element, axisymmetric));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetPlaneStress - whether a plane body is free of stress across its plane, or of strain

  Logically Collective

  Input Parameters:
+ body         - the `Body`, before `BodySetFromOptions()`
- plane_stress - `PETSC_TRUE` for plane stress, `PETSC_FALSE` (default) for plane strain

  Options Database Key:
. -<body>_plane_stress (true|false) - plane stress

  Level: beginner

.seealso: `Body`, `BodySetThickness()`
@*/
PetscErrorCode BodySetPlaneStress(Body body, PetscBool plane_stress)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  CheckNotNumbered(body);
  PetscCall(ElementSetPlaneStress(body->model.element, plane_stress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetMassType - sets how the mass of an element is put on its nodes

  Logically Collective

  Input Parameters:
+ body - the `Body`, not yet set up
- type - `BODY_MASS_AVERAGED` by default, `BODY_MASS_LUMPED` for explicit bodies in two and three dimensions

  Options Database Key:
. -<body>_mass_type (lumped|consistent|averaged) - the mass matrix

  Level: intermediate

.seealso: `Body`, `BodyMassType`, `BodyGetMassType()`, `BodySetMassRedistribute()`
@*/
PetscErrorCode BodySetMassType(Body body, BodyMassType type)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidLogicalCollectiveEnum(body, type, 2);
  BodyCheckNotSetUp(body);
  PetscCheck((int)type >= BODY_MASS_LUMPED && (int)type <= BODY_MASS_AVERAGED, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_OUTOFRANGE,
             "Body '%s': there is no mass type %d", body->hdr.name, (int)type);
  body->mass.type = type;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetMassType - how the mass of an element is put on its nodes

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. type - the `BodyMassType`

  Level: intermediate

.seealso: `Body`, `BodySetMassType()`
@*/
PetscErrorCode BodyGetMassType(Body body, BodyMassType *type)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(type, 2);
  PetscCall(BodySetUpDiscretization(body));
  *type = body->mass.type;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetMassRedistribute - whether the mass of contact nodes is moved to their inner neighbours

  Logically Collective

  Input Parameters:
+ body         - the `Body`, not yet set up
- redistribute - `PETSC_TRUE`: contact nodes are massless; a static body has no mass to move. Until this function is called the body
                 chooses, and nodes that are tied to a body with the same integrator and step keep their mass

  Options Database Key:
. -<body>_mass_redistribute (true|false) - massless contact nodes

  Level: intermediate

  Note:
  Where the body chooses, mass moves to inner neighbours in fine bodies. In coarser ones the velocity of a massless node is the affine
  extrapolation of those of the nearest inner nodes, v = E v_inner, and the mass of the body is E^T M E, with the total, centre and moments
  of inertia of the full mass M. Thin bodies, in which inner nodes do not span the space around contact nodes, keep their mass, and so do
  all bodies that contact pairs connect with them. `BodyView()` tells.

  Reference:
. * - H. B. Khenous, P. Laborde, Y. Renard, Mass redistribution method for finite element contact problems in elastodynamics, 2008

.seealso: `Body`, `BodyIsRedistributed()`, `BodySetMassType()`
@*/
PetscErrorCode BodySetMassRedistribute(Body body, PetscBool redistribute)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidLogicalCollectiveBool(body, redistribute, 2);
  BodyCheckNotSetUp(body);
  body->mass.redistribute = redistribute;
  body->mass.automatic    = PETSC_FALSE;
  body->mass.chosen       = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether contact nodes that face nothing at the start keep their mass while that of others moves */
PetscErrorCode BodyGetMassRedistributeNear(Body body, PetscBool *near)
{
  PetscFunctionBegin;
  *near = (PetscBool)(body->mass.redistribute && body->mass.near);
  PetscFunctionReturn(PETSC_SUCCESS);
}
