/* The rows of all pairs: from surfaces to transfers, and what these say of each row. */
#include <contact/parts.h>
#include <sys/units.h>
#include <impakt/private/bodymesh.h>
#include <petscsf.h>

/* Planes count as parallel whose normals have a cosine nearer to 1 */
#define PARALLEL 1e-8
/* -contact_tolerance by default, in parts of the largest coordinate of any mesh, whose round-off is 10^4 times smaller: what a converged
   outer iteration leaves of the gap must not count as penetration in the next free trial */
#define PENETRATION_TOLERANCE 3e-12

static PetscErrorCode AllocateRows(Contact contact)
{
  const PetscInt n = contact->rows.n;

  PetscFunctionBegin;
  PetscCall(ContactShareRows(contact));
  PetscCall(PetscCalloc7(n, &contact->rows.pair, n, &contact->rows.initial_gap, n, &contact->rows.area, n, &contact->rows.dof, 3 * n,
                         &contact->rows.normal, n, &contact->rows.opposite, n, &contact->rows.tied));
  PetscCall(PetscCalloc7(n, &contact->end.force, n, &contact->end.gap, n, &contact->start.force, n, &contact->start.gap, n,
                         &contact->end.active, n, &contact->start.active, n, &contact->work.conditions));
  PetscCall(PetscCalloc3(contact->rows.n_all, &contact->ranks.row_pair, n, &contact->ranks.mine_active, contact->rows.n_all,
                         &contact->ranks.all_active));
  PetscCall(PetscCalloc4(n, &contact->ties.holds, n, &contact->ties.distance, 2 * n, &contact->work.entry_counts, n, &contact->work.drift));
  PetscCall(PetscCalloc7(n, &contact->rows.changed, n, &contact->rows.gap_shift, n, &contact->work.last_gap, n, &contact->held.dropped, n,
                         &contact->held.heir, n, &contact->held.merged_gap, n, &contact->work.tilts));
  PetscCall(PetscCalloc6(n, &contact->work.last_force, 2 * n, &contact->work.handover, n, &contact->work.intervals, n,
                         &contact->rows.followed, n, &contact->work.flags, n, &contact->work.rest));
  PetscCall(PetscCalloc3(contact->n_pairs, &contact->work.updated, CONTACT_MOTION * contact->n_pairs, &contact->work.motion,
                         contact->n_pairs, &contact->work.off));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++) contact->rows.pair[i] = p;
  PetscCall(ContactGatherRows(contact, MPIU_INT, contact->rows.pair, contact->ranks.row_pair));
  PetscCall(ContactNumberBodyRows(contact));
  PetscCall(PetscMalloc2(n, &contact->rows.near, n, &contact->rows.acting));
  PetscCall(ContactListAllRows(contact));
  PetscCall(ContactOrderVisits(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for the rows of all pairs, whose transfers are known, and their numbers, pair by pair: a row is on the rank that owns its Dirichlet
   node */
PetscErrorCode ContactLayOutRows(Contact contact)
{
  PetscFunctionBegin;
  contact->rows.n = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];
    TransferRows rows;

    PetscCall(TransferGetRows(pair->transfer, &rows));
    pair->bonded     = (PetscBool)(pair->bonded || ContactPairTies(pair));
    pair->components = pair->law == CONTACT_LAW_FRICTIONLESS ? 1 : contact->dim;
    pair->begin      = contact->rows.n;
    contact->rows.n += rows.n * pair->components;
    pair->end = contact->rows.n;
  }
  PetscCall(AllocateRows(contact));
  PetscCall(ContactSetUpTurns(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Describes the rows of a pair as its transfer has them now; ContactMeasureTies() has found ties. */
PetscErrorCode ContactDescribeRows(Contact contact, const ContactPair *pair)
{
  TransferRows rows;
  Vec          positions;
  PetscInt     first;

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  PetscCall(BodyGetReferencePositions(contact->bodies[pair->body[0]], &positions));
  PetscCall(VecGetOwnershipRange(positions, &first, NULL));
  for (PetscInt node = 0; node < rows.n; node++)
    for (PetscInt k = 0; k < pair->components; k++) {
      const PetscInt i = pair->begin + node * pair->components + k;

      contact->rows.dof[i]         = rows.dofs[node] - first;
      contact->rows.opposite[i]    = rows.opposite[node];
      contact->rows.initial_gap[i] = rows.opposite[node] ? rows.gap[node] + (rows.changed[node] ? 0 : contact->rows.gap_shift[i])
                                                         : CONTACT_NO_GAP;
      contact->rows.area[i]        = rows.area[node];
      contact->rows.changed[i]     = rows.changed[node];
      contact->rows.followed[i]    = rows.followed[node];
      if (ContactPairTies(pair)) {
        contact->rows.tied[i]        = contact->ties.holds[i];
        contact->rows.initial_gap[i] = contact->rows.tied[i] ? 0 : CONTACT_NO_GAP;
      }
      ContactGetDirection(contact, pair, &rows, i, contact->rows.normal + 3 * i);
      if (pair->law == CONTACT_LAW_FRICTION && k > 0) contact->rows.initial_gap[i] = CONTACT_NO_GAP;
      if (pair->law == CONTACT_LAW_BONDED && k > 0) { /* until the node sticks */
        contact->rows.opposite[i]    = PETSC_FALSE;
        contact->rows.initial_gap[i] = CONTACT_NO_GAP;
      }
      contact->held.merged_gap[i] = 0;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if all rows of a pair that have a partner opposite are held, so that the pair would have no contact at all. Where
   bodies answer to forces held rows are conditions on the partner. */
static PetscErrorCode CheckHeld(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs && contact->prescribes; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const Body         body = contact->bodies[pair->body[0]];
    PetscBool          any = PETSC_FALSE, free = PETSC_FALSE; /* rows with a partner opposite, and those that are not held */
    TransferRows       rows;

    PetscCall(TransferGetRows(pair->transfer, &rows));
    for (PetscInt i = 0; i < rows.n; i++) any = (PetscBool)(any || rows.opposite[i]);
    for (PetscInt i = pair->begin; i < pair->end; i++) free = (PetscBool)(free || contact->rows.opposite[i]);
    PetscCall(ContactOr(contact, &any));
    PetscCall(ContactOr(contact, &free));
    PetscCheck(
        free || !any, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
        "-contact_pairs %s: the displacement of all nodes of body '%s' that may touch is prescribed across the surface, so that they "
        "cannot follow the other side; %s, or prescribe less in -%s_boundary_displacement",
        pair->name, ((PetscObject)body)->name, pair->turned ? "set -contact_rows first" : "name that body second",
        ((PetscObject)body)->name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if a body has two plane obstacles with one normal: rows would be there twice */
static PetscErrorCode CheckPlanes(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt q = 0; q < p; q++) {
      const ContactPair *pairs[2] = {&contact->pairs[q], &contact->pairs[p]};
      PetscReal          points[2][3], normals[2][3], along = 0;
      PetscBool          planes = (PetscBool)(pairs[0]->obstacle && pairs[1]->obstacle && pairs[0]->body[0] == pairs[1]->body[0]);

      for (PetscInt k = 0; k < 2 && planes; k++) {
        ObstacleType type;

        PetscCall(ObstacleGetShape(pairs[k]->obstacle, &type, points[k], normals[k]));
        planes = (PetscBool)(type == OBSTACLE_PLANE);
      }
      for (PetscInt d = 0; d < 3 && planes; d++) along += normals[0][d] * normals[1][d];
      PetscCheck(along < 1 - PARALLEL, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
                 "-contact_pairs %s,%s: two planes with one normal, of which the nearer one alone is ever touched; name the pairs in "
                 "-contact_pairs without the other one",
                 pairs[0]->name, pairs[1]->name);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets surfaces of all pairs in their bodies. `extent` becomes the largest coordinate of their meshes, without sign [m]. */
PetscErrorCode ContactTakeSurfaces(Contact contact, PetscReal *extent)
{
  PetscFunctionBegin;
  *extent = 0;
  PetscCall(CheckPlanes(contact));
  PetscCall(ContactChooseTiedMass(contact));
  if (contact->neighbours.come_and_go) PetscCall(ContactTakeFirstNeighbours(contact, extent));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(ContactCreateSurfaces(contact, &contact->pairs[p], extent));
    PetscCall(ContactMarkNodes(contact, &contact->pairs[p]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Transfers and rows of all pairs, whose surfaces are known and have coordinates up to `extent` [m] */
PetscErrorCode ContactSetUpRows(Contact contact, PetscReal extent)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(ContactChooseRowSide(contact, &contact->pairs[p]));
  PetscCall(ContactChooseBalance(contact));
  PetscCall(ContactOrderBodies(contact)); /* again, since pairs may have been turned round */
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(ContactCreateTransfer(contact, &contact->pairs[p]));
  PetscCall(ContactLayOutRows(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscBool changed;

    PetscCall(ContactMeasureTies(contact, &contact->pairs[p], &changed));
    PetscCall(ContactDescribeRows(contact, &contact->pairs[p]));
  }
  PetscCall(ContactMergeDroppedRows(contact));
  PetscCall(CheckHeld(contact));
  ContactForgetMatrices(contact);
  PetscCall(ContactFillMatrices(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodySetInterface(contact->bodies[b], contact->interfaces[b]));
    contact->body_rows[b].filled = PETSC_FALSE;
  }
  if (contact->options.tolerance == (PetscReal)PETSC_DEFAULT) contact->options.tolerance = PENETRATION_TOLERANCE * extent;
  PetscCheck(contact->options.tolerance >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_tolerance %g%s must not be negative", (double)contact->options.tolerance,
             UnitsOf((PetscObject)contact, UNIT_LENGTH));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An obstacle has traces as a body has that does not move: zeros, at as many times as the body with the most substeps */
PetscErrorCode ContactSetUpObstacleTraces(Contact contact)
{
  BodyTraces *traces = &contact->traces[contact->n_bodies];
  PetscInt    levels = 1;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt substeps;

    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    levels = PetscMax(levels, substeps);
  }
  for (PetscInt t = BODY_FIRST_FORCE; t < BODY_TRACES; t++) PetscCall(TraceCreate(contact->rows.n, levels, &traces->all[t]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyRows(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt t = 0; t < BODY_TRACES && contact->traces; t++) PetscCall(TraceDestroy(&contact->traces[contact->n_bodies].all[t]));
  PetscCall(ContactDestroyMerger(contact));
  PetscCall(PetscFree7(contact->rows.pair, contact->rows.initial_gap, contact->rows.area, contact->rows.dof, contact->rows.normal,
                       contact->rows.opposite, contact->rows.tied));
  PetscCall(PetscFree7(contact->end.force, contact->end.gap, contact->start.force, contact->start.gap, contact->end.active,
                       contact->start.active, contact->work.conditions));
  PetscCall(PetscFree3(contact->ranks.row_pair, contact->ranks.mine_active, contact->ranks.all_active));
  PetscCall(PetscLayoutDestroy(&contact->ranks.layout));
  PetscCall(PetscSFDestroy(&contact->ranks.gather));
  PetscCall(PetscFree7(contact->rows.changed, contact->rows.gap_shift, contact->work.last_gap, contact->held.dropped, contact->held.heir,
                       contact->held.merged_gap, contact->work.tilts));
  PetscCall(PetscFree6(contact->work.last_force, contact->work.handover, contact->work.intervals, contact->rows.followed,
                       contact->work.flags, contact->work.rest));
  PetscCall(PetscFree3(contact->work.updated, contact->work.motion, contact->work.off));
  PetscCall(ContactDestroyBodyRows(contact));
  PetscCall(PetscFree2(contact->rows.near, contact->rows.acting));
  PetscCall(PetscFree(contact->ranks.visits));
  PetscCall(PetscFree4(contact->ties.holds, contact->ties.distance, contact->work.entry_counts, contact->work.drift));
  PetscCall(PetscFree(contact->saved.state));
  PetscCall(ContactDestroyTurns(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
