/* What a user should know before believing a run, a line each at its end and in the summary: what is amiss, how much, what to do. */
#include "verdict.h"
#include <controller/plausible.h>
#include <impakt/private/bodymass.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodyrows.h>
#include <impakt/private/contactsteps.h>
#include <stdarg.h>

/* Parts of its largest energy or work from which on a run says that it has lost them, or gained: nothing makes energy */
#define ENERGY_LOSS 0.02
#define ENERGY_GAIN 0.01
/* The same of the momentum, which contact keeps to round-off unless it is known to lose some */
#define MOMENTUM_ERROR 1e-3
/* Of the angular momentum, of which rows that follow the surfaces lose some; it is 4.6e-4 in bars-3d.opts, whose meshes do not match */
#define ANGULAR_ERROR 1e-3

/* Nodes that lie beyond the end of the partner guard its corner and bear up to 17 % of the impulse of blocks that rock on each other
   (stack.opts). An overhanging block that they keep from tipping has 70 % of it on them. */
#define BEYOND 0.25

/* Normal forces along rows of bodies without inertia may be off along the surfaces by this much of what friction can bear: it is 0.02 for
   the spheres of cattaneo-spheres.opts, 0.07 for a linear band that stretches by 1 % along a drum, whose held end bears 6 % too much */
#define TILT 0.05

/* How far massless contact nodes may move a body's centre of mass unsaid [parts of its least extent]: a plate that is three elements thick
   keeps it, one of two triangles moves it by 7 % */
#define CENTRE_SHIFT 0.01
/* The same of a moment of inertia, relative: 71 % in a plate that is two elements thick and may touch on both sides */
#define INERTIA_CHANGE 0.2

/* Adds a sentence; where it is on one of many bodies or pairs, of each kind the first few, and the others are counted */
static PetscErrorCode Add(Verdict *verdict, VerdictKind kind, const char format[], ...) PETSC_ATTRIBUTE_FORMAT(3, 4);
static PetscErrorCode Add(Verdict *verdict, VerdictKind kind, const char format[], ...)
{
  va_list        arguments;
  PetscErrorCode failure;

  PetscFunctionBegin;
  if (kind != VERDICT_RUN && verdict->found[kind]++ >= VERDICT_OF_A_KIND) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(verdict->n < VERDICT_MAX, PETSC_COMM_SELF, PETSC_ERR_PLIB, "There are more than %d sentences on a run", VERDICT_MAX);
  va_start(arguments, format);
  failure = PetscVSNPrintf(verdict->text[verdict->n++], VERDICT_SIZE, format, NULL, arguments);
  va_end(arguments);
  PetscFunctionReturn(failure);
}

