/* The first state of massless nodes is the one in which they are in balance, under loads, with strains of the initial displacement, and
   with the forces of ties and of closed rows. With the layer of each body held by the rest of it, which stays where the user has put it,
   gaps g answer to forces l on the rows by

     g = g* + S l,   S = sum_bodies B K_LL^{-1} B^T,   g*: gaps of layers that relax without contact.

   The laws of rows hold for g and l as they do in a step (contact/solve), with the springs of the penalty method on the diagonal of S. Rows
   across normals read how far they have slipped from where the user has put the bodies, so that a state of rest under friction stays one.
   Nonlinear bodies repeat it with the tangents at the displacements found. The forces are those of the first record of the history. */
#include <contact/parts.h>
#include <contact/rows/inversemass.h>
#include <contact/solve/lawimpl.h>
#include <impakt/private/bodystart.h>

/* Rows up to which S has entries; more are products with it */
#define FEW_ROWS 500
/* Rounds of nonlinear layers; the layer is in balance when its last change is below this part of the largest one */
#define MAX_ROUNDS 50
#define SMALL      1e-13

/* What all ranks have to know of a row: how it takes part, with the bounds of friction of its node, the compliance of its spring [m/N],
   what it reads without forces [m], and the force to begin with [N] */
enum { TOLD_KIND, TOLD_COHESION, TOLD_COEFFICIENT, TOLD_SPRING, TOLD_READ, TOLD_FORCE, N_TOLD };
enum { ROW_NONE, ROW_OPENS, ROW_HELD, ROW_ACROSS }; /* rows across a normal follow that along it */

typedef struct {
  Contact      contact;
  PetscBool   *takes_part;                     /* per row: its force is looked for here */
  PetscReal   *relaxed;                        /* per row: g*, or across a normal the slip of layers that relax [m] */
  PetscReal   *put;                            /* per row across a normal: B u as the bodies have been put [m] */
  PetscReal    change;                         /* of the layers in this round [m] */
  LawProblem   problem;                        /* the same on every rank */
  RowLaw       open, held;                     /* of rows that push, and of those that pull as well */
  PetscInt    *rows;                           /* of the problem, by their numbers among those of all ranks, ascending */
  PetscReal   *springs;                        /* of the same [m/N] */
  PetscScalar *on_body, *moved, *force, *ways; /* work space, per row */
  PetscReal   *told, *all;                     /* the same: numbers of each row of this rank; of all ranks */
} StartBalance;

