/* Rows that are built again as bodies slide and turn, and what becomes of their gaps. */
#include <contact/parts.h>
#include <sys/stages.h>

/* Shifts of gaps may keep surfaces apart for good by this much [edges of the face]. Taking all of a shift back loses energy at each rebuild
   as polygons roll: ten discs lose 3.5 % of it with 0.05, and 1.0 % with 0.1, at a step at which impacts cost little. */
#define APART 0.1
/* What is beyond that is taken back in proportion to the slip: all of it within a slip of one over this [edges of the face] */
#define TAKEN_BACK 3

/* What remains of a shift, by which the gap of a row in contact goes on from where it was [m]. If surfaces slide far without losing
   contact, shifts add up: between two builds a row moves along the plane across its normal, from which a curved partner bends away, so that
   surfaces would be kept apart by more and more. What a shift is beyond APART is taken back in proportion to the slip [edges of the face],
   which loses energy. Shifts of the other sign, by which surfaces overlap, stay: to take them back would gain energy. */
static PetscReal RemainingShift(PetscReal shift, PetscReal size, PetscReal slip)
{
  return shift - PetscMin(shift + APART * size, 0) * PetscMin(1, TAKEN_BACK * slip);
}

/* Whether gaps of a pair are right wherever rows are built: on obstacles, without facets, and without inertia (static, rigid partner) */
PetscBool ContactPairStartsAnew(Contact contact, const ContactPair *pair)
{
  if (pair->obstacle || !pair->rests) return (PetscBool)(pair->obstacle != NULL);
  for (PetscInt side = 0; side < 2; side++) {
    const Body body = contact->bodies[pair->body[side]];

    if (!BodyDoes(body, BodyIsStatic) && !BodyDoes(body, BodyIsRigid)) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* A row that is built again compares the faceted surfaces at other points, and its gap jumps. To close this jump within one step would be a
   blow out of nothing. So its gap is shifted: that of a row in contact such that it goes on from where it was, that of any other row that
   would begin inside the partner such that it begins at zero, or as deep as it was. The shift stays until the row is open. Between bodies
   without inertia there are no blows, and gaps are not shifted. `before` are the gaps before the rebuild. */
static PetscErrorCode ShiftGaps(Contact contact, const PetscReal before[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const PetscBool    anew = ContactPairStartsAnew(contact, pair);
    TransferRows       rows;

    for (PetscInt i = pair->begin; i < pair->end && anew; i++)
      if (contact->rows.changed[i]) contact->rows.gap_shift[i] = 0;
    if (anew) continue;
    PetscCall(TransferGetRows(pair->transfer, &rows));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscBool pushes = (PetscBool)(contact->start.active[i] && (contact->start.force[i] > 0 || !contact->options.separation));
      const PetscInt  node   = (i - pair->begin) / pair->components;

      if (!contact->rows.changed[i]) continue;
      if (!contact->rows.opposite[i]) contact->rows.gap_shift[i] = 0;
      else
        contact->rows.gap_shift[i] = pushes ? RemainingShift(before[i] - contact->end.gap[i], rows.size[node], rows.slip[node])
                                            : PetscMax(PetscMin(before[i], 0) - contact->end.gap[i], 0);
      contact->rows.initial_gap[i] += contact->rows.gap_shift[i];
      contact->end.gap[i] += contact->rows.gap_shift[i];
      contact->start.gap[i] = contact->end.gap[i];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes shifts of gaps back as far as rows are open, where this does no work. In contact it would do work, out of nothing. */
static void DropShifts(Contact contact)
{
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt k = pair->near_begin; k < pair->near_end; k += ContactGapStride(pair)) {
      const PetscInt i = contact->rows.near[k];
      PetscReal      part;

      if (contact->rows.gap_shift[i] == 0 || contact->start.active[i]) continue;
      part = PetscMin(contact->rows.gap_shift[i], PetscMax(contact->end.gap[i], 0));
      contact->rows.gap_shift[i] -= part;
      contact->rows.initial_gap[i] -= part;
      contact->end.gap[i] -= part;
      contact->start.gap[i] -= part;
    }
  }
}

/* Which bodies begin the step with forces along other rows than they end it with: their rows have got new entries, or have been let go */
static PetscErrorCode FindHandingOver(Contact contact, const PetscReal before[])
{
  int *hands_over = contact->work.hands_over;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const ContactBodyRows *of = &contact->body_rows[b];

    hands_over[b] = of->affected || contact->attempt.again; /* what a failed attempt has handed over counts no more */
    for (PetscInt k = 0; k < of->n && !hands_over[b]; k++) hands_over[b] = before[of->rows[k]] != contact->start.force[of->rows[k]];
  }
  PetscCall(ContactReduce(contact, contact->n_bodies, MPI_INT, MPI_MAX, hands_over));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the bodies' forces at the start of the step along the old rows. `before`: these, without those of rows let go. */
static PetscErrorCode HandOver(Contact contact, const PetscReal before[])
{
  PetscReal *old = contact->work.handover, *now = contact->work.handover + contact->rows.n;
  PetscInt  *intervals = contact->work.intervals, fewest = PETSC_INT_MAX;

  PetscFunctionBegin;
  PetscCall(FindHandingOver(contact, before));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];

    pair->intervals = 1; /* the Dirichlet side's substeps, where it is prescribed */
    if (contact->prescribes) PetscCall(BodyGetSubsteps(contact->bodies[pair->body[pair->dirichlet]], &pair->intervals));
    fewest = PetscMin(fewest, pair->intervals);
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const ContactBodyRows *of = &contact->body_rows[b];

    if (!contact->work.hands_over[b]) continue;
    for (PetscInt k = 0; k < of->n; k++) {
      const PetscInt i = of->rows[k];

      old[k]       = before[i];
      now[k]       = contact->start.force[i];
      intervals[k] = contact->pairs[contact->rows.pair[i]].intervals;
    }
    PetscCall(BodyHandOver(contact->bodies[b], old, now, intervals, fewest));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the start of a controller step: builds the rows again of those pairs whose surfaces have slid or turned far enough, and lets those
   near contact follow. Rows in contact that have no partner opposite any more are let go. */
PetscErrorCode ContactUpdateRows(Contact contact)
{
  PetscReal reach = 0;
  PetscBool any = PETSC_FALSE, built = PETSC_FALSE, logged;

  PetscFunctionBegin;
  if (contact->dim == 1 || ContactAllPairsTie(contact) || (!contact->n_pairs && !contact->neighbours.come_and_go))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactMeasureReach(contact, &reach));
  if (reach > contact->rows.near_reach) PetscCall(ContactListAllRows(contact));
  PetscCall(ContactRenewNeighbours(contact, reach, PETSC_FALSE, &any));
  if (contact->attempt.again) PetscCall(ContactRestoreRows(contact));
  else PetscCall(ContactSaveRows(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactBodyRows *of = &contact->body_rows[b];

    of->affected = (PetscBool)(contact->attempt.again && of->rewritten);
    any          = (PetscBool)(any || of->affected);
  }
  DropShifts(contact);
  PetscCall(PetscArrayzero(contact->rows.changed, contact->rows.n));
  PetscCall(PetscArrayzero(contact->rows.followed, contact->rows.n));
  PetscCall(StageBegin(STAGE_SEARCH, &logged));
  PetscCall(ContactMoveSurfaces(contact));
  PetscCall(StageEnd(logged));
  PetscCall(ContactUpdatePairs(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) any = (PetscBool)(any || contact->work.updated[p] != ROWS_STAY);
  if (!any) {
    PetscCall(ContactListNearRows(contact, reach));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ContactListAllRows(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair    = &contact->pairs[p];
    const PetscBool    rebuilt = (PetscBool)(contact->work.updated[p] == ROWS_REBUILT);

    if (contact->work.updated[p] == ROWS_STAY) continue;
    built = (PetscBool)(built || rebuilt);
    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
      ContactBodyRows *of = &contact->body_rows[pair->body[side]];

      of->affected = of->rewritten = PETSC_TRUE;
      if (rebuilt) of->pattern++; /* entries in other places */
    }
    PetscCall(ContactDescribeRows(contact, pair));
  }
  if (built) contact->counts.rebuilds++;
  contact->energy.rebuilt = PETSC_TRUE;
  PetscCall(ContactMergeDroppedRows(contact));
  if (contact->held.merger) ContactAffectAll(contact); /* heirs change with rows that are not their own */
  PetscCall(ContactFillMatrices(contact));
  PetscCall(ContactUpdateBodies(contact, PETSC_FALSE));
  PetscCall(PetscArraycpy(contact->work.last_gap, contact->start.gap, contact->rows.n));
  PetscCall(ContactReadStartGaps(contact, PETSC_TRUE));
  ContactAlignRubbingRows(contact);
  PetscCall(PetscArraycpy(contact->work.last_force, contact->start.force, contact->rows.n));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (contact->rows.opposite[i]) continue;
    contact->start.active[i] = PETSC_FALSE;
    contact->start.force[i]  = 0;
  }
  ContactCarryFriction(contact);
  PetscCall(HandOver(contact, contact->work.last_force));
  PetscCall(ShiftGaps(contact, contact->work.last_gap));
  PetscTryTypeMethod(contact, rowschanged);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Builds the rows again where the displacements at the start have other nodes tied, or tied to other ones, than the meshes alone */
static PetscErrorCode RebuildTies(Contact contact)
{
  PetscBool any = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(ContactMoveSurfaces(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    Vec                u[2] = {NULL, NULL};
    PetscBool          rebuilt, changed = PETSC_FALSE;

    if (!ContactPairTies(pair)) continue;
    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++)
      PetscCall(BodyGetSolution(contact->bodies[pair->body[side]], &u[side], NULL, NULL));
    PetscCall(TransferUpdate(pair->transfer, u[0], u[1], contact->dim == 1 || pair->obstacle ? PETSC_MAX_REAL : 0, &rebuilt));
    PetscCall(ContactMeasureTies(contact, pair, &changed));
    if (rebuilt || changed) any = PETSC_TRUE;
  }
  PetscCall(ContactOr(contact, &any));
  PetscCall(ContactCheckTies(contact));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (ContactPairTies(&contact->pairs[p])) PetscCall(ContactDescribeRows(contact, &contact->pairs[p]));
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->rows.changed[i] = PETSC_TRUE;
  PetscCall(ContactMergeDroppedRows(contact));
  ContactAffectAll(contact);
  PetscCall(ContactFillMatrices(contact));
  PetscCall(ContactUpdateBodies(contact, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ties what lies on each other in the present states; an error where that is not clear or nothing is tied. After bodies are set up. */
PetscErrorCode ContactTie(Contact contact)
{
  PetscBool any = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) any = (PetscBool)(any || ContactPairTies(&contact->pairs[p]));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(RebuildTies(contact));
  PetscCall(ContactReadStartGaps(contact, PETSC_TRUE));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (!contact->rows.tied[i]) continue;
    contact->rows.initial_gap[i] -= contact->start.gap[i];
    contact->start.gap[i] = contact->end.gap[i] = 0;
  }
  PetscTryTypeMethod(contact, rowschanged);
  PetscFunctionReturn(PETSC_SUCCESS);
}
