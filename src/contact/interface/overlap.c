/* Bodies that are inside each other, or inside obstacles. */
#include <contact/parts.h>
#include <sys/units.h>
#include <impakt/private/bodymesh.h>

/* Rows at the start are at most this deep where bodies have the state of another run, in contact there [parts of a contact element] */
#define INSIDE 0.02
/* Bodies that overlap by more do not start, whatever the gaps of their rows are [parts of an element]. Two circles of four edges each that
   touch all round overlap by 0.2. A run warns of smaller overlaps at its end. */
#define NO_START 0.25

/* The size of the elements with a contact node of the finer one of two bodies, the second of which may be an obstacle [m] */
PetscErrorCode ContactGetLeastElement(Contact contact, const PetscInt body[2], PetscReal *least)
{
  PetscFunctionBegin;
  *least = PETSC_MAX_REAL;
  for (PetscInt side = 0; side < 2 && body[side] < contact->n_bodies; side++) {
    PetscReal size;

    PetscCall(BodyGetScale(contact->bodies[body[side]], BODY_CONTACT_ELEMENT_SIZE, &size));
    *least = PetscMin(*least, size);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that start no deeper than the bow of their partner's faces makes of surfaces which only touch, as two rounds whose poles meet, start
   closed: the depth is added to their gap until they have been open, so that it is no blow in the first step. Bodies with the state of
   another run (`of_state`) may have touched by other rows there: their depth is allowed too. */
PetscErrorCode ContactLetTouch(Contact contact, PetscBool of_state)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    TransferRows       rows;
    PetscReal          least;

    if (pair->obstacle || ContactPairTies(pair)) continue;
    PetscCall(TransferGetRows(pair->transfer, &rows));
    PetscCall(ContactGetLeastElement(contact, pair->body, &least));
    for (PetscInt i = pair->begin; i < pair->end; i += pair->components) {
      const PetscReal depth = -contact->start.gap[i], bow = rows.bow[(i - pair->begin) / pair->components];

      if (!contact->rows.opposite[i] || depth <= 0 || depth > (of_state ? PetscMax(bow, INSIDE * least) : bow)) continue;
      contact->rows.gap_shift[i] += depth;
      contact->rows.initial_gap[i] += depth;
      contact->end.gap[i] = contact->start.gap[i] = 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a body may touch another one of a higher number, or an obstacle, which is counted after all bodies; and whether pairs tie them:
   of those that are no pair, whether all pairs tie */
static PetscBool MayTouch(Contact contact, PetscInt body, PetscInt other, PetscBool *tied)
{
  PetscBool touch = contact->neighbours.come_and_go, tie = PETSC_FALSE;

  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair    = &contact->pairs[p];
    const PetscInt     partner = ContactPairPartner(contact, pair);

    if (PetscMin(pair->body[0], partner) != body || PetscMax(pair->body[0], partner) != other) continue;
    touch = PETSC_TRUE;
    tie   = (PetscBool)(tie || ContactPairTies(pair));
  }
  *tied = touch ? tie : ContactAllPairsTie(contact);
  return touch;
}

/* The whole boundary of a body, not moved */
PetscErrorCode ContactGetBoundary(Contact contact, PetscInt body, Surface *boundary)
{
  Surface *own = &contact->overlaps.boundaries[body];

  PetscFunctionBegin;
  if (!*own) PetscCall(ContactCreateSurface(contact, body, NULL, own));
  *boundary = *own;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How deep each body is in any other, and in any obstacle, where they are now; the body with the lower number comes first */
static PetscErrorCode FindDepths(Contact contact, PetscInt *n, SurfaceDepth *depths[])
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Surface boundary = NULL;
    Vec     u;

    PetscCall(ContactGetBoundary(contact, b, &boundary));
    PetscCall(BodyGetSolution(contact->bodies[b], &u, NULL, NULL));
    PetscCall(SurfaceUpdate(boundary, u));
  }
  PetscCall(SurfacesFindDepths(PetscObjectComm((PetscObject)contact), contact->n_bodies, contact->overlaps.boundaries, contact->n_obstacles,
                               contact->obstacles, n, depths));
  for (PetscInt i = 0; i < *n; i++) {
    SurfaceDepth *depth = &(*depths)[i];

    PetscCall(PetscSortInt(2, depth->surfaces));
    if (contact->dim == 1 && depth->depth > 0)
      PetscCall(ContactGetLeastElement(contact, depth->surfaces, &depth->size)); /* faces are points */
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RefuseOverlap(Contact contact, const SurfaceDepth *overlap)
{
  const PetscInt *of = overlap->surfaces;
  char            moves[2][CONTACT_MOVES], nodes[2][CONTACT_MOVES];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) PetscCall(ContactDescribeMoves(contact, of[k], moves[k], nodes[k]));
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
          "Bodies '%s' and '%s' overlap by %g%s at the start, at (%g, %g, %g); move one of them: %s, or %s%s%s",
          ((PetscObject)contact->bodies[of[0]])->name, ((PetscObject)contact->bodies[of[1]])->name, (double)overlap->depth,
          UnitsOf((PetscObject)contact, UNIT_LENGTH), (double)overlap->x[0], (double)overlap->x[1], (double)overlap->x[2], moves[0],
          moves[1], nodes[0], nodes[1]);
}

static const SurfaceDepth *FindDeepest(const ContactPair *pair, PetscInt n, const SurfaceDepth depths[])
{
  const PetscInt      first = PetscMin(pair->body[0], pair->body[1]), second = PetscMax(pair->body[0], pair->body[1]);
  const SurfaceDepth *deepest = NULL;

  for (PetscInt i = 0; i < n; i++)
    if (depths[i].surfaces[0] == first && depths[i].surfaces[1] == second && (!deepest || depths[i].depth > deepest->depth))
      deepest = &depths[i];
  return deepest;
}

/* Ends with an error if a pair overlaps at the start: by more than the tolerance, both by its rows, whose partners may be faces on the far
   sides of the bodies, and by its surfaces; or by more than NO_START by its surfaces alone */
static PetscErrorCode RefuseOverlaps(Contact contact, PetscBool of_state, PetscInt n, const SurfaceDepth depths[])
{
  const SurfaceDepth *refused = NULL;
  const ContactPair  *inside  = NULL;
  PetscReal           depth   = 0;
  ContactPairState   *states  = contact->resultants.states;

  PetscFunctionBegin;
  PetscCall(ContactComputePairStates(contact, states));
  for (PetscInt p = 0; p < contact->n_pairs && !inside && !refused; p++) {
    const ContactPair  *pair    = &contact->pairs[p];
    const SurfaceDepth *deepest = pair->obstacle ? NULL : FindDeepest(pair, n, depths);

    if (!(states[p].gap < -contact->options.tolerance)) continue;
    if (pair->obstacle) inside = pair;
    else if (deepest && deepest->depth > contact->options.tolerance) refused = deepest;
    depth = -states[p].gap;
  }
  for (PetscInt i = 0; i < n && !refused && !of_state; i++) {
    const PetscInt *of = depths[i].surfaces;
    PetscBool       tied;

    if (!MayTouch(contact, of[0], of[1], &tied) || tied || of[1] >= contact->n_bodies) continue;
    if (depths[i].depth > NO_START * depths[i].size) refused = &depths[i];
  }
  if (inside) PetscCall(ContactRefuseInside(contact, inside, depth));
  if (refused) PetscCall(RefuseOverlap(contact, refused));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses bodies that overlap at the start. Overlaps of tied bodies count later by their growth, those of bodies that are no pair never */
PetscErrorCode ContactStartOverlaps(Contact contact, PetscBool of_state)
{
  ContactOverlaps *overlaps = &contact->overlaps;
  SurfaceDepth    *depths;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(PetscFree(overlaps->allowed));
  overlaps->n_allowed = 0;
  PetscCall(FindDepths(contact, &n, &depths));
  overlaps->allowed = depths; /* freed with contact, also after an error */
  PetscCall(RefuseOverlaps(contact, of_state, n, depths));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt *of = depths[i].surfaces;
    PetscBool       tied, touch = MayTouch(contact, of[0], of[1], &tied);

    if (depths[i].depth == 0) continue;
    if (!tied && (depths[i].depth <= CONTACT_OVERLAP * depths[i].size || (touch && of[1] < contact->n_bodies))) continue;
    if (!tied || !touch) depths[i].depth = PETSC_MAX_REAL;
    depths[overlaps->n_allowed++] = depths[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How deep bodies are inside each other and inside obstacles now, anywhere on their surfaces: for each body the deepest overlap, in parts
   of an element, with a body of a higher number, or an obstacle. Left out are obstacles that are no pair of the body, and bodies that are
   no pair and overlap at the start; of tied bodies what is more than at the start counts. Collective. */
PetscErrorCode ContactGetOverlaps(Contact contact, ContactOverlap overlaps[])
{
  SurfaceDepth *depths;
  PetscInt      n;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(overlaps, 2);
  for (PetscInt b = 0; b < contact->n_bodies; b++) overlaps[b] = (ContactOverlap){.other = -1};
  if (!contact->n_pairs && !contact->neighbours.come_and_go) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FindDepths(contact, &n, &depths));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt *of      = depths[i].surfaces;
    ContactOverlap *overlap = &overlaps[of[0]];
    PetscReal       depth   = depths[i].depth;
    PetscBool       pair, tied;

    for (PetscInt k = 0; k < contact->overlaps.n_allowed; k++) {
      const SurfaceDepth *allowed = &contact->overlaps.allowed[k];

      if (allowed->surfaces[0] == of[0] && allowed->surfaces[1] == of[1]) depth = PetscMin(depth, depths[i].depth - allowed->depth);
    }
    if (depth <= PetscMax(overlap->part * depths[i].size, contact->options.tolerance)) continue;
    pair = MayTouch(contact, of[0], of[1], &tied);
    if (!pair && of[1] >= contact->n_bodies) continue; /* planes go on where no body is meant to touch them */
    overlap->other = of[1];
    overlap->depth = depths[i].depth;
    overlap->part  = depth / depths[i].size;
    overlap->pair  = pair;
    PetscCall(PetscArraycpy(overlap->x, depths[i].x, 3));
  }
  PetscCall(PetscFree(depths));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Name of the other body, or of the obstacle, of an overlap; `NULL` where nothing overlaps */
PetscErrorCode ContactGetOverlapName(Contact contact, const ContactOverlap *overlap, const char *name[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(overlap, 2);
  PetscAssertPointer(name, 3);
  if (overlap->other >= contact->n_bodies)
    PetscCall(PetscObjectGetName((PetscObject)contact->obstacles[overlap->other - contact->n_bodies], name));
  else *name = overlap->other < 0 ? NULL : ((PetscObject)contact->bodies[overlap->other])->name;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyOverlaps(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && contact->overlaps.boundaries; b++)
    PetscCall(SurfaceDestroy(&contact->overlaps.boundaries[b]));
  PetscCall(PetscFree(contact->overlaps.boundaries));
  PetscCall(PetscFree(contact->overlaps.allowed));
  PetscFunctionReturn(PETSC_SUCCESS);
}
