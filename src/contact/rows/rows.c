/* The rows of all pairs: from surfaces and transfers to matrices. */
#include <impakt/private/contactimpl.h>

/* Rows whose bodies lie closer than this part of a face are tied */
#define TIE_DISTANCE 0.5
/* Directions along which a row moves less than this part of the displacement do not count */
#define DIRECTION 1e-9

/* All nodes of both surfaces: they may slide, and any of them may come to lie opposite to the partner */
static PetscErrorCode MarkContactNodes(Contact contact, const ContactPair *pair)
{
  PetscFunctionBegin;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    const SurfaceData *data;
    const PetscInt    *vertices;
    PetscInt           n, rstart, body = pair->body[side];
    Vec                positions;

    PetscCall(SurfaceGetVertices(pair->surfaces[side], &n, &vertices));
    PetscCall(BodySetContactNodes(contact->bodies[body], n, vertices));
    if (contact->n_all_nodes[body]) continue;
    /* the first pair of a body says where its contact point is */
    PetscCall(SurfaceGetData(pair->surfaces[side], &data));
    PetscCallMPI(MPIU_Allreduce(&data->n_owned, &contact->n_all_nodes[body], 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
    PetscCall(BodyGetReferencePositions(contact->bodies[body], &positions));
    PetscCall(VecGetOwnershipRange(positions, &rstart, NULL));
    PetscCall(PetscMalloc1(data->n_owned, &contact->node_dofs[body]));
    for (PetscInt i = 0; i < data->n_owned; i++) contact->node_dofs[body][i] = data->dofs[i] - rstart;
    contact->n_node_dofs[body] = data->n_owned;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows live on the rank that owns their Dirichlet node */
static PetscErrorCode CountRows(Contact contact)
{
  PetscFunctionBegin;
  contact->n_rows = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];
    TransferRows rows;

    PetscCall(TransferGetRows(pair->transfer, &rows));
    pair->components = contact->law == CONTACT_LAW_TIED ? contact->dim : 1;
    pair->begin      = contact->n_rows;
    contact->n_rows += rows.n * pair->components;
    pair->end = contact->n_rows;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AllocateRows(Contact contact)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)contact);
  PetscMPIInt mine, total = 0;
  PetscInt    n = contact->n_rows;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Scan(&n, &contact->row_begin, 1, MPIU_INT, MPI_SUM, comm));
  contact->row_begin -= n;
  PetscCallMPI(MPI_Allreduce(&n, &contact->n_all_rows, 1, MPIU_INT, MPI_SUM, comm));
  PetscCall(PetscCalloc7(n, &contact->row_pair, n, &contact->initial_gap, n, &contact->area, n, &contact->row_dof, 3 * n,
                         &contact->row_normal, n, &contact->opposite, n, &contact->tied));
  PetscCall(PetscCalloc7(n, &contact->force, n, &contact->gap, n, &contact->saved_force, n, &contact->saved_gap, n, &contact->active, n,
                         &contact->saved_active, n, &contact->conditions));
  PetscCall(PetscCalloc5(contact->n_all_rows, &contact->all_row_pair, n, &contact->mine_active, contact->n_all_rows, &contact->all_active,
                         contact->size, &contact->counts, contact->size, &contact->offsets));
  PetscCall(PetscCalloc6(n, &contact->changed, n, &contact->gap_shift, n, &contact->last_gap, n, &contact->dropped, n, &contact->heir, n,
                         &contact->merged_gap));
  PetscCall(PetscMPIIntCast(n, &mine));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, contact->counts, 1, MPI_INT, comm));
  for (PetscMPIInt r = 0; r < contact->size; total += contact->counts[r++]) contact->offsets[r] = total;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++) contact->row_pair[i] = p;
  PetscCallMPI(MPI_Allgatherv(contact->row_pair, mine, MPIU_INT, contact->all_row_pair, contact->counts, contact->offsets, MPIU_INT, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether row i asks for a displacement of its Dirichlet node that the user prescribes already */
static PetscErrorCode IsHeld(Contact contact, const ContactPair *pair, PetscInt i, PetscBool *held)
{
  const PetscInt *dofs;
  PetscInt        n;

  PetscFunctionBegin;
  *held = contact->prescribes;
  PetscCall(BodyGetHeldDofs(contact->bodies[pair->body[0]], &n, &dofs));
  for (PetscInt d = 0; d < contact->dim && *held; d++) {
    PetscInt place;

    if (PetscAbsReal(contact->row_normal[3 * i + d]) < DIRECTION) continue;
    PetscCall(PetscFindInt(contact->row_dof[i] + d, n, dofs, &place));
    if (place < 0) *held = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the rows of a pair are, as its transfer has them now. Tied rows keep the bodies together as they are; what is held already is not.
 */
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

      contact->row_dof[i]     = rows.dofs[node] - first;
      contact->opposite[i]    = rows.opposite[node];
      contact->initial_gap[i] = rows.opposite[node] ? rows.gap[node] + (rows.changed[node] ? 0 : contact->gap_shift[i]) : CONTACT_NO_GAP;
      contact->area[i]        = rows.area[node];
      contact->changed[i]     = rows.changed[node];
      if (contact->law == CONTACT_LAW_TIED) {
        contact->tied[i]               = (PetscBool)(rows.opposite[node] && PetscAbsReal(rows.gap[node]) <= TIE_DISTANCE * rows.size[node]);
        contact->initial_gap[i]        = contact->tied[i] ? 0 : CONTACT_NO_GAP;
        contact->row_normal[3 * i + k] = 1;
      } else
        for (PetscInt d = 0; d < dim; d++) contact->row_normal[3 * i + d] = rows.normals[dim * node + d];
      PetscCall(IsHeld(contact, pair, i, &held));
      contact->dropped[i]    = (PetscBool)(held && (contact->law == CONTACT_LAW_TIED ? contact->tied[i] : rows.opposite[node]) &&
                                           !pair->obstacle && dim > 1);
      contact->merged_gap[i] = 0;
      if (!held) continue;
      contact->opposite[i] = contact->tied[i] = PETSC_FALSE;
      contact->initial_gap[i]                 = CONTACT_NO_GAP;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error where nothing of the Dirichlet side can follow its partner, which might follow it */
static PetscErrorCode CheckHeld(Contact contact, const ContactPair *pair)
{
  TransferRows rows;
  int          any[2] = {0, 0};

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  for (PetscInt i = 0; i < rows.n; i++) any[0] |= rows.opposite[i];
  for (PetscInt i = pair->begin; i < pair->end; i++) any[1] |= contact->opposite[i];
  PetscCall(ContactOr(contact, &any[0]));
  PetscCall(ContactOr(contact, &any[1]));
  PetscCheck(!any[0] || any[1], PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: the displacement of all nodes of body '%s' that may touch is prescribed across the surface, so that they "
             "cannot follow the other side; name that body second, or prescribe less in -%s_boundary_displacement",
             pair->name, ((PetscObject)contact->bodies[pair->body[0]])->name, ((PetscObject)contact->bodies[pair->body[0]])->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* New matrices with the rows as they are */
PetscErrorCode ContactFillMatrices(Contact contact)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Vec      positions;
    PetscInt n;

    PetscCall(BodyGetReferencePositions(contact->bodies[b], &positions));
    PetscCall(VecGetLocalSize(positions, &n));
    PetscCall(MatDestroy(&contact->interfaces[b]));
    PetscCall(MatCreate(comm, &contact->interfaces[b]));
    PetscCall(MatSetSizes(contact->interfaces[b], contact->n_rows, n, PETSC_DETERMINE, PETSC_DETERMINE));
    PetscCall(MatSetType(contact->interfaces[b], MATAIJ));
    PetscCall(MatSetUp(contact->interfaces[b]));
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    PetscCall(TransferSetValues(pair->transfer, contact->row_begin + pair->begin, pair->components, contact->interfaces[pair->body[0]],
                                pair->obstacle ? NULL : contact->interfaces[pair->body[1]]));
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(MatAssemblyBegin(contact->interfaces[b], MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(contact->interfaces[b], MAT_FINAL_ASSEMBLY));
    PetscCall(ContactMergeMatrix(contact, &contact->interfaces[b]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mean normal of the rows, and whether there are any */
static PetscErrorCode GetPairNormal(Contact contact, ContactPair *pair)
{
  MPI_Comm     comm    = PetscObjectComm((PetscObject)contact);
  PetscReal    sums[4] = {0};
  TransferRows rows;

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  for (PetscInt i = 0; i < rows.n; i++) {
    if (!rows.opposite[i]) continue;
    for (PetscInt d = 0; d < contact->dim; d++) sums[d] += rows.normals[contact->dim * i + d];
    sums[3] += 1;
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, sums, 4, MPIU_REAL, MPIU_SUM, comm));
  for (PetscInt d = 0; d < 3; d++) pair->normal[d] = sums[3] > 0 ? sums[d] / sums[3] : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surfaces of a pair that the user wants must have faces that see each other, though they may lie beside each other at the start */
static PetscErrorCode CheckFacing(Contact contact, const ContactPair *pair)
{
  Surface surfaces[2] = {NULL, NULL};
  int     any[2]      = {0, 1};

  PetscFunctionBegin;
  if (pair->chosen || !contact->facing) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    DM dm;

    PetscCall(BodyGetDM(contact->bodies[pair->body[side]], &dm));
    PetscCall(SurfaceCreate(dm, pair->surface[side], &surfaces[side]));
  }
  PetscCall(SurfaceKeepFacing(surfaces[0], surfaces[1], pair->obstacle, PETSC_TRUE, PETSC_TRUE));
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    const SurfaceData *data;

    PetscCall(SurfaceGetData(surfaces[side], &data));
    any[side] = data->n_faces > 0;
    PetscCall(ContactOr(contact, &any[side]));
    PetscCall(SurfaceDestroy(&surfaces[side]));
  }
  PetscCheck(any[0] && any[1], PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: the surfaces of the two bodies do not face each other anywhere", pair->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateTransfer(Contact contact, ContactPair *pair, PetscReal *extent)
{
  PetscBool rebuilt;
  PetscInt  dims[2] = {contact->dim, contact->dim};

  PetscFunctionBegin;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    PetscReal lower[3], upper[3];
    DM        dm;

    PetscCall(BodyGetDM(contact->bodies[pair->body[side]], &dm));
    PetscCall(DMGetCoordinateDim(dm, &dims[side]));
    PetscCall(SurfaceCreate(dm, pair->surface[side], &pair->surfaces[side]));
    PetscCall(DMGetBoundingBox(dm, lower, upper));
    for (PetscInt d = 0; d < dims[side]; d++) *extent = PetscMax(*extent, PetscMax(PetscAbsReal(lower[d]), PetscAbsReal(upper[d])));
  }
  PetscCheck(dims[0] == dims[1] && dims[0] == contact->dim, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: the bodies of a contact problem must have one dimension; these have %" PetscInt_FMT " and %" PetscInt_FMT
             ", and another body has %" PetscInt_FMT,
             pair->name, dims[0], dims[1], contact->dim);
  PetscCall(SurfaceKeepFacing(pair->surfaces[0], pair->surfaces[1], pair->obstacle, (PetscBool)(contact->facing && !pair->surface[0]),
                              (PetscBool)(contact->facing && !pair->surface[1])));
  PetscCall(CheckFacing(contact, pair));
  PetscCall(TransferCreate(PetscObjectComm((PetscObject)contact), pair->surfaces[0], pair->surfaces[1], pair->obstacle, &pair->transfer));
  PetscCall(TransferSetBounds(pair->transfer, contact->slip_bound, contact->angle_bound));
  PetscCall(TransferSetGuards(pair->transfer, (PetscBool)(contact->law != CONTACT_LAW_TIED)));
  PetscCall(TransferUpdate(pair->transfer, NULL, NULL, contact->dim == 1 || pair->obstacle ? PETSC_MAX_REAL : 0, &rebuilt));
  PetscCall(GetPairNormal(contact, pair));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surfaces, transfers and rows of all pairs */
PetscErrorCode ContactSetUpPairs(Contact contact)
{
  PetscReal extent = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc7(contact->n_bodies, &contact->speeds, contact->n_bodies + 1, &contact->traces, contact->n_bodies,
                         &contact->interfaces, contact->n_bodies, &contact->order, contact->n_bodies, &contact->node_dofs,
                         contact->n_bodies, &contact->n_node_dofs, contact->n_bodies, &contact->n_all_nodes));
  PetscCall(ContactOrderBodies(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetUpDiscretization(contact->bodies[b]));
  PetscCall(ContactFindDimension(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(CreateTransfer(contact, &contact->pairs[p], &extent));
    PetscCall(MarkContactNodes(contact, &contact->pairs[p]));
  }
  PetscCall(CountRows(contact));
  PetscCall(AllocateRows(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(ContactDescribeRows(contact, &contact->pairs[p]));
    PetscCall(CheckHeld(contact, &contact->pairs[p]));
  }
  PetscCall(ContactMergeDroppedRows(contact));
  PetscCall(ContactFindSharedNodes(contact));
  PetscCall(ContactLeaveOutObstacles(contact));
  PetscCall(ContactFillMatrices(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetInterface(contact->bodies[b], contact->interfaces[b]));
  /* what a converged outer iteration leaves of the gap must not count as penetration in the next trial */
  if (contact->tolerance == (PetscReal)PETSC_DEFAULT) contact->tolerance = 3e-12 * extent;
  PetscCheck(contact->tolerance >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_tolerance %g m must not be negative", (double)contact->tolerance);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An obstacle answers as a body would that stays where it is: its traces are zeros, at as many times as any body has */
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
  PetscCall(TraceCreate(contact->n_rows, levels, &traces->displacement));
  PetscCall(TraceCreate(contact->n_rows, levels, &traces->velocity));
  PetscCall(TraceCreate(contact->n_rows, levels, &traces->acceleration));
  PetscCall(TraceCreate(contact->n_rows, levels, &traces->reaction));
  PetscCall(TraceCreate(contact->n_rows, levels, &traces->force_in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyRows(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];

    PetscCall(TransferDestroy(&pair->transfer));
    for (PetscInt side = 0; side < 2; side++) {
      PetscCall(SurfaceDestroy(&pair->surfaces[side]));
      PetscCall(PetscFree(pair->surface[side]));
    }
    PetscCall(PetscFree(pair->name));
  }
  for (PetscInt o = 0; o < contact->n_obstacles; o++) PetscCall(ObstacleDestroy(&contact->obstacles[o]));
  if (contact->traces) {
    BodyTraces *traces = &contact->traces[contact->n_bodies];

    PetscCall(TraceDestroy(&traces->displacement));
    PetscCall(TraceDestroy(&traces->velocity));
    PetscCall(TraceDestroy(&traces->acceleration));
    PetscCall(TraceDestroy(&traces->reaction));
    PetscCall(TraceDestroy(&traces->force_in));
  }
  PetscCall(ContactDestroyMerger(contact));
  PetscCall(PetscFree(contact->obstacles));
  PetscCall(PetscFree(contact->pairs));
  PetscCall(PetscFree7(contact->row_pair, contact->initial_gap, contact->area, contact->row_dof, contact->row_normal, contact->opposite,
                       contact->tied));
  PetscCall(PetscFree7(contact->force, contact->gap, contact->saved_force, contact->saved_gap, contact->active, contact->saved_active,
                       contact->conditions));
  PetscCall(PetscFree5(contact->all_row_pair, contact->mine_active, contact->all_active, contact->counts, contact->offsets));
  PetscCall(PetscFree6(contact->changed, contact->gap_shift, contact->last_gap, contact->dropped, contact->heir, contact->merged_gap));
  PetscCall(PetscFree2(contact->release_intervals, contact->release));
  PetscCall(ContactDestroySharedNodes(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
