/* The package of the class. */
#include <body/layout/bodyimpl.h>
#include <sys/package.h>

PetscClassId  BODY_CLASSID = 0;
PetscLogEvent BODY_Integrate, BODY_Compliance, BODY_InternalForce, BODY_LayerForce, BODY_Tangent;

static PetscBool BodyPackageInitialized = PETSC_FALSE;

/*@
  BodyInitializePackage - registers the class, with the integrators, materials and elements that bodies need; `BodyCreate()` calls it

  Not Collective

  Level: developer

.seealso: `BodyFinalizePackage()`, `ImpaktInitialize()`
@*/
PetscErrorCode BodyInitializePackage(void)
{
  PetscFunctionBegin;
  if (BodyPackageInitialized) PetscFunctionReturn(PETSC_SUCCESS);
  BodyPackageInitialized = PETSC_TRUE;
  PetscCall(TSSecondOrderInitializePackage());
  PetscCall(PetscClassIdRegister("Body", &BODY_CLASSID));
  PetscCall(PetscLogEventRegister("BodyIntegrate", BODY_CLASSID, &BODY_Integrate));
  PetscCall(PetscLogEventRegister("BodyCompliance", BODY_CLASSID, &BODY_Compliance));
  PetscCall(PetscLogEventRegister("BodyForce", BODY_CLASSID, &BODY_InternalForce));
  PetscCall(PetscLogEventRegister("BodyLayerForce", BODY_CLASSID, &BODY_LayerForce));
  PetscCall(PetscLogEventRegister("BodyTangent", BODY_CLASSID, &BODY_Tangent));
  PetscCall(MaterialInitializePackage());
  PetscCall(ElementInitializePackage());
  PetscCall(ImpaktFinishPackage("body", BODY_CLASSID, BodyFinalizePackage));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyFinalizePackage - ends the package; `PetscFinalize()` calls it

  Not Collective

  Level: developer

.seealso: `BodyInitializePackage()`
@*/
PetscErrorCode BodyFinalizePackage(void)
{
  PetscFunctionBegin;
  BodyPackageInitialized = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
