/* The packages of the classes. */
#include <impakt/private/transfer.h>
#include <sys/package.h>

PetscClassId OBSTACLE_CLASSID = 0, SURFACE_CLASSID = 0, TRANSFER_CLASSID = 0;

static PetscBool ObstaclePackageInitialized = PETSC_FALSE, SurfacePackageInitialized = PETSC_FALSE,
                 TransferPackageInitialized = PETSC_FALSE;

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

PetscErrorCode SurfaceInitializePackage(void)
{
  PetscFunctionBegin;
  if (SurfacePackageInitialized) PetscFunctionReturn(PETSC_SUCCESS);
  SurfacePackageInitialized = PETSC_TRUE;
  PetscCall(PetscClassIdRegister("Surface", &SURFACE_CLASSID));
  PetscCall(ImpaktFinishPackage("surface", SURFACE_CLASSID, SurfaceFinalizePackage));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SurfaceFinalizePackage(void)
{
  PetscFunctionBegin;
  SurfacePackageInitialized = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TransferInitializePackage(void)
{
  PetscFunctionBegin;
  if (TransferPackageInitialized) PetscFunctionReturn(PETSC_SUCCESS);
  TransferPackageInitialized = PETSC_TRUE;
  PetscCall(PetscClassIdRegister("Transfer", &TRANSFER_CLASSID));
  PetscCall(ImpaktFinishPackage("transfer", TRANSFER_CLASSID, TransferFinalizePackage));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TransferFinalizePackage(void)
{
  PetscFunctionBegin;
  TransferPackageInitialized = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
