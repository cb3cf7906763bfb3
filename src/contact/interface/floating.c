/* Controller steps of static bodies that contact or ties alone hold. Such a body has artificial springs (src/body/system/springs.c), with
   which the method makes its step as with any other body. The step is made again with the springs at rest where the body has come to, until
   they do not pull: that is the step without springs. Whatever the method, and whatever it does in a step, is the same each time.

   Springs are moved by their stretch, at least. Where contact resists little, that is slow. So a stretch that is a sum of changes which
   earlier moves have brought is undone by the same sum of moves, and the rest is moved by its stretch (Anderson 1965): a linear problem
   takes as many times as there are springs. Where the stretch grows, as it may where the active set changes, this starts anew after
   some moves by the stretch alone, which never make it grow.

   A stretch that does not change is that of a body which nothing resists: it falls until it lands. Then it leaps, farther each time, and
   without turning: springs beside its middle would tilt it. */
#include <contact/parts.h>

/* Times that a step is made: 3 to 6 are enough for most */
#define MAX_TIMES 200
/* Springs do not pull where their stretch is below this part of the displacements that they pull at. Nor do they where round-off of contact
   forces is left: their forces are below REST_FORCE of the largest ones on a body, and their stretch has not fallen for STALLS times and is
   below STRETCH_ATOL times the tolerance on positions, or has not fallen for LONG_STALLS times */
#define STRETCH_RTOL 1e-12
#define STRETCH_ATOL 10
#define REST_FORCE   3e-9
#define STALLS       3
#define LONG_STALLS  10
/* A stretch above this part of the least one so far does not fall */
#define FALLS 0.5
/* One that changes by less than this part of it is steady; each leap is so many times longer than the last one */
#define STEADY 1e-3
#define LONGER 8
/* Times with moves by the stretch alone after it has grown: two at first, then twice as many each time it grows, up to so many */
#define MOST_PATIENCE 8
/* Moves that are remembered; what is left of a change after those before have been taken out of it, below which it has nothing new */
#define MOST_KNOWN  24
#define NOTHING_NEW 1e-4
/* A leap strains a nonlinear body by no more than this if the springs hold it where it is not */
#define LARGE_STRAIN 0.1
/* A body whose stretch has less of a translation, in parts of it, turns in its leap */
#define TURNS 0.1
/* Way of a body, in parts of its size, after which nothing is thought to hold it */
#define FAR           100
#define FAR_NONLINEAR 0.5

/* Springs of bodies that contact alone holds are as soft beside the softest of all static bodies as beside their own: a stiff body that
   lies on a soft one has to sink in as far as that gives way. Before matrices are made. */
