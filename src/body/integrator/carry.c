/* The first iterate of Newton's method of a static nonlinear body: what is prescribed, carried into the body by its tangent. */
#include "implicitimpl.h"

/* The move of a difference that stands for a derivative, in parts of the body's size: small against elements, large against round-off */
#define PART 1e-7

/* X1 is the displacement X0 with held dofs and prescribed rows at the end of the substep, and nothing else moved: near a plate that moves
   by an element's height, or by little where volume is kept, that is far from any balance. With d = X1 - X0, Newton's first iteration is
   made at X0 instead,

     K(X0) du = -(F(X0) + K(X0) d),  X1 = X0 + d + du,

   F being the residual with the loads of the end. K d is a difference of residuals. X1 stays as it is where its residual is smaller. */
PetscErrorCode BodyImplicitCarry(Body body, BodyResidualFn *residual, Vec X0, Vec X1)
{
  BodyImplicit   *implicit = (BodyImplicit *)body->integrator->data;
  const PetscReal t        = body->state.time + body->time.step;
  Vec             d = implicit->lead[0], f = implicit->lead[1], g = implicit->lead[2], x = implicit->lead[3];
  PetscReal       box[6] = {0}, size = 0, largest, part, before, after;

  PetscFunctionBegin;
  PetscCall(VecWAXPY(d, -1, X0, X1));
  PetscCall(VecNorm(d, NORM_INFINITY, &largest));
  if (!(largest > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMGetBoundingBox(body->mesh.dm, box, box + 3));
  for (PetscInt k = 0; k < 3; k++) size = PetscMax(size, box[3 + k] - box[k]);
  part = PetscMin(1, PART * size / largest);
  PetscCall((*residual)(body->time.ts, t, X1, NULL, NULL, g, body));
  PetscCall(VecNorm(g, NORM_2, &before));
  PetscCall(VecWAXPY(x, part, d, X0));
  PetscCall((*residual)(body->time.ts, t, x, NULL, NULL, g, body));
  PetscCall((*residual)(body->time.ts, t, X0, NULL, NULL, f, body));
  PetscCall(VecAXPY(g, -1, f));
  PetscCall(VecAXPY(f, 1 / part, g));
  PetscCall(BodyImplicitRefactor(body, X0));
  PetscCall(ConstrainedSolverSolve(body->solver, f, x));
  PetscCall(VecAYPX(x, -1, X1));
  PetscCall((*residual)(body->time.ts, t, x, NULL, NULL, g, body));
  PetscCall(VecNorm(g, NORM_2, &after));
  if (after < before || (PetscIsInfOrNanReal(before) && !PetscIsInfOrNanReal(after))) PetscCall(VecCopy(x, X1));
  PetscFunctionReturn(PETSC_SUCCESS);
}
