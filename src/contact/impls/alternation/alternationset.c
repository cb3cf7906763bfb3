/* Setters of the Schwarz alternating method, beside its options. */
#include "alternationimpl.h"
#include "../methodset.h"

/*@
  ContactSchwarzSetTransmission - sets what is prescribed on both sides of the contact boundary

  Logically Collective

  Input Parameters:
+ contact      - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- transmission - the conditions

  Options Database Key:
. -schwarz_transmission (dirichlet_neumann|robin|impedance) - what is prescribed on both sides of the contact boundary

  Level: intermediate

.seealso: `Contact`, `CONTACT_ALTERNATION`, `SchwarzTransmission`
@*/
PetscErrorCode ContactSchwarzSetTransmission(Contact contact, SchwarzTransmission transmission)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveEnum(contact, transmission, 2);
  ContactCheckEnum(contact, transmission, SCHWARZ_TRANSMISSION_IMPEDANCE, "transmission condition");
  alternation->transmission = transmission;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetRobinParameter - sets the stiffness of Robin conditions

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- stiffness - for each unit of area: [N/m^3] in three dimensions; in two for each metre of the contact line, at the thickness of the bodies
              [N/m^2]; in one that of the contact point [N/m]; by default E/h of the Neumann side's contact elements, for ties the stiffness
              of the first side's contact nodes, with 4 m / dt^2 of those that keep their mass

  Options Database Key:
. -schwarz_robin_parameter alpha - the stiffness of Robin conditions

  Level: advanced

.seealso: `Contact`, `CONTACT_ALTERNATION`
@*/
PetscErrorCode ContactSchwarzSetRobinParameter(Contact contact, PetscReal stiffness)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveReal(contact, stiffness, 2);
  PetscCheck(stiffness > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE, "A Robin parameter of %g must be positive",
             (double)stiffness);
  alternation->robin_parameter = stiffness;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetImpedanceParameter - sets the impedance of impedance conditions

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- impedance - for each unit of area: [N s/m^3] in three dimensions; in two for each metre of the contact line, at the thickness of the
bodies [N s/m^2]; in one that of the contact point [N s/m]; by default that of plane waves in the Neumann side, see `BodyGetImpedance()`

  Options Database Key:
. -schwarz_impedance_parameter z - the impedance

  Level: advanced

.seealso: `Contact`, `CONTACT_ALTERNATION`, `ContactSchwarzSetTransmission()`, `ContactSchwarzSetRobinParameter()`
@*/
PetscErrorCode ContactSchwarzSetImpedanceParameter(Contact contact, PetscReal impedance)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveReal(contact, impedance, 2);
  PetscCheck(impedance > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE, "An impedance of %g must be positive",
             (double)impedance);
  alternation->impedance = impedance;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetTraction - sets the nodal force that is handed to the Neumann side

  Logically Collective

  Input Parameters:
+ contact  - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- traction - without or with the inertia of the nodes

  Options Database Key:
. -schwarz_traction (internal|reaction) - the nodal force that is handed to the Neumann side

  Level: advanced

.seealso: `Contact`, `CONTACT_ALTERNATION`, `BodyTractionType`
@*/
PetscErrorCode ContactSchwarzSetTraction(Contact contact, BodyTractionType traction)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveEnum(contact, traction, 2);
  ContactCheckEnum(contact, traction, BODY_TRACTION_REACTION, "traction");
  alternation->traction = traction;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetTractionWaveform - sets how the traction of a partner with longer substeps varies in the course of them

  Logically Collective

  Input Parameters:
+ contact  - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- waveform - the waveform

  Options Database Key:
. -schwarz_traction_waveform (linear|constant) - how the traction of a partner with longer substeps varies in the course of them

  Level: advanced

.seealso: `Contact`, `CONTACT_ALTERNATION`, `SchwarzWaveform`
@*/
PetscErrorCode ContactSchwarzSetTractionWaveform(Contact contact, SchwarzWaveform waveform)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveEnum(contact, waveform, 2);
  ContactCheckEnum(contact, waveform, SCHWARZ_WAVEFORM_CONSTANT, "waveform");
  alternation->waveform = waveform;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetPredictor - sets where the first sweep of a controller step starts from

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- predictor - the predictor

  Options Database Key:
. -schwarz_predictor (last|trial|extrapolate|inelastic) - where the first sweep of a controller step starts from

  Level: intermediate

.seealso: `Contact`, `CONTACT_ALTERNATION`, `SchwarzPredictor`
@*/
PetscErrorCode ContactSchwarzSetPredictor(Contact contact, SchwarzPredictor predictor)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveEnum(contact, predictor, 2);
  ContactCheckEnum(contact, predictor, SCHWARZ_PREDICTOR_INELASTIC, "predictor");
  alternation->predictor = predictor;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetSwapSides - sets whether the sides change with every controller step

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- swap    - whether they do

  Options Database Key:
. -contact_swap_sides (true|false) - whether the sides change with every controller step

  Level: advanced

.seealso: `Contact`, `CONTACT_ALTERNATION`
@*/
PetscErrorCode ContactSchwarzSetSwapSides(Contact contact, PetscBool swap)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveBool(contact, swap, 2);
  alternation->swap = swap;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetRelaxation - sets the relaxation of the plain alternation

  Logically Collective

  Input Parameters:
+ contact    - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- relaxation - the relaxation

  Options Database Key:
. -schwarz_relaxation (fixed|aitken) - the relaxation of the plain alternation

  Level: advanced

.seealso: `Contact`, `CONTACT_ALTERNATION`, `SchwarzRelaxation`
@*/
PetscErrorCode ContactSchwarzSetRelaxation(Contact contact, SchwarzRelaxation relaxation)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveEnum(contact, relaxation, 2);
  ContactCheckEnum(contact, relaxation, SCHWARZ_RELAXATION_AITKEN, "relaxation");
  alternation->relaxation = relaxation;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetConvergence - sets what change of position is compared with the tolerances

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- test    - the test

  Options Database Key:
. -schwarz_convergence (auto|position|contact_position|mismatch) - what change of position is compared with the tolerances

  Level: advanced

.seealso: `Contact`, `CONTACT_ALTERNATION`, `SchwarzConvergence`
@*/
PetscErrorCode ContactSchwarzSetConvergence(Contact contact, SchwarzConvergence test)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveEnum(contact, test, 2);
  ContactCheckEnum(contact, test, SCHWARZ_CONVERGENCE_MISMATCH, "convergence test");
  alternation->convergence = test;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSchwarzSetRecheck - sets whether tensile nodes leave contact within the controller step

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, of type `CONTACT_ALTERNATION`, not yet set up
- recheck - whether they do; else they leave at its end

  Options Database Key:
. -schwarz_recheck (true|false) - whether tensile nodes leave contact within the controller step

  Level: advanced

.seealso: `Contact`, `CONTACT_ALTERNATION`
@*/
PetscErrorCode ContactSchwarzSetRecheck(Contact contact, PetscBool recheck)
{
  Alternation *alternation = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_ALTERNATION, NULL, "CONTACT_ALTERNATION", (void **)&alternation);
  PetscValidLogicalCollectiveBool(contact, recheck, 2);
  alternation->recheck = recheck;
  PetscFunctionReturn(PETSC_SUCCESS);
}
