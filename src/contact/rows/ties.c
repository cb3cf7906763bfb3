/* What is tied follows from where the bodies are at the start: mesh, placement and initial displacement. A node at most
   -contact_tie_distance from the partner is tied to it as it lies there, with the gap that it has. One farther away, but nearer than the
   next node, is not clearly tied or apart: an error, as are surfaces that overlap and pairs that tie nothing. */
#include <contact/parts.h>
#include <sys/units.h>
#include <impakt/private/bodymesh.h>

/* Nodes farther from the partner than this are left alone [edges of the face]; nearer ones beyond the tie distance are errors. */
#define APART 0.5

/* What keeps a node that lies opposite to the partner from being tied */
typedef enum { TIE_HOLDS, TIE_OVERLAPS, TIE_TOO_FAR, TIE_APART } TieState;

/* Of the nodes in a state that which overlaps most, is too far by most, or, of those apart, is the nearest */
typedef struct {
  double    bad;             /* by how much [m] */
  PetscReal x[3], gap, size; /* its reference position, its gap without sign, and the edge of its face [m] */
} TieNode;

typedef struct {
  PetscInt n[4];  /* nodes in each state */
  TieState state; /* that is told of: the first that there is of TIE_OVERLAPS, TIE_TOO_FAR and TIE_APART */
  TieNode  worst; /* in that state; with an infinite gap if there is none */
} TieSummary;

