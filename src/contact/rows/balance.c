/* Whether forces have the same sum along the normals of both sides, -contact_balance, as they should without friction. Where few nodes are
   in contact the centre of pressure hangs on where these lie, which spins bodies that hit each other off-centre: discs of 64 edges by up to
   0.05 of the ratio of speed and radius, balls by 0.1; with this option by at most 4e-4 and 2e-3, at a fifth more time. Where two nodes
   bear all it helps less, as normals of rows are half way between those of both sides up to 10 degrees alone: balls of 40 edges spin by
   0.003 at 2 m/s, 0.023 at 0.04 m/s.

   There is one condition for each pair in two dimensions, two in three, where the bends of both surfaces count and nodes have the normals
   of round surfaces, see SurfaceSetRound(). It is for rows that follow the surfaces, frictionless pairs of bodies with inertia that are not
   both linear, with CONTACT_SCHWARZ and massless contact nodes; else an error. A pair should touch in one place, faces bend by 11.5 degrees
   at most, and one body be free: what turns of gaps between led bodies bring or take is not limited. With auto, the default, forces are
   balanced where all that holds, and all pairs are of bodies whose surfaces are round without edges. */
#include <contact/parts.h>
#include <impakt/private/bodymesh.h>

/* Chords of angles between the normals of two nodes of a face: from 18 degrees on the face is beside an edge; faces that bend by more than
   11.5 degrees are too coarse: discs of 32 edges keep half of their spin or more */
#define EDGE   0.31
#define COARSE 0.2
/* Surfaces without a face that bends by more are flat, and need no balance */
#define FLAT 1e-3
/* Pairs whose gaps are turned unasked, at most: the turns of all are unknowns of one dense matrix */
#define MOST_PAIRS 100
#define WHY        256 /* length of a text that says why gaps of a pair are not turned */

