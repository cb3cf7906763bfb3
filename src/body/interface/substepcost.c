/* How long a substep takes, found by making some. */
#include <body/layout/bodyimpl.h>

/* Of more substeps to a controller step so many are made at a time */
#define MOST_SUBSTEPS 8
/* The fastest of so many times counts, until so much time has gone [s]: the first one has what is made once in a run */
#define TRIALS  5
#define SECONDS 0.5

/* Wall time of a substep on this rank, tried from the saved state without contact: the fastest of several unless they take long, since
   the first call of an integrator makes what it needs once [s]. A substep that fails, whose loads contact may have to bear, counts too.
   The body has its saved state again afterwards, with free rows. Collective. */
PetscErrorCode BodyMeasureSubstep(Body body, PetscLogDouble *seconds)
{
  MPI_Comm       comm     = PetscObjectComm((PetscObject)body);
  const PetscInt substeps = body->time.substeps;
  PetscReal      spent    = 0;
  BodyCondition *conditions;

  PetscFunctionBegin;
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
