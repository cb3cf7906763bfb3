/*
   Forces that are balanced along the normals of both sides.

   Without friction the pressure on each surface acts along that surface's own normal. Forces lambda_i of the rows act along one line for
   both sides; along the normals of the first side they would sum up to sum lambda_i n_i, along those of the second to sum -lambda_i m_i. In
   a contact that the mesh resolves both are the same, since surfaces that touch are parallel. In one of two or three nodes they are not:
   the centre of pressure lies somewhere between the nodes, where it hangs on the mesh, and spins discs that should not spin.

   With c_i the component of n_i + m_i across the row, both sums are the same if S = sum lambda_i c_i is zero. What is dual to this
   condition is a turn theta of the gap: rows have the gap g_i + theta c_i, which shifts the place at which curved surfaces meet and does no
   work while S is zero. Before contact theta is that which makes the smallest gap largest, so that the nodes on both sides of that place
   touch at one time. In contact it follows S by a proportional and integral rule: the turn needs no knowledge of the bodies but about how
   stiff they are.
*/
#include "interfaceimpl.h"

/* Part of what is out of balance that is turned back in a step, and part of it by which the rate of the turn changes. With the stiffness
   that TransferSetBalance() is told the turn is stable up to twice the first part. */
#define PROPORTIONAL 0.5
#define INTEGRAL     0.08
/* Where rows have joined or left the rate is learnt anew: by this part at once, and in later steps by half as much each */
#define ANEW 0.5
/* Turns before contact are found within this, by so many halvings: more is no turn of a curved surface between two nodes [edges] */
#define LARGEST_TURN 1.0
#define HALVINGS     50
/* Least squares of c_i that count: surfaces that are parallel within 1e-3 rad are balanced */
#define PARALLEL 1e-6

/* The component c_i of a row; 0 where nothing is turned, which is where the surface has an edge */
static PetscReal Unevenness(const Transfer transfer, PetscInt row)
{
  const RowSet    *set    = &transfer->rows;
  const PetscReal *normal = set->normals + 2 * row, *node = transfer->dirichlet->data.normals + 3 * row;
  PetscReal        partner[2] = {0, 0};

  if (!set->opposite[row] || set->beyond[row]) return 0;
  for (PetscInt j = set->offsets[row]; j < set->offsets[row + 1]; j++)
    for (PetscInt d = 0; d < 2; d++) partner[d] += set->shares[j].value * transfer->column_normals[3 * set->columns[j] + d];
  if (RowBendCounts(-(partner[0] * node[0] + partner[1] * node[1])) == 0) return 0;
  return normal[0] * (node[1] + partner[1]) - normal[1] * (node[0] + partner[0]);
}

/* The turn that makes the smallest gap of all rows largest: where it is, the gaps of rows with c_i of both signs are the same */
static PetscErrorCode FindTurn(Transfer transfer, PetscReal *turn)
{
  const Balance *balance = &transfer->balance;
  PetscReal      low = -LARGEST_TURN, high = LARGEST_TURN;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < HALVINGS; i++) {
    struct {
      double gap;
      int    rank;
    } least          = {PETSC_MAX_REAL, 0};
    int         sign = 0;
    PetscMPIInt rank;

    PetscCallMPI(MPI_Comm_rank(transfer->comm, &rank));
    least.rank = rank;
    *turn      = 0.5 * (low + high);
    for (PetscInt row = 0; row < transfer->n; row++) {
      const PetscReal gap = balance->gap[row] - balance->turned[row] + *turn * balance->uneven[row];

      if (balance->uneven[row] == 0 || gap >= least.gap) continue;
      least.gap = gap;
      sign      = balance->uneven[row] > 0 ? 1 : -1;
    }
    PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE_INT, MPI_MINLOC, transfer->comm));
    PetscCallMPI(MPI_Bcast(&sign, 1, MPI_INT, least.rank, transfer->comm));
    if (sign > 0) low = *turn;
    else high = *turn;
  }
  if (PetscAbsReal(*turn) > 0.9 * LARGEST_TURN) *turn = 0; /* all c_i have one sign: the surfaces meet beyond the rows */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much to turn in contact. No open row may be turned into the partner. */
