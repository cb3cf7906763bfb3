/* What a run is to be expected to do, before it is made: bodies, elements that bound steps, steps and cost. */
#include "controllerimpl.h"
#include <sys/units.h>
#include <impakt/private/bodystep.h>

/* A stable step so many times shorter than the body's median is worth a warning; hertz-impact.opts, graded by 64, has 2.5 */
#define MUCH_SHORTER 20
/* Products of inertia that are smaller, in parts of the largest moment, are round-off */
#define ROUND_OFF 1e-12

/* How many times longer the median of the steps of all elements is than the shortest one; 1 where the body has no stable step */
static PetscErrorCode GetRatio(Body body, const BodyStepBounds **bounds, PetscReal *ratio)
{
  PetscBool is_explicit;

  PetscFunctionBegin;
  *bounds = NULL;
  *ratio  = 1;
  PetscCall(BodyIsExplicit(body, &is_explicit));
  if (!is_explicit) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetStepBounds(body, bounds));
  if ((*bounds)->n) *ratio = (*bounds)->median / (*bounds)->step[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CountSubsteps(Controller controller, Body body, PetscInt *substeps)
{
  ContactTraits traits;

  PetscFunctionBegin;
  PetscCall(ContactGetTraits(controller->contact, &traits));
  PetscCall(BodyGetSubsteps(body, substeps));
  *substeps *= traits.parts;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells where an element has a much shorter stable step than others of its body, for the worst body, and how many more there are */
PetscErrorCode ControllerWarnOfElements(Controller controller)
{
  const BodyStepBounds *bounds, *of_worst = NULL;
  PetscReal             ratio, largest    = MUCH_SHORTER;
  PetscInt              n         = 0, substeps;
  Body                  worst     = NULL;
  char                  more[128] = "";
  const char           *name;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    PetscCall(GetRatio(controller->bodies[b], &bounds, &ratio));
    n += ratio > MUCH_SHORTER;
    if (ratio <= largest) continue;
    largest  = ratio;
    worst    = controller->bodies[b];
    of_worst = bounds;
  }
  if (!of_worst) PetscFunctionReturn(PETSC_SUCCESS);
  if (n > 1)
    PetscCall(PetscSNPrintf(more, sizeof(more), "; %" PetscInt_FMT " more bod%s", n - 1,
                            n == 2 ? "y has such an element" : "ies have such elements"));
  PetscCall(CountSubsteps(controller, worst, &substeps));
  PetscCall(PetscObjectGetName((PetscObject)worst, &name));
  PetscCall(PetscFPrintf(
      PetscObjectComm((PetscObject)controller), stderr,
      "impakt: warning: element %" PetscInt_FMT
      " (rank after rank, from 0) of the explicit body '%s', around (%.6g, %.6g, %.6g)%s, has a stable step "
      "of %.3g%s, %.3g times shorter than the median of its elements, %.3g%s, and all make as many substeps as it needs, %" PetscInt_FMT
      " to each controller step: mend the mesh there, or let the body be implicit (-%sts_type alpha2); -check lists the elements that "
      "bound the step%s\n",
      of_worst->number[0], name, (double)of_worst->centre[0][0], (double)of_worst->centre[0][1], (double)of_worst->centre[0][2],
      UnitsOf((PetscObject)worst, UNIT_LENGTH), (double)of_worst->step[0], UnitsOf((PetscObject)worst, UNIT_TIME), (double)largest,
      (double)of_worst->median, UnitsOf((PetscObject)worst, UNIT_TIME), substeps, ((PetscObject)worst)->prefix, more));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewInertia(Body body, PetscViewer viewer)
{
  PetscReal centre[3], inertia[9], largest = 0, mass;
  PetscInt  dim;

  PetscFunctionBegin;
  PetscCall(BodyGetDimension(body, &dim));
  PetscCall(BodyGetMass(body, &mass));
  PetscCall(BodyGetInertia(body, centre, inertia));
  for (PetscInt k = 0; k < 9; k++) largest = PetscMax(largest, PetscAbsReal(inertia[k]));
  for (PetscInt k = 0; k < 9; k++)
    if (PetscAbsReal(inertia[k]) <= ROUND_OFF * largest) inertia[k] = 0;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  mass                 %.6g%s, centre (%.6g, %.6g, %.6g)%s\n", (double)mass,
                                   UnitsOf((PetscObject)body, UNIT_MASS), (double)centre[0], (double)centre[1], (double)centre[2],
                                   UnitsOf((PetscObject)body, UNIT_LENGTH)));
  if (dim == 2 && largest > 0)
    PetscCall(
        PetscViewerASCIIPrintf(viewer, "  moment of inertia    %.6g%s\n", (double)inertia[8], UnitsOf((PetscObject)body, UNIT_INERTIA)));
  if (dim == 3)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  moments of inertia   xx %.6g, yy %.6g, zz %.6g, xy %.6g, yz %.6g, xz %.6g%s\n",
                                     (double)inertia[0], (double)inertia[4], (double)inertia[8], (double)inertia[1], (double)inertia[5],
                                     (double)inertia[2], UnitsOf((PetscObject)body, UNIT_INERTIA)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewBounds(Body body, PetscViewer viewer)
{
  const BodyStepBounds *bounds;
  PetscReal             ratio;

  PetscFunctionBegin;
  PetscCall(GetRatio(body, &bounds, &ratio));
  if (!bounds || !bounds->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "  stable steps         median of all elements %.4g%s; the shortest are those of\n",
                                   (double)bounds->median, UnitsOf((PetscObject)body, UNIT_TIME)));
  for (PetscInt k = 0; k < bounds->n; k++)
    PetscCall(PetscViewerASCIIPrintf(viewer, "    element %" PetscInt_FMT ": %.4g%s, %.3g of the median, around (%.6g, %.6g, %.6g)%s\n",
                                     bounds->number[k], (double)bounds->step[k], UnitsOf((PetscObject)body, UNIT_TIME),
                                     (double)(bounds->step[k] / bounds->median), (double)bounds->centre[k][0], (double)bounds->centre[k][1],
                                     (double)bounds->centre[k][2], UnitsOf((PetscObject)body, UNIT_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerCheck - what `ControllerSolve()` would begin with, and be expected to do, without making a step

  Collective

  Input Parameters:
+ controller - the `Controller`, set up
- viewer     - an ASCII viewer, `NULL` for standard output

  Options Database Key:
. -check - this in place of a run

  Level: beginner

  Notes:
  Observers are told of the start. Then come, beside what `ControllerView()` prints: mass, centre and moments of inertia of each body, with
all mass where the mesh has it; of explicit bodies the elements that bound the stable step; controller steps and substeps of the run; and
its wall time, estimated from a few substeps of each body that are tried without contact. No solution goes on from there.

.seealso: `Controller`, `ControllerSolve()`, `ControllerView()`, `BodyGetStepBounds()`
@*/
PetscErrorCode ControllerCheck(Controller controller, PetscViewer viewer)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)controller);
  PetscReal   wall = 0;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(comm, &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCheck(controller->setup, comm, PETSC_ERR_ARG_WRONGSTATE, "Call ControllerSetUp() first");
  PetscCall(ControllerNotify(controller, 0));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscViewerASCIIPrintf(viewer, "check: the set-up alone, no step is made\n"));
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    const Body     body = controller->bodies[b];
    const char    *name;
    PetscLogDouble seconds;
    PetscInt       substeps;

    PetscCall(PetscObjectGetName((PetscObject)body, &name));
    PetscCall(CountSubsteps(controller, body, &substeps));
    PetscCall(PetscViewerASCIIPrintf(viewer, "check of body %s\n", name));
    PetscCall(ViewInertia(body, viewer));
    PetscCall(ViewBounds(body, viewer));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  substeps expected    %" PetscInt_FMT " to a controller step, %.0f in the run\n", substeps,
                                     (double)controller->steps * (double)substeps));
    PetscCall(BodyMeasureSubstep(body, &seconds));
    wall += (PetscReal)(seconds * (PetscLogDouble)controller->steps * (PetscLogDouble)substeps);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &wall, 1, MPIU_REAL, MPIU_MAX, comm));
  PetscCall(
      PetscViewerASCIIPrintf(viewer,
                             "check of the run\n  controller steps     %" PetscInt_FMT
                             " expected\n  wall time            about %.3g s on %d process%s: an estimate "
                             "from substeps that were tried without contact; a step in contact costs as many of them as it has sweeps\n",
                             controller->steps, (double)wall, (int)size, size == 1 ? "" : "es"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
