/* Bodies that stick to each other once they have met. Each node has a row along its normal, which opens and closes like that of
   frictionless contact, and rows across it, which mean nothing at first. At the start of the controller step after the one in which the
   normal row closed with a compressive force, all rows of the node become ties, with the positions that they have there: nothing jumps, so
   that no energy is lost by it. A pair with such a node does not slide any more, and its rows are not built again. */
#include <contact/parts.h>

/* The direction of row k of a node: its normal, then unit vectors across it */
static void GetFrame(PetscInt dim, const PetscReal normal[], PetscInt k, PetscReal direction[3])
{
  PetscReal first[3] = {0}, length = 0;
  PetscInt  least = 0;

  for (PetscInt d = 0; d < 3; d++) direction[d] = d < dim && k == 0 ? normal[d] : 0;
  if (k == 0) return;
  if (dim == 2) {
    direction[0] = -normal[1];
    direction[1] = normal[0];
    return;
  }
  /* the axis that is farthest from the normal, less its part along the normal; on a flat surface the same for all nodes */
  for (PetscInt d = 1; d < 3; d++)
    if (PetscAbsReal(normal[d]) < PetscAbsReal(normal[least]) - PETSC_SQRT_MACHINE_EPSILON) least = d;
  for (PetscInt d = 0; d < 3; d++) {
    first[d] = (d == least ? 1 : 0) - normal[least] * normal[d];
    length += PetscSqr(first[d]);
  }
  for (PetscInt d = 0; d < 3; d++) first[d] /= PetscSqrtReal(length);
  for (PetscInt d = 0; d < 3; d++) {
    const PetscInt e = (d + 1) % 3, f = (d + 2) % 3;

    direction[d] = k == 1 ? first[d] : normal[e] * first[f] - normal[f] * first[e];
  }
}

/* The direction of row i of a pair, as its transfer has it: of ties an axis */
void ContactGetDirection(Contact contact, const ContactPair *pair, const TransferRows *rows, PetscInt i, PetscReal direction[3])
{
  const PetscInt node = (i - pair->begin) / pair->components, k = (i - pair->begin) % pair->components;

  for (PetscInt d = 0; d < 3; d++) direction[d] = d == k ? 1 : 0;
  if (!ContactPairTies(pair)) GetFrame(contact->dim, rows->normals + contact->dim * node, k, direction);
}

/* At the start of a controller step: nodes that were pushed together at the end of the last one stick from now on. All of their rows become
   ties as they are there. */
PetscErrorCode ContactBond(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];
    PetscScalar *start[2];

    if (pair->law != CONTACT_LAW_BONDED) continue;
    PetscCall(ContactGetPairTraces(contact, pair, 0, PETSC_FALSE, start));
    for (PetscInt first = pair->begin; first < pair->end; first += pair->components) {
      if (contact->rows.tied[first] || !contact->start.active[first] || contact->start.force[first] <= 0) continue;
      for (PetscInt i = first; i < first + pair->components; i++) {
        contact->rows.tied[i] = contact->rows.opposite[i] = PETSC_TRUE;
        contact->rows.initial_gap[i]                      = -ContactRowSum(pair, start, i);
        contact->start.gap[i] = contact->end.gap[i] = 0;
        contact->start.active[i]                    = PETSC_TRUE;
        if (i > first) contact->start.force[i] = 0;
      }
      pair->bonded = PETSC_TRUE;
    }
    PetscCall(ContactOr(contact, &pair->bonded));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the start of a controller step, with its rows: those that were in contact at the end of the last one are held from now on, pushed or
   pulled, along their normal alone. A row that has no partner opposite any more has been let go. */
void ContactHoldTogether(Contact contact)
{
  for (PetscInt i = 0; i < contact->rows.n && !contact->options.separation; i++)
    if (contact->pairs[contact->rows.pair[i]].law == CONTACT_LAW_FRICTIONLESS) contact->rows.tied[i] = contact->start.active[i];
}
