/* Faces in space, and polygons in the plane of a face. */
#include "interfaceimpl.h"

/* Newton's method for the inverse of a bilinear map ends when the sum of its steps in both natural coordinates, which are of order 1, is
   below round-off. The limit is for points far outside, where it may not converge. */
#define SHORTEST_STEP  1e-14
#define MAX_ITERATIONS 30

/* Outward unit normal and area of a face with n nodes. Of a point, n = 1, the caller sets the normal, and the area is 1. */
void FaceNormal(PetscInt n, const PetscReal x[][3], PetscReal normal[], PetscReal *area)
{
  PetscReal a[3], b[3];

  *area = 1;
  if (n == 1) return;
  if (n == 2) {
    normal[0] = x[1][1] - x[0][1];
    normal[1] = x[0][0] - x[1][0];
    normal[2] = 0;
    *area     = Normalize(normal);
    return;
  }
  /* the normal of a quadrilateral follows from its diagonals: of a warped one it is the mean normal */
  for (PetscInt d = 0; d < 3; d++) {
    a[d] = n == 3 ? x[1][d] - x[0][d] : x[2][d] - x[0][d];
    b[d] = n == 3 ? x[2][d] - x[0][d] : x[3][d] - x[1][d];
  }
  Cross(a, b, normal);
  *area = Normalize(normal) / 2;
}

/* The edge of the square, of the half square, or of the segment that has this area [m]; 1 for a point */
PetscReal FaceSize(PetscInt n, PetscReal area)
{
  return n < 3 ? area : PetscSqrtReal(n == 3 ? 2 * area : area);
}

/* Integrals of the shape functions over a face, projected on the plane across its normal; exact for any quadrilateral */
void FaceNodeAreas(PetscInt n, const PetscReal x[][3], const PetscReal normal[], PetscReal areas[])
{
  static const PetscReal corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const PetscReal        gauss        = 1 / PetscSqrtReal(3);
  PetscReal              area, unit[3];

  if (n < 4) {
    FaceNormal(n, x, unit, &area);
    for (PetscInt k = 0; k < n; k++) areas[k] = area / n;
    return;
  }
  for (PetscInt k = 0; k < 4; k++) areas[k] = 0;
  for (PetscInt q = 0; q < 4; q++) {
    const PetscReal xi = gauss * corner[q][0], eta = gauss * corner[q][1];
    PetscReal       along[3] = {0}, across[3] = {0}, product[3], weight;

    for (PetscInt k = 0; k < 4; k++)
      for (PetscInt d = 0; d < 3; d++) {
        along[d] += corner[k][0] * (1 + corner[k][1] * eta) / 4 * x[k][d];
        across[d] += corner[k][1] * (1 + corner[k][0] * xi) / 4 * x[k][d];
      }
    Cross(along, across, product);
    weight = Dot(product, normal);
    for (PetscInt k = 0; k < 4; k++) areas[k] += weight * (1 + corner[k][0] * xi) * (1 + corner[k][1] * eta) / 4;
  }
}

/* The plane of a face, with its first tangent along the first edge */
void FrameOfFace(PetscInt n, const PetscReal x[][3], const PetscReal normal[], Frame *frame)
{
  for (PetscInt d = 0; d < 3; d++) {
    frame->origin[d] = 0;
    for (PetscInt k = 0; k < n; k++) frame->origin[d] += x[k][d] / n;
    frame->normal[d]      = normal[d];
    frame->tangents[0][d] = n > 1 ? x[1][d] - x[0][d] : 0;
  }
  if (n > 2) { /* an edge of a warped quadrilateral does not lie in its plane */
    const PetscReal out = Dot(frame->tangents[0], normal);

    for (PetscInt d = 0; d < 3; d++) frame->tangents[0][d] -= out * normal[d];
  }
  Normalize(frame->tangents[0]);
  Cross(frame->normal, frame->tangents[0], frame->tangents[1]);
}

/* Coordinates of a point in the plane of a face, along its tangents [m] */
void FrameProject(const Frame *frame, const PetscReal x[], PetscReal s[])
{
  const PetscReal from[3] = {x[0] - frame->origin[0], x[1] - frame->origin[1], x[2] - frame->origin[2]};

  s[0] = Dot(from, frame->tangents[0]);
  s[1] = Dot(from, frame->tangents[1]);
}

