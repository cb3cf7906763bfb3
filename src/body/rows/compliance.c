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
  PetscCall(PetscFree(body->compliance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyCreateCompliance(Body body)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(&body->compliance));
  body->compliance->nodal_kind = NODAL_BY_STEPS;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The parts of the compliance B K^{-1} B^T of rows that answer by a massless layer alone: its stiffness K, held by the rest of the body
   [N/m], and B on its dofs without held ones. Owned by the body, they change with layer and rows; NULL where rows answer otherwise. */
PetscErrorCode BodyGetLayerMatrices(Body body, Mat *stiffness, Mat *rows)
{
  PetscFunctionBegin;
  if (stiffness) *stiffness = NULL;
  if (rows) *rows = NULL;
  if (!body->integrator->answers_by_layer) PetscFunctionReturn(PETSC_SUCCESS);
  if (rows) PetscCall((*body->integrator->ops.setrows)(body));
  PetscCall(ConstrainedSolverGetMatrices(body->solver, stiffness, rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacements of all rows at the end of a substep under forces on them there [N], [m]: one solution with factored matrices, for
   interfaces with too many rows to have a column of each. Collective. */
PetscErrorCode BodyApplyCompliance(Body body, Vec force, Vec displacement)
{
  PetscBool logged;

  PetscFunctionBegin;
  PetscCall(StageBegin(STAGE_INTERFACE, &logged));
  PetscCall(PetscLogEventBegin(BODY_Compliance, body, 0, 0, 0));
  if (body->integrator->ops.setrows) PetscCall((*body->integrator->ops.setrows)(body));
  PetscCall(ConstrainedSolverApplyCompliance(body->solver, force, displacement));
  PetscCall(PetscLogEventEnd(BODY_Compliance, body, 0, 0, 0));
  PetscCall(StageEnd(logged));
  PetscFunctionReturn(PETSC_SUCCESS);
}
