/* Which parts of the Dirichlet faces of this rank lie opposite to which faces of the Neumann side. */
#include "segments.h"

#define MARGIN  0.05  /* nodes this far beyond the end of the partner, in parts of the face size, count as covered */
#define REACH   0.95  /* and those up to here guard that end */
#define SLIVER  1e-10 /* parts of a face smaller than this, relative to its area, are left out */
#define STEEP   -0.8  /* normals whose scalar product is more are far from parallel */
#define OPPOSED -0.1  /* normals whose scalar product is less are opposed */

/* What is the same for all candidates of one Dirichlet face */
typedef struct {
  PetscInt           face, n; /* nodes of a face */
  const SurfaceData *data;
  Frame              frame;
  PetscReal          corners[4][2], area, size;
} Target;

static void SetUpTarget(const SurfaceData *data, PetscInt f, Target *target)
{
  const PetscInt n = data->face_nodes;
  PetscReal      x[4][3];

  for (PetscInt k = 0; k < n; k++)
    for (PetscInt d = 0; d < 3; d++) x[k][d] = data->positions[3 * data->faces[f * n + k] + d];
  target->data = data;
  target->face = f;
  target->n    = n;
  target->area = data->face_areas[f];
  target->size = FaceSize(n, target->area);
  FrameOfFace(n, (const PetscReal(*)[3])x, data->face_normals + 3 * f, &target->frame);
  for (PetscInt k = 0; k < n; k++) FrameProject(&target->frame, x[k], target->corners[k]);
}

/* Gap at a point of the plane, along the face's normal */
static PetscReal GapAt(const Target *target, const Face *face, PetscInt n, const PetscReal corners[][2], const PetscReal s[])
{
  PetscReal shapes[4], gap = 0;

  FaceShapes(n, corners, s, shapes);
  for (PetscInt j = 0; j < n; j++) gap += shapes[j] * Dot(target->frame.normal, face->x[j]);
  FaceShapes(target->n, (const PetscReal(*)[2])target->corners, s, shapes);
  for (PetscInt k = 0; k < target->n; k++)
    gap -= shapes[k] * Dot(target->frame.normal, target->data->positions + 3 * target->data->faces[target->face * target->n + k]);
  return gap;
}

