/* Bodies that do not deform: what a program sets of them, and asks. */
#include <body/layout/bodyimpl.h>
#include <body/loads/loadsimpl.h>
#include "bodysetup.h"

/*@
  BodySetRigid - lets a body move as a whole, without deforming

  Collective

  Input Parameters:
+ body  - the `Body`, not yet set up
- rigid - `PETSC_TRUE`: it has mass, centre and inertia of its mesh, and moves by forces and torques, or as it is led; `PETSC_FALSE`: it
          deforms, under `TSALPHA2` where it was rigid

  Options Database Key:
. -<body>_rigid (true|false) - the same

  Level: beginner

  Notes:
  The same as `BodySetTSType()` with `TSRIGID`. The centre moves by the trapezoidal rule, the rotation by a rule that keeps energy and
angular momentum (Simo, Wong 1991), for any step. The mass is consistent, so that the moments of inertia are those of the mesh. Of the
  material the density alone counts; from options it needs no modulus.

  In contact its partner has to give: a pair of two rigid bodies, or of one and an obstacle, is refused. It takes forces, and so is the
second side of its pairs, whatever their order.

.seealso: `Body`, `BodyIsRigid()`, `BodySetRigidDisplacement()`, `BodySetRigidRotation()`, `TSRIGID`
@*/
PetscErrorCode BodySetRigid(Body body, PetscBool rigid)
{
  PetscBool is;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidLogicalCollectiveBool(body, rigid, 2);
  PetscCall(BodyIsRigid(body, &is));
  if (rigid && !is) PetscCall(BodySetTSType(body, TSRIGID));
  if (!rigid && is) PetscCall(BodySetTSType(body, TSALPHA2));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyIsRigid - whether the body does not deform

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. rigid - `PETSC_TRUE` if so

  Level: intermediate

.seealso: `Body`, `BodySetRigid()`
@*/
PetscErrorCode BodyIsRigid(Body body, PetscBool *rigid)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(rigid, 2);
  *rigid = body->integrator ? (PetscBool)!body->integrator->deforms : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether formulas lead a rigid body, and whether they leave nothing to forces, so that its kinetic energy is given; either may be NULL */
PetscErrorCode BodyGetLed(Body body, PetscBool *led, PetscBool *wholly)
{
  const PetscBool axisymmetric = body->model.element->axisymmetric;

  PetscFunctionBegin;
  if (led) *led = BodyIsLed(body);
  if (!wholly) PetscFunctionReturn(PETSC_SUCCESS);
  *wholly = (PetscBool)(BodyLeads(body, 3) || body->mesh.dim == 1 || axisymmetric);
  for (PetscInt d = axisymmetric ? 1 : 0; d < body->mesh.dim; d++) *wholly = (PetscBool)(*wholly && BodyLeads(body, d));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* -<body>_rigid beside -<body>_ts_type, which is NULL where it is not given; whether that has made the body a rigid one */
PetscErrorCode BodyReadRigid(Body body, const char type[], PetscBool *rigid)
{
  PetscBool given, same = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(BodyIsRigid(body, rigid));
  PetscCall(PetscOptionsGetBool(NULL, ((PetscObject)body)->prefix, "-rigid", rigid, &given));
  if (given && type) {
    PetscCall(PetscStrcmp(type, TSRIGID, &same));
    PetscCheck(same == *rigid, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
               "-%srigid %s and -%sts_type %s exclude each other: a rigid body has an integrator of its own; leave one of them out",
               ((PetscObject)body)->prefix, PetscBools[*rigid], ((PetscObject)body)->prefix, type);
  }
  if (!given && type) *rigid = PETSC_FALSE;
  if (given) PetscCall(BodySetRigid(body, *rigid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether options, or else the program, make the body a rigid one, before its integrator is read */
PetscErrorCode BodyAsksForRigid(Body body, PetscBool *rigid)
{
  char      type[64];
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(BodyIsRigid(body, rigid));
  PetscCall(PetscOptionsGetString(NULL, ((PetscObject)body)->prefix, "-ts_type", type, sizeof(type), &set));
  if (set) PetscCall(PetscStrcmp(type, TSRIGID, rigid));
  PetscCall(PetscOptionsGetBool(NULL, ((PetscObject)body)->prefix, "-rigid", rigid, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Prepare(Body body)
{
  PetscBool rigid;

  PetscFunctionBegin;
  BodyCheckNotSetUp(body);
  PetscCall(BodyIsRigid(body, &rigid));
  PetscCheck(rigid, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Body '%s': call BodySetRigid() first", body->hdr.name);
  PetscCall(BodySetUpDiscretization(body));
  if (!body->loads) PetscCall(PetscNew(&body->loads));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetRigidDisplacement - leads the centre of mass of a rigid body

  Collective

  Input Parameters:
+ body       - the `Body`, after `BodySetRigid()`, with mesh and material, not yet set up
- components - for each dimension an expression in t [m], or the word `free`; with commas between them, as in "0,-1e-3*t"

  Options Database Key:
. -<body>_rigid_displacement ux,uy,uz - the same

  Level: intermediate

  Notes:
  From where the mesh puts it. What leads the body does work on it, and is one of its reactions, under the name `rigid`.

  A displacement of the start, and a velocity there, give way to the formulas.

.seealso: `Body`, `BodySetRigid()`, `BodySetRigidRotation()`, `BodyGetReactions()`, `ExpressionCreate()`
@*/
PetscErrorCode BodySetRigidDisplacement(Body body, const char components[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(components, 2);
  PetscCall(Prepare(body));
  PetscCall(BodyLoadsSetRigidDisplacement(body, components));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetRigidRotation - leads the rotation of a rigid body about its centre of mass

  Collective

  Input Parameters:
+ body       - the `Body`, after `BodySetRigid()`, with mesh and material, not yet set up
- components - in two dimensions the angle, in three the components of axis times angle, expressions in t [rad]; with commas between
               them; zeros for a body that does not turn

  Options Database Key:
. -<body>_rigid_rotation r[,r,r] - the same

  Level: intermediate

.seealso: `Body`, `BodySetRigid()`, `BodySetRigidDisplacement()`, `BodyGetReactions()`, `ExpressionCreate()`
@*/
PetscErrorCode BodySetRigidRotation(Body body, const char components[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(components, 2);
  PetscCall(Prepare(body));
  PetscCall(BodyLoadsSetRigidRotation(body, components));
  PetscFunctionReturn(PETSC_SUCCESS);
}
