/*
   The first state of massless nodes is the one in which they are in balance, under loads, with strains of the initial displacement, and
   with the forces of ties and of closed rows. With the layer of each body held by the rest of it, which stays where the user has put it,
   gaps g answer to forces l on the rows by

     g = g* + S l,   S = sum_bodies B K_LL^{-1} B^T,   g*: gaps of layers that relax without contact.

   Rows that are tied have g = 0, others l >= 0, g >= 0, l g = 0; where springs hold the rows, as in the penalty method, g = -l / k stands
   in place of g = 0. The active set settles in rounds, the forces of each are found by conjugate gradients. Nonlinear bodies repeat it with
   the tangents at the displacements found. The forces are those of the first record of the history.

   With friction, closed nodes stick where they have been put, so that a state of rest under friction stays one; rows across their normals
   are then like ties. Those whose forces are beyond what the law allows slide under forces that are given: see frictionstart.c.
*/
#include <contact/activeset/rounds.h>
#include <contact/rows/inversemass.h>

/* Of the gaps, relative: near round-off, since a gap that is left does work in the first step */
#define TOLERANCE 1e-15
/* What may be left where round-off keeps conjugate gradients from that, as with rows that depend on each other; and iterations at most */
#define WORST          1e-9
#define MAX_ITERATIONS 5000
/* Rounds of nonlinear layers; the layer is in balance when its last change is below this part of the largest one */
#define MAX_ROUNDS 50
#define SMALL      1e-13
/* Times that friction may change its mind about which nodes stick */
#define MAX_RUBS 100

typedef struct {
  Contact      contact;
  PetscBool   *takes_part;      /* per row: its force is looked for here */
  PetscReal   *springs;         /* per row: compliance of the spring that holds it, 0 if it is rigid [m/N] */
  PetscReal   *relaxed;         /* per row: g* [m] */
  PetscBool   *sticks;          /* per row across a normal: its force is looked for as long as its node is closed */
  PetscReal   *given;           /* per row across a normal that does not stick: its force [N] */
  PetscReal   *put, *slip;      /* per row across a normal: B u as the bodies have been put, and by how much it has changed [m] */
  PetscScalar *on_body, *moved; /* work space, per row */
  PetscBool    rubs;            /* there is friction */
  PetscReal    change;          /* of the layers in this round [m] */
  Rounds       rounds;
  KSP          ksp;
  Mat          S;
  Vec          rhs, solution;
} StartBalance;

/* change = S force on this rank's rows [m] */
static PetscErrorCode MultiplyLayers(StartBalance *start, const PetscScalar force[], PetscScalar change[])
{
  const Contact contact = start->contact;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(change, contact->rows.n));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    InverseMassGetBodyForces(contact, b, force, start->on_body);
    PetscCall(BodyMultiplyLayerCompliance(contact->bodies[b], start->on_body, start->moved));
    InverseMassAddBodyRows(contact, b, start->moved, change);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the force of a row is looked for in this round */
static inline PetscBool IsSolved(const StartBalance *start, PetscInt i)
{
  const Contact contact = start->contact;

  if (!ContactRowRubs(contact, i)) return contact->end.active[i];
  return (PetscBool)(start->sticks[i] && contact->end.active[ContactFirstRow(contact, i)]);
}

/* The force that a row has, whatever is found */
static inline PetscReal GetGiven(const StartBalance *start, PetscInt i)
{
  const Contact contact = start->contact;

  return ContactRowRubs(contact, i) && !start->sticks[i] && contact->end.active[ContactFirstRow(contact, i)] ? start->given[i] : 0;
}

