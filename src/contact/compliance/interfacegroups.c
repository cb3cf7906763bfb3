/*
   Groups of rows between which S is zero: those of bodies that touch each other, directly or by others, when forces on these move them.
   Among many bodies there are many small groups, whose blocks of S are factored one by one: that costs in proportion to the number of
   bodies.
*/
#include "interfaceimpl.h"

/* The bodies of a pair that answer to forces on its rows; returns how many */
static PetscInt GetBodies(InterfaceOperator op, const ContactPair *pair, PetscInt bodies[2])
{
  PetscInt n = 0;

  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++)
    if (op->feels[pair->body[side]]) bodies[n++] = pair->body[side];
  return n;
}

/* The listed rows of each body; the first one has all where S is given as a matrix */
static void ListByBody(InterfaceOperator op)
{
  const Contact contact = op->contact;
  PetscInt     *next    = op->body_begin + 1; /* where the next row of body b comes; in the end that of body b + 1 begins there */

  for (PetscInt b = 0; b <= contact->n_bodies; b++) op->body_begin[b] = op->matrix && b ? op->n : 0;
  for (PetscInt place = 0; place < op->n && op->matrix; place++) op->of_body[place] = place;
  if (op->matrix) return;
  for (PetscInt pass = 0; pass < 2; pass++) {
    for (PetscInt place = 0; place < op->n; place++) {
      const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[op->rows[place]]];

      for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++)
        if (pass) op->of_body[next[pair->body[side]]++] = place;
        else next[pair->body[side]]++;
    }
    if (pass) break;
    for (PetscInt b = 0, sum = 0; b < contact->n_bodies; b++) {
      const PetscInt count = next[b];

      next[b] = sum;
      sum += count;
    }
  }
}

/* Finds the groups of the rows that are listed to be solved for, in the order of their first rows, and the bodies of all that are listed;
   all rows are one group where S is given as a matrix. The same on all ranks. */
PetscErrorCode InterfaceOperatorFindGroups(InterfaceOperator op)
{
  const Contact contact = op->contact;
  PetscInt     *root    = op->body_group, bodies[2];

  PetscFunctionBegin;
  ListByBody(op);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    root[b]         = b;
    op->has_rows[b] = PETSC_FALSE;
  }
  for (PetscInt i = 0; i < op->n; i++) {
    const PetscInt n = GetBodies(op, &contact->pairs[contact->ranks.row_pair[op->rows[i]]], bodies);

    for (PetscInt k = 0; k < n; k++) op->has_rows[bodies[k]] = PETSC_TRUE;
  }
  for (PetscInt i = 0; i < op->n && !op->matrix; i++)
    if (GetBodies(op, &contact->pairs[contact->ranks.row_pair[op->rows[i]]], bodies) == 2) ContactJoinGroups(root, bodies[0], bodies[1]);
  for (PetscInt b = 0; b < contact->n_bodies; b++) root[b] = ContactGroupOf(root, b);
  op->n_groups = 0;
  if (op->matrix) {
    for (PetscInt b = 0; b < contact->n_bodies; b++) op->has_rows[b] = (PetscBool)(b == 0);
    for (PetscInt i = 0; i < op->n; i++) op->group[i] = 0;
    if (op->n) op->group_rows[op->n_groups++] = op->n;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /* from here on the group of a root is below 0: -1 less its number */
  for (PetscInt i = 0; i < op->n; i++) {
    const PetscInt n = GetBodies(op, &contact->pairs[contact->ranks.row_pair[op->rows[i]]], bodies);
    PetscInt       at;

    /* a row that moves nothing is a group by itself, and has no pivot */
    if (!n) {
      op->group_rows[op->n_groups] = 1;
      op->group[i]                 = op->n_groups++;
      continue;
    }
    at = root[bodies[0]] < 0 ? bodies[0] : root[bodies[0]];
    if (root[at] >= 0) {
      op->group_rows[op->n_groups] = 0;
      root[at]                     = -1 - op->n_groups++;
    }
    op->group[i] = -1 - root[at];
    op->group_rows[op->group[i]]++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
