/* The largest controller step that resolves contact. In a step in which rows join or leave the trapezoidal rule takes or brings energy by
   the force at one of its ends times the gap at the other. Both are small where the step is one in which the force changes little: that of
   an oscillator of two masses, the contact elements of both sides, with a spring between them, the layers of both sides one behind the
   other. For equal sides this is the time that a wave takes through a contact element. */
#include <contact/parts.h>
#include <sys/units.h>
#include <impakt/private/bodymesh.h>

/* Part of a contact element by which the bodies may close in a step */
#define CLOSING 0.25

typedef struct {
  PetscReal size;      /* of its contact elements [m] */
  PetscReal transit;   /* of a plane wave through one [s] */
  PetscReal impedance; /* [N s/m^3] */
  PetscReal velocity[3];
  PetscBool rigid; /* it has no waves */
} Side;

static PetscErrorCode GetSide(Body body, Side *side)
{
  PetscFunctionBegin;
  PetscCall(BodyIsRigid(body, &side->rigid));
  PetscCall(BodyGetScale(body, BODY_CONTACT_ELEMENT_SIZE, &side->size));
  PetscCall(ContactGetTransit(body, side->size, &side->transit, &side->impedance));
  PetscCall(BodyGetInitialVelocity(body, side->velocity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A smaller step, if sides of contact elements of this size close by more than a part of one at this speed */
static PetscErrorCode LimitClosing(Contact contact, const char who[], PetscReal speed, PetscReal element, PetscReal *step, size_t size,
                                   char reason[])
{
  PetscFunctionBegin;
  if (!(speed * *step > CLOSING * element)) PetscFunctionReturn(PETSC_SUCCESS);
  *step = CLOSING * element / speed;
  PetscCall(PetscSNPrintf(reason, size, "%s close at %.3g%s, by %g of a contact element in it", who, (double)speed,
                          UnitsOf((PetscObject)contact, UNIT_VELOCITY), CLOSING));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GetPairStep(Contact contact, const ContactPair *pair, PetscReal *step, size_t size, char reason[])
{
  Side      sides[2]    = {{.rigid = PETSC_FALSE}, {.rigid = PETSC_FALSE}};
  PetscReal flexibility = 0, mobility = 0, speed = 0, smallest = PETSC_MAX_REAL;
  char      second[32] = "";
  PetscInt  deforms    = -1;

  PetscFunctionBegin;
  *step = PETSC_INFINITY;
  for (PetscInt s = 0; s < (pair->obstacle ? 1 : 2); s++) {
    PetscCall(GetSide(contact->bodies[pair->body[s]], &sides[s]));
    smallest = PetscMin(smallest, sides[s].size);
    if (sides[s].rigid) continue;
    flexibility += sides[s].transit / sides[s].impedance;    /* h / M */
    mobility += 1 / (sides[s].transit * sides[s].impedance); /* 1 / (rho h) */
    if (deforms == 0) PetscCall(PetscSNPrintf(second, sizeof(second), " and %.3g", (double)sides[1].transit));
    else deforms = s;
  }
  if (deforms < 0) PetscFunctionReturn(PETSC_SUCCESS); /* between rigid bodies springs alone have a period */
  for (PetscInt d = 0; d < 3; d++) speed += PetscSqr(sides[0].velocity[d] - sides[1].velocity[d]);
  *step = PetscSqrtReal(flexibility / mobility);
  PetscCall(PetscSNPrintf(reason, size, "waves cross the contact elements of %s in %.3g%s%s", pair->name, (double)sides[deforms].transit,
                          second, UnitsOf((PetscObject)contact, UNIT_TIME)));
  PetscCall(LimitClosing(contact, pair->name, PetscSqrtReal(speed), smallest, step, size, reason));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The step of all pairs that may come and go, or less: by equal sides, and the two fastest bodies */
static PetscErrorCode GetNeighboursStep(Contact contact, PetscReal *step, size_t size, char reason[])
{
  PetscReal   first = 0, second = 0, smallest = PETSC_MAX_REAL;
  const char *name = "";

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal speed = 0;
    Side      side;

    PetscCall(GetSide(contact->bodies[b], &side));
    for (PetscInt d = 0; d < 3; d++) speed += PetscSqr(side.velocity[d]);
    speed    = PetscSqrtReal(speed);
    second   = PetscMax(second, PetscMin(first, speed));
    first    = PetscMax(first, speed);
    smallest = PetscMin(smallest, side.size);
    if (side.rigid || side.transit >= *step) continue;
    *step = side.transit;
    name  = ((PetscObject)contact->bodies[b])->name;
  }
  PetscCall(PetscSNPrintf(reason, size, "waves cross the contact elements of %s in %.3g%s", name, (double)*step,
                          UnitsOf((PetscObject)contact, UNIT_TIME)));
  PetscCall(LimitClosing(contact, "the two fastest bodies, at most,", first + second, smallest, step, size, reason));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest controller step that resolves contact, after ContactSetUpSurfaces(), and what it follows from, in words; infinity where no
   pair has inertia on both sides. With the masses m = rho h and the stiffnesses k = M / h of the contact elements on both sides, for a unit
   of area, h being the mean edge of the elements with a contact node and M the modulus of plane waves, it is sqrt((1/k_1 + 1/k_2) / (1/m_1
   + 1/m_2)) of the pair where that is least: between equal sides the time that a wave takes through a contact element. Where pairs come and
   go it is that of the body through whose contact elements waves go fastest. It is less where the bodies, at their mean velocities at the
   start, would close by more than a quarter of a contact element. Collective. */
PetscErrorCode ContactGetResolvedStep(Contact contact, PetscReal *step, size_t size, char reason[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(step, 2);
  PetscAssertPointer(reason, 4);
  *step     = PETSC_INFINITY;
  reason[0] = 0;
  if (ContactAllPairsTie(contact)) PetscFunctionReturn(PETSC_SUCCESS); /* no row joins or leaves */
  if (contact->neighbours.come_and_go) {
    PetscCall(GetNeighboursStep(contact, step, size, reason));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair    = &contact->pairs[p];
    PetscReal          of_pair = 0;
    char               why[256];

    if (pair->rests || ContactPairTies(pair)) continue;
    PetscCall(GetPairStep(contact, pair, &of_pair, sizeof(why), why));
    if (of_pair >= *step) continue;
    *step = of_pair;
    PetscCall(PetscStrncpy(reason, why, size));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
