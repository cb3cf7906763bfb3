/* Which faces of a body may touch another at all: those that see it. */
#include "interfaceimpl.h"

/* Directions are grouped by where they meet a cube whose sides have 5 x 5 cells: an odd number, so that axes are in the middle of a cell */
#define CELLS  5
#define GROUPS (6 * CELLS * CELLS)
/* Components of a normal that differ by less, relative, count as equal, so that round-off does not choose the side of the cube */
#define EQUAL_COMPONENTS 1e-9
/* Added to the bound of the overlap, relative to that bound and to the extent of the larger surface: covers round-off */
#define OVERLAP_MARGIN 1e-6
#define OVERLAP_FLOOR  1e-9

/* The faces of all ranks whose normals are in one cell: bounds of their normals n, of their centroids x, and of n . (x - centre). All
   bounds are minima, so that one reduction finds them: an upper bound is kept with its sign changed. */
typedef struct {
  PetscReal normal[2][3], x[2][3], support;
} Group;
#define GROUP_VALUES 13

typedef struct {
  PetscReal centre[3], extent;
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
  directions->extent = 0;
  for (PetscInt d = 0; d < 3; d++) {
    directions->centre[d] = (box[d] - box[3 + d]) / 2;
    directions->extent    = PetscMax(directions->extent, -box[3 + d] - box[d]);
  }
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

/* How far the whole body of a surface reaches along each direction n: the largest n . x of all its nodes [m] */
static PetscErrorCode GetSupport(MPI_Comm comm, Surface surface, PetscInt n, const PetscReal directions[][3], PetscReal support[])
{
  const PetscInt     dim = surface->data.dim;
  const PetscScalar *x;
  PetscInt           size;
  Vec                coordinates;

  PetscFunctionBegin;
  PetscCall(DMGetCoordinatesLocal(surface->dm, &coordinates));
  PetscCall(VecGetLocalSize(coordinates, &size));
  PetscCall(VecGetArrayRead(coordinates, &x));
  for (PetscInt i = 0; i < n; i++) support[i] = -PETSC_MAX_REAL;
  for (PetscInt at = 0; at < size; at += dim) {
    PetscReal position[3] = {0};

    for (PetscInt d = 0; d < dim; d++) position[d] = PetscRealPart(x[at + d]);
    for (PetscInt i = 0; i < n; i++) support[i] = PetscMax(support[i], Dot(position, directions[i]));
  }
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, support, (PetscMPIInt)n, MPIU_REAL, MPIU_MAX, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void AddDirections(Directions *directions, PetscReal sign, PetscInt *n, PetscReal list[][3])
{
  for (PetscInt g = 0; g < GROUPS; g++) {
    Group *group = &directions->groups[g];

    if (group->support == PETSC_MAX_REAL) continue;
    for (PetscInt d = 0; d < 3; d++) list[*n][d] = sign * (group->normal[0][d] - group->normal[1][d]) / 2;
    if (Normalize(list[*n]) > 0) (*n)++;
  }
}

/* The directions of both surfaces, and an upper bound of the depth by which the convex hulls of two bodies overlap [m]: the least of the
   depths along the mean normals of the groups and along the axes. If the depth along any direction is negative, the bodies are apart
   (theorem of separating axes). */
static PetscErrorCode ComputeOverlap(MPI_Comm comm, Surface a, Surface b, Directions directions[2], PetscReal *overlap)
{
  PetscReal *support[2];
  PetscReal(*list)[3];
  PetscInt n = 0;

  PetscFunctionBegin;
  PetscCall(GetDirections(comm, a, &directions[0]));
  PetscCall(GetDirections(comm, b, &directions[1]));
  PetscCall(PetscMalloc3(2 * GROUPS + 6, &list, 2 * GROUPS + 6, &support[0], 2 * GROUPS + 6, &support[1]));
  for (PetscInt side = 0; side < 2 * a->data.dim; side++, n++)
    for (PetscInt d = 0; d < 3; d++) list[n][d] = d == side / 2 ? (side % 2 ? 1 : -1) : 0;
  AddDirections(&directions[0], 1, &n, list);
  AddDirections(&directions[1], -1, &n, list);
  PetscCall(GetSupport(comm, a, n, (const PetscReal(*)[3])list, support[0]));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt d = 0; d < 3; d++) list[i][d] = -list[i][d];
  PetscCall(GetSupport(comm, b, n, (const PetscReal(*)[3])list, support[1]));
  *overlap = PETSC_MAX_REAL;
  for (PetscInt i = 0; i < n; i++) *overlap = PetscMin(*overlap, support[0][i] + support[1][i]);
  *overlap = PetscMax(*overlap, 0) * (1 + OVERLAP_MARGIN) + OVERLAP_FLOOR * PetscMax(directions[0].extent, directions[1].extent);
  PetscCall(PetscFree3(list, support[0], support[1]));
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
    PetscCall(ComputeOverlap(PetscObjectComm((PetscObject)a->dm), a, b, directions, &depth));
  }
  for (PetscInt side = 0; side < 2; side++) {
    if (!surfaces[side] || !wanted[side]) continue;
    PetscCall(PetscMalloc1(surfaces[side]->data.n_faces, &keep[side]));
    for (PetscInt f = 0; f < surfaces[side]->data.n_faces; f++) {
      const PetscReal *normal = surfaces[side]->data.face_normals + 3 * f;
      PetscReal        x[3], distance, gradient[3];

      Centroid(&surfaces[side]->data, f, x);
      if (directions) {
        keep[side][f] = SeesGroups(x, normal, &directions[1 - side], depth);
        continue;
      }
      PetscCall(ObstacleGetGap(obstacle, x, &distance, gradient));
      keep[side][f] = (PetscBool)(Dot(normal, gradient) < OPPOSED);
    }
  }
  for (PetscInt side = 0; side < 2; side++) {
    if (surfaces[side] && wanted[side]) PetscCall(SurfaceKeepFaces(surfaces[side], keep[side]));
    PetscCall(PetscFree(keep[side]));
  }
  PetscCall(PetscFree(directions));
  PetscFunctionReturn(PETSC_SUCCESS);
}
