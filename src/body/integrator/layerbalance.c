/* The massless contact layer of an explicit body: where it is follows from static balance with the rest of the body as it is,

     K_LL du = (forces - internal force)_L,

   with prescribed rows held and Robin rows on their springs. One round is exact for a linear material. Others repeat it by chord Newton's
   method, with the factors of K_LL at a displacement that may lie many steps back, at first that of the undeformed body. These factors
   become worse as the body turns, and fail after 23 degrees. When a balance has become slow, new ones are made at the start of the next
   controller step or, when it has become much slower still, within a controller step, before the next balance. In the second case they are
   not those that the step began with, so that a restore has to make these again, for the step to end with the same bits when it is
   repeated; and they are made where the outer iteration is, which may be far from where it ends. */
#include "explicitimpl.h"

/* Rounds that the balance of a nonlinear layer may take */
#define MAX_ROUNDS 100
/* A balance that takes so many is slow: in the plane, where a layer is a curve and its factors cost little, and in space. With new factors,
   a block that turns by half a degree in a step (tests/body/interface/body_repeat.c) takes 3 to 6 rounds at first. */
#define SLOW_ROUNDS_PLANE 6
#define SLOW_ROUNDS_SPACE 20
/* and so many are too slow to wait for the next step */
#define SLOW_ROUNDS_WITHIN_STEP 20
/* Where a material flows stiffness changes within a step by orders of magnitude: after so many rounds there are new factors */
#define ROUNDS_OF_FACTORS 8
/* A round of such a material has gone too far where the force along its way has turned round and is more than this part of what it was:
   factors of points that flow are too soft for points that do not, and rounds between the two would go on for ever. So often it is sought
   where less than that is left, and each time this part at least of the bracket goes. */
#define FORCE_LEFT 0.5
#define MAX_SEARCH 10
#define LEAST_PART 0.1
/* The layer is in balance when its last change is below this part of the largest one in this balance, */
#define TOLERANCE 1e-12
/* or below this part of the norm of displacements and reference positions of all nodes, whose round-off is part of any change */
#define ROUND_OFF (4 * PETSC_MACHINE_EPSILON)
/* Forces of contact rows cancel what the layer would do without them, and where its stiffness is near singular that is many times what
   is left: a change that falls no more is round-off too when it is below so many times the above */
#define AMPLIFIED 100

typedef struct {
  PetscInt number; /* of these factors, counted as they are made from those before */
  PetscInt rounds; /* that the last balance with them took */
} Age;

typedef struct {
  Age        age;
  Vec        point;   /* the displacement that they are made at [m] */
  char      *memory;  /* of the history */
  PetscReal *history; /* that the elements of the layer had then, and the length of their step; NULL where the material has none */
  PetscReal  step;
} Factors;

struct _n_LayerBalance {
  PetscReal reach;      /* norm of the reference positions of all nodes [m] */
  Factors   now, aside; /* the latter: of the saved state */
  PetscInt  n_history;  /* numbers of that history */
};

