/* Energies, momentum, mean rotation, and boxes about bodies. */
#include <body/integrator/rigidmotion.h>
#include <body/layout/bodyimpl.h>

/* Of the kinetic energy this part counts even where all bodies move alike: less is round-off of it */
#define ROUND_OFF 1e-9

/* Sums over nodes and elements that measures are made of; then works of loads and dashpots, in accepted steps and in the present one */
#define N_SUMS (BODY_MEASURE_SUMS - 4)

/* Stored energy of this rank's elements [J], where that is more than half the work of the internal force */
static PetscErrorCode ComputePotential(Body body, PetscReal *potential)
{
  const PetscScalar *u;
  Vec                local;
  ElementHistory     before;

  PetscFunctionBegin;
  PetscCall(BodyGetLocalRead(body, body->state.u, &local, &u));
  BodyHistoryLook(body, &before);
  PetscCall((*body->model.element->ops->energy)(body->model.element, u, potential));
  BodyHistoryLookBack(body, &before);
  PetscCall(BodyRestoreLocalRead(body, body->state.u, &local, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of this rank's elements with one point [J] */
static PetscErrorCode ComputeHourglassEnergy(Body body, PetscReal *energy)
{
  const PetscScalar *u;
  Vec                local;

  PetscFunctionBegin;
  *energy = 0;
  if (!body->model.element->ops->hourglass || !body->integrator->deforms) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetLocalRead(body, body->state.u, &local, &u));
  PetscCall((*body->model.element->ops->hourglass)(body->model.element, u, energy));
  PetscCall(BodyRestoreLocalRead(body, body->state.u, &local, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the elements have displacements that their points do not see, and a stiffness that holds them: those of ELEMENT_REDUCED */
PetscErrorCode BodyHasHourglasses(Body body, PetscBool *hourglasses)
{
  PetscFunctionBegin;
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  *hourglasses = (PetscBool)(body->model.element->ops->hourglass != NULL && body->integrator->deforms);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the last sums are those of the present state, which they are from now on; divided bodies and those with memory sum each time */
static PetscErrorCode IsMeasured(Body body, PetscBool *measured)
{
  const Vec of[4] = {body->state.u, body->state.v, body->state.a, body->state.internal_force};

  PetscFunctionBegin;
  *measured = (PetscBool)(!body->mesh.ghosted && !body->history && body->measured.time_step == body->time.step);
  for (PetscInt k = 0; k < 4; k++) {
    PetscObjectState now = 0;

    if (of[k]) PetscCall(PetscObjectStateGet((PetscObject)of[k], &now));
    if (now != body->measured.of[k]) *measured = PETSC_FALSE;
    body->measured.of[k] = now;
  }
  body->measured.time_step = body->time.step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What measures are sums of, over this rank's part. A body without inertia has a mean velocity, weighted by its mass, all the same. */
static PetscErrorCode SumMeasures(Body body, PetscReal sums[])
{
  PetscReal kinetic, moving, half_work, momentum[3], angular[3], turned[3], place[3];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(sums, N_SUMS));
  PetscCall(BodySumNodes(body, &kinetic, &moving, &half_work, momentum, angular, turned, place));
  if (body->integrator->deforms && body->model.linear) sums[1] = half_work;
  else if (body->integrator->deforms) PetscCall(ComputePotential(body, &sums[1]));
  PetscCall(ComputeHourglassEnergy(body, &sums[14]));
  if (body->integrator->has_inertia) {
    sums[0]  = kinetic;
    sums[16] = moving;
    PetscCall(PetscArraycpy(sums + 2, momentum, 3));
    PetscCall(PetscArraycpy(sums + 5, angular, 3));
  }
  PetscCall(PetscArraycpy(sums + 8, momentum, 3));
  PetscCall(PetscArraycpy(sums + 11, turned, 3));
  PetscCall(PetscArraycpy(sums + 17, place, 3));
  sums[15] = body->model.element->plastic_work; /* found with the potential energy */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetMeasures - energies, momenta and mean velocity at the current time

  Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. measures - see `BodyMeasures`

  Level: intermediate

  Notes:
  The kinetic energy of a body under central differences is the staggered one, 1/2 v'Mv - dt^2/8 a'Ma: together with the
  potential energy it is what the scheme conserves.

  A static body has neither kinetic energy nor momentum.

  Energies and momentum of an axisymmetric body are those of whole rings: it has momentum along y alone, and turns about nothing.

.seealso: `Body`, `BodyMeasures`
@*/
PetscErrorCode BodyGetMeasures(Body body, BodyMeasures *measures)
{
  PetscReal sums[BODY_MEASURE_SUMS];

  PetscFunctionBegin;
  PetscAssertPointer(measures, 2);
  PetscCall(BodyGetAllMeasures(1, &body, sums, measures));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What this rank adds to the sums of a body. The works are not sums over its nodes: they come from the rank that knows them. */
static PetscErrorCode GetSums(Body body, PetscReal sums[BODY_MEASURE_SUMS])
{
  PetscBool measured;

  PetscFunctionBegin;
  if (BodyIsElsewhere(body)) {
    PetscCall(PetscArrayzero(sums, BODY_MEASURE_SUMS));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyFindInternalForce(body));
  PetscCall(IsMeasured(body, &measured));
  if (!measured) PetscCall(SumMeasures(body, body->measured.sums));
  PetscCall(PetscArraycpy(sums, body->measured.sums, N_SUMS));
  sums[N_SUMS]     = BodyShareOf(body, body->state.external_work);
  sums[N_SUMS + 1] = BodyShareOf(body, body->state.damping_work);
  sums[N_SUMS + 2] = sums[N_SUMS + 3] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddRanks(PetscInt n, const Body bodies[], PetscReal sums[])
{
  PetscMPIInt count;

  PetscFunctionBegin;
  if (!n || bodies[0]->rows.size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMPIIntCast(BODY_MEASURE_SUMS * n, &count));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, count, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)bodies[0])));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Measures from the sums of all ranks */
static PetscErrorCode Finish(Body body, const PetscReal sums[], BodyMeasures *measures)
{
  PetscReal drag;

  PetscFunctionBegin;
  measures->kinetic             = sums[0];
  measures->kinetic_unstaggered = sums[16];
  measures->potential           = sums[1];
  measures->external_work       = sums[N_SUMS];
  measures->damping_work        = sums[N_SUMS + 1];
  measures->plastic_work        = sums[15] - body->plastic_before;
  measures->hourglass_energy    = sums[14];
  RigidMultiply(body->mass.inverse_inertia, sums + 11, measures->rotation); /* of sum m (X - C) x u */
  PetscCall(BodyGetDamping(body, &drag, NULL));                             /* which takes momentum */
  measures->loaded = (PetscBool)(BodyIsLoaded(body) || drag > 0);
  for (PetscInt d = 0; d < 3; d++) {
    measures->momentum[d]         = sums[2 + d];
    measures->angular_momentum[d] = sums[5 + d];
    measures->mean_velocity[d]    = sums[8 + d] / body->mass.total;
    measures->place[d]            = sums[17 + d] / body->mass.total;
    measures->orientation[d] = measures->angular_velocity[d] = 0;
  }
  if (body->integrator->ops.measure) PetscCall((*body->integrator->ops.measure)(body, measures));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyGetMeasures() of bodies on one communicator by one reduction. `sums`: work space, BODY_MEASURE_SUMS for each body. Collective. */
PetscErrorCode BodyGetAllMeasures(PetscInt n, const Body bodies[], PetscReal sums[], BodyMeasures measures[])
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < n; b++) {
    PetscCall(GetSums(bodies[b], sums + BODY_MEASURE_SUMS * b));
  }
  PetscCall(AddRanks(n, bodies, sums));
  for (PetscInt b = 0; b < n; b++) PetscCall(Finish(bodies[b], sums + BODY_MEASURE_SUMS * b, &measures[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Energies that only contact and errors of the integrator change: kinetic and potential energy, less the work of loads, with what
   dashpots took, of the present states [J]. Unlike BodyGetMeasures() they have the work of a step that is not accepted yet. `sums`: work
   space, BODY_MEASURE_SUMS for each body. One sum over the ranks for all bodies. Collective. */
PetscErrorCode BodyComputeEnergies(PetscInt n, const Body bodies[], PetscReal sums[], PetscReal energies[])
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < n; b++) {
    const Body body = bodies[b];

    /* where a step has been undone, the internal force is still that of its end */
    if (body->state.step == body->saved.step && !BodyIsElsewhere(body) && !body->integrator->leaves_force)
      PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
    PetscCall(GetSums(body, sums + BODY_MEASURE_SUMS * b));
    if (!BodyIsElsewhere(body)) PetscCall(BodyAddPendingWork(body, sums + BODY_MEASURE_SUMS * b + N_SUMS + 2));
  }
  PetscCall(AddRanks(n, bodies, sums));
  for (PetscInt b = 0; b < n; b++) {
    const PetscReal *of = sums + BODY_MEASURE_SUMS * b;
    BodyMeasures     measures;

    PetscCall(Finish(bodies[b], of, &measures));
    energies[b] = BodyMeasuresGetBalance(&measures) - of[N_SUMS + 2] + of[N_SUMS + 3];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyMeasuresGetBalance - the energy that only contact and errors of the integrator change

  Not Collective

  Input Parameter:
. measures - of a body, by `BodyGetMeasures()`

  Level: intermediate

  Note:
  Kinetic and potential energy, with what dashpots and plastic flow have taken, less the work of loads and of held displacements [J].

.seealso: `Body`, `BodyMeasures`, `BodyGetMeasures()`
@*/
PetscReal BodyMeasuresGetBalance(const BodyMeasures *measures)
{
  return measures->kinetic + measures->potential + measures->damping_work + measures->plastic_work - measures->external_work;
}

/* Kinetic energy of all bodies of a system that are not led [J]. That of their common motion is left out where nothing outside holds,
   loads or stops any of them: so it is the same in frames that move. */
PetscErrorCode BodyGetOwnKinetic(PetscInt n, const Body bodies[], const BodyMeasures measures[], PetscReal *kinetic)
{
  PetscReal momentum[3] = {0}, mass = 0, common = 0;
  PetscBool free = PETSC_TRUE;

  PetscFunctionBegin;
  *kinetic = 0;
  for (PetscInt b = 0; b < n; b++) {
    PetscBool led;

    PetscCall(BodyGetLed(bodies[b], NULL, &led));
    /* the staggered energy is round-off of much more, or negative, in the first step of a load that sets in at zero */
    *kinetic += led ? 0 : measures[b].kinetic_unstaggered;
    for (PetscInt d = 0; d < 3; d++) momentum[d] += measures[b].momentum[d];
    mass += bodies[b]->mass.total;
    free = (PetscBool)(free && !measures[b].loaded);
  }
  for (PetscInt d = 0; d < 3; d++) common += 0.5 * PetscSqr(momentum[d]) / mass;
  if (free) *kinetic = PetscMax(*kinetic - common, ROUND_OFF * *kinetic);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Boxes about bodies on one communicator where they are, or where their meshes are before the set-up: of each the lower corner, and the
   upper corner with its sign changed; zeros beyond the dimension [m]. Collective. */
PetscErrorCode BodyGetAllBoxes(PetscInt n, const Body bodies[], PetscReal boxes[])
{
  PetscMPIInt count;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < n; b++) {
    const PetscInt     dim = bodies[b]->mesh.dim;
    PetscReal         *box = boxes + 6 * b;
    const PetscScalar *x, *u = NULL;
    PetscInt           size;

    for (PetscInt k = 0; k < 6; k++) box[k] = k % 3 < dim ? PETSC_MAX_REAL : 0;
    PetscCall(VecGetLocalSize(bodies[b]->mesh.positions, &size));
    PetscCall(VecGetArrayRead(bodies[b]->mesh.positions, &x));
    if (bodies[b]->state.u) PetscCall(VecGetArrayRead(bodies[b]->state.u, &u));
    for (PetscInt i = 0; i < size; i++) {
      const PetscReal at = PetscRealPart(x[i]) + (u ? PetscRealPart(u[i]) : 0);
      const PetscInt  d  = i % dim;

      box[d]     = PetscMin(box[d], at);
      box[3 + d] = PetscMin(box[3 + d], -at);
    }
    if (u) PetscCall(VecRestoreArrayRead(bodies[b]->state.u, &u));
    PetscCall(VecRestoreArrayRead(bodies[b]->mesh.positions, &x));
  }
  PetscCall(PetscMPIIntCast(6 * n, &count));
  if (n && bodies[0]->rows.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, boxes, count, MPIU_REAL, MPIU_MIN, PetscObjectComm((PetscObject)bodies[0])));
  PetscFunctionReturn(PETSC_SUCCESS);
}
