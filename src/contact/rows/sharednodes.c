/*
   Shared nodes have rows of several pairs, whose normals may depend on each other: nodes of a block that stands astride two others, or on
   two plane obstacles side by side. Rows that depend on each other are prescribed by least squares, weighted by the areas that the partners
   cover: see BodySetRowWeights(). Of several obstacles with the same normal at a node only the nearest counts.
*/
#include <contact/parts.h>
#include <impakt/private/bodysweeps.h>

/* Squared sine of the angle between two normals of obstacles below which they count as the same: 0.006 degrees */
#define PARALLEL 1e-8

/* Finds the shared nodes of this rank, which are the same for the whole run. All rows of a node are on the rank that owns it. */
PetscErrorCode ContactFindSharedNodes(Contact contact)
{
  SharedNodes   *shared = &contact->shared;
  const PetscInt n      = contact->rows.n;
  PetscInt      *rows, *keys, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &rows, n, &keys));
  PetscCall(PetscCalloc3(n + 1, &shared->offsets, n, &shared->rows, n, &shared->left_out));
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
    }
  }
  PetscCall(PetscFree2(rows, keys));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroySharedNodes(Contact contact)
{
  SharedNodes *shared = &contact->shared;

  PetscFunctionBegin;
  PetscCall(PetscFree3(shared->offsets, shared->rows, shared->left_out));
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

/* Lets methods that prescribe displacements weigh the rows of shared nodes by the areas of their partners. The bodies must have been set
 * up.
 */
PetscErrorCode ContactWeighSharedRows(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactCopyAreas(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetRowWeights(contact->bodies[b], contact->body_rows[b].area));
  PetscFunctionReturn(PETSC_SUCCESS);
}
