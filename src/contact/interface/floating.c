/*
   Controller steps of static bodies that contact or ties alone hold. Such a body has artificial springs (src/body/system/springs.c), with
   which the method makes its step as with any other body. The step is made again with the springs at rest where the body has come to, until
   they do not pull: that is the step without springs. Whatever the method, and whatever it does in a step, is the same each time.

   Where the stretch of a body does not fall much from one time to the next, and keeps its direction, its springs go on farther that way: to
   the limit of a stretch that falls by a constant ratio. Where that is far, as for a body that falls freely until it comes to what it lands
   on, they leap by its size, then by GROWTH times that, and so on. A body that has gone FAR times its size is held by nothing.
*/
#include <impakt/private/contactimpl.h>

/* Times that a step is made; 2 to 4 are enough where contact is not much softer than the bodies */
#define MAX_TIMES 200
/* Springs do not pull where their stretch is below this part of the displacements that they pull at; what is left of it in the
   displacements is smaller by the ratio of the stiffnesses, some 1e-3 */
#define STRETCH_RTOL 1e-10
/* or, where it does not get smaller any more, below so many times the tolerance on positions */
#define STRETCH_ATOL 10
/* A stretch that is above this part of the last one does not fall */
#define FALLS  0.5
#define GROWTH 8.0
#define FAR    100
/* Factors up to NEAR are taken at once. For larger ones MAX_WAITS times pass first, unless the factor is above FREE, for parts of the
   stretch that fall fast to be gone: they would grow by the factor. A stretch whose limit is then still above STEADY times what it is does
   not fall: what it changes by is round-off. */
#define NEAR      20
#define FREE      1e6
#define STEADY    1e3
#define MAX_WAITS 6
/* Cosine from which on two stretches have one direction */
#define ALONG 0.9

PetscErrorCode ContactSetUpFloating(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool floating;

    PetscCall(BodyIsFloating(contact->bodies[b], &floating));
    if (floating) contact->floating.n++;
  }
  if (!contact->floating.n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc1(contact->floating.n, &contact->floating.springs));
  PetscCall(PetscCalloc2(contact->rows.n, &contact->floating.start_force, contact->rows.n, &contact->floating.start_active));
  contact->floating.n = 0;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool floating;

    PetscCall(BodyIsFloating(contact->bodies[b], &floating));
    if (floating) contact->floating.springs[contact->floating.n++].body = b;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyFloating(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(contact->floating.springs));
  PetscCall(PetscFree2(contact->floating.start_force, contact->floating.start_active));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body that has gone far, driven by what does not get less */
static PetscErrorCode RefuseUnheld(Contact contact, Body body)
{
  const char *name = ((PetscObject)body)->name;
  char        motion[128];

  PetscFunctionBegin;
  PetscCall(BodyDescribeDrift(body, sizeof(motion), motion));
  SETERRQ(
      PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
      "Body '%s' is static, and neither contact nor ties hold it in the step from time %.9g s: a load, or the push of its partners, makes "
      "it %s, and nothing stops that; hold it with -%s_boundary_displacement, or let friction or ties do it",
      name, (double)contact->floating.time, motion, name);
}

/* How the springs of a body are moved next, from how they are stretched now */
static void ChooseFactor(const BodySpringState *state, ContactSprings *springs)
{
  const PetscReal norm = PetscSqrtReal(state->square), last_norm = PetscSqrtReal(state->last_square);
  const PetscReal change = PetscSqrtReal(PetscMax(state->square - 2 * state->product + state->last_square, 0));
  const PetscReal limit  = change > 0 ? springs->factor * last_norm / change : PETSC_MAX_REAL;
  const PetscReal leap   = state->size * PetscPowRealInt(GROWTH, springs->leaps) / norm;

  springs->factor = 1;
  if (last_norm == 0 || norm < FALLS * last_norm || state->product < ALONG * norm * last_norm) {
    springs->waits = 0;
    return;
  }
  if (limit > NEAR && limit < FREE && springs->waits < MAX_WAITS) {
    springs->waits++;
    return;
  }
  springs->waits  = 0;
  springs->factor = PetscMax(1, limit > STEADY ? leap : PetscMin(limit, leap));
  if (limit > PetscMin(leap, STEADY)) springs->leaps++;
}

