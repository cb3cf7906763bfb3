/* The closest point of a face, and where a segment crosses a face. Faces with four nodes count as two triangles. */
#include "interfaceimpl.h"

/* Ends and edges reach this much further, in parts of their length, so that round-off leaves no slit between neighbouring faces */
#define SLIT 1e-9
/* A segment that is inclined less to a face [rad] lies along it, and does not cross it */
#define ALONG 1e-6

static void Subtract(const PetscReal a[], const PetscReal b[], PetscReal difference[])
{
  for (PetscInt d = 0; d < 3; d++) difference[d] = a[d] - b[d];
}

static void GetTriangle(const Face *face, PetscInt t, const PetscReal *corners[3])
{
  corners[0] = face->x[0];
  corners[1] = face->x[1 + t];
  corners[2] = face->x[2 + t];
}

static void ClosestOfSegment(const PetscReal a[], const PetscReal b[], const PetscReal x[], PetscReal closest[])
{
  PetscReal along[3], from[3], square, s;

  Subtract(b, a, along);
  Subtract(x, a, from);
  square = Dot(along, along);
  s      = square > 0 ? PetscMin(1, PetscMax(0, Dot(from, along) / square)) : 0;
  for (PetscInt d = 0; d < 3; d++) closest[d] = a[d] + s * along[d];
}

/* The point of a triangle that is closest to x, and the unit normal of the triangle: below x, or on one of its sides */
static void ClosestOfTriangle(const PetscReal *corners[3], const PetscReal x[], PetscReal closest[], PetscReal normal[])
{
  PetscReal sides[2][3], from[3], smallest = PETSC_MAX_REAL;
  PetscBool above = PETSC_TRUE;

  for (PetscInt d = 0; d < 3; d++) closest[d] = corners[0][d]; /* of an x that is no number */
  for (PetscInt k = 0; k < 2; k++) Subtract(corners[k + 1], corners[0], sides[k]);
  Cross(sides[0], sides[1], normal);
  if (Normalize(normal) == 0) above = PETSC_FALSE;
  for (PetscInt k = 0; k < 3 && above; k++) {
    PetscReal side[3], inward[3];

    Subtract(corners[(k + 1) % 3], corners[k], side);
    Subtract(x, corners[k], from);
    Cross(normal, side, inward);
    if (Dot(inward, from) < 0) above = PETSC_FALSE;
  }
  if (above) {
    Subtract(x, corners[0], from);
    for (PetscInt d = 0; d < 3; d++) closest[d] = x[d] - Dot(from, normal) * normal[d];
    return;
  }
  for (PetscInt k = 0; k < 3; k++) {
    PetscReal point[3];

    ClosestOfSegment(corners[k], corners[(k + 1) % 3], x, point);
    Subtract(x, point, from);
    if (Dot(from, from) >= smallest) continue;
    smallest = Dot(from, from);
    for (PetscInt d = 0; d < 3; d++) closest[d] = point[d];
  }
}

/* Takes the closer of two points. On edges and corners of faces the plane farthest from the looking point says on which side this is. */
void ClosestTake(Closest *closest, const Closest *other)
{
  const PetscReal round_off = CLOSEST_SAME_POINT * closest->square;

  if (other->square > closest->square + round_off) return;
  if (other->square >= closest->square - round_off && PetscAbsReal(other->height) <= PetscAbsReal(closest->height)) return;
  *closest = *other;
}

/* Takes the closest point of a face if it is closer than that of other faces */
void FaceFindClosest(PetscInt n, const Face *face, const PetscReal x[], Closest *closest)
{
  for (PetscInt t = 0; t < PetscMax(n - 2, 1); t++) {
    PetscReal        point[3], normal[3], from[3], square, height;
    const PetscReal *corners[3];

    if (n > 2) {
      GetTriangle(face, t, corners);
      ClosestOfTriangle(corners, x, point, normal);
    } else {
      ClosestOfSegment(face->x[0], face->x[n - 1], x, point);
      for (PetscInt d = 0; d < 3; d++) normal[d] = face->normal[d];
    }
    Subtract(x, point, from);
    square = Dot(from, from);
    height = Dot(from, normal);
    ClosestTake(closest, &(const Closest){.square = square, .height = height, .size = face->size});
  }
}

/* Where the segment from a to b crosses a face, from 0 at a to 1 at b, at most one place for each of its triangles; returns their number */
PetscInt FaceFindCrossings(PetscInt n, const Face *face, const PetscReal a[], const PetscReal b[], PetscReal t[2])
{
  PetscReal along[3];
  PetscInt  found = 0;

  Subtract(b, a, along);
  for (PetscInt k = 0; k < PetscMax(n - 2, 1) && n > 1; k++) {
    PetscReal        sides[2][3] = {{0}, {0, 0, 1}}, from[3], normal[3], product[3], slope, at[3];
    const PetscReal *corners[3]  = {face->x[0], face->x[1], face->x[1]};

    if (n > 2) GetTriangle(face, k, corners);
    Subtract(corners[1], corners[0], sides[0]);
    if (n > 2) Subtract(corners[2], corners[0], sides[1]); /* in the plane faces reach along z */
    Cross(sides[0], sides[1], normal);
    slope = Dot(normal, along);
    if (PetscAbsReal(slope) <= ALONG * PetscSqrtReal(Dot(normal, normal) * Dot(along, along))) continue;
    Subtract(a, corners[0], from);
    at[0] = -Dot(normal, from) / slope;
    Cross(from, along, product);
    at[1] = -Dot(sides[1], product) / slope;
    at[2] = n > 2 ? Dot(sides[0], product) / slope : 0;
    if (at[0] < -SLIT || at[0] > 1 + SLIT || at[1] < -SLIT || at[2] < -SLIT || at[1] + at[2] > 1 + SLIT) continue;
    t[found++] = at[0];
  }
  return found;
}
