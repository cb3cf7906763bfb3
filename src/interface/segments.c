/* Which parts of the Dirichlet faces of this rank lie opposite to which faces of the Neumann side. */
#include "segments.h"

/* Lengths here are in parts of the edge of the Dirichlet face, areas in parts of its area */
#define MARGIN 0.05  /* a node no further beyond the end of the partner counts as covered */
#define REACH  0.95  /* a node beyond that, but no further than this, guards the end; at 1 the next node of a matching mesh would too */
#define SLIVER 1e-10 /* smaller common parts of two faces are round-off of faces that have an edge in common */
/* A face beside a sharp edge has nothing opposite if less of it is covered: it lies beside what the partner stands on, as the side of a
   base does over whose edge a block slides, which sags by a part of this */
#define GRAZED 0.01
/* A partner whose gap is larger by this much than another's is hidden behind it, if that covers more than this part of its area */
#define HIDDEN_DISTANCE 0.5
#define HIDDEN_PART     0.1
/* A partner is steep if the cosine of the angle between its normal and that of the face is above this: it is inclined to the face by more
   than 37 degrees, as the side of a block beside its edge is. Its end is not guarded. */
#define STEEP (-0.8)

void TargetSetUp(const SurfaceData *data, PetscInt f, Target *target)
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

/* The gap at the point s of the Dirichlet face's plane, along a normal, before a face of n nodes with `corners` in that plane [m] */
PetscReal TargetGap(const Target *target, const PetscReal normal[], const Face *face, PetscInt n, const PetscReal corners[][2],
                    const PetscReal s[])
{
  PetscReal shapes[4], gap = 0;

  FaceShapes(n, corners, s, shapes);
  for (PetscInt j = 0; j < n; j++) gap += shapes[j] * Dot(normal, face->x[j]);
  FaceShapes(target->n, (const PetscReal(*)[2])target->corners, s, shapes);
  for (PetscInt k = 0; k < target->n; k++)
    gap -= shapes[k] * Dot(normal, target->data->positions + 3 * target->data->faces[target->face * target->n + k]);
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

/* Appends the part of the Dirichlet face that lies opposite to one face of the partner, if there is one */
static PetscErrorCode CompareFaces(const Target *target, const Face *face, PetscInt which, Segments *segments)
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
  segment.gap = TargetGap(target, target->frame.normal, face, n, (const PetscReal(*)[2])segment.partner_corners, centroid);
  if (segment.gap > segments->ahead + target->size || segment.gap < -segments->behind - target->size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AddSegment(segments, &segment));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of several partners over the same part of a face only the nearest counts. The parts that neighbouring partners share with the face do not
   overlap, and their gaps are similar: only partners with quite different gaps are compared. */
static void DropHidden(const Target *target, Segments *segments, PetscInt begin)
{
  PetscInt kept = begin;

  for (PetscInt a = begin; a < segments->n; a++) {
    PetscBool hidden = PETSC_FALSE;

    for (PetscInt b = begin; b < segments->n && !hidden; b++) {
      const Segment *mine = &segments->list[a], *other = &segments->list[b];
      PetscReal      part[16][2], corners[8][2], centroid[2];

      if (PetscAbsReal(mine->gap) - PetscAbsReal(other->gap) < HIDDEN_DISTANCE * target->size) continue;
      for (PetscInt k = 0; k < other->n; k++) /* segments run clockwise, as their partners do when seen from behind */
        for (PetscInt d = 0; d < 2; d++) corners[k][d] = other->polygon[other->n - 1 - k][d];
      hidden = (PetscBool)(PolygonMeasure(PolygonClip(mine->n, mine->polygon, other->n, (const PetscReal(*)[2])corners, part),
                                          (const PetscReal(*)[2])part,
                                          centroid) > HIDDEN_PART * PolygonMeasure(mine->n, mine->polygon, centroid));
    }
    segments->list[a].hidden = hidden;
  }
  for (PetscInt a = begin; a < segments->n; a++)
    if (!segments->list[a].hidden) segments->list[kept++] = segments->list[a];
  segments->n = kept;
}

/* Drops what lies opposite to a face beside a sharp edge if that is hardly any of the face */
static void DropGrazed(const Target *target, const PetscBool sharp[], Segments *segments, PetscInt begin)
{
  PetscReal covered = 0, centroid[2];
  PetscBool edge    = PETSC_FALSE;

  for (PetscInt k = 0; k < target->n; k++) edge = (PetscBool)(edge || sharp[target->data->faces[target->face * target->n + k]]);
  for (PetscInt i = begin; i < segments->n; i++)
    covered += PolygonMeasure(segments->list[i].n, (const PetscReal(*)[2])segments->list[i].polygon, centroid);
  if (edge && covered < GRAZED * target->area) segments->n = begin;
}

/* In one dimension: the nearest point whose normal has the opposite direction */
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
  if (segment.partner >= 0) PetscCall(AddSegment(segments, &segment));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the nodes of a face that have a partner opposite, and those just beyond its end, unless the partner is steep there */
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

/* Compares a Dirichlet face with those faces of the partner that the tree finds near it */
static PetscErrorCode CompareWithTree(const Target *target, Tree *tree, const Face faces[], Segments *segments)
{
  PetscReal       lower[3], upper[3];
  PetscInt        n_found;
  const PetscInt *found;

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
  PetscCall(TreeQuery(tree, &target->frame, lower, upper, &n_found, &found));
  for (PetscInt i = 0; i < n_found; i++) PetscCall(CompareFaces(target, &faces[found[i]], found[i], segments));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the common parts of the Dirichlet faces of this rank and of the faces of the partner, at most segments->ahead before and
   segments->behind behind them [m]. Marks the nodes of the Dirichlet faces, which must be MARK_NONE before. */
PetscErrorCode SegmentsFind(Surface surface, PetscInt n_faces, const Face faces[], PetscInt marks[], Segments *segments)
{
  const SurfaceData *data = &surface->data;
  Tree               tree;

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

    TargetSetUp(data, f, &target);
    PetscCall(CompareWithTree(&target, &tree, faces, segments));
    DropHidden(&target, segments, begin);
    if (segments->guards) DropGrazed(&target, surface->sharp, segments, begin); /* not from ties */
    MarkNodes(&target, segments, begin, marks);
  }
  PetscCall(TreeDestroy(&tree));
  PetscFunctionReturn(PETSC_SUCCESS);
}
