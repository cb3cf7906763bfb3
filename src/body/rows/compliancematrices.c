/* What the compliance of the rows is made of, and what it costs. */
#include "complianceimpl.h"

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
  BodyGetComplianceMatrices - what makes up the compliance of the rows of a body with one substep

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameters:
+ matrix - A, the effective matrix of an implicit body or the stiffness of the layer by which an explicit one answers [N/m]; `NULL` where
           rows answer otherwise
- rows   - B, the rows on its dofs, without held ones; or `NULL`

  Level: developer

  Note:
  The compliance is B A^{-1} B^T. Both matrices are owned by the body, as those of `BodyGetLayerMatrices()` are.

.seealso: `Body`, `BodyApplyCompliance()`, `BodyGetLayerMatrices()`
@*/
PetscErrorCode BodyGetComplianceMatrices(Body body, Mat *matrix, Mat *rows)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (matrix) *matrix = NULL;
  if (rows) *rows = NULL;
  if (body->solver && body->time.substeps == 1) PetscCall(ConstrainedSolverGetMatrices(body->solver, matrix, rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyCountUnknown - how many of some rows its compliance does not know yet

  Not Collective

  Input Parameters:
+ body - the `Body`, set up
. n    - number of rows
- rows - rows of any rank

  Output Parameter:
. unknown - how many of them `BodyExtendCompliance()` would have to make known

  Level: developer

.seealso: `Body`, `BodyExtendCompliance()`, `BodyGetComplianceFlops()`
@*/
PetscErrorCode BodyCountUnknown(Body body, PetscInt n, const PetscInt rows[], PetscInt *unknown)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(unknown, 4);
  *unknown = 0;
  for (PetscInt i = 0; i < n; i++) *unknown += !ComplianceKnows(body->compliance->matrices, rows[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetComplianceFlops - operations of one `BodyApplyCompliance()`, and of making rows known

  Not Collective

  Input Parameters:
+ body - the `Body`, set up
. n    - number of rows
- rows - rows of any rank

  Output Parameters:
+ apply  - floating-point operations of a solution with the factors, counted from their entries, not measured: the same in every run
- extend - those of `BodyExtendCompliance()` for these rows; where many rows become known together, as many as would take that time one
           after the other

  Level: developer

.seealso: `Body`, `BodyApplyCompliance()`, `BodyExtendCompliance()`
@*/
PetscErrorCode BodyGetComplianceFlops(Body body, PetscInt n, const PetscInt rows[], PetscLogDouble *apply, PetscLogDouble *extend)
{
  PetscInt unknown;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(apply, 4);
  PetscAssertPointer(extend, 5);
  *apply = *extend = 0;
  if (!body->solver) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyCountUnknown(body, n, rows, &unknown));
  *apply  = ConstrainedSolverGetFlops(body->solver);
  *extend = ConstrainedSolverGetExtendFlops(body->solver, unknown);
  PetscFunctionReturn(PETSC_SUCCESS);
}
