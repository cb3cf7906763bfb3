/* Which body of a pair takes displacements, and what the unknowns of the outer iteration are then. */
#include "alternationimpl.h"
#include <impakt/private/bodymass.h>

/* By how much the square of the weight of a node that lies opposite may be off one: round-off of geometry */
#define OPPOSITE 1e-9

/* Times in the controller step at which the trace of a pair is an unknown: one for each substep of the Neumann side, but the Dirichlet side
   sees nothing of the interior ones if it makes one substep */
static PetscErrorCode CountLevels(Contact contact, PetscInt p, PetscInt dirichlet, PetscInt *levels)
{
  const ContactPair *pair = &contact->pairs[p];
  PetscInt           substeps[2];

  PetscFunctionBegin;
  PetscCall(BodyGetSubsteps(contact->bodies[pair->body[0]], &substeps[0]));
  substeps[1] = substeps[0]; /* of an obstacle */
  if (!pair->obstacle) PetscCall(BodyGetSubsteps(contact->bodies[pair->body[1]], &substeps[1]));
  *levels = substeps[dirichlet] == 1 ? 1 : substeps[1 - dirichlet];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The partner can be prescribed only where its rows are single nodes: then the squares of entries have the sum one */
static PetscErrorCode CheckSwappable(Contact contact, PetscInt b)
{
  const ContactBodyRows *of = &contact->body_rows[b];

  PetscFunctionBegin;
  PetscCheck(!BodyDoes(contact->bodies[b], BodyIsRigid), PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_swap_sides: body '%s' is rigid, and takes forces alone; leave the option out",
             ((PetscObject)contact->bodies[b])->name);
  for (PetscInt k = 0; k < of->n; k++) {
    const ContactPair *pair = &contact->pairs[contact->rows.pair[of->rows[k]]];
    const PetscScalar *values;
    PetscReal          sum = 0;
    PetscInt           n;

    if (pair->body[1] != b) continue;
    PetscCall(MatGetRow(contact->interfaces[b], of->begin + k, &n, NULL, &values));
    for (PetscInt e = 0; e < n; e++) sum += PetscSqr(PetscRealPart(values[e]));
    PetscCall(MatRestoreRow(contact->interfaces[b], of->begin + k, &n, NULL, &values));
    PetscCheck(PetscAbsReal(sum - 1) < OPPOSITE, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "-contact_swap_sides: in pair %s the nodes of the two bodies do not lie opposite each other, and only one side can take "
               "displacements; leave the option out",
               pair->name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reactions of prescribed nodes with mass at the ends of several substeps. Two plane blocks, lumped mass, the first 100 times as stiff:
   with 2 substeps of it to a step of 1e-6 s the iteration diverges after 29 steps and, where that is accepted, the energy grows to 1e10 of
   itself; with 3 and 4 the blocks gain 6.4 and 4.8 %, with one 3.6 %. Bars gain 1 % at most, with up to 50 substeps. */
static PetscErrorCode CheckReactionSubsteps(Contact contact, Body dirichlet)
{
  const char *name = ((PetscObject)dirichlet)->name;
  PetscInt    substeps;

  PetscFunctionBegin;
  PetscCall(BodyGetSubsteps(dirichlet, &substeps));
  if (substeps == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(
      !BodyDoes(dirichlet, BodyIsExplicit), PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
      "-schwarz_traction reaction: body '%s' is explicit, takes displacements, and its contact nodes have mass: what they feel at the "
      "end of a substep moves nothing in it; choose -schwarz_traction internal, or -%s_mass_redistribute true",
      name, name);
  PetscCall(
      ContactRefuseUnstable(contact, (PetscBool)(contact->dim > 1),
                            "-schwarz_traction reaction diverges or gains energy where contact nodes with mass take displacements over "
                            "several substeps; choose -schwarz_traction internal, one substep, or -<body>_mass_redistribute true"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With the inertia of prescribed nodes in the traction, their acceleration takes part in the iteration. It follows from their
   displacement where the Neumann side is implicit and makes one substep. */
static PetscErrorCode SetUpReactionTraction(Contact contact, PetscInt p, PetscInt side)
{
  Alternation       *alternation = (Alternation *)contact->data;
  const ContactPair *pair        = &contact->pairs[p];
  const Body         dirichlet = contact->bodies[pair->body[side]], neumann = pair->obstacle ? NULL : contact->bodies[pair->body[1 - side]];
  PetscInt           substeps;

  PetscFunctionBegin;
  if (pair->obstacle || alternation->traction != BODY_TRACTION_REACTION ||
      alternation->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN || !BodyDoes(dirichlet, BodyPrescribesMass))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetSubsteps(neumann, &substeps));
  PetscCheck(!BodyDoes(neumann, BodyIsExplicit) && substeps == 1, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-schwarz_traction reaction: the contact nodes of body '%s' have mass, and then its partner '%s' must be implicit with the "
             "controller step as its step; choose -schwarz_traction internal, or -%s_mass_redistribute true",
             ((PetscObject)dirichlet)->name, ((PetscObject)neumann)->name, ((PetscObject)dirichlet)->name);
  PetscCall(CheckReactionSubsteps(contact, dirichlet));
  alternation->kinematic[2 * p + side] = PETSC_TRUE;
  for (PetscInt k = 0; k < 2; k++)
    if (!alternation->rate[k]) PetscCall(TraceCreate(contact->rows.n, 1, &alternation->rate[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Levels and traces of all pairs, for both choices of sides if they are to be swapped */
PetscErrorCode AlternationSetUpSides(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    PetscCheck(!contact->pairs[p].obstacle || (!alternation->swap && alternation->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN),
               PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_pairs %s: an obstacle has no other side, neither for -contact_swap_sides nor for -schwarz_transmission robin or "
               "impedance",
               contact->pairs[p].name);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    PetscCheck(!alternation->swap || !contact->pairs[p].turned, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_swap_sides: the rows of pair %s are on its second body, and the first one takes displacements first; leave "
               "-contact_rows at first",
               contact->pairs[p].name);
  PetscCall(PetscCalloc5(contact->n_pairs, &alternation->levels[0], contact->n_pairs, &alternation->levels[1], 2 * contact->n_pairs,
                         &alternation->trace, contact->n_pairs, &alternation->room, 2 * contact->n_pairs, &alternation->kinematic));
  for (PetscInt side = 0; side <= (alternation->swap ? 1 : 0); side++)
    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      PetscInt *levels = &alternation->levels[side][p];

      PetscCall(CountLevels(contact, p, side, levels));
      PetscCall(TraceCreate(contact->pairs[p].end - contact->pairs[p].begin, *levels, &alternation->trace[2 * p + side]));
      PetscCall(SetUpReactionTraction(contact, p, side));
      if (alternation->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN &&
          BodyDoes(contact->bodies[contact->pairs[p].body[side]], BodyPrescribesMass))
        alternation->mass_prescribed = PETSC_TRUE;
      alternation->room[p] = PetscMax(alternation->room[p], *levels);
    }
  for (PetscInt b = 0; b < contact->n_bodies && alternation->swap; b++) PetscCall(CheckSwappable(contact, b));
  if (alternation->mass_prescribed) contact->energy.unlimited = "nodes with mass take velocity and acceleration from their partner";
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From now on the other body of each pair takes displacements. What came before its partner in a sweep comes after it. */
void AlternationSwapSides(Contact contact)
{
  for (PetscInt p = 0; p < contact->n_pairs; p++) contact->pairs[p].dirichlet = 1 - contact->pairs[p].dirichlet;
  for (PetscInt b = 0; b < contact->n_bodies / 2; b++) {
    const PetscInt first = contact->order[b];

    contact->order[b]                         = contact->order[contact->n_bodies - 1 - b];
    contact->order[contact->n_bodies - 1 - b] = first;
  }
}
