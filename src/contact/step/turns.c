/* Turns of gaps in the contact step, with which forces have the same sum along the normals of both sides of a pair
   (src/interface/balance.c): a turn t opens gaps by L t, and forces fulfil C^T lambda = 0. L is a mean of C and of what it was in the step
   before.

   For the law of rows a turn is one more body between the surfaces, which is soft: t = t_0 + W C^T lambda. So S has L W C^T beside the
   blocks of bodies. This part is exact in every pass, since t is computed from the forces under which bodies are advanced; it is not
   symmetric. A pass solves the law a few times, each time with the t of the last solution as t_0, until C^T lambda is zero: that is the
   method of multipliers. A softer turn would need no repetition, but round-off of forces would move gaps by as much more.

   A set of rows whose c have all one sign cannot have a force: the turn grows until another row joins. Where that would take it beyond the
   edge of an element, since forces press nodes deep into the partner that would spring back without them, the step is made without turns
   of the pair, and again with the rows that a turn could close. Where there is no such row, it stays without turns. */
#include "stepimpl.h"

/* The stiffness of a turn, in parts of that of the pair's bodies against it: each solution of the law leaves this part of C^T lambda */
#define SOFT 1e-2
/* C^T lambda is zero where a turn changes gaps by less than this part of what forces do: these are right to 1e-13, by SOFT to 1e-11. */
#define BALANCED 1e-10
#define ROUNDS   30    /* solutions of the law beyond one in each pass, in all passes together: then t_0 stays, so that passes end */
#define PUSHES   1e-10 /* W is that of rows with at least this part of the largest force, */
#define OTHER    4     /* and changes by at least this factor */
#define PARALLEL 1e-3  /* least mean c that W is made of [rad]: flatter surfaces are turned less */
/* Turn of a pair in contact, at most [edges of an element, of the coarser body]. Nodes lie half an edge of a face off the place where
   surfaces meet, and faces may be larger than the mean element. */
#define LARGEST 2.0

#define AXES 2 /* turns of a pair in space; rows of one in the plane have zeros for the second */

static PetscInt CountTurns(Contact contact, PetscInt p)
{
  return contact->turns.begin[p + 1] - contact->turns.begin[p];
}

PetscErrorCode ContactStepperSetUpTurns(Contact contact, ContactStepper *stepper)
{
  const PetscInt n_all = contact->turns.n ? contact->rows.n_all : 0;
  StepperTurns  *turns = &stepper->turns;

  PetscFunctionBegin;
  PetscCall(PetscCalloc5(contact->n_pairs, &turns->fixed, contact->n_pairs, &turns->joined, contact->n_pairs, &turns->softness,
                         contact->turns.n, &turns->start, contact->turns.n, &turns->read));
  PetscCall(PetscCalloc4(AXES * n_all, &turns->uneven, AXES * n_all, &turns->lever, contact->rows.n_all, &turns->own, contact->rows.n_all,
                         &turns->shift));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether turns suit the step, before it is set up: nodes with mass have another rule, whose rows are not closed at its end */
PetscBool ContactStepperMayTurn(Contact contact)
{
  PetscBool may = (PetscBool)(Stepper(contact)->asked != &ContactRuleImpulse);

  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt side = 0; side < (contact->pairs[p].obstacle ? 1 : 2) && may; side++)
      may = (PetscBool)!ContactNeedsImpulse(contact, contact->pairs[p].body[side]);
  return may;
}