/* Inverse of the bilinear map of a quadrilateral, by Newton's method: one iteration for a parallelogram */
static void InvertBilinear(const PetscReal p[][2], const PetscReal s[], PetscReal *xi, PetscReal *eta)
{
  *xi = *eta = 0;
  for (PetscInt iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
    PetscReal rest[2], along[2], across[2], determinant, step[2];

    for (PetscInt d = 0; d < 2; d++) {
      const PetscReal mean = (p[0][d] + p[1][d] + p[2][d] + p[3][d]) / 4, a = (-p[0][d] + p[1][d] + p[2][d] - p[3][d]) / 4;
      const PetscReal b = (-p[0][d] - p[1][d] + p[2][d] + p[3][d]) / 4, c = (p[0][d] - p[1][d] + p[2][d] - p[3][d]) / 4;

      rest[d]   = s[d] - mean - a * *xi - b * *eta - c * *xi * *eta;
      along[d]  = a + c * *eta;
      across[d] = b + c * *xi;
    }
    determinant = along[0] * across[1] - along[1] * across[0];
    if (determinant == 0) return;
    step[0] = (rest[0] * across[1] - rest[1] * across[0]) / determinant;
    step[1] = (along[0] * rest[1] - along[1] * rest[0]) / determinant;
    *xi += step[0];
    *eta += step[1];
    if (PetscAbsReal(step[0]) + PetscAbsReal(step[1]) < SHORTEST_STEP) return;
  }
}

/* Shape functions of the face with corners p at the point s of their plane */
void FaceShapes(PetscInt n, const PetscReal p[][2], const PetscReal s[], PetscReal shapes[])
{
  if (n == 2) {
    shapes[1] = (s[0] - p[0][0]) / (p[1][0] - p[0][0]);
    shapes[0] = 1 - shapes[1];
  } else if (n == 3) {
    const PetscReal a[2] = {p[1][0] - p[0][0], p[1][1] - p[0][1]}, b[2] = {p[2][0] - p[0][0], p[2][1] - p[0][1]},
                    c[2]        = {s[0] - p[0][0], s[1] - p[0][1]};
    const PetscReal determinant = a[0] * b[1] - a[1] * b[0];

    shapes[1] = (c[0] * b[1] - c[1] * b[0]) / determinant;
    shapes[2] = (a[0] * c[1] - a[1] * c[0]) / determinant;
    shapes[0] = 1 - shapes[1] - shapes[2];
  } else {
    PetscReal xi, eta;

    InvertBilinear(p, s, &xi, &eta);
    shapes[0] = (1 - xi) * (1 - eta) / 4;
    shapes[1] = (1 + xi) * (1 - eta) / 4;
    shapes[2] = (1 + xi) * (1 + eta) / 4;
    shapes[3] = (1 - xi) * (1 + eta) / 4;
  }
}

/* The part of a polygon p inside a convex polygon `clip` that runs counterclockwise (Sutherland, Hodgman 1974); with two points each, of
   one interval inside another. Returns its number of corners, 0 if nothing is inside. `out` must have room for the corners of both. */
PetscInt PolygonClip(PetscInt n, const PetscReal p[][2], PetscInt n_clip, const PetscReal clip[][2], PetscReal out[][2])
{
  PetscReal work[2][16][2];
  PetscInt  count = n, which = 0;

  if (n_clip == 2) {
    out[0][0] = PetscMax(PetscMin(p[0][0], p[1][0]), PetscMin(clip[0][0], clip[1][0]));
    out[1][0] = PetscMin(PetscMax(p[0][0], p[1][0]), PetscMax(clip[0][0], clip[1][0]));
    out[0][1] = out[1][1] = 0;
    return out[1][0] > out[0][0] ? 2 : 0;
  }
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt d = 0; d < 2; d++) work[0][k][d] = p[k][d];
  for (PetscInt e = 0; e < n_clip && count; e++) {
    const PetscReal *a = clip[e], *b = clip[(e + 1) % n_clip], edge[2] = {b[0] - a[0], b[1] - a[1]};
    PetscInt         kept = 0;

    for (PetscInt k = 0; k < count; k++) {
      const PetscReal *from = work[which][k], *to = work[which][(k + 1) % count];
      const PetscReal  side_from = edge[0] * (from[1] - a[1]) - edge[1] * (from[0] - a[0]),
                       side_to   = edge[0] * (to[1] - a[1]) - edge[1] * (to[0] - a[0]);

      if (side_from >= 0) {
        for (PetscInt d = 0; d < 2; d++) work[1 - which][kept][d] = from[d];
        kept++;
      }
      if ((side_from > 0 && side_to < 0) || (side_from < 0 && side_to > 0)) {
        for (PetscInt d = 0; d < 2; d++) work[1 - which][kept][d] = from[d] + side_from / (side_from - side_to) * (to[d] - from[d]);
        kept++;
      }
    }
    which = 1 - which;
    count = PetscMin(kept, 8);
  }
  if (count < 3) return 0; /* they have an edge or a corner in common, and no area */
  for (PetscInt k = 0; k < count; k++)
    for (PetscInt d = 0; d < 2; d++) out[k][d] = work[which][k][d];
  return count;
}

