/*
   Nodes with rows of several pairs, whose directions may depend on each other: a block that stands astride two others, or on two plane
   obstacles side by side. What must hold is that of each pair on its own, whatever the method: no gap is negative, no force pulls, and a
   force is there where the gap is closed. This defines the gaps, and the forces too if of the partners of a node all but one give way. But
   a body can be prescribed only where its rows are independent. So, where Schwarz's method runs on the bodies' compliance, of the active
   rows of a node

   - the first that are independent are prescribed;
   - the others with a partner that answers to forces have their force for an unknown, on both sides, and the condition that their gap is
   closed: what both partners take is then what they would take under Lagrange multipliers;
   - the others with a partner that does not (an obstacle, or an explicit body whose contact nodes have mass) are let go: their gap is
   closed by the rows before them, unless their partner is deeper inside, and then it comes first.

   Elsewhere rows that depend on each other are prescribed by least squares, weighted by the areas that the partners cover:
   see BodySetRowWeights().
   Of obstacles with one normal at a node only the nearest counts.
*/
#include <impakt/private/contactimpl.h>

/* Of a direction, what is not along others, squared. Obstacles are dropped only if they are parallel; bodies are better prescribed where
   directions differ clearly. */
#define PARALLEL 1e-8
#define NEAR     1e-2

/* The direction of a row at a shared node, without the displacements that the user prescribes */
static void GetDirection(Contact contact, PetscInt node, PetscInt i, PetscReal direction[3])
{
  for (PetscInt d = 0; d < 3; d++)
    direction[d] = d < contact->dim && contact->shared.free_dofs[3 * node + d] ? contact->row_normal[3 * i + d] : 0;
}

