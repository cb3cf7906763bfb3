/* Boxes of bars, quadrilaterals and hexahedra that all ranks make together: a rank makes the brick of cells that is its own.

   The box is cut in two, again and again: no graph is divided and no cell is sent. Ranks exchange which points of their bricks' sides are
   the same, by places in a lattice of half cells, in which vertices have even numbers along all axes and the middle of a cell odd ones.

   A step is over once the rank with most elements has done with them and, after that, the rank with most contact faces with those. Cuts
   across the longest edge leave all contact faces to the bricks at one end of a bar. So cuts along the normal of the contact surface are
   made rarer, step by step, up to none at all, and the division that costs least is taken. */
#include "meshimpl.h"
#include <petscsf.h>
#include <sys/petsccompat.h>

/* Most cells of a brick over their mean. Beyond, as with few cells for many ranks, PETSc divides the box as a graph. */
#define MOST_IMBALANCE 1.1
/* Work for a face that two bricks share, whose nodes are packed, sent and added up, in units of the work for an element */
#define COST_OF_SHARED 0.2
/* An edge along a contact normal counts with 1, 1/2, 1/4, ... of its cells, at last with none: so many divisions are compared */
#define DIVISIONS 8

/* The cells begin[d] to end[d] - 1 along each axis d */
typedef struct {
  PetscInt begin[3], end[3];
} Brick;

/* The axis across which a brick is cut: that with most cells, those along the normals of contact surfaces counting less */
static PetscInt ChooseAxis(const MeshBox *box, const Brick *brick)
{
  PetscReal most = -1;
  PetscInt  axis = 0;

  for (PetscInt d = 0; d < box->dim; d++) {
    const PetscInt n = brick->end[d] - brick->begin[d];

    if (n < 2 || box->along[d] * (PetscReal)n <= most) continue;
    most = box->along[d] * (PetscReal)n;
    axis = d;
  }
  return axis;
}

/* Cuts the box so often that each rank has a brick */
static Brick CutForRank(const MeshBox *box, PetscMPIInt size, PetscMPIInt rank)
{
  Brick brick = {{0, 0, 0}, {1, 1, 1}};

  for (PetscInt d = 0; d < box->dim; d++) brick.end[d] = box->faces[d];
  while (size > 1) {
    const PetscMPIInt below = size / 2;
    const PetscInt    axis = ChooseAxis(box, &brick), n = brick.end[axis] - brick.begin[axis];
    const PetscInt    cut = brick.begin[axis] + (PetscInt)((2 * (PetscInt64)n * below + size) / (2 * size)); /* rounded */

    if (rank < below) {
      brick.end[axis] = cut;
      size            = below;
    } else {
      brick.begin[axis] = cut;
      size -= below;
      rank -= below;
    }
  }
  return brick;
}

static PetscReal CountCells(const Brick *brick)
{
  PetscReal n = 1;

  for (PetscInt d = 0; d < 3; d++) n *= (PetscReal)(brick->end[d] - brick->begin[d]);
  return n;
}

/* Faces of a brick in contact surfaces, and faces that it shares with other bricks */
static void CountFaces(const MeshBox *box, const Brick *brick, PetscReal *contact, PetscReal *shared)
{
  const PetscReal cells = CountCells(brick);

  *contact = *shared = 0;
  for (PetscInt side = 0; side < 2 * box->dim && cells > 0; side++) {
    const PetscInt  d     = side / 2;
    const PetscReal faces = cells / (PetscReal)(brick->end[d] - brick->begin[d]);

    if (side % 2 ? brick->end[d] < box->faces[d] : brick->begin[d] > 0) *shared += faces;
    else if (box->contact[side]) *contact += faces;
  }
}

/* What a step costs with the bricks as they are cut, in units of the work for an element; most: cells of the largest brick */
static PetscReal FindCost(const MeshBox *box, PetscMPIInt size, PetscReal *most)
{
  PetscReal most_contact = 0, most_shared = 0;

  *most = 0;
  for (PetscMPIInt rank = 0; rank < size; rank++) {
    const Brick brick = CutForRank(box, size, rank);
    PetscReal   contact, shared;

    CountFaces(box, &brick, &contact, &shared);
    *most        = PetscMax(*most, CountCells(&brick));
    most_contact = PetscMax(most_contact, contact);
    most_shared  = PetscMax(most_shared, shared);
  }
  return *most + box->contact_cost * most_contact + COST_OF_SHARED * most_shared;
}

