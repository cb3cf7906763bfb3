/* The packages of the classes. */
#include <impakt/obstacle.h>
#include <sys/package.h>

PetscClassId OBSTACLE_CLASSID = 0;

static PetscBool ObstaclePackageInitialized = PETSC_FALSE;

/*@
  ObstacleInitializePackage - registers the class; `ObstacleCreate()` calls it

  Not Collective

  Level: developer

.seealso: `ObstacleFinalizePackage()`, `ImpaktInitialize()`
@*/
PetscErrorCode ObstacleInitializePackage(void)
{
  PetscFunctionBegin;
  if (ObstaclePackageInitialized) PetscFunctionReturn(PETSC_SUCCESS);
  ObstaclePackageInitialized = PETSC_TRUE;
  PetscCall(PetscClassIdRegister("Obstacle", &OBSTACLE_CLASSID));
  PetscCall(ImpaktFinishPackage("obstacle", OBSTACLE_CLASSID, ObstacleFinalizePackage));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ObstacleFinalizePackage - ends the package; `PetscFinalize()` calls it

  Not Collective

  Level: developer

.seealso: `ObstacleInitializePackage()`
@*/
PetscErrorCode ObstacleFinalizePackage(void)
{
  PetscFunctionBegin;
  ObstaclePackageInitialized = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
