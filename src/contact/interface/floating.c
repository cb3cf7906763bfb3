/* Controller steps of static bodies that contact or ties alone hold. Such a body has artificial springs (src/body/system/springs.c), with
   which the method makes its step as with any other body. The step is made again with the springs at rest where the body has come to, until
   they do not pull: that is the step without springs. Whatever the method, and whatever it does in a step, is the same each time.
   src/contact/interface/springmoves.c has by how much the springs are moved. */
#include "floating.h"
#include <impakt/private/bodyfloating.h>

/* Times that a step is made: 3 to 12 are enough for most */
#define MAX_TIMES 200
/* Springs do not pull where their stretch is below this part of the displacements that they pull at */
#define STRETCH_RTOL 1e-12
/* Nor do they where round-off of contact forces is left: their forces are below REST_FORCE of those on a body, and their stretch has not
   fallen for MAX_STALLS times and is below STRETCH_ATOL times the tolerance on positions, or has not fallen for LONG_STALLS times */
#define STRETCH_ATOL 10
#define REST_FORCE   3e-9
#define MAX_STALLS   3
#define LONG_STALLS  10
/* A stretch above this part of the last one does not fall; where it may be round-off, above this part of its least value there */
#define FALLS 0.5
/* One that changes by less than this part of it is steady */
#define STEADY 1e-3
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
    PetscBool  is_static, rigid;
    PetscReal  stiffness;

    PetscCall(BodyIsStatic(body, &is_static));
    PetscCall(BodyIsRigid(body, &rigid));
    if (!is_static || rigid) continue;
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
  PetscCall(PetscCalloc4(n, &f->bodies, n, &f->states, n, &f->work, n, &f->held));
  for (PetscInt b = 0; b < n; b++) {
    PetscBool floating;

    PetscCall(BodyIsFloating(contact->bodies[b], &floating));
    if (!floating) continue;
    PetscCall(BodyMeasureSprings(contact->bodies[b], &f->states[f->n]));
    f->bodies[f->n] = (ContactSprings){.body = b, .begin = f->n_springs};
    f->n_springs += f->states[f->n++].n;
  }
  if (!f->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc4(f->n_springs, &f->root, f->n_springs, &f->stretch, f->n_springs, &f->last, f->n_springs, &f->move));
  PetscCall(PetscCalloc4((SPRINGS_HISTORY + 1) * f->n_springs, &f->moves, (SPRINGS_HISTORY + 1) * f->n_springs, &f->changes,
                         SPRINGS_HISTORY * f->n_springs, &f->basis, SPRINGS_HISTORY * f->n_springs, &f->directions));
  PetscCall(PetscCalloc2(contact->rows.n, &f->start_force, contact->rows.n, &f->start_active));
  for (PetscInt k = 0; k < f->n; k++)
    for (PetscInt i = 0; i < f->states[k].n; i++) f->root[f->bodies[k].begin + i] = PetscSqrtReal(f->states[k].stiffness);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyFloating(Contact contact)
{
  ContactFloating *f = &contact->floating;

  PetscFunctionBegin;
  PetscCall(PetscFree4(f->bodies, f->states, f->work, f->held));
  PetscCall(PetscFree4(f->root, f->stretch, f->last, f->move));
  PetscCall(PetscFree4(f->moves, f->changes, f->basis, f->directions));
  PetscCall(PetscFree2(f->start_force, f->start_active));
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

/* The largest sum of the sizes of the contact forces on a body [N] */
static PetscErrorCode FindLargestForce(Contact contact, PetscReal *largest)
{
  PetscReal *forces = contact->floating.work;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(forces, contact->n_bodies));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];

    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) forces[pair->body[side]] += PetscAbsReal(contact->end.force[i]);
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, forces, (PetscMPIInt)contact->n_bodies, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  *largest = 0;
  for (PetscInt b = 0; b < contact->n_bodies; b++) *largest = PetscMax(*largest, forces[b]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How the springs of all bodies are stretched; whether they have come to rest */
static PetscErrorCode Measure(Contact contact, PetscInt times, PetscBool *rest)
{
  const PetscReal  atol = STRETCH_ATOL * CONTACT_POSITION_TOLERANCE * contact->scale.length;
  ContactFloating *f    = &contact->floating;
  PetscReal        force;

  PetscFunctionBegin;
  *rest = PETSC_TRUE;
  PetscCall(FindLargestForce(contact, &force));
  PetscCall(PetscArraycpy(f->last, f->stretch, f->n_springs));
  for (PetscInt k = 0; k < f->n; k++) {
    ContactSprings  *springs = &f->bodies[k];
    BodySpringState *state   = &f->states[k];
    const Body       body    = contact->bodies[springs->body];
    PetscReal        most = 0, square = 0, last = 0, change = 0, least;

    PetscCall(BodyMeasureSprings(body, state));
    for (PetscInt i = 0; i < state->n; i++) {
      const PetscInt at = springs->begin + i;

      f->stretch[at] = f->root[at] * state->stretch[i];
      most           = PetscMax(most, PetscAbsReal(state->stretch[i]));
      square += PetscSqr(f->stretch[at]);
      last += PetscSqr(f->last[at]);
      change += PetscSqr(f->stretch[at] - f->last[at]);
    }
    least           = force > 0 ? REST_FORCE * force / state->stiffness : atol;
    springs->stalls = times && square > PetscSqr(FALLS) * springs->lowest ? springs->stalls + 1 : 0;
    springs->lowest = times && most <= PetscMax(least, atol) ? PetscMin(springs->lowest, square) : square;
    springs->steady = times && most > least && change < PetscSqr(STEADY) * last ? springs->steady + 1 : 0;
    if (most > STRETCH_RTOL * state->displacement &&
        (springs->stalls < MAX_STALLS || most > least || (springs->stalls < LONG_STALLS && most > atol)))
      *rest = PETSC_FALSE;
    if (springs->stalls && state->way > (state->linear ? FAR : FAR_NONLINEAR) * state->size && most > least)
      PetscCall(RefuseUnheld(contact, body));
    PetscCall(PetscInfo(contact, "body '%s': springs stretched by %g m after a way of %g m, step made %" PetscInt_FMT " times\n",
                        ((PetscObject)body)->name, (double)most, (double)state->way, times + 1));
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
  f->n_history = f->plain = 0;
  f->patience             = 2;
  f->leapt                = PETSC_FALSE;
  for (PetscInt k = 0; k < f->n; k++) {
    f->bodies[k].leaps = f->bodies[k].steady = f->bodies[k].stalls = 0;
    PetscCall(BodyResetSprings(contact->bodies[f->bodies[k].body]));
  }
  for (PetscInt times = 0; times < MAX_TIMES && !rest; times++) {
    PetscCall(MakeStep(contact, (PetscBool)(times == 0)));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(Measure(contact, times, &rest));
    if (!rest) PetscCall(SpringsMove(contact, (PetscBool)(times > 0)));
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
    PetscUseTypeMethod(contact, step);
    PetscCall(ContactCompleteBodies(contact));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscArraycpy(f->start_force, contact->start.force, contact->rows.n));
  PetscCall(PetscArraycpy(f->start_active, contact->start.active, contact->rows.n));
  PetscCall(MakeStepOfFloating(contact));
  PetscCall(PetscArraycpy(contact->start.force, f->start_force, contact->rows.n));
  PetscCall(PetscArraycpy(contact->start.active, f->start_active, contact->rows.n));
  PetscFunctionReturn(PETSC_SUCCESS);
}
