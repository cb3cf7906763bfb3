/* How the rows of a body answer to forces on them, and what is kept of that. */
#include "complianceimpl.h"
#include <sys/stages.h>

PetscErrorCode BodyDestroyCompliance(Body body)
{
  struct _BodyCompliance *c = body->compliance;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ComplianceDestroy(&c->nodal));
  PetscCall(NodalMatrixDestroy(&c->nodal_matrix));
  PetscCall(VecDestroy(&c->diagonal));
  PetscCall(PetscFree(c->change));
  PetscCall(PetscFree(body->compliance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyCreateCompliance(Body body)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(&body->compliance));
  body->compliance->nodal_kind = NODAL_BY_STEPS;
  PetscCall(PetscCalloc1(body->rows.local, &body->compliance->change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyComplianceIsExact - whether the displacements of the rows are affine in the contact forces at the ends of the substeps

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. exact - true for linear bodies, if implicit then under Newmark's method

  Level: developer

.seealso: `Body`, `BodyApplyCompliance()`
@*/
PetscErrorCode BodyComplianceIsExact(Body body, PetscBool *exact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(exact, 2);
  *exact = (PetscBool)(body->model.linear && body->integrator->affine);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetLayerMatrices - what makes up the compliance of rows that answer by a massless contact layer alone

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameters:
+ stiffness - K of the layer, held by the rest of the body [N/m]; `NULL` where rows answer otherwise
- rows      - B, the rows on the dofs of the layer, without held ones; or `NULL`

  Level: developer

  Note:
  The compliance is B K^{-1} B^T. Both matrices are owned by the body, which gives them new values where layer or rows change, or puts
  others in their place.

.seealso: `Body`, `BodyApplyCompliance()`
@*/
PetscErrorCode BodyGetLayerMatrices(Body body, Mat *stiffness, Mat *rows)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (stiffness) *stiffness = NULL;
  if (rows) *rows = NULL;
  if (body->integrator->answers_by_layer) PetscCall(ConstrainedSolverGetMatrices(body->solver, stiffness, rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyApplyCompliance - displacements of all rows, at the end of a substep, under forces on them at its end

  Collective

  Input Parameters:
+ body  - the `Body`, set up
- force - one for each row [N]

  Output Parameter:
. displacement - one for each row [m]

  Level: developer

  Note:
  One solution with factored matrices, for interfaces with too many rows to know each of them.

.seealso: `Body`, `BodyApplyCompliance()`
@*/
PetscErrorCode BodyApplyCompliance(Body body, Vec force, Vec displacement)
{
  PetscBool logged;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(StageBegin(STAGE_INTERFACE, &logged));
  PetscCall(PetscLogEventBegin(BODY_Compliance, body, 0, 0, 0));
  PetscCall(ConstrainedSolverApplyCompliance(body->solver, force, displacement));
  PetscCall(PetscLogEventEnd(BODY_Compliance, body, 0, 0, 0));
  PetscCall(StageEnd(logged));
  PetscFunctionReturn(PETSC_SUCCESS);
}
