/* How long a substep takes, found by making some. */
#include <body/layout/bodyimpl.h>

/* Of more substeps to a controller step so many are made at a time */
#define MOST_SUBSTEPS 8
/* The fastest of so many times counts, until so much time has gone [s]: the first one has what is made once in a run */
#define TRIALS  5
#define SECONDS 0.5

/*@
  BodyMeasureSubstep - how long a substep of the body takes, tried from its saved state without contact

  Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. seconds - wall time of a substep on this rank [s]

  Level: advanced

  Notes:
  The body has its saved state again afterwards, and its rows are free. A substep that fails, as one may whose loads contact is to bear, has
  taken its time all the same.

  The first call of an integrator makes what it needs once. So there are several, of which the fastest counts, unless they take long.

.seealso: `Body`, `BodyGetSubsteps()`, `BodyIntegrate()`
@*/
PetscErrorCode BodyMeasureSubstep(Body body, PetscLogDouble *seconds)
{
  MPI_Comm       comm     = PetscObjectComm((PetscObject)body);
  const PetscInt substeps = body->time.substeps;
  PetscReal      spent    = 0;
  BodyCondition *conditions;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(seconds, 2);
  PetscCheck(body->setup, comm, PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  PetscCall(PetscMalloc1(body->rows.local, &conditions));
  for (PetscInt i = 0; i < body->rows.local; i++) conditions[i] = BODY_FREE;
  PetscCall(BodySetConditions(body, conditions));
  PetscCall(PetscFree(conditions));
  body->time.substeps = PetscMin(substeps, MOST_SUBSTEPS);
  *seconds            = PETSC_MAX_REAL;
  for (PetscInt trial = 0; trial < TRIALS && spent < SECONDS; trial++) {
    PetscLogDouble begin, end;
    PetscReal      slowest;

    body->repeats = PETSC_FALSE; /* else a linear body would find that nothing has changed */
    PetscCall(PetscTime(&begin));
    PetscCall(BodyTryIntegrate(body, NULL));
    PetscCall(PetscTime(&end));
    *seconds = PetscMin(*seconds, (end - begin) / (PetscLogDouble)body->time.substeps);
    slowest  = (PetscReal)(end - begin);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &slowest, 1, MPIU_REAL, MPIU_MAX, comm));
    spent += slowest;
  }
  body->time.substeps = substeps;
  StepFailureClear(&body->failure);
  PetscCall(BodyRestore(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
