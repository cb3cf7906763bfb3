/* What a mesh file can hardly have meant: elements over each other, and double nodes that leave the mesh in pieces. */
#include "meshimpl.h"

/* How far a point must be inside an element to say so, as a part of its extent: faces of hexahedra may be warped */
#define INSIDE 0.05
/* How far points near corners are on the way to the centre of their element: in one that overlaps it by 0.15 of its width or more */
#define PULLED 0.2
/* Distance of nodes that lie on each other, as a part of the extent of the mesh */
#define SAME 1e-9
/* Most pairs of elements and points that are looked at, which is far more than in meshes whose elements do not overlap */
#define MOST_LOOKS 200000000

/* Points in boxes: those of box k are points[begin[k]] to points[begin[k + 1] - 1] */
typedef struct {
  PetscInt   dim, n[3], *begin, *points;
  PetscReal  lower[3], width[3];
  PetscInt   n_points;
  PetscReal *x; /* dim coordinates each */
} Boxes;

/* Faces of elements, their vertices counterclockwise as seen from outside */
static const PetscInt edges_of_triangle[][4]      = {{0, 1}, {1, 2}, {2, 0}};
static const PetscInt edges_of_quadrilateral[][4] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
static const PetscInt faces_of_tetrahedron[][4]   = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
static const PetscInt faces_of_hexahedron[][4]    = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
static const PetscInt (*const faces_of[4][9])[4]  = {[2] = {[3] = edges_of_triangle, [4] = edges_of_quadrilateral},
                                                     [3] = {[4] = faces_of_tetrahedron, [8] = faces_of_hexahedron}};
static const PetscInt face_count[4][9]            = {[2] = {[3] = 3, [4] = 4}, [3] = {[4] = 4, [8] = 6}};

static PetscInt BoxAlong(const Boxes *boxes, PetscInt d, PetscReal x)
{
  const PetscReal place = (x - boxes->lower[d]) / boxes->width[d];

  return place > 0 ? PetscMin((PetscInt)place, boxes->n[d] - 1) : 0;
}

static PetscInt BoxOf(const Boxes *boxes, const PetscReal x[])
{
  PetscInt box = 0;

  for (PetscInt d = boxes->dim - 1; d >= 0; d--) box = box * boxes->n[d] + BoxAlong(boxes, d, x[d]);
  return box;
}

