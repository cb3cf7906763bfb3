/* The rows of all pairs: from surfaces and transfers to matrices. */
#include <contact/parts.h>

/* A component of a unit normal that is smaller is round-off: the row does not ask for that displacement */
#define NO_COMPONENT 1e-9
/* -contact_tolerance by default, in parts of the largest coordinate of any mesh, whose round-off is 10^4 times smaller: what a converged
   outer iteration leaves of the gap must not count as penetration in the next free trial */
#define PENETRATION_TOLERANCE 3e-12

/* Numbers the rows of this rank, pair by pair: a row is on the rank that owns its Dirichlet node */
static PetscErrorCode CountRows(Contact contact)
{
  PetscFunctionBegin;
  contact->rows.n = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];
    TransferRows rows;

    PetscCall(TransferGetRows(pair->transfer, &rows));
    pair->components = contact->options.law == CONTACT_LAW_FRICTIONLESS ? 1 : contact->dim;
    pair->begin      = contact->rows.n;
    contact->rows.n += rows.n * pair->components;
    pair->end = contact->rows.n;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AllocateRows(Contact contact)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)contact);
  PetscMPIInt mine, total = 0;
  PetscInt    n = contact->rows.n;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Scan(&n, &contact->rows.begin, 1, MPIU_INT, MPI_SUM, comm));
  contact->rows.begin -= n;
  PetscCallMPI(MPI_Allreduce(&n, &contact->rows.n_all, 1, MPIU_INT, MPI_SUM, comm));
  PetscCall(PetscCalloc7(n, &contact->rows.pair, n, &contact->rows.initial_gap, n, &contact->rows.area, n, &contact->rows.dof, 3 * n,
                         &contact->rows.normal, n, &contact->rows.opposite, n, &contact->rows.tied));
  PetscCall(PetscCalloc7(n, &contact->end.force, n, &contact->end.gap, n, &contact->start.force, n, &contact->start.gap, n,
                         &contact->end.active, n, &contact->start.active, n, &contact->work.conditions));
  PetscCall(PetscCalloc5(contact->rows.n_all, &contact->ranks.row_pair, n, &contact->ranks.mine_active, contact->rows.n_all,
                         &contact->ranks.all_active, contact->ranks.size, &contact->ranks.counts, contact->ranks.size,
                         &contact->ranks.offsets));
  PetscCall(PetscCalloc3(n, &contact->ties.holds, n, &contact->ties.distance, 2 * n, &contact->work.entry_counts));
  PetscCall(PetscCalloc7(n, &contact->rows.changed, n, &contact->rows.gap_shift, n, &contact->work.last_gap, n, &contact->held.dropped, n,
                         &contact->held.heir, n, &contact->held.merged_gap, n, &contact->work.tilts));
  PetscCall(PetscCalloc7(n, &contact->work.last_force, 2 * n, &contact->work.handover, n, &contact->work.intervals, n,
                         &contact->rows.followed, n, &contact->work.moved, n, &contact->work.flags, n, &contact->work.rest));
  PetscCall(PetscCalloc2(contact->n_pairs, &contact->work.updated, (2 * TRANSFER_SUMS + TRANSFER_LARGEST) * contact->n_pairs,
                         &contact->work.motion));
  PetscCall(ContactSetUpSavedRows(contact));
  PetscCall(PetscMPIIntCast(n, &mine));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, contact->ranks.counts, 1, MPI_INT, comm));
  for (PetscMPIInt r = 0; r < contact->ranks.size; total += contact->ranks.counts[r++]) contact->ranks.offsets[r] = total;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++) contact->rows.pair[i] = p;
  PetscCallMPI(MPI_Allgatherv(contact->rows.pair, mine, MPIU_INT, contact->ranks.row_pair, contact->ranks.counts, contact->ranks.offsets,
                              MPIU_INT, comm));
  PetscCall(ContactNumberBodyRows(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for the rows of all pairs, whose transfers are known, and their numbers */
PetscErrorCode ContactLayOutRows(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(CountRows(contact));
  PetscCall(AllocateRows(contact));
  PetscCall(ContactSetUpTurns(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether row i is held: the method would prescribe displacements of its Dirichlet node, and the user prescribes all of these already */
static PetscErrorCode IsHeld(Contact contact, const ContactPair *pair, PetscInt i, PetscBool *held)
{
  const PetscInt *dofs;
  PetscInt        n;

  PetscFunctionBegin;
  *held = contact->prescribes;
  PetscCall(BodyGetHeldDofs(contact->bodies[pair->body[0]], &n, &dofs));
  for (PetscInt d = 0; d < contact->dim && *held; d++) {
    PetscInt place;

    if (PetscAbsReal(contact->rows.normal[3 * i + d]) < NO_COMPONENT) continue;
    PetscCall(PetscFindInt(contact->rows.dof[i] + d, n, dofs, &place));
    if (place < 0) *held = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Describes the rows of a pair as its transfer has them now; which nodes are tied ContactMeasureTies() has found. A held row neither opens
   nor closes. */
PetscErrorCode ContactDescribeRows(Contact contact, const ContactPair *pair)
{
  const PetscInt dim = contact->dim;
  TransferRows   rows;
  Vec            positions;
  PetscInt       first;

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  PetscCall(BodyGetReferencePositions(contact->bodies[pair->body[0]], &positions));
  PetscCall(VecGetOwnershipRange(positions, &first, NULL));
  for (PetscInt node = 0; node < rows.n; node++)
    for (PetscInt k = 0; k < pair->components; k++) {
      const PetscInt i = pair->begin + node * pair->components + k;
      PetscBool      held;

      contact->rows.dof[i]         = rows.dofs[node] - first;
      contact->rows.opposite[i]    = rows.opposite[node];
      contact->rows.initial_gap[i] = rows.opposite[node] ? rows.gap[node] + (rows.changed[node] ? 0 : contact->rows.gap_shift[i])
                                                         : CONTACT_NO_GAP;
      contact->rows.area[i]        = rows.area[node];
      contact->rows.changed[i]     = rows.changed[node];
      contact->rows.followed[i]    = rows.followed[node];
      if (contact->options.law == CONTACT_LAW_TIED) {
        contact->rows.tied[i]           = contact->ties.holds[i];
        contact->rows.initial_gap[i]    = contact->rows.tied[i] ? 0 : CONTACT_NO_GAP;
        contact->rows.normal[3 * i + k] = 1;
      } else ContactGetFrame(dim, rows.normals + dim * node, k, contact->rows.normal + 3 * i);
      if (contact->options.law == CONTACT_LAW_FRICTION && k > 0) contact->rows.initial_gap[i] = CONTACT_NO_GAP;
      if (contact->options.law == CONTACT_LAW_BONDED && k > 0) { /* until the node sticks */
        contact->rows.opposite[i]    = PETSC_FALSE;
        contact->rows.initial_gap[i] = CONTACT_NO_GAP;
      }
      PetscCall(IsHeld(contact, pair, i, &held));
      contact->held.dropped[i]    = (PetscBool)(held &&
                                                (contact->options.law == CONTACT_LAW_TIED ? contact->rows.tied[i] : rows.opposite[node]) &&
                                                !pair->obstacle && dim > 1 && contact->options.law != CONTACT_LAW_BONDED);
      contact->held.merged_gap[i] = 0;
      if (!held) continue;
      contact->rows.opposite[i] = contact->rows.tied[i] = PETSC_FALSE;
      contact->rows.initial_gap[i]                      = CONTACT_NO_GAP;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if all rows of a pair that have a partner opposite are held: then the pair would have no contact at all */
static PetscErrorCode CheckHeld(Contact contact, const ContactPair *pair)
{
  TransferRows rows;
  int          any[2] = {0, 0};

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  for (PetscInt i = 0; i < rows.n; i++) any[0] |= rows.opposite[i];
  for (PetscInt i = pair->begin; i < pair->end; i++) any[1] |= contact->rows.opposite[i];
  PetscCall(ContactOr(contact, &any[0]));
  PetscCall(ContactOr(contact, &any[1]));
  PetscCheck(!any[0] || any[1], PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: the displacement of all nodes of body '%s' that may touch is prescribed across the surface, so that they "
             "cannot follow the other side; %s, or prescribe less in -%s_boundary_displacement",
             pair->name, ((PetscObject)contact->bodies[pair->body[0]])->name,
             pair->turned ? "set -contact_rows first" : "name that body second", ((PetscObject)contact->bodies[pair->body[0]])->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for the entries of the rows of a body, of which each has as many as its transfer tells: PETSc else collects them in a hash table.
   Ties have other rows, and on several ranks nobody knows which columns are those of other ranks. */
static PetscErrorCode Preallocate(Contact contact, PetscInt b, Mat matrix)
{
  PetscInt *entries = contact->work.intervals, *counts[2] = {contact->work.entry_counts, contact->work.entry_counts + contact->rows.n};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < contact->body_rows[b].n_pairs; k++) {
    const ContactPair *pair = &contact->pairs[contact->body_rows[b].pairs[k]];
    const PetscInt     side = pair->body[0] == b ? 0 : 1;

    PetscCall(TransferCountValues(pair->transfer, counts[0], pair->obstacle ? NULL : counts[1]));
    for (PetscInt i = pair->begin; i < pair->end; i++) entries[i - pair->shift[side]] = counts[side][(i - pair->begin) / pair->components];
  }
  PetscCall(MatSeqAIJSetPreallocation(matrix, 0, entries));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateMatrix(Contact contact, PetscInt b)
{
  const ContactLaw law = contact->options.law;
  Vec              positions;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(BodyGetReferencePositions(contact->bodies[b], &positions));
  PetscCall(VecGetLocalSize(positions, &n));
  PetscCall(MatDestroy(&contact->interfaces[b]));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)contact), &contact->interfaces[b]));
  PetscCall(MatSetSizes(contact->interfaces[b], contact->body_rows[b].n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(contact->interfaces[b], MATAIJ));
  if (contact->ranks.size == 1 && (law == CONTACT_LAW_FRICTIONLESS || law == CONTACT_LAW_FRICTION))
    PetscCall(Preallocate(contact, b, contact->interfaces[b]));
  else PetscCall(MatSetUp(contact->interfaces[b]));
  PetscCall(MatSetOption(contact->interfaces[b], MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a matrix that has been filled before can get entries in other places without a word of other ranks: one of several ranks has all
   of the body and of its rows. The same on every rank. */
static PetscErrorCode CanRenew(Contact contact, PetscInt b, PetscBool *can)
{
  const ContactBodyRows *of  = &contact->body_rows[b];
  const ContactLaw       law = contact->options.law;
  PetscMPIInt            rank;
  PetscInt               n, first;

  PetscFunctionBegin;
  *can = PETSC_FALSE;
  if (contact->ranks.size == 1 || !(law == CONTACT_LAW_FRICTIONLESS || law == CONTACT_LAW_FRICTION)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!contact->interfaces[b] || of->patterns[0] < 0 || !of->n_all) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetMeshRank(contact->bodies[b], &rank));
  if (rank < 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatGetSize(contact->interfaces[b], &n, NULL));
  first = contact->ranks.offsets[rank];
  *can  = (PetscBool)(n == of->n_all && of->all[0] >= first && of->all[n - 1] < first + contact->ranks.counts[rank]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* New room for its entries, in the block of the rank that has all of them. The block of no other rank changes, nor what ranks tell each
   other in products. */
static PetscErrorCode Renew(Contact contact, PetscInt b)
{
  Mat block;

  PetscFunctionBegin;
  if (!contact->body_rows[b].n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatMPIAIJGetSeqAIJ(contact->interfaces[b], &block, NULL, NULL));
  PetscCall(Preallocate(contact, b, block));
  /* A new matrix, as after a checkpoint, multiplies by groups of rows alike where it has enough of them. One that goes on is to look for
     them anew too: without this gaps after a checkpoint differed in the last bit. */
  PetscCall(MatSetOption(block, MAT_USE_INODES, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of the two matrices of a body is filled. The body keeps the rows of the last accepted step until this one is accepted, since
   contact forces go over from them; the rows of a step that has failed are of no use any more. */
static void ChooseMatrix(Contact contact, PetscInt b)
{
  ContactBodyRows *of      = &contact->body_rows[b];
  const PetscInt64 pattern = of->patterns[0];
  const Mat        matrix  = contact->interfaces[b];

  if (of->filled) return;
  contact->interfaces[b] = contact->spares[b];
  contact->spares[b]     = matrix;
  of->patterns[0]        = of->patterns[1];
  of->patterns[1]        = pattern;
  of->filled             = PETSC_TRUE;
}

/* Fills the matrices of the bodies whose rows are affected: in place if they have entries where those that were filled last have them,
   which is so until rows are built again. Rows that are merged or turned come from products of matrices, which are made anew. */
PetscErrorCode ContactFillMatrices(Contact contact)
{
  const PetscBool product = (PetscBool)(contact->held.merger || (contact->options.law == CONTACT_LAW_BONDED && contact->dim > 1));

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactBodyRows *of = &contact->body_rows[b];
    PetscBool        can;

    if (!of->affected) continue;
    ChooseMatrix(contact, b);
    PetscCall(CanRenew(contact, b, &can));
    if (of->patterns[0] == of->pattern) PetscCall(MatZeroEntries(contact->interfaces[b]));
    else if (can && !product) PetscCall(Renew(contact, b));
    else PetscCall(CreateMatrix(contact, b));
    of->patterns[0] = product ? -1 : of->pattern;
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair     = &contact->pairs[p];
    PetscInt           begin[2] = {0, 0};
    Mat                rows[2]  = {NULL, NULL};
    PetscBool          any      = PETSC_FALSE;

    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
      begin[side] = contact->body_rows[pair->body[side]].begin + pair->begin - pair->shift[side];
      if (!contact->body_rows[pair->body[side]].affected) continue;
      rows[side] = contact->interfaces[pair->body[side]];
      any        = PETSC_TRUE;
    }
    if (any && contact->options.law == CONTACT_LAW_FRICTION)
      PetscCall(TransferSetDirectedValues(pair->transfer, begin, pair->components, contact->rows.normal + 3 * pair->begin, rows));
    else if (any) PetscCall(TransferSetValues(pair->transfer, begin, pair->components, rows));
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    if (!contact->body_rows[b].affected) continue;
    PetscCall(MatAssemblyBegin(contact->interfaces[b], MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(contact->interfaces[b], MAT_FINAL_ASSEMBLY));
    /* values in the same places need no word of other ranks when they are assembled again */
    PetscCall(MatSetOption(contact->interfaces[b], MAT_NEW_NONZERO_LOCATION_ERR, PETSC_TRUE));
    PetscCall(ContactTurnMatrix(contact, b));
    PetscCall(ContactMergeMatrix(contact, b));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surfaces, transfers and rows of all pairs */
PetscErrorCode ContactSetUpRows(Contact contact)
{
  PetscReal extent = 0;

  PetscFunctionBegin;
  PetscCall(ContactChooseTiedMass(contact));
  if (contact->neighbours.come_and_go) PetscCall(ContactTakeFirstNeighbours(contact, &extent));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(ContactCreateSurfaces(contact, &contact->pairs[p], &extent));
    PetscCall(ContactChooseRowSide(contact, &contact->pairs[p]));
  }
  PetscCall(ContactChooseBalance(contact));
  PetscCall(ContactOrderBodies(contact)); /* again, since pairs may have been turned round */
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(ContactCreateTransfer(contact, &contact->pairs[p]));
    PetscCall(ContactMarkNodes(contact, &contact->pairs[p]));
  }
  PetscCall(ContactLayOutRows(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscBool changed;

    PetscCall(ContactMeasureTies(contact, &contact->pairs[p], PETSC_FALSE, &changed));
    PetscCall(ContactDescribeRows(contact, &contact->pairs[p]));
    PetscCall(CheckHeld(contact, &contact->pairs[p]));
  }
  PetscCall(ContactMergeDroppedRows(contact));
  PetscCall(ContactFindSharedNodes(contact));
  PetscCall(ContactLeaveOutObstacles(contact));
  ContactForgetMatrices(contact);
  PetscCall(ContactFillMatrices(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodySetInterface(contact->bodies[b], contact->interfaces[b]));
    contact->body_rows[b].filled = PETSC_FALSE;
  }
  if (contact->options.tolerance == (PetscReal)PETSC_DEFAULT) contact->options.tolerance = PENETRATION_TOLERANCE * extent;
  PetscCheck(contact->options.tolerance >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_tolerance %g m must not be negative", (double)contact->options.tolerance);
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
  PetscCall(TraceCreate(contact->rows.n, levels, &traces->displacement));
  PetscCall(TraceCreate(contact->rows.n, levels, &traces->velocity));
  PetscCall(TraceCreate(contact->rows.n, levels, &traces->acceleration));
  PetscCall(TraceCreate(contact->rows.n, levels, &traces->reaction));
  PetscCall(TraceCreate(contact->rows.n, levels, &traces->force_in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Frees the rows, and the traces of obstacles */
PetscErrorCode ContactDestroyRows(Contact contact)
{
  PetscFunctionBegin;
  if (contact->traces) {
    BodyTraces *traces = &contact->traces[contact->n_bodies];

    PetscCall(TraceDestroy(&traces->displacement));
    PetscCall(TraceDestroy(&traces->velocity));
    PetscCall(TraceDestroy(&traces->acceleration));
    PetscCall(TraceDestroy(&traces->reaction));
    PetscCall(TraceDestroy(&traces->force_in));
  }
  PetscCall(ContactDestroyMerger(contact));
  PetscCall(PetscFree7(contact->rows.pair, contact->rows.initial_gap, contact->rows.area, contact->rows.dof, contact->rows.normal,
                       contact->rows.opposite, contact->rows.tied));
  PetscCall(PetscFree7(contact->end.force, contact->end.gap, contact->start.force, contact->start.gap, contact->end.active,
                       contact->start.active, contact->work.conditions));
  PetscCall(PetscFree5(contact->ranks.row_pair, contact->ranks.mine_active, contact->ranks.all_active, contact->ranks.counts,
                       contact->ranks.offsets));
  PetscCall(PetscFree7(contact->rows.changed, contact->rows.gap_shift, contact->work.last_gap, contact->held.dropped, contact->held.heir,
                       contact->held.merged_gap, contact->work.tilts));
  PetscCall(PetscFree7(contact->work.last_force, contact->work.handover, contact->work.intervals, contact->rows.followed,
                       contact->work.moved, contact->work.flags, contact->work.rest));
  PetscCall(PetscFree2(contact->work.updated, contact->work.motion));
  PetscCall(ContactDestroyBodyRows(contact));
  PetscCall(PetscFree2(contact->release.intervals, contact->release.forces));
  PetscCall(PetscFree3(contact->ties.holds, contact->ties.distance, contact->work.entry_counts));
  PetscCall(ContactDestroySavedRows(contact));
  PetscCall(ContactDestroyTurns(contact));
  PetscCall(ContactDestroySharedNodes(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
