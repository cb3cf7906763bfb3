/* The Schwarz alternating method for contact (Hoy, Tezaur, Mota): options, set-up, destruction. */
#include "alternationimpl.h"
#include <contact/rows/inversemass.h>
#include <checkpoint/checkpoint.h>
#include <sys/citations.h>
#include <sys/units.h>
#include <impakt/private/bodysweeps.h>

static const char *const Relaxations[]   = {"fixed", "aitken", "SchwarzRelaxation", "SCHWARZ_RELAXATION_", NULL};
static const char *const Transmissions[] = {"dirichlet_neumann",     "robin", "impedance", "SchwarzTransmission",
                                            "SCHWARZ_TRANSMISSION_", NULL};
static const char *const Predictors[]    = {"last", "inelastic", "SchwarzPredictor", "SCHWARZ_PREDICTOR_", NULL};
static const char *const Waveforms[]     = {"linear", "constant", "SchwarzWaveform", "SCHWARZ_WAVEFORM_", NULL};

static PetscErrorCode ContactSetFromOptions_Alternation(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;
  const char  *parameter   = "-schwarz_robin_parameter";
  PetscBool    set         = PETSC_FALSE;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEnum("-schwarz_transmission", "What is prescribed on both sides", "ContactSetFromOptions", Transmissions,
                             (PetscEnum)alternation->transmission, (PetscEnum *)&alternation->transmission, NULL));
  /* only where it has an effect, so that it is an unused option elsewhere */
  if (alternation->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN) {
    PetscCall(PetscOptionsEnum("-schwarz_traction", "Nodal force handed to the Neumann side", "ContactSetFromOptions", BodyTractionTypes,
                               (PetscEnum)alternation->traction, (PetscEnum *)&alternation->traction, NULL));
    PetscCall(PetscOptionsEnum("-schwarz_traction_waveform", "Traction of a partner with longer substeps in their course",
                               "ContactSetFromOptions", Waveforms, (PetscEnum)alternation->waveform, (PetscEnum *)&alternation->waveform,
                               NULL));
  }
  if (alternation->transmission == SCHWARZ_TRANSMISSION_IMPEDANCE) parameter = "-schwarz_impedance_parameter";
  if (alternation->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN)
    PetscCall(PetscOptionsReal(parameter, "Stiffness [N/m] or impedance [N s/m] for each unit of area", "ContactSetFromOptions",
                               alternation->parameter, &alternation->parameter, &set));
  PetscCall(PetscOptionsEnum("-schwarz_predictor", "Where the first sweep starts from", "ContactSetFromOptions", Predictors,
                             (PetscEnum)alternation->predictor, (PetscEnum *)&alternation->predictor, NULL));
  PetscCall(PetscOptionsBool("-contact_swap_sides", "Sides change with every controller step", "ContactSetFromOptions", alternation->swap,
                             &alternation->swap, NULL));
  PetscCall(PetscOptionsEnum("-schwarz_relaxation", "Relaxation of nrichardson", "ContactSetFromOptions", Relaxations,
                             (PetscEnum)alternation->relaxation, (PetscEnum *)&alternation->relaxation, NULL));
  PetscCall(ContactReadUnconverged(contact));
  PetscOptionsEnd();
  PetscCheck(!set || alternation->parameter > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "%s %g must be positive",
             parameter, (double)alternation->parameter);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUpUnknowns(Contact contact, PetscInt *unknowns)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  alternation->controller_step = contact->step;
  PetscCall(PetscCalloc2(contact->n_bodies, &alternation->exchange, contact->rows.n, &alternation->offset));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt substeps;

    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    PetscCall(TraceCreate(contact->body_rows[b].n, substeps, &alternation->exchange[b]));
  }
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    alternation->offset[i] = *unknowns;
    *unknowns += alternation->room[contact->rows.pair[i]];
  }
  PetscCall(PetscMalloc2(contact->rows.n, &alternation->left, contact->rows.n, &alternation->row_work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ties that keep their mass, with the rows as they are */
static PetscErrorCode SetUpTies(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  PetscCall(ContactSetUpTiedEnds(contact));
  if (!contact->ties.inverse || alternation->drift[0]) PetscFunctionReturn(PETSC_SUCCESS);
  contact->energy.unlimited = "tied nodes keep their mass, and their forces are not those of massless layers";
  PetscCall(PetscMalloc2(contact->rows.n, &alternation->drift[0], contact->rows.n, &alternation->drift[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactSetUp_Alternation(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;
  PetscInt     unknowns    = 0;

  PetscFunctionBegin;
  PetscCall(ImpaktCite(CITE_SCHWARZ));
  PetscCheck(
      contact->options.constraint != CONTACT_CONSTRAINT_BOTH, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
      "-contact_constraint both: with -contact_type alternation a closed gap has no rate already, since contact nodes with mass take "
      "velocity and acceleration from their partner and massless ones have none of their own; choose gap or gap_rate");
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetTractionType(contact->bodies[b], alternation->traction));
  if (alternation->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN) PetscCall(ContactWarnOfStages(contact, PETSC_TRUE));
  PetscCall(AlternationSetUpSides(contact));
  PetscCall(SetUpUnknowns(contact, &unknowns));
  PetscCall(AlternationSetUpTransmission(contact));
  PetscCall(ContactCopyAreas(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetRowWeights(contact->bodies[b], contact->body_rows[b].area));
  PetscCall(AlternationSetUpOuterSolver(contact, unknowns));
  PetscCall(SetUpTies(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactRowsChanged_Alternation(Contact contact)
{
  PetscFunctionBegin;
  if (((Alternation *)contact->data)->drift[0]) PetscCall(SetUpTies(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The end of a controller step, before the next one starts from it */
static PetscErrorCode ContactAccept_Alternation(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  if (contact->ties.inverse) PetscCall(InverseMassAlign(contact, contact->ties.inverse, BODY_AT_END, alternation->drift));
  if (alternation->swap) AlternationSwapSides(contact);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nothing is remembered from step to step but which side takes displacements, which contact itself has in a checkpoint */
static PetscErrorCode ContactVisit_Alternation(Contact contact, Checkpoint checkpoint)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  alternation->controller_step = contact->step;
  PetscCall(CheckpointVisitReals(checkpoint, "weight", contact->rows.n, alternation->weight));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactView_Alternation(Contact contact, PetscViewer viewer)
{
  const Alternation *alternation = (const Alternation *)contact->data;
  SNESType           type;

  PetscFunctionBegin;
  PetscCall(SNESGetType(alternation->snes, &type));
  PetscCall(PetscViewerASCIIPrintf(
      viewer, "  outer iteration %s%s, %s conditions, %s traction, %s predictor, tolerances %g%s and %g relative\n", type,
      alternation->relaxation == SCHWARZ_RELAXATION_AITKEN ? " (Aitken)" : "", Transmissions[alternation->transmission],
      alternation->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN ? BodyTractionTypes[alternation->traction] : "whole",
      Predictors[alternation->predictor], (double)alternation->atol, UnitsOf((PetscObject)contact, UNIT_LENGTH),
      (double)alternation->rtol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactDestroy_Alternation(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  for (PetscInt p = 0; alternation->trace && p < 2 * contact->n_pairs; p++) PetscCall(TraceDestroy(&alternation->trace[p]));
  for (PetscInt b = 0; alternation->exchange && b < contact->n_bodies; b++) PetscCall(TraceDestroy(&alternation->exchange[b]));
  for (PetscInt k = 0; k < 2; k++) PetscCall(TraceDestroy(&alternation->rate[k]));
  PetscCall(SNESDestroy(&alternation->snes));
  PetscCall(VecDestroy(&alternation->x));
  PetscCall(VecDestroy(&alternation->residual));
  PetscCall(VecDestroy(&alternation->last_residual));
  PetscCall(ContactDestroyTiedEnds(contact));
  PetscCall(PetscFree2(alternation->drift[0], alternation->drift[1]));
  PetscCall(PetscFree5(alternation->levels[0], alternation->levels[1], alternation->trace, alternation->room, alternation->kinematic));
  PetscCall(PetscFree2(alternation->exchange, alternation->offset));
  PetscCall(PetscFree3(alternation->weight, alternation->mass[0], alternation->mass[1]));
  PetscCall(PetscFree2(alternation->left, alternation->row_work));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   CONTACT_ALTERNATION - the Schwarz alternating method: displacements one way, tractions the other, until both agree

   Options Database Keys:
+  -schwarz_transmission (dirichlet_neumann|robin|impedance) - what is prescribed on both sides
.  -schwarz_traction (internal|reaction)                     - nodal force handed over: without or with inertia
.  -schwarz_snes_...                                         - the outer iteration, a `SNES` of type anderson
-  -schwarz_..., -contact_...                                - all others, with defaults in options/README.md

   Level: beginner

   Note:
   A node may belong to several pairs: in a corner, or over the joint of two bodies side by side. Partners side by side share its
displacement and force by the areas that they cover, and the mean of their gaps is closed. Two plane obstacles with one normal at one body
are an error.

   Reference:
.  * - J. Hoy, I. Tezaur, A. Mota, The Schwarz alternating method for multiscale contact mechanics, 2021

.seealso: `ContactSetType()`, `CONTACT_PENALTY`, `CONTACT_LAGRANGE`
M*/
PetscErrorCode ContactCreate_Alternation(Contact contact)
{
  Alternation *alternation;

  PetscFunctionBegin;
  PetscCall(PetscNew(&alternation));
  alternation->traction        = BODY_TRACTION_INTERNAL;
  alternation->predictor       = SCHWARZ_PREDICTOR_INELASTIC;
  contact->prescribes          = PETSC_TRUE;
  contact->data                = alternation;
  contact->ops->setfromoptions = ContactSetFromOptions_Alternation;
  contact->ops->setup          = ContactSetUp_Alternation;
  contact->ops->step           = ContactStep_Alternation;
  contact->ops->stored         = ContactStoresNothing;
  contact->ops->rowschanged    = ContactRowsChanged_Alternation;
  contact->ops->steplevel      = AlternationSetStepLevel;
  contact->ops->accept         = ContactAccept_Alternation;
  contact->ops->view           = ContactView_Alternation;
  contact->ops->visit          = ContactVisit_Alternation;
  contact->ops->destroy        = ContactDestroy_Alternation;
  PetscFunctionReturn(PETSC_SUCCESS);
}
