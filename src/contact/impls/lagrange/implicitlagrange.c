/*
   Lagrange multipliers at the end of each controller step, for bodies whose gap answers to the force there. With gap(lambda) the
   gaps after integrating all bodies under forces that go linearly from their last values to lambda,

     gap(lambda) >= 0,   lambda >= 0,   lambda . gap(lambda) = 0,

   an outer SNES for variational inequalities on F(lambda) = gap(lambda) with 0 as lower bound; its Jacobian is the interface
   compliance of all bodies, which is constant.
*/
#include "lagrangeimpl.h"
#include <checkpoint/checkpoint.h>
#include <sys/units.h>

/* Whether impulses correct the velocities, beside the forces of the step */
static PetscBool HasImpulses(const ImplicitLagrange *lagrange)
{
  return (PetscBool)(lagrange->close_rate || lagrange->stabilized);
}

/* The solution. The semismooth iteration may leave forces that pull, within the tolerance: these are taken out. */
static PetscErrorCode TakeForces(Contact contact)
{
  ImplicitLagrange  *lagrange = (ImplicitLagrange *)contact->data;
  const PetscScalar *force;
  int                pulls = 0;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(lagrange->outer.x, &force));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    pulls |= force[i] < 0;
    contact->end.force[i] = PetscMax(force[i], 0);
  }
  PetscCall(VecRestoreArrayRead(lagrange->outer.x, &force));
  PetscCall(ContactOr(contact, &pulls));
  if (pulls) PetscCall(ForcesIntegrate(contact, &lagrange->forces, contact->end.force, lagrange->scale));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactStep_ImplicitLagrange(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;
  PetscBool         in_contact, changed = PETSC_TRUE;
  PetscScalar      *x;

  PetscFunctionBegin;
  PetscCall(ForcesBeginStep(contact, &lagrange->forces, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  if (lagrange->stabilized) PetscCall(LagrangeProjectPrediction(contact, lagrange->step, &lagrange->impulses));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayWrite(lagrange->outer.x, &x));
  PetscCall(PetscArraycpy(x, contact->start.force, contact->rows.n));
  PetscCall(VecRestoreArrayWrite(lagrange->outer.x, &x));
  while (changed) {
    PetscCall(SNESSolve(lagrange->outer.snes, NULL, lagrange->outer.x));
    PetscCall(LagrangeCheckConverged(contact));
    if (!ContactFailed(contact)) PetscCall(TakeForces(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    changed = PETSC_FALSE;
    if (contact->options.constraint == CONTACT_CONSTRAINT_GAP_RATE)
      PetscCall(ForcesTouch(contact, &lagrange->forces, contact->end.force, &changed));
  }
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->end.active[i] = (PetscBool)(contact->end.force[i] > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Corrections of the states at the end of the step: velocities without gap rate; and accelerations without contact forces, from
   which the contact-stabilised method starts its next step */
static PetscErrorCode ContactAccept_ImplicitLagrange(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;
  PetscBool         in_contact;

  PetscFunctionBegin;
  if (lagrange->close_rate) PetscCall(LagrangeCloseRate(contact, PETSC_FALSE, &lagrange->impulses));
  if (!lagrange->stabilized) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++) lagrange->impulses.forces[i] = -lagrange->scale * contact->end.force[i];
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(ComplementarityGetBodyForces(contact, b, &lagrange->impulses, lagrange->impulses.mine));
    PetscCall(BodyAddAcceleration(contact->bodies[b], lagrange->impulses.mine));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactView_ImplicitLagrange(Contact contact, PetscViewer viewer)
{
  const ImplicitLagrange *lagrange = (const ImplicitLagrange *)contact->data;
  SNESType                type;

  PetscFunctionBegin;
  PetscCall(SNESGetType(lagrange->outer.snes, &type));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  outer iteration %s on the forces at the end of the step, tolerances %g%s and %g relative\n",
                                   type, (double)lagrange->atol, UnitsOf((PetscObject)contact, UNIT_LENGTH), (double)lagrange->rtol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactDestroy_ImplicitLagrange(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;

  PetscFunctionBegin;
  PetscCall(OuterSolverDestroy(&lagrange->outer));
  PetscCall(ForcesDestroy(&lagrange->forces));
  if (HasImpulses(lagrange)) PetscCall(ComplementarityDestroy(&lagrange->impulses));
  PetscCall(InterfaceOperatorDestroy(&lagrange->S));
  PetscCall(PetscFree2(lagrange->compliance, lagrange->marks));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The contact-stabilised Newmark method (Deuflhard, Krause, Ertel 2008) by the trapezoidal rule: with accelerations without contact
   forces at the start of a step and twice the force at its end, u_1 and v_1 have the whole contact force of the end of the step. */
static PetscErrorCode SetUpStabilized(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;
  MPI_Comm          comm     = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  PetscCheck(
      contact->options.constraint == CONTACT_CONSTRAINT_GAP, comm, PETSC_ERR_USER_INPUT,
      "-contact_stabilization contact_stabilized closes the gap by a projection of its own; leave -contact_constraint at gap, not %s",
      ContactConstraints[contact->options.constraint]);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const char *name = ((PetscObject)contact->bodies[b])->name;
    PetscBool   is_explicit, massless;
    PetscReal   alpha_m, alpha_f, gamma, beta;
    PetscInt    substeps;
    TS          ts;

    PetscCall(BodyIsExplicit(contact->bodies[b], &is_explicit));
    PetscCheck(
        !is_explicit, comm, PETSC_ERR_USER_INPUT,
        "-contact_stabilization contact_stabilized works with implicit bodies only, and body '%s' is explicit; give it -%s_ts_type alpha2",
        name, name);
    PetscCall(BodyIsRedistributed(contact->bodies[b], &massless));
    PetscCheck(!massless, comm, PETSC_ERR_USER_INPUT,
               "-contact_stabilization contact_stabilized projects in the norm of the mass, and the contact nodes of body '%s' have none, "
               "so that they do not chatter either; set -%s_mass_redistribute false, or leave the stabilization at none",
               name, name);
    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    PetscCheck(substeps == 1, comm, PETSC_ERR_USER_INPUT,
               "-contact_stabilization contact_stabilized needs one step for all bodies, and body '%s' makes %" PetscInt_FMT
               " substeps; set -%s_ts_time_step to -time_step",
               name, substeps, name);
    PetscCall(BodyGetTS(contact->bodies[b], &ts));
    PetscCall(TSAlpha2GetParams(ts, &alpha_m, &alpha_f, &gamma, &beta));
    PetscCheck(alpha_m == 1 && alpha_f == 1 && gamma == 0.5 && beta == 0.25, comm, PETSC_ERR_USER_INPUT,
               "-contact_stabilization contact_stabilized is made for the trapezoidal rule, and body '%s' has alpha_m %g, alpha_f %g, "
               "gamma %g, beta %g; leave -%s_ts_alpha_... at their defaults",
               name, (double)alpha_m, (double)alpha_f, (double)gamma, (double)beta, name);
  }
  lagrange->scale              = 2;
  lagrange->stabilized         = PETSC_TRUE;
  contact->attempt.moves_start = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ComputeCompliance(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;

  PetscFunctionBegin;
  PetscCall(InterfaceOperatorSetRows(lagrange->S, lagrange->marks, 1));
  PetscCall(InterfaceOperatorAssemble(lagrange->S, INTERFACE_GAP, lagrange->compliance));
  for (PetscInt i = 0; i < contact->rows.n_all * contact->rows.n_all; i++) lagrange->compliance[i] *= lagrange->scale;
  lagrange->have_jacobian = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactRowsChanged_ImplicitLagrange(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;

  PetscFunctionBegin;
  PetscCall(ComputeCompliance(contact));
  if (HasImpulses(lagrange)) PetscCall(ComplementaritySetCompliance(contact, BodyComputeInverseMass, &lagrange->impulses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Another controller step, and so another compliance */
static PetscErrorCode SetStepLevel(Contact contact, PetscInt level, PetscBool goes_on)
{
  PetscFunctionBegin;
  (void)level;
  (void)goes_on;
  ((ImplicitLagrange *)contact->data)->step = contact->step;
  PetscCall(ComputeCompliance(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactVisit_ImplicitLagrange(Contact contact, Checkpoint checkpoint)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;

  PetscFunctionBegin;
  if (CheckpointLoads(checkpoint)) {
    lagrange->step          = contact->step;
    lagrange->have_jacobian = PETSC_FALSE;
    if (HasImpulses(lagrange)) PetscCall(ComplementaritySetCompliance(contact, BodyComputeInverseMass, &lagrange->impulses));
  }
  PetscCall(CheckpointVisitReals(checkpoint, "compliance", contact->rows.n_all * contact->rows.n_all, lagrange->compliance));
  PetscCall(InterfaceOperatorVisit(lagrange->S, checkpoint));
  PetscCall(ForcesVisit(contact, &lagrange->forces, checkpoint));
  PetscCall(CheckpointVisitVec(checkpoint, "outer", lagrange->outer.x));
  if (HasImpulses(lagrange)) PetscCall(ComplementarityVisit(contact, &lagrange->impulses, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LagrangeSetUpImplicit(Contact contact)
{
  /* SNESVI wants all of S as a matrix: dense whatever its size, which ForcesCheckDense() bounds; nothing is iterated for */
  const InterfaceSettings settings = {.prefix = "lagrange_", .dense_limit = contact->rows.n_all, .few = contact->rows.n_all};
  ImplicitLagrange       *lagrange;
  PetscBool               has_mass;

  PetscFunctionBegin;
  PetscCall(ForcesCheckBodies(contact, "lagrange"));
  PetscCall(ForcesCheckDense(contact, "lagrange"));
  PetscCall(ContactHasMass(contact, PETSC_TRUE, &has_mass));
  PetscCall(ContactRefuseUnstable(
      contact,
      (PetscBool)(has_mass && contact->options.constraint == CONTACT_CONSTRAINT_GAP &&
                  contact->options.stabilization == CONTACT_STABILIZATION_NONE),
      "-contact_type lagrange: where the contact nodes of both sides have mass, multipliers at the end of the step swing and gain energy; "
      "set "
      "-<body>_mass_redistribute true, or choose -contact_stabilization contact_stabilized, or -contact_type schwarz"));
  PetscCheck(!ContactAllPairsTie(contact), PetscObjectComm((PetscObject)contact), PETSC_ERR_SUP,
             "-contact_law tied with -contact_type lagrange is for bodies that are all explicit, with mass on their contact nodes and "
             "without substeps: with others the multipliers only push; choose -contact_type schwarz or penalty");
  PetscCall(PetscNew(&lagrange));
  contact->data             = lagrange;
  contact->ops->step        = ContactStep_ImplicitLagrange;
  contact->ops->stored      = ContactStoresNothing;
  contact->ops->view        = ContactView_ImplicitLagrange;
  contact->ops->rowschanged = ContactRowsChanged_ImplicitLagrange;
  contact->ops->steplevel   = SetStepLevel;
  contact->ops->visit       = ContactVisit_ImplicitLagrange;
  contact->ops->destroy     = ContactDestroy_ImplicitLagrange;
  lagrange->scale           = 1;
  PetscCall(ForcesGetStep(contact, &lagrange->step));
  PetscCall(ForcesCreate(contact, &lagrange->forces));
  PetscCall(InterfaceOperatorCreate(contact, &settings, &lagrange->S));
  PetscCall(PetscCalloc2(contact->rows.n_all * contact->rows.n_all, &lagrange->compliance, contact->rows.n, &lagrange->marks));
  for (PetscInt i = 0; i < contact->rows.n; i++) lagrange->marks[i] = INTERFACE_SOLVED;
  if (contact->options.stabilization == CONTACT_STABILIZATION_CONTACT_STABILIZED) PetscCall(SetUpStabilized(contact));
  if (contact->options.constraint == CONTACT_CONSTRAINT_BOTH) {
    PetscCall(LagrangeSetUpImpulses(contact, "-contact_constraint both", &lagrange->impulses));
    lagrange->close_rate = PETSC_TRUE;
  } else if (lagrange->stabilized)
    PetscCall(LagrangeSetUpImpulses(contact, "-contact_stabilization contact_stabilized", &lagrange->impulses));
  if (HasImpulses(lagrange)) contact->ops->accept = ContactAccept_ImplicitLagrange;
  PetscCall(ComputeCompliance(contact));
  PetscCall(LagrangeSetUpOuter(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
