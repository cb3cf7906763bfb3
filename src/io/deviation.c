/* How far bodies are from displacements that the user gives as formulas. */
#include "deviation.h"
#include <math.h>

struct _n_Deviation {
  PetscInt    n_bodies;
  const Body *bodies; /* borrowed */
  Expression *exact;  /* three for each body; NULL if none is given */
};

/*
  DeviationCreate - reads the exact displacements of bodies from the options

  Collective

  Input Parameter:
. controller - the `Controller`, set up

  Output Parameter:
. deviation - the `Deviation`

  Options Database Key:
. -<body>_exact_displacement ux[,uy,uz] - a function of x, y, z, t for each component [m]
*/
PetscErrorCode DeviationCreate(Controller controller, Deviation *deviation)
{
  MPI_Comm  comm = PetscObjectComm((PetscObject)controller);
  Deviation d;

  PetscFunctionBegin;
  PetscCall(PetscNew(&d));
  PetscCall(ControllerGetBodies(controller, &d->n_bodies, &d->bodies));
  PetscCall(PetscCalloc1(3 * d->n_bodies, &d->exact));
  *deviation = d;
  for (PetscInt b = 0; b < d->n_bodies; b++) {
    char        text[2048], option[256];
    const char *prefix;
    PetscBool   set;
    PetscInt    dim;

    PetscCall(PetscObjectGetOptionsPrefix((PetscObject)d->bodies[b], &prefix));
    PetscCall(PetscOptionsGetString(NULL, prefix, "-exact_displacement", text, sizeof(text), &set));
    if (!set) continue;
    PetscCall(BodyGetDimension(d->bodies[b], &dim));
    PetscCall(PetscSNPrintf(option, sizeof(option), "-%sexact_displacement", prefix));
    PetscCall(ExpressionListCreate(comm, option, text, dim, PETSC_FALSE, d->exact + 3 * b));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  DeviationCompute - relative L2 error of the displacement of each body at its current time

  Collective

  Input Parameter:
. deviation - the `Deviation`

  Output Parameter:
. errors - one for each body; not-a-number if no exact displacement is given; absolute [m] if that is zero
*/
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

/* DeviationDestroy - frees a deviation */
PetscErrorCode DeviationDestroy(Deviation *deviation)
{
  PetscFunctionBegin;
  if (!*deviation) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < 3 * (*deviation)->n_bodies; i++) PetscCall(ExpressionDestroy(&(*deviation)->exact[i]));
  PetscCall(PetscFree((*deviation)->exact));
  PetscCall(PetscFree(*deviation));
  PetscFunctionReturn(PETSC_SUCCESS);
}
