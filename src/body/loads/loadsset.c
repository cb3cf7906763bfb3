/* Loads of a body, from the program: each added to those that there are. */
#include "loadsimpl.h"
#include <body/interface/bodysetup.h>

/* How many prescriptions and forces more there is room for, when there is no room left */
#define GROWTH 4

/* An error while the formulas are read leaves a prescription without effect, which is freed with the body */
PetscErrorCode BodyLoadsAddDisplacement(Body body, const char surface[], const char text[])
{
  struct _BodyLoads      *loads = body->loads;
  PrescribedDisplacement *prescribed;
  char                    name[LOADS_NAME_LENGTH];

  PetscFunctionBegin;
  if (loads->n_prescribed % GROWTH == 0)
    PetscCall(PetscRealloc((size_t)(loads->n_prescribed + GROWTH) * sizeof(*loads->prescribed), &loads->prescribed));
  prescribed = &loads->prescribed[loads->n_prescribed++];
  PetscCall(PetscMemzero(prescribed, sizeof(*prescribed)));
  PetscCall(PetscStrallocpy(surface, &prescribed->surface));
  PetscCall(PetscSNPrintf(name, sizeof(name), "boundary_displacement_%s", surface));
  PetscCall(BodyLoadsGetComponents(body, name, text, PETSC_TRUE, prescribed->component));
  PetscCall(BodyLoadsRefuseNormal(body, name, prescribed->component));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddLoad(Body body, Load **load)
{
  struct _BodyLoads *loads = body->loads;

  PetscFunctionBegin;
  if (loads->n_loads % GROWTH == 0) PetscCall(PetscRealloc((size_t)(loads->n_loads + GROWTH) * sizeof(*loads->loads), &loads->loads));
  *load = &loads->loads[loads->n_loads++];
  PetscCall(PetscMemzero(*load, sizeof(**load)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLoadsAddTraction(Body body, const char surface[], const char text[])
{
  char  name[LOADS_NAME_LENGTH];
  Load *load = NULL;

  PetscFunctionBegin;
  PetscCall(AddLoad(body, &load));
  load->on_faces = PETSC_TRUE;
  PetscCall(PetscSNPrintf(name, sizeof(name), "boundary_traction_%s", surface));
  PetscCall(BodyLoadsGetComponents(body, name, text, PETSC_FALSE, load->component));
  PetscCall(BodyFacesCreate(body, surface, &load->faces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLoadsAddBodyForce(Body body, const char text[])
{
  Load *load = NULL;

  PetscFunctionBegin;
  PetscCheck(body->element->ops->points, PetscObjectComm((PetscObject)body), PETSC_ERR_SUP,
             "-%sbody_force: elements of shape '%s' do not support it", ((PetscObject)body)->prefix, DMPolytopeTypes[body->cell_shape]);
  PetscCall(AddLoad(body, &load));
  PetscCall(BodyLoadsGetComponents(body, "body_force", text, PETSC_FALSE, load->component));
  PetscCall(BodyLoadsRefuseNormal(body, "body_force", load->component));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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

.seealso: `Body`, `BodyAddBodyForce()`, `BodyLoadsSetFromOptions()`
@*/
PetscErrorCode BodySetGravity(Body body, const PetscReal gravity[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(gravity, 2);
  PetscCall(Prepare(body));
  for (PetscInt d = 0; d < body->dim; d++) body->loads->gravity[d] = gravity[d];
  body->loads->has_gravity = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the loads hold, where the rest of the body looks for it */
PetscErrorCode BodyNoteHeld(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyLoadsGetHeld(body, &body->n_held, &body->held_dofs));
  body->any_held = (PetscBool)(body->n_held > 0);
  PetscCall(BodyAnyRank(body, &body->any_held));
  PetscFunctionReturn(PETSC_SUCCESS);
}
