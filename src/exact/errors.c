/* How far a run is from the exact solution. */
#include "exactimpl.h"
#include <math.h>

/* Members of ExactSolution in their order */
enum { CONTACT_POSITION, CONTACT_VELOCITY, CONTACT_FORCE_VALUE, KINETIC, POTENTIAL, MEAN_VELOCITY };

_Static_assert(sizeof(ExactSolution) == EXACT_QUANTITIES * sizeof(PetscReal), "ExactSolution is read as an array here");

static PetscReal Along(const PetscReal normal[], const PetscReal x[])
{
  return normal[0] * x[0] + normal[1] * x[1] + normal[2] * x[2];
}

static void AddToDistance(ExactDistance *distance, PetscReal exact, PetscReal computed)
{
  const PetscReal error = computed - exact;

  distance->square += PetscSqr(exact);
  distance->error_square += PetscSqr(error);
  distance->largest = PetscMax(distance->largest, PetscAbsReal(exact));
  distance->worst   = PetscMax(distance->worst, PetscAbsReal(error));
}

/* Compares the state at the end of a controller step with the solution */
PetscErrorCode ExactMonitor(Controller controller, const ControllerFrame *frame, void *context)
{
  Exact           exact  = (Exact)context;
  const PetscReal origin = exact->impact_position + exact->frame_velocity * (frame->time - exact->start);

  PetscFunctionBegin;
  (void)controller;
  if (frame->step == 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt side = 0; side < 2; side++) {
    const PetscInt      b    = exact->body[side];
    const BodyMeasures *body = &frame->bodies[b];
    ExactSolution       solution, computed;

    PetscCall(ExactEvaluate(exact, side, frame->time, &solution));
    solution.contact_position -= origin;
    computed.contact_position = Along(exact->normal, &frame->contact_positions[3 * b]) - origin;
    computed.contact_velocity = Along(exact->normal, &frame->contact_velocities[3 * b]);
    computed.contact_force    = frame->pairs[0].force;
    computed.kinetic          = body->kinetic;
    computed.potential        = body->potential;
    computed.mean_velocity    = Along(exact->normal, body->mean_velocity);
    for (PetscInt i = 0; i < EXACT_QUANTITIES; i++)
      AddToDistance(&exact->distance[side][i], ((const PetscReal *)&solution)[i], ((const PetscReal *)&computed)[i]);
  }
  exact->peak_potential = PetscMax(exact->peak_potential, frame->bodies[exact->body[0]].potential);
  if (frame->pairs[0].active > 0) exact->last_contact = frame->time;
  exact->last_time = frame->time;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal RelativeNorm(const ExactDistance *distance)
{
  return distance->square > 0 ? PetscSqrtReal(distance->error_square / distance->square) : NAN;
}

static PetscReal RelativeMaximum(const ExactDistance *distance)
{
  return distance->largest > 0 ? distance->worst / distance->largest : NAN;
}

/* Distance of the run from the solution. Errors of the potential energy's peak, or of the release, are not-a-number before these */
PetscErrorCode ExactGetErrors(Exact exact, ExactErrors *errors)
{
  const ExactDistance *distance = exact->distance[0];

  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(errors, 2);
  errors->contact_position = RelativeNorm(&distance[CONTACT_POSITION]);
  errors->contact_velocity = RelativeNorm(&distance[CONTACT_VELOCITY]);
  errors->contact_force    = RelativeNorm(&distance[CONTACT_FORCE_VALUE]);
  errors->kinetic          = RelativeNorm(&distance[KINETIC]);
  errors->potential        = RelativeNorm(&distance[POTENTIAL]);
  errors->mean_velocity    = RelativeNorm(&distance[MEAN_VELOCITY]);
  errors->peak_potential   = exact->last_time >= exact->turn ? (exact->peak_potential - exact->peak) / exact->peak : NAN;
  errors->release_time = exact->last_contact < exact->last_time ? (exact->last_contact - exact->release) / (exact->release - exact->impact)
                                                                : NAN;
  for (PetscInt side = 0; side < 2; side++) {
    ExactBodyErrors *body = &errors->bodies[side];

    distance            = exact->distance[side];
    body->kinetic       = RelativeNorm(&distance[KINETIC]);
    body->potential     = RelativeNorm(&distance[POTENTIAL]);
    body->mean_velocity = RelativeNorm(&distance[MEAN_VELOCITY]);
    body->kinetic_max   = RelativeMaximum(&distance[KINETIC]);
    body->potential_max = RelativeMaximum(&distance[POTENTIAL]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
