/* Meshes of composite elements: each triangle divided into 4, each tetrahedron into 8, which follow each other in the DMPlex and stay on
   one rank. What is a face of six nodes elsewhere is four faces here. */
#include "meshimpl.h"
#include <petsc/private/petscimpl.h>
#include <petscdmplextransform.h>

/* Whether the options of a body ask for elements that need such a mesh */
PetscErrorCode MeshWantsComposite(const char prefix[], PetscBool *wants)
{
  char      formulation[128];
  PetscBool set;

  PetscFunctionBegin;
  *wants = PETSC_FALSE;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-element_formulation", formulation, sizeof(formulation), &set));
  if (set) PetscCall(PetscStrcmp(formulation, "composite", wants));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether both ends of an edge are in a label with some value */
static PetscErrorCode HasEnds(DM dm, DMLabel label, PetscInt value, PetscInt edge, PetscBool *has)
{
  const PetscInt *ends;

  PetscFunctionBegin;
  PetscCall(DMPlexGetCone(dm, edge, &ends));
  PetscCall(DMLabelStratumHasPoint(label, value, ends[0], has));
  if (*has) PetscCall(DMLabelStratumHasPoint(label, value, ends[1], has));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes out of a label what a point that it has is divided into but for parts of its own dimension: a surface has no nodes, nor a block
   faces. A node in the middle of an edge stays where the ends of the edge are in the label too. */
static PetscErrorCode MendPoint(DMPlexTransform division, DM dm, DMLabel label, PetscInt value, PetscInt point, DMLabel divided)
{
  DMPolytopeType shape, *shapes;
  PetscInt       n, *sizes, *cones, *turns;
  PetscBool      ends = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(DMPlexGetCellType(dm, point, &shape));
  if (shape == DM_POLYTOPE_SEGMENT) PetscCall(HasEnds(dm, label, value, point, &ends));
  if (ends) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMPlexTransformCellTransform(division, shape, point, NULL, &n, &shapes, &sizes, &cones, &turns));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt r = 0; r < sizes[i] && DMPolytopeTypeGetDim(shapes[i]) < DMPolytopeTypeGetDim(shape); r++) {
      PetscInt part;

      PetscCall(DMPlexTransformGetTargetPoint(division, shape, shapes[i], point, r, &part));
      PetscCall(DMLabelClearValue(divided, part, value));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the node in the middle of an edge into the label of the node set that it belongs to */
static PetscErrorCode AddMiddle(DMPlexTransform division, PetscInt edge, PetscInt value, DMLabel nodes)
{
  PetscInt vertex;

  PetscFunctionBegin;
  PetscCall(DMPlexTransformGetTargetPoint(division, DM_POLYTOPE_SEGMENT, DM_POLYTOPE_POINT, edge, 0, &vertex));
  PetscCall(DMLabelSetValue(nodes, vertex, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A label of the divided mesh, which PETSc has made of that of the mesh */
static PetscErrorCode MendLabel(DMPlexTransform division, DM dm, const char name[], DM divided)
{
  DMLabel         label, mended;
  IS              values, points;
  const PetscInt *value, *point;
  PetscInt        n_values, n;
  PetscBool       internal, middles;

  PetscFunctionBegin;
  PetscCall(MeshLabelIsInternal(name, &internal));
  if (internal) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrncmp(name, MESH_MIDDLES, strlen(MESH_MIDDLES), &middles));
  if (middles) PetscCall(DMCreateLabel(divided, name + strlen(MESH_MIDDLES)));
  PetscCall(DMGetLabel(dm, name, &label));
  PetscCall(DMGetLabel(divided, middles ? name + strlen(MESH_MIDDLES) : name, &mended));
  PetscCall(DMLabelGetValueIS(label, &values));
  PetscCall(ISGetLocalSize(values, &n_values));
  PetscCall(ISGetIndices(values, &value));
  for (PetscInt v = 0; v < n_values; v++) {
    PetscCall(DMLabelGetStratumIS(label, value[v], &points));
    if (!points) continue;
    PetscCall(ISGetLocalSize(points, &n));
    PetscCall(ISGetIndices(points, &point));
    for (PetscInt i = 0; i < n; i++) {
      if (middles) PetscCall(AddMiddle(division, point[i], value[v], mended));
      else PetscCall(MendPoint(division, dm, label, value[v], point[i], mended));
    }
    PetscCall(ISRestoreIndices(points, &point));
    PetscCall(ISDestroy(&points));
  }
  PetscCall(ISRestoreIndices(values, &value));
  PetscCall(ISDestroy(&values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MendLabels(DMPlexTransform division, DM dm, DM divided)
{
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(DMGetNumLabels(dm, &n));
  for (PetscInt pass = 0; pass < 2; pass++) /* middles are added when the rest is mended */
    for (PetscInt i = 0; i < n; i++) {
      const char *name;
      PetscBool   middles;

      PetscCall(DMGetLabelName(dm, i, &name));
      PetscCall(PetscStrncmp(name, MESH_MIDDLES, strlen(MESH_MIDDLES), &middles));
      if (middles != (PetscBool)pass) continue;
      PetscCall(MendLabel(division, dm, name, divided));
      if (middles) PetscCall(DMRemoveLabel(divided, name, NULL));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the new vertices of a divided mesh to where the middles of edges are */
static PetscErrorCode MoveMiddles(DMPlexTransform division, DM dm, const MeshMiddles *middles, DM divided)
{
  PetscSection       section;
  Vec                coordinates;
  PetscScalar       *x;
  const PetscScalar *positions;
  PetscInt           dim, start, end;

  PetscFunctionBegin;
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(DMPlexGetDepthStratum(dm, 1, &start, &end));
  PetscCall(DMGetCoordinateSection(divided, &section));
  PetscCall(DMGetCoordinatesLocal(divided, &coordinates));
  PetscCall(VecGetArray(coordinates, &x));
  PetscCall(VecGetArrayRead(middles->positions, &positions));
  for (PetscInt edge = start; edge < end; edge++) {
    PetscInt vertex, from, to;

    PetscCall(DMPlexTransformGetTargetPoint(division, DM_POLYTOPE_SEGMENT, DM_POLYTOPE_POINT, edge, 0, &vertex));
    PetscCall(PetscSectionGetOffset(middles->section, edge, &from));
    PetscCall(PetscSectionGetOffset(section, vertex, &to));
    for (PetscInt d = 0; d < dim; d++) x[to + d] = positions[from + d];
  }
  PetscCall(VecRestoreArrayRead(middles->positions, &positions));
  PetscCall(VecRestoreArray(coordinates, &x));
  PetscCall(DMSetCoordinatesLocal(divided, coordinates));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Divide(DM dm, const MeshMiddles *middles, DM *divided)
{
  DMPlexTransform division;
  const char     *name, *prefix;

  PetscFunctionBegin;
  PetscCall(DMPlexTransformCreate(PetscObjectComm((PetscObject)dm), &division));
  PetscCall(DMPlexTransformSetType(division, DMPLEXREFINEREGULAR));
  PetscCall(DMPlexTransformSetDM(division, dm));
  PetscCall(DMPlexTransformSetUp(division));
  PetscCall(DMPlexTransformApply(division, dm, divided));
  PetscCall(MendLabels(division, dm, *divided));
  if (middles && middles->section) PetscCall(MoveMiddles(division, dm, middles, *divided));
  PetscCall(DMPlexTransformDestroy(&division));
  PetscCall(DMCreateLabel(*divided, MESH_COMPOSITE));
  PetscCall(PetscObjectGetName((PetscObject)dm, &name));
  PetscCall(PetscObjectSetName((PetscObject)*divided, name));
  PetscCall(DMGetOptionsPrefix(dm, &prefix));
  PetscCall(DMSetOptionsPrefix(*divided, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error unless all cells are triangles, or all are tetrahedra */
static PetscErrorCode CheckSimplices(DM dm, const char before[])
{
  PetscInt    start, end;
  int         other = -1;
  const char *name;

  PetscFunctionBegin;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &start, &end));
  for (PetscInt c = start; c < end; c++) {
    DMPolytopeType shape;

    PetscCall(DMPlexGetCellType(dm, c, &shape));
    if (shape != DM_POLYTOPE_TRIANGLE && shape != DM_POLYTOPE_TETRAHEDRON) other = (int)shape;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &other, 1, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)dm)));
  PetscCall(PetscObjectGetName((PetscObject)dm, &name));
  PetscCheck(other < 0, PetscObjectComm((PetscObject)dm), PETSC_ERR_USER_INPUT,
             "%sbody '%s': composite elements are made of triangles and tetrahedra, not of cells of shape '%s'; of boxes and balls "
             "-dm_plex_simplex makes these",
             before, name, other < 0 ? "" : DMPolytopeTypes[other]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same mesh, or its part on this rank, divided; in place of it */
PetscErrorCode MeshMakeComposite(DM *dm, const char prefix[], const char name[], MeshMiddles *middles)
{
  DM   divided;
  char before[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(before, sizeof(before), "-%selement_formulation composite, ", prefix));
  PetscCall(PetscObjectSetName((PetscObject)*dm, name));
  PetscCall(CheckSimplices(*dm, before));
  PetscCall(Divide(*dm, middles, &divided));
  PetscCall(DMDestroy(dm));
  *dm = divided;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A mesh of composite elements: each cell of a mesh of triangles or tetrahedra divided into 4 or 8. A `Body` with such a mesh has elements
   of six or ten nodes, unless another formulation has been set. `MeshCreate()` divides where options or files ask. Collective */
PetscErrorCode MeshCreateComposite(DM dm, DM *composite)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(dm, DM_CLASSID, 1);
  PetscAssertPointer(composite, 2);
  PetscCall(CheckSimplices(dm, ""));
  PetscCall(Divide(dm, NULL, composite));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a mesh is one of composite elements */
PetscErrorCode MeshIsComposite(DM dm, PetscBool *composite)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(dm, DM_CLASSID, 1);
  PetscAssertPointer(composite, 2);
  PetscCall(DMHasLabel(dm, MESH_COMPOSITE, composite));
  PetscFunctionReturn(PETSC_SUCCESS);
}