PetscErrorCode ContactSetUpSprings(Contact contact)
{
  PetscReal least = PETSC_MAX_REAL;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const Body body = contact->bodies[b];
    PetscReal  stiffness;

    if (!BodyDoes(body, BodyIsStatic) || BodyDoes(body, BodyIsRigid)) continue;
    PetscCall(BodyGetLeastStiffness(body, &stiffness));
    least = PetscMin(least, stiffness);
  }
  for (PetscInt b = 0; b < contact->n_bodies && least < PETSC_MAX_REAL; b++) PetscCall(BodySetSpringStiffness(contact->bodies[b], least));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactSetUpFloating(Contact contact)
{
  ContactFloating *f = &contact->floating;
  const PetscInt   n = contact->n_bodies;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(n, &f->bodies, n, &f->forces));
  for (PetscInt b = 0; b < n; b++) {
    if (!BodyDoes(contact->bodies[b], BodyIsFloating)) continue;
    PetscCall(BodyMeasureSprings(contact->bodies[b], &f->bodies[f->n].state));
    f->bodies[f->n].body  = b;
    f->bodies[f->n].begin = f->n_springs;
    f->n_springs += f->bodies[f->n++].state.n;
  }
  if (!f->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc3(f->n_springs, &f->stretch, f->n_springs, &f->last, f->n_springs, &f->move));
  PetscCall(PetscCalloc2(MOST_KNOWN * f->n_springs, &f->changes, MOST_KNOWN * f->n_springs, &f->moves));
  PetscCall(PetscCalloc2(contact->rows.n, &f->start_force, contact->rows.n, &f->start_active));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyFloating(Contact contact)
{
  ContactFloating *f = &contact->floating;

  PetscFunctionBegin;
  PetscCall(PetscFree2(f->bodies, f->forces));
  PetscCall(PetscFree3(f->stretch, f->last, f->move));
  PetscCall(PetscFree2(f->changes, f->moves));
  PetscCall(PetscFree2(f->start_force, f->start_active));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest sum of the sizes of the contact forces on a body [N] */
static PetscErrorCode FindLargestForce(Contact contact, PetscReal *largest)
{
  PetscReal *forces = contact->floating.forces;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(forces, contact->n_bodies));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];

    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) forces[pair->body[side]] += PetscAbsReal(contact->end.force[i]);
  }
  PetscCall(ContactReduce(contact, contact->n_bodies, MPIU_REAL, MPIU_SUM, forces));
  *largest = 0;
  for (PetscInt b = 0; b < contact->n_bodies; b++) *largest = PetscMax(*largest, forces[b]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How the springs of a body are stretched under contact forces of that size; whether they have come to rest */
static PetscErrorCode Measure(Contact contact, ContactSprings *springs, PetscInt times, PetscReal force, PetscBool *rest)
{
  const PetscReal  atol    = STRETCH_ATOL * CONTACT_POSITION_TOLERANCE * contact->scale.length;
  const Body       body    = contact->bodies[springs->body];
  BodySpringState *state   = &springs->state;
  PetscReal       *stretch = contact->floating.stretch + springs->begin, *last = contact->floating.last + springs->begin;
  PetscReal        most = 0, square = 0, last_square = 0, change = 0, least;
  char             motion[128];

  PetscFunctionBegin;
  PetscCall(BodyMeasureSprings(body, state));
  PetscCall(PetscArraycpy(last, stretch, state->n));
  PetscCall(PetscArraycpy(stretch, state->stretch, state->n));
  for (PetscInt i = 0; i < state->n; i++) {
    most = PetscMax(most, PetscAbsReal(stretch[i]));
    square += PetscSqr(stretch[i]);
    last_square += PetscSqr(last[i]);
    change += PetscSqr(stretch[i] - last[i]);
  }
  least           = force > 0 ? REST_FORCE * force / state->stiffness : atol;
  springs->stalls = times && square > PetscSqr(FALLS) * springs->least ? springs->stalls + 1 : 0;
  springs->least  = times ? PetscMin(springs->least, square) : square;
  *rest           = (PetscBool)(most <= STRETCH_RTOL * state->displacement ||
                                (most <= least && springs->stalls >= (most <= atol ? STALLS : LONG_STALLS)));
  springs->falls  = (PetscBool)(times && most > least && change < PetscSqr(STEADY) * last_square);
  if (square < PetscSqr(FALLS) * springs->steady) springs->leap = 1; /* it has landed */
  if (springs->falls) {
    springs->leap *= LONGER;
    springs->steady = square;
  }
  if (!*rest && springs->stalls &&
      state->way > (state->linear ? FAR : FAR_NONLINEAR) * state->size) { /* what drives it does not get less */
    PetscCall(BodyDescribeDrift(body, sizeof(motion), motion));
    SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
            "Body '%s' is static, and neither contact nor ties hold it in the step from time %.9g s: a load, or the push of its partners, "
            "makes it %s, and nothing stops that; hold it with -%s_boundary_displacement, or let friction or ties do it",
            ((PetscObject)body)->name, (double)contact->floating.time, motion, ((PetscObject)body)->name);
  }
  PetscCall(PetscInfo(contact, "body '%s': springs stretched by %g m after a way of %g m, step made %" PetscInt_FMT " times\n",
                      ((PetscObject)body)->name, (double)most, (double)state->way, times + 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Dot(PetscInt n, const PetscReal a[], const PetscReal b[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* b += factor a */
static void Add(PetscInt n, PetscReal factor, const PetscReal a[], PetscReal b[])
{
  for (PetscInt i = 0; i < n; i++) b[i] += factor * a[i];
}

/* The last move and the change that it has brought: what is new in them, so that changes are an orthonormal basis. Of a stretch that is
   steady they are round-off, or the way of a body that falls. */
static PetscErrorCode Learn(ContactFloating *f)
{
  const PetscInt n      = f->n_springs;
  PetscReal     *change = f->changes + f->n_known * n, *move = f->moves + f->n_known * n, size, norm;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(move, f->move, n));
  PetscCall(PetscArraycpy(change, f->stretch, n));
  Add(n, -1, f->last, change);
  size = PetscSqrtReal(Dot(n, change, change));
  for (PetscInt j = 0; j < f->n_known; j++) {
    const PetscReal part = Dot(n, change, f->changes + j * n);

    Add(n, -part, f->changes + j * n, change);
    Add(n, -part, f->moves + j * n, move);
  }
  norm = PetscSqrtReal(Dot(n, change, change));
  if (norm <= NOTHING_NEW * size || size <= STEADY * PetscSqrtReal(Dot(n, f->last, f->last))) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < n; i++) {
    change[i] /= norm;
    move[i] /= norm;
  }
  f->n_known++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body falls by the translation that its springs tell of, as far as the last leap and farther */
static PetscErrorCode Leap(ContactFloating *f, const ContactSprings *springs)
{
  const BodySpringState *state   = &springs->state;
  const PetscReal        longest = state->linear ? PETSC_INFINITY : LARGE_STRAIN * state->size / state->part;
  const PetscReal       *way     = state->falls;

  PetscFunctionBegin;
  if (Dot(state->n, way, way) < PetscSqr(TURNS) * Dot(state->n, state->stretch, state->stretch)) way = state->stretch;
  PetscCall(PetscArrayzero(f->move + springs->begin, state->n));
  Add(state->n, PetscMax(1, PetscMin(springs->leap, longest / PetscSqrtReal(Dot(state->n, way, way)))), way, f->move + springs->begin);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The next move: by the stretch, which is undone as far as it is known how, or by a leap */
static PetscErrorCode FindMove(ContactFloating *f, PetscBool moved)
{
  const PetscInt  n     = f->n_springs;
  const PetscBool grows = (PetscBool)(Dot(n, f->stretch, f->stretch) > Dot(n, f->last, f->last));

  PetscFunctionBegin;
  if (grows && f->n_known && !f->leapt) {
    f->plain    = f->patience;
    f->patience = PetscMin(2 * f->patience, MOST_PATIENCE);
  }
  if (grows || f->leapt || f->n_known == MOST_KNOWN) f->n_known = 0;
  else if (moved && !f->plain) PetscCall(Learn(f));
  if (f->plain) f->plain--;
  PetscCall(PetscArraycpy(f->move, f->stretch, n));
  for (PetscInt j = 0; j < f->n_known; j++) {
    const PetscReal part = Dot(n, f->stretch, f->changes + j * n);

    Add(n, -part, f->changes + j * n, f->move);
    Add(n, -part, f->moves + j * n, f->move);
  }
  f->leapt = PETSC_FALSE;
  for (PetscInt k = 0; k < f->n; k++) {
    if (!f->bodies[k].falls) continue;
    PetscCall(Leap(f, &f->bodies[k]));
    f->leapt = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The step of the method, from where contact has been the last time */
static PetscErrorCode MakeStep(Contact contact, PetscBool first)
{
  const PetscBool again = contact->energy.again;

  PetscFunctionBegin;
  if (!first) {
    PetscCall(PetscArraycpy(contact->start.force, contact->end.force, contact->rows.n));
    PetscCall(PetscArraycpy(contact->start.active, contact->end.active, contact->rows.n));
  }
  contact->energy.again = (PetscBool)(again || !first);
  PetscUseTypeMethod(contact, step);
  PetscCall(ContactCompleteBodies(contact));
  contact->energy.again = again;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The step from the saved states with springs at rest there; then as often as they pull */
static PetscErrorCode MakeStepOfFloating(Contact contact)
{
  ContactFloating *f    = &contact->floating;
  PetscBool        rest = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(ContactGetTime(contact, &f->time));
  f->n_known = f->plain = 0;
  f->patience           = 2;
  f->leapt              = PETSC_FALSE;
  for (PetscInt k = 0; k < f->n; k++) {
    f->bodies[k].leap   = 1;
    f->bodies[k].steady = 0;
    PetscCall(BodyResetSprings(contact->bodies[f->bodies[k].body]));
  }
  for (PetscInt times = 0; times < MAX_TIMES && !rest; times++) {
    PetscReal force = 0;

    PetscCall(MakeStep(contact, (PetscBool)(times == 0)));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(FindLargestForce(contact, &force));
    rest = PETSC_TRUE;
    for (PetscInt k = 0; k < f->n; k++) {
      PetscBool rests = PETSC_FALSE;

      PetscCall(Measure(contact, &f->bodies[k], times, force, &rests));
      rest = (PetscBool)(rest && rests);
    }
    if (rest) break;
    PetscCall(FindMove(f, (PetscBool)(times > 0)));
    for (PetscInt k = 0; k < f->n; k++) PetscCall(BodyMoveSprings(contact->bodies[f->bodies[k].body], f->move + f->bodies[k].begin));
  }
  if (!rest)
    PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                             "Static bodies that contact or ties alone hold have not come to rest in the step from time %.9g s, which has "
                             "been made %d times: -info tells of their springs. Choose a smaller -time_step, or prescribe displacements",
                             (double)f->time, MAX_TIMES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The method's step, as often as floating bodies need it */
PetscErrorCode ContactMakeStep(Contact contact)
{
  ContactFloating *f = &contact->floating;

  PetscFunctionBegin;
  if (!f->n) {
    PetscCall(MakeStep(contact, PETSC_TRUE));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscArraycpy(f->start_force, contact->start.force, contact->rows.n));
  PetscCall(PetscArraycpy(f->start_active, contact->start.active, contact->rows.n));
  PetscCall(MakeStepOfFloating(contact));
  PetscCall(PetscArraycpy(contact->start.force, f->start_force, contact->rows.n));
  PetscCall(PetscArraycpy(contact->start.active, f->start_active, contact->rows.n));
  PetscFunctionReturn(PETSC_SUCCESS);
}
