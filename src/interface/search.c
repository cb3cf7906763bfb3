/* Which faces may lie opposite to a face: a tree of boxes, O(log n) a query. */
#include "interfaceimpl.h"

/* Faces in a leaf at most, a trade between the numbers of boxes and of faces that are compared */
#define LEAF 4

/* Puts those `half` of n numbers in `order` first whose values are least. O(n) where they were in order or in none (C. A. R. Hoare,
   Algorithm 65: Find, Communications of the ACM 4, 1961). */
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

/* Another box of a tree, about the faces order[begin] to order[end - 1] */
static void AddBox(Tree *tree, PetscInt begin, PetscInt end)
{
  Box *box = &tree->boxes[tree->n_boxes++];

  box->begin = begin;
  box->end   = end;
  box->child = end - begin > LEAF ? TREE_WHOLE : TREE_LEAF;
  BoxFind(0, NULL, box->bounds);
  for (PetscInt i = begin; i < end; i++)
    for (PetscInt k = 0; k < 6; k++) box->bounds[k] = PetscMin(box->bounds[k], tree->bounds[6 * tree->order[i] + k]);
}

/* Halves a box along its longest axis when a query first looks into it: those far from all that is asked for stay whole */
static void LookInto(Tree *tree, Box *box)
{
  const PetscInt n = box->end - box->begin, half = box->begin + n / 2;
  PetscInt      *order = tree->order + box->begin, axis = 0;

  if (box->child != TREE_WHOLE) return;
  for (PetscInt d = 1; d < 3; d++)
    if (box->bounds[d] + box->bounds[3 + d] < box->bounds[axis] + box->bounds[3 + axis]) axis = d;
  for (PetscInt i = 0; i < n; i++) tree->middles[order[i]] = tree->bounds[6 * order[i] + axis] - tree->bounds[6 * order[i] + 3 + axis];
  Halve(n / 2, n, tree->middles, order);
  box->child = tree->n_boxes;
  AddBox(tree, box->begin, half);
  AddBox(tree, half, box->end);
}

/* A tree of the boxes that bound some faces */
PetscErrorCode TreeCreate(PetscInt face_nodes, PetscInt n, const Face faces[], Tree *tree)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(tree, sizeof(*tree)));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc4(n, &tree->order, 2 * n, &tree->boxes, 6 * n, &tree->bounds, n, &tree->middles));
  for (PetscInt i = 0; i < n; i++) {
    tree->order[i] = i;
    BoxFind(face_nodes, faces[i].x[0], tree->bounds + 6 * i);
  }
  AddBox(tree, 0, n);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TreeDestroy(Tree *tree)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(tree->order, tree->boxes, tree->bounds, tree->middles));
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
    Box *box = &tree->boxes[stack[--depth]];

    if (!BoxMeets(box, frame, lower, upper)) continue;
    LookInto(tree, box);
    if (box->child != TREE_LEAF) {
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
void TreeFindClosest(Tree *tree, PetscInt n, const Face faces[], const PetscReal x[], Closest *closest)
{
  PetscInt  stack[128], depth = 0;
  PetscReal squares[128]; /* of the distances of these boxes */

  squares[0] = 0;
  if (tree->n_boxes) stack[depth++] = 0;
  while (depth) {
    Box      *box = &tree->boxes[stack[--depth]];
    PetscReal least[2], largest;

    if (squares[depth] > (1 + CLOSEST_SAME_POINT) * closest->square) continue; /* other faces at the same corner say on which side x is */
    LookInto(tree, box);
    if (box->child == TREE_LEAF) {
      for (PetscInt i = box->begin; i < box->end; i++) FaceFindClosest(n, &faces[tree->order[i]], x, closest);
      continue;
    }
    for (PetscInt k = 0; k < 2; k++) BoxDistances(tree->boxes[box->child + k].bounds, x, &least[k], &largest);
    for (PetscInt k = 0; k < 2; k++) { /* the nearer one comes first */
      const PetscInt which = (least[0] <= least[1]) != k;

      squares[depth] = least[which];
      stack[depth++] = box->child + which;
    }
  }
}
