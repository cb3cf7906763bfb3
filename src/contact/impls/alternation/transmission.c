/* Robin transmission conditions: each side of the contact boundary gets, in place of a displacement or a force, a mixture of both,

     f + alpha w = r,

   with the force f along the row and the part w of its gap that comes from the side. From what one side answers to its r, the partner's is

     r' = 2 f - r - alpha o,

   o being what a closed gap has beside w + w' = -o. When the sides agree, f' = f and the gap is closed, as under Dirichlet and Neumann
   conditions: the conditions change the way there, not the goal.

   An impedance condition, f + z dw/dt = r, is one with alpha = z / dt as soon as time is discrete: dt is the controller step here,
   so that it is the mean velocity over it that counts, and the gap closes whatever the substeps. */
#include "alternationimpl.h"
#include <impakt/private/bodymass.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodysweeps.h>

/* Stiffness of the springs of each row: as given, or that of the partner, which answers best */
static void SetUpWeights(Contact contact, PetscInt b, const PetscReal stiffness[], PetscReal impedance)
{
  Alternation *alternation = (Alternation *)contact->data;

  for (PetscInt k = 0; k < contact->body_rows[b].n; k++) {
    const PetscInt i = contact->body_rows[b].rows[k];

    if (contact->pairs[contact->rows.pair[i]].body[1] != b) continue;
    alternation->weight[i] = (alternation->parameter > 0 ? alternation->parameter : impedance) * contact->rows.area[i];
    if (alternation->transmission == SCHWARZ_TRANSMISSION_IMPEDANCE) alternation->weight[i] /= alternation->controller_step;
    else if (alternation->parameter == 0) alternation->weight[i] = stiffness[k];
  }
}

/* Ties have rows across the normal as well, and the partner's rows are means over nodes that need not lie opposite, which move more easily
   than each node: there the nodes of the first body tell the stiffness, with their inertia in a substep where they keep their mass.
   Newmark's trapezoidal rule has 4 m / dt^2; a cantilever of implicit halves takes 7 sweeps with it, and 127 without. */
