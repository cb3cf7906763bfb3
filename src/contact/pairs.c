/* Contact pairs: from their names to rows of the interface. */
#include "contactimpl.h"

static PetscErrorCode ParseSide(Contact contact, const char pair[], const char side[], PetscInt *body, char **surface)
{
  char     *dot;
  char      name[256], known[1024] = "";
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(name, side, sizeof(name)));
  PetscCall(PetscStrchr(name, '.', &dot));
  *surface = NULL;
  if (dot) {
    *dot = 0;
    PetscCall(PetscStrallocpy(dot + 1, surface));
  }
  *body = -1;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(PetscStrcmp(((PetscObject)contact->bodies[b])->name, name, &same));
    if (same) *body = b;
    PetscCall(PetscStrlcat(known, b ? ", " : "", sizeof(known)));
    PetscCall(PetscStrlcat(known, ((PetscObject)contact->bodies[b])->name, sizeof(known)));
  }
  PetscCheck(*body >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_pairs %s: there is no body '%s'; -bodies has %s", pair, name, known);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactAddPair - adds a pair of bodies that may touch

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, with its bodies
- pair    - names of two bodies, Dirichlet side first, `left:right`; or of their surfaces, `left.top:right.bottom`

  Options Database Key:
. -contact_pairs a:b,b:c - pairs

  Level: beginner

.seealso: `Contact`, `SurfaceCreate()`
@*/
PetscErrorCode ContactAddPair(Contact contact, const char pair[])
{
  ContactPair *p;
  char         text[512], *colon;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscCheck(!contact->setup, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_WRONGSTATE, "Call before ContactSetUp()");
  PetscCall(PetscStrncpy(text, pair, sizeof(text)));
  PetscCall(PetscStrchr(text, ':', &colon));
  PetscCheck(colon, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_pairs %s: a pair is two bodies with a colon between them, Dirichlet side first, as in left:right", pair);
  *colon = 0;
  if (contact->n_pairs == contact->max_pairs) {
    contact->max_pairs = 2 * contact->max_pairs + 4;
    PetscCall(PetscRealloc((size_t)contact->max_pairs * sizeof(ContactPair), &contact->pairs));
  }
  p = &contact->pairs[contact->n_pairs++];
  PetscCall(PetscMemzero(p, sizeof(*p)));
  PetscCall(PetscStrallocpy(pair, &p->name));
  PetscCall(ParseSide(contact, pair, text, &p->body[0], &p->surface[0]));
  PetscCall(ParseSide(contact, pair, colon + 1, &p->body[1], &p->surface[1]));
  PetscCheck(p->body[0] != p->body[1], PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_pairs %s: a body cannot touch itself", pair);
  for (PetscInt other = 0; other < contact->n_pairs - 1; other++) {
    PetscBool same;

    PetscCall(PetscStrcmp(pair, contact->pairs[other].name, &same));
    PetscCheck(!same, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_pairs: pair %s is given twice", pair);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bodies in an order in which every Dirichlet side comes before its Neumann side */
static PetscErrorCode OrderBodies(Contact contact)
{
  PetscInt  done  = 0;
  PetscBool moved = PETSC_TRUE, *placed;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(contact->n_bodies, &placed));
  while (done < contact->n_bodies && moved) {
    moved = PETSC_FALSE;
    for (PetscInt b = 0; b < contact->n_bodies; b++) {
      PetscBool ready = (PetscBool)!placed[b];

      for (PetscInt p = 0; p < contact->n_pairs; p++)
        if (contact->pairs[p].body[1] == b && !placed[contact->pairs[p].body[0]]) ready = PETSC_FALSE;
      if (!ready) continue;
      contact->order[done++] = b;
      placed[b] = moved = PETSC_TRUE;
    }
  }
  PetscCall(PetscFree(placed));
  PetscCheck(done == contact->n_bodies, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_pairs: the pairs form a circle, each body waiting for the reaction of the one before; turn one pair round (b:a instead of a:b)");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All nodes of both surfaces: they may slide, and any of them may come to lie opposite to the partner */
static PetscErrorCode MarkContactNodes(Contact contact, const ContactPair *pair, Surface surfaces[])
{
  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) {
    const SurfaceData *data;
    const PetscInt    *vertices;
    PetscInt           n, rstart, body = pair->body[side];
    Vec                positions;

    PetscCall(SurfaceGetVertices(surfaces[side], &n, &vertices));
    PetscCall(BodySetContactNodes(contact->bodies[body], n, vertices));
    if (contact->n_all_nodes[body]) continue;
    /* the first pair of a body says where its contact point is */
    PetscCall(SurfaceGetData(surfaces[side], &data));
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
static PetscErrorCode CountRows(Contact contact, Transfer transfers[])
{
  PetscFunctionBegin;
  contact->n_rows = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    TransferRows rows;

    PetscCall(TransferGetRows(transfers[p], &rows));
    contact->pairs[p].begin = contact->n_rows;
    contact->n_rows += rows.n;
    contact->pairs[p].end = contact->n_rows;
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
  PetscCall(PetscMalloc3(n, &contact->row_pair, n, &contact->initial_gap, n, &contact->area));
  PetscCall(PetscCalloc7(n, &contact->force, n, &contact->gap, n, &contact->saved_force, n, &contact->saved_gap, n, &contact->active, n, &contact->saved_active, n, &contact->conditions));
  PetscCall(PetscCalloc5(contact->n_all_rows, &contact->all_row_pair, n, &contact->mine_active, contact->n_all_rows, &contact->all_active, contact->size, &contact->counts, contact->size, &contact->offsets));
  PetscCall(PetscMPIIntCast(n, &mine));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, contact->counts, 1, MPI_INT, comm));
  for (PetscMPIInt r = 0; r < contact->size; total += contact->counts[r++]) contact->offsets[r] = total;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FillRows(Contact contact, Transfer transfers[])
{
  MPI_Comm comm = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Vec      positions;
    PetscInt n;

    PetscCall(BodyGetReferencePositions(contact->bodies[b], &positions));
    PetscCall(VecGetLocalSize(positions, &n));
    PetscCall(MatCreate(comm, &contact->interfaces[b]));
    PetscCall(MatSetSizes(contact->interfaces[b], contact->n_rows, n, PETSC_DETERMINE, PETSC_DETERMINE));
    PetscCall(MatSetType(contact->interfaces[b], MATAIJ));
    PetscCall(MatSetUp(contact->interfaces[b]));
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair *pair = &contact->pairs[p];
    TransferRows rows;

    PetscCall(TransferGetRows(transfers[p], &rows));
    for (PetscInt i = 0; i < rows.n; i++) {
      contact->row_pair[pair->begin + i]    = p;
      contact->initial_gap[pair->begin + i] = rows.gap[i];
      contact->area[pair->begin + i]        = rows.area[i];
    }
    PetscCall(TransferSetValues(transfers[p], contact->row_begin + pair->begin, 1, contact->interfaces[pair->body[0]], contact->interfaces[pair->body[1]]));
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(MatAssemblyBegin(contact->interfaces[b], MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(contact->interfaces[b], MAT_FINAL_ASSEMBLY));
    PetscCall(BodySetInterface(contact->bodies[b], contact->interfaces[b]));
  }
  {
    PetscMPIInt *counts = contact->counts, *offsets = contact->offsets;

    PetscCallMPI(MPI_Allgatherv(contact->row_pair, (PetscMPIInt)contact->n_rows, MPIU_INT, contact->all_row_pair, counts, offsets, MPIU_INT, comm));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mean normal of the rows, and whether there are any */
static PetscErrorCode GetPairNormal(Contact contact, ContactPair *pair, Transfer transfer, PetscInt dim)
{
  MPI_Comm     comm    = PetscObjectComm((PetscObject)contact);
  PetscReal    sums[4] = {0};
  TransferRows rows;

  PetscFunctionBegin;
  PetscCall(TransferGetRows(transfer, &rows));
  for (PetscInt i = 0; i < rows.n; i++) {
    if (!rows.opposite[i]) continue;
    for (PetscInt d = 0; d < dim; d++) sums[d] += rows.normals[dim * i + d];
    sums[3] += 1;
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, sums, 4, MPIU_REAL, MPIU_SUM, comm));
  PetscCheck(sums[3] > 0, comm, PETSC_ERR_USER_INPUT, "-contact_pairs %s: the surfaces of the two bodies do not face each other anywhere", pair->name);
  for (PetscInt d = 0; d < 3; d++) pair->normal[d] = sums[d] / sums[3];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateTransfer(Contact contact, ContactPair *pair, Surface surfaces[], Transfer *transfer, PetscReal *extent)
{
  PetscInt  dim = 0;
  PetscBool rebuilt;

  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) {
    PetscReal lower[3], upper[3];
    DM        dm;

    PetscCall(BodyGetDM(contact->bodies[pair->body[side]], &dm));
    PetscCall(SurfaceCreate(dm, pair->surface[side], &surfaces[side]));
    PetscCall(DMGetCoordinateDim(dm, &dim));
    PetscCall(DMGetBoundingBox(dm, lower, upper));
    for (PetscInt d = 0; d < dim; d++) *extent = PetscMax(*extent, PetscMax(PetscAbsReal(lower[d]), PetscAbsReal(upper[d])));
  }
  PetscCall(SurfaceKeepFacing(surfaces[0], surfaces[1], NULL, (PetscBool)!pair->surface[0], (PetscBool)!pair->surface[1]));
  PetscCall(TransferCreate(PetscObjectComm((PetscObject)contact), surfaces[0], surfaces[1], NULL, transfer));
  PetscCall(TransferUpdate(*transfer, NULL, NULL, PETSC_MAX_REAL, &rebuilt));
  PetscCall(GetPairNormal(contact, pair, *transfer, dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surfaces, transfers and rows of all pairs */
PetscErrorCode ContactSetUpPairs(Contact contact)
{
  Transfer *transfers;
  Surface  *surfaces;
  PetscReal extent = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc6(contact->n_bodies, &contact->traces, contact->n_bodies, &contact->interfaces, contact->n_bodies, &contact->order, contact->n_bodies, &contact->node_dofs, contact->n_bodies, &contact->n_node_dofs, contact->n_bodies, &contact->n_all_nodes));
  PetscCall(OrderBodies(contact));
  PetscCall(PetscMalloc2(contact->n_pairs, &transfers, 2 * contact->n_pairs, &surfaces));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(CreateTransfer(contact, &contact->pairs[p], surfaces + 2 * p, &transfers[p], &extent));
    PetscCall(MarkContactNodes(contact, &contact->pairs[p], surfaces + 2 * p));
  }
  PetscCall(CountRows(contact, transfers));
  PetscCall(AllocateRows(contact));
  PetscCall(FillRows(contact, transfers));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(TransferDestroy(&transfers[p]));
    PetscCall(SurfaceDestroy(&surfaces[2 * p]));
    PetscCall(SurfaceDestroy(&surfaces[2 * p + 1]));
  }
  PetscCall(PetscFree2(transfers, surfaces));
  /* what a converged outer iteration leaves of the gap must not count as penetration in the next trial */
  if (contact->tolerance == (PetscReal)PETSC_DEFAULT) contact->tolerance = 3e-12 * extent;
  PetscCheck(contact->tolerance >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_tolerance %g m must not be negative", (double)contact->tolerance);
  PetscFunctionReturn(PETSC_SUCCESS);
}
