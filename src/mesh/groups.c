/* Surfaces, node sets and blocks of a mesh by their names. */
#include "meshimpl.h"
#include <petsc/private/petscimpl.h>
#include <petscsf.h>
#include <sys/names.h>

/* A face is on a side of the bounding box if no vertex is further from it, in parts of the box's edge across it: round-off */
#define ON_SIDE 1e-8

static const char *const sides[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

/* What a name stands for: points of a label (with one value, or with any), or faces on a side of the bounding box */
typedef struct {
  DMLabel   label;
  PetscBool by_value;
  PetscInt  value;
  PetscInt  side;      /* index into `sides`; -1: none */
  PetscReal place;     /* where that side is on its axis [m] */
  PetscReal tolerance; /* how far from there a vertex may be [m] */
} Selection;

static PetscBool InLabel(const Selection *selection, PetscInt point)
{
  PetscBool in = PETSC_FALSE;
  PetscInt  value;

  if (selection->by_value) {
    (void)DMLabelStratumHasPoint(selection->label, selection->value, point, &in);
    return in;
  }
  (void)DMLabelGetValue(selection->label, point, &value);
  return (PetscBool)(value >= 0);
}

static void UseSide(PetscInt side, const PetscReal lower[], const PetscReal upper[], Selection *selection)
{
  selection->side      = side;
  selection->place     = side % 2 ? upper[side / 2] : lower[side / 2];
  selection->tolerance = ON_SIDE * (upper[side / 2] - lower[side / 2]);
}

/* Finds a label by its name; or, if the name is a number which any of these ranks has in the label `sets`, that value of this label */
static PetscErrorCode FindLabel(MPI_Comm comm, DM dm, const char name[], const char sets[], Selection *selection, PetscBool *found)
{
  PetscBool internal, exists = PETSC_FALSE;
  char     *end;
  long      number;
  int       any;

  PetscFunctionBegin;
  PetscCall(MeshLabelIsInternal(name, &internal));
  *found = PETSC_FALSE;
  if (!internal) PetscCall(DMGetLabel(dm, name, &selection->label));
  if (selection->label) {
    *found = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  number = strtol(name, &end, 10);
  if (end == name || *end || number < 0 || number >= PETSC_INT_MAX) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMGetLabel(dm, sets, &selection->label));
  if (selection->label) PetscCall(DMLabelHasValue(selection->label, (PetscInt)number, &exists));
  any = exists;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, comm));
  *found = (PetscBool)any;
  if (!*found) selection->label = NULL;
  selection->by_value = *found;
  selection->value    = (PetscInt)number;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds what the name of a surface stands for, on all ranks or on this one alone */