/* The largest bend of a face of one side of a pair, as a chord, without those that are `edge` or more */
static PetscErrorCode GetBend(Contact contact, const ContactPair *pair, PetscInt side, PetscReal edge, PetscReal *bend)
{
  const SurfaceData *data;

  PetscFunctionBegin;
  *bend = 0;
  PetscCall(SurfaceGetData(pair->surfaces[side], &data));
  for (PetscInt f = 0; f < data->n_faces; f++)
    for (PetscInt k = 0; k < data->face_nodes; k++) {
      const PetscReal *a      = data->normals + 3 * data->faces[data->face_nodes * f + k];
      const PetscReal *b      = data->normals + 3 * data->faces[data->face_nodes * f + (k + 1) % data->face_nodes];
      PetscReal        square = 0;

      for (PetscInt d = 0; d < contact->dim; d++) square += PetscSqr(a[d] - b[d]);
      if (square < PetscSqr(edge)) *bend = PetscMax(*bend, PetscSqrtReal(square));
    }
  PetscCall(ContactReduce(contact, 1, MPIU_REAL, MPIU_MAX, bend));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode IsHeld(Contact contact, PetscInt b, PetscBool *held)
{
  const PetscInt *dofs;
  PetscInt        n;

  PetscFunctionBegin;
  PetscCall(BodyGetHeldDofs(contact->bodies[b], &n, &dofs));
  PetscCall(BodyGetLed(contact->bodies[b], held, NULL));
  if (n > 0) *held = PETSC_TRUE;
  PetscCall(ContactOr(contact, held));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Why gaps of a pair cannot be turned, or are not to be `unasked`; empty: they can. Unasked they are not where faces are flat or beside
   edges, nor where both bodies are held: they cannot spin, and turns that nothing answers have brought energy. */
static PetscErrorCode Judge(Contact contact, const ContactPair *pair, PetscBool unasked, char why[], size_t size)
{
  PetscBool linear = PETSC_TRUE, both_held = PETSC_TRUE;

  PetscFunctionBegin;
  why[0] = 0;
  if (contact->dim == 1 || pair->obstacle || pair->law != CONTACT_LAW_FRICTIONLESS)
    PetscCall(PetscStrncpy(why, "is not a frictionless one of two bodies in two or three dimensions", size));
  else if (BodyDoes(contact->bodies[pair->body[0]], BodyGetAxisymmetric))
    PetscCall(PetscStrncpy(why, "is axisymmetric, so that moments of contact forces are in balance all around; leave it out", size));
  else if (!contact->ops->maybalance || !(*contact->ops->maybalance)(contact))
    PetscCall(PetscStrncpy(why, "needs -contact_type schwarz and massless contact nodes (-<body>_mass_redistribute true)", size));
  for (PetscInt side = 0; side < 2 && !why[0]; side++) {
    const char *name = ((PetscObject)contact->bodies[pair->body[side]])->name;
    PetscReal   bend;
    PetscBool   held;

    PetscCall(GetBend(contact, pair, side, unasked ? PETSC_MAX_REAL : EDGE, &bend));
    PetscCall(IsHeld(contact, pair->body[side], &held));
    linear    = (PetscBool)(linear && BodyDoes(contact->bodies[pair->body[side]], BodyIsLinear));
    both_held = (PetscBool)(both_held && held);
    if (BodyDoes(contact->bodies[pair->body[side]], BodyIsStatic))
      PetscCall(PetscSNPrintf(why, size, "has a body without inertia, '%s'", name));
    else if (bend > COARSE)
      PetscCall(PetscSNPrintf(why, size,
                              "has faces of body '%s' that bend by up to %.3g degrees; refine its surface until that is 11.5 or less", name,
                              (double)(bend * 180 / PETSC_PI)));
    else if (unasked && bend < FLAT) PetscCall(PetscStrncpy(why, "is flat", size));
  }
  if (!why[0] && linear)
    PetscCall(PetscStrncpy(why, "has bodies that are both linear elastic, and its rows do not follow the surfaces", size));
  if (!why[0] && unasked && both_held) PetscCall(PetscStrncpy(why, "has bodies that are both held", size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether gaps are turned where neither the user nor the program has said so. Surfaces are known, but not how they are to be moved. */
PetscErrorCode ContactChooseBalance(Contact contact)
{
  PetscBool suits = PETSC_TRUE;
  char      why[WHY];

  PetscFunctionBegin;
  if (!contact->options.auto_balance) PetscFunctionReturn(PETSC_SUCCESS);
  contact->options.balance = PETSC_FALSE;
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP || contact->options.stabilization != CONTACT_STABILIZATION_NONE ||
      !contact->options.shared_times || contact->neighbours.come_and_go || !contact->n_pairs || contact->n_pairs > MOST_PAIRS)
    PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs && suits; p++) {
    PetscCall(Judge(contact, &contact->pairs[p], PETSC_TRUE, why, sizeof(why)));
    suits = (PetscBool)!why[0];
  }
  if (!suits) PetscFunctionReturn(PETSC_SUCCESS);
  contact->options.balance = PETSC_TRUE;
  for (PetscInt s = 0; s < contact->n_surfaces; s++) {
    PetscCall(SurfaceSetRound(contact->surfaces[s].surface, (PetscBool)(contact->dim == 3)));
    PetscCall(SurfaceUpdate(contact->surfaces[s].surface, NULL));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error where gaps of a pair are to be turned and cannot be */
PetscErrorCode ContactCheckBalance(Contact contact, const ContactPair *pair)
{
  char why[WHY];

  PetscFunctionBegin;
  if (!contact->options.balance) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Judge(contact, pair, PETSC_FALSE, why, sizeof(why)));
  PetscCheck(!why[0], PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_balance: pair %s %s", pair->name, why);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stiffness of both bodies of a pair against a force on a node [N/m]: in two dimensions their modulus times the thickness, in three
   times the edge of an element. `edge` becomes the larger edge [m]. */
static PetscErrorCode GetStiffness(Contact contact, const ContactPair *pair, PetscReal *stiffness, PetscReal *edge)
{
  PetscReal softness = 0;

  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) {
    PetscReal of_element, size, thickness;

    PetscCall(BodyGetScale(contact->bodies[pair->body[side]], BODY_ELEMENT_STIFFNESS, &of_element));
    PetscCall(BodyGetScale(contact->bodies[pair->body[side]], BODY_ELEMENT_SIZE, &size));
    PetscCall(BodyGetScale(contact->bodies[pair->body[side]], BODY_CROSS_SECTION, &thickness));
    *edge = PetscMax(*edge, size);
    if (!BodyDoes(contact->bodies[pair->body[side]], BodyIsRigid))
      softness += 1 / (of_element * size * (contact->dim == 2 ? thickness : size));
  }
  *stiffness = 1 / softness;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for the turns of all pairs, once their rows are known */
PetscErrorCode ContactSetUpTurns(Contact contact)
{
  ContactTurns *turns = &contact->turns;

  PetscFunctionBegin;
  PetscCall(PetscCalloc3(contact->n_pairs + 1, &turns->begin, contact->n_pairs, &turns->stiffness, contact->n_pairs, &turns->edge));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscInt n;

    PetscCall(TransferGetTurns(contact->pairs[p].transfer, &n, NULL, NULL, NULL));
    turns->begin[p + 1] = turns->begin[p] + n;
    if (n) PetscCall(GetStiffness(contact, &contact->pairs[p], &turns->stiffness[p], &turns->edge[p]));
  }
  turns->n = turns->begin[contact->n_pairs];
  PetscCall(PetscCalloc2(turns->n, &turns->change, contact->rows.n, &turns->turned));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyTurns(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(contact->turns.begin, contact->turns.stiffness, contact->turns.edge));
  PetscCall(PetscFree2(contact->turns.change, contact->turns.turned));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much gaps are turned in the controller step; NULL: not at all */
PetscErrorCode ContactTurn(Contact contact, const PetscReal change[])
{
  ContactTurns *turns = &contact->turns;

  PetscFunctionBegin;
  for (PetscInt t = 0; t < turns->n; t++) turns->change[t] = change ? change[t] : 0;
  for (PetscInt p = 0; p < contact->n_pairs && turns->n; p++) {
    const PetscReal *lever;
    PetscInt         n;

    PetscCall(TransferGetTurns(contact->pairs[p].transfer, &n, NULL, &lever, NULL));
    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end && n; i++) {
      turns->turned[i] = 0;
      for (PetscInt k = 0; k < n; k++)
        turns->turned[i] += turns->change[turns->begin[p] + k] * lever[n * (i - contact->pairs[p].begin) + k];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The turns of the step that has been accepted stay */
PetscErrorCode ContactAcceptTurns(Contact contact)
{
  ContactTurns *turns = &contact->turns;

  PetscFunctionBegin;
  if (!turns->n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (turns->begin[p + 1] > turns->begin[p]) PetscCall(TransferTurn(contact->pairs[p].transfer, turns->change + turns->begin[p]));
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->rows.initial_gap[i] += turns->turned[i];
  PetscCall(ContactTurn(contact, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
