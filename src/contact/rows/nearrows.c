/* Rows near contact: those that may touch before rows are built again, which they are once surfaces have moved by a quarter of the smallest
   face. A step of a method that asks for them looks at no others, and costs what touches. Others are open and have no force; their gaps and
   the bodies' output traces are old until somebody asks.

   Of near rows those act in a step whose node touches, or had a force in it or in the last one. On all others forces and their effects have
   been zero since the step after their last force. */
#include <contact/parts.h>

/* Gap of a row up to which it is near [edges of the face]: rows within two edges count as near contact in builds, and surfaces may have
   moved by a quarter of an edge since the last one, and by another one until the next. Beside an obstacle, whose builds do not look at
   rows that cannot touch: half an edge, and the way of a step, which is at most an edge. */
#define NEAR_CONTACT  3
#define NEAR_OBSTACLE 1.5

/* In a step, once it is known which rows touch (NULL: all near ones act): lists those that act, of all and of the bodies. After a failed
   attempt, with forces on others, all near rows do. */
void ContactListActingRows(Contact contact, const PetscBool touches[])
{
  ContactRows *rows = &contact->rows;

  if (!rows->listed && touches) return; /* all do */
  rows->n_acting = 0;
  for (PetscInt b = 0; b < contact->n_bodies; b++) contact->body_rows[b].n_acting = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];

    pair->acts_begin = rows->n_acting;
    for (PetscInt k = pair->near_begin; k < pair->near_end; k += pair->components) {
      const PetscInt first = rows->near[k];
      PetscBool      acts  = (PetscBool)(!touches || touches[first] || contact->attempt.again);

      for (PetscInt i = first; i < first + pair->components && !acts; i++)
        acts = (PetscBool)(contact->start.force[i] != 0 || contact->energy.last_force[i] != 0);
      for (PetscInt i = first; i < first + pair->components && acts; i++) rows->acting[rows->n_acting++] = i;
    }
    pair->acts_end = rows->n_acting;
    for (PetscInt side = 0; side < ContactPairBodies(pair); side++) {
      ContactBodyRows *of = &contact->body_rows[pair->body[side]];

      for (PetscInt k = pair->acts_begin; k < pair->acts_end; k++) of->acting[of->n_acting++] = rows->acting[k] - pair->shift[side];
    }
  }
}