/* Age of factors, and what they are made from, from one place to another */
static PetscErrorCode CopyFactors(LayerBalance layer, const Factors *from, Factors *to)
{
  PetscFunctionBegin;
  PetscCall(VecCopy(from->point, to->point));
  PetscCall(PetscArraycpy(to->history, from->history, layer->n_history));
  to->step = from->step;
  to->age  = from->age;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of one balance */
typedef struct {
  PetscReal time, position;
  PetscBool outside; /* with forces of contact or from outside */
  Vec       force;   /* of these, of the body */
} LoadCase;

static PetscErrorCode Refactor(LayerBalance layer, Body body)
{
  Mat K;

  PetscFunctionBegin;
  PetscCall(ConstrainedSolverGetMatrices(body->solver, &K, NULL));
  PetscCall(BodyAssembleLayer(body, layer->now.point, layer->now.history, layer->now.step, NULL, K));
  PetscCall(ConstrainedSolverRefactor(body->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* New factors at displacement u of the body */
static PetscErrorCode RefactorAt(LayerBalance layer, Body body, Vec u)
{
  PetscFunctionBegin;
  PetscCall(BodyGatherLayer(body, u, layer->now.point));
  PetscCall(BodyLayerCopyHistory(body, layer->now.history, &layer->now.step));
  layer->now.age.number++;
  layer->now.age.rounds = 0;
  PetscCall(Refactor(layer, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state of the body has been put aside. That of an accepted step is where slow factors are made anew, for all that starts there. */
PetscErrorCode LayerBalanceSave(Body body)
{
  LayerBalance   layer = GetLayerBalance(body);
  const PetscInt slow  = body->mesh.dim == 2 ? SLOW_ROUNDS_PLANE : SLOW_ROUNDS_SPACE;

  PetscFunctionBegin;
  if (body->model.linear) PetscFunctionReturn(PETSC_SUCCESS);
  if (layer->now.age.rounds >= slow) PetscCall(RefactorAt(layer, body, body->state.u));
  PetscCall(CopyFactors(layer, &layer->now, &layer->aside));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How good the factors of a local body are its rank alone knows; before all ranks have rows to hold, they all do */
PetscErrorCode LayerBalanceAgree(Body body)
{
  LayerBalance layer = GetLayerBalance(body);

  PetscFunctionBegin;
  if (body->model.linear) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Bcast(&layer->now.age, sizeof(Age), MPI_BYTE, body->mesh.owner, PetscObjectComm((PetscObject)body)));
  PetscCallMPI(MPI_Bcast(&layer->aside.age, sizeof(Age), MPI_BYTE, body->mesh.owner, PetscObjectComm((PetscObject)body)));
  PetscCall(ConstrainedSolverForgetColumns(body->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LayerBalanceRestore(Body body)
{
  LayerBalance   layer = GetLayerBalance(body);
  const Factors *aside = &layer->aside;

  PetscFunctionBegin;
  if (body->model.linear) PetscFunctionReturn(PETSC_SUCCESS);
  layer->now.age.rounds = aside->age.rounds;
  if (aside->age.number == layer->now.age.number) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CopyFactors(layer, aside, &layer->now));
  PetscCall(Refactor(layer, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* rhs: what is missing to balance at u. `follows`: forces from outside go with u. */
static PetscErrorCode ComputeMissing(Body body, const LoadCase *load, PetscBool follows, Vec u)
{
  PetscFunctionBegin;
  if (follows) PetscCall(BodyComputeOutsideForce(body, load->time, load->position, PETSC_TRUE, u, load->force));
  if (load->outside) {
    PetscCall(BodyReadLayer(body, load->force, body->layer.rhs));
  } else PetscCall(VecZeroEntries(body->layer.rhs));
  PetscCall(BodySubtractLayerForce(body, u, body->layer.rhs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes back so much of the last round, with rhs as it is after it, that less force is left along its way, where it has gone too far: what
   flows has a potential of each step (M. Ortiz, L. Stainier, The variational formulation of viscoplastic constitutive updates, Computer
   Methods in Applied Mechanics and Engineering 171, 1999), and this is a search for its least value along a line. `before`: force along
   the way at the start of the round, times the way [J]. */
static PetscErrorCode TakeBack(Body body, const LoadCase *load, PetscBool follows, PetscReal before, Vec u)
{
  PetscReal low = 0, high = 1, of_low = before, of_high, at = 1, left;

  PetscFunctionBegin;
  PetscCall(BodyGetDot(body, body->layer.solution, body->layer.rhs, &left));
  of_high = left;
  if (!(before > 0) || left >= -FORCE_LEFT * before) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt tries = 0; tries < MAX_SEARCH && !(PetscAbsReal(left) <= FORCE_LEFT * before); tries++) {
    const PetscReal root = PetscIsInfOrNanReal(of_high) ? 0.5 : of_low / (of_low - of_high);
    const PetscReal next = low + (high - low) * PetscMin(PetscMax(root, LEAST_PART), 1 - LEAST_PART);

    PetscCall(VecScale(body->layer.solution, next - at));
    PetscCall(BodyWriteLayer(body, body->layer.solution, ADD_VALUES, u));
    PetscCall(VecScale(body->layer.solution, 1 / (next - at)));
    PetscCall(ComputeMissing(body, load, follows, u));
    PetscCall(BodyGetDot(body, body->layer.solution, body->layer.rhs, &left));
    at = next;
    if (left > 0) {
      low    = next;
      of_low = left;
    } else {
      high    = next;
      of_high = left;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the layer in u into balance at a time. Where there are forces from outside or of contact, `force` becomes their sum, with Robin
   rows where they were before the last round; else it is left alone. */
PetscErrorCode LayerBalanceSolve(LayerBalance layer, Body body, PetscReal time, PetscReal position, Vec u, Vec force)
{
  const PetscBool outside = BodyHasOutsideForce(body, PETSC_TRUE), linear = (PetscBool)(body->model.linear || body->model.linearized),
                  robin = (PetscBool)(body->rows.n_robin > 0);
  const LoadCase  load  = {.time = time, .position = position, .outside = outside, .force = force};
  PetscReal       first = 0, previous = PETSC_MAX_REAL, round_off = 0, work = 0;

  PetscFunctionBegin;
  if (!linear) {
    if (layer->now.age.rounds >= SLOW_ROUNDS_WITHIN_STEP) PetscCall(RefactorAt(layer, body, u));
    PetscCall(BodyGetNorm(body, u, &round_off));
    round_off = ROUND_OFF * (round_off + layer->reach);
  }
  if (outside) PetscCall(BodyComputeOutsideForce(body, time, position, PETSC_TRUE, u, force));
  for (PetscInt round = 0; round < (linear ? 1 : MAX_ROUNDS); round++) {
    PetscReal change;

    if (body->history && round && round % ROUNDS_OF_FACTORS == 0) PetscCall(RefactorAt(layer, body, u));
    PetscCall(ComputeMissing(body, &load, (PetscBool)(round && robin), u));
    if (body->history && round > 1) PetscCall(TakeBack(body, &load, robin, work, u)); /* the first puts held rows in their places */
    PetscCall(ConstrainedSolverSolve(body->solver, body->layer.rhs, body->layer.solution));
    if (body->history) PetscCall(BodyGetDot(body, body->layer.solution, body->layer.rhs, &work));
    PetscCall(BodyWriteLayer(body, body->layer.solution, ADD_VALUES, u));
    if (linear) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(BodyGetNorm(body, body->layer.solution, &change));
    first = PetscMax(first, change);
    /* what is not a number is told when the substep is over */
    layer->now.age.rounds = round + 1;
    if (change <= TOLERANCE * first + round_off || PetscIsInfOrNanReal(change)) PetscFunctionReturn(PETSC_SUCCESS);
    if (change >= previous && change <= AMPLIFIED * round_off) PetscFunctionReturn(PETSC_SUCCESS);
    previous = change;
  }
  PetscCall(StepFailureSet(
      &body->failure, STEP_DIVERGED_LAYER, PETSC_ERR_NOT_CONVERGED,
      "Body '%s': the massless contact layer found no balance in %d rounds at time %.9g s; choose a smaller -%sts_time_step, or "
      "-%smass_redistribute false",
      body->hdr.name, MAX_ROUNDS, (double)time, ((PetscObject)body)->prefix, ((PetscObject)body)->prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The internal force of the body at displacement u, on the dofs of the layer alone; other entries of `force` are left alone */
PetscErrorCode LayerBalanceGetForce(Body body, Vec u, Vec force)
{
  PetscFunctionBegin;
  PetscCall(VecZeroEntries(body->layer.rhs));
  PetscCall(BodySubtractLayerForce(body, u, body->layer.rhs));
  PetscCall(VecScale(body->layer.rhs, -1));
  PetscCall(BodyWriteLayer(body, body->layer.rhs, INSERT_VALUES, force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The solver has new rows of the body, on all of its dofs: takes those on the dofs of the layer in their place. Collective. */
PetscErrorCode LayerBalanceSetRows(Body body)
{
  Mat B;
  IS  rows;

  PetscFunctionBegin;
  PetscCall(ConstrainedSolverGetMatrices(body->solver, NULL, &B));
  if (B != body->rows.free_matrix) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ISCreateStride(PetscObjectComm((PetscObject)body), body->rows.local, body->rows.begin, 1, &rows));
  PetscCall(MatCreateSubMatrix(body->rows.free_matrix, rows, body->layer.global, MAT_INITIAL_MATRIX, &B));
  PetscCall(ConstrainedSolverSetRows(body->solver, B, NULL));
  PetscCall(MatDestroy(&B));
  PetscCall(ISDestroy(&rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With the factors of the undeformed layer, in body->solver */
PetscErrorCode LayerBalanceCreate(Body body, LayerBalance *balance)
{
  Mat          K;
  char         prefix[128];
  LayerBalance layer;

  PetscFunctionBegin;
  PetscCall(PetscNew(balance));
  layer = *balance;
  PetscCall(BodySetUpLayerElements(body));
  PetscCall(BodyCreateLayerMatrix(body, &K));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%slayer_", ((PetscObject)body)->prefix));
  /* a layer is a surface, and its factors fill in as those of a mesh with one dimension less */
  PetscCall(ConstrainedSolverCreate(K, body->rows.free_matrix, PetscMax(body->mesh.dim - 1, 1), prefix, body->model.linear, &body->solver));
  PetscCall(VecNorm(body->mesh.positions, NORM_2, &layer->reach));
  PetscCall(MatDestroy(&K));
  if (!body->model.linear) {
    PetscCall(BodyCreateLayerVec(body, &layer->now.point));
    PetscCall(VecZeroEntries(layer->now.point));
    PetscCall(BodyLayerCreateHistory(body, &layer->n_history, &layer->now.memory, &layer->now.history));
    PetscCall(BodyLayerCreateHistory(body, NULL, &layer->aside.memory, &layer->aside.history));
    PetscCall(VecDuplicate(layer->now.point, &layer->aside.point));
    PetscCall(VecZeroEntries(layer->aside.point));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For a checkpoint that is continued on another number of ranks: where the factors were made, on the nodes of the body near the layer, and
   their number, 0 for those of the undeformed layer, and the rounds of the last balance with them; or back */
PetscErrorCode LayerBalanceCopyPoint(Body body, PetscBool back, Vec point, PetscReal numbers[2])
{
  LayerBalance layer = GetLayerBalance(body);

  PetscFunctionBegin;
  if (back) {
    layer->now.age.number = (PetscInt)numbers[0];
    layer->now.age.rounds = (PetscInt)numbers[1];
    if (!layer->now.age.number) PetscFunctionReturn(PETSC_SUCCESS);
    /* a displacement of earlier steps goes with the history of these steps: with that of now there are factors where the body is now */
    PetscCall(BodyGatherLayer(body, body->history ? body->saved.u : point, layer->now.point));
    PetscCall(BodyLayerCopyHistory(body, layer->now.history, &layer->now.step));
    PetscCall(CopyFactors(layer, &layer->now, &layer->aside));
    PetscCall(Refactor(layer, body));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  numbers[0] = (PetscReal)layer->now.age.number;
  numbers[1] = (PetscReal)layer->now.age.rounds;
  PetscCall(BodySpreadLayer(body, layer->now.point, point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint: where the factors of a nonlinear layer were made */
PetscErrorCode LayerBalanceVisit(Body body, PetscInt level, Checkpoint checkpoint)
{
  LayerBalance   layer  = GetLayerBalance(body);
  const PetscInt before = layer->now.age.number;

  PetscFunctionBegin;
  if (CheckpointLoads(checkpoint)) PetscCall(LayerBalanceSetRows(body)); /* columns are made of them */
  if (level || body->model.linear) PetscFunctionReturn(PETSC_SUCCESS);   /* one for all levels */
  PetscCall(CheckpointVisitInts(checkpoint, "layer number", 1, &layer->now.age.number));
  PetscCall(CheckpointVisitInts(checkpoint, "layer rounds", 1, &layer->now.age.rounds));
  PetscCall(CheckpointVisitVec(checkpoint, "layer point", layer->now.point));
  if (body->history) {
    PetscCall(CheckpointVisitReals(checkpoint, "layer history", layer->n_history, layer->now.history));
    PetscCall(CheckpointVisitReals(checkpoint, "layer step", 1, &layer->now.step));
  }
  if (!CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CopyFactors(layer, &layer->now, &layer->aside));
  if (layer->now.age.number != before) PetscCall(Refactor(layer, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LayerBalanceDestroy(LayerBalance *layer)
{
  PetscFunctionBegin;
  if (!*layer) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDestroy(&(*layer)->now.point));
  PetscCall(PetscFree((*layer)->now.memory));
  PetscCall(VecDestroy(&(*layer)->aside.point));
  PetscCall(PetscFree((*layer)->aside.memory));
  PetscCall(PetscFree(*layer));
  PetscFunctionReturn(PETSC_SUCCESS);
}
