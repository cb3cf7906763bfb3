/* Which faces of a body may touch another at all: those that see it. */
#include "interfaceimpl.h"

/* Directions are grouped by where they meet a cube whose sides have 5 x 5 cells: an odd number, so that axes are in the middle of a cell */
#define CELLS  5
#define GROUPS (6 * CELLS * CELLS)
/* Components of a normal that differ by less, relative, count as equal, so that round-off does not choose the side of the cube */
#define EQUAL_COMPONENTS 1e-9
/* Added to the overlap, relative to the extent of the larger surface: covers round-off */
#define ROUND_OFF 1e-9

/* The faces of all ranks whose normals are in one cell: bounds of their normals n, of their centroids x, and of n . (x - centre). All
   bounds are minima, so that one reduction finds them: an upper bound is kept with its sign changed. */
typedef struct {
  PetscReal normal[2][3], x[2][3], support;
} Group;
#define GROUP_VALUES 13

typedef struct {
  PetscReal centre[3];
  Group     groups[GROUPS];
} Directions;

static PetscInt GroupOf(const PetscReal normal[])
{
  PetscInt  axis = 0, cell[2];
  PetscReal largest;

  for (PetscInt d = 1; d < 3; d++)
    if (PetscAbsReal(normal[d]) > PetscAbsReal(normal[axis]) * (1 + EQUAL_COMPONENTS)) axis = d;
  largest = PetscAbsReal(normal[axis]);
  for (PetscInt d = 0; d < 2; d++) cell[d] = PetscMin((PetscInt)((normal[(axis + 1 + d) % 3] / largest + 1) / 2 * CELLS), CELLS - 1);
  return ((2 * axis + (normal[axis] > 0)) * CELLS + cell[0]) * CELLS + cell[1];
}

static void Centroid(const SurfaceData *data, PetscInt f, PetscReal x[])
{
  for (PetscInt d = 0; d < 3; d++) {
    x[d] = 0;
    for (PetscInt k = 0; k < data->face_nodes; k++)
      x[d] += data->positions[3 * data->faces[f * data->face_nodes + k] + d] / data->face_nodes;
  }
}