/* y = (S + springs) x on active rows; ones on the diagonal of the others */
static PetscErrorCode MultiplyActive(Mat S, Vec x, Vec y)
{
  StartBalance      *start;
  const PetscScalar *in;
  PetscScalar       *force, *out;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(S, &start));
  PetscCall(PetscMalloc1(start->contact->rows.n, &force));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArrayWrite(y, &out));
  for (PetscInt i = 0; i < start->contact->rows.n; i++) force[i] = IsSolved(start, i) ? in[i] : 0;
  PetscCall(MultiplyLayers(start, force, out));
  for (PetscInt i = 0; i < start->contact->rows.n; i++) out[i] = IsSolved(start, i) ? out[i] + start->springs[i] * in[i] : in[i];
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscCall(PetscFree(force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces of the active rows, and the gaps that they leave; of rows across normals the slips */
static PetscErrorCode SolveActive(StartBalance *start)
{
  const Contact      contact = start->contact;
  PetscScalar       *change = start->moved + contact->rows.n, *all = change + contact->rows.n, *rhs;
  KSPConvergedReason reason;
  PetscReal          left, size;
  const PetscScalar *force;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(change, contact->rows.n));
  for (PetscInt i = 0; i < contact->rows.n; i++) all[i] = GetGiven(start, i);
  if (start->rubs) PetscCall(MultiplyLayers(start, all, change));
  PetscCall(VecGetArrayWrite(start->rhs, &rhs));
  for (PetscInt i = 0; i < contact->rows.n; i++) rhs[i] = IsSolved(start, i) ? -start->relaxed[i] - change[i] : 0;
  PetscCall(VecRestoreArrayWrite(start->rhs, &rhs));
  PetscCall(KSPSolve(start->ksp, start->rhs, start->solution));
  PetscCall(KSPGetConvergedReason(start->ksp, &reason));
  PetscCall(KSPGetResidualNorm(start->ksp, &left));
  PetscCall(VecNorm(start->rhs, NORM_2, &size));
  PetscCheck(reason >= 0 || left <= WORST * size, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
             "The contact forces of the first state, in which massless nodes are in balance, were not found: %s, with %g of the gaps left; "
             "set -contact_balanced_start false to start from the displacements as they are",
             KSPConvergedReasons[reason], (double)(left / size));
  PetscCall(VecGetArrayRead(start->solution, &force));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    contact->end.force[i] = IsSolved(start, i) ? PetscRealPart(force[i]) : GetGiven(start, i);
    all[i]                = contact->end.force[i];
  }
  PetscCall(VecRestoreArrayRead(start->solution, &force));
  PetscCall(MultiplyLayers(start, all, change));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscReal opened = start->relaxed[i] + PetscRealPart(change[i]);
    const PetscBool rubs   = ContactRowRubs(contact, i);

    contact->end.gap[i] = start->takes_part[i] && !rubs ? opened : contact->start.gap[i];
    start->slip[i]      = rubs ? opened : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows join and leave until the forces fit the gaps, under given forces of nodes that slide */
static PetscErrorCode SolveRounds(StartBalance *start)
{
  const Contact contact = start->contact;
  PetscBool     changed = PETSC_TRUE, flips;

  PetscFunctionBegin;
  PetscCall(RoundsBegin(&start->rounds));
  while (changed) {
    PetscCall(RoundsNext(&start->rounds));
    PetscCall(StepFailureRaise(PetscObjectComm((PetscObject)contact), &contact->attempt.failure));
    PetscCall(SolveActive(start));
    PetscCall(RoundsChange(&start->rounds));
    PetscCall(RoundsHaveChanged(&start->rounds, &changed));
    if (changed) PetscCall(RoundsBreakCycle(&start->rounds, &flips));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces of all rows */
static PetscErrorCode SolveRows(StartBalance *start)
{
  const Contact contact = start->contact;
  PetscBool     changed = start->rubs;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    contact->end.active[i] = (PetscBool)(start->takes_part[i] && !ContactRowRubs(contact, i) &&
                                         (contact->rows.tied[i] || start->relaxed[i] < -contact->options.tolerance));
    start->sticks[i]       = start->rubs;
    start->given[i]        = 0;
  }
  PetscCall(SolveRounds(start));
  for (PetscInt rub = 0; changed; rub++) {
    PetscCheck(rub < MAX_RUBS, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
               "The forces of friction of the first state, in which massless nodes are in balance, did not settle in %d rounds; set "
               "-contact_balanced_start false to start from the displacements as they are",
               MAX_RUBS);
    PetscCall(ContactJudgeRubbing(contact, start->slip, start->sticks, start->given, &changed));
    if (changed) PetscCall(SolveRounds(start));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The gaps of layers that relax without contact, with tangents at their present displacements */
static PetscErrorCode Relax(StartBalance *start)
{
  const Contact contact = start->contact;

  PetscFunctionBegin;
  start->change = 0;
  PetscCall(ContactComputeStartGaps(contact));
  ContactAlignRubbingRows(contact);
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    start->relaxed[i] = contact->start.gap[i];
    if (!ContactRowRubs(contact, i)) continue;
    PetscCall(ContactGetOpening(contact, i, &start->relaxed[i]));
    start->relaxed[i] -= start->put[i];
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal change;

    PetscCall(BodyRelaxLayer(contact->bodies[b], start->moved, &change));
    start->change = PetscMax(start->change, change);
    for (PetscInt k = 0; k < contact->body_rows[b].n; k++) {
      const PetscInt i = contact->body_rows[b].rows[k];

      if (start->takes_part[i])
        start->relaxed[i] += ContactSign(&contact->pairs[contact->rows.pair[i]], b) * PetscRealPart(start->moved[k]);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The layers of all bodies under the forces found */
static PetscErrorCode Move(StartBalance *start)
{
  const Contact contact = start->contact;

  PetscFunctionBegin;
  start->change = 0;
  for (PetscInt i = 0; i < contact->rows.n; i++) start->moved[i] = contact->end.force[i];
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal change;

    InverseMassGetBodyForces(contact, b, start->moved, start->on_body);
    PetscCall(BodyMoveLayer(contact->bodies[b], start->on_body, &change));
    start->change = PetscMax(start->change, change);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows whose forces move a massless node take part, but ties that keep their mass, where nodes with mass are: ContactStartTies() finds
   their forces */
static PetscErrorCode FindRows(StartBalance *start)
{
  const Contact contact = start->contact;
  PetscBool    *massless, *mass, *any_mass;

  PetscFunctionBegin;
  PetscCall(PetscCalloc3(contact->rows.n, &massless, contact->rows.n, &mass, contact->rows.n, &any_mass));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodyMarkRows(contact->bodies[b], massless, mass));
    for (PetscInt k = 0; k < contact->body_rows[b].n; k++) {
      const PetscInt i = contact->body_rows[b].rows[k];

      start->takes_part[i] = (PetscBool)(start->takes_part[i] || massless[k]);
      any_mass[i]          = (PetscBool)(any_mass[i] || mass[k]);
    }
  }
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (any_mass[i] && contact->rows.tied[i] && contact->pairs[contact->rows.pair[i]].keeps_mass) start->takes_part[i] = PETSC_FALSE;
  PetscCall(PetscFree3(massless, mass, any_mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compliance of the springs that a method has between both sides of a row, from what they store at a penetration of a metre */
static PetscReal SpringCompliance(Contact contact, PetscInt i)
{
  const PetscReal stored = contact->ops->stored ? (*contact->ops->stored)(contact, i, -1) : 0;

  return stored > 0 ? 0.5 / stored : 0;
}

static PetscErrorCode Create(Contact contact, StartBalance *start)
{
  const PetscInt n = contact->rows.n;
  PC             pc;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(start, sizeof(*start)));
  start->contact = contact;
  PetscCall(PetscCalloc5(n, &start->takes_part, n, &start->springs, n, &start->relaxed, n, &start->on_body, 3 * n, &start->moved));
  start->rubs = ContactAnyPairHas(contact, CONTACT_LAW_FRICTION);
  PetscCall(PetscCalloc4(n, &start->sticks, n, &start->given, n, &start->put, n, &start->slip));
  PetscCall(FindRows(start));
  for (PetscInt i = 0; i < n; i++) start->springs[i] = SpringCompliance(contact, i);
  PetscCall(RoundsCreate(contact, contact->end.active, contact->end.force, contact->end.gap, &start->rounds));
  start->rounds.known = start->takes_part;
  for (PetscInt i = 0; i < n; i++)
    if (ContactRowRubs(contact, i)) PetscCall(ContactGetOpening(contact, i, &start->put[i]));
  PetscCall(ContactCreateRowVec(contact, &start->rhs));
  PetscCall(VecDuplicate(start->rhs, &start->solution));
  PetscCall(MatCreateShell(PetscObjectComm((PetscObject)contact), n, n, contact->rows.n_all, contact->rows.n_all, start, &start->S));
  PetscCall(MatShellSetOperation(start->S, MATOP_MULT, (void (*)(void))MultiplyActive));
  PetscCall(MatSetOption(start->S, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)contact), &start->ksp));
  PetscCall(KSPSetOperators(start->ksp, start->S, start->S));
  PetscCall(KSPSetType(start->ksp, KSPCG));
  PetscCall(KSPSetNormType(start->ksp, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetTolerances(start->ksp, TOLERANCE, 0, PETSC_CURRENT, MAX_ITERATIONS));
  PetscCall(KSPGetPC(start->ksp, &pc));
  PetscCall(PCSetType(pc, PCNONE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(StartBalance *start)
{
  PetscFunctionBegin;
  PetscCall(RoundsDestroy(&start->rounds));
  PetscCall(KSPDestroy(&start->ksp));
  PetscCall(MatDestroy(&start->S));
  PetscCall(VecDestroy(&start->rhs));
  PetscCall(VecDestroy(&start->solution));
  PetscCall(PetscFree4(start->sticks, start->given, start->put, start->slip));
  PetscCall(PetscFree5(start->takes_part, start->springs, start->relaxed, start->on_body, start->moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The states of the bodies, and of the rows, as those that the run starts from */
static PetscErrorCode Finish(StartBalance *start)
{
  const Contact  contact = start->contact;
  const PetscInt n       = contact->rows.n;
  PetscReal      stored  = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) start->moved[i] = contact->end.force[i];
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    InverseMassGetBodyForces(contact, b, start->moved, start->on_body);
    PetscCall(BodyStartUnderForces(contact->bodies[b], start->on_body));
  }
  PetscCall(ContactComputeStartGaps(contact));
  ContactAlignRubbingRows(contact);
  for (PetscInt i = 0; i < n; i++)
    if (ContactRowRubs(contact, i)) contact->end.active[i] = contact->end.active[ContactFirstRow(contact, i)];
  PetscCall(PetscArraycpy(contact->start.force, contact->end.force, n));
  PetscCall(PetscArraycpy(contact->start.active, contact->end.active, n));
  PetscCall(PetscArraycpy(contact->energy.accepted_force, contact->end.force, n));
  if (contact->ops->stored)
    for (PetscInt i = 0; i < n; i++) stored += contact->energy.last_stored[i] = (*contact->ops->stored)(contact, i, contact->end.gap[i]);
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, &stored, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  contact->resultants.penalty_energy = stored;
  PetscCall(ContactStartImpulses(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether any body has a layer out of balance, and all have inertia: what a body without inertia does in its first step is not known yet */
static PetscErrorCode IsNeeded(Contact contact, PetscBool *needed)
{
  PetscFunctionBegin;
  *needed = PETSC_FALSE;
  if (!contact->options.balanced_start || !(contact->n_pairs || contact->neighbours.come_and_go)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool is_static;

    PetscCall(BodyIsStatic(contact->bodies[b], &is_static));
    if (is_static) PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt b = 0; b < contact->n_bodies && !*needed; b++) PetscCall(BodyIsOutOfBalance(contact->bodies[b], needed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The error of a first state that is not found */
static PetscErrorCode RefuseStart(Contact contact)
{
  char sudden[BODY_SUDDEN_LENGTH] = "";

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && !sudden[0]; b++) PetscCall(BodyDescribeSuddenLoad(contact->bodies[b], sudden));
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
          "The massless nodes found no balance in %d rounds at the start, from the initial displacements and loads of the bodies; give "
          "these smaller values, or set -contact_balanced_start false to start from the displacements as they are%s%s",
          MAX_ROUNDS, sudden[0] ? ". " : "", sudden);
}

/* Moves the massless nodes of all bodies into balance in their first states, with the rows as they are. Call with the bodies set up, when
   ties and rows are known. */
PetscErrorCode ContactBalanceStart(Contact contact)
{
  PetscReal    first = 0;
  PetscBool    needed, linear = PETSC_TRUE, out = PETSC_FALSE; /* of balance without forces */
  StartBalance start;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(contact->end.force, contact->rows.n));
  PetscCall(PetscArrayzero(contact->start.force, contact->rows.n));
  PetscCall(PetscArrayzero(contact->end.active, contact->rows.n));
  PetscCall(PetscArrayzero(contact->start.active, contact->rows.n));
  PetscCall(IsNeeded(contact, &needed));
  if (!needed) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool is_linear;

    PetscCall(BodyIsLinear(contact->bodies[b], &is_linear));
    linear = (PetscBool)(linear && is_linear);
  }
  PetscCall(Create(contact, &start));
  for (PetscInt round = 0;; round++) {
    if (round == MAX_ROUNDS) PetscCall(RefuseStart(contact));
    PetscCall(Relax(&start));
    if (round == 0 && start.change == 0) break;
    out = PETSC_TRUE;
    PetscCall(SolveRows(&start));
    PetscCall(Move(&start));
    first = PetscMax(first, start.change);
    if (linear || start.change <= SMALL * first) break;
  }
  if (out) PetscCall(Finish(&start)); /* also where forces put all nodes back where they were, as with the state of a run that goes on */
  PetscCall(Destroy(&start));
  PetscFunctionReturn(PETSC_SUCCESS);
}