static PetscErrorCode FindSurface(DM dm, const char name[], PetscBool alone, PetscBool by_side, Selection *selection, PetscBool *found)
{
  PetscReal lower[3], upper[3];
  PetscInt  dim;

  PetscFunctionBegin;
  PetscCall(FindLabel(alone ? PETSC_COMM_SELF : PetscObjectComm((PetscObject)dm), dm, name, "Face Sets", selection, found));
  PetscCall(DMGetCoordinateDim(dm, &dim));
  for (PetscInt side = 0; side < 2 * dim && by_side && !*found; side++) {
    PetscCall(PetscStrcmp(name, sides[side], found));
    if (!*found) continue;
    if (alone) PetscCall(DMGetLocalBoundingBox(dm, lower, upper));
    else PetscCall(DMGetBoundingBox(dm, lower, upper));
    UseSide(side, lower, upper, selection);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RefuseSurface(DM dm, const char name[], const char what[])
{
  PetscInt    dim, fstart, fend;
  char        list[1024], box[64] = "";
  const char *body;

  PetscFunctionBegin;
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(DMPlexGetHeightStratum(dm, 1, &fstart, &fend));
  PetscCall(MeshListLabels(dm, fstart, fend, "Face Sets", list, sizeof(list)));
  for (PetscInt i = 0; i < 2 * dim; i++) {
    PetscCall(NamesAppend(box, sizeof(box), ", ", sides[i]));
  }
  PetscCall(PetscObjectGetName((PetscObject)dm, &body));
  SETERRQ(PetscObjectComm((PetscObject)dm), PETSC_ERR_USER_INPUT,
          "Body '%s' has no surface '%s'%s; its mesh has these, by name or number: %s; sides of its bounding box: %s", body,
          name ? name : "", what, list[0] ? list : "none", box);
}

/* The coordinates of a face, dimension by dimension. In one dimension a face is its own vertex. */
static PetscErrorCode GetExtent(DM dm, PetscInt face, PetscInt dim, PetscInt vstart, PetscInt vend, PetscSection section,
                                const PetscScalar x[], PetscReal lower[3], PetscReal upper[3])
{
  PetscInt *closure = NULL, n;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 3; d++) lower[d] = PETSC_MAX_REAL;
  for (PetscInt d = 0; d < 3; d++) upper[d] = -PETSC_MAX_REAL;
  PetscCall(DMPlexGetTransitiveClosure(dm, face, PETSC_TRUE, &n, &closure));
  for (PetscInt p = 0; p < n; p++) {
    PetscInt offset;

    if (closure[2 * p] < vstart || closure[2 * p] >= vend) continue;
    PetscCall(PetscSectionGetOffset(section, closure[2 * p], &offset));
    for (PetscInt d = 0; d < dim; d++) {
      lower[d] = PetscMin(lower[d], PetscRealPart(x[offset + d]));
      upper[d] = PetscMax(upper[d], PetscRealPart(x[offset + d]));
    }
  }
  PetscCall(DMPlexRestoreTransitiveClosure(dm, face, PETSC_TRUE, &n, &closure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether all vertices of a face with this extent are on the side of the bounding box that the selection has, if it has one */
static PetscBool OnSide(const Selection *selection, const PetscReal lower[3], const PetscReal upper[3])
{
  const PetscInt d = selection->side / 2;

  if (selection->side < 0) return PETSC_TRUE;
  return (PetscBool)(PetscAbsReal(lower[d] - selection->place) <= selection->tolerance &&
                     PetscAbsReal(upper[d] - selection->place) <= selection->tolerance);
}

/* The faces of the boundary. Faces between two ranks do not belong to it. */
static PetscErrorCode MarkBoundary(DM dm, DMLabel *boundary)
{
  PetscFunctionBegin;
  PetscCall(DMLabelCreate(PETSC_COMM_SELF, "boundary", boundary));
  PetscCall(DMPlexMarkBoundaryFaces(dm, 1, *boundary));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* This rank's boundary faces of some selections, all found in one pass */
static PetscErrorCode CollectFaces(DM dm, DMLabel boundary, PetscInt n_selections, const Selection selections[], PetscInt n_faces[],
                                   PetscInt *faces[])
{
  IS                 points;
  const PetscInt    *point;
  const PetscScalar *x;
  PetscSection       section;
  Vec                coordinates;
  PetscInt           n, dim, vstart, vend;
  PetscBool          by_side = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(DMLabelGetStratumSize(boundary, 1, &n));
  PetscCall(DMGetCoordinateSection(dm, &section));
  PetscCall(DMGetCoordinatesLocal(dm, &coordinates));
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(DMPlexGetDepthStratum(dm, 0, &vstart, &vend));
  for (PetscInt s = 0; s < n_selections; s++) {
    PetscCall(PetscMalloc1(n, &faces[s]));
    n_faces[s] = 0;
    if (selections[s].side >= 0) by_side = PETSC_TRUE;
  }
  if (n) {
    PetscCall(VecGetArrayRead(coordinates, &x));
    PetscCall(DMLabelGetStratumIS(boundary, 1, &points));
    PetscCall(ISGetIndices(points, &point));
    for (PetscInt i = 0; i < n; i++) {
      PetscReal lower[3], upper[3];

      if (by_side) PetscCall(GetExtent(dm, point[i], dim, vstart, vend, section, x, lower, upper));
      for (PetscInt s = 0; s < n_selections; s++) {
        PetscBool in = PETSC_TRUE;

        if (selections[s].label) in = InLabel(&selections[s], point[i]);
        else if (selections[s].by_value) in = PETSC_FALSE; /* only other ranks have the label */
        if (in && OnSide(&selections[s], lower, upper)) faces[s][n_faces[s]++] = point[i];
      }
    }
    PetscCall(ISRestoreIndices(points, &point));
    PetscCall(ISDestroy(&points));
    PetscCall(VecRestoreArrayRead(coordinates, &x));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Labels the faces on the sides of the bounding box as xmin, xmax, ... A side without faces on any rank gets no label. */
PetscErrorCode MeshMarkSides(DM dm)
{
  Selection selections[6];
  DMLabel   boundary;
  PetscReal lower[3], upper[3];
  PetscInt  dim, n[6], any[6], *faces[6];

  PetscFunctionBegin;
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(DMGetBoundingBox(dm, lower, upper));
  PetscCall(MarkBoundary(dm, &boundary));
  for (PetscInt side = 0; side < 2 * dim; side++) {
    selections[side] = (Selection){.side = -1};
    UseSide(side, lower, upper, &selections[side]);
  }
  PetscCall(CollectFaces(dm, boundary, 2 * dim, selections, n, faces));
  PetscCall(PetscArraycpy(any, n, 2 * dim));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, any, (PetscMPIInt)(2 * dim), MPIU_INT, MPI_MAX, PetscObjectComm((PetscObject)dm)));
  for (PetscInt side = 0; side < 2 * dim; side++) {
    DMLabel label;

    if (any[side]) {
      PetscCall(DMCreateLabel(dm, sides[side]));
      PetscCall(DMGetLabel(dm, sides[side], &label));
      for (PetscInt i = 0; i < n[side]; i++) PetscCall(DMLabelSetValue(label, faces[side][i], 1));
    }
    PetscCall(PetscFree(faces[side]));
  }
  PetscCall(DMLabelDestroy(&boundary));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a mesh has a surface of that name, with faces on its boundary or not */
PetscErrorCode MeshHasSurface(DM dm, const char name[], PetscBool *has)
{
  Selection selection = {.side = -1};
  PetscInt  dim;

  PetscFunctionBegin;
  PetscCall(FindLabel(PetscObjectComm((PetscObject)dm), dm, name, "Face Sets", &selection, has));
  PetscCall(DMGetCoordinateDim(dm, &dim));
  for (PetscInt side = 0; side < 2 * dim && !*has; side++) PetscCall(PetscStrcmp(name, sides[side], has));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Faces of a mesh's boundary by the name of a surface: a label of the mesh, a number in its "Face Sets", or a side of its bounding box
   (xmin, xmax, ...), in this order of precedence; NULL or empty: the whole boundary. `faces`: points of the mesh, ascending, to be freed.
   Each face is on one rank, unless the mesh was distributed with an overlap. A name that the mesh does not have, and a surface without any
   face of the boundary, end with an error that lists the surfaces. Collective */
PetscErrorCode MeshGetSurface(DM dm, const char name[], PetscInt *n_faces, PetscInt *faces[])
{
  Selection selection = {.side = -1};
  DMLabel   boundary;
  PetscInt  total;
  PetscBool found = PETSC_FALSE;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(dm, DM_CLASSID, 1);
  PetscAssertPointer(n_faces, 3);
  PetscAssertPointer(faces, 4);
  if (name && name[0]) {
    PetscCall(FindSurface(dm, name, PETSC_FALSE, PETSC_TRUE, &selection, &found));
    if (!found) PetscCall(RefuseSurface(dm, name, ""));
  }
  PetscCall(MarkBoundary(dm, &boundary));
  PetscCall(CollectFaces(dm, boundary, 1, &selection, n_faces, faces));
  PetscCall(DMLabelDestroy(&boundary));
  PetscCallMPI(MPI_Allreduce(n_faces, &total, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)dm)));
  if (!total) {
    PetscCall(PetscFree(*faces));
    PetscCall(RefuseSurface(dm, name, " with faces on its boundary"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of a mesh on this rank alone; no faces without such a surface, a side of the bounding box only if `by_side` */
PetscErrorCode MeshFindSurface(DM dm, const char name[], PetscBool by_side, PetscInt *n_faces, PetscInt *faces[])
{
  Selection selection = {.side = -1};
  DMLabel   boundary;
  PetscBool found;
  PetscInt  start, end;

  PetscFunctionBegin;
  *n_faces = 0;
  *faces   = NULL;
  PetscCall(FindSurface(dm, name, PETSC_TRUE, by_side, &selection, &found));
  if (!found) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMLabelCreate(PETSC_COMM_SELF, "boundary", &boundary));
  PetscCall(DMPlexGetHeightStratum(dm, 1, &start, &end));
  for (PetscInt f = start; f < end; f++) {
    PetscInt n;

    PetscCall(DMPlexGetSupportSize(dm, f, &n));
    if (n == 1) PetscCall(DMLabelSetValue(boundary, f, 1));
  }
  PetscCall(CollectFaces(dm, boundary, 1, &selection, n_faces, faces));
  PetscCall(DMLabelDestroy(&boundary));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks vertices on all ranks that have them, if one of these ranks has marked them */
static PetscErrorCode ShareMarks(DM dm, PetscInt marks[])
{
  PetscSF     sf;
  PetscInt    roots, start, end, *shared;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)dm), &size));
  PetscCall(DMGetPointSF(dm, &sf));
  PetscCall(PetscSFGetGraph(sf, &roots, NULL, NULL, NULL));
  if (size == 1 || roots < 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMPlexGetChart(dm, &start, &end));
  PetscCall(PetscMalloc1(end - start, &shared));
  PetscCall(PetscArraycpy(shared, marks, end - start));
  PetscCall(PetscSFReduceBegin(sf, MPIU_INT, marks, shared, MPI_MAX));
  PetscCall(PetscSFReduceEnd(sf, MPIU_INT, marks, shared, MPI_MAX));
  PetscCall(PetscArraycpy(marks, shared, end - start));
  PetscCall(PetscSFBcastBegin(sf, MPIU_INT, shared, marks, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_INT, shared, marks, MPI_REPLACE));
  PetscCall(PetscFree(shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MarkVerticesOfFaces(DM dm, PetscInt n, const PetscInt faces[], PetscInt start, PetscInt vstart, PetscInt vend,
                                          PetscInt marks[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++) {
    PetscInt *closure = NULL, n_points;

    PetscCall(DMPlexGetTransitiveClosure(dm, faces[f], PETSC_TRUE, &n_points, &closure));
    for (PetscInt p = 0; p < n_points; p++)
      if (closure[2 * p] >= vstart && closure[2 * p] < vend) marks[closure[2 * p] - start] = 1;
    PetscCall(DMPlexRestoreTransitiveClosure(dm, faces[f], PETSC_TRUE, &n_points, &closure));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells of a block by its name, or by its number; found: any rank has some. To be freed */
PetscErrorCode MeshFindBlock(DM dm, const char name[], PetscInt *n, PetscInt *cells[], PetscBool *found)
{
  Selection selection = {.side = -1};
  PetscInt  start, end;

  PetscFunctionBegin;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &start, &end));
  PetscCall(FindLabel(PetscObjectComm((PetscObject)dm), dm, name, "Cell Sets", &selection, found));
  if (*found && !selection.by_value) PetscCall(MeshLabelHasPoints(dm, selection.label, start, end, found));
  PetscCall(PetscMalloc1(end - start, cells));
  *n = 0;
  for (PetscInt c = start; c < end && selection.label; c++)
    if (InLabel(&selection, c)) (*cells)[(*n)++] = c;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Vertices of a node set or surface by its name. `vertices`: points, ascending, ghosts too; free with `PetscFree()`. Collective */
PetscErrorCode MeshGetNodeSet(DM dm, const char name[], PetscInt *n_vertices, PetscInt *vertices[])
{
  Selection selection = {.side = -1};
  PetscInt  start, end, vstart, vend, *marks;
  PetscBool found = PETSC_FALSE;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(dm, DM_CLASSID, 1);
  PetscAssertPointer(n_vertices, 3);
  PetscAssertPointer(vertices, 4);
  PetscCall(DMPlexGetDepthStratum(dm, 0, &vstart, &vend));
  if (name && name[0]) PetscCall(FindLabel(PetscObjectComm((PetscObject)dm), dm, name, "Vertex Sets", &selection, &found));
  if (found && !selection.by_value) PetscCall(MeshLabelHasPoints(dm, selection.label, vstart, vend, &found));
  PetscCall(DMPlexGetChart(dm, &start, &end));
  PetscCall(PetscCalloc1(end - start, &marks));
  if (found) {
    for (PetscInt v = vstart; v < vend; v++)
      if (selection.label) marks[v - start] = InLabel(&selection, v);
  } else {
    PetscInt       n, *faces;
    PetscErrorCode error = MeshGetSurface(dm, name, &n, &faces);

    if (error) PetscCall(PetscFree(marks));
    PetscCall(error);
    PetscCall(MarkVerticesOfFaces(dm, n, faces, start, vstart, vend, marks));
    PetscCall(PetscFree(faces));
  }
  PetscCall(ShareMarks(dm, marks));
  *n_vertices = 0;
  for (PetscInt v = vstart; v < vend; v++) *n_vertices += marks[v - start];
  PetscCall(PetscMalloc1(*n_vertices, vertices));
  *n_vertices = 0;
  for (PetscInt v = vstart; v < vend; v++)
    if (marks[v - start]) (*vertices)[(*n_vertices)++] = v;
  PetscCall(PetscFree(marks));
  PetscFunctionReturn(PETSC_SUCCESS);
}