static PetscErrorCode FollowForces(Transfer transfer, const PetscReal force[], const PetscReal sums[], PetscReal *change)
{
  Balance        *balance   = &transfer->balance;
  const PetscReal uneven    = sums[0] / (balance->stiffness * PetscMax(sums[1], PARALLEL));
  PetscReal       limits[2] = {-PETSC_MAX_REAL, -PETSC_MAX_REAL}; /* how far to turn up, and down, with their signs changed */

  PetscFunctionBegin;
  if (balance->n_active != (PetscInt)sums[2]) balance->gain = ANEW;
  balance->n_active = (PetscInt)sums[2];
  balance->rate += PetscMax(INTEGRAL, balance->gain) * uneven;
  balance->gain *= 0.5;
  *change = PROPORTIONAL * uneven + balance->rate;
  for (PetscInt row = 0; row < transfer->n; row++) {
    const PetscReal c = balance->uneven[row];

    if (c == 0 || force[row] > 0) continue;
    limits[c > 0] = PetscMax(limits[c > 0], -PetscMax(balance->gap[row], 0) / PetscAbsReal(c));
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, limits, 2, MPIU_REAL, MPIU_MAX, transfer->comm));
  if (*change > -limits[0] || *change < limits[1]) {
    *change       = PetscMax(limits[1], PetscMin(-limits[0], *change));
    balance->rate = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetBalance - prepares a transfer for `TransferBalance()`

  Logically Collective

  Input Parameters:
+ transfer  - the `Transfer`, between two surfaces in two dimensions
- stiffness - of both sides one after the other, against a force on a row [N/m]

  Level: developer

.seealso: `Transfer`, `TransferBalance()`, `TransferSetCurved()`
@*/
PetscErrorCode TransferSetBalance(Transfer transfer, PetscReal stiffness)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscValidLogicalCollectiveReal(transfer, stiffness, 2);
  PetscCheck(stiffness > 0, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE, "The stiffness %g N/m must be positive", (double)stiffness);
  PetscCheck(transfer->neumann && transfer->dim == 2, transfer->comm, PETSC_ERR_SUP,
             "Forces are balanced between two surfaces in two dimensions alone");
  transfer->balance.stiffness = stiffness;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferBalance - turns the gaps of all rows such that forces have the same sum along the normals of both sides

  Collective

  Input Parameters:
+ transfer - the `Transfer`, after `TransferFollow()` and `TransferSetBalance()`
. force    - of each row of this rank at the start of the step [N]
- reach    - gap up to which rows may come into contact in the step [m]

  Output Parameter:
. any - set to true if gaps have changed, else left as it is

  Level: developer

  Note:
  Rows with a force count as having followed the surfaces.

.seealso: `Transfer`, `TransferFollow()`, `TransferSetBalance()`
@*/
PetscErrorCode TransferBalance(Transfer transfer, const PetscReal force[], PetscReal reach, PetscBool *any)
{
  Balance  *balance = &transfer->balance;
  PetscReal sums[3] = {0, 0, 0}, nearest[1] = {-PETSC_MAX_REAL},
            change = 0; /* S, sum of c_i^2 and rows with a force; minus the least gap without turns */

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscValidLogicalCollectiveReal(transfer, reach, 3);
  PetscAssertPointer(any, 4);
  PetscCall(TransferGetColumns(transfer, transfer->neumann->data.positions, transfer->column_x));
  PetscCall(TransferGetColumns(transfer, transfer->neumann->data.normals, transfer->column_normals));
  for (PetscInt row = 0; row < transfer->n; row++) {
    balance->uneven[row] = Unevenness(transfer, row);
    if (!transfer->rows.opposite[row]) continue;
    balance->gap[row] = TransferPresentGap(transfer, row);
    nearest[0]        = PetscMax(nearest[0], balance->turned[row] - balance->gap[row]);
    if (!(force[row] > 0)) continue;
    sums[0] += force[row] * balance->uneven[row];
    sums[1] += PetscSqr(balance->uneven[row]);
    sums[2]++;
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPIU_SUM, transfer->comm));
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, nearest, 1, MPIU_REAL, MPIU_MAX, transfer->comm));
  if (sums[2] > 0) PetscCall(FollowForces(transfer, force, sums, &change));
  else {
    balance->rate     = 0;
    balance->n_active = 0;
    if (-nearest[0] > reach) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(FindTurn(transfer, &change));
    change -= balance->turn;
  }
  balance->turn += change;
  for (PetscInt row = 0; row < transfer->n; row++) {
    const PetscBool pushes = (PetscBool)(force[row] > 0);
    PetscReal       more   = pushes ? change * balance->uneven[row] : balance->turn * balance->uneven[row] - balance->turned[row];

    if (balance->uneven[row] == 0) continue;
    if (!pushes && balance->gap[row] + more < 0) more = -PetscMax(balance->gap[row], 0);
    transfer->rows.gap[row] += more;
    balance->turned[row] += more;
    if (pushes) transfer->followed[row] = PETSC_TRUE;
  }
  *any = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
