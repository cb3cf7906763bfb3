/* The packages of the classes. */
#include <impakt/private/transfer.h>
#include <sys/package.h>

PetscClassId OBSTACLE_CLASSID = 0, SURFACE_CLASSID = 0, TRANSFER_CLASSID = 0;

PetscErrorCode ObstacleInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Obstacle", &OBSTACLE_CLASSID, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surfaces and transfers, which only contact uses */
PetscErrorCode InterfaceInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Surface", &SURFACE_CLASSID, NULL, NULL));
  PetscCall(ImpaktRegisterClass("Transfer", &TRANSFER_CLASSID, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
