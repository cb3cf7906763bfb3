/* What a program sets is what the options set; what comes too late, to another method, or makes no sense is refused. */
#include "simulation.h"

#define STEPS 30

static void create(Simulation *simulation)
{
  ok(ControllerDestroy(&simulation->controller));
  ok(ControllerCreate(PETSC_COMM_WORLD, &simulation->controller));
  ok(ControllerSetFromOptions(simulation->controller));
  ok(ControllerGetContact(simulation->controller, &simulation->contact));
}

static void run(Simulation *simulation, ContactPairState states[STEPS], ContactCounts *counts)
{
  ok(ControllerSetUp(simulation->controller));
  for (PetscInt step = 0; step < STEPS; step++) states[step] = Step(simulation);
  ok(ContactGetCounts(simulation->contact, counts));
}

/* Bit for bit: nothing but where a value comes from is another. PETSc's other partitioners draw random numbers, so that a second run in one
   process has other parts of the meshes, whose sums differ by round-off. */
static void compare(Simulation *simulation, const char options[], PetscErrorCode (*set)(Contact))
{
  ContactPairState states[2][STEPS];
  ContactCounts    counts[2];

  AddOptions("-petscpartitioner_type simple");
  create(simulation);
  ok((*set)(simulation->contact));
  run(simulation, states[0], &counts[0]);
  AddOptions(options);
  create(simulation);
  run(simulation, states[1], &counts[1]);
  assert_true(states[1][STEPS - 1].impulse[0] != 0);
  for (PetscInt step = 0; step < STEPS; step++) {
    near(states[0][step].force, states[1][step].force, 0);
    near(states[0][step].gap, states[1][step].gap, 0);
    assert_int_equal(states[0][step].active, states[1][step].active);
  }
  assert_int_equal(counts[0].sweeps, counts[1].sweeps);
}

static PetscErrorCode SetRobin(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactSchwarzSetTransmission(contact, SCHWARZ_TRANSMISSION_ROBIN));
  PetscCall(ContactSchwarzSetRobinParameter(contact, 7));
  PetscCall(ContactSchwarzSetPredictor(contact, SCHWARZ_PREDICTOR_LAST));
  PetscCall(ContactSchwarzSetSwapSides(contact, PETSC_TRUE));
  PetscCall(ContactSchwarzSetConvergence(contact, SCHWARZ_CONVERGENCE_POSITION));
  PetscCall(ContactSchwarzSetUnconverged(contact, SCHWARZ_UNCONVERGED_ACCEPT));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetAlternation(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactSchwarzSetTraction(contact, BODY_TRACTION_REACTION));
  PetscCall(ContactSchwarzSetTractionWaveform(contact, SCHWARZ_WAVEFORM_CONSTANT));
  PetscCall(ContactSchwarzSetRelaxation(contact, SCHWARZ_RELAXATION_AITKEN));
  PetscCall(ContactSchwarzSetRecheck(contact, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void schwarz(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(7, 11, 0.3);
  AddOptions("-contact_type alternation");
  compare(
      simulation,
      "-schwarz_transmission robin -schwarz_robin_parameter 7 -schwarz_predictor last -contact_swap_sides -schwarz_convergence position "
      "-schwarz_unconverged accept",
      SetRobin);
}

static void alternation(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(7, 11, 0.3);
  AddOptions("-contact_type alternation");
  AddOptions("-schwarz_snes_type nrichardson -right_ts_time_step 0.005");
  compare(simulation, "-schwarz_traction reaction -schwarz_traction_waveform constant -schwarz_relaxation aitken -schwarz_recheck 0",
          SetAlternation);
}

static PetscErrorCode SetPenalty(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactSetConstraint(contact, CONTACT_CONSTRAINT_BOTH));
  PetscCall(ContactPenaltySetParameter(contact, 50));
  PetscCall(ContactPenaltySetDamping(contact, 0.1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void penalty(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(7, 11, 0.3);
  AddOptions("-contact_type penalty");
  compare(simulation, "-contact_constraint both -contact_penalty 50 -contact_penalty_damping 0.1", SetPenalty);
}

static PetscErrorCode SetAugmentation(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactPenaltySetScale(contact, 0.5));
  PetscCall(ContactPenaltySetAugmentation(contact, 1e-6, 60));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void augmented_lagrangian(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(7, 11, 0.3);
  AddOptions("-contact_type augmented_lagrangian");
  compare(simulation, "-contact_penalty_scale 0.5 -contact_augmentation_tolerance 1e-6 -contact_augmentation_max_it 60", SetAugmentation);
}

static void refusals(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Contact     contact;

  AddCollision(7, 11, 0);
  AddOptions("-contact_type alternation");
  create(simulation);
  contact = simulation->contact;
  refused(PETSC_ERR_ARG_OUTOFRANGE, "must be positive", ContactSchwarzSetRobinParameter(contact, 0));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "must be positive", ContactSchwarzSetImpedanceParameter(contact, -1));
  for (int value = -1; value <= 4; value += 5) { /* one less and one more than there are, of the largest enum */
    refused(PETSC_ERR_ARG_OUTOFRANGE, "no transmission condition", ContactSchwarzSetTransmission(contact, (SchwarzTransmission)value));
    refused(PETSC_ERR_ARG_OUTOFRANGE, "no traction", ContactSchwarzSetTraction(contact, (BodyTractionType)value));
    refused(PETSC_ERR_ARG_OUTOFRANGE, "no waveform", ContactSchwarzSetTractionWaveform(contact, (SchwarzWaveform)value));
    refused(PETSC_ERR_ARG_OUTOFRANGE, "no predictor", ContactSchwarzSetPredictor(contact, (SchwarzPredictor)value));
    refused(PETSC_ERR_ARG_OUTOFRANGE, "no relaxation", ContactSchwarzSetRelaxation(contact, (SchwarzRelaxation)value));
    refused(PETSC_ERR_ARG_OUTOFRANGE, "no convergence test", ContactSchwarzSetConvergence(contact, (SchwarzConvergence)value));
    refused(PETSC_ERR_ARG_OUTOFRANGE, "no way to go on", ContactSchwarzSetUnconverged(contact, (SchwarzUnconverged)value));
  }
  ok(ContactSchwarzSetTransmission(contact, SCHWARZ_TRANSMISSION_IMPEDANCE));
  ok(ContactSchwarzSetTransmission(contact, SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ContactSetType(contact, CONTACT_PENALTY)", ContactPenaltySetParameter(contact, 1));
  ok(ContactSetType(contact, CONTACT_PENALTY));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ContactSetType(contact, CONTACT_ALTERNATION)",
          ContactSchwarzSetPredictor(contact, SCHWARZ_PREDICTOR_LAST));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "must be positive", ContactPenaltySetParameter(contact, -1));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "must be positive", ContactPenaltySetScale(contact, 0));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "must be positive", ContactPenaltySetDamping(contact, 0));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "must be positive", ContactPenaltySetAugmentation(contact, 1e-6, 0));
  ok(ContactSetType(contact, CONTACT_ALTERNATION));
  ok(ControllerSetUp(simulation->controller));
  refused(PETSC_ERR_ARG_WRONGSTATE, "before ContactSetUp()", ContactSchwarzSetRecheck(contact, PETSC_TRUE));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(schwarz),  simulation_test(alternation), simulation_test(penalty), simulation_test(augmented_lagrangian),
      simulation_test(refusals),
  };

  return impakt_main(argc, argv, tests);
}