static PetscErrorCode AddSegment(Segments *segments, const Segment *segment)
{
  PetscFunctionBegin;
  if (segments->n == segments->max) {
    segments->max = 2 * segments->max + 64;
    PetscCall(PetscRealloc((size_t)segments->max * sizeof(Segment), &segments->list));
  }
  segments->list[segments->n++] = *segment;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of the Dirichlet face that lies opposite to one face, if any */
static PetscErrorCode CompareFaces(const Target *target, const Segments *range, const Face *face, PetscInt which, Segments *segments)
{
  const PetscInt n       = segments->face_nodes;
  Segment        segment = {.face = target->face, .partner = which};
  PetscReal      centroid[2];

  PetscFunctionBegin;
  if (Dot(target->frame.normal, face->normal) >= OPPOSED) PetscFunctionReturn(PETSC_SUCCESS);
  segment.steep = (PetscBool)(Dot(target->frame.normal, face->normal) >= STEEP);
  for (PetscInt j = 0; j < n; j++) FrameProject(&target->frame, face->x[j], segment.partner_corners[j]);
  segment.n = PolygonClip(n, (const PetscReal(*)[2])segment.partner_corners, target->n, (const PetscReal(*)[2])target->corners,
                          segment.polygon);
  if (!segment.n || PolygonMeasure(segment.n, (const PetscReal(*)[2])segment.polygon, centroid) < SLIVER * target->area)
    PetscFunctionReturn(PETSC_SUCCESS);
  segment.gap = GapAt(target, face, n, (const PetscReal(*)[2])segment.partner_corners, centroid);
  if (segment.gap > range->ahead + target->size || segment.gap < -range->behind - (range->behind > 0 ? target->size : 0.1 * target->size))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AddSegment(segments, &segment));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of several partners over the same part of a face the nearest counts. Parts on neighbouring faces do not overlap, so that only those
   with quite different gaps are compared. */
static void DropHidden(const Target *target, Segments *segments, PetscInt begin)
{
  PetscInt kept = begin;

  for (PetscInt a = begin; a < segments->n; a++) {
    PetscBool hidden = PETSC_FALSE;

    for (PetscInt b = begin; b < segments->n && !hidden; b++) {
      const Segment *mine = &segments->list[a], *other = &segments->list[b];
      PetscReal      part[16][2], corners[8][2], centroid[2];

      if (PetscAbsReal(mine->gap) - PetscAbsReal(other->gap) < 0.5 * target->size) continue;
      for (PetscInt k = 0; k < other->n; k++) /* segments run clockwise, as their partners do */
        for (PetscInt d = 0; d < 2; d++) corners[k][d] = other->polygon[other->n - 1 - k][d];
      hidden = (PetscBool)(PolygonMeasure(PolygonClip(mine->n, mine->polygon, other->n, (const PetscReal(*)[2])corners, part),
                                          (const PetscReal(*)[2])part, centroid) > 0.1 * PolygonMeasure(mine->n, mine->polygon, centroid));
    }
    segments->list[a].hidden = hidden;
  }
  for (PetscInt a = begin; a < segments->n; a++)
    if (!segments->list[a].hidden) segments->list[kept++] = segments->list[a];
  segments->n = kept;
}

/* In one dimension: the nearest point that looks the other way */
static PetscErrorCode ComparePoints(const SurfaceData *data, PetscInt f, PetscInt n_faces, const Face faces[], Segments *segments)
{
  const PetscReal *normal = data->face_normals + 3 * f, *x = data->positions + 3 * data->faces[f];
  PetscReal        smallest = PETSC_MAX_REAL;
  Segment          segment  = {.face = f, .partner = -1};

  PetscFunctionBegin;
  for (PetscInt g = 0; g < n_faces; g++) {
    const PetscReal distance = PetscAbsReal(faces[g].x[0][0] - x[0]);

    if (normal[0] * faces[g].normal[0] > 0 || distance >= smallest) continue;
    smallest        = distance;
    segment.partner = g;
  }
  segments->candidates += n_faces;
  if (segment.partner >= 0) PetscCall(AddSegment(segments, &segment));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes that have something opposite to them, and those just beyond its end, unless the partner turns away there */
static void MarkNodes(const Target *target, const Segments *segments, PetscInt begin, PetscInt marks[])
{
  PetscBool guards = segments->guards;

  for (PetscInt i = begin; i < segments->n; i++)
    if (segments->list[i].steep) guards = PETSC_FALSE;
  for (PetscInt k = 0; k < target->n; k++) {
    const PetscInt node = target->data->faces[target->face * target->n + k];

    for (PetscInt i = begin; i < segments->n && marks[node] < MARK_COVERED; i++) {
      const PetscReal distance = PolygonDistance(segments->face_nodes, (const PetscReal(*)[2])segments->list[i].partner_corners,
                                                 target->corners[k]);

      if (distance <= MARGIN * target->size) marks[node] = MARK_COVERED;
      else if (guards && distance <= REACH * target->size) marks[node] = MARK_BEYOND;
    }
  }
}

static PetscErrorCode CompareWithTree(const Target *target, Tree *tree, const Face faces[], Segments *segments)
{
  PetscReal lower[3], upper[3];
  PetscInt  n_found;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < 2; a++) {
    lower[a] = PETSC_MAX_REAL;
    upper[a] = -PETSC_MAX_REAL;
    for (PetscInt k = 0; k < target->n; k++) {
      lower[a] = PetscMin(lower[a], target->corners[k][a]);
      upper[a] = PetscMax(upper[a], target->corners[k][a]);
    }
  }
  lower[2] = -segments->behind - target->size;
  upper[2] = segments->ahead < PETSC_MAX_REAL ? segments->ahead + target->size : PETSC_MAX_REAL;
  PetscCall(TreeQuery(tree, &target->frame, lower, upper, &n_found));
  for (PetscInt i = 0; i < n_found; i++) PetscCall(CompareFaces(target, segments, &faces[tree->found[i]], tree->found[i], segments));
  segments->candidates += n_found;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compares the Dirichlet faces of this rank with those given. marks, one for each node, must be MARK_NONE; segments->ahead and behind say
   how far a partner may be. */
PetscErrorCode SegmentsFind(const SurfaceData *data, PetscInt n_faces, const Face faces[], PetscInt marks[], Segments *segments)
{
  Tree tree;

  PetscFunctionBegin;
  if (data->dim == 1) {
    for (PetscInt f = 0; f < data->n_faces; f++) PetscCall(ComparePoints(data, f, n_faces, faces, segments));
    for (PetscInt i = 0; i < segments->n; i++) marks[data->faces[segments->list[i].face]] = MARK_COVERED;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(TreeCreate(segments->face_nodes, n_faces, faces, &tree));
  for (PetscInt f = 0; f < data->n_faces; f++) {
    const PetscInt begin = segments->n;
    Target         target;

    SetUpTarget(data, f, &target);
    PetscCall(CompareWithTree(&target, &tree, faces, segments));
    DropHidden(&target, segments, begin);
    MarkNodes(&target, segments, begin, marks);
  }
  PetscCall(TreeDestroy(&tree));
  PetscFunctionReturn(PETSC_SUCCESS);
}