/* Whether the springs of all bodies have come to rest; else they are moved */
static PetscErrorCode Move(Contact contact, PetscInt times, PetscBool *rest)
{
  const PetscReal atol = STRETCH_ATOL * CONTACT_POSITION_TOLERANCE * contact->scale.length;

  PetscFunctionBegin;
  *rest = PETSC_TRUE;
  for (PetscInt k = 0; k < contact->floating.n; k++) {
    const Body      body    = contact->bodies[contact->floating.springs[k].body];
    ContactSprings *springs = &contact->floating.springs[k];
    BodySpringState state;
    PetscBool       falls;

    PetscCall(BodyMeasureSprings(body, &state));
    falls = (PetscBool)(times == 0 || state.square <= PetscSqr(FALLS) * state.last_square);
    if (state.stretch > STRETCH_RTOL * state.displacement && (falls || state.stretch > atol)) *rest = PETSC_FALSE;
    if (!falls && state.way > FAR * state.size && state.stretch > atol) PetscCall(RefuseUnheld(contact, body));
    ChooseFactor(&state, springs);
    PetscCall(PetscInfo(contact, "body '%s': springs stretched by %g m after %g m, made %" PetscInt_FMT " times, moved by %g of it next\n",
                        ((PetscObject)body)->name, (double)state.stretch, (double)state.way, times + 1, (double)springs->factor));
  }
  for (PetscInt k = 0; k < contact->floating.n && !*rest; k++)
    PetscCall(BodyMoveSprings(contact->bodies[contact->floating.springs[k].body], contact->floating.springs[k].factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The step of the method, from where contact has been the last time; not its released rows, whose forces fade from where they were at the
   start */
static PetscErrorCode MakeStep(Contact contact, PetscBool first)
{
  const PetscBool again = contact->energy.again;

  PetscFunctionBegin;
  if (!first && !contact->release.fades) {
    PetscCall(PetscArraycpy(contact->start.force, contact->end.force, contact->rows.n));
    PetscCall(PetscArraycpy(contact->start.active, contact->end.active, contact->rows.n));
  }
  contact->energy.again = (PetscBool)(again || !first);
  PetscUseTypeMethod(contact, step);
  contact->energy.again = again;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The method's step, as often as floating bodies need it */
PetscErrorCode ContactMakeStep(Contact contact)
{
  ContactFloating *floating = &contact->floating;
  PetscBool        rest     = (PetscBool)!floating->n;
  PetscInt         times    = 0;
  TS               ts;

  PetscFunctionBegin;
  if (rest) {
    PetscUseTypeMethod(contact, step);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyGetTS(contact->bodies[floating->springs[0].body], &ts));
  PetscCall(TSGetTime(ts, &floating->time));
  for (PetscInt k = 0; k < floating->n; k++) {
    floating->springs[k] = (ContactSprings){.body = floating->springs[k].body, .factor = 1};
    PetscCall(BodyResetSprings(contact->bodies[floating->springs[k].body]));
  }
  PetscCall(PetscArraycpy(floating->start_force, contact->start.force, contact->rows.n));
  PetscCall(PetscArraycpy(floating->start_active, contact->start.active, contact->rows.n));
  while (!rest && times < MAX_TIMES) {
    PetscCall(MakeStep(contact, (PetscBool)(times == 0)));
    if (ContactFailed(contact)) break;
    PetscCall(Move(contact, times++, &rest));
  }
  PetscCall(PetscArraycpy(contact->start.force, floating->start_force, contact->rows.n));
  PetscCall(PetscArraycpy(contact->start.active, floating->start_active, contact->rows.n));
  if (!rest && !ContactFailed(contact))
    PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                             "Static bodies that contact or ties alone hold have not come to rest in the step from time %.9g s, which has "
                             "been made %d times; are their contact stiffnesses, or their shapes, far apart? A smaller "
                             "-<body>_artificial_stiffness makes fewer times do",
                             (double)floating->time, MAX_TIMES));
  PetscFunctionReturn(PETSC_SUCCESS);
}
