/* The class: package, creation, what all types of solution tell, view, destruction. */
#include "exactimpl.h"
#include "exactvisit.h"
#include <sys/package.h>
#include <math.h>
#include <sys/units.h>

PetscClassId EXACT_CLASSID = 0;

PetscErrorCode ExactInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Exact", &EXACT_CLASSID, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An exact solution for the bodies of a controller in their initial state. An error says why it does not fit them. Collective */
PetscErrorCode ExactCreate(Controller controller, ExactType type, Exact *exact)
{
  MPI_Comm       comm = PetscObjectComm((PetscObject)controller);
  PetscBool      impact, any;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(type, 2);
  PetscAssertPointer(exact, 3);
  PetscCall(ExactInitializePackage());
  PetscCall(PetscStrcmp(type, EXACT_IMPACT, &impact));
  PetscCall(PetscStrcmp(type, EXACT_CHARACTERISTICS, &any));
  PetscCheck(impact || any, comm, PETSC_ERR_USER_INPUT, "Unknown -exact '%s'; known: none %s %s", type, EXACT_IMPACT,
             EXACT_CHARACTERISTICS);
  PetscCall(PetscHeaderCreate(*exact, EXACT_CLASSID, "Exact", "Exact solution", "Exact", comm, ExactDestroy, ExactView));
  (*exact)->type         = impact ? EXACT_IMPACT : EXACT_CHARACTERISTICS;
  (*exact)->last_contact = NAN;
  error                  = ExactSetUpBars(*exact, controller);
  if (!error) {
    (*exact)->last_time = (*exact)->start;
    error               = ExactSetUpCharacteristics(*exact, controller);
  }
  if (error) (void)ExactDestroy(exact); /* nothing is left to be freed by the caller */
  PetscCall(error);
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

PetscErrorCode ExactDestroy(Exact *exact)
{
  PetscFunctionBegin;
  if (!*exact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*exact, EXACT_CLASSID, 1);
  if (--((PetscObject)*exact)->refct > 0) {
    *exact = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ExactDestroyCharacteristics(*exact));
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
