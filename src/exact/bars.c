/* The two bars of an exact solution, from the initial state of the bodies. */
#include "exactimpl.h"
#include <sys/units.h>
#include <impakt/private/bodystart.h>
#include <impakt/private/contactsteps.h>

/* Bars move as a whole, undeformed, if their energies are those of their mean velocity but for this part: round-off of sums */
#define ENERGY_ROUND_OFF 1e-9
/* Bars approach each other if the difference of their mean velocities is more than this part of them: round-off of the same sums */
#define VELOCITY_ROUND_OFF 1e-12

/* End faces are the same if their edges differ by less than this part of their width: of round bars, meshes decide */
#define SAME_FACE 1e-2

/* Waves in a bar in space that is as many times as long as wide are those of the bar's theory to 1 %: measured with ten times */
#define SLENDER 8.0

/* Smallest and largest coordinate along the normal of all nodes [m] */
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

static PetscErrorCode GetBar(Body body, const PetscReal normal[], ExactBar *bar, BodyMeasures *measures)
{
  Material  material;
  PetscInt  dim, blocks;
  Vec       reference, displacement, positions;
  PetscReal lower, upper, poissons_ratio, drag;
  PetscBool linear, loaded, slender;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetName((PetscObject)body, &bar->name));
  PetscCall(BodyGetMaterial(body, &material));
  PetscCall(BodyGetBlocks(body, &blocks, NULL, NULL));
  PetscCheck(
      !blocks, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
      "-exact: the exact solutions are those of bars of one material, and body '%s' has blocks with materials of their own; leave the "
      "option out",
      ((PetscObject)body)->name);
  PetscCall(MaterialIsLinear(material, &linear));
  PetscCheck(linear, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-exact: the exact solutions are those of linear elastic bars, and body '%s' is nonlinear; leave the option out, or choose "
             "-%s_material_type linear_elastic",
             ((PetscObject)body)->name, ((PetscObject)body)->name);
  PetscCall(BodyGetDimension(body, &dim));
  PetscCall(MaterialGetPoissonsRatio(material, &poissons_ratio));
  PetscCall(BodyHasForces(body, &loaded));
  PetscCheck(!loaded, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-exact: the exact solutions are those of bars without forces from outside, and body '%s' has tractions, body forces or "
             "gravity; leave the option out",
             ((PetscObject)body)->name);
  PetscCall(BodyGetDamping(body, &drag, NULL)); /* that by the stiffness may be there to smooth waves */
  PetscCheck(
      drag == 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
      "-exact: the exact solutions are those of bars that nothing slows down, and body '%s' has -%s_damping_mass %g; leave one of the "
      "options out",
      ((PetscObject)body)->name, ((PetscObject)body)->name, (double)drag);
  PetscCall(MaterialGetDensity(material, &bar->density));
  PetscCall(MaterialGetUniaxialModulus(material, &bar->modulus));
  PetscCall(BodyGetMass(body, &bar->mass));
  PetscCall(BodyGetReferencePositions(body, &reference));
  PetscCall(GetExtent(reference, dim, normal, &lower, &upper));
  bar->length = upper - lower;
  slender     = (PetscBool)(dim == 3 && PetscSqr(bar->length) >= PetscSqr(SLENDER) * bar->mass / (bar->density * bar->length));
  PetscCheck(dim == 1 || poissons_ratio == 0 || slender, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-exact: waves in body '%s', of %" PetscInt_FMT " dimensions, are those of a bar only if it does not get thicker where it is "
             "pressed, or is a bar in space %g times as long as wide; leave the option out, or choose -%s_poissons_ratio 0",
             ((PetscObject)body)->name, dim, SLENDER, ((PetscObject)body)->name);
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

