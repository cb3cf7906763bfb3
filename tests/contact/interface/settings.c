/* What setters set, and what options set, getters tell; what cannot be is refused, and changes nothing. */
#include "support.h"

typedef struct {
  PetscBool            unstable, shared_times, cap, facing, balance;
  PetscReal            excess, tolerance, tie_distance;
  ContactConstraint    constraint;
  ContactStabilization stabilization;
} Settings;

static void get(Contact contact, Settings *settings)
{
  ok(ContactGetAllowUnstable(contact, &settings->unstable));
  ok(ContactGetSharedTimes(contact, &settings->shared_times));
  ok(ContactGetEnergyCap(contact, &settings->cap, &settings->excess));
  ok(ContactGetFacing(contact, &settings->facing));
  ok(ContactGetBalance(contact, &settings->balance));
  ok(ContactGetTolerance(contact, &settings->tolerance));
  ok(ContactGetTieDistance(contact, &settings->tie_distance));
  ok(ContactGetConstraint(contact, &settings->constraint));
  ok(ContactGetStabilization(contact, &settings->stabilization));
}

/* Twice, with other values: one of the two differs from the default */
static void set_and_got(void **state)
{
  Contact  contact;
  Settings settings;

  (void)state;
  ok(ContactCreate(PETSC_COMM_WORLD, &contact));
  for (PetscInt k = 0; k < 2; k++) {
    const PetscBool flag = k ? PETSC_TRUE : PETSC_FALSE, other = k ? PETSC_FALSE : PETSC_TRUE;

    ok(ContactSetAllowUnstable(contact, flag));
    ok(ContactSetSharedTimes(contact, other));
    ok(ContactSetEnergyCap(contact, flag, 0.25 + k));
    ok(ContactSetFacing(contact, other));
    ok(ContactSetBalance(contact, flag));
    ok(ContactSetTolerance(contact, 1e-5 * (1 + k)));
    ok(ContactSetTieDistance(contact, 0.5 + k));
    ok(ContactSetConstraint(contact, k ? CONTACT_CONSTRAINT_GAP_RATE : CONTACT_CONSTRAINT_BOTH));
    ok(ContactSetStabilization(contact, k ? CONTACT_STABILIZATION_NAIVE : CONTACT_STABILIZATION_CONTACT_STABILIZED));
    get(contact, &settings);
    assert_int_equal(settings.unstable, flag);
    assert_int_equal(settings.shared_times, other);
    assert_int_equal(settings.cap, flag);
    near(settings.excess, 0.25 + k, 0);
    assert_int_equal(settings.facing, other);
    assert_int_equal(settings.balance, flag);
    near(settings.tolerance, 1e-5 * (1 + k), 0);
    near(settings.tie_distance, 0.5 + k, 0);
    assert_int_equal(settings.constraint, k ? CONTACT_CONSTRAINT_GAP_RATE : CONTACT_CONSTRAINT_BOTH);
    assert_int_equal(settings.stabilization, k ? CONTACT_STABILIZATION_NAIVE : CONTACT_STABILIZATION_CONTACT_STABILIZED);
  }
  ok(ContactSetAutomaticBalance(contact));
  get(contact, &settings);
  assert_int_equal(settings.balance, PETSC_FALSE); /* until the set-up finds that it suits the bodies */
  ok(ContactDestroy(&contact));
}

static void refused_values(void **state)
{
  const PetscErrorCode code = PETSC_ERR_ARG_OUTOFRANGE;
  Contact              contact;
  Settings             before, after;

  (void)state;
  ok(ContactCreate(PETSC_COMM_WORLD, &contact));
  get(contact, &before);
  refused(code, "energy excess -1|negative", ContactSetEnergyCap(contact, PETSC_TRUE, -1));
  refused(code, "tolerance of -1|negative", ContactSetTolerance(contact, -1));
  refused(code, "tie distance of 0|positive", ContactSetTieDistance(contact, 0));
  refused(code, "no constraint 3", ContactSetConstraint(contact, (ContactConstraint)3));
  refused(code, "no stabilization 3", ContactSetStabilization(contact, (ContactStabilization)3));
  get(contact, &after);
  near(after.excess, before.excess, 0);
  near(after.tolerance, before.tolerance, 0);
  near(after.tie_distance, before.tie_distance, 0);
  assert_int_equal(after.constraint, before.constraint);
  assert_int_equal(after.stabilization, before.stabilization);
  ok(ContactDestroy(&contact));
}

static void of_the_controller(void **state)
{
  Controller controller;
  PetscReal  part;
  PetscInt   cuts;

  (void)state;
  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  ok(ControllerSetEnergyGuard(controller, 0.125));
  ok(ControllerSetStepCuts(controller, 3));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "energy guard -1|negative", ControllerSetEnergyGuard(controller, -1));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "in halves 0 to|not -1", ControllerSetStepCuts(controller, -1));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "in halves 0 to|not 1000", ControllerSetStepCuts(controller, 1000));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "interval of 0 steps", ControllerSetMonitorInterval(controller, 0));
  ok(ControllerGetEnergyGuard(controller, &part));
  ok(ControllerGetStepCuts(controller, &cuts));
  near(part, 0.125, 0);
  assert_int_equal(cuts, 3);
  ok(ControllerDestroy(&controller));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(set_and_got),
      cmocka_unit_test(refused_values),
      cmocka_unit_test(of_the_controller),
  };

  return impakt_main(argc, argv, tests);
}
