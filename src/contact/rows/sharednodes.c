/*
   Shared nodes have rows of several pairs, whose normals may depend on each other: nodes of a block that stands astride two others, or on
   two plane obstacles side by side. Whatever the method, the conditions of each pair must hold: no gap is negative, no force pulls, and
   there is a force only where a gap is closed. These conditions define the gaps; they define the forces too, if all partners of the node
   but one give way. But the displacement of a node can be prescribed only along independent normals. So, if Schwarz's method runs on the
   bodies' compliance, of the active rows of a node

   - the first independent rows are prescribed;
   - of the others, rows whose partner moves under forces have their force as an unknown, on both sides, with the condition that their gap
   is closed: both partners then get the forces that Lagrange multipliers would give them;
   - the others, whose partner does not move under forces (an obstacle, or an explicit body whose contact nodes have mass), are let go: the
   rows before them close their gap too, unless their partner is deeper inside the body, in which case their row comes first.

   Otherwise rows that depend on each other are prescribed by least squares, weighted by the areas that the partners cover: see
   BodySetRowWeights(). Of several obstacles with the same normal at a node only the nearest counts.
*/
#include <contact/parts.h>

/* Squared sine of the angle between a normal and the span of others below which the normal depends on them. For obstacles 0.006 degrees,
   since their rows are let go, and must be closed by the others; for bodies 6 degrees, since two prescribed displacements along normals
   that are nearly parallel make a large one across them. */
#define PARALLEL 1e-8
#define NEAR     1e-2

/* The normal of a row at a shared node, without its components along held displacements */
static void GetDirection(Contact contact, PetscInt node, PetscInt i, PetscReal direction[3])
{
  for (PetscInt d = 0; d < 3; d++)
    direction[d] = d < contact->dim && contact->shared.free_dofs[3 * node + d] ? contact->rows.normal[3 * i + d] : 0;
}

