/* Which faces may lie opposite to a face: a tree of boxes, O(log n) a query. */
#include "interfaceimpl.h"

/* Faces in a leaf at most, a trade between the numbers of boxes and of faces that are compared */
#define LEAF 4

/* Puts those of n numbers in `order` first, `half` of them, whose values are least, in no order: O(n), whatever the order was (C. A. R. Hoare,
   Algorithm 65: Find, Communications of the ACM 4, 1961) */
static void Halve(PetscInt half, PetscInt n, const PetscReal values[], PetscInt order[])
{
  PetscInt begin = 0, end = n - 1;

  while (begin < end) {
    const PetscReal pivot = values[order[half]];
    PetscInt        i = begin, j = end;

    do {
      while (values[order[i]] < pivot) i++;
      while (values[order[j]] > pivot) j--;
      if (i <= j) {
        const PetscInt first = order[i];

        order[i++] = order[j];
        order[j--] = first;
      }
    } while (i <= j);
    if (j < half) begin = i;
    if (i > half) end = j;
  }
}

/* A tree of the boxes that bound some faces, each box halved along its longest axis */
PetscErrorCode TreeCreate(PetscInt face_nodes, PetscInt n, const Face faces[], Tree *tree)
{
  PetscReal *bounds, *middles; /* of boxes of faces: the middle along an axis, twice */

  PetscFunctionBegin;
  PetscCall(PetscMemzero(tree, sizeof(*tree)));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc2(n, &tree->order, 2 * n, &tree->boxes));
  PetscCall(PetscMalloc2(6 * n, &bounds, n, &middles));
  for (PetscInt i = 0; i < n; i++) {
    tree->order[i] = i;
    BoxFind(face_nodes, faces[i].x[0], bounds + 6 * i);
  }
  tree->boxes[0].begin = 0;
  tree->boxes[0].end   = n;
  tree->n_boxes        = 1;
  for (PetscInt b = 0; b < tree->n_boxes; b++) {
    Box      *box   = &tree->boxes[b];
    PetscInt *order = tree->order + box->begin, count = box->end - box->begin, axis = 0, half = box->begin + count / 2;

    BoxFind(0, NULL, box->bounds);
    for (PetscInt i = 0; i < count; i++)
      for (PetscInt k = 0; k < 6; k++) box->bounds[k] = PetscMin(box->bounds[k], bounds[6 * order[i] + k]);
    box->child = -1;
    if (count <= LEAF) continue;
    for (PetscInt d = 1; d < 3; d++)
      if (box->bounds[d] + box->bounds[3 + d] < box->bounds[axis] + box->bounds[3 + axis]) axis = d;
    for (PetscInt i = 0; i < count; i++) middles[order[i]] = bounds[6 * order[i] + axis] - bounds[6 * order[i] + 3 + axis];
    Halve(count / 2, count, middles, order);
    box->child                       = tree->n_boxes;
    tree->boxes[tree->n_boxes].begin = box->begin;
    tree->boxes[tree->n_boxes++].end = half;
    tree->boxes[tree->n_boxes].begin = half;
    tree->boxes[tree->n_boxes++].end = box->end;
  }
  PetscCall(PetscFree2(bounds, middles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TreeDestroy(Tree *tree)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(tree->order, tree->boxes));
  PetscCall(PetscFree(tree->found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a box reaches into the intervals lower to upper along the two tangents and the normal of a frame */
static PetscBool BoxMeets(const Box *box, const Frame *frame, const PetscReal lower[], const PetscReal upper[])
{
  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal *axis   = a < 2 ? frame->tangents[a] : frame->normal;
    PetscReal        middle = 0, half = 0;

    for (PetscInt d = 0; d < 3; d++) {
      middle += ((box->bounds[d] - box->bounds[3 + d]) / 2 - frame->origin[d]) * axis[d];
      half -= (box->bounds[d] + box->bounds[3 + d]) / 2 * PetscAbsReal(axis[d]);
    }
    if (middle - half > upper[a] || middle + half < lower[a]) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The faces whose boxes reach into the intervals `lower` to `upper` along the tangents and the normal of a frame: their number, and the
   faces themselves, which belong to the tree and are valid until its next query */
PetscErrorCode TreeQuery(Tree *tree, const Frame *frame, const PetscReal lower[], const PetscReal upper[], PetscInt *n,
                         const PetscInt *found[])
{
  PetscInt stack[128], depth = 0; /* one box for each level, which are fewer than 64 as boxes are halved */

  PetscFunctionBegin;
  *n = 0;
  if (tree->n_boxes) stack[depth++] = 0;
  while (depth) {
    const Box *box = &tree->boxes[stack[--depth]];

    if (!BoxMeets(box, frame, lower, upper)) continue;
    if (box->child >= 0) {
      stack[depth++] = box->child;
      stack[depth++] = box->child + 1;
      continue;
    }
    if (*n + LEAF > tree->max_found) {
      tree->max_found = 2 * tree->max_found + 64;
      PetscCall(PetscRealloc((size_t)tree->max_found * sizeof(PetscInt), &tree->found));
    }
    for (PetscInt i = box->begin; i < box->end; i++) tree->found[(*n)++] = tree->order[i];
  }
  *found = tree->found;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The square of the least distance of a point from a box, and of its largest one [m^2] */
void BoxDistances(const PetscReal box[6], const PetscReal x[], PetscReal *least, PetscReal *largest)
{
  *least = *largest = 0;
  for (PetscInt d = 0; d < 3; d++) {
    *least += PetscSqr(PetscMax(0, PetscMax(box[d] - x[d], x[d] + box[3 + d])));
    *largest += PetscSqr(PetscMax(PetscAbsReal(box[d] - x[d]), PetscAbsReal(box[3 + d] + x[d])));
  }
}

/* The closest point of the faces of a tree, no farther than `closest` says: that with which it begins */
void TreeFindClosest(const Tree *tree, PetscInt n, const Face faces[], const PetscReal x[], Closest *closest)
{
  PetscInt stack[128], depth = 0;

  if (tree->n_boxes) stack[depth++] = 0;
  while (depth) {
    const Box *box = &tree->boxes[stack[--depth]];
    PetscReal  least[2], largest;

    BoxDistances(box->bounds, x, &least[0], &largest);
    if (least[0] > (1 + CLOSEST_SAME_POINT) * closest->square) continue; /* other faces at the same corner say on which side x is */
    if (box->child < 0) {
      for (PetscInt i = box->begin; i < box->end; i++) FaceFindClosest(n, &faces[tree->order[i]], x, closest);
      continue;
    }
    for (PetscInt k = 0; k < 2; k++) BoxDistances(tree->boxes[box->child + k].bounds, x, &least[k], &largest);
    stack[depth++] = box->child + (least[0] <= least[1]); /* the nearer one comes first */
    stack[depth++] = box->child + (least[0] > least[1]);
  }
}