/* About one point in each box; takes the points over */
static PetscErrorCode BoxesCreate(PetscInt dim, PetscInt n_points, PetscReal x[], Boxes *boxes)
{
  PetscReal upper[3];
  PetscInt  all = 1;

  PetscFunctionBegin;
  boxes->dim      = dim;
  boxes->n_points = n_points;
  boxes->x        = x;
  for (PetscInt d = 0; d < dim; d++) {
    boxes->lower[d] = upper[d] = x[d];
    for (PetscInt i = 0; i < n_points; i++) {
      boxes->lower[d] = PetscMin(boxes->lower[d], x[i * dim + d]);
      upper[d]        = PetscMax(upper[d], x[i * dim + d]);
    }
    boxes->n[d]     = 1 + (PetscInt)PetscPowReal((PetscReal)n_points, 1 / (PetscReal)dim);
    boxes->width[d] = PetscMax((upper[d] - boxes->lower[d]) / (PetscReal)boxes->n[d], PETSC_MACHINE_EPSILON);
    all *= boxes->n[d];
  }
  PetscCall(PetscCalloc1(all + 1, &boxes->begin));
  PetscCall(PetscMalloc1(n_points, &boxes->points));
  for (PetscInt i = 0; i < n_points; i++) boxes->begin[BoxOf(boxes, x + i * dim)]++;
  for (PetscInt k = 0, sum = 0; k <= all; k++) {
    sum += boxes->begin[k];
    boxes->begin[k] = sum; /* the end of box k, from which filling it takes us to its begin */
  }
  for (PetscInt i = 0; i < n_points; i++) boxes->points[--boxes->begin[BoxOf(boxes, x + i * dim)]] = i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode BoxesDestroy(Boxes *boxes)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(boxes->begin));
  PetscCall(PetscFree(boxes->points));
  PetscCall(PetscFree(boxes->x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a point lies inside an element, and not near its boundary */
static PetscBool IsInside(const MeshFile *file, const PetscInt cell[], const PetscReal p[], PetscReal extent)
{
  const PetscInt  dim = file->dim, corners = file->corners, per_face = dim == 2 ? 2 : corners == 4 ? 3 : 4;
  const PetscReal margin = INSIDE * extent;

  if (dim == 1) {
    const PetscReal a = file->vertices[cell[0]], b = file->vertices[cell[1]];

    return (PetscBool)(p[0] > PetscMin(a, b) + margin && p[0] < PetscMax(a, b) - margin);
  }
  for (PetscInt f = 0; f < face_count[dim][corners]; f++) {
    const PetscInt  *face = faces_of[dim][corners][f];
    const PetscReal *x[4];
    PetscReal        normal[3] = {0}, size = 0, distance = 0;

    for (PetscInt k = 0; k < per_face; k++) x[k] = file->vertices + cell[face[k]] * dim;
    if (dim == 2) {
      normal[0] = x[1][1] - x[0][1];
      normal[1] = x[0][0] - x[1][0];
    } else {
      const PetscReal *from = per_face == 3 ? x[0] : x[1], *to = per_face == 3 ? x[2] : x[3]; /* diagonals, or edges */
      PetscReal        a[3], b[3];

      for (PetscInt d = 0; d < 3; d++) {
        a[d] = (per_face == 3 ? x[1][d] : x[2][d]) - x[0][d];
        b[d] = to[d] - from[d];
      }
      for (PetscInt d = 0; d < 3; d++) normal[d] = a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
    }
    for (PetscInt d = 0; d < dim; d++) {
      size += PetscSqr(normal[d]);
      for (PetscInt k = 0; k < per_face; k++) distance += (p[d] - x[k][d]) * normal[d] / (PetscReal)per_face;
    }
    if (!(distance < -margin * PetscSqrtReal(size))) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The vertices, then of each element its centre and `corners` points near its corners (0: none) */
static PetscErrorCode CollectPoints(const MeshFile *file, PetscInt corners, PetscInt *n, PetscReal **points)
{
  const PetscInt dim = file->dim, of_cell = 1 + corners;
  PetscReal     *x;

  PetscFunctionBegin;
  *n = file->n_vertices + file->n_cells * of_cell;
  PetscCall(PetscCalloc1(*n * dim, points));
  PetscCall(PetscArraycpy(*points, file->vertices, file->n_vertices * dim));
  x = *points + file->n_vertices * dim;
  for (PetscInt c = 0; c < file->n_cells; c++, x += of_cell * dim) {
    const PetscInt *cell = file->cells + c * file->corners;

    for (PetscInt k = 0; k < file->corners; k++)
      for (PetscInt d = 0; d < dim; d++) x[d] += file->vertices[cell[k] * dim + d] / (PetscReal)file->corners;
    for (PetscInt k = 0; k < corners; k++)
      for (PetscInt d = 0; d < dim; d++) x[(k + 1) * dim + d] = (1 - PULLED) * file->vertices[cell[k] * dim + d] + PULLED * x[d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts elements that hold a vertex or one of `of_cell` points of another; gives one such pair, the second negative: a vertex */
static PetscErrorCode FindOverlap(const MeshFile *file, const Boxes *boxes, PetscInt of_cell, PetscInt *number, PetscInt pair[2])
{
  const PetscInt dim   = file->dim;
  PetscInt64     looks = 0;

  PetscFunctionBegin;
  *number = 0;
  for (PetscInt c = 0; c < file->n_cells && looks < MOST_LOOKS; c++) {
    const PetscInt *cell     = file->cells + c * file->corners;
    PetscReal       lower[3] = {0}, upper[3] = {0}, extent = PETSC_MAX_REAL;
    PetscInt        from[3] = {0}, to[3] = {0}, found = -1;

    for (PetscInt d = 0; d < dim; d++) {
      lower[d] = upper[d] = file->vertices[cell[0] * dim + d];
      for (PetscInt k = 1; k < file->corners; k++) {
        lower[d] = PetscMin(lower[d], file->vertices[cell[k] * dim + d]);
        upper[d] = PetscMax(upper[d], file->vertices[cell[k] * dim + d]);
      }
      extent  = PetscMin(extent, upper[d] - lower[d]);
      from[d] = BoxAlong(boxes, d, lower[d]);
      to[d]   = BoxAlong(boxes, d, upper[d]);
    }
    for (PetscInt k = from[2]; k <= to[2]; k++)
      for (PetscInt j = from[1]; j <= to[1]; j++)
        for (PetscInt i = from[0]; i <= to[0]; i++) {
          const PetscInt box = dim == 1 ? i : dim == 2 ? j * boxes->n[0] + i : (k * boxes->n[1] + j) * boxes->n[0] + i;

          for (PetscInt q = boxes->begin[box]; q < boxes->begin[box + 1] && found < 0; q++) {
            const PetscInt point = boxes->points[q];

            looks++;
            const PetscBool own = (PetscBool)(point >= file->n_vertices && (point - file->n_vertices) / of_cell == c);

            if (!own && IsInside(file, cell, boxes->x + point * dim, extent)) found = point;
          }
        }
    if (found < 0) continue;
    if (!(*number)++) {
      pair[0] = c;
      pair[1] = found < file->n_vertices ? -1 : (found - file->n_vertices) / of_cell;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt FindRoot(PetscInt parent[], PetscInt i)
{
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* Pieces that share no node, and nodes of one that lie on nodes of another */
static PetscErrorCode CountPieces(const MeshFile *file, const Boxes *boxes, PetscInt *pieces, PetscInt *doubles)
{
  const PetscInt dim    = file->dim;
  PetscReal      extent = 0;
  PetscInt      *parent;

  PetscFunctionBegin;
  *pieces = *doubles = 0;
  PetscCall(PetscMalloc1(file->n_vertices, &parent));
  for (PetscInt i = 0; i < file->n_vertices; i++) parent[i] = i;
  for (PetscInt c = 0; c < file->n_cells; c++)
    for (PetscInt k = 1; k < file->corners; k++)
      parent[FindRoot(parent, file->cells[c * file->corners + k])] = FindRoot(parent, file->cells[c * file->corners]);
  for (PetscInt i = 0; i < file->n_vertices; i++) *pieces += parent[i] == i;
  for (PetscInt d = 0; d < dim; d++) extent = PetscMax(extent, boxes->width[d] * (PetscReal)boxes->n[d]);
  for (PetscInt i = 0; i < file->n_vertices && *pieces > 1; i++) {
    const PetscInt box = BoxOf(boxes, boxes->x + i * dim);
    PetscBool      two = PETSC_FALSE;

    for (PetscInt q = boxes->begin[box]; q < boxes->begin[box + 1]; q++) {
      const PetscInt other    = boxes->points[q];
      PetscReal      distance = 0;

      if (other >= i) continue; /* each pair once; centres of elements come last */
      for (PetscInt d = 0; d < dim; d++) distance = PetscMax(distance, PetscAbsReal(boxes->x[i * dim + d] - boxes->x[other * dim + d]));
      two = (PetscBool)(two || (distance <= SAME * extent && FindRoot(parent, i) != FindRoot(parent, other)));
    }
    *doubles += two;
  }
  PetscCall(PetscFree(parent));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A warning; in one dimension an error, since bars are lines without branches */
static PetscErrorCode Tell(const MeshFile *file, const char where[], const char text[])
{
  PetscFunctionBegin;
  PetscCheck(file->dim > 1, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "%s: %s", where, text);
  PetscCall(PetscFPrintf(PETSC_COMM_SELF, stderr, "impakt: warning: %s: %s\n", where, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Warns of elements that overlap, and of a mesh in pieces; in one dimension these are errors. The first rank calls it. */
PetscErrorCode MeshFileDoubt(const MeshFile *file, const char where[])
{
  PetscInt   n, overlaps, pair[2] = {0}, pieces, doubles, corners = 0;
  char       text[512], other[64];
  PetscReal *x;
  Boxes      boxes;

  PetscFunctionBegin;
  PetscCall(CollectPoints(file, corners, &n, &x));
  PetscCall(BoxesCreate(file->dim, n, x, &boxes));
  PetscCall(CountPieces(file, &boxes, &pieces, &doubles));
  if (pieces > 1) { /* blocks of which the lines of nodes meet may overlap by less than half an element, where no centre is */
    PetscCall(BoxesDestroy(&boxes));
    corners = file->corners;
    PetscCall(CollectPoints(file, corners, &n, &x));
    PetscCall(BoxesCreate(file->dim, n, x, &boxes));
  }
  PetscCall(FindOverlap(file, &boxes, 1 + corners, &overlaps, pair));
  PetscCall(BoxesDestroy(&boxes));
  if (overlaps) {
    PetscCall(PetscSNPrintf(other, sizeof(other), pair[1] >= 0 ? "element %" PetscInt_FMT : "one that has a node inside it",
                            pair[1] >= 0 ? file->cell_numbers[pair[1]] : 0));
    PetscCall(PetscSNPrintf(text, sizeof(text),
                            "%" PetscInt_FMT " element%s over others, as element %" PetscInt_FMT
                            " over %s: the body has their mass and stiffness twice there",
                            overlaps, overlaps == 1 ? " lies" : "s lie", file->cell_numbers[pair[0]], other));
    PetscCall(Tell(file, where, text));
  }
  if (pieces > 1) {
    PetscCall(PetscSNPrintf(text, sizeof(text),
                            "the mesh is in %" PetscInt_FMT
                            " pieces, which are not connected: merge nodes that lie on each other (%" PetscInt_FMT
                            " do), or make bodies of them by -<body>_mesh_blocks",
                            pieces, doubles));
    PetscCall(Tell(file, where, text));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
