/* Impact of two equal elastic bars: Hoy, Tezaur, Mota, eqs. (4.1) to (4.7), after Carpenter, Taylor, Katona (1991). */
#include "exactimpl.h"
#include <sys/units.h>

/* Figures of the bars that differ by less, relative, are equal: options have some digits, and masses are sums over nodes */
#define EQUAL 1e-9
/* Times are the same if they differ by less than this part of the duration of contact or of the start: steps add up round-off */
#define ROUND_OFF 1e-12

static PetscErrorCode CheckEqual(MPI_Comm comm, Exact exact, const char what[], UnitDimension dimension, PetscReal one, PetscReal other)
{
  PetscFunctionBegin;
  PetscCheck(PetscAbsReal(one - other) <= EQUAL * PetscMax(PetscAbsReal(one), PetscAbsReal(other)), comm, PETSC_ERR_USER_INPUT,
             "-exact impact is known for two equal bars only, but the %s of '%s' is %.12g%s and that of '%s' %.12g%s; make them equal, "
             "or leave -exact out",
             what, exact->bars[0].name, (double)one, UnitsOf((PetscObject)exact, dimension), exact->bars[1].name, (double)other,
             UnitsOf((PetscObject)exact, dimension));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The speed of each bar as seen from the centre of mass: half the speed of approach [m/s] */
static PetscReal Speed(Exact exact)
{
  return 0.5 * (exact->bars[0].velocity - exact->bars[1].velocity);
}

/* As seen from the centre of mass, the bar on the other side is the mirror image of the first */
static PetscErrorCode ExactEvaluate_Impact(Exact exact, PetscInt side, PetscReal time, ExactSolution *solution)
{
  const PetscReal v = Speed(exact), frame = exact->frame_velocity, mass = exact->bars[0].mass, energy = exact->peak, sign = side ? -1 : 1;
  const PetscReal tolerance = ROUND_OFF * PetscMax(PetscAbsReal(exact->start), exact->release - exact->start);
  PetscReal       position, velocity, mean, potential;

  PetscFunctionBegin;
  if (time <= exact->impact + tolerance) {
    position  = v * (time - exact->impact);
    velocity  = v;
    mean      = v;
    potential = 0;
  } else if (time <= exact->release + tolerance) {
    /* of the bar that the wave has passed: 1 when it is at the free end, 2 when it is back */
    const PetscReal part = (time - exact->impact) / (exact->turn - exact->impact);

    position  = 0;
    velocity  = 0;
    mean      = v * (1 - part);
    potential = energy * PetscMax(0, part <= 1 ? part : 2 - part);
  } else {
    position  = -v * (time - exact->release);
    velocity  = -v;
    mean      = -v;
    potential = 0;
  }
  solution->contact_position = exact->impact_position + frame * (time - exact->start) + sign * position;
  solution->contact_velocity = frame + sign * velocity;
  solution->contact_force    = velocity == 0 ? exact->force : 0;
  solution->kinetic          = mass * frame * (0.5 * frame + sign * mean) + energy - potential;
  solution->potential        = potential;
  solution->mean_velocity    = frame + sign * mean;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The solution for two equal bars. Ends with an error if they are not equal. */
PetscErrorCode ExactCreate_Impact(Controller controller, Exact exact)
{
  MPI_Comm        comm = PetscObjectComm((PetscObject)controller);
  const ExactBar *bars = exact->bars;
  PetscReal       area;

  PetscFunctionBegin;
  PetscCall(CheckEqual(comm, exact, "density", UNIT_DENSITY, bars[0].density, bars[1].density));
  PetscCall(CheckEqual(comm, exact, "uniaxial modulus", UNIT_STRESS, bars[0].modulus, bars[1].modulus));
  PetscCall(CheckEqual(comm, exact, "length", UNIT_LENGTH, bars[0].length, bars[1].length));
  PetscCall(CheckEqual(comm, exact, "mass", UNIT_MASS, bars[0].mass, bars[1].mass));
  area                 = bars[0].mass / (bars[0].density * bars[0].length);
  exact->turn          = exact->impact + bars[0].length * PetscSqrtReal(bars[0].density / bars[0].modulus);
  exact->release       = exact->turn + (exact->turn - exact->impact);
  exact->peak          = 0.5 * bars[0].mass * PetscSqr(Speed(exact));
  exact->force         = Speed(exact) * PetscSqrtReal(bars[0].modulus * bars[0].density) * area;
  exact->impulse       = exact->force * (exact->release - exact->impact);
  exact->ops->evaluate = ExactEvaluate_Impact;
  PetscFunctionReturn(PETSC_SUCCESS);
}