/* Chooses how the box is cut; balance: whether bricks are near enough in size when cut across the longest edges */
PetscErrorCode MeshBricksChoose(MeshBox *box, PetscBool *balance)
{
  const PetscMPIInt size = box->ranks->n;
  PetscReal         all = 1, most, least_cost, weight = 1, best = 1;
  PetscBool         any = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < box->dim; d++) {
    all *= (PetscReal)box->faces[d];
    box->along[d] = 1;
    if (box->contact[2 * d] || box->contact[2 * d + 1]) any = PETSC_TRUE;
  }
  least_cost = FindCost(box, size, &most);
  *balance   = (PetscBool)(most * size <= MOST_IMBALANCE * all);
  if (!any || !*balance || size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 1; i < DIVISIONS; i++) {
    PetscReal cost;

    weight = i < DIVISIONS - 1 ? weight / 2 : 0;
    for (PetscInt d = 0; d < box->dim; d++) box->along[d] = box->contact[2 * d] || box->contact[2 * d + 1] ? weight : 1;
    cost = FindCost(box, size, &most);
    if (cost >= least_cost) continue;
    least_cost = cost;
    best       = weight;
  }
  for (PetscInt d = 0; d < box->dim; d++) box->along[d] = box->contact[2 * d] || box->contact[2 * d + 1] ? best : 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cones and their orientations from one mesh to another with the same points */
