/* What a program sets of a body beside its options: loads and the state at the start. */
#include <body/loads/loadsimpl.h>
#include "bodysetup.h"

/* Room for loads, on a mesh whose surfaces are known; loads are part of what is set up */
static PetscErrorCode Prepare(Body body)
{
  PetscFunctionBegin;
  PetscCheck(!body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Body '%s': loads come before BodySetUp()",
             body->hdr.name);
  PetscCall(BodySetUpDiscretization(body));
  if (!body->loads) PetscCall(PetscNew(&body->loads));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddDisplacement - prescribes the displacement of a surface

  Collective

  Input Parameters:
+ body       - the `Body`, with mesh and material, not yet set up
. surface    - name of a surface or node set, see `MeshGetNodeSet()`
- components - for each dimension an expression in x, y, z, t [m], or the word `free`; with commas between them, as in "0,free"

  Options Database Keys:
+ -<body>_boundary_displacement a,b                - surfaces
- -<body>_boundary_displacement_<surface> ux,uy,uz - the components on each

  Level: beginner

  Note:
  Where several surfaces prescribe the same component of a node, the one that comes last holds.

.seealso: `Body`, `BodyAddTraction()`, `BodyGetHeldDofs()`, `BodyLoadsSetFromOptions()`, `ExpressionCreate()`
@*/
PetscErrorCode BodyAddDisplacement(Body body, const char surface[], const char components[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(surface, 2);
  PetscAssertPointer(components, 3);
  PetscCall(Prepare(body));
  PetscCall(BodyLoadsAddDisplacement(body, surface, components));
  PetscCall(BodyLoadsSetUpHeld(body));
  PetscCall(BodyNoteHeld(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddTraction - adds a traction on a surface

  Collective

  Input Parameters:
+ body       - the `Body`, with mesh and material, not yet set up
. surface    - name of a surface, see `MeshGetSurface()`
- components - for each dimension an expression in x, y, z, t and the outward normal nx, ny, nz, per area of the reference configuration
               [Pa]; with commas between them: "-1e5*nx,-1e5*ny" is a pressure of 1e5 Pa

  Options Database Keys:
+ -<body>_boundary_traction a,b                - surfaces
- -<body>_boundary_traction_<surface> tx,ty,tz - the components on each

  Level: beginner

.seealso: `Body`, `BodyAddDisplacement()`, `BodySetGravity()`, `BodyAddBodyForce()`, `BodyLoadsSetFromOptions()`, `ExpressionCreate()`
@*/
PetscErrorCode BodyAddTraction(Body body, const char surface[], const char components[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(surface, 2);
  PetscAssertPointer(components, 3);
  PetscCall(Prepare(body));
  PetscCall(BodyLoadsAddTraction(body, surface, components));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddBodyForce - adds a force in the volume

  Collective

  Input Parameters:
+ body       - the `Body`, with mesh and material, not yet set up
- components - for each dimension an expression in x, y, z, t, per volume of the reference configuration [N/m^3]; with commas between them

  Options Database Key:
. -<body>_body_force fx,fy,fz - the components

  Level: beginner

.seealso: `Body`, `BodySetGravity()`, `BodyAddTraction()`, `BodyLoadsSetFromOptions()`, `ExpressionCreate()`
@*/
PetscErrorCode BodyAddBodyForce(Body body, const char components[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(components, 2);
  PetscCall(Prepare(body));
  PetscCall(BodyLoadsAddBodyForce(body, components));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetGravity - sets the acceleration of gravity

  Collective

  Input Parameters:
+ body    - the `Body`, with mesh and material, not yet set up
- gravity - as many numbers as the body has dimensions [m/s^2]

  Options Database Key:
. -<body>_gravity gx,gy,gz - the acceleration

  Level: beginner

.seealso: `Body`, `BodyGetGravity()`, `BodyAddBodyForce()`, `BodyLoadsSetFromOptions()`
@*/
PetscErrorCode BodySetGravity(Body body, const PetscReal gravity[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(gravity, 2);
  PetscCall(Prepare(body));
  PetscCall(BodyLoadsSetGravity(body, gravity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetGravity - the acceleration of gravity

  Not Collective

  Input Parameter:
. body - the `Body`, with its mesh

  Output Parameter:
. gravity - as many numbers as the body has dimensions [m/s^2]; zeros where none is set

  Level: beginner

.seealso: `Body`, `BodySetGravity()`
@*/
PetscErrorCode BodyGetGravity(Body body, PetscReal gravity[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(gravity, 2);
  for (PetscInt d = 0; d < body->mesh.dim; d++) gravity[d] = body->loads && body->loads->has_gravity ? body->loads->gravity[d] : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetInitial(Body body, PetscBool velocity, const PetscReal value[])
{
  PetscFunctionBegin;
  PetscCheck(!body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Body '%s': after BodySetUp(), call BodySetInitialState()", body->hdr.name);
  PetscCall(BodySetUpDiscretization(body));
  PetscCall(BodyLoadsSetInitial(body, velocity, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetInitialDisplacement - sets the displacement that all nodes have at the start

  Collective

  Input Parameters:
+ body         - the `Body`, with mesh and material, not yet set up
- displacement - as many numbers as the body has dimensions [m]

  Options Database Key:
. -<body>_initial_displacement ux,uy,uz - expressions in x, y, z [m], default 0

  Level: beginner

.seealso: `Body`, `BodySetInitialVelocity()`, `BodySetInitialState()`
@*/
PetscErrorCode BodySetInitialDisplacement(Body body, const PetscReal displacement[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(displacement, 2);
  PetscCall(SetInitial(body, PETSC_FALSE, displacement));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetInitialVelocity - sets the velocity that all nodes have at the start

  Collective

  Input Parameters:
+ body     - the `Body`, with mesh and material, not yet set up
- velocity - as many numbers as the body has dimensions [m/s]

  Options Database Key:
. -<body>_initial_velocity vx,vy,vz - expressions in x, y, z [m/s], default 0

  Level: beginner

  Note:
  For a velocity that is not the same everywhere, call `BodySetInitialState()` after `BodySetUp()`.

.seealso: `Body`, `BodySetInitialDisplacement()`, `BodySetInitialState()`
@*/
PetscErrorCode BodySetInitialVelocity(Body body, const PetscReal velocity[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(velocity, 2);
  PetscCall(SetInitial(body, PETSC_TRUE, velocity));
  PetscFunctionReturn(PETSC_SUCCESS);
}
