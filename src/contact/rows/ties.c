/*
   What is tied follows from where the bodies are at the start: mesh, placement and initial displacement. A node at most
   -contact_tie_distance from the partner is tied to it as it lies there, with the gap that it has. One that is farther away, but nearer
   than it would be to the next node, is neither clearly tied nor clearly apart: it is an error, as are surfaces that overlap and pairs
   that tie nothing.
*/
#include <contact/parts.h>
#include <sys/units.h>
#include <impakt/private/bodymesh.h>

/* Nodes farther from the partner than this belong to another part of the surface and are left alone [edges of the face]. A node that is
   nearer and yet not within the tie distance is an error. */
#define APART 0.5

/* What keeps a node that lies opposite to the partner from being tied */
typedef enum { TIE_HOLDS, TIE_OVERLAPS, TIE_TOO_FAR, TIE_APART } TieState;

/* Of one pair, on all ranks */
typedef struct {
  PetscInt  n[4];        /* nodes in each state */
  PetscReal gap[4];      /* the largest distance without sign in that state, of nodes apart the smallest [m] */
  PetscReal position[9]; /* reference positions of the nodes that overlap most, lie farthest, or are apart by least [m] */
  PetscReal size[3];     /* edges of the faces there [m] */
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

/* The worst node of a state on all ranks: its gap, position and face */
static PetscErrorCode FindWorst(Contact contact, PetscReal gap, const PetscReal mine[4], TieState state, TieSummary *summary)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)contact);
  struct {
    double value;
    int    rank;
  } worst;
  PetscMPIInt rank;
  PetscReal   all[4];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  worst.value = (double)(state == TIE_APART ? -gap : gap);
  worst.rank  = rank;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm));
  PetscCall(PetscArraycpy(all, mine, 4));
  PetscCallMPI(MPI_Bcast(all, 4, MPIU_REAL, worst.rank, comm));
  summary->gap[state] = PetscAbsReal((PetscReal)worst.value);
  PetscCall(PetscArraycpy(summary->position + 3 * (state - 1), all, 3));
  summary->size[state - 1] = all[3];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts the nodes of a pair in each state, and finds the worst ones */
static PetscErrorCode Summarize(Contact contact, const ContactPair *pair, TieSummary *summary)
{
  PetscReal          worst[4] = {0, -1, -1, PETSC_MAX_REAL}, places[4][4] = {{0}};
  const PetscScalar *x;
  TransferRows       rows;
  Vec                positions;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(summary, sizeof(*summary)));
  PetscCall(TransferGetRows(pair->transfer, &rows));
  PetscCall(BodyGetReferencePositions(contact->bodies[pair->body[0]], &positions));
  PetscCall(VecGetArrayRead(positions, &x));
  for (PetscInt node = 0; node < rows.n; node++) {
    const PetscInt  i   = pair->begin + node * pair->components;
    const PetscReal gap = contact->ties.distance[i], distance = PetscAbsReal(gap);
    PetscReal       size;
    TieState        state;

    if (!rows.opposite[node]) continue;
    PetscCall(GetFaceSize(contact, pair, &rows, node, &size));
    state = JudgeDistance(contact, gap, size);
    summary->n[state]++;
    if (state == TIE_APART ? distance >= worst[state] : distance <= worst[state]) continue;
    worst[state] = distance;
    for (PetscInt d = 0; d < contact->dim; d++) places[state][d] = PetscRealPart(x[contact->rows.dof[i] + d]);
    places[state][3] = size;
  }
  PetscCall(VecRestoreArrayRead(positions, &x));
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, summary->n, 4, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
  for (PetscInt state = TIE_OVERLAPS; state <= TIE_APART; state++)
    PetscCall(FindWorst(contact, worst[state], places[state], (TieState)state, summary));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What overlaps, or is neither tied nor apart, is an error that says where */
static PetscErrorCode CheckDistances(Contact contact, const ContactPair *pair, const TieSummary *summary)
{
  MPI_Comm    comm  = PetscObjectComm((PetscObject)contact);
  const char *first = ((PetscObject)contact->bodies[pair->body[0]])->name;
  char        moves[CONTACT_MOVES];

  PetscFunctionBegin;
  for (TieState state = TIE_OVERLAPS; state <= TIE_TOO_FAR; state = (TieState)(state + 1)) {
    const PetscReal *x = summary->position + 3 * (state - 1), gap = summary->gap[state], size = summary->size[state - 1];

    if (!summary->n[state]) continue;
    PetscCall(ContactDescribeMoves(contact, pair->body[0], moves));
    SETERRQ(comm, PETSC_ERR_USER_INPUT,
            "-contact_pairs %s: at the start %" PetscInt_FMT " of %" PetscInt_FMT " nodes of body '%s' opposite to the partner %s, and "
            "-contact_law %s ties surfaces that lie on each other: the worst, at (%g, %g, %g) before any displacement, %s by %g%s, which "
            "is %.3g of its face. Move one of the bodies (%s), name smaller surfaces in -contact_pairs, "
            "or set -contact_tie_distance, now %g of a face, above that number to tie them as they are",
            pair->name, summary->n[state],
            summary->n[TIE_HOLDS] + summary->n[TIE_OVERLAPS] + summary->n[TIE_TOO_FAR] + summary->n[TIE_APART], first,
            state == TIE_OVERLAPS ? "overlap it" : "have a gap to it", ContactNameLaw(contact, pair), (double)x[0], (double)x[1],
            (double)x[2], state == TIE_OVERLAPS ? "overlaps" : "is apart", (double)gap, UnitsOf((PetscObject)contact, UNIT_LENGTH),
            (double)(gap / size), moves, (double)contact->options.tie_distance);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Pairs that tie nothing: one that the user has named is an error, as is one of all possible pairs with a body that no pair ties. The pair
   with the smallest gap is told. */
static PetscErrorCode CheckNothingTied(Contact contact, const PetscInt tied[], const TieSummary summaries[])
{
  PetscInt nearest = -1;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair     = &contact->pairs[p];
    const PetscBool    expected = (PetscBool)(!pair->chosen || !tied[pair->body[0]] || (!pair->obstacle && !tied[pair->body[1]]));

    if (!ContactPairTies(pair) || summaries[p].n[TIE_HOLDS] || !expected) continue;
    if (nearest < 0 || summaries[p].gap[TIE_APART] < summaries[nearest].gap[TIE_APART]) nearest = p;
  }
  if (nearest >= 0) {
    const ContactPair *pair    = &contact->pairs[nearest];
    const TieSummary  *summary = &summaries[nearest];
    const PetscReal   *x       = summary->position + 3 * (TIE_APART - 1);
    char               moves[CONTACT_MOVES];

    PetscCall(ContactDescribeMoves(contact, pair->body[0], moves));
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
            (double)x[2], (double)summary->gap[TIE_APART], UnitsOf((PetscObject)contact, UNIT_LENGTH),
            (double)(summary->gap[TIE_APART] / summary->size[TIE_APART - 1]), (double)contact->options.tie_distance, moves);
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