static PetscErrorCode GetDirections(MPI_Comm comm, Surface surface, Directions *directions)
{
  const SurfaceData *data = &surface->data;
  PetscReal          box[6];

  PetscFunctionBegin;
  BoxFind(data->n_nodes, data->positions, box);
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, box, 6, MPIU_REAL, MPIU_MIN, comm));
  for (PetscInt d = 0; d < 3; d++) directions->centre[d] = (box[d] - box[3 + d]) / 2;
  for (PetscInt i = 0; i < GROUPS * GROUP_VALUES; i++) ((PetscReal *)directions->groups)[i] = PETSC_MAX_REAL;
  for (PetscInt f = 0; f < data->n_faces; f++) {
    const PetscReal *normal = data->face_normals + 3 * f;
    Group           *group  = &directions->groups[GroupOf(normal)];
    PetscReal        x[3], support = 0;

    Centroid(data, f, x);
    for (PetscInt d = 0; d < 3; d++) {
      support += normal[d] * (x[d] - directions->centre[d]);
      group->normal[0][d] = PetscMin(group->normal[0][d], normal[d]);
      group->normal[1][d] = PetscMin(group->normal[1][d], -normal[d]);
      group->x[0][d]      = PetscMin(group->x[0][d], x[d]);
      group->x[1][d]      = PetscMin(group->x[1][d], -x[d]);
    }
    group->support = PetscMin(group->support, support);
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, directions->groups, GROUPS * GROUP_VALUES, MPIU_REAL, MPIU_MIN, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest scalar product of `a` with any vector within the bounds */
static PetscReal LargestProduct(const PetscReal a[], PetscReal bounds[2][3])
{
  PetscReal sum = 0;

  for (PetscInt d = 0; d < 3; d++) sum += PetscMax(a[d] * bounds[0][d], -a[d] * bounds[1][d]);
  return sum;
}

/* Whether a face may see any face of the partner. Two faces see each other if their normals are opposed, and if each lies before the plane
   of the other, or behind that plane by no more than `depth`, by which the bodies overlap [m]. */
static PetscBool SeesGroups(const PetscReal x[], const PetscReal normal[], Directions *others, PetscReal depth)
{
  for (PetscInt g = 0; g < GROUPS; g++) {
    Group          *group   = &others->groups[g];
    const PetscReal back[3] = {-normal[0], -normal[1], -normal[2]},
                    from[3] = {x[0] - others->centre[0], x[1] - others->centre[1], x[2] - others->centre[2]};

    if (group->support == PETSC_MAX_REAL || -LargestProduct(back, group->normal) >= OPPOSED) continue;
    if (LargestProduct(normal, group->x) - Dot(normal, x) < -depth) continue;
    if (LargestProduct(from, group->normal) - group->support < -depth) continue;
    return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static PetscErrorCode SeesObstacle(Obstacle obstacle, const PetscReal x[], const PetscReal normal[], PetscBool *sees)
{
  PetscReal distance, gradient[3];

  PetscFunctionBegin;
  PetscCall(ObstacleGetGap(obstacle, x, &distance, gradient));
  *sees = (PetscBool)(Dot(normal, gradient) < OPPOSED);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How deep two bodies are inside each other at any point, with some room for round-off [m]. Collective on a communicator that has both. */
PetscErrorCode SurfacesGetOverlap(MPI_Comm comm, const Surface surfaces[2], PetscReal *overlap)
{
  SurfaceDepth *depths;
  PetscReal     boxes[12], extent = 0;
  PetscInt      n;

  PetscFunctionBegin;
  PetscCall(SurfacesFindDepths(comm, 2, surfaces, 0, NULL, &n, &depths));
  for (PetscInt side = 0; side < 2; side++) BoxFind(surfaces[side]->data.n_nodes, surfaces[side]->data.positions, boxes + 6 * side);
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, boxes, 12, MPIU_REAL, MPIU_MIN, comm));
  for (PetscInt k = 0; k < 6; k++) extent = PetscMax(extent, -boxes[6 * (k / 3) + k % 3] - boxes[6 * (k / 3) + 3 + k % 3]);
  *overlap = 0;
  for (PetscInt i = 0; i < n; i++) *overlap = PetscMax(*overlap, depths[i].depth);
  *overlap += ROUND_OFF * extent;
  PetscCall(PetscFree(depths));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Restricts surfaces to the faces that see the partner, `b` or the obstacle, the other one being NULL; `keep_a`, `keep_b`: which of both
   are restricted. In the reference positions, a face sees another one if their normals are opposed and each lies before the plane of the
   other, or behind it by no more than the bodies overlap. Faces of the partner are compared in groups of similar direction: all faces
   that see one are kept, and maybe some more. A surface may end up without any face. */
PetscErrorCode SurfaceKeepFacing(Surface a, Surface b, Obstacle obstacle, PetscBool keep_a, PetscBool keep_b)
{
  Surface     surfaces[2] = {a, b};
  PetscBool   wanted[2] = {keep_a, keep_b}, *keep[2] = {NULL, NULL};
  Directions *directions = NULL;
  PetscReal   depth      = 0;

  PetscFunctionBegin;
  if (b)
    PetscCheck(a->data.dim == b->data.dim, PetscObjectComm((PetscObject)a->dm), PETSC_ERR_USER_INPUT,
               "The two bodies of a contact pair have %" PetscInt_FMT " and %" PetscInt_FMT " dimensions", a->data.dim, b->data.dim);
  if (!keep_a && !keep_b) PetscFunctionReturn(PETSC_SUCCESS);
  if (b) {
    PetscCall(PetscMalloc1(2, &directions));
    for (PetscInt side = 0; side < 2; side++)
      PetscCall(GetDirections(PetscObjectComm((PetscObject)surfaces[side]->dm), surfaces[side], &directions[side]));
    PetscCall(SurfacesGetOverlap(PetscObjectComm((PetscObject)a->dm), surfaces, &depth));
  }
  for (PetscInt side = 0; side < 2; side++) {
    if (!surfaces[side] || !wanted[side]) continue;
    PetscCall(PetscMalloc1(surfaces[side]->data.n_faces, &keep[side]));
    for (PetscInt f = 0; f < surfaces[side]->data.n_faces; f++) {
      const PetscReal *normal = surfaces[side]->data.face_normals + 3 * f;
      PetscReal        x[3];

      Centroid(&surfaces[side]->data, f, x);
      if (b) keep[side][f] = SeesGroups(x, normal, &directions[1 - side], depth);
      else PetscCall(SeesObstacle(obstacle, x, normal, &keep[side][f]));
    }
  }
  for (PetscInt side = 0; side < 2; side++) {
    if (surfaces[side] && wanted[side]) PetscCall(SurfaceKeepFaces(surfaces[side], keep[side]));
    PetscCall(PetscFree(keep[side]));
  }
  PetscCall(PetscFree(directions));
  PetscFunctionReturn(PETSC_SUCCESS);
}
