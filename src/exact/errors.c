/* How far a run is from the exact solution. */
#include "exactimpl.h"
#include <math.h>

_Static_assert(sizeof(ExactSolution) == EXACT_QUANTITIES * sizeof(PetscReal), "ExactSolution is read as an array here");

static PetscReal Along(const PetscReal normal[], const PetscReal x[])
{
  return normal[0] * x[0] + normal[1] * x[1] + normal[2] * x[2];
}

/*@
  ExactMonitor - compares the state at the end of a controller step with the solution

  Logically Collective

  Input Parameters:
+ controller - the `Controller`
. frame      - the state of everything
- context    - the `Exact`

  Level: intermediate

.seealso: `Exact`, `ExactGetErrors()`, `ControllerMonitorSet()`
@*/
PetscErrorCode ExactMonitor(Controller controller, const ControllerFrame *frame, void *context)
{
  Exact               exact  = (Exact)context;
  const BodyMeasures *body   = &frame->bodies[exact->body[0]];
  const PetscReal     origin = exact->impact_position + exact->frame_velocity * (frame->time - exact->start);
  ExactSolution       solution, computed;

  PetscFunctionBegin;
  (void)controller;
  if (frame->step == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ExactEvaluate(exact, 0, frame->time, &solution));
  solution.contact_position -= origin;
  computed.contact_position = Along(exact->normal, &frame->contact_positions[3 * exact->body[0]]) - origin;
  computed.contact_velocity = Along(exact->normal, &frame->contact_velocities[3 * exact->body[0]]);
  computed.contact_force    = frame->pairs[0].force;
  computed.kinetic          = body->kinetic;
  computed.potential        = body->potential;
  computed.mean_velocity    = Along(exact->normal, body->mean_velocity);
  for (PetscInt i = 0; i < EXACT_QUANTITIES; i++) {
    exact->squares[i] += PetscSqr(((const PetscReal *)&solution)[i]);
    exact->errors[i] += PetscSqr(((const PetscReal *)&computed)[i] - ((const PetscReal *)&solution)[i]);
  }
  exact->peak_potential = PetscMax(exact->peak_potential, body->potential);
  if (frame->pairs[0].active > 0) exact->last_contact = frame->time;
  exact->last_time = frame->time;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal RelativeNorm(Exact exact, PetscInt quantity)
{
  return exact->squares[quantity] > 0 ? PetscSqrtReal(exact->errors[quantity] / exact->squares[quantity]) : NAN;
}

/*@
  ExactGetErrors - the distance between the run and the solution

  Not Collective

  Input Parameter:
. exact - the `Exact`, told of every step by `ExactMonitor()`

  Output Parameter:
. errors - see `ExactErrors`

  Level: intermediate

  Note:
  The peak of the potential energy is not told of a run that ends before it, the release not of one that ends in contact.

.seealso: `Exact`, `ExactMonitor()`
@*/
PetscErrorCode ExactGetErrors(Exact exact, ExactErrors *errors)
{
  PetscFunctionBegin;
  errors->contact_position = RelativeNorm(exact, 0);
  errors->contact_velocity = RelativeNorm(exact, 1);
  errors->contact_force    = RelativeNorm(exact, 2);
  errors->kinetic          = RelativeNorm(exact, 3);
  errors->potential        = RelativeNorm(exact, 4);
  errors->mean_velocity    = RelativeNorm(exact, 5);
  errors->peak_potential   = exact->last_time >= exact->turn ? (exact->peak_potential - exact->peak) / exact->peak : NAN;
  errors->release_time     = exact->last_contact < exact->last_time ? (exact->last_contact - exact->release) / (exact->release - exact->impact) : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}