/* The near rows of the bodies, from the list of all; all of them act until it is known which touch */
static PetscErrorCode ListBodyRows(Contact contact)
{
  PetscFunctionBegin;
  ContactListActingRows(contact, NULL);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactBodyRows *of = &contact->body_rows[b];

    of->n_near = of->n_acting;
    PetscCall(PetscArraycpy(of->near, of->acting, of->n_near));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaps at the start of the controller step, from the bodies' traces; those of near rows if these are wanted */
PetscErrorCode ContactReadStartGaps(Contact contact, PetscBool near)
{
  PetscInt k = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscScalar       *u[2];

    PetscCall(ContactGetPairTraces(contact, pair, 0, PETSC_FALSE, u));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscBool is_near = (PetscBool)(k < contact->rows.n_near && contact->rows.near[k] == i);

      k += is_near;
      if (is_near && !near) continue; /* as the step has left it */
      contact->end.gap[i] = contact->start.gap[i] = contact->rows.initial_gap[i] + ContactRowSum(pair, u, i);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaps of all rows as they are where the saved states of the bodies are */
PetscErrorCode ContactRefreshGaps(Contact contact)
{
  PetscFunctionBegin;
  if (!contact->rows.listed) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (contact->body_rows[b].n_all) PetscCall(BodyWriteStartTraces(contact->bodies[b]));
  PetscCall(ContactReadStartGaps(contact, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells bodies and transfers which rows are near, and the surfaces which nodes these are about */
static PetscErrorCode Tell(Contact contact)
{
  PetscBool **nodes, *near;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const ContactBodyRows *of = &contact->body_rows[b];

    if (of->n_all) PetscCall(BodySetNearRows(contact->bodies[b], contact->rows.listed ? of->n_near : -1, of->near));
  }
  PetscCall(PetscMalloc1(contact->n_surfaces, &nodes));
  PetscCall(PetscMalloc1(contact->rows.n + 1, &near));
  for (PetscInt s = 0; s < contact->n_surfaces; s++) {
    const SurfaceData *data;

    PetscCall(SurfaceGetData(contact->surfaces[s].surface, &data));
    PetscCall(PetscCalloc1(data->n_owned + 1, &nodes[s])); /* never NULL */
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const PetscInt     n    = (pair->end - pair->begin) / pair->components;

    PetscCall(PetscArrayzero(near, n));
    for (PetscInt k = pair->near_begin; k < pair->near_end; k += pair->components)
      near[(contact->rows.near[k] - pair->begin) / pair->components] = PETSC_TRUE;
    PetscCall(TransferSetNear(pair->transfer, contact->rows.listed ? near : NULL, nodes[pair->place[0]],
                              pair->obstacle ? NULL : nodes[pair->place[1]]));
  }
  for (PetscInt s = 0; s < contact->n_surfaces; s++) {
    PetscCall(SurfaceSetNear(contact->surfaces[s].surface, contact->rows.listed ? nodes[s] : NULL));
    PetscCall(PetscFree(nodes[s]));
  }
  PetscCall(PetscFree(near));
  PetscCall(PetscFree(nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactListAllRows(Contact contact)
{
  const PetscBool before = contact->rows.listed;

  PetscFunctionBegin;
  if (!contact->body_rows) PetscFunctionReturn(PETSC_SUCCESS); /* no rows have been laid out yet */
  PetscCall(ContactRefreshGaps(contact));
  if (before && !contact->saved.known) PetscCall(ContactSaveRowState(contact));
  contact->rows.listed     = PETSC_FALSE;
  contact->rows.near_reach = PETSC_MAX_REAL;
  contact->rows.n_near     = contact->rows.n;
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->rows.near[i] = i;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    contact->pairs[p].near_begin = contact->pairs[p].begin;
    contact->pairs[p].near_end   = contact->pairs[p].end;
  }
  PetscCall(ListBodyRows(contact));
  if (before) PetscCall(Tell(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The near rows of a pair, and the smallest face at any of its nodes */
static PetscErrorCode ListPair(Contact contact, ContactPair *pair, PetscReal *smallest)
{
  const PetscReal most = pair->obstacle ? NEAR_OBSTACLE : NEAR_CONTACT;
  ContactRows    *of   = &contact->rows;
  TransferRows    rows;

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  pair->near_begin = of->n_near;
  for (PetscInt node = 0; node < rows.n; node++) {
    const PetscInt first = pair->begin + node * pair->components;
    PetscBool      near  = (PetscBool)(pair->bonded || (of->opposite[first] && contact->start.gap[first] <= most * rows.size[node]));

    *smallest = PetscMin(*smallest, rows.size[node]);
    for (PetscInt i = first; i < first + pair->components; i++)
      near = (PetscBool)(near || of->tied[i] || contact->start.active[i] || contact->start.force[i] != 0 || of->gap_shift[i] != 0 ||
                         contact->energy.last_force[i] != 0);
    for (PetscInt i = first; near && i < first + pair->components; i++) of->near[of->n_near++] = i;
  }
  pair->near_end = of->n_near;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists near rows at the start of a step in which rows stay, if the method wants that. `reach`: how far surfaces may be that touch [m] */
PetscErrorCode ContactListNearRows(Contact contact, PetscReal reach)
{
  PetscReal smallest = PETSC_MAX_REAL;

  PetscFunctionBegin;
  if (!contact->rows.lists || contact->rows.listed || contact->held.merger || contact->turns.n || !contact->energy.unlimited)
    PetscFunctionReturn(PETSC_SUCCESS);
  contact->rows.n_near = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(ListPair(contact, &contact->pairs[p], &smallest));
  PetscCall(ContactReduce(contact, 1, MPIU_REAL, MPIU_MIN, &smallest));
  if (reach > smallest) {
    PetscCall(ContactListAllRows(contact));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  contact->rows.near_reach = smallest;
  contact->rows.listed     = PETSC_TRUE;
  PetscCall(ListBodyRows(contact));
  PetscCall(Tell(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
