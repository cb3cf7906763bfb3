/*
   Friction in the first state, in which massless nodes are in balance: which nodes stick where the user, or the run whose state this one
   begins with, has put them, and which slide on the way to the balance. The forces along normals of all closed nodes and across them of
   those that stick come from one linear problem; those of nodes that slide are given to it, and follow from what it has found.
*/
#include "friction.h"

/* Forces that differ by less, in parts of the largest, are the same: conjugate gradients have left that much */
#define SAME_FORCE 1e-11

/* The force of node `first` across its normal: given where it slides, found where it sticks. Whether that is another state or force. */
static PetscBool JudgeNode(Contact contact, PetscInt first, PetscReal small, const PetscReal slip[], PetscBool sticks[], PetscReal given[])
{
  const PetscReal *force = contact->end.force;
  const PetscBool  stuck = sticks[first + 1];
  PetscReal        cohesion, coefficient, limit, size = 0, way = 0, along = 0, change = 0;

  (*contact->friction.law.getlimit)(contact, contact->friction.law.data, first, contact->friction.speed[first], &cohesion, &coefficient);
  limit = PetscMax(cohesion + coefficient * force[first], 0);
  for (PetscInt i = first + 1; i < first + contact->dim; i++) {
    size += PetscSqr(force[i]);
    way += PetscSqr(slip[i]);
    along += force[i] * slip[i];
  }
  size = PetscSqrtReal(size);
  way  = PetscSqrtReal(way);
  if (stuck && size <= limit + small) return PETSC_FALSE;
  for (PetscInt i = first + 1; i < first + contact->dim; i++) {
    const PetscReal before = given[i];

    sticks[i] = (PetscBool)(!stuck && along > 0); /* friction does not push a node the way that it slides */
    if (sticks[i]) given[i] = 0;
    else if (stuck || way == 0) given[i] = size > 0 ? limit * force[i] / size : 0;
    else given[i] = -limit * slip[i] / way;
    change = PetscMax(change, PetscAbsReal(given[i] - before));
  }
  contact->friction.slides[first] = (PetscBool)!sticks[first + 1];
  return (PetscBool)(stuck || sticks[first + 1] || change > small);
}

/*
  ContactJudgeRubbing - which nodes of the first state stick, and the forces across the normals of those that slide

  Collective

  Input Parameters:
+ contact - the `Contact`, with the forces and the active rows that have been found in `end`
- slip    - of rows across the normals, from where the bodies have been put [m]

  Input/Output Parameters:
+ sticks - rows across the normals whose forces are found with those along the normals
- given  - forces of the others [N]

  Output Parameter:
. changed - whether the forces are to be found again
*/
PetscErrorCode ContactJudgeRubbing(Contact contact, const PetscReal slip[], PetscBool sticks[], PetscReal given[], PetscBool *changed)
{
  PetscReal largest = 0;
  int       any     = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) largest = PetscMax(largest, PetscAbsReal(contact->end.force[i]));
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, &largest, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)contact)));
  for (PetscInt first = 0; first + 1 < contact->rows.n; first++) {
    if (!ContactRowRubs(contact, first + 1) || ContactRowRubs(contact, first)) continue; /* the first row of a node with friction */
    if (contact->end.active[first]) {
      any |= JudgeNode(contact, first, SAME_FORCE * largest, slip, sticks, given);
      continue;
    }
    contact->friction.slides[first] = PETSC_FALSE;
    for (PetscInt i = first + 1; i < first + contact->dim; i++) { /* where the node closes it sticks first */
      sticks[i] = PETSC_TRUE;
      given[i]  = 0;
    }
  }
  PetscCall(ContactOr(contact, &any));
  *changed = (PetscBool)(any > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactGetOpening - B u of a row as the bodies are now, without what their meshes are apart by [m] */
PetscErrorCode ContactGetOpening(Contact contact, PetscInt i, PetscReal *opening)
{
  const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];
  PetscScalar       *dirichlet, *neumann;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(contact->traces[pair->body[0]].displacement, 0, &dirichlet));
  PetscCall(TraceGetLevel(contact->traces[pair->body[1]].displacement, 0, &neumann));
  *opening = PetscRealPart(neumann[i - pair->shift[1]] - dirichlet[i - pair->shift[0]]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
