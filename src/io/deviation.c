/* How far bodies are from displacements that the user gives as formulas. */
#include "deviation.h"
#include <petsc/private/petscimpl.h>
#include <math.h>

struct _n_Deviation {
  PetscInt    n_bodies;
  const Body *bodies; /* borrowed */
  Expression *exact;  /* three for each body; NULL if none is given */
};

/* DeviationCreate - prepares to compare the bodies of a controller, set up; nothing to compare with is given yet. Collective */
PetscErrorCode DeviationCreate(Controller controller, Deviation *deviation)
{
  Deviation d;

  PetscFunctionBegin;
  PetscCall(PetscNew(&d));
  *deviation = d;
  PetscCall(ControllerGetBodies(controller, &d->n_bodies, &d->bodies));
  PetscCall(PetscCalloc1(3 * d->n_bodies, &d->exact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The exact displacement of a body. `text`: a function of x, y, z, t for each component, with commas between them [m]. Collective */
PetscErrorCode DeviationSet(Deviation deviation, Body body, const char text[])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)body);
  char        option[256];
  const char *prefix;
  PetscInt    dim, b = 0;

  PetscFunctionBegin;
  while (b < deviation->n_bodies && deviation->bodies[b] != body) b++;
  PetscCheck(b < deviation->n_bodies, comm, PETSC_ERR_ARG_WRONG, "Body '%s' is none of the controller's", ((PetscObject)body)->name);
  PetscCall(PetscObjectGetOptionsPrefix((PetscObject)body, &prefix));
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%sexact_displacement", prefix));
  PetscCall(BodyGetDimension(body, &dim));
  for (PetscInt d = 0; d < 3; d++) PetscCall(ExpressionDestroy(&deviation->exact[3 * b + d]));
  PetscCall(ExpressionListCreate(comm, option + 1, text, dim, PETSC_FALSE, deviation->exact + 3 * b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Relative L2 error of the displacement of each body at its current time. `errors`: one for each body; not-a-number if no exact
   displacement is given; absolute [m] if that is zero. Collective */
PetscErrorCode DeviationCompute(Deviation deviation, PetscReal errors[])
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < deviation->n_bodies; b++) {
    PetscReal difference, norm;

    errors[b] = NAN;
    if (!deviation->exact[3 * b]) continue;
    PetscCall(BodyComputeDeviation(deviation->bodies[b], deviation->exact + 3 * b, &difference, &norm));
    errors[b] = norm > 0 ? difference / norm : difference;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DeviationDestroy(Deviation *deviation)
{
  PetscFunctionBegin;
  if (!*deviation) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < 3 * (*deviation)->n_bodies; i++) PetscCall(ExpressionDestroy(&(*deviation)->exact[i]));
  PetscCall(PetscFree((*deviation)->exact));
  PetscCall(PetscFree(*deviation));
  PetscFunctionReturn(PETSC_SUCCESS);
}