/* all = what the ranks have in `told`, n numbers for each row */
static PetscErrorCode Gather(StartBalance *start, PetscMPIInt n)
{
  const Contact contact = start->contact;
  MPI_Datatype  numbers;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous(n, MPIU_REAL, &numbers));
  PetscCallMPI(MPI_Type_commit(&numbers));
  PetscCallMPI(MPI_Allgatherv(start->told, (PetscMPIInt)contact->rows.n, numbers, start->all, contact->ranks.counts, contact->ranks.offsets,
                              numbers, PetscObjectComm((PetscObject)contact)));
  PetscCallMPI(MPI_Type_free(&numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* force = forces on the rows of the problem, ways = S force without springs: of this rank's rows */
static PetscErrorCode Respond(StartBalance *start, const PetscScalar of_problem[])
{
  const Contact contact = start->contact;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(start->force, contact->rows.n));
  for (PetscInt k = 0; k < start->problem.n; k++) {
    const PetscInt i = start->rows[k] - contact->rows.begin;

    if (i >= 0 && i < contact->rows.n) start->force[i] = of_problem[k];
  }
  PetscCall(PetscArrayzero(start->ways, contact->rows.n));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactTakeRows(contact, b, start->force, start->on_body);
    PetscCall(BodyMultiplyLayerCompliance(contact->bodies[b], start->on_body, start->moved));
    ContactAddRows(contact, b, start->moved, start->ways);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = S x of the rows of the problem, collective */
static PetscErrorCode Multiply(Mat S, Vec x, Vec y)
{
  StartBalance      *start;
  const PetscScalar *in;
  PetscScalar       *out;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(S, &start));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(Respond(start, in));
  for (PetscInt i = 0; i < start->contact->rows.n; i++) start->told[i] = PetscRealPart(start->ways[i]);
  PetscCall(Gather(start, 1));
  PetscCall(VecGetArrayWrite(y, &out));
  for (PetscInt k = 0; k < start->problem.n; k++) out[k] = start->all[start->rows[k]] + start->springs[k] * in[k];
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TakeS(StartBalance *start)
{
  const PetscInt n = start->problem.n;
  Mat            S, near = NULL;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(PETSC_COMM_SELF, n, n, n, n, start, &S));
  PetscCall(MatShellSetOperation(S, MATOP_MULT, (void (*)(void))Multiply));
  if (n > FEW_ROWS) {
    PetscCall(MatCreateConstantDiagonal(PETSC_COMM_SELF, n, n, n, n, 1, &near));
    PetscCall(MatConvert(near, MATSEQAIJ, MAT_INPLACE_MATRIX, &near));
    PetscCall(LawProblemMatchTrace(S, near));
  } else {
    Mat products = S;

    PetscCall(MatComputeOperator(products, MATSEQDENSE, &S));
    PetscCall(MatDestroy(&products));
  }
  PetscCall(LawProblemTakeS(&start->problem, &S, near ? &near : NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compliance of the springs that a method has between both sides of a row, from what they store at a penetration of a metre */
static PetscReal SpringCompliance(Contact contact, PetscInt i)
{
  const PetscReal stored = contact->ops->stored ? (*contact->ops->stored)(contact, i, -1) : 0;

  return stored > 0 ? 0.5 / stored : 0;
}

/* Those rows make up the problem that take part and have a partner, with those across their normals */
static void Tell(StartBalance *start)
{
  const Contact contact = start->contact;
  PetscInt      first   = 0;

  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscBool rubs = ContactRowRubs(contact, i);
    PetscReal      *told = start->told + N_TOLD * i;

    if (!rubs) first = i;
    told[TOLD_KIND] = rubs ? ROW_ACROSS : contact->rows.tied[i] ? ROW_HELD : ROW_OPENS;
    if (!start->takes_part[first] || !(contact->rows.tied[first] || contact->rows.opposite[first])) told[TOLD_KIND] = ROW_NONE;
    told[TOLD_SPRING]   = SpringCompliance(contact, i);
    told[TOLD_READ]     = start->relaxed[i];
    told[TOLD_FORCE]    = contact->end.force[i];
    told[TOLD_COHESION] = told[TOLD_COEFFICIENT] = 0;
    if (i + 1 < contact->rows.n && !rubs && ContactRowRubs(contact, i + 1))
      ContactGetFrictionLimit(contact, i, contact->friction.speed[i], &told[TOLD_COHESION]);
  }
}

static PetscErrorCode TakeRows(StartBalance *start)
{
  LawProblem *problem = &start->problem;
  PetscInt    n       = 0;

  PetscFunctionBegin;
  Tell(start);
  PetscCall(Gather(start, N_TOLD));
  for (PetscInt i = 0; i < start->contact->rows.n_all; i++)
    if (start->all[N_TOLD * i + TOLD_KIND] != ROW_NONE) start->rows[n++] = i;
  PetscCall(LawProblemResize(problem, n));
  problem->n_nodes = 0;
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal *told = start->all + N_TOLD * start->rows[k];

    start->springs[k] = told[TOLD_SPRING];
    problem->read[k]  = told[TOLD_READ];
    problem->force[k] = told[TOLD_FORCE];
    problem->base[k]  = 0;
    if (told[TOLD_KIND] == ROW_ACROSS) continue;
    problem->begin[problem->n_nodes]         = k;
    problem->law[problem->n_nodes]           = told[TOLD_KIND] == ROW_HELD ? &start->held : &start->open;
    problem->limit[2 * problem->n_nodes]     = told[TOLD_COHESION];
    problem->limit[2 * problem->n_nodes + 1] = told[TOLD_COEFFICIENT];
    problem->n_nodes++;
  }
  problem->begin[problem->n_nodes] = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces of the problem, and the gaps that they leave, to the rows */
static PetscErrorCode TakeForces(StartBalance *start)
{
  const Contact     contact = start->contact;
  const LawProblem *problem = &start->problem;

  PetscFunctionBegin;
  PetscCall(Respond(start, problem->force));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscBool rubs = ContactRowRubs(contact, i);

    contact->end.force[i]  = PetscRealPart(start->force[i]);
    contact->end.active[i] = (PetscBool)(!rubs && start->takes_part[i] && (contact->rows.tied[i] || contact->end.force[i] > 0));
    contact->end.gap[i]    = start->takes_part[i] && !rubs ? start->relaxed[i] + PetscRealPart(start->ways[i]) : contact->start.gap[i];
  }
  for (PetscInt node = 0; node < problem->n_nodes && contact->friction.slip; node++) {
    const PetscInt i = start->rows[problem->begin[node]] - contact->rows.begin;

    if (i < 0 || i >= contact->rows.n) continue;
    contact->friction.slides[i] = (PetscBool)(contact->end.active[i] && LawProblemSlides(problem, node));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether squares of what rows read are finite. The energies of other states are not, of which the controller tells with their cause. */
static PetscBool IsFinite(const LawProblem *problem)
{
  PetscBool finite = PETSC_TRUE;

  for (PetscInt k = 0; k < problem->n; k++) finite = (PetscBool)(finite && !PetscIsInfOrNanScalar(PetscSqr(problem->read[k])));
  return finite;
}

static PetscErrorCode SolveRows(StartBalance *start)
{
  LawProblem *problem = &start->problem;

  PetscFunctionBegin;
  PetscCall(TakeRows(start));
  if (problem->n && IsFinite(problem)) {
    PetscCall(TakeS(start));
    PetscCall(LawProblemSolve(problem));
    PetscCheck(problem->solved, PetscObjectComm((PetscObject)start->contact), PETSC_ERR_NOT_CONVERGED,
               "The contact forces of the first state, in which massless nodes are in balance, were not found in %" PetscInt_FMT
               " iterations for %" PetscInt_FMT " rows; raise -law_snes_max_it, or set -contact_balanced_start false to start from the "
               "displacements as they are",
               problem->iterations, problem->n);
  }
  PetscCall(TakeForces(start));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B u of a row as the bodies are now, without what their meshes are apart by [m] */
static PetscErrorCode GetOpening(Contact contact, PetscInt i, PetscReal *opening)
{
  const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];
  PetscScalar       *u[2];

  PetscFunctionBegin;
  PetscCall(ContactGetPairTraces(contact, pair, 0, PETSC_FALSE, u));
  *opening = ContactRowSum(pair, u, i);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The gaps of layers that relax without contact, with tangents at their present displacements */
static PetscErrorCode Relax(StartBalance *start)
{
  const Contact contact = start->contact;

  PetscFunctionBegin;
  start->change = 0;
  PetscCall(ContactReadStartGaps(contact, PETSC_TRUE));
  ContactAlignRubbingRows(contact);
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    start->relaxed[i] = contact->start.gap[i];
    if (!ContactRowRubs(contact, i)) continue;
    PetscCall(GetOpening(contact, i, &start->relaxed[i]));
    start->relaxed[i] -= start->put[i];
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal change;

    PetscCall(BodyRelaxLayer(contact->bodies[b], start->moved, &change));
    start->change = PetscMax(start->change, change);
    for (PetscInt k = 0; k < contact->body_rows[b].n; k++) {
      const PetscInt i = contact->body_rows[b].rows[k];

      if (start->takes_part[i]) start->relaxed[i] += PetscRealPart(start->moved[k]);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Move(StartBalance *start)
{
  const Contact contact = start->contact;

  PetscFunctionBegin;
  start->change = 0;
  for (PetscInt i = 0; i < contact->rows.n; i++) start->moved[i] = contact->end.force[i];
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal change;

    ContactTakeRows(contact, b, start->moved, start->on_body);
    PetscCall(BodyMoveLayer(contact->bodies[b], start->on_body, &change));
    start->change = PetscMax(start->change, change);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows whose forces move a massless node take part, but not ties that keep their mass: ContactStartTies() finds their forces */
static PetscErrorCode FindRows(StartBalance *start)
{
  const Contact contact = start->contact;
  PetscBool    *massless, *mass, *any_mass;

  PetscFunctionBegin;
  PetscCall(PetscCalloc3(contact->rows.n, &massless, contact->rows.n, &mass, contact->rows.n, &any_mass));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodyMarkRows(contact->bodies[b], massless, mass));
    for (PetscInt k = 0; k < contact->body_rows[b].n; k++) {
      const PetscInt i = contact->body_rows[b].rows[k];

      start->takes_part[i] = (PetscBool)(start->takes_part[i] || massless[k]);
      any_mass[i]          = (PetscBool)(any_mass[i] || mass[k]);
    }
  }
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (any_mass[i] && contact->rows.tied[i] && contact->pairs[contact->rows.pair[i]].keeps_mass) start->takes_part[i] = PETSC_FALSE;
  PetscCall(PetscFree3(massless, mass, any_mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(Contact contact, StartBalance *start)
{
  const PetscInt n = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(start, sizeof(*start)));
  start->contact = contact;
  PetscCall(PetscCalloc3(n, &start->takes_part, n, &start->relaxed, n, &start->put));
  PetscCall(PetscCalloc5(n, &start->on_body, n, &start->moved, n, &start->force, n, &start->ways, N_TOLD * n, &start->told));
  PetscCall(
      PetscMalloc3(N_TOLD * contact->rows.n_all, &start->all, contact->rows.n_all, &start->rows, contact->rows.n_all, &start->springs));
  PetscCall(RowLawCreate("unilateral", &start->open));
  PetscCall(RowLawCreate("tie", &start->held));
  PetscCall(LawProblemSetUp(&start->problem));
  PetscCall(FindRows(start));
  for (PetscInt i = 0; i < n; i++)
    if (ContactRowRubs(contact, i)) PetscCall(GetOpening(contact, i, &start->put[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(StartBalance *start)
{
  PetscFunctionBegin;
  PetscCall(LawProblemDestroy(&start->problem));
  PetscCall(PetscFree3(start->all, start->rows, start->springs));
  PetscCall(PetscFree5(start->on_body, start->moved, start->force, start->ways, start->told));
  PetscCall(PetscFree3(start->takes_part, start->relaxed, start->put));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The states of the bodies, and of the rows, as those that the run starts from */
static PetscErrorCode Finish(StartBalance *start)
{
  const Contact  contact = start->contact;
  const PetscInt n       = contact->rows.n;
  PetscReal      stored  = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) start->moved[i] = contact->end.force[i];
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactTakeRows(contact, b, start->moved, start->on_body);
    PetscCall(BodyStartUnderForces(contact->bodies[b], start->on_body));
  }
  PetscCall(ContactReadStartGaps(contact, PETSC_TRUE));
  ContactAlignRubbingRows(contact);
  for (PetscInt i = 0; i < n; i++)
    if (ContactRowRubs(contact, i)) contact->end.active[i] = contact->end.active[ContactFirstRow(contact, i)];
  PetscCall(PetscArraycpy(contact->start.force, contact->end.force, n));
  PetscCall(PetscArraycpy(contact->start.active, contact->end.active, n));
  PetscCall(PetscArraycpy(contact->energy.accepted_force, contact->end.force, n));
  if (contact->ops->stored)
    for (PetscInt i = 0; i < n; i++) stored += contact->energy.last_stored[i] = (*contact->ops->stored)(contact, i, contact->end.gap[i]);
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, &stored, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  contact->resultants.penalty_energy = stored;
  PetscCall(ContactStartImpulses(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether any body has a layer out of balance, and all have inertia: what a body without inertia does in its first step is not known yet */
static PetscErrorCode IsNeeded(Contact contact, PetscBool *needed)
{
  PetscFunctionBegin;
  *needed = PETSC_FALSE;
  if (!contact->options.balanced_start || !(contact->n_pairs || contact->neighbours.come_and_go)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool is_static;

    PetscCall(BodyIsStatic(contact->bodies[b], &is_static));
    if (is_static) PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt b = 0; b < contact->n_bodies && !*needed; b++) PetscCall(BodyIsOutOfBalance(contact->bodies[b], needed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The error of a first state that is not found */
static PetscErrorCode RefuseStart(Contact contact)
{
  char sudden[BODY_SUDDEN_LENGTH] = "";

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && !sudden[0]; b++) PetscCall(BodyDescribeSuddenLoad(contact->bodies[b], sudden));
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
          "The massless nodes found no balance in %d rounds at the start, from the initial displacements and loads of the bodies; give "
          "these smaller values, or set -contact_balanced_start false to start from the displacements as they are%s%s",
          MAX_ROUNDS, sudden[0] ? ". " : "", sudden);
}

/* Moves the massless nodes of all bodies into balance in their first states. Call with the bodies set up, when ties and rows are known. */
PetscErrorCode ContactBalanceStart(Contact contact)
{
  PetscReal    first = 0;
  PetscBool    needed, linear = PETSC_TRUE, out = PETSC_FALSE; /* of balance without forces */
  StartBalance start;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(contact->end.force, contact->rows.n));
  PetscCall(PetscArrayzero(contact->start.force, contact->rows.n));
  PetscCall(PetscArrayzero(contact->end.active, contact->rows.n));
  PetscCall(PetscArrayzero(contact->start.active, contact->rows.n));
  PetscCall(IsNeeded(contact, &needed));
  if (!needed) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool is_linear;

    PetscCall(BodyIsLinear(contact->bodies[b], &is_linear));
    linear = (PetscBool)(linear && is_linear);
  }
  PetscCall(Create(contact, &start));
  for (PetscInt round = 0;; round++) {
    if (round == MAX_ROUNDS) PetscCall(RefuseStart(contact));
    PetscCall(Relax(&start));
    if (round == 0 && start.change == 0) break;
    out = PETSC_TRUE;
    PetscCall(SolveRows(&start));
    PetscCall(Move(&start));
    first = PetscMax(first, start.change);
    if (linear || start.change <= SMALL * first) break;
  }
  if (out) PetscCall(Finish(&start)); /* also where forces put all nodes back where they were, as with the state of a run that goes on */
  PetscCall(Destroy(&start));
  PetscFunctionReturn(PETSC_SUCCESS);
}
