/* The Schwarz alternating method for contact (Hoy, Tezaur, Mota): options, set-up, and one controller step. */
#include "schwarzimpl.h"
#include <sys/petsccompat.h>

static const char *const ConvergenceTests[] = {"auto", "position", "mismatch", "ConvergenceTest", "CONVERGENCE_", NULL};
static const char *const Relaxations[]      = {"fixed", "aitken", "Relaxation", "RELAXATION_", NULL};
static const char *const Unconvergeds[]     = {"error", "accept", "Unconverged", "UNCONVERGED_", NULL};

/* Rounds of the active set in one step after which something must be wrong */
#define MAX_ROUNDS 100

static PetscErrorCode ContactSetFromOptions_Schwarz(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEnum("-schwarz_traction", "Nodal force handed to the Neumann side", "BodySetTractionType", BodyTractionTypes, (PetscEnum)schwarz->traction, (PetscEnum *)&schwarz->traction, NULL));
  PetscCall(PetscOptionsEnum("-schwarz_relaxation", "Relaxation of nrichardson", "", Relaxations, (PetscEnum)schwarz->relaxation, (PetscEnum *)&schwarz->relaxation, NULL));
  PetscCall(PetscOptionsEnum("-schwarz_convergence", "What change of position is tested", "", ConvergenceTests, (PetscEnum)schwarz->convergence, (PetscEnum *)&schwarz->convergence, NULL));
  PetscCall(PetscOptionsEnum("-schwarz_unconverged", "What to do with a step that does not converge", "", Unconvergeds, (PetscEnum)schwarz->unconverged, (PetscEnum *)&schwarz->unconverged, NULL));
  PetscCall(PetscOptionsBool("-schwarz_recheck", "Let tensile nodes leave contact within the step", "", schwarz->recheck, &schwarz->recheck, NULL));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Unknowns: one for each row and level. The Dirichlet side sees nothing of the interior levels if it makes one substep. */