static PetscErrorCode CopyCones(DM from, DM to)
{
  PetscInt end, size = 0, *cones[2], *orientations[2];

  PetscFunctionBegin;
  PetscCall(DMPlexGetChart(from, NULL, &end));
  PetscCall(DMPlexSetChart(to, 0, end));
  for (PetscInt p = 0; p < end; p++) {
    PetscInt n;

    PetscCall(DMPlexGetConeSize(from, p, &n));
    PetscCall(DMPlexSetConeSize(to, p, n));
    size += n;
  }
  PetscCall(DMSetUp(to));
  PetscCall(DMPlexGetCones(from, &cones[0]));
  PetscCall(DMPlexGetConeOrientations(from, &orientations[0]));
  PetscCall(DMPlexGetCones(to, &cones[1]));
  PetscCall(DMPlexGetConeOrientations(to, &orientations[1]));
  PetscCall(PetscArraycpy(cones[1], cones[0], size));
  PetscCall(PetscArraycpy(orientations[1], orientations[0], size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the points of the brick, in PETSc's own order for a box, and the places of all but its cells in the lattice of half cells, three
   numbers each. With cells of size 1 the coordinates of a vertex are its place. */
static PetscErrorCode MakePoints(const MeshBox *box, const Brick *brick, DM dm, PetscInt **places)
{
  PetscInt           faces[3], end, depth, cstart, cend, vstart, vend;
  PetscReal          lower[3] = {0}, upper[3] = {0};
  const PetscScalar *x;
  Vec                coordinates;
  DM                 part;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < box->dim; d++) {
    faces[d] = brick->end[d] - brick->begin[d];
    lower[d] = (PetscReal)brick->begin[d];
    upper[d] = (PetscReal)brick->end[d];
  }
  PetscCall(DMPlexCreateBoxMesh(PETSC_COMM_SELF, box->dim, PETSC_FALSE, faces, lower, upper, NULL, PETSC_TRUE, BOX_NOT_PERIODIC & part));
  PetscCall(CopyCones(part, dm));
  PetscCall(DMPlexGetChart(part, NULL, &end));
  PetscCall(PetscCalloc1(3 * end, places));
  PetscCall(DMPlexGetDepthStratum(part, 0, &vstart, &vend));
  PetscCall(DMGetCoordinatesLocal(part, &coordinates));
  PetscCall(VecGetArrayRead(coordinates, &x));
  for (PetscInt v = vstart; v < vend; v++)
    for (PetscInt d = 0; d < box->dim; d++) (*places)[3 * v + d] = (PetscInt)(2 * PetscRealPart(x[(v - vstart) * box->dim + d]) + 0.5);
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  for (depth = 1; depth < box->dim; depth++) {
    PetscCall(DMPlexGetDepthStratum(part, depth, &cstart, &cend));
    for (PetscInt p = cstart; p < cend; p++) {
      const PetscInt *cone;
      PetscInt        n;

      PetscCall(DMPlexGetConeSize(part, p, &n));
      PetscCall(DMPlexGetCone(part, p, &cone));
      for (PetscInt d = 0; d < box->dim; d++) {
        PetscInt sum = 0;

        for (PetscInt k = 0; k < n; k++) sum += (*places)[3 * cone[k] + d];
        (*places)[3 * p + d] = sum / n;
      }
    }
  }
  PetscCall(DMDestroy(&part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells the ranks which of their points are the same */
static PetscErrorCode ShareSides(const MeshBox *box, const Brick *brick, const PetscInt places[], DM dm)
{
  PetscInt           n = 0, all = 1, end, cstart, cend, n_leaves, *points, *numbers, *remote, *leaves;
  const PetscInt    *leaf;
  const PetscSFNode *root;
  PetscSFNode       *roots;
  PetscSF            matching, sf;
  PetscLayout        layout;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < box->dim; d++) all *= 2 * box->faces[d] + 1;
  PetscCall(DMPlexGetChart(dm, NULL, &end));
  PetscCall(DMPlexGetHeightStratum(dm, 0, &cstart, &cend));
  PetscCall(PetscMalloc3(end, &points, end, &numbers, end, &remote));
  for (PetscInt p = 0; p < end; p++) {
    PetscBool shared = PETSC_FALSE;
    PetscInt  number = 0;

    if (p >= cstart && p < cend) continue;
    for (PetscInt d = box->dim - 1; d >= 0; d--) {
      const PetscInt place = places[3 * p + d];

      if (place == 2 * brick->begin[d] && place > 0) shared = PETSC_TRUE;
      if (place == 2 * brick->end[d] && place < 2 * box->faces[d]) shared = PETSC_TRUE;
      number = number * (2 * box->faces[d] + 1) + place;
    }
    if (!shared) continue;
    points[n]    = p;
    numbers[n++] = number;
  }
  PetscCall(PetscLayoutCreate(PetscObjectComm((PetscObject)dm), &layout));
  PetscCall(PetscLayoutSetSize(layout, all));
  PetscCall(PetscLayoutSetBlockSize(layout, 1));
  PetscCall(PetscSFCreateByMatchingIndices(layout, n, numbers, NULL, 0, n, numbers, NULL, 0, NULL, &matching));
  PetscCall(PetscLayoutDestroy(&layout));
  /* from places in the list of shared points to points of the mesh, here and on the rank that owns them */
  PetscCall(PetscSFBcastBegin(matching, MPIU_INT, points, remote, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(matching, MPIU_INT, points, remote, MPI_REPLACE));
  PetscCall(PetscSFGetGraph(matching, NULL, &n_leaves, &leaf, &root));
  PetscCall(PetscMalloc1(n_leaves, &leaves));
  PetscCall(PetscMalloc1(n_leaves, &roots));
  for (PetscInt i = 0; i < n_leaves; i++) {
    const PetscInt k = leaf ? leaf[i] : i;

    leaves[i]      = points[k];
    roots[i].rank  = root[i].rank;
    roots[i].index = remote[k];
  }
  PetscCall(PetscSFDestroy(&matching));
  PetscCall(PetscFree3(points, numbers, remote));
  PetscCall(DMGetPointSF(dm, &sf));
  PetscCall(PetscSFSetGraph(sf, end, n_leaves, leaves, PETSC_OWN_POINTER, roots, PETSC_OWN_POINTER));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Coordinates by the formulas by which PETSc makes a whole box, so that they are the same bit for bit on any number of ranks */
static PetscErrorCode SetCoordinates(const MeshBox *box, const PetscInt places[], DM dm)
{
  PetscSection section;
  PetscScalar *x;
  Vec          coordinates;
  PetscInt     vstart, vend, dim = box->dim;

  PetscFunctionBegin;
  PetscCall(DMSetCoordinateDim(dm, dim));
  PetscCall(DMPlexGetDepthStratum(dm, 0, &vstart, &vend));
  PetscCall(DMGetCoordinateSection(dm, &section));
  PetscCall(PetscSectionSetNumFields(section, 1));
  PetscCall(PetscSectionSetFieldComponents(section, 0, dim));
  PetscCall(PetscSectionSetChart(section, vstart, vend));
  for (PetscInt v = vstart; v < vend; v++) {
    PetscCall(PetscSectionSetDof(section, v, dim));
    PetscCall(PetscSectionSetFieldDof(section, v, 0, dim));
  }
  PetscCall(PetscSectionSetUp(section));
  PetscCall(VecCreate(PETSC_COMM_SELF, &coordinates));
  PetscCall(PetscObjectSetName((PetscObject)coordinates, "coordinates"));
  PetscCall(VecSetSizes(coordinates, (vend - vstart) * dim, PETSC_DETERMINE));
  PetscCall(VecSetBlockSize(coordinates, dim));
  PetscCall(VecSetType(coordinates, VECSTANDARD));
  PetscCall(VecGetArrayWrite(coordinates, &x));
  for (PetscInt v = vstart; v < vend; v++)
    for (PetscInt d = 0; d < dim; d++) {
      const PetscReal length = box->upper[d] - box->lower[d];
      const PetscInt  place  = places[3 * v + d] / 2;

      x[(v - vstart) * dim + d] = box->lower[d] +
                                  (dim == 1 ? length * ((PetscReal)place / (PetscReal)box->faces[d]) : length / box->faces[d] * place);
    }
  PetscCall(VecRestoreArrayWrite(coordinates, &x));
  PetscCall(DMSetCoordinatesLocal(dm, coordinates));
  PetscCall(VecDestroy(&coordinates));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The labels that PETSc gives its boxes: the number of its side for each face on the boundary, and a mark for all points there */
static PetscErrorCode LabelSides(const MeshBox *box, const PetscInt places[], DM dm)
{
  DMLabel  marker, sets;
  PetscInt end, cstart, cend, fstart, fend;

  PetscFunctionBegin;
  PetscCall(DMCreateLabel(dm, "marker"));
  PetscCall(DMGetLabel(dm, "marker", &marker));
  PetscCall(DMCreateLabel(dm, "Face Sets"));
  PetscCall(DMGetLabel(dm, "Face Sets", &sets));
  PetscCall(DMPlexGetChart(dm, NULL, &end));
  PetscCall(DMPlexGetHeightStratum(dm, 0, &cstart, &cend));
  PetscCall(DMPlexGetHeightStratum(dm, 1, &fstart, &fend));
  for (PetscInt p = 0; p < end; p++) {
    if (p >= cstart && p < cend) continue;
    for (PetscInt side = 0; side < 2 * box->dim; side++) {
      /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): places are those of all points that there are */
      if (places[3 * p + side / 2] != (side % 2 ? 2 * box->faces[side / 2] : 0)) continue;
      PetscCall(DMLabelSetValue(marker, p, 1));
      if (p >= fstart && p < fend) PetscCall(DMLabelSetValue(sets, p, MeshBoxSideNumber(box->dim, side)));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of a rank that has no cell, where there are more ranks than cells, or others have the body */
static PetscErrorCode MakeNoPoints(DM dm)
{
  PetscFunctionBegin;
  PetscCall(DMPlexSetChart(dm, 0, 0));
  PetscCall(DMSetUp(dm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A box of which each rank that is to have a part of it makes its own brick */
PetscErrorCode MeshCreateBricks(MPI_Comm comm, const MeshBox *box, DM *dm)
{
  PetscMPIInt rank, part;
  PetscInt   *places = NULL;
  PetscReal   points = 1;
  Brick       brick  = {{0, 0, 0}, {0, 0, 0}};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  part = MeshRanksFind(box->ranks, rank);
  for (PetscInt d = 0; d < box->dim; d++) points *= 2 * (PetscReal)box->faces[d] + 1;
  PetscCheck(points < (PetscReal)PETSC_INT_MAX, comm, PETSC_ERR_USER_INPUT,
             "a box of this size has more points than indices of %d bits can count%s", (int)(8 * sizeof(PetscInt)),
             sizeof(PetscInt) == 4 ? "; build with INDICES=64" : "");
  if (part >= 0) brick = CutForRank(box, box->ranks->n, part);
  PetscCall(DMCreate(comm, dm));
  PetscCall(DMSetType(*dm, DMPLEX));
  PetscCall(DMSetDimension(*dm, box->dim));
  if (CountCells(&brick) > 0) PetscCall(MakePoints(box, &brick, *dm, &places));
  else PetscCall(MakeNoPoints(*dm));
  PetscCall(DMPlexSymmetrize(*dm));
  PetscCall(DMPlexStratify(*dm));
  PetscCall(ShareSides(box, &brick, places, *dm));
  PetscCall(SetCoordinates(box, places, *dm));
  PetscCall(LabelSides(box, places, *dm));
  PetscCall(PetscFree(places));
  PetscCall(DMPlexSetRefinementUniform(*dm, PETSC_TRUE));
  PetscCall(DMPlexDistributeSetDefault(*dm, PETSC_FALSE)); /* it is */
  PetscFunctionReturn(PETSC_SUCCESS);
}