static PetscErrorCode MarkFreeDofs(Contact contact, PetscInt node)
{
  const PetscInt  i = contact->shared.rows[contact->shared.offsets[node]];
  const PetscInt *held;
  PetscInt        n;

  PetscFunctionBegin;
  PetscCall(BodyGetHeldDofs(contact->bodies[contact->pairs[contact->row_pair[i]].body[0]], &n, &held));
  for (PetscInt d = 0; d < contact->dim; d++) {
    PetscInt place;

    PetscCall(PetscFindInt(contact->row_dof[i] + d, n, held, &place));
    contact->shared.free_dofs[3 * node + d] = (PetscBool)(place < 0);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds them. They stay the same: all rows of a node are on the rank that owns it. */
PetscErrorCode ContactFindSharedNodes(Contact contact)
{
  SharedNodes   *shared = &contact->shared;
  const PetscInt n      = contact->n_rows;
  PetscInt      *rows, *keys, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &rows, n, &keys));
  PetscCall(PetscCalloc4(n + 1, &shared->offsets, n, &shared->rows, n, &shared->left_out, 3 * n, &shared->free_dofs));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt of_body = 0;

    for (PetscInt i = 0; i < n; i++) {
      if (contact->pairs[contact->row_pair[i]].body[0] != b) continue;
      rows[of_body]   = i;
      keys[of_body++] = contact->row_dof[i];
    }
    PetscCall(PetscSortIntWithArray(of_body, keys, rows));
    for (PetscInt begin = 0, end; begin < of_body; begin = end) {
      for (end = begin + 1; end < of_body && keys[end] == keys[begin];) end++;
      PetscCall(PetscSortInt(end - begin, rows + begin));
      if (contact->row_pair[rows[begin]] == contact->row_pair[rows[end - 1]]) continue;
      for (PetscInt k = begin; k < end; k++) shared->rows[count++] = rows[k];
      shared->offsets[++shared->n] = count;
      PetscCall(MarkFreeDofs(contact, shared->n - 1));
    }
  }
  PetscCall(PetscFree2(rows, keys));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroySharedNodes(Contact contact)
{
  SharedNodes *shared = &contact->shared;

  PetscFunctionBegin;
  PetscCall(PetscFree4(shared->offsets, shared->rows, shared->left_out, shared->free_dofs));
  PetscCall(PetscFree4(contact->by_force, shared->unit, shared->answers, shared->sorted));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether row i says the same as row j, of another obstacle which is nearer */
static PetscBool IsBehind(Contact contact, PetscInt i, PetscInt j)
{
  const PetscReal *a = contact->row_normal + 3 * i, *b = contact->row_normal + 3 * j;
  const PetscReal  along = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  if (contact->row_pair[i] == contact->row_pair[j] || !contact->pairs[contact->row_pair[j]].obstacle || !contact->opposite[j])
    return PETSC_FALSE;
  if (along <= 0 || PetscSqr(along) < 1 - PARALLEL) return PETSC_FALSE;
  return (PetscBool)(contact->initial_gap[j] < contact->initial_gap[i] || (contact->initial_gap[j] == contact->initial_gap[i] && j < i));
}

/* Rows that have been left out come back, unless their pair has been described anew */
static PetscErrorCode Reconsider(Contact contact, PetscInt i)
{
  const ContactPair *pair = &contact->pairs[contact->row_pair[i]];
  const PetscInt     node = (i - pair->begin) / pair->components;
  TransferRows       rows;

  PetscFunctionBegin;
  if (contact->opposite[i]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TransferGetRows(pair->transfer, &rows));
  contact->opposite[i] = rows.opposite[node];
  contact->area[i]     = rows.area[node];
  if (rows.opposite[node]) contact->initial_gap[i] = rows.gap[node];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Leaves rows of obstacles out that lie behind others; call with the rows of all pairs described */
PetscErrorCode ContactLeaveOutObstacles(Contact contact)
{
  SharedNodes *shared = &contact->shared;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < shared->offsets[shared->n]; k++)
    if (shared->left_out[k]) PetscCall(Reconsider(contact, shared->rows[k]));
  for (PetscInt node = 0; node < shared->n; node++) {
    const PetscInt begin = shared->offsets[node], end = shared->offsets[node + 1];

    for (PetscInt k = begin; k < end; k++) {
      const PetscInt i = shared->rows[k];

      shared->left_out[k] = PETSC_FALSE;
      if (!contact->pairs[contact->row_pair[i]].obstacle || !contact->opposite[i]) continue;
      for (PetscInt l = begin; l < end && !shared->left_out[k]; l++) shared->left_out[k] = IsBehind(contact, i, shared->rows[l]);
    }
    for (PetscInt k = begin; k < end; k++) {
      const PetscInt i = shared->rows[k];

      if (!shared->left_out[k]) continue;
      contact->opposite[i] = contact->tied[i] = PETSC_FALSE;
      contact->initial_gap[i]                 = CONTACT_NO_GAP;
      contact->area[i]                        = 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Force for a metre of the unknown that stands for it: of an element of the bodies on both sides, one behind the other */
static PetscErrorCode GetUnit(Contact contact, const ContactPair *pair, PetscReal *unit)
{
  PetscReal flexibility = 0;

  PetscFunctionBegin;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    PetscReal stiffness;

    PetscCall(BodyGetElementStiffness(contact->bodies[pair->body[side]], &stiffness));
    flexibility += 1 / stiffness;
  }
  *unit = 1 / flexibility;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For a method that prescribes displacements; `arranges`: it may have forces for unknowns. After the bodies have been set up. */
PetscErrorCode ContactSetUpSharedNodes(Contact contact, PetscBool arranges)
{
  SharedNodes *shared = &contact->shared;
  PetscInt     most   = 0;

  PetscFunctionBegin;
  for (PetscInt node = 0; node < shared->n; node++) most = PetscMax(most, shared->offsets[node + 1] - shared->offsets[node]);
  PetscCall(PetscCalloc4(contact->n_rows, &contact->by_force, contact->n_pairs, &shared->unit, contact->n_pairs, &shared->answers, most,
                         &shared->sorted));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    PetscCall(GetUnit(contact, pair, &shared->unit[p]));
    if (!pair->obstacle) PetscCall(BodyFeelsEndForce(contact->bodies[pair->body[1]], &shared->answers[p]));
  }
  for (PetscInt i = 0; i < contact->n_rows; i++) contact->by_force[i] = contact->pairs[contact->row_pair[i]].by_force;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetRowWeights(contact->bodies[b], contact->area));
  shared->arranges = arranges;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Force along a row for a metre of its unknown [N/m] */
PetscReal ContactForceUnit(Contact contact, PetscInt i)
{
  return contact->shared.unit[contact->row_pair[i]] * contact->area[i] * contact->cross_section[contact->row_pair[i]];
}

/* The active rows of a node in the order in which they are prescribed: of those whose partner does not answer to forces, first the ones
   that penetrate; then the others */
static PetscInt SortActive(Contact contact, PetscInt node)
{
  SharedNodes *shared = &contact->shared;
  PetscInt     count  = 0;

  for (PetscInt round = 0; round < 3; round++)
    for (PetscInt k = shared->offsets[node]; k < shared->offsets[node + 1]; k++) {
      const PetscInt  i     = shared->rows[k];
      const PetscBool first = (PetscBool)(contact->gap[i] < -contact->tolerance);

      if (contact->active[i] && round == (shared->answers[contact->row_pair[i]] ? 2 : first ? 0 : 1)) shared->sorted[count++] = i;
    }
  return count;
}

/* What is left of a direction without its parts along the unit vectors of a basis, which it becomes one of if that is more than `least` of
   it, squared */
static PetscBool Extends(PetscReal direction[3], PetscReal least, PetscInt *n, PetscReal basis[3][3])
{
  PetscReal before = 0, after = 0;

  for (PetscInt d = 0; d < 3; d++) before += PetscSqr(direction[d]);
  for (PetscInt b = 0; b < *n; b++) {
    const PetscReal along = direction[0] * basis[b][0] + direction[1] * basis[b][1] + direction[2] * basis[b][2];

    for (PetscInt d = 0; d < 3; d++) direction[d] -= along * basis[b][d];
  }
  for (PetscInt d = 0; d < 3; d++) after += PetscSqr(direction[d]);
  if (*n == 3 || !(after > least * before)) return PETSC_FALSE;
  for (PetscInt d = 0; d < 3; d++) basis[*n][d] = direction[d] / PetscSqrtReal(after);
  (*n)++;
  return PETSC_TRUE;
}

/* What each active row of shared nodes is to be, as told above: prescribed, by its force, or not active */
void ContactArrangeShared(Contact contact)
{
  SharedNodes *shared = &contact->shared;

  for (PetscInt node = 0; node < shared->n && shared->arranges; node++) {
    const PetscInt count = SortActive(contact, node);
    PetscReal      basis[3][3];
    PetscInt       n = 0;

    for (PetscInt k = 0; k < count; k++) {
      const PetscInt  i       = shared->sorted[k];
      const PetscBool answers = shared->answers[contact->row_pair[i]];
      PetscReal       direction[3];
      PetscBool       independent;

      if (contact->pairs[contact->row_pair[i]].by_force) continue; /* not prescribed anyway */
      GetDirection(contact, node, i, direction);
      independent          = Extends(direction, answers ? NEAR : PARALLEL, &n, basis);
      contact->by_force[i] = (PetscBool)(!independent && answers);
      contact->active[i]   = (PetscBool)(independent || answers);
    }
  }
}