/* Ends with an error unless the two bars are undeformed and fly towards each other along the normal without turning */
static PetscErrorCode CheckBars(MPI_Comm comm, Exact exact, const ExactBar bars[2], const BodyMeasures measures[2])
{
  const PetscReal small = VELOCITY_ROUND_OFF * (PetscAbsReal(bars[0].velocity) + PetscAbsReal(bars[1].velocity));

  PetscFunctionBegin;
  PetscCheck(bars[0].velocity - bars[1].velocity > small, comm, PETSC_ERR_USER_INPUT,
             "-exact %s needs bars that approach each other, but along the contact normal '%s' moves at %g%s and '%s' at %g%s; change "
             "an initial velocity, or leave -exact out",
             exact->type, bars[0].name, (double)bars[0].velocity, UnitsOf((PetscObject)exact, UNIT_VELOCITY), bars[1].name,
             (double)bars[1].velocity, UnitsOf((PetscObject)exact, UNIT_VELOCITY));
  for (PetscInt i = 0; i < 2; i++) {
    const PetscReal scale   = bars[i].mass * (PetscSqr(bars[0].velocity) + PetscSqr(bars[1].velocity));
    const PetscReal kinetic = 0.5 * bars[i].mass * PetscSqr(bars[i].velocity);

    PetscCheck(PetscAbsReal(measures[i].potential) <= ENERGY_ROUND_OFF * scale &&
                   PetscAbsReal(measures[i].kinetic - kinetic) <= ENERGY_ROUND_OFF * scale,
               comm, PETSC_ERR_USER_INPUT,
               "-exact %s needs bars that start undeformed and move as a whole along the contact normal, but '%s' starts with %g%s "
               "potential and %g%s kinetic energy, where its mean velocity makes %g%s; change its initial state, or leave -exact out",
               exact->type, bars[i].name, (double)measures[i].potential, UnitsOf((PetscObject)exact, UNIT_ENERGY),
               (double)measures[i].kinetic, UnitsOf((PetscObject)exact, UNIT_ENERGY), (double)kinetic,
               UnitsOf((PetscObject)exact, UNIT_ENERGY));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error unless the bars meet with the whole of their end faces: the same extent along each direction across the normal. */
static PetscErrorCode CheckFaces(MPI_Comm comm, Exact exact, const Body sides[2])
{
  const PetscReal *normal = exact->normal;
  PetscInt         dim, least = 0;

  PetscFunctionBegin;
  PetscCall(BodyGetDimension(sides[0], &dim));
  for (PetscInt d = 1; d < dim; d++)
    if (PetscAbsReal(normal[d]) < PetscAbsReal(normal[least])) least = d;
  for (PetscInt k = 1; k < dim; k++) {
    PetscReal across[3] = {0, 0, 0}, first[3] = {0, 0, 0}, ends[2][2], size = 0;

    /* the axis that is least along the normal, without its part along it; then what is square to both */
    for (PetscInt d = 0; d < dim; d++) first[d] = (d == least) - normal[least] * normal[d];
    for (PetscInt d = 0; d < dim; d++)
      across[d] = k == 1 ? first[d] : exact->normal[(d + 1) % 3] * first[(d + 2) % 3] - exact->normal[(d + 2) % 3] * first[(d + 1) % 3];
    for (PetscInt d = 0; d < dim; d++) size += PetscSqr(across[d]);
    for (PetscInt d = 0; d < dim; d++) across[d] /= PetscSqrtReal(size);
    for (PetscInt i = 0; i < 2; i++) {
      Vec reference;

      PetscCall(BodyGetReferencePositions(sides[i], &reference));
      PetscCall(GetExtent(reference, dim, across, &ends[i][0], &ends[i][1]));
    }
    size = PetscMax(ends[0][1] - ends[0][0], ends[1][1] - ends[1][0]);
    for (PetscInt e = 0; e < 2; e++)
      PetscCheck(PetscAbsReal(ends[0][e] - ends[1][e]) <= SAME_FACE * size, comm, PETSC_ERR_USER_INPUT,
                 "-exact %s needs bars that meet with the whole of their end faces, but along (%g, %g, %g) '%s' ends at %g%s and '%s' at "
                 "%g%s; move or resize one of them, or leave -exact out",
                 exact->type, (double)across[0], (double)across[1], (double)across[2], exact->bars[0].name, (double)ends[0][e],
                 UnitsOf((PetscObject)exact, UNIT_LENGTH), exact->bars[1].name, (double)ends[1][e],
                 UnitsOf((PetscObject)exact, UNIT_LENGTH));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the two bars, where and when they first touch, and the velocity of their centre of mass */
PetscErrorCode ExactSetUpBars(Exact exact, Controller controller)
{
  MPI_Comm      comm = PetscObjectComm((PetscObject)controller);
  PetscInt      n_bodies, n_pairs;
  const Body   *bodies;
  Body          sides[2];
  Contact       contact;
  ContactLaw    law;
  const char   *pair;
  ContactTraits traits;
  BodyMeasures  measures[2];
  ExactBar     *bars = exact->bars;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, &n_bodies, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ContactGetNumPairs(contact, &n_pairs));
  PetscCheck(n_bodies == 2 && n_pairs == 1, comm, PETSC_ERR_USER_INPUT,
             "-exact %s is known for two bodies and one contact pair, but there are %" PetscInt_FMT " bodies and %" PetscInt_FMT
             " pairs; leave -exact out",
             exact->type, n_bodies, n_pairs);
  PetscCall(ContactGetPair(contact, 0, &pair, &sides[0], &sides[1]));
  PetscCall(ContactGetPairTraits(contact, 0, NULL, NULL, exact->normal));
  for (PetscInt i = 0; i < 2; i++) {
    exact->body[i] = sides[i] == bodies[0] ? 0 : 1;
    PetscCall(GetBar(sides[i], exact->normal, &bars[i], &measures[i]));
  }
  PetscCall(CheckBars(comm, exact, bars, measures));
  PetscCall(CheckFaces(comm, exact, sides));
  PetscCall(ContactGetPairLaw(contact, 0, &law));
  PetscCheck(law == CONTACT_LAW_FRICTIONLESS || law == CONTACT_LAW_FRICTION, comm, PETSC_ERR_USER_INPUT,
             "-exact %s is known for bars that part again, and -contact_law %s does not let them; leave one of the options out",
             exact->type, ContactLaws[law]);
  PetscCall(ContactGetTraits(contact, &traits));
  PetscCheck(traits.separation, comm, PETSC_ERR_USER_INPUT,
             "-exact %s is known for bars that part again, and -contact_separation false does not let them; leave one of the options out",
             exact->type);
  PetscCall(ControllerGetTimes(controller, &exact->start, NULL, NULL));
  exact->frame_velocity  = (bars[0].mass * bars[0].velocity + bars[1].mass * bars[1].velocity) / (bars[0].mass + bars[1].mass);
  exact->impact          = exact->start + (bars[1].lower - bars[0].upper) / (bars[0].velocity - bars[1].velocity);
  exact->impact_position = bars[0].upper + (bars[0].velocity - exact->frame_velocity) * (exact->impact - exact->start);
  PetscFunctionReturn(PETSC_SUCCESS);
}
