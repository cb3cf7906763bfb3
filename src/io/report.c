/* The table that a run prints at its end. */
#include "report.h"
#include "ranks.h"
#include <math.h>
#include <sys/stages.h>

/* Times of first contact below this part of the duration of contact are printed as 0: round-off of start + gap / speed */
#define ROUND_OFF 1e-12

/* Prints a line with a value and, if there is one, the exact value beside it */
static PetscErrorCode PrintValue(PetscViewer viewer, const char name[], PetscReal value, const char unit[], PetscReal exact)
{
  PetscFunctionBegin;
  if (PetscIsInfOrNanReal(value)) PetscCall(PetscViewerASCIIPrintf(viewer, "  %-32s %13s\n", name, "none"));
  else if (PetscIsInfOrNanReal(exact)) PetscCall(PetscViewerASCIIPrintf(viewer, "  %-32s %13.6g %s\n", name, (double)value, unit));
  else PetscCall(PetscViewerASCIIPrintf(viewer, "  %-32s %13.6g %-4s exact %.6g\n", name, (double)value, unit, (double)exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintCount(PetscViewer viewer, const char name[], PetscInt count, PetscInt of)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  %-32s %13" PetscInt_FMT, name, count));
  if (of >= 0) PetscCall(PetscViewerASCIIPrintf(viewer, " of %" PetscInt_FMT, of));
  PetscCall(PetscViewerASCIIPrintf(viewer, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintPercent(PetscViewer viewer, const char name[], PetscReal value)
{
  PetscFunctionBegin;
  PetscCall(PrintValue(viewer, name, 100 * value, "%", NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether no body has inertia: then the time of the run means nothing, nor does the impulse of a force */
static PetscErrorCode AllStatic(PetscInt n, const Body bodies[], PetscBool *all)
{
  PetscFunctionBegin;
  *all = PETSC_TRUE;
  for (PetscInt i = 0; i < n && *all; i++) PetscCall(BodyIsStatic(bodies[i], all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewContact(Contact contact, const Body bodies[], const StatisticsResults *results, Exact exact, PetscViewer viewer)
{
  const ContactStatistics *c     = &results->contact;
  PetscReal                onset = c->times.onset, impact = NAN, release = NAN, force = NAN, impulse = NAN;
  ContactType              type;
  ContactLaw               law;
  PetscBool                all_static;

  PetscFunctionBegin;
  PetscCall(AllStatic(results->n_bodies, bodies, &all_static));
  if (exact) {
    PetscCall(ExactGetTimes(exact, &impact, &release));
    PetscCall(ExactGetForce(exact, &force));
    PetscCall(ExactGetImpulse(exact, &impulse));
    if (PetscAbsReal(impact) < ROUND_OFF * (release - impact)) impact = 0;
  }
  PetscCall(ContactGetType(contact, &type));
  PetscCall(PetscViewerASCIIPrintf(viewer, "contact (%s)\n", type));
  if (PetscAbsReal(onset) < ROUND_OFF * (c->release_time - onset)) onset = 0;
  PetscCall(PrintValue(viewer, "first contact", onset, "s", impact));
  if (c->times.in_contact_at_end) PetscCall(PetscViewerASCIIPrintf(viewer, "  %-32s still in contact\n", "release"));
  else PetscCall(PrintValue(viewer, "release", c->times.separation, "s", release));
  PetscCall(PrintCount(viewer, "onsets", c->onsets, -1));
  PetscCall(PrintCount(viewer, "steps in contact", c->steps_in_contact, results->steps));
  PetscCall(PrintValue(viewer, "force, mean", c->force_mean, "N", force));
  PetscCall(PrintValue(viewer, "force, standard deviation", c->force_std, "N", NAN));
  PetscCall(PrintValue(viewer, "force, peak", c->force_peak, "N", NAN));
  PetscCall(ContactGetLaw(contact, &law));
  if (law != CONTACT_LAW_FRICTIONLESS) PetscCall(PrintValue(viewer, "tension of a node, peak", c->tension_max, "N", NAN));
  if (!all_static) PetscCall(PrintValue(viewer, "impulse", c->impulse, "N s", impulse));
  PetscCall(PrintValue(viewer, "largest penetration", PetscMax(0, -c->gap_min), "m", NAN));
  if (law == CONTACT_LAW_FRICTION) PetscCall(PrintValue(viewer, "energy taken by friction", c->friction_loss, "J", NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewSweeps(Controller controller, Contact contact, const StatisticsResults *results, PetscViewer viewer)
{
  ContactCounts  counts;
  ControllerCuts cuts;

  PetscFunctionBegin;
  PetscCall(ControllerGetCuts(controller, &cuts));
  PetscCall(ContactGetCounts(contact, &counts));
  PetscCall(PetscViewerASCIIPrintf(viewer, "sweeps\n"));
  PetscCall(PrintCount(viewer, "most in a step", results->max_sweeps, -1));
  PetscCall(PrintValue(viewer, "mean over steps in contact", results->mean_sweeps_contact, "", NAN));
  if (cuts.cuts) {
    PetscCall(PrintCount(viewer, "steps made again in halves", cuts.cuts, -1));
    PetscCall(PrintValue(viewer, "smallest step", cuts.smallest_step, "s", NAN));
  }
  if (counts.unconverged_steps) PetscCall(PrintCount(viewer, "steps that did not converge", counts.unconverged_steps, results->steps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewEnergies(const Body bodies[], const StatisticsResults *results, PetscViewer viewer)
{
  const PetscReal worst = -results->energy_error_min > results->energy_error_max ? results->energy_error_min : results->energy_error_max;
  const char     *name;
  PetscInt        dim;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "energy and momentum\n"));
  for (PetscInt i = 0; i < results->n_bodies; i++) {
    const BodyStatistics *body = &results->bodies[i];

    PetscCall(PetscObjectGetName((PetscObject)bodies[i], &name));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %-32.32s %13.6g J kinetic, %.6g J potential at the end\n", name, (double)body->kinetic,
                                     (double)body->potential));
    if (!PetscIsNanReal(body->displacement_error))
      PetscCall(PrintPercent(viewer, "    error of the displacement", body->displacement_error));
    if (body->rotation_max > STATISTICS_FAR_TURN)
      PetscCall(PrintValue(viewer, "    rotation, far for linear", body->rotation_max, "rad", NAN));
    if (body->external_work != 0) PetscCall(PrintValue(viewer, "    work of its loads", body->external_work, "J", NAN));
    if (body->damping_work != 0) PetscCall(PrintValue(viewer, "    taken by its damping", body->damping_work, "J", NAN));
    if (body->plastic_work != 0) PetscCall(PrintValue(viewer, "    taken by plastic flow", body->plastic_work, "J", NAN));
  }
  PetscCall(PrintPercent(viewer, "system energy error, worst", worst));
  PetscCall(PrintPercent(viewer, "system energy error, final", results->energy_error_final));
  if (!PetscIsInfOrNanReal(results->momentum_error_max))
    PetscCall(PrintPercent(viewer, "momentum error, worst", results->momentum_error_max));
  PetscCall(BodyGetDimension(bodies[0], &dim));
  if (dim > 1 && !PetscIsInfOrNanReal(results->angular_momentum_error_max))
    PetscCall(PrintPercent(viewer, "angular momentum error, worst", results->angular_momentum_error_max));
  if (results->penalty_energy_max > 0)
    PetscCall(PrintValue(viewer, "energy in penalty springs, most", results->penalty_energy_max, "J", NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What holds the bodies at the end */
static PetscErrorCode ViewReactions(const Body bodies[], const StatisticsResults *results, PetscViewer viewer)
{
  PetscFunctionBegin;
  if (results->n_supports) PetscCall(PetscViewerASCIIPrintf(viewer, "reactions at the end\n"));
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
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %-32.32s %13.6g", name, (double)support->force[0]));
    for (PetscInt d = 1; d < dim; d++) PetscCall(PetscViewerASCIIPrintf(viewer, ", %.6g", (double)support->force[d]));
    PetscCall(PetscViewerASCIIPrintf(viewer, " N"));
    if (dim == 2) PetscCall(PetscViewerASCIIPrintf(viewer, "; moment %.6g N m", (double)support->moment[2]));
    if (dim == 3)
      PetscCall(PetscViewerASCIIPrintf(viewer, "; moment %.6g, %.6g, %.6g N m", (double)support->moment[0], (double)support->moment[1],
                                       (double)support->moment[2]));
    PetscCall(PetscViewerASCIIPrintf(viewer, "\n"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewErrors(Exact exact, PetscViewer viewer)
{
  ExactErrors errors;

  PetscFunctionBegin;
  PetscCall(ExactGetErrors(exact, &errors));
  PetscCall(PetscViewerASCIIPrintf(viewer, "errors against the exact solution\n"));
  PetscCall(PrintPercent(viewer, "contact position", errors.contact_position));
  PetscCall(PrintPercent(viewer, "contact force", errors.contact_force));
  PetscCall(PrintPercent(viewer, "kinetic energy", errors.kinetic));
  PetscCall(PrintPercent(viewer, "mean velocity", errors.mean_velocity));
  PetscCall(PrintPercent(viewer, "peak of the potential energy", errors.peak_potential));
  PetscCall(PrintPercent(viewer, "release time", errors.release_time));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  ReportView - prints the results table

  Collective on the viewer

  Input Parameters:
+ controller - the `Controller`, at its end
. results    - figures of the run
. exact      - what it was compared with, or `NULL`
- viewer     - an ASCII viewer
*/
PetscErrorCode ReportView(Controller controller, const StatisticsResults *results, Exact exact, PetscViewer viewer)
{
  Contact        contact;
  const Body    *bodies;
  PetscInt       n;
  PetscLogDouble setup, wall, cpu;
  RanksSummary   ranks;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, &n, &bodies));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ControllerGetTimings(controller, &setup, &wall, &cpu));
  PetscCall(RanksGather(controller, &ranks));
  if (results->n_pairs) {
    PetscCall(ViewContact(contact, bodies, results, exact, viewer));
    PetscCall(ViewSweeps(controller, contact, results, viewer));
  }
  PetscCall(ViewEnergies(bodies, results, viewer));
  PetscCall(ViewReactions(bodies, results, viewer));
  if (exact) PetscCall(ViewErrors(exact, viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer, "%-34s %13.6g s wall, %.6g s processor\n", "time loop", (double)wall, (double)cpu));
  PetscCall(StagesView(PetscObjectComm((PetscObject)controller), viewer));
  PetscCall(RanksView(&ranks, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}