/* At the start of a step all pairs may be turned, and none is */
PetscErrorCode ContactStepperBeginTurns(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(stepper->turns.fixed, contact->n_pairs));
  PetscCall(PetscArrayzero(stepper->turns.joined, contact->n_pairs));
  PetscCall(PetscArrayzero(stepper->turns.start, contact->turns.n));
  PetscCall(ContactTurn(contact, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* W for a pair, by the c of its touching rows, or of those with a force */
static PetscReal Softness(Contact contact, const ContactStepper *stepper, PetscInt p, const PetscScalar force[])
{
  const PetscReal *uneven  = stepper->turns.uneven;
  PetscReal        squares = 0, least = 0;
  PetscInt         count = 0;

  if (!CountTurns(contact, p)) return 0;
  for (PetscInt i = 0; i < stepper->problem.n && force; i++)
    if (contact->ranks.row_pair[stepper->rows[i]] == p) least = PetscMax(least, PUSHES * PetscRealPart(force[i]));
  for (PetscInt i = 0; i < stepper->problem.n; i++) {
    if (contact->ranks.row_pair[stepper->rows[i]] != p || (force && !(PetscRealPart(force[i]) > least))) continue;
    squares += PetscSqr(uneven[AXES * i]) + PetscSqr(uneven[AXES * i + 1]);
    count++;
  }
  return 1 / (SOFT * contact->turns.stiffness[p] * PetscMax(squares / PetscMax(count, 1), PetscSqr(PARALLEL)));
}

/* Brings C and L of the touching rows to all ranks; what turns give by */
PetscErrorCode ContactStepperListTurns(Contact contact, ContactStepper *stepper)
{
  StepperTurns  *turns = &stepper->turns;
  const PetscInt n     = stepper->problem.n;

  PetscFunctionBegin;
  if (!contact->turns.n) PetscFunctionReturn(PETSC_SUCCESS);
  turns->rounds      = 0;
  stepper->assembled = -1; /* with other C, L and W */
  for (PetscInt k = 0; k < 2 * AXES; k++) {
    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      const ContactPair *pair  = &contact->pairs[p];
      const PetscInt     count = CountTurns(contact, p);
      const PetscReal   *values[2];

      PetscCall(TransferGetTurns(pair->transfer, NULL, &values[0], &values[1], NULL));
      for (PetscInt i = pair->begin; i < pair->end; i++)
        stepper->mine[i] = k / 2 < count ? values[k % 2][count * (i - pair->begin) + k / 2] : 0;
    }
    PetscCall(ContactStepperGather(contact, stepper, stepper->mine, stepper->gathered));
    for (PetscInt i = 0; i < n; i++) (k % 2 ? turns->lever : turns->uneven)[AXES * i + k / 2] = PetscRealPart(stepper->gathered[i]);
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) turns->softness[p] = turns->fixed[p] ? 0 : Softness(contact, stepper, p, NULL);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds L W C^T to S, whose bodies have entries there */
PetscErrorCode ContactStepperAddTurns(Contact contact, ContactStepper *stepper, Mat S)
{
  StepperTurns  *turns = &stepper->turns;
  const PetscInt n     = stepper->problem.n;

  PetscFunctionBegin;
  if (!contact->turns.n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < n; j++) {
    const PetscInt p = contact->ranks.row_pair[stepper->rows[j]];

    for (PetscInt i = 0; i < n; i++) {
      PetscReal value = 0;

      if (contact->ranks.row_pair[stepper->rows[i]] != p) continue;
      for (PetscInt a = 0; a < AXES; a++) value += turns->softness[p] * turns->lever[AXES * i + a] * turns->uneven[AXES * j + a];
      PetscCall(MatSetValue(S, i, j, value, ADD_VALUES));
      if (i == j) turns->own[i] = value;
    }
  }
  PetscCall(MatAssemblyBegin(S, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(S, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* t_0 + W C^T lambda of a pair by forces on touching rows of all ranks */
static void FindTurn(Contact contact, const ContactStepper *stepper, PetscInt p, const PetscScalar force[], PetscReal turn[])
{
  const StepperTurns *turns = &stepper->turns;

  for (PetscInt a = 0; a < CountTurns(contact, p); a++) {
    turn[a] = 0;
    for (PetscInt i = 0; i < stepper->problem.n; i++)
      if (contact->ranks.row_pair[stepper->rows[i]] == p) turn[a] += turns->uneven[AXES * i + a] * PetscRealPart(force[i]);
    turn[a] = turns->start[contact->turns.begin[p] + a] + turns->softness[p] * turn[a];
  }
}

/* Before a pass: gaps are turned by the forces of which `base` has those of the touching rows */
PetscErrorCode ContactStepperTurn(Contact contact, ContactStepper *stepper)
{
  StepperTurns *turns = &stepper->turns;

  PetscFunctionBegin;
  if (!contact->turns.n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    FindTurn(contact, stepper, p, stepper->problem.base, turns->read + contact->turns.begin[p]);
  PetscCall(PetscArrayzero(turns->shift, stepper->problem.n));
  PetscCall(ContactTurn(contact, turns->read));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much a touching row of a pair would read more with other turns [m] */
static PetscReal More(Contact contact, const ContactStepper *stepper, PetscInt p, const PetscReal to[], PetscInt i)
{
  const StepperTurns *turns = &stepper->turns;
  PetscReal           more  = 0;

  for (PetscInt a = 0; a < CountTurns(contact, p) && contact->ranks.row_pair[stepper->rows[i]] == p; a++)
    more += turns->lever[AXES * i + a] * (to[a] - turns->read[contact->turns.begin[p] + a]);
  return more;
}

/* Lets the touching rows of a pair read what they would have read with other turns */
static void TurnRead(Contact contact, ContactStepper *stepper, PetscInt p, const PetscReal to[])
{
  StepperTurns *turns = &stepper->turns;

  for (PetscInt i = 0; i < stepper->problem.n; i++) {
    const PetscReal more = More(contact, stepper, p, to, i);

    stepper->problem.read[i] += more;
    turns->shift[i] += more;
  }
  for (PetscInt a = 0; a < CountTurns(contact, p); a++) turns->read[contact->turns.begin[p] + a] = to[a];
}

/* Whether forces are balanced: the turns that have been found would change gaps by little beside what forces do */
static PetscBool IsBalanced(Contact contact, const ContactStepper *stepper, PetscInt p, const PetscReal turn[])
{
  const StepperTurns *turns = &stepper->turns;
  const PetscReal    *start = turns->start + contact->turns.begin[p];
  PetscReal           most = 0, way = 0, to[AXES];

  for (PetscInt a = 0; a < CountTurns(contact, p); a++) to[a] = turns->read[contact->turns.begin[p] + a] + turn[a] - start[a];
  for (PetscInt i = 0; i < stepper->problem.n; i++) {
    if (contact->ranks.row_pair[stepper->rows[i]] != p) continue;
    most = PetscMax(most, PetscAbsReal(More(contact, stepper, p, to, i)));
    way  = PetscMax(way, PetscAbsScalar((stepper->problem.diagonal[i] - turns->own[i]) * stepper->problem.force[i]));
  }
  return (PetscBool)(most <= BALANCED * way);
}

/* The law is to be solved once more for a pair, by other turns from which C^T lambda is less. W becomes that of the rows that push. */
static void StartFrom(Contact contact, ContactStepper *stepper, PetscInt p, const PetscReal turn[])
{
  StepperTurns   *turns    = &stepper->turns;
  const PetscReal softness = Softness(contact, stepper, p, stepper->problem.force);
  PetscReal       to[AXES];

  for (PetscInt a = 0; a < CountTurns(contact, p); a++) turns->start[contact->turns.begin[p] + a] = turn[a];
  if (softness > OTHER * turns->softness[p] || turns->softness[p] > OTHER * softness) {
    turns->softness[p] = softness;
    stepper->assembled = -1;
  }
  FindTurn(contact, stepper, p, stepper->problem.base, to);
  TurnRead(contact, stepper, p, to);
}

/* Whether the law is to be solved again: without turns of pairs turned too far, of all if there was no solution; S changes then. */
PetscErrorCode ContactStepperImproveTurns(Contact contact, ContactStepper *stepper, PetscBool *again)
{
  StepperTurns   *turns      = &stepper->turns;
  const PetscReal none[AXES] = {0};

  PetscFunctionBegin;
  *again = PETSC_FALSE;
  for (PetscInt p = 0; p < contact->n_pairs && contact->turns.n; p++) {
    const PetscInt n          = CountTurns(contact, p);
    PetscReal      last[AXES] = {0}, turn[AXES] = {0}, square = 0;

    if (!n || turns->fixed[p]) continue;
    PetscCall(TransferGetTurns(contact->pairs[p].transfer, NULL, NULL, NULL, last));
    FindTurn(contact, stepper, p, stepper->problem.force, turn);
    for (PetscInt a = 0; a < n; a++) square += PetscSqr(last[a] + turn[a]);
    if (stepper->problem.solved && square <= PetscSqr(LARGEST * contact->turns.edge[p])) {
      if (turns->rounds >= ROUNDS || IsBalanced(contact, stepper, p, turn)) continue;
      StartFrom(contact, stepper, p, turn);
      *again = PETSC_TRUE;
      continue;
    }
    turns->fixed[p] = *again = PETSC_TRUE;
    turns->softness[p]       = 0;
    stepper->assembled       = -1;
    PetscCall(PetscArrayzero(turns->start + contact->turns.begin[p], n));
    TurnRead(contact, stepper, p, none);
    PetscCall(PetscInfo(contact, "gaps of %s are not turned in this step: %s\n", contact->pairs[p].name,
                        stepper->problem.solved ? "they would be too far" : "the law has no solution then"));
  }
  turns->rounds += *again;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Pairs that are not turned in this step: it is made again, once, with all rows that a turn could close, from one end to the other */
PetscErrorCode ContactStepperJoinTurned(Contact contact, ContactStepper *stepper, PetscBool *more)
{
  StepperTurns *turns = &stepper->turns;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs && contact->turns.n; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const PetscInt     n    = CountTurns(contact, p);
    const PetscReal   *uneven;
    PetscBool          joined = PETSC_FALSE;

    if (!turns->fixed[p] || turns->joined[p]) continue;
    PetscCall(TransferGetTurns(pair->transfer, NULL, &uneven, NULL, NULL));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      PetscReal square = 0;

      for (PetscInt k = 0; k < n; k++) square += PetscSqr(uneven[n * (i - pair->begin) + k]);
      if (stepper->touches[i] || !contact->rows.opposite[i]) continue;
      if (2 * LARGEST * contact->turns.edge[p] * PetscSqrtReal(square) <= contact->end.gap[i]) continue;
      stepper->touches[i] = stepper->joins[i] = joined = PETSC_TRUE;
    }
    PetscCall(ContactOr(contact, &joined));
    turns->joined[p] = PETSC_TRUE;
    turns->fixed[p]  = (PetscBool)!joined;
    PetscCall(PetscInfo(contact, "gaps of %s that are not turned: %s\n", pair->name,
                        joined ? "rows join, and they are again" : "there is no row to join"));
    *more = (PetscBool)(*more || joined);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