/* How many more there are of each kind */
static PetscErrorCode AddNumbers(Verdict *verdict)
{
  static const char *const kinds[][3] = {
      [VERDICT_UNITS]    = {"body", "bodies", "with numbers that are implausible in the units of -units"},
      [VERDICT_CENTRE]   = {"body", "bodies", "whose centre of mass massless contact nodes move"},
      [VERDICT_INERTIA]  = {"body", "bodies", "whose moments of inertia massless contact nodes change"},
      [VERDICT_TURNED]   = {"linear body", "linear bodies", "that turned too far"},
      [VERDICT_INVERTED] = {"linear body", "linear bodies", "of which elements were inside out"},
      [VERDICT_UNTIED]   = {"pair", "pairs", "the ties of which tie nothing"},
      [VERDICT_APART]    = {"pair", "pairs", "that never touched"},
      [VERDICT_BEYOND]   = {"pair", "pairs", "of which nodes beyond the end of the partner bear much"},
      [VERDICT_INSIDE]   = {"body", "bodies", "that were inside others"},
  };

  PetscFunctionBegin;
  for (PetscInt k = 0; k < VERDICT_KINDS; k++) {
    const PetscInt more = verdict->found[k] - VERDICT_OF_A_KIND;

    if (more > 0)
      PetscCall(Add(verdict, VERDICT_RUN, "as above, there %s %" PetscInt_FMT " more %s %s", more == 1 ? "is" : "are", more,
                    kinds[k][more > 1], kinds[k][2]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gain and loss are parts of `scale` [J] */
static PetscErrorCode LookAtEnergy(Controller controller, Contact contact, const ContactTraits *traits, PetscReal gain, PetscReal loss,
                                   PetscReal scale, Verdict *verdict)
{
  const PetscBool lost    = (PetscBool)(loss > ENERGY_LOSS && loss > gain);
  const double    percent = (double)(100 * (lost ? -loss : gain));
  PetscReal       step, resolved, unresolved;

  PetscFunctionBegin;
  PetscCall(ContactGetUnresolvedEnergy(contact, &unresolved));
  if (PetscMax(gain, loss) * scale <= unresolved || (gain <= ENERGY_GAIN && loss <= ENERGY_LOSS)) PetscFunctionReturn(PETSC_SUCCESS);
  if (verdict->statics.all) { /* masses and waves are no matter there */
    if (verdict->statics.balanced)
      PetscCall(
          Add(verdict, VERDICT_RUN,
              "the energy error is %+.3g %% at its worst: forces change too much within a load step for its work to be told from those "
              "at its ends; a smaller -time_step makes it less, where surfaces slide together with a smaller -contact_slip_bound",
              percent));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ControllerGetTimes(controller, NULL, &step, NULL));
  PetscCall(ControllerGetResolvedStep(controller, &resolved));
  if (traits->takes && lost) PetscCall(Add(verdict, VERDICT_RUN, "the energy error is %+.3g %% at its worst: %s", percent, traits->takes));
  else if (traits->unlimited)
    PetscCall(Add(verdict, VERDICT_RUN,
                  "the energy error is %+.3g %% at its worst, and contact may bring or take some, since %s; massless contact nodes "
                  "(-<body>_mass_redistribute, the default) keep it",
                  percent, traits->unlimited));
  else
    PetscCall(Add(verdict, VERDICT_RUN, "the energy error is %+.3g %% at its worst; %s", percent,
                  resolved > 0 && resolved < step
                      ? "-time_step auto, or another smaller one, makes it less"
                      : "a smaller -time_step makes it less, where surfaces slide together with a smaller -contact_slip_bound"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LookAtSteps(Controller controller, Contact contact, const StatisticsResults *results, Verdict *verdict)
{
  /* what penalty springs hold they give back */
  const PetscReal in_springs = results->energy_scale > 0 ? results->uncounted_energy_max / results->energy_scale : 0;
  const PetscReal gain = results->energy_error_max, loss = -results->energy_error_min - in_springs;
  const char     *reason, *always;
  ContactTraits   traits;
  ContactCounts   counts;
  ControllerCuts  cuts;

  PetscFunctionBegin;
  PetscCall(ContactGetCounts(contact, &counts));
  PetscCall(ControllerGetCuts(controller, &cuts));
  PetscCall(ContactGetTraits(contact, &traits));
  always = traits.unlimited;
  reason = traits.not_always;
  PetscCall(LookAtEnergy(controller, contact, &traits, gain, loss, results->energy_scale, verdict));
  if (reason && results->momentum_error_max > MOMENTUM_ERROR)
    PetscCall(Add(verdict, VERDICT_RUN, "the momentum error is %.3g %%: %s; choose equal substeps, or leave -schwarz_transmission out",
                  (double)(100 * results->momentum_error_max), reason));
  else if (always && results->momentum_scale > 0 && results->momentum_error_max > MOMENTUM_ERROR)
    PetscCall(
        Add(verdict, VERDICT_RUN,
            "the momentum error is %.3g %%, and contact may lose some, since %s; massless contact nodes (-<body>_mass_redistribute, the "
            "default) keep it",
            (double)(100 * results->momentum_error_max), always));
  else if (results->momentum_scale > 0 && results->momentum_error_max > MOMENTUM_ERROR)
    PetscCall(Add(verdict, VERDICT_RUN,
                  "the momentum error is %.3g %%, as where round-off of a body's stiffness hides its mass: check units and constants of "
                  "materials, or take a smaller -time_step",
                  (double)(100 * results->momentum_error_max)));
  if (results->momentum_scale > 0 && results->angular_momentum_error_max > ANGULAR_ERROR)
    PetscCall(Add(verdict, VERDICT_RUN,
                  "the angular momentum error is %.3g %%; it is less with nonlinear materials where bodies turn, and with a smaller "
                  "-time_step",
                  (double)(100 * results->angular_momentum_error_max)));
  if (counts.unlimited_steps && !(gain <= traits.energy_excess))
    PetscCall(Add(verdict, VERDICT_RUN, "%" PetscInt_FMT " step%s gained more energy at contact than -contact_energy_excess allows%s%s",
                  counts.unlimited_steps, counts.unlimited_steps == 1 ? "" : "s", reason ? ", since " : "", reason ? reason : ""));
  if (counts.ambiguous_steps)
    PetscCall(Add(verdict, VERDICT_RUN,
                  "in %" PetscInt_FMT " step%s friction may have had more than one solution, since its coefficient is large for the way in "
                  "which forces across a surface press on it; nodes that slide may stick as well",
                  counts.ambiguous_steps, counts.ambiguous_steps == 1 ? "" : "s"));
  if (counts.friction_tilt > TILT)
    PetscCall(
        Add(verdict, VERDICT_RUN,
            "surfaces have turned since contact rows were built, or linear bodies have: along surfaces normal forces are off by up to "
            "%.3g %% of what friction can bear; take materials that are not linear, and a smaller -contact_angle_bound (1e-4)",
            (double)(100 * counts.friction_tilt)));
  if (counts.unconverged_steps)
    PetscCall(Add(verdict, VERDICT_RUN, "%" PetscInt_FMT " step%s accepted without having converged (-schwarz_unconverged accept)",
                  counts.unconverged_steps, counts.unconverged_steps == 1 ? " was" : "s were"));
  if (cuts.lossy_steps && !(gain <= traits.energy_tolerance && loss <= traits.energy_tolerance))
    PetscCall(Add(verdict, VERDICT_RUN,
                  "%" PetscInt_FMT " step%s accepted although contact took or brought more energy than -contact_energy_tolerance after "
                  "the last cut, to %.3g%s; a smaller -time_step, or more -controller_step_cuts, makes it less",
                  cuts.lossy_steps, cuts.lossy_steps == 1 ? " was" : "s were", (double)cuts.smallest_step,
                  UnitsText(verdict->units, UNIT_TIME)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the mass that is left to a body with massless contact nodes cannot have the body's centre of mass */
static PetscErrorCode LookAtMass(Body body, const char name[], Verdict *verdict)
{
  PetscReal shift[3] = {0}, lower[3], upper[3], thickness = PETSC_MAX_REAL, square = 0, inertia;
  PetscInt  dim;
  DM        dm;

  PetscFunctionBegin;
  PetscCall(BodyGetMassRedistribution(body, NULL, NULL, shift, NULL));
  PetscCall(BodyGetInertiaChange(body, &inertia));
  PetscCall(BodyGetDM(body, &dm));
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(DMGetBoundingBox(dm, lower, upper));
  for (PetscInt d = 0; d < dim; d++) {
    square += PetscSqr(shift[d]);
    thickness = PetscMin(thickness, upper[d] - lower[d]);
  }
  if (PetscSqrtReal(square) > CENTRE_SHIFT * thickness)
    PetscCall(Add(verdict, VERDICT_CENTRE,
                  "massless contact nodes move the centre of mass of body '%s' by %.3g%s, %.3g %% of its least extent: set "
                  "-%s_mass_redistribute auto, which keeps it, or refine it across",
                  name, (double)PetscSqrtReal(square), UnitsText(verdict->units, UNIT_LENGTH),
                  (double)(100 * PetscSqrtReal(square) / thickness), name));
  else if (inertia > INERTIA_CHANGE)
    PetscCall(Add(verdict, VERDICT_INERTIA,
                  "massless contact nodes change moments of inertia of body '%s' by up to %.3g %%: it turns as another body does; "
                  "set -%s_mass_redistribute auto, which keeps them, or refine it across",
                  name, (double)(100 * inertia), name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LookAtBody(Body body, const PetscReal box[6], const BodyStatistics *statistics, Verdict *verdict)
{
  const char *name;
  char        doubt[DOUBT_SIZE];
  PetscBool   linear;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetName((PetscObject)body, &name));
  PetscCall(BodyDoubtUnits(body, box, doubt));
  if (doubt[0]) PetscCall(Add(verdict, VERDICT_UNITS, "%s", doubt));
  PetscCall(LookAtMass(body, name, verdict));
  PetscCall(BodyIsLinear(body, &linear));
  if (linear && statistics->rotation_max > STATISTICS_FAR_TURN)
    PetscCall(Add(verdict, VERDICT_TURNED, "linear body '%s' has turned by %.3g rad: set a nonlinear -%s_material_type", name,
                  (double)statistics->rotation_max, name));
  if (!statistics->inverted_max) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Add(verdict, VERDICT_INVERTED,
                "up to %" PetscInt_FMT " elements of linear body '%s' were inside out: its figures mean nothing from then on",
                statistics->inverted_max, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LookAtOverlap(Contact contact, Body body, const BodyStatistics *statistics, Verdict *verdict)
{
  const ContactOverlap *overlap = &statistics->overlap;
  const char           *name, *other, *advice = "they are no pair of -contact_pairs";
  PetscBool             penalty;

  PetscFunctionBegin;
  if (!(overlap->part > CONTACT_OVERLAP)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectGetName((PetscObject)body, &name));
  PetscCall(ContactGetOverlapName(contact, overlap, &other));
  PetscCall(PetscObjectTypeCompare((PetscObject)contact, CONTACT_PENALTY, &penalty));
  if (overlap->pair && penalty) advice = "set a larger -contact_penalty";
  else if (overlap->pair)
    advice = "refine them there, give the rows to the one with the sharper corners (-contact_rows), or take a smaller -time_step";
  PetscCall(Add(
      verdict, VERDICT_INSIDE, "'%s' and '%s' were %.3g%s inside each other, %.3g %% of an element, at (%.4g, %.4g, %.4g) and %.4g%s: %s",
      name, other, (double)overlap->depth, UnitsText(verdict->units, UNIT_LENGTH), (double)(100 * overlap->part), (double)overlap->x[0],
      (double)overlap->x[1], (double)overlap->x[2], (double)statistics->overlap_time, UnitsText(verdict->units, UNIT_TIME), advice));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LookAtPair(Contact contact, PetscInt p, const ContactPairState *state, const StatisticsResults *results,
                                 Verdict *verdict)
{
  const char *name;
  char        nearest[64];
  ContactLaw  law;
  PetscBool   named, tied;
  PetscInt    side;

  PetscFunctionBegin;
  PetscCall(ContactGetPair(contact, p, &name, NULL, NULL));
  PetscCall(ContactGetPairLaw(contact, p, &law));
  tied = (PetscBool)(law == CONTACT_LAW_TIED || law == CONTACT_LAW_GLUE);
  if (tied && !results->pairs[p].active_max)
    PetscCall(Add(verdict, VERDICT_UNTIED, "the ties of %s tie nothing: no node of one surface lies opposite the other", name));
  PetscCall(ContactGetPairTraits(contact, p, &named, NULL, NULL));
  if (named && !tied && !results->pairs[p].steps_in_contact) {
    if (results->pairs[p].gap_min < CONTACT_NO_GAP)
      PetscCall(PetscSNPrintf(nearest, sizeof(nearest), "its smallest gap was %.3g%s", (double)results->pairs[p].gap_min,
                              UnitsText(verdict->units, UNIT_LENGTH)));
    else PetscCall(PetscSNPrintf(nearest, sizeof(nearest), "no node of one surface ever lay opposite the other"));
    PetscCall(Add(verdict, VERDICT_APART,
                  "pair %s never touched: %s; check where its bodies start (the boxes that are printed), where they move, and -time_end",
                  name, nearest));
  }
  if (state->beyond_impulse > BEYOND * PetscAbsReal(state->normal_impulse)) { /* ties pull as well as push */
    PetscCall(ContactGetPairRowSide(contact, p, &side));
    PetscCall(Add(verdict, VERDICT_BEYOND,
                  "nodes beyond the end of the partner bear %.3g %% of the impulse of %s, as if it reached there: what hangs over may not "
                  "tip; set -contact_rows %s, or refine the surface",
                  (double)(100 * state->beyond_impulse / PetscAbsReal(state->normal_impulse)), name, side ? "first" : "second"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode VerdictMake(Controller controller, const StatisticsResults *results, Verdict *verdict)
{
  Contact           contact;
  ContactPairState *states;
  const Body       *bodies;
  PetscReal        *boxes;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(verdict, sizeof(*verdict)));
  PetscCall(UnitsGet((PetscObject)controller, &verdict->units));
  PetscCall(ControllerGetStatics(controller, &verdict->statics));
  PetscCall(ControllerGetBodies(controller, NULL, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(PetscMalloc1(6 * results->n_bodies, &boxes));
  PetscCall(BodyGetAllBoxes(results->n_bodies, bodies, boxes));
  PetscCall(LookAtSteps(controller, contact, results, verdict));
  for (PetscInt b = 0; b < results->n_bodies; b++) {
    PetscCall(LookAtBody(bodies[b], boxes + 6 * b, &results->bodies[b], verdict));
    PetscCall(LookAtOverlap(contact, bodies[b], &results->bodies[b], verdict));
  }
  PetscCall(PetscFree(boxes));
  if (results->steps && results->n_pairs) {
    PetscCall(PetscMalloc1(results->n_pairs, &states));
    PetscCall(ContactGetPairStates(contact, states));
    for (PetscInt p = 0; p < results->n_pairs; p++) PetscCall(LookAtPair(contact, p, &states[p], results, verdict));
    PetscCall(PetscFree(states));
  }
  PetscCall(AddNumbers(verdict));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first line of the table: how far the run came, its energy error, and how much there is to warn of */
PetscErrorCode VerdictView(Controller controller, const StatisticsResults *results, const Verdict *verdict, PetscViewer viewer)
{
  char     energy[64] = "", warnings[64] = "";
  PetscInt step, steps;

  PetscFunctionBegin;
  PetscCall(ControllerGetStep(controller, &step));
  PetscCall(ControllerGetTimes(controller, NULL, NULL, &steps));
  if (verdict->statics.balanced)
    PetscCall(PetscSNPrintf(energy, sizeof(energy), ", energy error %.2g %%", (double)(100 * StatisticsGetWorstError(results))));
  if (verdict->n)
    PetscCall(
        PetscSNPrintf(warnings, sizeof(warnings), " with %" PetscInt_FMT " warning%s, see below", verdict->n, verdict->n == 1 ? "" : "s"));
  if (step == steps)
    PetscCall(PetscViewerASCIIPrintf(viewer, "finished%s: %" PetscInt_FMT " step%s%s%s\n", warnings, steps, steps == 1 ? "" : "s", energy,
                                     verdict->n ? "" : ", nothing to warn of in its figures"));
  else
    PetscCall(PetscViewerASCIIPrintf(viewer, "stopped%s: %" PetscInt_FMT " of %" PetscInt_FMT " steps%s%s\n", warnings, step, steps, energy,
                                     verdict->n ? "" : ", nothing to warn of in its figures"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode VerdictPrint(MPI_Comm comm, const Verdict *verdict)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < verdict->n; i++) PetscCall(PetscFPrintf(comm, stderr, "impakt: warning: %s\n", verdict->text[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
