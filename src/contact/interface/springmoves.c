/* How the springs of floating bodies are moved after a step: by their stretch, to where the bodies have come, at least. Where contact
   resists little, that is slow. So a stretch that is a sum of changes which earlier moves have brought is undone by the same sum of moves,
   and the rest is moved by its stretch (Anderson 1965): a linear problem takes as many times as there are springs. Where the stretch grows,
   as it may where the active set changes, this starts anew after some moves by the stretch alone, which never make it grow.

   A stretch that does not change is that of a body which nothing resists: it falls until it lands. Then the springs leap by its size, and
   farther the next time. */
#include "floating.h"
#include <impakt/private/bodyfloating.h>

/* What is left of a change after those before have been taken out of it, below which it has nothing new */
#define NOTHING_NEW 1e-4
/* Times without earlier moves after the stretch has grown: two at first, then twice as many each time it grows, up to so many */
#define MOST_PATIENCE 8
/* Times in a row that the stretch of a body has been steady, before its springs leap; growth from leap to leap. The first would strain a
   held body by FIRST_STRAIN, and none of a nonlinear body is longer than for LARGE_STRAIN. */
#define STEADY_TIMES 3
#define LONGER       8
#define FIRST_STRAIN 1e-2
#define LARGE_STRAIN 0.04
/* A row lies ahead of a body that falls where the cosine between both ways is larger */
#define AHEAD 0.01

