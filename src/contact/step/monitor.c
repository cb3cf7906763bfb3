/* -contact_monitor: a line for each pass of a step, and one at its end. It looks at what is there, and changes no number. */
#include "stepimpl.h"
#include <sys/statusline.h>
#include <sys/units.h>

/* ContactStepperSetFromOptions - options of all contact types that are made of the step */
PetscErrorCode ContactStepperSetFromOptions(Contact contact)
{
  PetscViewer *monitor = &Stepper(contact)->monitor;

  PetscFunctionBegin;
  PetscCall(PetscViewerDestroy(monitor));
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsViewer("-contact_monitor", "A line for each pass of a contact step", "ContactSetType", monitor, NULL, NULL));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  PetscInt nodes, push, stick, slide;
} NodeCounts;

/* Nodes of a group, of all ranks, that may touch, push, stick and slide, by the forces of the last solution */
static void CountNodes(Contact contact, const ContactStepper *stepper, PetscInt g, NodeCounts *counts)
{
  const LawProblem *problem = &stepper->problem;

  *counts = (NodeCounts){0, 0, 0, 0};
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node];

    if (ContactStepperGroup(contact, stepper, first) != g) continue;
    counts->nodes++;
    if (!(PetscRealPart(problem->force[first]) > 0) && !problem->law[node]->pulls) continue;
    counts->push++;
    if (problem->begin[node + 1] == first + 1) continue;
    if (LawProblemSlides(problem, node)) counts->slide++;
    else counts->stick++;
  }
}

/* After a pass: a line for each group that has been advanced in it */
PetscErrorCode ContactMonitorPass(Contact contact, const ContactStepper *stepper)
{
  const LawProblem *problem = &stepper->problem;
  PetscViewer       viewer  = stepper->monitor;
  const char       *m;
  PetscReal         time;

  PetscFunctionBegin;
  if (!viewer) PetscFunctionReturn(PETSC_SUCCESS);
  m = UnitsOf((PetscObject)contact, UNIT_LENGTH);
  PetscCall(ContactGetTime(contact, &time));
  StatusLineBreak();
  for (PetscInt g = 0; g < contact->n_bodies; g++) {
    NodeCounts counts;

    if (stepper->group[g] != g || stepper->done[g]) continue;
    CountNodes(contact, stepper, g, &counts);
    if (!counts.nodes) continue;
    PetscCall(PetscViewerASCIIPrintf(
        viewer,
        "step that ends at %.9g%s, group of '%s', pass %" PetscInt_FMT
        ": rows off by %.3e%s, %.1e of the way that forces make; %" PetscInt_FMT " nodes may touch, %" PetscInt_FMT " push (%" PetscInt_FMT
        " stick, %" PetscInt_FMT " slide); law %s in %" PetscInt_FMT " iterations%s%s\n",
        (double)time, UnitsOf((PetscObject)contact, UNIT_TIME), ((PetscObject)contact->bodies[g])->name, stepper->passes,
        (double)stepper->off[g], m, (double)(stepper->scale[g] > 0 ? stepper->off[g] / stepper->scale[g] : 0), counts.nodes, counts.push,
        counts.stick, counts.slide, problem->solved ? "solved" : "NOT solved", problem->iterations,
        problem->by_nodes ? ", node by node too" : "", stepper->corrected ? "; compliance corrected" : ""));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactMonitorStep(Contact contact, const ContactStepper *stepper, SNESConvergedReason reason)
{
  PetscViewer viewer = stepper->monitor;
  PetscReal   time;
  int         counts[2] = {0, 0};

  PetscFunctionBegin;
  if (!viewer) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (ContactRowRubs(contact, i)) continue;
    counts[0] += stepper->joins[i] && contact->end.force[i] > 0;
    counts[1] += contact->start.active[i] && !(contact->end.force[i] > 0) && !contact->rows.tied[i];
  }
  PetscCall(ContactReduce(contact, 2, MPI_INT, MPI_SUM, counts));
  PetscCall(ContactGetTime(contact, &time));
  StatusLineBreak();
  PetscCall(PetscViewerASCIIPrintf(viewer, "step that ends at %.9g%s: %s in %" PetscInt_FMT " passes; %d rows joined, %d left\n",
                                   (double)time, UnitsOf((PetscObject)contact, UNIT_TIME), SNESConvergedReasons[reason], stepper->passes,
                                   counts[0], counts[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