static PetscErrorCode SetUpTiedWeights(Contact contact, PetscInt b, const PetscReal stiffness[])
{
  Alternation       *alternation = (Alternation *)contact->data;
  const PetscScalar *flexibility;
  PetscInt           substeps;
  PetscReal          shift;
  Vec                diagonal;
  Mat                inverse;

  PetscFunctionBegin;
  PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
  shift = 4 * PetscSqr(substeps / alternation->controller_step);
  PetscCall(BodyComputeInverseMass(contact->bodies[b], PETSC_TRUE, &inverse));
  PetscCall(MatCreateVecs(inverse, &diagonal, NULL));
  PetscCall(MatGetDiagonal(inverse, diagonal));
  PetscCall(VecGetArrayRead(diagonal, &flexibility));
  for (PetscInt k = 0; k < contact->body_rows[b].n; k++) {
    const PetscInt     i    = contact->body_rows[b].rows[k];
    const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];

    if (pair->body[0] != b) continue;
    alternation->weight[i] = stiffness[k];
    if (pair->keeps_mass && PetscRealPart(flexibility[k]) > 0) alternation->weight[i] += shift / PetscRealPart(flexibility[k]);
  }
  PetscCall(VecRestoreArrayRead(diagonal, &flexibility));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(MatDestroy(&inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What both sides of each row weigh in their common velocity after an impact: the impedances of plane waves, or, where nodes with mass are
   prescribed, the masses of the elements beside the row. E A / h and sqrt(E rho) A make rho A h. */
static void SetUpMasses(Contact contact, PetscInt b, const PetscReal stiffness[], PetscReal impedance)
{
  Alternation *alternation = (Alternation *)contact->data;

  for (PetscInt k = 0; k < contact->body_rows[b].n; k++) {
    const PetscInt i    = contact->body_rows[b].rows[k];
    const PetscInt side = contact->pairs[contact->rows.pair[i]].body[1] == b ? 1 : 0;

    alternation->mass[side][i] = alternation->mass_prescribed ? PetscSqr(impedance * contact->rows.area[i]) / stiffness[k] : impedance;
  }
}

/* The force at the end of a substep must move its row in that substep */
static PetscErrorCode CheckBodies(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const Body  body = contact->bodies[b];
    const char *name = ((PetscObject)body)->name;

    PetscCheck(
        !BodyDoes(body, BodyIsRigid), PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
        "-schwarz_transmission robin and impedance put springs on the contact nodes of both bodies, and body '%s' is rigid: it takes "
        "forces; choose -schwarz_transmission dirichlet_neumann",
        name);
    PetscCheck(!BodyDoes(body, BodyIsExplicit) || BodyDoes(body, BodyIsRedistributed), PetscObjectComm((PetscObject)contact),
               PETSC_ERR_USER_INPUT,
               "-schwarz_transmission robin and impedance put springs on the contact nodes, and those of the explicit body '%s' have mass, "
               "so that they do not feel them in the step in which they act; give it -%s_mass_redistribute true, or choose "
               "-schwarz_transmission dirichlet_neumann",
               name, name);
  }
  PetscCall(ContactRefuseUnstable(contact, ContactHasMass(contact, PETSC_FALSE),
                                  "-schwarz_transmission robin and impedance gain energy without end where contact nodes have mass; set "
                                  "-<body>_mass_redistribute true, or choose -schwarz_transmission dirichlet_neumann"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Robin conditions have a mixture of force and displacement go linearly between the times that both sides share. Where one side has more
   substeps, its force does not: it brings another impulse and other work than the partner's. Two bars lose 6.6e-5 of their momentum with 2
   and 1 substeps to a step of 1e-6 s and 1.4e-2 to one of 5e-5 s, where they gain 0.7 % of energy; tied blocks 4.2e-2, and gain 1.9 %. */
static PetscErrorCode RefuseUnshared(Contact contact)
{
  PetscBool unshared = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscInt substeps[2];

    if (contact->pairs[p].obstacle) continue;
    for (PetscInt side = 0; side < 2; side++) PetscCall(BodyGetSubsteps(contact->bodies[contact->pairs[p].body[side]], &substeps[side]));
    if (substeps[0] != substeps[1]) unshared = PETSC_TRUE;
  }
  PetscCall(
      ContactRefuseUnstable(contact, unshared,
                            "-schwarz_transmission robin and impedance keep neither momentum nor energy where two bodies make unequal "
                            "substeps; give both the same -<body>_ts_time_step, or leave -schwarz_transmission out"));
  if (unshared) contact->energy.not_always = "Robin and impedance conditions over unequal substeps keep neither momentum nor energy";
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetRobin(Contact contact)
{
  const Alternation *alternation = (const Alternation *)contact->data;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactTakeRows(contact, b, alternation->weight, alternation->row_work);
    PetscCall(BodySetRobin(contact->bodies[b], alternation->row_work));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Masses for the inelastic predictor; weights, and springs of the bodies, for Robin conditions */
PetscErrorCode AlternationSetUpTransmission(Contact contact)
{
  Alternation    *alternation = (Alternation *)contact->data;
  const PetscBool robin       = (PetscBool)(alternation->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN);
  const PetscBool tied        = (PetscBool)(alternation->transmission == SCHWARZ_TRANSMISSION_ROBIN && alternation->parameter == 0 &&
                                            ContactAllPairsTie(contact));
  PetscReal      *stiffness;

  PetscFunctionBegin;
  PetscCall(
      PetscCalloc3(contact->rows.n, &alternation->weight, contact->rows.n, &alternation->mass[0], contact->rows.n, &alternation->mass[1]));
  if (robin) PetscCall(CheckBodies(contact));
  if (robin) PetscCall(RefuseUnshared(contact));
  PetscCall(PetscCalloc1(contact->rows.n, &stiffness));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal impedance;

    PetscCall(BodyGetScale(contact->bodies[b], BODY_IMPEDANCE, &impedance));
    if (robin || alternation->mass_prescribed) PetscCall(BodyComputeRowStiffness(contact->bodies[b], stiffness));
    SetUpMasses(contact, b, stiffness, impedance);
    if (tied) PetscCall(SetUpTiedWeights(contact, b, stiffness));
    else if (robin) SetUpWeights(contact, b, stiffness, impedance);
  }
  PetscCall(PetscFree(stiffness));
  if (robin) PetscCall(SetRobin(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The controller step is another: so are the weights of impedances */
PetscErrorCode AlternationSetStepLevel(Contact contact)
{
  Alternation    *alternation = (Alternation *)contact->data;
  const PetscReal ratio       = alternation->controller_step / contact->step; /* a power of two */

  PetscFunctionBegin;
  alternation->controller_step = contact->step;
  if (alternation->transmission != SCHWARZ_TRANSMISSION_IMPEDANCE) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++) alternation->weight[i] *= ratio;
  PetscCall(SetRobin(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