static PetscReal Dot(PetscInt n, const PetscReal a[], const PetscReal b[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

static void Add(PetscInt n, PetscReal factor, const PetscReal a[], PetscReal b[])
{
  for (PetscInt i = 0; i < n; i++) b[i] += factor * a[i];
}

static void Scale(PetscInt n, PetscReal factor, PetscReal a[])
{
  for (PetscInt i = 0; i < n; i++) a[i] *= factor;
}

/* The last move and what it has brought; the oldest one is forgotten */
static PetscErrorCode Remember(ContactFloating *f)
{
  const PetscInt n = f->n_springs;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(f->moves + f->n_history * n, f->move, n));
  PetscCall(PetscArraycpy(f->changes + f->n_history * n, f->stretch, n));
  Add(n, -1, f->last, f->changes + f->n_history * n);
  f->n_history++;
  if (f->n_history > SPRINGS_HISTORY) {
    f->n_history--;
    PetscCall(PetscArraymove(f->moves, f->moves + n, f->n_history * n));
    PetscCall(PetscArraymove(f->changes, f->changes + n, f->n_history * n));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The next move, from what is remembered: changes as an orthonormal basis, the last ones first, and the moves that bring them */
static PetscErrorCode Extrapolate(ContactFloating *f)
{
  const PetscInt n     = f->n_springs;
  PetscInt       count = 0;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(f->move, f->stretch, n));
  for (PetscInt k = f->n_history - 1; k >= 0; k--) {
    PetscReal *basis = f->basis + count * n, *direction = f->directions + count * n, norm, part;

    PetscCall(PetscArraycpy(basis, f->changes + k * n, n));
    PetscCall(PetscArraycpy(direction, f->moves + k * n, n));
    norm = PetscSqrtReal(Dot(n, basis, basis));
    if (norm == 0) continue;
    Scale(n, 1 / norm, basis);
    Scale(n, 1 / norm, direction);
    for (PetscInt j = 0; j < count; j++) {
      part = Dot(n, basis, f->basis + j * n);
      Add(n, -part, f->basis + j * n, basis);
      Add(n, -part, f->directions + j * n, direction);
    }
    norm = PetscSqrtReal(Dot(n, basis, basis));
    if (norm < NOTHING_NEW) continue;
    Scale(n, 1 / norm, basis);
    Scale(n, 1 / norm, direction);
    part = Dot(n, basis, f->stretch);
    Add(n, -part, basis, f->move);
    Add(n, -part, direction, f->move);
    count++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far the springs of a body may be moved at most to strain it so much, if they hold it where it is not [m] */
static PetscReal LengthOfStrain(const BodySpringState *state, PetscReal strain)
{
  return strain * state->size / state->part;
}

/* A move of other than the stretch that is longer than a leap is none that earlier moves tell of */
static PetscErrorCode DropLong(ContactFloating *f)
{
  PetscBool too_long = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < f->n; k++)
    for (PetscInt i = 0; i < f->states[k].n; i++) {
      const PetscInt at = f->bodies[k].begin + i;

      if (PetscAbsReal(f->move[at]) <= PetscAbsReal(f->stretch[at])) continue;
      if (PetscAbsReal(f->move[at]) > f->root[at] * LengthOfStrain(&f->states[k], LARGE_STRAIN)) too_long = PETSC_TRUE;
    }
  if (!too_long) PetscFunctionReturn(PETSC_SUCCESS);
  f->n_history = 0;
  PetscCall(PetscArraycpy(f->move, f->stretch, f->n_springs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cosine between the way on which a body falls and the one to its partner in a row */
static PetscReal Ahead(Contact contact, PetscInt i, const ContactPair *pair, PetscInt body, const PetscReal fall[])
{
  const PetscReal *normal = contact->rows.normal + 3 * i, length = PetscSqrtReal(Dot(3, fall, fall));

  return length > 0 ? (pair->body[0] == body ? 1 : -1) * Dot(3, fall, normal) / length : 0;
}

/* -1 for bodies that are held, or in contact with something that is, directly or by others; else 0 */
static PetscErrorCode FindHeld(Contact contact, PetscReal held[])
{
  const ContactFloating *f       = &contact->floating;
  PetscBool              changes = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) held[b] = -1;
  for (PetscInt k = 0; k < f->n; k++) held[f->bodies[k].body] = 0;
  while (changes) {
    PetscReal before = 0, after = 0;

    for (PetscInt b = 0; b < contact->n_bodies; b++) before += held[b];
    for (PetscInt i = 0; i < contact->rows.n; i++) {
      const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];

      if (!contact->end.active[i]) continue;
      if (pair->obstacle) held[pair->body[0]] = -1;
      else held[pair->body[0]] = held[pair->body[1]] = PetscMin(held[pair->body[0]], held[pair->body[1]]);
    }
    if (contact->ranks.size > 1)
      PetscCallMPI(
          MPI_Allreduce(MPI_IN_PLACE, held, (PetscMPIInt)contact->n_bodies, MPIU_REAL, MPIU_MIN, PetscObjectComm((PetscObject)contact)));
    for (PetscInt b = 0; b < contact->n_bodies; b++) after += held[b];
    changes = (PetscBool)(after < before);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For each floating body the smallest gap of the rows ahead of it as it falls [m], 0 in contact; PETSC_MAX_REAL: none */
static PetscErrorCode FindGaps(Contact contact, PetscReal gaps[])
{
  ContactFloating *f = &contact->floating;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < f->n; k++) {
    const PetscInt b = f->bodies[k].body;

    gaps[b] = PETSC_MAX_REAL;
    for (PetscInt i = 0; i < contact->rows.n; i++) {
      const ContactPair *pair  = &contact->pairs[contact->rows.pair[i]];
      const PetscBool    holds = (PetscBool)(contact->end.active[i] && (contact->rows.tied[i] || pair->components > 1));

      if ((pair->body[0] != b && (pair->obstacle || pair->body[1] != b)) || !contact->rows.opposite[i]) continue;
      if (holds) gaps[b] = 0;
      else if ((i - pair->begin) % pair->components == 0 && Ahead(contact, i, pair, b, f->states[k].fall) > AHEAD)
        gaps[b] = PetscMin(gaps[b], contact->end.active[i] ? 0 : PetscMax(contact->end.gap[i], 0));
    }
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, gaps, (PetscMPIInt)contact->n_bodies, MPIU_REAL, MPIU_MIN, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bodies that fall freely leap: one that nothing holds by the gap ahead of it, as it is, others the farther the longer they fall */
static PetscErrorCode Leap(Contact contact)
{
  ContactFloating *f = &contact->floating;

  PetscFunctionBegin;
  PetscCall(FindGaps(contact, f->work));
  PetscCall(FindHeld(contact, f->held));
  for (PetscInt k = 0; k < f->n; k++) {
    const BodySpringState *state   = &f->states[k];
    ContactSprings        *springs = &f->bodies[k];
    const PetscReal       *stretch = f->stretch + springs->begin, *root = f->root + springs->begin;
    const PetscReal        gap  = f->work[springs->body];
    PetscReal             *move = f->move + springs->begin, leap;

    if (gap > 0 && gap < PETSC_MAX_REAL && f->held[springs->body] == 0) {
      for (PetscInt i = 0; i < state->n; i++) move[i] = root[i] * state->falls[i];
      Scale(state->n, PetscMax(1, gap / PetscSqrtReal(Dot(3, state->fall, state->fall))), move);
    } else if (springs->steady >= STEADY_TIMES) {
      leap = LengthOfStrain(state, FIRST_STRAIN) * PetscPowRealInt(LONGER, springs->leaps++);
      if (!state->linear) leap = PetscMin(leap, LengthOfStrain(state, LARGE_STRAIN));
      PetscCall(PetscArraycpy(move, stretch, state->n));
      Scale(state->n, PetscMax(1, root[0] * leap / PetscSqrtReal(Dot(state->n, stretch, stretch))), move);
    } else continue;
    springs->steady = 0;
    f->n_history    = 0;
    f->leapt        = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the springs of all bodies; `moved`: they have been moved in this step before */
PetscErrorCode SpringsMove(Contact contact, PetscBool moved)
{
  ContactFloating *f = &contact->floating;

  PetscFunctionBegin;
  if (moved && !f->leapt) {
    const PetscBool grown = (PetscBool)(Dot(f->n_springs, f->stretch, f->stretch) > Dot(f->n_springs, f->last, f->last));

    if (grown && f->n_history) {
      f->n_history = 0;
      f->plain     = f->patience;
      f->patience  = PetscMin(2 * f->patience, MOST_PATIENCE);
    } else PetscCall(Remember(f));
  }
  f->leapt = PETSC_FALSE;
  if (f->plain) {
    f->plain--;
    f->n_history = 0;
  }
  PetscCall(Extrapolate(f));
  PetscCall(DropLong(f));
  PetscCall(Leap(contact));
  for (PetscInt k = 0; k < f->n; k++) {
    PetscReal move[BODY_MAX_SPRINGS];

    for (PetscInt i = 0; i < f->states[k].n; i++) move[i] = f->move[f->bodies[k].begin + i] / f->root[f->bodies[k].begin + i];
    PetscCall(BodyMoveSprings(contact->bodies[f->bodies[k].body], move));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
