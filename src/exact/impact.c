/* Impact of two equal elastic bars: Hoy, Tezaur, Mota, eqs. (4.1) to (4.7), after Carpenter, Taylor, Katona (1991). */
#include "exactimpl.h"
#include <math.h>

/* What the closed form needs to know of one bar, along the contact normal */
typedef struct {
  const char *name;
  PetscReal   density, modulus, mass; /* kg/m^3, Pa, kg */
  PetscReal   length;                 /* m */
  PetscReal   lower, upper;           /* its ends as it lies at the start [m] */
  PetscReal   velocity;               /* m/s */
} Bar;

/* Smallest and largest of positions . normal over all nodes */
static PetscErrorCode GetExtent(Vec positions, PetscInt dim, const PetscReal normal[], PetscReal *lower, PetscReal *upper)
{
  const PetscScalar *x;
  PetscInt           n;
  PetscReal          extremes[2] = {PETSC_MIN_REAL, PETSC_MIN_REAL};

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(positions, &n));
  PetscCall(VecGetArrayRead(positions, &x));
  for (PetscInt i = 0; i < n; i += dim) {
    PetscReal along = 0;

    for (PetscInt d = 0; d < dim; d++) along += normal[d] * PetscRealPart(x[i + d]);
    extremes[0] = PetscMax(extremes[0], -along);
    extremes[1] = PetscMax(extremes[1], along);
  }
  PetscCall(VecRestoreArrayRead(positions, &x));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, extremes, 2, MPIU_REAL, MPI_MAX, PetscObjectComm((PetscObject)positions)));
  *lower = -extremes[0];
  *upper = extremes[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GetBar(Body body, const PetscReal normal[], Bar *bar, BodyMeasures *measures)
{
  Material  material;
  DM        dm;
  PetscInt  dim;
  Vec       reference, displacement, positions;
  PetscReal lower, upper;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetName((PetscObject)body, &bar->name));
  PetscCall(BodyGetMaterial(body, &material));
  PetscCall(MaterialGetDensity(material, &bar->density));
  PetscCall(MaterialGetUniaxialModulus(material, &bar->modulus));
  PetscCall(BodyGetMass(body, &bar->mass));
  PetscCall(BodyGetDM(body, &dm));
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(BodyGetReferencePositions(body, &reference));
  PetscCall(GetExtent(reference, dim, normal, &lower, &upper));
  bar->length = upper - lower;
  PetscCall(BodyGetSolution(body, &displacement, NULL, NULL));
  PetscCall(VecDuplicate(reference, &positions));
  PetscCall(VecWAXPY(positions, 1, reference, displacement));
  PetscCall(GetExtent(positions, dim, normal, &bar->lower, &bar->upper));
  PetscCall(VecDestroy(&positions));
  PetscCall(BodyGetMeasures(body, measures));
  bar->velocity = 0;
  for (PetscInt d = 0; d < dim; d++) bar->velocity += normal[d] * measures->mean_velocity[d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckEqual(MPI_Comm comm, const Bar bars[2], const char what[], const char unit[], PetscReal one, PetscReal other)
{
  PetscFunctionBegin;
  PetscCheck(PetscAbsReal(one - other) <= 1e-9 * PetscMax(PetscAbsReal(one), PetscAbsReal(other)), comm, PETSC_ERR_USER_INPUT, "-exact impact is known for two equal bars only, but the %s of '%s' is %.12g %s and that of '%s' %.12g %s; make them equal, or leave -exact out", what, bars[0].name, (double)one, unit, bars[1].name, (double)other, unit);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two equal bars, undeformed, that fly towards each other along the normal without turning */
static PetscErrorCode CheckBars(MPI_Comm comm, const Bar bars[2], const BodyMeasures measures[2])
{
  PetscFunctionBegin;
  PetscCall(CheckEqual(comm, bars, "density", "kg/m^3", bars[0].density, bars[1].density));
  PetscCall(CheckEqual(comm, bars, "uniaxial modulus", "Pa", bars[0].modulus, bars[1].modulus));
  PetscCall(CheckEqual(comm, bars, "length", "m", bars[0].length, bars[1].length));
  PetscCall(CheckEqual(comm, bars, "mass", "kg", bars[0].mass, bars[1].mass));
  PetscCheck(bars[0].velocity > bars[1].velocity, comm, PETSC_ERR_USER_INPUT, "-exact impact needs bars that approach each other, but along the contact normal '%s' moves at %g m/s and '%s' at %g m/s; change an initial velocity, or leave -exact out", bars[0].name, (double)bars[0].velocity, bars[1].name, (double)bars[1].velocity);
  for (PetscInt i = 0; i < 2; i++) {
    const PetscReal scale   = bars[i].mass * (PetscSqr(bars[0].velocity) + PetscSqr(bars[1].velocity));
    const PetscReal kinetic = 0.5 * bars[i].mass * PetscSqr(bars[i].velocity);

    PetscCheck(PetscAbsReal(measures[i].potential) <= 1e-9 * scale && PetscAbsReal(measures[i].kinetic - kinetic) <= 1e-9 * scale, comm, PETSC_ERR_USER_INPUT, "-exact impact needs bars that start undeformed and move as a whole along the contact normal, but '%s' starts with %g J potential and %g J kinetic energy, where its mean velocity makes %g J; change its initial state, or leave -exact out", bars[i].name, (double)measures[i].potential, (double)measures[i].kinetic, (double)kinetic);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactImpactCreate - the closed-form solution for the bodies of a controller, in their initial state

  Collective

  Input Parameter:
. controller - the `Controller`, set up, before its first step

  Output Parameter:
. exact - the solution

  Options Database Key:
. -exact impact - compare the run with it

  Level: intermediate

  Note:
  Refuses, with the reason, bodies for which it is not the solution: more than two, unequal ones, ones that do not approach.

.seealso: `ExactImpact`, `ExactImpactEvaluate()`, `ExactImpactMonitor()`
@*/
PetscErrorCode ExactImpactCreate(Controller controller, ExactImpact *exact)
{
  MPI_Comm     comm = PetscObjectComm((PetscObject)controller);
  PetscInt     n_bodies, n_pairs;
  const Body  *bodies;
  Body         sides[2];
  Contact      contact;
  const char  *pair;
  Bar          bars[2];
  BodyMeasures measures[2];
  PetscReal    normal[3] = {0, 0, 0}, half_gap, area;
  ExactImpact  e;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, &n_bodies, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ContactGetNumPairs(contact, &n_pairs));
  PetscCheck(n_bodies == 2 && n_pairs == 1, comm, PETSC_ERR_USER_INPUT, "-exact impact is known for two bodies and one contact pair, but there are %" PetscInt_FMT " bodies and %" PetscInt_FMT " pairs; leave -exact out", n_bodies, n_pairs);
  PetscCall(ContactGetPair(contact, 0, &pair, &sides[0], &sides[1]));
  PetscCall(ContactGetPairNormal(contact, 0, normal));
  for (PetscInt i = 0; i < 2; i++) PetscCall(GetBar(sides[i], normal, &bars[i], &measures[i]));
  PetscCall(CheckBars(comm, bars, measures));
  PetscCall(PetscNew(&e));
  PetscCall(ControllerGetTimes(controller, &e->start, NULL, NULL));
  PetscCall(PetscArraycpy(e->normal, normal, 3));
  e->body            = sides[0] == bodies[0] ? 0 : 1;
  half_gap           = 0.5 * (bars[1].lower - bars[0].upper);
  area               = bars[0].mass / (bars[0].density * bars[0].length);
  e->mass            = bars[0].mass;
  e->speed           = 0.5 * (bars[0].velocity - bars[1].velocity);
  e->frame_velocity  = 0.5 * (bars[0].velocity + bars[1].velocity);
  e->impact_position = bars[0].upper + half_gap;
  e->force           = e->speed * PetscSqrtReal(bars[0].modulus * bars[0].density) * area;
  e->impact          = e->start + half_gap / e->speed;
  e->turn            = e->impact + bars[0].length * PetscSqrtReal(bars[0].density / bars[0].modulus);
  e->release         = e->turn + (e->turn - e->impact);
  e->last_contact    = NAN;
  e->last_time       = e->start;
  *exact             = e;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactImpactEvaluate - the closed-form solution at one time

  Not Collective

  Input Parameters:
+ exact - the `ExactImpact`
- time  - any time [s]; at a jump, or within round-off of one, the value before it is given

  Output Parameter:
. solution - see `ExactSolution`

  Level: intermediate

.seealso: `ExactImpact`, `ExactImpactGetTimes()`
@*/
PetscErrorCode ExactImpactEvaluate(ExactImpact exact, PetscReal time, ExactSolution *solution)
{
  const PetscReal v = exact->speed, frame = exact->frame_velocity, energy = 0.5 * exact->mass * v * v;
  const PetscReal tolerance = 1e-12 * PetscMax(PetscAbsReal(exact->start), exact->release - exact->start);
  PetscReal       position, velocity, mean, potential;

  PetscFunctionBegin;
  /* seen by an observer at the point of impact */
  if (time <= exact->impact + tolerance) {
    position  = v * (time - exact->impact);
    velocity  = v;
    mean      = v;
    potential = 0;
  } else if (time <= exact->release + tolerance) {
    const PetscReal part = (time - exact->impact) / (exact->turn - exact->impact); /* of the bar that the wave has met: 2 at release */

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
  solution->contact_position = exact->impact_position + frame * (time - exact->start) + position;
  solution->contact_velocity = frame + velocity;
  solution->contact_force    = velocity == 0 ? exact->force : 0;
  solution->kinetic          = exact->mass * frame * (0.5 * frame + mean) + energy - potential;
  solution->potential        = potential;
  solution->mean_velocity    = frame + mean;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactImpactGetTimes - when the bars touch

  Not Collective

  Input Parameter:
. exact - the `ExactImpact`

  Output Parameters:
+ impact  - first contact [s]
- release - last contact [s]

  Level: intermediate

.seealso: `ExactImpact`, `ExactImpactGetForce()`
@*/
PetscErrorCode ExactImpactGetTimes(ExactImpact exact, PetscReal *impact, PetscReal *release)
{
  PetscFunctionBegin;
  *impact  = exact->impact;
  *release = exact->release;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactImpactGetForce - the contact force while the bars touch

  Not Collective

  Input Parameter:
. exact - the `ExactImpact`

  Output Parameter:
. force - compression positive [N]

  Level: intermediate

.seealso: `ExactImpact`, `ExactImpactGetTimes()`
@*/
PetscErrorCode ExactImpactGetForce(ExactImpact exact, PetscReal *force)
{
  PetscFunctionBegin;
  *force = exact->force;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ExactImpactDestroy - frees the solution

  Not Collective

  Input Parameter:
. exact - the `ExactImpact`, set to `NULL`

  Level: intermediate

.seealso: `ExactImpact`, `ExactImpactCreate()`
@*/
PetscErrorCode ExactImpactDestroy(ExactImpact *exact)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(*exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