/* Finds out which displacements of a shared node are not held */
static PetscErrorCode MarkFreeDofs(Contact contact, PetscInt node)
{
  const PetscInt  i = contact->shared.rows[contact->shared.offsets[node]];
  const PetscInt *held;
  PetscInt        n;

  PetscFunctionBegin;
  PetscCall(BodyGetHeldDofs(contact->bodies[contact->pairs[contact->rows.pair[i]].body[0]], &n, &held));
  for (PetscInt d = 0; d < contact->dim; d++) {
    PetscInt place;

    PetscCall(PetscFindInt(contact->rows.dof[i] + d, n, held, &place));
    contact->shared.free_dofs[3 * node + d] = (PetscBool)(place < 0);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the shared nodes of this rank, which are the same for the whole run. All rows of a node are on the rank that owns it. */
PetscErrorCode ContactFindSharedNodes(Contact contact)
{
  SharedNodes   *shared = &contact->shared;
  const PetscInt n      = contact->rows.n;
  PetscInt      *rows, *keys, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &rows, n, &keys));
  PetscCall(PetscCalloc4(n + 1, &shared->offsets, n, &shared->rows, n, &shared->left_out, 3 * n, &shared->free_dofs));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt of_body = 0;

    for (PetscInt k = 0; k < contact->body_rows[b].n; k++) {
      const PetscInt i = contact->body_rows[b].rows[k];

      if (contact->pairs[contact->rows.pair[i]].body[0] != b) continue;
      rows[of_body]   = i;
      keys[of_body++] = contact->rows.dof[i];
    }
    PetscCall(PetscSortIntWithArray(of_body, keys, rows));
    for (PetscInt begin = 0, end; begin < of_body; begin = end) {
      for (end = begin + 1; end < of_body && keys[end] == keys[begin];) end++;
      PetscCall(PetscSortInt(end - begin, rows + begin));
      if (contact->rows.pair[rows[begin]] == contact->rows.pair[rows[end - 1]]) continue;
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
  PetscCall(PetscFree4(contact->rows.by_force, shared->unit, shared->answers, shared->sorted));
  shared->n = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether row i has the same normal as row j, and row j is that of another obstacle, which is nearer */
static PetscBool IsBehind(Contact contact, PetscInt i, PetscInt j)
{
  const PetscReal *a = contact->rows.normal + 3 * i, *b = contact->rows.normal + 3 * j;
  const PetscReal  along = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  if (contact->rows.pair[i] == contact->rows.pair[j] || !contact->pairs[contact->rows.pair[j]].obstacle || !contact->rows.opposite[j])
    return PETSC_FALSE;
  if (along <= 0 || PetscSqr(along) < 1 - PARALLEL) return PETSC_FALSE;
  return (PetscBool)(contact->rows.initial_gap[j] < contact->rows.initial_gap[i] ||
                     (contact->rows.initial_gap[j] == contact->rows.initial_gap[i] && j < i));
}

/* Takes a row back that has been left out, unless its pair has been described since */
static PetscErrorCode Reconsider(Contact contact, PetscInt i)
{
  const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];
  const PetscInt     node = (i - pair->begin) / pair->components;
  TransferRows       rows;

  PetscFunctionBegin;
  if (contact->rows.opposite[i]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TransferGetRows(pair->transfer, &rows));
  contact->rows.opposite[i] = rows.opposite[node];
  contact->rows.area[i]     = rows.area[node];
  if (rows.opposite[node]) contact->rows.initial_gap[i] = rows.gap[node];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Leaves out the rows of obstacles that lie behind other obstacles. The rows of all pairs must have been described. */
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
      if (!contact->pairs[contact->rows.pair[i]].obstacle || !contact->rows.opposite[i]) continue;
      for (PetscInt l = begin; l < end && !shared->left_out[k]; l++) shared->left_out[k] = IsBehind(contact, i, shared->rows[l]);
    }
    for (PetscInt k = begin; k < end; k++) {
      const PetscInt i = shared->rows[k];

      if (!shared->left_out[k]) continue;
      contact->rows.opposite[i] = contact->rows.tied[i] = PETSC_FALSE;
      contact->rows.initial_gap[i]                      = CONTACT_NO_GAP;
      contact->rows.area[i]                             = 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stiffness that makes unknowns in metres of forces, for each unit of area [N/m^3]: an element of each body, one behind the other */
static PetscErrorCode GetUnit(Contact contact, const ContactPair *pair, PetscReal *unit)
{
  PetscReal flexibility = 0;

  PetscFunctionBegin;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    PetscReal stiffness;
    PetscBool rigid;

    PetscCall(BodyIsRigid(contact->bodies[pair->body[side]], &rigid));
    PetscCall(BodyGetElementStiffness(contact->bodies[pair->body[side]], &stiffness));
    if (!rigid) flexibility += 1 / stiffness;
  }
  *unit = 1 / flexibility;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets shared nodes up for a method that prescribes displacements; `arranges`: whether forces may be unknowns of the method. The bodies
   must have been set up. */
PetscErrorCode ContactSetUpSharedNodes(Contact contact, PetscBool arranges)
{
  SharedNodes *shared = &contact->shared;
  PetscInt     most   = 0;

  PetscFunctionBegin;
  for (PetscInt node = 0; node < shared->n; node++) most = PetscMax(most, shared->offsets[node + 1] - shared->offsets[node]);
  PetscCall(PetscCalloc4(contact->rows.n, &contact->rows.by_force, contact->n_pairs, &shared->unit, contact->n_pairs, &shared->answers,
                         most, &shared->sorted));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    PetscCall(GetUnit(contact, pair, &shared->unit[p]));
    if (!pair->obstacle) PetscCall(BodyFeelsEndForce(contact->bodies[pair->body[1]], &shared->answers[p]));
  }
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->rows.by_force[i] = contact->pairs[contact->rows.pair[i]].by_force;
  PetscCall(ContactCopyAreas(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetRowWeights(contact->bodies[b], contact->body_rows[b].area));
  shared->arranges = arranges;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Force along a row for a metre of its unknown [N/m] */
PetscReal ContactForceUnit(Contact contact, PetscInt i)
{
  return contact->shared.unit[contact->rows.pair[i]] * contact->rows.area[i] * contact->resultants.cross_section[contact->rows.pair[i]];
}

/* Puts the active rows of a node into `sorted`, in the order in which they are prescribed: first those whose partner does not move
   under forces, of these the ones that penetrate first; then the others. Returns their number. */
static PetscInt SortActive(Contact contact, PetscInt node, PetscInt sorted[])
{
  const SharedNodes *shared = &contact->shared;
  PetscInt           count  = 0;

  for (PetscInt round = 0; round < 3; round++)
    for (PetscInt k = shared->offsets[node]; k < shared->offsets[node + 1]; k++) {
      const PetscInt  i     = shared->rows[k];
      const PetscBool first = (PetscBool)(contact->end.gap[i] < -contact->options.tolerance);

      if (contact->end.active[i] && round == (shared->answers[contact->rows.pair[i]] ? 2 : first ? 0 : 1)) sorted[count++] = i;
    }
  return count;
}

/* Whether a direction is independent of a basis of n unit vectors: whether what remains of it without its components along them is longer
   than `least` of its length, squared. If so, it becomes one of the basis. */
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

/* Decides for each active row of shared nodes whether it is prescribed, has its force as an unknown, or is let go, as told at the top */
void ContactArrangeShared(Contact contact)
{
  SharedNodes *shared = &contact->shared;

  for (PetscInt node = 0; node < shared->n && shared->arranges; node++) {
    const PetscInt count = SortActive(contact, node, shared->sorted);
    PetscReal      basis[3][3];
    PetscInt       n = 0;

    for (PetscInt k = 0; k < count; k++) {
      const PetscInt  i       = shared->sorted[k];
      const PetscBool answers = shared->answers[contact->rows.pair[i]];
      PetscReal       direction[3];
      PetscBool       independent;

      if (contact->pairs[contact->rows.pair[i]].by_force) continue; /* not prescribed anyway */
      GetDirection(contact, node, i, direction);
      independent               = Extends(direction, answers ? NEAR : PARALLEL, &n, basis);
      contact->rows.by_force[i] = (PetscBool)(!independent && answers);
      contact->end.active[i]    = (PetscBool)(independent || answers);
    }
  }
}
