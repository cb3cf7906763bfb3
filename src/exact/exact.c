/* The class: package, creation, what all types of solution tell, view, destruction. */
#include "exactimpl.h"
#include "exactvisit.h"
#include <sys/package.h>
#include <math.h>
#include <sys/names.h>
#include <sys/units.h>

PetscClassId EXACT_CLASSID = 0;

static const struct {
  ExactType type;
  PetscErrorCode (*create)(Controller, Exact);
} Types[] = {
    {EXACT_IMPACT, ExactCreate_Impact},
    {EXACT_CHARACTERISTICS, ExactCreate_Characteristics},
};

PetscErrorCode ExactInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Exact", &EXACT_CLASSID, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An exact solution for the bodies of a controller that is set up, in their initial state. An error gives the reason where it is not the
   solution for these bodies. Collective */
PetscErrorCode ExactCreate(Controller controller, ExactType type, Exact *exact)
{
  MPI_Comm       comm       = PetscObjectComm((PetscObject)controller);
  char           known[256] = "none";
  PetscInt       found      = -1;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(type, 2);
  PetscAssertPointer(exact, 3);
  PetscCall(ExactInitializePackage());
  for (PetscInt i = 0; i < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(Types); i++) {
    PetscBool same;

    PetscCall(PetscStrcmp(type, Types[i].type, &same));
    if (same) found = i;
    PetscCall(NamesAppend(known, sizeof(known), " ", Types[i].type));
  }
  PetscCheck(found >= 0, comm, PETSC_ERR_USER_INPUT, "Unknown -exact '%s'; known: %s", type, known);
  PetscCall(PetscHeaderCreate(*exact, EXACT_CLASSID, "Exact", "Exact solution", "Exact", comm, ExactDestroy, ExactView));
  PetscCall(PetscObjectChangeTypeName((PetscObject)*exact, Types[found].type));
  (*exact)->type         = Types[found].type;
  (*exact)->last_contact = NAN;
  error                  = ExactSetUpBars(*exact, controller);
  if (!error) {
    (*exact)->last_time = (*exact)->start;
    error               = (*Types[found].create)(controller, *exact);
  }
  if (error) (void)ExactDestroy(exact); /* nothing is left to be freed by the caller */
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The exact solution at one time. `side`: 0 for the bar on the Dirichlet side, 1 for its partner; `time`: any time of the run [s]; at a
 * jump, or within round-off of one, the value before it is given */
PetscErrorCode ExactEvaluate(Exact exact, PetscInt side, PetscReal time, ExactSolution *solution)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(solution, 4);
  PetscUseTypeMethod(exact, evaluate, side, time, solution);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* First contact and end of the last contact force [s], the latter not-a-number where the run does not last until then; the mean of the
   force over the middle three fifths of that time, compression positive [N]; and the force integrated over time [N s] */
PetscErrorCode ExactGetFigures(Exact exact, ExactFigures *figures)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(figures, 2);
  *figures = (ExactFigures){exact->impact, exact->release, exact->force, exact->impulse};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Names of the two bars. `names`: two: of the bar on the Dirichlet side, and of its partner; owned by the bodies */
PetscErrorCode ExactGetBodies(Exact exact, const char *names[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  PetscAssertPointer(names, 2);
  for (PetscInt side = 0; side < 2; side++) names[side] = exact->bars[side].name;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prints the exact solution in short. `viewer`: an ASCII viewer, `NULL` for standard output. Collective */
PetscErrorCode ExactView(Exact exact, PetscViewer viewer)
{
  PetscBool ascii;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(exact, EXACT_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)exact), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "exact solution (%s): contact of %s and %s from %g to %g%s, mean force %g%s, impulse %g%s\n",
                                   exact->type, exact->bars[0].name, exact->bars[1].name, (double)exact->impact, (double)exact->release,
                                   UnitsOf((PetscObject)exact, UNIT_TIME), (double)exact->force, UnitsOf((PetscObject)exact, UNIT_FORCE),
                                   (double)exact->impulse, UnitsOf((PetscObject)exact, UNIT_IMPULSE)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Frees the solution. Collective */
PetscErrorCode ExactDestroy(Exact *exact)
{
  PetscFunctionBegin;
  if (!*exact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*exact, EXACT_CLASSID, 1);
  if (--((PetscObject)*exact)->refct > 0) {
    *exact = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscTryTypeMethod(*exact, destroy);
  PetscCall(PetscHeaderDestroy(exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ExactVisit - how far the run has been from the solution so far, to or from a checkpoint */
PetscErrorCode ExactVisit(Exact exact, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointVisitBytes(checkpoint, "distance", sizeof(exact->distance), exact->distance));
  PetscCall(CheckpointVisitReals(checkpoint, "peak potential", 1, &exact->peak_potential));
  PetscCall(CheckpointVisitReals(checkpoint, "last contact", 1, &exact->last_contact));
  PetscCall(CheckpointVisitReals(checkpoint, "last time", 1, &exact->last_time));
  PetscFunctionReturn(PETSC_SUCCESS);
}
