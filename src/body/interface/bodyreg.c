/* The package of the class. */
#include <body/layout/bodyimpl.h>
#include <sys/package.h>

PetscClassId  BODY_CLASSID = 0;
PetscLogEvent BODY_Integrate, BODY_Compliance, BODY_InternalForce, BODY_LayerForce, BODY_Tangent;

/* Events; and the integrators, materials and elements that bodies need */
static PetscErrorCode RegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(TSSecondOrderRegisterAll());
  PetscCall(PetscLogEventRegister("BodyIntegrate", BODY_CLASSID, &BODY_Integrate));
  PetscCall(PetscLogEventRegister("BodyCompliance", BODY_CLASSID, &BODY_Compliance));
  PetscCall(PetscLogEventRegister("BodyForce", BODY_CLASSID, &BODY_InternalForce));
  PetscCall(PetscLogEventRegister("BodyLayerForce", BODY_CLASSID, &BODY_LayerForce));
  PetscCall(PetscLogEventRegister("BodyTangent", BODY_CLASSID, &BODY_Tangent));
  PetscCall(MaterialInitializePackage());
  PetscCall(ElementInitializePackage());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Body", &BODY_CLASSID, RegisterAll, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
