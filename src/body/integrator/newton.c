/* The equations of one substep of a body on TSALPHA2, with inertia or without, and how those of a nonlinear one are solved: by Newton's
   method with the factors of the effective matrix. A linear body needs but one solution, see linearstep.c. */
#include "implicitimpl.h"
#include <impakt/private/bodymesh.h>
#include <sys/petsccompat.h>

/* Newton's method for a nonlinear body has converged where the residual is below this part of the forces that it is the balance of, or
   below its round-off; option -<body>_snes_rtol. What is left over changes momentum in each step: it should not show. */
#define NEWTON_TOLERANCE 1e-12
/* At most so many iterations in a substep; option -<body>_snes_max_it. The falling discs of options/ten-balls.opts take 1 to 4. */
#define NEWTON_ITERATIONS 50
/* Where the line search finds no smaller residual, Newton's method has converged if its step is below this part of the displacement: that
   is a few units in the last place; option -<body>_snes_stol */
#define NEWTON_STEP 1e-15
/* A slender static body turns as it bends. The first step of Newton's method, which is right but for the rotations, stretches it: the
   residual grows a thousandfold, and vanishes a few steps later. Steps that must reduce the residual get nowhere. So steps are whole unless
   they invert elements, or multiply the residual by the root of -BODY_STATIC_WHOLE (option -<body>_snes_linesearch_alpha). If the residual
   exceeds the first one after PATIENCE steps, the substep is made again with steps that must reduce it, by which rubber converges. Of 53
   strips of slenderness 10 to 500, bent by half of their length, in materials and elements of all kinds, none converged by the line
   searches bt, cp and l2, 51 by none, all by this. */
#define PATIENCE 8
/* Absolute tolerance [N]; option -<body>_snes_atol. Not a force in anyone's units: the square of a smaller number underflows. */
#define NEWTON_UNDERFLOW 1e-150
/* What a sum of a few products loses, in units of the largest number in it: a node belongs to some 8 elements */
#define ROUND_OFF (8 * PETSC_MACHINE_EPSILON)

