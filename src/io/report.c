/* The table that a run prints at its end. */
#include "report.h"
#include "ranks.h"
#include <math.h>
#include <sys/units.h>

/* Times of first contact below this part of the duration of contact are printed as 0: round-off of start + gap / speed */
#define ROUND_OFF 1e-12

/* Pairs whose forces are printed; the summary has those of all */
#define MOST_PAIRS 8
/* A force of more than PEAK_FACTOR times the mean over MEAN_STEPS steps, in the first PEAK_STEPS of a contact, is explained */
#define PEAK_FACTOR 2
#define PEAK_STEPS  3
#define MEAN_STEPS  10

typedef struct {
  PetscViewer              viewer;
  const StatisticsResults *results;
  ControllerStatics        statics;
  Units                    units;
  ExactFigures             exact; /* not-a-number: the run is compared with none */
} Report;

/* Prints a line with a value and, if there is one, the exact value beside it */
static PetscErrorCode PrintText(const Report *report, const char name[], PetscReal value, const char unit[], PetscReal exact)
{
  PetscFunctionBegin;
  if (PetscIsInfOrNanReal(value)) PetscCall(PetscViewerASCIIPrintf(report->viewer, "  %-32s %13s\n", name, "none"));
  else if (PetscIsInfOrNanReal(exact)) PetscCall(PetscViewerASCIIPrintf(report->viewer, "  %-32s %13.6g%s\n", name, (double)value, unit));
  else PetscCall(PetscViewerASCIIPrintf(report->viewer, "  %-32s %13.6g%-5s exact %.6g\n", name, (double)value, unit, (double)exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintValue(const Report *report, const char name[], PetscReal value, UnitDimension dimension, PetscReal exact)
{
  PetscFunctionBegin;
  PetscCall(PrintText(report, name, value, UnitsText(report->units, dimension), exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintPercent(const Report *report, const char name[], PetscReal value)
{
  PetscFunctionBegin;
  PetscCall(PrintText(report, name, 100 * value, " %", NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintCount(const Report *report, const char name[], PetscInt count, PetscInt of)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(report->viewer, "  %-32s %13" PetscInt_FMT, name, count));
  if (of >= 0) PetscCall(PetscViewerASCIIPrintf(report->viewer, " of %" PetscInt_FMT, of));
  PetscCall(PetscViewerASCIIPrintf(report->viewer, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* When bodies touched. In statics, time only counts loads: bodies that touch in all load steps have the number of these alone. */
static PetscErrorCode ViewTimes(const Report *report)
{
  const ContactStatistics *c      = &report->results->contact;
  const PetscBool          always = (PetscBool)(report->statics.all && c->steps_in_contact == report->results->steps);
  PetscReal                onset = c->times.onset, impact = report->exact.impact;

  PetscFunctionBegin;
  if (PetscAbsReal(impact) < ROUND_OFF * (report->exact.release - impact)) impact = 0;
  if (PetscAbsReal(onset) < ROUND_OFF * (c->release_time - onset)) onset = 0;
  if (!always) PetscCall(PrintValue(report, "first contact", onset, UNIT_TIME, impact));
  if (!always && c->times.in_contact_at_end) PetscCall(PetscViewerASCIIPrintf(report->viewer, "  %-32s still in contact\n", "release"));
  else if (!always) PetscCall(PrintValue(report, "release", c->times.separation, UNIT_TIME, report->exact.release));
  if (!always) PetscCall(PrintCount(report, "onsets", c->onsets, -1));
  PetscCall(PrintCount(report, "steps in contact", c->steps_in_contact, report->results->steps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewContact(const Report *report, Contact contact)
{
  const ContactStatistics *c = &report->results->contact;
  ContactType              type;
  ContactCounts            counts;
  ContactTraits            traits;

  PetscFunctionBegin;
  PetscCall(ContactGetType(contact, &type));
  PetscCall(ContactGetTraits(contact, &traits));
  PetscCall(PetscViewerASCIIPrintf(report->viewer, "contact (%s)\n", type));
  PetscCall(ViewTimes(report));
  if (traits.pulls) PetscCall(PrintValue(report, "tension of a node, peak", c->tension_max, UNIT_FORCE, NAN));
  if (!report->statics.all) PetscCall(PrintValue(report, "impulse along the normals", c->impulse, UNIT_IMPULSE, report->exact.impulse));
  PetscCall(PrintValue(report, "largest penetration", PetscMax(0, -c->gap_min), UNIT_LENGTH, NAN));
  if (traits.friction) PetscCall(PrintValue(report, "energy taken by friction", c->friction_loss, UNIT_ENERGY, NAN));
  PetscCall(ContactGetCounts(contact, &counts));
  if (traits.breaks) PetscCall(PrintValue(report, "energy taken by damage of glue", counts.glue_loss, UNIT_ENERGY, NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A line with the sum of a pair's forces along the normals of the nodes, and the magnitude of their sum as vectors */
static PetscErrorCode PrintForces(const Report *report, const char name[], PetscReal along, PetscReal resultant, PetscReal exact)
{
  const char *unit = UnitsText(report->units, UNIT_FORCE);

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(report->viewer, "    %-30s %13.6g%s", name, (double)along, unit));
  if (!PetscIsInfOrNanReal(resultant)) PetscCall(PetscViewerASCIIPrintf(report->viewer, " %14.6g%s", (double)resultant, unit));
  if (!PetscIsInfOrNanReal(exact)) PetscCall(PetscViewerASCIIPrintf(report->viewer, "  exact %.6g", (double)exact));
  PetscCall(PetscViewerASCIIPrintf(report->viewer, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `exact`: the mean force, or not-a-number */
static PetscErrorCode ViewPairForces(const Report *report, const char name[], const ContactStatistics *pair, PetscReal exact)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(report->viewer, "  %s\n", name));
  if (!report->statics.all && !PetscIsNanReal(pair->force_mean)) { /* over time, which statics have not */
    PetscCall(PrintForces(report, "mean", pair->force_mean, pair->resultant_mean, exact));
    PetscCall(PrintForces(report, "standard deviation", pair->force_std, NAN, NAN));
  }
  PetscCall(PrintForces(report, "peak", pair->force_peak, pair->resultant_peak, NAN));
  PetscCall(PrintForces(report, "at the end", pair->force_final, StatisticsNorm(pair->resultant), NAN));
  if (!report->statics.all && pair->steps_in_contact >= MEAN_STEPS && pair->peak_step >= 1 && pair->peak_step <= PEAK_STEPS &&
      pair->force_mean > 0 && pair->force_peak > PEAK_FACTOR * pair->force_mean)
    PetscCall(PetscViewerASCIIPrintf(
        report->viewer,
        "    the peak is that of step %" PetscInt_FMT " of a contact, %.3g times the mean of %.6g%s: it depends on "
        "the step, in which contact stops what it meets; take mean and impulse\n",
        pair->peak_step, (double)(pair->force_peak / pair->force_mean), (double)pair->force_mean, UnitsText(report->units, UNIT_FORCE)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewForces(const Report *report, Contact contact)
{
  const char *name;
  PetscInt    touched = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < report->results->n_pairs; p++) {
    const ContactStatistics *pair = &report->results->pairs[p];

    if (!pair->steps_in_contact) continue;
    if (!touched) PetscCall(PetscViewerASCIIPrintf(report->viewer, "contact forces %33s %16s\n", "sum along normals", "resultant"));
    if (touched++ >= MOST_PAIRS) continue;
    PetscCall(ContactGetPair(contact, p, &name, NULL, NULL));
    PetscCall(ViewPairForces(report, name, pair, p ? NAN : report->exact.force));
  }
  if (touched > MOST_PAIRS)
    PetscCall(
        PetscViewerASCIIPrintf(report->viewer, "  and of %" PetscInt_FMT " more pairs, which -output_summary has\n", touched - MOST_PAIRS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewSweeps(const Report *report, Controller controller, Contact contact)
{
  const StatisticsResults *results = report->results;
  ContactCounts            counts;
  ControllerCuts           cuts;

  PetscFunctionBegin;
  PetscCall(ControllerGetCuts(controller, &cuts));
  PetscCall(ContactGetCounts(contact, &counts));
  PetscCall(PetscViewerASCIIPrintf(report->viewer, "sweeps\n"));
  PetscCall(PrintCount(report, "most in a step", results->max_sweeps, -1));
  PetscCall(PrintText(report, "mean over steps in contact", results->mean_sweeps_contact, "", NAN));
  if (cuts.cuts) {
    PetscCall(PrintCount(report, "steps made again in halves", cuts.cuts, -1));
    PetscCall(PrintValue(report, "smallest step", cuts.smallest_step, UNIT_TIME, NAN));
  }
  if (counts.unconverged_steps) PetscCall(PrintCount(report, "steps that did not converge", counts.unconverged_steps, results->steps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewEnergies(const Report *report, const Body bodies[])
{
  const StatisticsResults *results = report->results;
  const PetscBool          moves   = (PetscBool)!report->statics.some; /* momenta are kept by bodies that all have inertia */
  const char              *name, *unit = UnitsText(report->units, UNIT_ENERGY);
  PetscBool                is_static;
  PetscInt                 dim;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(report->viewer, "energy%s\n", moves ? " and momentum" : ""));
  for (PetscInt i = 0; i < results->n_bodies; i++) {
    const BodyStatistics *body = &results->bodies[i];

    PetscCall(PetscObjectGetName((PetscObject)bodies[i], &name));
    PetscCall(BodyIsStatic(bodies[i], &is_static));
    if (is_static)
      PetscCall(PetscViewerASCIIPrintf(report->viewer, "  %-32.32s %13.6g%s potential at the end\n", name, (double)body->potential, unit));
    else
      PetscCall(PetscViewerASCIIPrintf(report->viewer, "  %-32.32s %13.6g%s kinetic, %.6g%s potential at the end\n", name,
                                       (double)body->kinetic, unit, (double)body->potential, unit));
    if (!PetscIsNanReal(body->displacement_error))
      PetscCall(PrintPercent(report, "    error of the displacement", body->displacement_error));
    if (body->rotation_max > STATISTICS_FAR_TURN)
      PetscCall(PrintValue(report, "    rotation, far for linear", body->rotation_max, UNIT_ANGLE, NAN));
    if (body->external_work != 0) PetscCall(PrintValue(report, "    work of its loads", body->external_work, UNIT_ENERGY, NAN));
    if (body->damping_work != 0) PetscCall(PrintValue(report, "    taken by its damping", body->damping_work, UNIT_ENERGY, NAN));
    if (body->plastic_work != 0) PetscCall(PrintValue(report, "    taken by plastic flow", body->plastic_work, UNIT_ENERGY, NAN));
  }
  if (report->statics.balanced) PetscCall(PrintPercent(report, "system energy error, worst", StatisticsGetWorstError(results)));
  if (report->statics.balanced) PetscCall(PrintPercent(report, "system energy error, final", results->energy_error_final));
  if (moves && !PetscIsInfOrNanReal(results->momentum_error_max))
    PetscCall(PrintPercent(report, "momentum error, worst", results->momentum_error_max));
  PetscCall(BodyGetDimension(bodies[0], &dim));
  if (moves && dim > 1 && !PetscIsInfOrNanReal(results->angular_momentum_error_max))
    PetscCall(PrintPercent(report, "angular momentum error, worst", results->angular_momentum_error_max));
  if (results->penalty_energy_max > 0)
    PetscCall(PrintValue(report, "energy in springs of contact, most", results->penalty_energy_max, UNIT_ENERGY, NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewReactions(const Report *report, const Body bodies[])
{
  const StatisticsResults *results = report->results;
  const char              *unit    = UnitsText(report->units, UNIT_MOMENT);

  PetscFunctionBegin;
  if (results->n_supports) PetscCall(PetscViewerASCIIPrintf(report->viewer, "reactions at the end\n"));
  for (PetscInt i = 0; i < results->n_supports; i++) {
    const SupportStatistics *support = &results->supports[i];
    const char              *owner   = "";
    char                     name[128];
    PetscInt                 dim = 0;

    for (PetscInt b = 0; b < results->n_bodies && dim < 3; b++) {
      PetscInt of_body;

      PetscCall(BodyGetDimension(bodies[b], &of_body));
      if (b == support->body || support->body < 0) dim = of_body;
    }
    if (support->body >= 0) PetscCall(PetscObjectGetName((PetscObject)bodies[support->body], &owner));
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s%s%s", owner, owner[0] ? "." : "", support->name));
    PetscCall(PetscViewerASCIIPrintf(report->viewer, "  %-32.32s %13.6g", name, (double)support->force[0]));
    for (PetscInt d = 1; d < dim; d++) PetscCall(PetscViewerASCIIPrintf(report->viewer, ", %.6g", (double)support->force[d]));
    PetscCall(PetscViewerASCIIPrintf(report->viewer, "%s", UnitsText(report->units, UNIT_FORCE)));
    if (dim == 2) PetscCall(PetscViewerASCIIPrintf(report->viewer, "; moment %.6g%s", (double)support->moment[2], unit));
    if (dim == 3)
      PetscCall(PetscViewerASCIIPrintf(report->viewer, "; moment %.6g, %.6g, %.6g%s", (double)support->moment[0],
                                       (double)support->moment[1], (double)support->moment[2], unit));
    PetscCall(PetscViewerASCIIPrintf(report->viewer, "\n"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewErrors(const Report *report, Exact exact)
{
  ExactErrors errors;

  PetscFunctionBegin;
  PetscCall(ExactGetErrors(exact, &errors));
  PetscCall(PetscViewerASCIIPrintf(report->viewer, "errors against the exact solution\n"));
  PetscCall(PrintPercent(report, "contact position", errors.contact_position));
  PetscCall(PrintPercent(report, "contact force", errors.contact_force));
  PetscCall(PrintPercent(report, "kinetic energy", errors.kinetic));
  PetscCall(PrintPercent(report, "mean velocity", errors.mean_velocity));
  PetscCall(PrintPercent(report, "peak of the potential energy", errors.peak_potential));
  PetscCall(PrintPercent(report, "release time", errors.release_time));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prints the results table. `exact`: what it was compared with, or `NULL`. Collective on the viewer */
PetscErrorCode ReportView(Controller controller, const StatisticsResults *results, Exact exact, const Verdict *verdict, PetscViewer viewer)
{
  Contact        contact;
  const Body    *bodies;
  PetscInt       n;
  ControllerCost cost;
  RanksSummary   ranks;
  Report         report = {.viewer = viewer, .results = results, .exact = {NAN, NAN, NAN, NAN}};

  PetscFunctionBegin;
  if (exact) PetscCall(ExactGetFigures(exact, &report.exact));
  PetscCall(UnitsGet((PetscObject)controller, &report.units));
  PetscCall(ControllerGetStatics(controller, &report.statics));
  PetscCall(ControllerGetBodies(controller, &n, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ControllerGetCost(controller, &cost));
  PetscCall(RanksGather(controller, &ranks));
  PetscCall(VerdictView(controller, results, verdict, viewer));
  if (results->n_pairs) {
    PetscCall(ViewContact(&report, contact));
    PetscCall(ViewForces(&report, contact));
    PetscCall(ViewSweeps(&report, controller, contact));
  }
  PetscCall(ViewEnergies(&report, bodies));
  PetscCall(ViewReactions(&report, bodies));
  if (exact) PetscCall(ViewErrors(&report, exact));
  PetscCall(PetscViewerASCIIPrintf(viewer, "%-34s %13.6g s wall, %.6g s processor\n", "time loop", (double)cost.wall, (double)cost.cpu));
  PetscCall(RanksView(&ranks, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}
