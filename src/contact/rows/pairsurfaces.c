/* The surfaces of a pair, which of their nodes may touch, and the transfer between them. */
#include <contact/parts.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodymass.h>

/* Tells both bodies of a pair which of their nodes may touch, and are to be massless: all nodes of both surfaces, since any may come
   opposite to the partner by sliding. None of a pair tied with its mass, unless the whole body keeps it */
PetscErrorCode ContactMarkNodes(Contact contact, const ContactPair *pair)
{
  PetscFunctionBegin;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    const Body         body = contact->bodies[pair->body[side]];
    const SurfaceData *data;

    PetscCall(SurfaceGetData(pair->surfaces[side], &data));
    if (!pair->keeps_mass || contact->sideless) {
      if (BodyDoes(body, BodyGetMassRedistributeNear)) PetscCall(ContactMarkNearNodes(contact, pair, side));
      else PetscCall(BodySetContactNodes(body, data->n_nodes, data->vertices));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mean normal of the rows that have a partner opposite */
static PetscErrorCode GetPairNormal(Contact contact, ContactPair *pair)
{
  PetscReal    sums[4] = {0};
  TransferRows rows;

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  for (PetscInt i = 0; i < rows.n; i++) {
    if (!rows.opposite[i]) continue;
    for (PetscInt d = 0; d < contact->dim; d++) sums[d] += rows.normals[contact->dim * i + d];
    sums[3] += 1;
  }
  PetscCall(ContactReduce(contact, 4, MPIU_REAL, MPIU_SUM, sums));
  for (PetscInt d = 0; d < 3; d++) pair->normal[d] = sums[3] > 0 ? sums[d] / sums[3] : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if the surfaces of a pair that the user has named have no faces that see each other (opposite or not). */
static PetscErrorCode CheckFacing(Contact contact, const ContactPair *pair)
{
  Surface   surfaces[2];
  PetscBool any[2]                  = {PETSC_FALSE, PETSC_TRUE};
  char      moves[2][CONTACT_MOVES] = {"", ""};

  PetscFunctionBegin;
  if (pair->chosen || !contact->options.facing) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactCreateFacing(contact, pair, surfaces));
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    const SurfaceData *data;

    PetscCall(SurfaceGetData(surfaces[side], &data));
    any[side] = (PetscBool)(data->n_faces > 0);
    PetscCall(ContactOr(contact, &any[side]));
    PetscCall(SurfaceDestroy(&surfaces[side]));
  }
  if (pair->obstacle && !any[0]) PetscCall(ContactRefuseTurned(contact, pair));
  for (PetscInt side = 0; side < 2 && !(any[0] && any[1]); side++)
    PetscCall(ContactDescribeMoves(contact, pair->body[side], moves[side], NULL));
  PetscCheck(any[0] && any[1], PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: the surfaces of the two bodies do not face each other anywhere at the start; name others, move one of the "
             "bodies (%s, or %s), or set -contact_facing false where they turn to each other later",
             pair->name, moves[0], moves[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A surface of a body at the end of those of all pairs */
static PetscErrorCode AppendSurface(Contact contact, PetscInt body, const char name[], PetscBool shared)
{
  ContactSurface *entry;
  PetscBool       first = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt s = 0; s < contact->n_surfaces; s++) first = (PetscBool)(first && contact->surfaces[s].body != body);
  if (contact->n_surfaces == contact->max_surfaces) {
    contact->max_surfaces = 2 * contact->max_surfaces + 4;
    PetscCall(PetscRealloc((size_t)contact->max_surfaces * sizeof(*contact->surfaces), &contact->surfaces));
  }
  entry  = &contact->surfaces[contact->n_surfaces++];
  *entry = (ContactSurface){.body = body, .name = name, .shared = shared, .first = first};
  PetscCall(ContactCreateSurface(contact, body, name, &entry->surface));
  PetscCall(SurfaceSetRound(entry->surface, (PetscBool)(contact->dim == 3 && contact->options.balance)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A surface of one side of a pair: that of an earlier pair where it has the same, or a new one */
static PetscErrorCode TakeSurface(Contact contact, ContactPair *pair, PetscInt side, PetscBool shared)
{
  PetscInt place = contact->n_surfaces;

  PetscFunctionBegin;
  for (PetscInt s = 0; s < contact->n_surfaces && shared && place == contact->n_surfaces; s++) {
    const ContactSurface *entry = &contact->surfaces[s];
    PetscBool             same  = (PetscBool)(entry->shared && entry->body == pair->body[side]);

    if (same) PetscCall(PetscStrcmp(entry->name, pair->surface[side], &same));
    if (same) place = s;
  }
  if (place == contact->n_surfaces) PetscCall(AppendSurface(contact, pair->body[side], pair->surface[side], shared));
  pair->place[side]    = place;
  pair->surfaces[side] = contact->surfaces[place].surface;
  PetscCall(PetscObjectReference((PetscObject)pair->surfaces[side]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `extent` grows to the largest coordinate of a mesh, without sign [m]. `dim`: how many these are */
static PetscErrorCode GrowExtent(Body body, PetscInt *dim, PetscReal *extent)
{
  PetscReal lower[3], upper[3];
  DM        dm;

  PetscFunctionBegin;
  PetscCall(BodyGetDM(body, &dm));
  PetscCall(DMGetCoordinateDim(dm, dim));
  PetscCall(DMGetBoundingBox(dm, lower, upper));
  for (PetscInt d = 0; d < *dim; d++) *extent = PetscMax(*extent, PetscMax(PetscAbsReal(lower[d]), PetscAbsReal(upper[d])));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where pairs come and go: the surfaces of all bodies, whose nodes may all touch; then the pairs that are near. `extent` becomes the
   largest coordinate of the meshes, without sign, if it was smaller [m]. */
PetscErrorCode ContactTakeFirstNeighbours(Contact contact, PetscReal *extent)
{
  PetscInt n_found;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const SurfaceData *data;
    PetscInt           dim;

    PetscCall(AppendSurface(contact, b, NULL, PETSC_TRUE));
    PetscCall(SurfaceGetData(contact->surfaces[b].surface, &data));
    PetscCall(BodySetContactNodes(contact->bodies[b], data->n_nodes, data->vertices));
    PetscCall(GrowExtent(contact->bodies[b], &dim, extent));
    PetscCall(BodyGetScale(contact->bodies[b], BODY_CONTACT_ELEMENT_SIZE, &contact->neighbours.edge[b]));
  }
  PetscCall(ContactFindNeighbours(contact, 0, &n_found));
  for (PetscInt p = 0; p < n_found; p++) {
    ContactPair *pair;

    PetscCall(ContactAppendNeighbours(contact, contact->neighbours.found[p], &pair));
  }
  PetscCall(ContactNoteNeighbours(contact, n_found, contact->neighbours.found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two surfaces by which a body touches itself are apart, and the method puts forces on both */
static PetscErrorCode CheckSelf(Contact contact, const ContactPair *pair)
{
  const SurfaceData *data[2];
  PetscInt          *first, place;
  PetscBool          common = PETSC_FALSE;

  PetscFunctionBegin;
  if (pair->obstacle || pair->body[0] != pair->body[1]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(
      !BodyDoes(contact->bodies[pair->body[0]], BodyIsRigid) && !contact->prescribes && contact->dim > 1,
      PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
      "-contact_pairs %s: a body touches itself where it deforms, in two or three dimensions, and by forces on its surfaces: leave the "
      "pair out for rigid bodies and bars, and choose -contact_type schwarz in place of alternation",
      pair->name);
  for (PetscInt side = 0; side < 2; side++) PetscCall(SurfaceGetData(pair->surfaces[side], &data[side]));
  PetscCall(PetscMalloc1(data[0]->n_owned, &first));
  PetscCall(PetscArraycpy(first, data[0]->dofs, data[0]->n_owned));
  PetscCall(PetscSortInt(data[0]->n_owned, first));
  for (PetscInt i = 0; i < data[1]->n_owned && !common; i++) {
    PetscCall(PetscFindInt(data[1]->dofs[i], data[0]->n_owned, first, &place));
    common = (PetscBool)(place >= 0);
  }
  PetscCall(PetscFree(first));
  PetscCall(ContactOr(contact, &common));
  PetscCheck(!common, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: the two surfaces have nodes in common, which would touch themselves; name surfaces that are apart",
             pair->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surfaces of a pair. `extent` grows to the largest coordinate of their meshes, without sign [m]; of all bodies if pairs come and go. */
PetscErrorCode ContactCreateSurfaces(Contact contact, ContactPair *pair, PetscReal *extent)
{
  PetscInt  dims[2]  = {contact->dim, contact->dim};
  PetscBool faces[2] = {PETSC_FALSE, PETSC_FALSE}; /* those alone that face the partner at the start */

  PetscFunctionBegin;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    faces[side] = (PetscBool)(contact->options.facing && !pair->surface[side]);
    PetscCall(TakeSurface(contact, pair, side, (PetscBool)!faces[side]));
    if (!contact->neighbours.come_and_go) PetscCall(GrowExtent(contact->bodies[pair->body[side]], &dims[side], extent));
  }
  PetscCheck(dims[0] == dims[1] && dims[0] == contact->dim, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs %s: the bodies of a contact problem must have one dimension; these have %" PetscInt_FMT " and %" PetscInt_FMT
             ", and another body has %" PetscInt_FMT,
             pair->name, dims[0], dims[1], contact->dim);
  PetscCall(ContactCheckAxisymmetric(contact, pair));
  PetscCall(CheckSelf(contact, pair));
  PetscCall(SurfaceKeepFacing(pair->surfaces[0], pair->surfaces[1], pair->obstacle, faces[0], faces[1]));
  PetscCall(CheckFacing(contact, pair));
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) { /* normals stay in planes of symmetry */
    const PetscInt *dofs;
    PetscInt        n, first;
    Vec             positions;

    PetscCall(BodyGetHeldDofs(contact->bodies[pair->body[side]], &n, &dofs));
    PetscCall(BodyGetReferencePositions(contact->bodies[pair->body[side]], &positions));
    PetscCall(VecGetOwnershipRange(positions, &first, NULL));
    PetscCall(SurfaceSetMirrors(pair->surfaces[side], n, dofs, first));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether rows count with the bends of both surfaces. Without inertia they stay as they were built while forces press the surfaces flat:
   between both normals is where that flat surface is, to first order in the curvatures, and what presses along normals of one side alone
   has a part along the surface that is not small beside friction. With inertia rows follow the surfaces; in three dimensions coarse balls
   lose six times the energy then if bends count, with normals that are means by areas. */
static PetscBool IsCurved(Contact contact, const ContactPair *pair, PetscBool inertia, PetscBool linear)
{
  if (ContactPairTies(pair)) return PETSC_FALSE;
  if (!inertia) return (PetscBool)(pair->law == CONTACT_LAW_FRICTION);
  return (PetscBool)(!linear && (contact->dim == 2 || contact->options.balance));
}

/* The modulus E / (1 - nu^2) by which a body gives way where another one is pressed on it [Pa]; infinite, if it is rigid */
static PetscErrorCode GetContactModulus(Body body, PetscReal *modulus)
{
  PetscReal poisson;
  Material  material;

  PetscFunctionBegin;
  *modulus = PETSC_INFINITY;
  if (BodyDoes(body, BodyIsRigid)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetSurfaceMaterial(body, &material));
  PetscCall(MaterialGetYoungsModulus(material, modulus));
  PetscCall(MaterialGetPoissonsRatio(material, &poisson));
  *modulus /= 1 - PetscSqr(poisson);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How much of the normals of rows between bodies without inertia is that of the second body: the stiffer one keeps its shape */
static PetscErrorCode GetNormalShare(Contact contact, const ContactPair *pair, PetscReal *share)
{
  PetscReal first, second;

  PetscFunctionBegin;
  *share = 0.5;
  if (!pair->rests || pair->obstacle) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GetContactModulus(contact->bodies[pair->body[0]], &first));
  PetscCall(GetContactModulus(contact->bodies[pair->body[1]], &second));
  if (first == second) PetscFunctionReturn(PETSC_SUCCESS);
  *share = second == PETSC_INFINITY ? 1 : second / (first + second); /* 0 where the first is rigid */
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactCreateTransfer(Contact contact, ContactPair *pair)
{
  TransferOptions options = {.slip_bound  = contact->options.slip_bound,
                             .angle_bound = contact->options.angle_bound,
                             .unguarded   = ContactPairTies(pair),
                             .turns       = contact->options.balance};
  Vec             u[2]    = {NULL, NULL};
  PetscBool       rebuilt;
  PetscBool       inertia = PETSC_TRUE, linear = PETSC_TRUE;
  PetscMPIInt     other;

  PetscFunctionBegin;
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    inertia = (PetscBool)(inertia && !BodyDoes(contact->bodies[pair->body[side]], BodyIsStatic));
    linear  = (PetscBool)(linear && BodyDoes(contact->bodies[pair->body[side]], BodyIsLinear));
    if (!pair->obstacle) PetscCall(ContactGetBoundary(contact, pair->body[side], &options.boundaries[side]));
    if (contact->setup) PetscCall(BodyGetSolution(contact->bodies[pair->body[side]], &u[side], NULL, NULL));
  }
  pair->rests    = (PetscBool)!inertia;
  options.curved = IsCurved(contact, pair, inertia, linear);
  PetscCall(GetNormalShare(contact, pair, &options.share));
  PetscCall(BodyGetMeshRank(contact->bodies[pair->body[0]], &options.owner));
  other = options.owner;
  if (!pair->obstacle) PetscCall(BodyGetMeshRank(contact->bodies[pair->body[1]], &other));
  /* where one of several ranks has all of both surfaces it is the only one that looks at them */
  pair->owned   = (PetscBool)(contact->ranks.size > 1 && !contact->options.balance && options.owner >= 0 && options.owner == other);
  options.owned = pair->owned;
  PetscCall(ContactCheckBalance(contact, pair));
  PetscCall(TransferCreate(PetscObjectComm((PetscObject)contact), pair->surfaces[0], pair->surfaces[1], pair->obstacle, &options,
                           &pair->transfer));
  PetscCall(TransferUpdate(pair->transfer, u[0], u[1], contact->dim == 1 || pair->obstacle ? PETSC_MAX_REAL : 0, &rebuilt));
  PetscCall(GetPairNormal(contact, pair));
  PetscFunctionReturn(PETSC_SUCCESS);
}