static PetscErrorCode SetUpUnknowns(Contact contact, PetscInt *unknowns)
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  PetscInt begin, *mine;

  PetscFunctionBegin;
  PetscCall(PetscCalloc4(contact->n_pairs, &schwarz->levels, contact->n_pairs, &schwarz->trace, contact->n_rows, &schwarz->offset, contact->n_pairs, &schwarz->kinematic));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscInt dirichlet, neumann;

    PetscCall(BodyGetSubsteps(contact->bodies[contact->pairs[p].body[0]], &dirichlet));
    PetscCall(BodyGetSubsteps(contact->bodies[contact->pairs[p].body[1]], &neumann));
    schwarz->levels[p] = dirichlet == 1 ? 1 : neumann;
    PetscCall(TraceCreate(contact->n_rows, schwarz->levels[p], &schwarz->trace[p]));
  }
  *unknowns = 0;
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    schwarz->offset[i] = *unknowns;
    *unknowns += schwarz->levels[contact->row_pair[i]];
  }
  PetscCallMPI(MPI_Scan(unknowns, &begin, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
  begin -= *unknowns;
  PetscCall(PetscMalloc1(contact->n_rows, &mine));
  for (PetscInt i = 0; i < contact->n_rows; i++) mine[i] = begin + schwarz->offset[i];
  PetscCall(PetscCalloc2(contact->n_all_rows, &schwarz->all_offset, contact->n_rows, &schwarz->jacobian_active));
  PetscCallMPI(MPI_Allgatherv(mine, (PetscMPIInt)contact->n_rows, MPIU_INT, schwarz->all_offset, contact->counts, contact->offsets, MPIU_INT, PetscObjectComm((PetscObject)contact)));
  PetscCall(PetscFree(mine));
  PetscCall(PetscMalloc2((MAX_ROUNDS + 1) * contact->n_rows, &schwarz->tried, contact->n_rows, &schwarz->kept_force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With the inertia of prescribed nodes in the traction, their acceleration takes part in the iteration. It follows from their
   displacement where the Neumann side is implicit and makes one substep. */
static PetscErrorCode SetUpReactionTraction(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  if (schwarz->traction != BODY_TRACTION_REACTION) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const Body dirichlet = contact->bodies[contact->pairs[p].body[0]], neumann = contact->bodies[contact->pairs[p].body[1]];
    PetscBool  massless, is_explicit;
    PetscInt   substeps;

    PetscCall(BodyIsRedistributed(dirichlet, &massless));
    if (massless) continue;
    PetscCall(BodyIsExplicit(neumann, &is_explicit));
    PetscCall(BodyGetSubsteps(neumann, &substeps));
    PetscCheck(!is_explicit && substeps == 1, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-schwarz_traction reaction: the contact nodes of body '%s' have mass, and then its partner '%s' must be implicit with the controller step as its step; choose -schwarz_traction internal, or -%s_mass_redistribute true", ((PetscObject)dirichlet)->name, ((PetscObject)neumann)->name, ((PetscObject)dirichlet)->name);
    schwarz->kinematic[p] = PETSC_TRUE;
    for (PetscInt k = 0; k < 2; k++)
      if (!schwarz->rate[k]) PetscCall(TraceCreate(contact->n_rows, 1, &schwarz->rate[k]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes everything that the time loop needs once all nodes are in contact, so that it need not be made there */
static PetscErrorCode PrepareContact(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) contact->active[i] = schwarz->jacobian_active[i] = PETSC_TRUE;
  PetscCall(ContactSetConditions(contact, CONDITIONS_SCHWARZ));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyPrepareSweeps(contact->bodies[b]));
  schwarz->stale = PETSC_TRUE;
  PetscCall(SchwarzComputeJacobian(schwarz->outer.snes, schwarz->outer.x, schwarz->outer.jacobian, schwarz->outer.jacobian, contact));
  for (PetscInt i = 0; i < contact->n_rows; i++) contact->active[i] = PETSC_FALSE;
  PetscCall(ContactSetConditions(contact, CONDITIONS_FREE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactSetUp_Schwarz(Contact contact)
{
  Schwarz  *schwarz = (Schwarz *)contact->data;
  PetscInt  unknowns;
  PetscBool richardson, damping_set;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetTractionType(contact->bodies[b], schwarz->traction));
  PetscCall(SetUpUnknowns(contact, &unknowns));
  PetscCall(SchwarzSetUpNewton(contact));
  PetscCall(SetUpReactionTraction(contact));
  PetscCall(OuterSolverCreate(contact, "schwarz_", unknowns, SchwarzSweep, SchwarzComputeJacobian, &schwarz->outer));
  PetscCall(OuterSolverSetFromOptions(contact, &schwarz->outer, 1e-12, 1e-15, 50));
  PetscCall(SNESGetTolerances(schwarz->outer.snes, &schwarz->atol, &schwarz->rtol, NULL, NULL, NULL));
  PetscCall(SNESSetConvergenceTest(schwarz->outer.snes, SchwarzTestConvergence, contact, NULL));
  PetscCall(PetscObjectTypeCompare((PetscObject)schwarz->outer.snes, SNESNRICHARDSON, &richardson));
  if (schwarz->relaxation == RELAXATION_AITKEN) {
    SNESLineSearch line_search;

    PetscCheck(richardson, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-schwarz_relaxation aitken goes with -schwarz_snes_type nrichardson only");
    PetscCall(PetscOptionsHasName(NULL, "schwarz_", "-snes_linesearch_damping", &damping_set));
    PetscCall(SchwarzSetUpAitken(contact));
    PetscCall(SNESGetLineSearch(schwarz->outer.snes, &line_search));
    if (!damping_set) PetscCall(SNESLineSearchSetDamping(line_search, 0.5));
  }
  if (schwarz->convergence == CONVERGENCE_AUTO) schwarz->convergence = richardson && schwarz->relaxation == RELAXATION_FIXED ? CONVERGENCE_POSITION : CONVERGENCE_MISMATCH;
  PetscCall(PrepareContact(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Not converging is an error that says where, or is counted */
static PetscErrorCode CheckConverged(Contact contact)
{
  Schwarz            *schwarz = (Schwarz *)contact->data;
  SNESConvergedReason reason;
  PetscReal           time;
  TS                  ts;

  PetscFunctionBegin;
  PetscCall(SNESGetConvergedReason(schwarz->outer.snes, &reason));
  if (reason > 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetTS(contact->bodies[0], &ts));
  PetscCall(TSGetTime(ts, &time));
  PetscCheck(schwarz->unconverged == UNCONVERGED_ACCEPT && reason != SNES_DIVERGED_NAN, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED, "The Schwarz iteration did not converge in the step that ends at time %.9g s: after %" PetscInt_FMT " sweeps the change of position is %g m (%s; absolute tolerance %g m, relative %g). Raise -schwarz_snes_max_it, loosen -schwarz_snes_atol, choose another -schwarz_snes_type, or take it as it is with -schwarz_unconverged accept", (double)time, contact->counts_made.sweeps, (double)schwarz->change, SNESConvergedReasons[reason], (double)schwarz->atol, (double)schwarz->rtol);
  contact->counts_made.unconverged_steps++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The outer iteration with the active set as it is, then forces and gaps */
static PetscErrorCode SolveActive(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(ContactSetConditions(contact, CONDITIONS_SCHWARZ));
  {
    int differs = 0;

    for (PetscInt i = 0; i < contact->n_rows; i++) differs |= schwarz->jacobian_active[i] != contact->active[i];
    PetscCall(ContactOr(contact, &differs));
    if (differs) {
      PetscCall(PetscArraycpy(schwarz->jacobian_active, contact->active, contact->n_rows));
      schwarz->stale = PETSC_TRUE;
    }
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyPrepareSweeps(contact->bodies[b]));
  PetscCall(SchwarzStartTraces(contact));
  PetscCall(SNESSolve(schwarz->outer.snes, NULL, schwarz->outer.x));
  PetscCall(CheckConverged(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair     = &contact->pairs[p];
    Trace              reaction = contact->traces[pair->body[0]].reaction;
    PetscScalar       *end;
    PetscInt           levels;

    PetscCall(TraceGetSizes(reaction, NULL, &levels));
    PetscCall(TraceGetLevel(reaction, levels, &end));
    for (PetscInt i = pair->begin; i < pair->end; i++) contact->force[i] = contact->active[i] ? -end[i] : 0;
  }
  PetscCall(ContactComputeGaps(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the active set is one that has been tried in this step before; `last`: the one before this */
static PetscErrorCode FindActiveSet(Contact contact, PetscBool *seen, PetscBool *last)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  *seen = *last = PETSC_FALSE;
  for (PetscInt k = schwarz->n_tried - 1; k >= 0 && !*seen; k--) {
    int differs = 0;

    for (PetscInt i = 0; i < contact->n_rows; i++) differs |= schwarz->tried[k * contact->n_rows + i] != contact->active[i];
    PetscCall(ContactOr(contact, &differs));
    if (differs) continue;
    *seen = PETSC_TRUE;
    *last = (PetscBool)(k == schwarz->n_tried - 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes that penetrate join, nodes that are pulled leave */
static PetscErrorCode UpdateActiveSet(Contact contact, PetscBool *changed)
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  int      any     = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const PetscBool leaves = (PetscBool)(contact->active[i] && schwarz->recheck && contact->force[i] < 0);
    const PetscBool joins  = (PetscBool)(!contact->active[i] && contact->gap[i] < -contact->tolerance);

    if (!leaves && !joins) continue;
    contact->active[i] = joins;
    any                = 1;
  }
  PetscCall(ContactOr(contact, &any));
  *changed = (PetscBool)(any > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Free trial, where no pair is pushed together already; the rows that penetrate at its end become active */
static PetscErrorCode Trial(Contact contact, PetscBool *in_contact)
{
  PetscFunctionBegin;
  PetscCall(ContactIntegrateFree(contact, in_contact));
  for (PetscInt i = 0; i < contact->n_rows; i++) contact->active[i] = (PetscBool)(contact->gap[i] < -contact->tolerance);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The free trial after all nodes have been let go, being pulled. If it ends in penetration by the same nodes as were held,
   the contact solution is the better of both, and is taken back. */
static PetscErrorCode TrialAfterContact(Contact contact, PetscBool *in_contact, PetscBool *final)
{
  Schwarz  *schwarz = (Schwarz *)contact->data;
  PetscBool seen, last;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyKeep(contact->bodies[b]));
  PetscCall(PetscArraycpy(schwarz->kept_force, contact->force, contact->n_rows));
  PetscCall(Trial(contact, in_contact));
  if (!*in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FindActiveSet(contact, &seen, &last));
  if (!last) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyReinstate(contact->bodies[b]));
  PetscCall(PetscArraycpy(contact->force, schwarz->kept_force, contact->n_rows));
  PetscCall(ContactComputeGaps(contact));
  contact->counts_made.set_cycles++;
  *final = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactStep_Schwarz(Contact contact)
{
  Schwarz  *schwarz = (Schwarz *)contact->data;
  PetscBool in_contact, changed, seen, last, final = PETSC_FALSE;

  PetscFunctionBegin;
  schwarz->n_tried = 0;
  /* push: in contact in the last step (sustainability), with compressive traction at its end (compression) */
  for (PetscInt i = 0; i < contact->n_rows; i++) contact->active[i] = (PetscBool)(contact->saved_active[i] && contact->saved_force[i] > 0);
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscCall(Trial(contact, &in_contact));
  while (in_contact) {
    PetscCheck(schwarz->n_tried < MAX_ROUNDS, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED, "The active set of contact nodes has changed %d times in one controller step; choose a smaller -time_step", MAX_ROUNDS);
    PetscCall(PetscArraycpy(schwarz->tried + schwarz->n_tried++ * contact->n_rows, contact->active, contact->n_rows));
    PetscCall(SolveActive(contact));
    if (final) break;
    PetscCall(UpdateActiveSet(contact, &changed));
    if (!changed) break;
    contact->counts_made.set_changes++;
    PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
    if (!in_contact) {
      PetscCall(TrialAfterContact(contact, &in_contact, &final));
      if (final) break;
    }
    PetscCall(FindActiveSet(contact, &seen, &last));
    if (in_contact && seen) {
      /* the alternation ends with all nodes held that were held in either of the last two sets: no penetration */
      contact->counts_made.set_cycles++;
      for (PetscInt i = 0; i < contact->n_rows; i++) contact->active[i] = (PetscBool)(contact->active[i] || schwarz->tried[(schwarz->n_tried - 1) * contact->n_rows + i]);
      final = PETSC_TRUE;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactView_Schwarz(Contact contact, PetscViewer viewer)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;
  SNESType       type;

  PetscFunctionBegin;
  PetscCall(SNESGetType(schwarz->outer.snes, &type));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  outer iteration %s%s, %s traction, tolerances %g m and %g relative\n", type, schwarz->relaxation == RELAXATION_AITKEN ? " (Aitken)" : "", BodyTractionTypes[schwarz->traction], (double)schwarz->atol, (double)schwarz->rtol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactDestroy_Schwarz(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  if (schwarz->trace)
    for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(TraceDestroy(&schwarz->trace[p]));
  for (PetscInt k = 0; k < 2; k++) PetscCall(TraceDestroy(&schwarz->rate[k]));
  PetscCall(OuterSolverDestroy(&schwarz->outer));
  PetscCall(VecDestroy(&schwarz->last_residual));
  PetscCall(PetscFree4(schwarz->levels, schwarz->trace, schwarz->offset, schwarz->kinematic));
  PetscCall(PetscFree2(schwarz->all_offset, schwarz->jacobian_active));
  PetscCall(SchwarzDestroyNewton(contact));
  PetscCall(PetscFree2(schwarz->tried, schwarz->kept_force));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   CONTACT_SCHWARZ - the Schwarz alternating method: displacements one way, tractions the other, until both agree

   Options Database Keys:
+  -schwarz_snes_type (newtonls|anderson|nrichardson|ngmres|qn) - the outer iteration; newtonls uses the interface compliance
.  -schwarz_snes_atol, -schwarz_snes_rtol                       - tolerances on the change of position, 1e-12 m and 1e-15
.  -schwarz_snes_max_it n                                       - limit of iterations, 50
.  -schwarz_snes_linesearch_damping theta                       - relaxation of nrichardson, 1 (Aitken: first one, 1/2)
.  -schwarz_relaxation (fixed|aitken)                           - relaxation of nrichardson
.  -schwarz_traction (internal|reaction)                        - nodal force handed over: without or with inertia
.  -schwarz_convergence (auto|position|mismatch)                - change of all positions from sweep to sweep (the paper's), or
                                                                  the change of the contact nodes that a plain sweep would bring
.  -schwarz_recheck (true|false)                                - whether tensile nodes leave contact within the step
-  -schwarz_unconverged (error|accept)                          - what to do with a step that does not converge

   Level: beginner

   Reference:
.  * - J. Hoy, I. Tezaur, A. Mota, The Schwarz alternating method for multiscale contact mechanics, 2021

.seealso: `ContactSetType()`, `CONTACT_PENALTY`, `CONTACT_LAGRANGE`
M*/
PetscErrorCode ContactCreate_Schwarz(Contact contact)
{
  Schwarz *schwarz;

  PetscFunctionBegin;
  PetscCall(PetscNew(&schwarz));
  schwarz->traction            = BODY_TRACTION_INTERNAL;
  schwarz->recheck             = PETSC_TRUE;
  contact->data                = schwarz;
  contact->ops->setfromoptions = ContactSetFromOptions_Schwarz;
  contact->ops->setup          = ContactSetUp_Schwarz;
  contact->ops->step           = ContactStep_Schwarz;
  contact->ops->view           = ContactView_Schwarz;
  contact->ops->destroy        = ContactDestroy_Schwarz;
  PetscFunctionReturn(PETSC_SUCCESS);
}
