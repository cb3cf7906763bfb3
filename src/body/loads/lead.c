/* How a rigid body is led: displacement of its centre of mass and its rotation, as functions of time. */
#include "loadsimpl.h"
#include <body/integrator/rigidmotion.h>

/* Between the times at which angular velocities are compared for their rate, in parts of the step */
#define SPACING 0.25

/* The displacement of the centre of mass: for each dimension a formula in t [m], or the word free */
PetscErrorCode BodyLoadsSetRigidDisplacement(Body body, const char text[])
{
  struct _BodyLoads *loads = body->loads;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 3; d++) PetscCall(ExpressionDestroy(&loads->lead[d]));
  PetscCall(BodyLoadsGetComponents(body, "rigid_displacement", text, PETSC_TRUE, loads->lead));
  PetscCall(BodyLoadsRefuse(body, "rigid_displacement", LOADS_PLACE, body->mesh.dim, loads->lead));
  for (PetscInt d = 0; d < body->mesh.dim; d++) loads->led = (PetscBool)(loads->led || loads->lead[d]);
  PetscCheck(!body->model.element->axisymmetric || !loads->lead[0], PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%srigid_displacement %s: an axisymmetric body moves along its axis, y, alone; write free for the first component",
             ((PetscObject)body)->prefix, text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rotation about the centre of mass: in two dimensions an angle, in three the vector of axis times angle; formulas in t [rad] */
PetscErrorCode BodyLoadsSetRigidRotation(Body body, const char text[])
{
  struct _BodyLoads *loads = body->loads;
  MPI_Comm           comm  = PetscObjectComm((PetscObject)body);
  const PetscInt     turns = body->mesh.dim == 3 ? 3 : 1;
  char               option[LOADS_NAME_LENGTH];
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, sizeof(option), "%srigid_rotation", ((PetscObject)body)->prefix));
  PetscCheck(body->mesh.dim > 1 && !body->model.element->axisymmetric, comm, PETSC_ERR_USER_INPUT, "-%s %s: body '%s' cannot turn", option,
             text, body->hdr.name);
  PetscCall(ExpressionListCount(text, &n));
  PetscCheck(n == turns, comm, PETSC_ERR_USER_INPUT,
             "-%s '%s' has %" PetscInt_FMT " component%s; body '%s' is %" PetscInt_FMT "-dimensional and has %" PetscInt_FMT " [rad]",
             option, text, n, n == 1 ? "" : "s", body->hdr.name, body->mesh.dim, turns);
  for (PetscInt d = 0; d < 3; d++) PetscCall(ExpressionDestroy(&loads->lead[3 + d]));
  PetscCall(ExpressionListCreate(comm, option, text, turns, PETSC_FALSE, loads->lead + 3));
  PetscCall(BodyLoadsRefuse(body, "rigid_rotation", LOADS_PLACE, turns, loads->lead + 3));
  if (turns == 1) { /* about the third axis */
    loads->lead[5] = loads->lead[3];
    loads->lead[3] = NULL;
  }
  loads->led = loads->turned = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a component of the displacement, or (3) the rotation, is led */
PetscBool BodyLeads(Body body, PetscInt component)
{
  if (!body->loads || !body->loads->led) return PETSC_FALSE;
  return component < 3 ? (PetscBool)(body->loads->lead[component] != NULL) : body->loads->turned;
}

PetscBool BodyIsLed(Body body)
{
  return (PetscBool)(body->loads && body->loads->led);
}

/* A displacement or a component of the rotation vector, its first and its second derivative */
static PetscErrorCode Evaluate(Body body, Expression formula, PetscReal t, PetscReal values[3])
{
  const ExpressionPoint point = {.t = t};

  PetscFunctionBegin;
  values[0] = values[1] = values[2] = 0;
  if (formula) PetscCall(ExpressionEvaluateRates(formula, &point, body->time.start, body->time.step, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode EvaluateRotation(Body body, PetscReal t, PetscReal rotation[9], PetscReal spin[3])
{
  PetscReal vector[3], rate[3];

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 3; d++) {
    PetscReal values[3];

    PetscCall(Evaluate(body, body->loads->lead[3 + d], t, values));
    vector[d] = values[0];
    rate[d]   = values[1];
  }
  if (rotation) RigidExponential(vector, rotation);
  RigidSpin(vector, rate, spin);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts what leads the body at a time into a motion. Angular acceleration: a centred difference of second order, one-sided at the start. */
PetscErrorCode BodyLead(Body body, PetscReal t, RigidMotion *motion)
{
  const PetscReal h     = SPACING * body->time.step;
  const PetscBool first = (PetscBool)(t - h < body->time.start);

  PetscFunctionBegin;
  for (PetscInt d = 0; d < body->mesh.dim; d++) {
    PetscReal values[3];

    if (!BodyLeads(body, d)) continue;
    PetscCall(Evaluate(body, body->loads->lead[d], t, values));
    motion->centre[d]       = body->mass.centre[d] + values[0];
    motion->velocity[d]     = values[1];
    motion->acceleration[d] = values[2];
  }
  if (BodyLeads(body, 3)) {
    PetscReal near[3], far[3];

    PetscCall(EvaluateRotation(body, t, motion->rotation, motion->angular_velocity));
    PetscCall(EvaluateRotation(body, first ? t + h : t - h, NULL, near));
    PetscCall(EvaluateRotation(body, first ? t + 2 * h : t + h, NULL, far));
    for (PetscInt d = 0; d < 3; d++)
      motion->angular_acceleration[d] = first ? (4 * near[d] - 3 * motion->angular_velocity[d] - far[d]) / (2 * h)
                                              : (far[d] - near[d]) / (2 * h);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