/* Edge of the elements at the contact point of a body in one dimension [m]; of others the transfer knows the faces */
static PetscErrorCode GetFaceSize(Contact contact, const ContactPair *pair, const TransferRows *rows, PetscInt node, PetscReal *size)
{
  PetscFunctionBegin;
  if (contact->dim == 1) PetscCall(BodyGetScale(contact->bodies[pair->body[0]], BODY_ELEMENT_SIZE, size));
  else *size = rows->size[node];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static TieState JudgeDistance(Contact contact, PetscReal gap, PetscReal size)
{
  if (PetscAbsReal(gap) <= contact->options.tie_distance * size) return TIE_HOLDS;
  if (gap < 0) return TIE_OVERLAPS;
  return gap <= APART * size ? TIE_TOO_FAR : TIE_APART;
}

/* Which nodes of a pair are tied, with its surfaces where they are now. `changed` becomes true if any is that was not, or is no more. */
PetscErrorCode ContactMeasureTies(Contact contact, const ContactPair *pair, PetscBool *changed)
{
  TransferRows rows;
  PetscReal   *gaps;

  PetscFunctionBegin;
  if (!ContactPairTies(pair)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TransferGetRows(pair->transfer, &rows));
  PetscCall(PetscMalloc1(rows.n, &gaps));
  PetscCall(TransferGetGaps(pair->transfer, gaps));
  for (PetscInt node = 0; node < rows.n; node++) {
    PetscReal size;
    PetscBool tied;

    PetscCall(GetFaceSize(contact, pair, &rows, node, &size));
    tied = (PetscBool)(rows.opposite[node] && JudgeDistance(contact, gaps[node], size) == TIE_HOLDS);
    for (PetscInt k = 0; k < pair->components; k++) {
      const PetscInt i = pair->begin + node * pair->components + k;

      if (contact->ties.holds[i] != tied) *changed = PETSC_TRUE;
      contact->ties.holds[i]    = tied;
      contact->ties.distance[i] = gaps[node];
    }
  }
  PetscCall(PetscFree(gaps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts the nodes of a pair in each state, and finds the worst one */
static PetscErrorCode Summarize(Contact contact, const ContactPair *pair, TieSummary *summary)
{
  struct {
    double value;
    int    rank;
  } worst = {0, contact->ranks.rank};
  TieNode            nodes[4]; /* the worst in each state on this rank */
  const SurfaceData *data;
  TransferRows       rows;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(summary, sizeof(*summary)));
  for (PetscInt state = 0; state < 4; state++) nodes[state] = (TieNode){.bad = -PETSC_MAX_REAL, .gap = PETSC_MAX_REAL};
  PetscCall(TransferGetRows(pair->transfer, &rows));
  PetscCall(SurfaceGetData(pair->surfaces[0], &data));
  for (PetscInt node = 0; node < rows.n; node++) {
    const PetscInt i   = pair->begin + node * pair->components;
    TieNode        own = {.gap = PetscAbsReal(contact->ties.distance[i])};
    TieState       state;

    if (!rows.opposite[node]) continue;
    PetscCall(GetFaceSize(contact, pair, &rows, node, &own.size));
    PetscCall(PetscArraycpy(own.x, data->reference + 3 * node, 3));
    state   = JudgeDistance(contact, contact->ties.distance[i], own.size);
    own.bad = state == TIE_APART ? -own.gap : own.gap;
    if (own.bad > nodes[state].bad) nodes[state] = own;
    summary->n[state]++;
  }
  PetscCall(ContactReduce(contact, 4, MPIU_INT, MPI_SUM, summary->n));
  summary->state = summary->n[TIE_OVERLAPS] ? TIE_OVERLAPS : summary->n[TIE_TOO_FAR] ? TIE_TOO_FAR : TIE_APART;
  summary->worst = nodes[summary->state];
  worst.value    = summary->worst.bad;
  PetscCall(ContactReduce(contact, 1, MPI_DOUBLE_INT, MPI_MAXLOC, &worst));
  PetscCallMPI(MPI_Bcast(&summary->worst, sizeof(summary->worst), MPI_BYTE, worst.rank, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What overlaps, or is neither tied nor apart, is an error that says where */
static PetscErrorCode CheckDistances(Contact contact, const ContactPair *pair, const TieSummary *summary)
{
  const TieState   state = summary->state;
  const PetscReal *x = summary->worst.x, gap = summary->worst.gap, size = summary->worst.size;
  char             moves[CONTACT_MOVES];

  PetscFunctionBegin;
  if (state == TIE_APART) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactDescribeMoves(contact, pair->body[0], moves, NULL));
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
          "-contact_pairs %s: at the start %" PetscInt_FMT " of %" PetscInt_FMT " nodes of body '%s' opposite to the partner %s, and "
          "-contact_law %s ties surfaces that lie on each other: the worst, at (%g, %g, %g) before any displacement, %s by %g%s, which "
          "is %.3g of its face. Move one of the bodies (%s), name smaller surfaces in -contact_pairs, "
          "or set -contact_tie_distance, now %g of a face, above that number to tie them as they are",
          pair->name, summary->n[state], summary->n[TIE_HOLDS] + summary->n[TIE_OVERLAPS] + summary->n[TIE_TOO_FAR] + summary->n[TIE_APART],
          ((PetscObject)contact->bodies[pair->body[0]])->name, state == TIE_OVERLAPS ? "overlap it" : "have a gap to it",
          ContactNameLaw(contact, pair), (double)x[0], (double)x[1], (double)x[2], state == TIE_OVERLAPS ? "overlaps" : "is apart",
          (double)gap, UnitsOf((PetscObject)contact, UNIT_LENGTH), (double)(gap / size), moves, (double)contact->options.tie_distance);
}

/* Pairs that tie nothing are an error if named, or of a body that no pair ties. The pair with the smallest gap is told. */
static PetscErrorCode CheckNothingTied(Contact contact, const PetscInt tied[], const TieSummary summaries[])
{
  PetscInt nearest = -1;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair     = &contact->pairs[p];
    const PetscBool    expected = (PetscBool)(!pair->chosen || !tied[pair->body[0]] || (!pair->obstacle && !tied[pair->body[1]]));

    if (!ContactPairTies(pair) || summaries[p].n[TIE_HOLDS] || !expected) continue;
    if (nearest < 0 || summaries[p].worst.gap < summaries[nearest].worst.gap) nearest = p;
  }
  if (nearest >= 0) {
    const ContactPair *pair    = &contact->pairs[nearest];
    const TieSummary  *summary = &summaries[nearest];
    const PetscReal   *x       = summary->worst.x;
    char               moves[CONTACT_MOVES];

    PetscCall(ContactDescribeMoves(contact, pair->body[0], moves, NULL));
    PetscCheck(summary->n[TIE_APART], PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_pairs %s: -contact_law %s ties nothing, since at the start no node of body '%s' lies opposite to the partner; "
               "place the bodies so that their surfaces lie on each other, or leave the pair out of -contact_pairs",
               pair->name, ContactNameLaw(contact, pair), ((PetscObject)contact->bodies[pair->body[0]])->name);
    SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
            "-contact_pairs %s: -contact_law %s ties nothing: at the start the node of body '%s' that is nearest to the partner, at "
            "(%g, %g, %g) before any displacement, has a gap of %g%s, which is %.3g of its face, and nodes are tied within "
            "-contact_tie_distance, now %g of a face; move one of the bodies (%s), or leave the pair out "
            "of -contact_pairs",
            pair->name, ContactNameLaw(contact, pair), ((PetscObject)contact->bodies[pair->body[0]])->name, (double)x[0], (double)x[1],
            (double)x[2], (double)summary->worst.gap, UnitsOf((PetscObject)contact, UNIT_LENGTH),
            (double)(summary->worst.gap / summary->worst.size), (double)contact->options.tie_distance, moves);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactCheckTies(Contact contact)
{
  TieSummary *summaries;
  PetscInt   *tied; /* per body, and for obstacles: its nodes that are tied, and those of others that are tied to it */

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(contact->n_pairs, &summaries));
  PetscCall(PetscCalloc1(contact->n_bodies + 1, &tied));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (!ContactPairTies(pair)) continue;
    PetscCall(Summarize(contact, pair, &summaries[p]));
    for (PetscInt side = 0; side < 2; side++) tied[pair->body[side]] += summaries[p].n[TIE_HOLDS];
    PetscCall(CheckDistances(contact, pair, &summaries[p]));
  }
  PetscCall(CheckNothingTied(contact, tied, summaries));
  PetscCall(PetscFree(tied));
  PetscCall(PetscFree(summaries));
  PetscFunctionReturn(PETSC_SUCCESS);
}