/* Area of a polygon, or length of an interval, whichever way it runs; and its centroid */
PetscReal PolygonMeasure(PetscInt n, const PetscReal p[][2], PetscReal centroid[])
{
  PetscReal area = 0, moment[2] = {0, 0};

  centroid[0] = n ? p[0][0] : 0;
  centroid[1] = n ? p[0][1] : 0;
  if (n == 2) {
    centroid[0] = (p[0][0] + p[1][0]) / 2;
    return PetscAbsReal(p[1][0] - p[0][0]);
  }
  for (PetscInt k = 1; k + 1 < n; k++) {
    const PetscReal part = ((p[k][0] - p[0][0]) * (p[k + 1][1] - p[0][1]) - (p[k][1] - p[0][1]) * (p[k + 1][0] - p[0][0])) / 2;

    area += part;
    for (PetscInt d = 0; d < 2; d++) moment[d] += part * (p[k][d] + p[k + 1][d] - 2 * p[0][d]) / 3;
  }
  if (area != 0)
    for (PetscInt d = 0; d < 2; d++) centroid[d] += moment[d] / area;
  return PetscAbsReal(area);
}

/* How far a point is outside the farthest edge line of a clockwise convex polygon, negative inside: a lower bound of the distance. */
PetscReal PolygonDistance(PetscInt n, const PetscReal p[][2], const PetscReal s[])
{
  PetscReal farthest = -PETSC_MAX_REAL;

  if (n == 2) return PetscMax(PetscMin(p[0][0], p[1][0]) - s[0], s[0] - PetscMax(p[0][0], p[1][0]));
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal *a = p[k], *b = p[(k + 1) % n], edge[2] = {b[0] - a[0], b[1] - a[1]};
    const PetscReal  length = PetscSqrtReal(edge[0] * edge[0] + edge[1] * edge[1]);

    if (length > 0) farthest = PetscMax(farthest, (edge[0] * (s[1] - a[1]) - edge[1] * (s[0] - a[0])) / length);
  }
  return farthest;
}

/* Points and weights on a polygon, cut into triangles from its first corner: exact for polynomials of degree 4 (Dunavant 1985, table II),
   and so for the product of two bilinear functions on parallelograms; on intervals of degree 5 (Gauss). Each triangle has six points, so
   that a polygon of eight corners has 36. */
PetscInt PolygonQuadrature(PetscInt n, const PetscReal p[][2], PetscReal points[][2], PetscReal weights[])
{
  static const PetscReal share[2] = {0.223381589678011, 0.109951743655322}, place[2] = {0.445948490915965, 0.091576213509771};
  PetscInt               count = 0;

  if (n == 2) {
    const PetscReal middle = (p[0][0] + p[1][0]) / 2, half = (p[1][0] - p[0][0]) / 2, out = PetscSqrtReal(0.6);

    for (PetscInt q = -1; q <= 1; q++) {
      points[count][0] = middle + q * out * half;
      points[count][1] = 0;
      weights[count++] = half * (q ? 5. / 9 : 8. / 9);
    }
    return count;
  }
  for (PetscInt k = 1; k + 1 < n; k++) {
    const PetscReal *corners[3] = {p[0], p[k], p[k + 1]};
    const PetscReal  area = PetscAbsReal((p[k][0] - p[0][0]) * (p[k + 1][1] - p[0][1]) - (p[k][1] - p[0][1]) * (p[k + 1][0] - p[0][0])) / 2;

    for (PetscInt set = 0; set < 2; set++)
      for (PetscInt q = 0; q < 3; q++) {
        for (PetscInt d = 0; d < 2; d++)
          points[count][d] = (1 - 2 * place[set]) * corners[q][d] + place[set] * (corners[(q + 1) % 3][d] + corners[(q + 2) % 3][d]);
        weights[count++] = area * share[set];
      }
  }
  return count;
}
