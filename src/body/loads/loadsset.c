/* Loads of a body, one by one: each is added to those that there are. */
#include "loadsimpl.h"

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
  PetscCall(BodyLoadsRefuse(body, name, LOADS_NORMAL, body->mesh.dim, prescribed->component));
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
  PetscCheck(body->model.element->ops->points, PetscObjectComm((PetscObject)body), PETSC_ERR_SUP,
             "-%sbody_force: elements of shape '%s' do not support it", ((PetscObject)body)->prefix,
             DMPolytopeTypes[body->mesh.cell_shape]);
  PetscCall(AddLoad(body, &load));
  PetscCall(BodyLoadsGetComponents(body, "body_force", text, PETSC_FALSE, load->component));
  PetscCall(BodyLoadsRefuse(body, "body_force", LOADS_NORMAL, body->mesh.dim, load->component));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error of rings that would not remain rings */
PetscErrorCode BodyLoadsCheckGravity(Body body)
{
  PetscFunctionBegin;
  PetscCheck(
      !body->model.element->axisymmetric || body->loads->gravity[0] == 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
      "-%sgravity %g,...: gravity of an axisymmetric body is along its axis, y; for a force away from the axis there is -%sbody_force",
      ((PetscObject)body)->prefix, (double)body->loads->gravity[0], ((PetscObject)body)->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLoadsSetGravity(Body body, const PetscReal gravity[])
{
  PetscFunctionBegin;
  for (PetscInt d = 0; d < body->mesh.dim; d++) body->loads->gravity[d] = gravity[d];
  body->loads->has_gravity = PETSC_TRUE;
  PetscCall(BodyLoadsCheckGravity(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