/* BodyGetNorm(), but for substeps that all ranks make of a body that one rank has: those in which others bring forces, and the first */
static PetscErrorCode GetNorm(Body body, Vec vec, PetscReal *norm)
{
  const PetscBool alone = ((const BodyImplicit *)body->integrator->data)->alone;

  PetscFunctionBegin;
  PetscCall(BodyGetNorm(body, vec, norm));
  if (BodyStepsAlone(body) && !alone)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, norm, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* sqrt(sum of (a_i b_i)^2) over all dofs, in a work vector */
static PetscErrorCode ProductNorm(Body body, Vec a, Vec b, Vec work, PetscReal *norm)
{
  PetscFunctionBegin;
  PetscCall(VecPointwiseMult(work, a, b));
  PetscCall(GetNorm(body, work, norm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sizes of a nonlinear residual: of its forces, and of the round-off of its largest numbers; `inertia` is M A, or NULL */
static PetscErrorCode NoteTerms(Body body, Vec U, Vec inertia)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;
  Vec           product  = body->work.nodes[2];
  PetscReal     force, stiffness, mass = 0, position = 0, start = 0, motion = 0;

  PetscFunctionBegin;
  PetscCall(GetNorm(body, body->state.internal_force, &force));
  /* the internal force is a sum of displacements times stiffnesses, which may cancel: a body that moves as a whole has none */
  PetscCall(ProductNorm(body, implicit->stiffness, U, product, &stiffness));
  if (inertia) {
    PetscCall(GetNorm(body, inertia, &mass));
    /* the acceleration is a difference of displacements and of dt times the velocity, over dt^2: either may be zero */
    PetscCall(ProductNorm(body, body->mass.row_sum, U, product, &position));
    PetscCall(ProductNorm(body, body->mass.row_sum, body->substep_start.u, product, &start));
    PetscCall(ProductNorm(body, body->mass.row_sum, body->substep_start.v, product, &motion));
  }
  implicit->terms     = force + mass;
  implicit->round_off = ROUND_OFF *
                        (implicit->shift * (position + start + body->time.step * motion) + force + stiffness + implicit->unit_strain);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces of displacements of the size of an element [N]: stresses of a nonlinear material have the round-off of strains of size 1 */
PetscErrorCode BodyImplicitComputeUnitStrainForce(Body body)
{
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;
  PetscReal     size;
  Mat           tangent;

  PetscFunctionBegin;
  PetscCall(BodyCreateMatrix(body, NULL, &tangent));
  PetscCall(BodyAssembleTangent(body, NULL, NULL, tangent));
  PetscCall(BodyCreateVec(body, &implicit->stiffness));
  PetscCall(MatGetDiagonal(tangent, implicit->stiffness));
  PetscCall(MatDestroy(&tangent));
  PetscCall(BodyGetScale(body, BODY_ELEMENT_SIZE, &size));
  PetscCall(VecNorm(implicit->stiffness, NORM_2, &implicit->unit_strain));
  implicit->unit_strain *= size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The residual from the inertia M A, or zero, in F: internal less outside and contact forces, without held dofs and prescribed rows */
PetscErrorCode BodyImplicitAddForces(Body body, PetscReal t, Vec U, Vec F)
{
  const BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;
  const PetscReal     position = (body->time.substep + implicit->alpha_f) / body->time.substeps;

  PetscFunctionBegin;
  if (!body->model.linear) PetscCall(NoteTerms(body, U, body->integrator->has_inertia ? F : NULL));
  PetscCall(VecAXPY(F, 1, body->state.internal_force));
  PetscCall(BodyAddExternalForce(body, t, -1, F));
  PetscCall(BodyAddContactForce(body, position, -1, U, F));
  if (body->rows.stage_balance) PetscCall(VecCopy(F, body->rows.stage_balance));
  PetscCall(BodyZeroHeld(body, F));
  PetscCall(BodyPrescribe(body, NULL, position, F));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Held dofs and prescribed rows of a displacement at the end of the substep */
PetscErrorCode BodyImplicitPrescribe(Body body, Vec U)
{
  PetscFunctionBegin;
  PetscCall(BodyPrescribeHeld(body, body->state.time + body->time.step, U, NULL, NULL));
  PetscCall(BodyPrescribe(body, body->traces.displacement_in, (PetscReal)(body->time.substep + 1) / body->time.substeps, U));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ComputeJacobian(TS ts, PetscReal t, Vec U, Vec V, Vec A, PetscReal shift_v, PetscReal shift_a, Mat J, Mat P,
                                      void *ctx)
{
  Body body = (Body)ctx;

  PetscFunctionBegin;
  (void)ts;
  (void)t;
  (void)V;
  (void)A;
  (void)shift_v;
  (void)shift_a;
  (void)J;
  (void)P;
  PetscCall(BodyImplicitLinearize(body, U));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyConstrainedSolver(PC pc, Vec b, Vec x)
{
  Body body;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &body));
  PetscCall(ConstrainedSolverSolve(body->solver, b, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newton's method has converged where the residual is small against the forces that it is the balance of, or is their round-off. The
   residual of the first iterate may be that already: then no iteration could make it smaller. */
static PetscErrorCode StopInBalance(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm, SNESConvergedReason *reason,
                                    void *ctx)
{
  const Body    body     = (Body)ctx;
  BodyImplicit *implicit = (BodyImplicit *)body->integrator->data;
  PetscReal     rtol, atol;

  PetscFunctionBegin;
  (void)xnorm;
  (void)gnorm;
  PetscCall(SNESGetTolerances(snes, &atol, &rtol, NULL, NULL, NULL));
  *reason = SNES_CONVERGED_ITERATING;
  if (!it) implicit->first = fnorm;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_NAN;
  else if (fnorm <= atol) *reason = SNES_CONVERGED_FNORM_ABS;
  else if (fnorm <= implicit->round_off || (it && fnorm <= rtol * implicit->terms + implicit->round_off))
    *reason = SNES_CONVERGED_FNORM_RELATIVE;
  else if (!body->integrator->has_inertia && it >= PATIENCE && fnorm > implicit->first) *reason = SNES_DIVERGED_DTOL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newton's method of a nonlinear body, whose linear systems go to the factors of the effective matrix with constraints */
PetscErrorCode BodyImplicitSetUpNewton(Body body, TS ts, Mat J, BodyPredictorFn *predictor)
{
  SNESLineSearch line_search;
  SNES           snes;
  KSP            ksp;
  PC             pc;
  char           outer[128];

  PetscFunctionBegin;
  PetscCall(TSSetI2Jacobian(ts, J, J, ComputeJacobian, body));
  PetscCall(TSAlpha2SetPredictor(ts, predictor, body));
  PetscCall(TSGetSNES(ts, &snes));
  PetscCall(SNESGetLineSearch(snes, &line_search));
  PetscCall(SNESSetTolerances(snes, NEWTON_UNDERFLOW, NEWTON_TOLERANCE, NEWTON_STEP, NEWTON_ITERATIONS, PETSC_CURRENT));
  PetscCall(SNESLineSearchSetType(line_search, SNESLINESEARCHBT));
  if (!body->integrator->has_inertia) PetscCall(SNESLineSearchBTSetAlpha(line_search, BODY_STATIC_WHOLE));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(SNESSetConvergenceTest(snes, StopInBalance, body, NULL));
  /* BodyImplicitCheckSubstep() tells, with body and time */
  PetscCall(SNESSetErrorIfNotConverged(snes, PETSC_FALSE));
  PetscCall(SNESGetKSP(snes, &ksp));
  /* the user's -<body>_ksp_... options are for the solver with the factors, inside */
  PetscCall(PetscSNPrintf(outer, sizeof(outer), "%sconstrained_", ((PetscObject)body)->prefix));
  PetscCall(KSPSetOptionsPrefix(ksp, outer));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, body));
  PetscCall(PCShellSetApply(pc, ApplyConstrainedSolver));
  PetscCall(PCShellSetName(pc, "factored effective matrix with contact constraints"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes a linear solver that did not converge, with body, time and what to do */
static PetscErrorCode CheckLinearSolver(Body body, PetscBool *failed)
{
  const KSPConvergedReason reason = ConstrainedSolverTakeFailure(body->solver);
  const char              *prefix = ((PetscObject)body)->prefix;

  PetscFunctionBegin;
  *failed = (PetscBool)(reason < 0);
  if (!*failed) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->model.linear)
    PetscCall(StepFailureSet(&body->failure, STEP_DIVERGED_LINEAR, PETSC_ERR_NOT_CONVERGED,
                             "The linear solver of body '%s' did not converge at time %.9g s (its step %" PetscInt_FMT
                             "): %s; allow more iterations (-%sksp_max_it), or choose another preconditioner or a direct solver "
                             "(-%spc_type cholesky)",
                             body->hdr.name, (double)body->state.time, body->state.step, KSPConvergedReasons[reason], prefix, prefix));
  else
    PetscCall(StepFailureSet(&body->failure, STEP_DIVERGED_NEWTON, PETSC_ERR_NOT_CONVERGED,
                             "The linear solver in Newton's method for body '%s' did not converge at time %.9g s (its step %" PetscInt_FMT
                             "): %s; choose a smaller -%sts_time_step, or a direct solver (-%spc_type cholesky)",
                             body->hdr.name, (double)body->state.time, body->state.step, KSPConvergedReasons[reason], prefix, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes Newton's method that did not converge, with body, time and what to do. Of a linear body the solver alone can fail. */
PetscErrorCode BodyImplicitCheckSubstep(Body body)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;
  SNESConvergedReason reason;
  PetscInt            iterations, element;
  PetscReal           centre[3] = {0}, largest;
  PetscBool           unsolved;
  SNES                snes;
  Vec                 residual;
  char                sudden[BODY_SUDDEN_LENGTH];

  PetscFunctionBegin;
  PetscCall(CheckLinearSolver(body, &unsolved));
  if (body->model.linear) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyImplicitGetSNES(body, &snes));
  if (!snes) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SNESGetConvergedReason(snes, &reason));
  PetscCall(SNESGetIterationNumber(snes, &iterations));
  if (reason >= 0 && !unsolved) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyNoteInverted(body, implicit->alone));
  PetscCall(SNESGetFunction(snes, &residual, NULL, NULL));
  PetscCall(BodyDescribeSuddenLoad(body, sudden));
  PetscCall(BodyLocateLargest(body, implicit->alone, residual, &element, centre, &largest));
  PetscCall(StepFailureSet(&body->failure, STEP_DIVERGED_NEWTON, PETSC_ERR_NOT_CONVERGED,
                           "Newton's method for body '%s' did not converge at time %.9g s (its step %" PetscInt_FMT
                           "): %s after %" PetscInt_FMT
                           " iterations; the force that is farthest from balance, by %g N, is that of a node of "
                           "element %" PetscInt_FMT " (rank after rank, from 0), around (%g, %g, %g) m of the undeformed mesh; choose a "
                           "smaller -%sts_time_step, or look with -%ssnes_monitor%s%s",
                           body->hdr.name, (double)body->state.time, body->state.step, SNESConvergedReasons[reason], iterations,
                           (double)largest, element, (double)centre[0], (double)centre[1], (double)centre[2], ((PetscObject)body)->prefix,
                           ((PetscObject)body)->prefix, sudden[0] ? ". " : "", sudden));
  PetscFunctionReturn(PETSC_SUCCESS);
}
