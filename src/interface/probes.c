/* Points ask for the closest faces of another surface, and edges for where they cross it: ranks ask those that may have these faces. */
#include "probes.h"

/* How much farther a rank looks for a face than there must be one, relative: covers round-off */
#define FARTHER 1e-6

PetscErrorCode ProbesAdd(Probes *probes, const Probe *probe, PetscMPIInt to)
{
  PetscFunctionBegin;
  if (probes->n == probes->max) {
    probes->max = 2 * probes->max + 64;
    PetscCall(PetscRealloc((size_t)probes->max * sizeof(*probes->list), &probes->list));
    PetscCall(PetscRealloc((size_t)probes->max * sizeof(*probes->to), &probes->to));
  }
  probes->to[probes->n]     = to;
  probes->list[probes->n++] = *probe;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ProbesDestroy(Probes *probes)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(probes->list));
  PetscCall(PetscFree(probes->to));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The tree of the faces that this rank has of a surface */
static PetscErrorCode GetTree(ProbeSearch *search, PetscInt s, Tree **tree)
{
  const Surface surface = search->surfaces[s];

  PetscFunctionBegin;
  if (!search->faces[s]) {
    PetscCall(PetscCalloc1(surface->data.n_faces, &search->faces[s]));
    for (PetscInt f = 0; f < surface->data.n_faces; f++) SurfaceGetFace(surface, f, &search->faces[s][f]);
    PetscCall(TreeCreate(surface->data.face_nodes, surface->data.n_faces, search->faces[s], &search->trees[s]));
  }
  *tree = &search->trees[s];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Answers with the places at which an edge crosses faces of this rank */
static PetscErrorCode AnswerEdge(ProbeSearch *search, const Probe *edge, Probes *answers)
{
  static const Frame axes   = {.normal = {0, 0, 1}, .tangents = {{1, 0, 0}, {0, 1, 0}}};
  const PetscInt     s      = search->pairs[edge->pair].surfaces[1];
  Probe              answer = *edge;
  PetscReal          box[6], upper[3];
  Tree              *tree = NULL;
  PetscInt           n;
  const PetscInt    *found;

  PetscFunctionBegin;
  PetscCall(GetTree(search, s, &tree));
  BoxFind(2, edge->x[0], box);
  for (PetscInt d = 0; d < 3; d++) upper[d] = -box[3 + d];
  PetscCall(TreeQuery(tree, &axes, box, upper, &n, &found));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal      at[2];
    const PetscInt count = FaceFindCrossings(search->surfaces[s]->data.face_nodes, &search->faces[s][found[i]], edge->x[0], edge->x[1], at);

    for (PetscInt k = 0; k < count; k++) {
      answer.at = at[k];
      PetscCall(ProbesAdd(answers, &answer, edge->rank));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Answers with the closest face of this rank, if it is as close as a face must be */
static PetscErrorCode AnswerPoint(ProbeSearch *search, const Probe *point, Probes *answers)
{
  const PetscInt s      = search->pairs[point->pair].surfaces[1];
  Probe          answer = *point;
  Tree          *tree   = NULL;

  PetscFunctionBegin;
  PetscCall(GetTree(search, s, &tree));
  TreeFindClosest(tree, search->surfaces[s]->data.face_nodes, search->faces[s], point->x[0], &answer.closest);
  if (answer.closest.size > 0) PetscCall(ProbesAdd(answers, &answer, point->rank));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sends the questions of all ranks, and the answers back. Free these with PetscFree(). */
static PetscErrorCode Exchange(ProbeSearch *search, Probes *questions, PetscErrorCode (*answer)(ProbeSearch *, const Probe *, Probes *),
                               PetscInt *n, Probe *answered[])
{
  Probes   answers = {0};
  PetscInt n_asked;
  Probe   *asked;

  PetscFunctionBegin;
  PetscCall(ExchangeRecords(search->comm, sizeof(Probe), questions->n, questions->to, questions->list, &n_asked, (void **)&asked));
  for (PetscInt i = 0; i < n_asked; i++) PetscCall(answer(search, &asked[i], &answers));
  PetscCall(ExchangeRecords(search->comm, sizeof(Probe), answers.n, answers.to, answers.list, n, (void **)answered));
  PetscCall(PetscFree(asked));
  PetscCall(ProbesDestroy(&answers));
  PetscCall(ProbesDestroy(questions));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int CompareCrossings(const void *a, const void *b, void *context)
{
  const Probe *left = (const Probe *)a, *right = (const Probe *)b;

  (void)context;
  if (left->source != right->source) return left->source < right->source ? -1 : 1;
  return left->at < right->at ? -1 : left->at > right->at;
}

/* Where edges cross the second surfaces of their pairs, along one edge after the other. Free with PetscFree(). */
PetscErrorCode ProbesFindCrossings(ProbeSearch *search, const Probes *edges, PetscInt *n, Probe *crossings[])
{
  Probes questions = {0};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < edges->n; i++) {
    Probe     edge = edges->list[i];
    PetscReal box[6];

    edge.rank   = search->rank;
    edge.source = i;
    BoxFind(2, edge.x[0], box);
    for (PetscMPIInt r = 0; r < search->n_ranks; r++)
      if (BoxesMeet(box, search->boxes + 6 * (search->n * r + search->pairs[edge.pair].surfaces[1])))
        PetscCall(ProbesAdd(&questions, &edge, r));
  }
  PetscCall(Exchange(search, &questions, AnswerEdge, n, crossings));
  if (*n > 1) PetscCall(PetscTimSort(*n, *crossings, sizeof(Probe), CompareCrossings, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the closest face of the second surface of their pairs for all points. No face is farther than the farthest corner of the box of any
   rank; ranks whose boxes are farther need not be asked. */
PetscErrorCode ProbesFindClosest(ProbeSearch *search, Probes *points)
{
  Probes   questions = {0};
  PetscInt n;
  Probe   *answers;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < points->n; i++) {
    Probe           *point = &points->list[i];
    const PetscReal *boxes = search->boxes + 6 * search->pairs[point->pair].surfaces[1];

    point->rank    = search->rank;
    point->source  = i;
    point->closest = (Closest){.square = PETSC_MAX_REAL};
    for (PetscInt pass = 0; pass < 2; pass++)
      for (PetscMPIInt r = 0; r < search->n_ranks; r++) {
        const PetscReal *box = boxes + 6 * search->n * r;
        PetscReal        least, largest;

        if (box[0] > -box[3]) continue; /* that rank has none */
        BoxDistances(box, point->x[0], &least, &largest);
        if (!pass) point->closest.square = PetscMin(point->closest.square, largest * (1 + FARTHER));
        else if (least <= point->closest.square) PetscCall(ProbesAdd(&questions, point, r));
      }
  }
  PetscCall(Exchange(search, &questions, AnswerPoint, &n, &answers));
  for (PetscInt i = 0; i < n; i++) ClosestTake(&points->list[answers[i].source].closest, &answers[i].closest);
  PetscCall(PetscFree(answers));
  PetscFunctionReturn(PETSC_SUCCESS);
}
