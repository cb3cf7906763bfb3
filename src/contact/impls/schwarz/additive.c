/*
   Additive sweeps: both bodies of a pair start from what the sweep before gave, and neither waits for the other's answer.

   The unknowns are the contact forces. They load both sides, and the residual is the gap that is left between them, where in a
   multiplicative sweep the displacements of the one side are the unknowns and its reactions load the other. Newton's step has the
   compliance of both bodies, corrected by secants where they are not linear; the convergence test is the same.
*/
#include "schwarzimpl.h"
#include "../methodset.h"

static const char *const SweepTypes[] = {"multiplicative", "additive", "SchwarzSweepType", "SCHWARZ_SWEEP_", NULL};

PetscErrorCode SchwarzReadSweepType(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEnum("-schwarz_sweep", "Whether bodies of a sweep wait for each other's answer", "ContactSchwarzSetSweepType",
                             SweepTypes, (PetscEnum)schwarz->sweep, (PetscEnum *)&schwarz->sweep, NULL));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the forces of all pairs of two bodies the unknowns, once the mode has been chosen */
PetscErrorCode SchwarzSetUpSweepType(Contact contact)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;
  MPI_Comm       comm    = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  if (schwarz->sweep == SCHWARZ_SWEEP_MULTIPLICATIVE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(
      schwarz->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN, comm, PETSC_ERR_USER_INPUT,
      "-schwarz_sweep additive: forces load both sides, which leaves no Robin or impedance conditions; leave -schwarz_transmission out");
  PetscCheck(schwarz->waveform == SCHWARZ_WAVEFORM_LINEAR, comm, PETSC_ERR_USER_INPUT,
             "-schwarz_sweep additive: both sides have one force, linear in time; leave -schwarz_traction_waveform out");
  PetscCheck(!schwarz->swap, comm, PETSC_ERR_USER_INPUT,
             "-schwarz_sweep additive: no side takes displacements, and none can be swapped; leave -contact_swap_sides out");
  PetscCheck(schwarz->mode != SCHWARZ_MASS, comm, PETSC_ERR_USER_INPUT,
             "-schwarz_sweep additive: contact nodes with mass (-<body>_mass_redistribute false) take velocity and acceleration from their "
             "partner as it answers; let them be massless");
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];

    for (PetscInt side = 0; side < 2 && !pair->obstacle; side++) {
      PetscBool feels;

      PetscCall(BodyFeelsEndForce(contact->bodies[pair->body[side]], &feels));
      PetscCheck(
          feels, comm, PETSC_ERR_USER_INPUT,
          "-schwarz_sweep additive: body '%s' is explicit and has mass on its contact nodes, which a force at the end of a step does "
          "not move in it; let them be massless, or leave the option out",
          ((PetscObject)contact->bodies[pair->body[side]])->name);
    }
    pair->by_force = (PetscBool)!pair->obstacle;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Without the compliance an iteration does not know how far a force moves anything; once the outer iteration has its options */
PetscErrorCode SchwarzCheckSweepType(Contact contact)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCheck(schwarz->sweep == SCHWARZ_SWEEP_MULTIPLICATIVE || schwarz->newton, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-schwarz_sweep additive goes with -schwarz_snes_type newtonls alone, which turns gaps into forces by the compliance of the "
             "bodies");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetSweepType - sets whether the bodies of a sweep wait for each other's answer

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, of type `CONTACT_SCHWARZ`, not yet set up
- sweep   - the order

  Options Database Key:
. -schwarz_sweep (multiplicative|additive) - whether they do

  Level: advanced

  Note:
  An additive sweep loads both sides of a pair by the same forces. It wants massless contact nodes or implicit bodies, Dirichlet-Neumann
  conditions, which it does without, and Newton's method as the outer iteration.

.seealso: `Contact`, `CONTACT_SCHWARZ`, `SchwarzSweepType`
@*/
PetscErrorCode ContactSchwarzSetSweepType(Contact contact, SchwarzSweepType sweep)
{
  Schwarz *schwarz = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_SCHWARZ, NULL, "CONTACT_SCHWARZ", (void **)&schwarz);
  PetscValidLogicalCollectiveEnum(contact, sweep, 2);
  ContactCheckEnum(contact, sweep, SCHWARZ_SWEEP_ADDITIVE, "order of sweeps");
  schwarz->sweep = sweep;
  PetscFunctionReturn(PETSC_SUCCESS);
}
