/*
   One controller step of bodies that touch. (1) All bodies are advanced under a guess of the forces of rows; (2) the law of each node's
   rows is solved on what these would read under other forces, y + S dlambda; (3) all are advanced under the solution; (4) what rows read is
   compared with what S told of it. Where they agree the step is made; else S is corrected by the secant, and (2) comes again. (1), (3), (4)
   are one evaluation of the outer SNES, F = lambda - (2)(lambda), and (2) is the SNES of solve/.

   Secants: C. G. Broyden, IMA Journal of Applied Mathematics 6 (1970) 76-90 and 222-231, and Fletcher, Goldfarb, Shanno in the same year.
*/
#include "stepimpl.h"
#include <contact/compliance/forces.h>
#include <contact/laws/friction.h>
#include <sys/petsccompat.h>

#define CURVATURE   1e-10 /* a secant counts whose work is at least this part of what S tells of it */
#define MOST_PASSES 50
#define EXACT       1e-9 /* S has told right what differs by less than this part of it */

static ContactStepper *Stepper(Contact contact)
{
  return (ContactStepper *)contact->data;
}

/* Rates of rows as the step begins */
PetscErrorCode ContactStepperComputeRates(Contact contact, PetscReal rate[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscScalar       *v[2];

    for (PetscInt side = 0; side < 2; side++) PetscCall(TraceGetLevel(contact->traces[pair->body[side]].velocity, 0, &v[side]));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      rate[i] = PetscRealPart(v[1][i - pair->shift[1]] - v[0][i - pair->shift[0]]);
      if (contact->friction.drive) rate[i] += contact->friction.drive[i] / contact->step;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a row reads, less what it may: by the law */
static PetscReal Reading(Contact contact, const ContactStepper *stepper, PetscInt i)
{
  const PetscBool rubs = ContactRowRubs(contact, i);

  if (stepper->problem.law->reads == ROW_LAW_READS_END) return contact->end.gap[i];
  return (rubs ? contact->friction.slip[i] : contact->end.gap[i] - contact->start.gap[i]) - stepper->lets[i];
}

/* Numbers of this rank's touching rows, on all ranks; `fields` of them, one after the other */
static PetscErrorCode Gather(Contact contact, ContactStepper *stepper, PetscInt fields, const PetscReal *const mine[], PetscScalar all[])
{
  const PetscInt n = stepper->problem.n;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(all, fields * n));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt i = stepper->rows[k] - contact->rows.begin;

    for (PetscInt f = 0; f < fields && i >= 0 && i < contact->rows.n; f++) all[f * n + k] = mine[f][i];
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all, (PetscMPIInt)(fields * n), MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All bodies under the forces contact->end.force; gaps, and what touching rows read */
static PetscErrorCode Advance(Contact contact)
{
  ContactStepper *stepper = Stepper(contact);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall((*stepper->rule->load)(contact, stepper, b));
  PetscCall(ContactIntegrateBodies(contact));
  contact->counts.sweeps++;
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactComputeGaps(contact));
  if (contact->friction.slip) PetscCall(ContactComputeSlips(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A dense S is corrected by what the last two passes have shown of it, unless it has told right; a sparse one does */
static PetscErrorCode CorrectS(ContactStepper *stepper)
{
  LawProblem    *problem = &stepper->problem;
  const PetscInt n       = problem->n;
  PetscScalar   *force = stepper->told, *read = stepper->told + n, *product = stepper->gathered + 2 * n, *S;
  PetscReal      work = 0, told_work = 0, off = 0, largest = 0;

  PetscFunctionBegin;
  if (problem->sparse) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < n; i++) force[i] = problem->base[i] - force[i];
  PetscCall(LawProblemMultiply(problem, force, product));
  for (PetscInt i = 0; i < n; i++) {
    read[i] = problem->read[i] - read[i];
    work += PetscRealPart(force[i] * read[i]);
    told_work += PetscRealPart(force[i] * product[i]);
    off     = PetscMax(off, PetscAbsScalar(read[i] - product[i]));
    largest = PetscMax(largest, PetscAbsScalar(product[i]));
  }
  if (off <= EXACT * largest || !(work > CURVATURE * told_work) || !(told_work > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDenseGetArray(problem->S, &S));
  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) S[j * n + i] += read[i] * read[j] / work - product[i] * product[j] / told_work;
  PetscCall(MatDenseRestoreArray(problem->S, &S));
  for (PetscInt i = 0; i < n; i++) problem->diagonal[i] += PetscRealPart(read[i] * read[i] / work - product[i] * product[i] / told_work);
  stepper->assembled = -1;
  stepper->corrected = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces that the law has for what rows read under those in X, less these: one pass */
static PetscErrorCode ComputeChange(SNES snes, Vec X, Vec F, void *ctx)
{
  Contact            contact = (Contact)ctx;
  ContactStepper    *stepper = Stepper(contact);
  LawProblem        *problem = &stepper->problem;
  const PetscInt     n       = problem->n;
  const PetscReal   *fields[3];
  const PetscScalar *x;
  PetscScalar       *f, *change;
  PetscInt           k = 0;

  PetscFunctionBegin;
  (void)snes;
  PetscCall(VecGetArrayRead(X, &x));
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->end.force[i] = stepper->touches[i] ? PetscRealPart(x[k++]) : 0;
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscCall(Advance(contact));
  if (ContactFailed(contact)) {
    PetscCall(ContactRejectResidual(F));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < contact->rows.n; i++) stepper->mine[i] = stepper->touches[i] ? Reading(contact, stepper, i) : 0;
  fields[0] = contact->end.force;
  fields[1] = stepper->mine;
  fields[2] = stepper->lets;
  PetscCall(Gather(contact, stepper, 3, fields, stepper->gathered));
  PetscCall(PetscArraycpy(problem->base, stepper->gathered, n));
  PetscCall(PetscArraycpy(problem->read, stepper->gathered + n, n));
  PetscCall(PetscArraycpy(problem->force, problem->base, n));
  stepper->corrected = PETSC_FALSE;
  if (stepper->has_told) PetscCall(CorrectS(stepper));
  PetscCall(LawProblemSolve(problem));
  if (!stepper->has_told && stepper->rule->limit) PetscCall((*stepper->rule->limit)(contact, stepper, stepper->gathered + 2 * n));
  PetscCall(PetscArraycpy(stepper->told, problem->base, n));
  PetscCall(PetscArraycpy(stepper->told + n, problem->read, n));
  stepper->has_told = PETSC_TRUE;
  change = stepper->gathered;
  stepper->passes++;
  stepper->off = 0;
  for (PetscInt i = 0; i < n; i++) change[i] = problem->force[i] - problem->base[i];
  PetscCall(LawProblemMultiply(problem, change, change));
  for (PetscInt i = 0; i < n; i++) {
    stepper->off   = PetscMax(stepper->off, PetscAbsScalar(change[i]));
    stepper->scale = PetscMax(stepper->scale, PetscAbsScalar(problem->diagonal[i] * problem->force[i]));
  }
  PetscCall(ContactMonitorPass(contact, stepper));
  PetscCall(PetscInfo(contact, "pass %" PetscInt_FMT ": rows off by %g m of %g m\n", stepper->passes, (double)stepper->off,
                      (double)stepper->scale));
  if (!problem->solved) {
    PetscCall(ContactRejectResidual(F));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecGetArrayWrite(F, &f));
  k = 0;
  for (PetscInt place = 0; place < n; place++) {
    const PetscInt i = stepper->rows[place] - contact->rows.begin;

    if (i >= 0 && i < contact->rows.n) f[k++] = problem->base[place] - problem->force[place];
  }
  PetscCall(VecRestoreArrayWrite(F, &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The step is made where rows would move no more by other forces, beside the way that forces make them go */
static PetscErrorCode TestConvergence(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm,
                                      SNESConvergedReason *reason, void *ctx)
{
  const ContactStepper *stepper = Stepper((Contact)ctx);
  PetscReal             rtol, atol;
  PetscInt              most;

  PetscFunctionBegin;
  (void)xnorm;
  (void)gnorm;
  PetscCall(SNESGetTolerances(snes, &atol, &rtol, NULL, &most, NULL));
  *reason = SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_LOCAL_MIN;
  else if (stepper->off <= rtol * stepper->scale + atol) *reason = SNES_CONVERGED_FNORM_RELATIVE;
  else if (it >= most) *reason = SNES_DIVERGED_MAX_IT;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperCreateOuter(Contact contact, ContactStepper *stepper)
{
  SNESLineSearch line_search;
  SNESType       type;
  PetscBool      known;
  MPI_Comm       comm = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  PetscCall(SNESDestroy(&stepper->outer));
  PetscCall(VecDestroy(&stepper->x));
  PetscCall(VecDestroy(&stepper->f));
  PetscCall(VecCreate(comm, &stepper->x));
  PetscCall(VecSetSizes(stepper->x, stepper->n_local, PETSC_DETERMINE));
  PetscCall(VecSetType(stepper->x, VECSTANDARD));
  PetscCall(VecDuplicate(stepper->x, &stepper->f));
  PetscCall(SNESCreate(comm, &stepper->outer));
  PetscCall(SNESSetOptionsPrefix(stepper->outer, "schwarz_"));
  PetscCall(SNESSetFunction(stepper->outer, stepper->f, ComputeChange, contact));
  PetscCall(SNESSetType(stepper->outer, SNESNRICHARDSON));
  PetscCall(SNESGetLineSearch(stepper->outer, &line_search));
  PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_FULL_STEP));
  PetscCall(SNESSetTolerances(stepper->outer, stepper->atol, stepper->rtol, 0, MOST_PASSES, PETSC_INT_MAX));
  PetscCall(SNESSetErrorIfNotConverged(stepper->outer, PETSC_FALSE));
  PetscCall(SNESSetFromOptions(stepper->outer));
  PetscCall(SNESGetType(stepper->outer, &type));
  PetscCall(PetscObjectTypeCompareAny((PetscObject)stepper->outer, &known, SNESNRICHARDSON, SNESANDERSON, SNESNGMRES, SNESQN, ""));
  PetscCheck(known, comm, PETSC_ERR_USER_INPUT,
             "-schwarz_snes_type %s: the outer iteration of -contact_type force has no Jacobian, since the law of rows is solved inside "
             "it; choose nrichardson, which is the default, anderson, ngmres or qn",
             type);
  PetscCall(SNESSetConvergenceTest(stepper->outer, TestConvergence, contact, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the touching rows of all ranks, by their numbers, and the nodes that have them with their law */
static PetscErrorCode ListRows(Contact contact, ContactStepper *stepper)
{
  LawProblem *problem = &stepper->problem;
  int        *touches = contact->ranks.mine_active, *all = contact->ranks.all_active;
  PetscInt    n = 0, local = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    touches[i] = stepper->touches[i];
    local += stepper->touches[i];
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allgatherv(touches, (PetscMPIInt)contact->rows.n, MPI_INT, all, contact->ranks.counts, contact->ranks.offsets, MPI_INT,
                                PetscObjectComm((PetscObject)contact)));
  else all = touches;
  for (PetscInt i = 0; i < contact->rows.n_all; i++) n += all[i];
  PetscCall(LawProblemResize(problem, n));
  if (n > stepper->room) {
    PetscCall(PetscFree5(stepper->rows, stepper->of_body, stepper->places, stepper->gathered, stepper->of_assembled));
    PetscCall(PetscFree(stepper->told));
    stepper->room = PetscMax(n, 2 * stepper->room);
    PetscCall(PetscMalloc5(stepper->room, &stepper->rows, stepper->room, &stepper->of_body, stepper->room, &stepper->places,
                           3 * stepper->room, &stepper->gathered, stepper->room, &stepper->of_assembled));
    PetscCall(PetscMalloc1(2 * stepper->room, &stepper->told));
    stepper->assembled = -1;
  }
  stepper->n_local = local;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  n = problem->n_nodes = 0;
  for (PetscInt i = 0; i < contact->rows.n_all; i++) {
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[i]];

    if (!all[i]) continue;
    /* the rows of a node follow each other, and touch all together */
    if (!problem->n_nodes || n - problem->begin[problem->n_nodes - 1] == pair->components ||
        contact->ranks.row_pair[i] != contact->ranks.row_pair[stepper->rows[n - 1]])
      problem->begin[problem->n_nodes++] = n;
    stepper->rows[n++] = i;
  }
  problem->begin[problem->n_nodes] = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bounds that the law of friction has for touching nodes, on all ranks */
static PetscErrorCode GetLimits(Contact contact, ContactStepper *stepper)
{
  LawProblem      *problem = &stepper->problem;
  const PetscReal *fields[2];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(problem->limit, 2 * problem->n_nodes));
  if (contact->options.law != CONTACT_LAW_FRICTION) PetscFunctionReturn(PETSC_SUCCESS);
  fields[0] = stepper->mine;
  fields[1] = stepper->before;
  PetscCall(PetscArrayzero(stepper->mine, contact->rows.n));
  PetscCall(PetscArrayzero(stepper->before, contact->rows.n));
  for (PetscInt i = 0; i < contact->rows.n; i += contact->dim)
    (*contact->friction.law.getlimit)(contact, contact->friction.law.data, i, contact->friction.speed[i], &stepper->mine[i],
                                      &stepper->before[i]);
  PetscCall(Gather(contact, stepper, 2, fields, stepper->gathered));
  for (PetscInt node = 0; node < problem->n_nodes; node++)
    for (PetscInt k = 0; k < 2; k++) problem->limit[2 * node + k] = PetscRealPart(stepper->gathered[k * problem->n + problem->begin[node]]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest way of a touching row as the step begins [m], for the tolerance */
static PetscErrorCode FindScale(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  stepper->scale = 0;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (stepper->touches[i]) stepper->scale = PetscMax(stepper->scale, PetscAbsReal(contact->step * stepper->rate[i]));
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &stepper->scale, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The outer iteration over the touching rows */
static PetscErrorCode Iterate(Contact contact, ContactStepper *stepper)
{
  SNESConvergedReason reason;
  PetscScalar        *x;
  PetscInt            size = 0, k = 0;
  int                 other;
  PetscReal           time, atol, rtol;

  PetscFunctionBegin;
  if (stepper->x) PetscCall(VecGetLocalSize(stepper->x, &size));
  other = !stepper->x || size != stepper->n_local;
  PetscCall(ContactOr(contact, &other));
  if (other) PetscCall(ContactStepperCreateOuter(contact, stepper));
  PetscCall(VecGetArrayWrite(stepper->x, &x));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (stepper->touches[i]) x[k++] = contact->end.force[i];
  PetscCall(VecRestoreArrayWrite(stepper->x, &x));
  PetscCall(FindScale(contact, stepper));
  stepper->has_told = PETSC_FALSE;
  PetscCall(SNESSolve(stepper->outer, NULL, stepper->x));
  PetscCall(SNESGetConvergedReason(stepper->outer, &reason));
  PetscCall(ContactMonitorStep(contact, stepper, reason));
  if (reason > 0 || ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ForcesGetTime(contact, &time));
  if (!stepper->problem.solved) {
    PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                             "The law of the %" PetscInt_FMT
                             " contact rows of the step that ends at time %.9g s was not solved in %" PetscInt_FMT
                             " iterations; choose a smaller -time_step, raise -law_snes_max_it and -law_nodes_snes_max_it, or look with "
                             "-law_snes_monitor and -law_nodes_snes_monitor",
                             stepper->problem.n, (double)time, stepper->problem.iterations));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(SNESGetTolerances(stepper->outer, &atol, &rtol, NULL, NULL, NULL));
  PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                           "The contact forces of the step that ends at time %.9g s were not found in %" PetscInt_FMT
                           " passes: rows are off by %g m, where %g m are allowed%s; choose a smaller -time_step, raise "
                           "-schwarz_snes_max_it, or look with -schwarz_snes_monitor and -info",
                           (double)time, stepper->passes, (double)stepper->off, (double)(rtol * stepper->scale + atol),
                           PetscIsInfOrNanReal(stepper->off) ? " (not a number)" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One controller step of all bodies */
PetscErrorCode ContactStepperStep(Contact contact)
{
  ContactStepper *stepper = Stepper(contact);
  PetscBool       more    = PETSC_TRUE;

  PetscFunctionBegin;
  stepper->passes = 0;
  PetscCall(PetscArraycpy(stepper->last, contact->start.force, contact->rows.n));
  PetscCall((*stepper->rule->begin)(contact, stepper));
  PetscCall(ContactSetConditions(contact, CONDITIONS_FORCES));
  while (more) {
    PetscCall(ListRows(contact, stepper));
    if (stepper->problem.n) {
      PetscCall(GetLimits(contact, stepper));
      PetscCall(ContactStepperAssemble(contact, stepper));
      PetscCall(Iterate(contact, stepper));
    } else PetscCall(Advance(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    more = PETSC_FALSE;
    if (stepper->rule->more) PetscCall((*stepper->rule->more)(contact, stepper, &more));
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++) {
      const PetscInt first = i - (i - contact->pairs[p].begin) % contact->pairs[p].components;

      contact->end.active[i] = (PetscBool)(contact->rows.tied[first] || contact->end.force[first] > 0);
    }
  if (stepper->rule->end) PetscCall((*stepper->rule->end)(contact, stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}
