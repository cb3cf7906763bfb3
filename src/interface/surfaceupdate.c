/* Where a surface is now, with its normals and areas. */
#include "interfaceimpl.h"

/* Positions of all nodes of this rank under the displacements u + time v; u NULL: the reference positions; v NULL: under u */
static PetscErrorCode UpdatePositions(Surface surface, Vec u, PetscReal time, Vec v)
{
  SurfaceData       *data = &surface->data;
  const PetscScalar *values, *rates;
  PetscInt           start;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(data->positions, data->reference, 3 * data->n_nodes));
  if (!u) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetOwnershipRange(u, &start, NULL));
  PetscCall(VecGetArrayRead(u, &values));
  PetscCall(VecGetArrayRead(v ? v : u, &rates));
  for (PetscInt i = 0; i < data->n_owned; i++)
    for (PetscInt d = 0; d < data->dim; d++) {
      const PetscInt k = data->dofs[i] - start + d;

      data->positions[3 * i + d] += PetscRealPart(v ? time * rates[k] + values[k] : values[k]);
    }
  PetscCall(VecRestoreArrayRead(v ? v : u, &rates));
  PetscCall(VecRestoreArrayRead(u, &values));
  if (!surface->divided) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSFBcastBegin(surface->vectors, MPIU_REAL, data->positions, data->positions, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(surface->vectors, MPIU_REAL, data->positions, data->positions, MPI_REPLACE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the corner k of a face with n nodes adds to the normal of its node. The mean normal of the faces of a polyhedron whose nodes lie on
   a sphere, or of a polygon on a circle, is that of the sphere with these weights, whatever the shapes and sizes of the faces. */
static void AddCorner(PetscInt n, PetscInt k, const PetscReal x[][3], const PetscReal normal[], PetscReal sum[])
{
  PetscReal next[3], last[3], product[3], squares;

  for (PetscInt d = 0; d < 3; d++) {
    next[d] = x[(k + 1) % n][d] - x[k][d];
    last[d] = x[(k + n - 1) % n][d] - x[k][d];
  }
  if (n > 2) Cross(next, last, product);
  else
    for (PetscInt d = 0; d < 3; d++) product[d] = normal[d] * PetscPowReal(Dot(next, next), 1.5);
  squares = Dot(next, next) * Dot(last, last);
  for (PetscInt d = 0; d < 3; d++) sum[d] += product[d] / squares;
}

/* Nothing has been added to a node */
static void Clear(SurfaceData *data, PetscInt i)
{
  for (PetscInt d = 0; d < 3; d++) data->normals[3 * i + d] = 0;
  data->areas[i] = 0;
  data->sizes[i] = PETSC_MAX_REAL;
}

/* Adds the area and normal of a face of this rank to its nodes, for which it may be the smallest one */
static void AddFace(Surface surface, PetscInt f)
{
  SurfaceData   *data = &surface->data;
  const PetscInt n = data->face_nodes, *nodes = data->faces + f * n;
  PetscReal      x[4][3], areas[4], *normal = data->face_normals + 3 * f;

  for (PetscInt k = 0; k < n; k++)
    for (PetscInt d = 0; d < 3; d++) x[k][d] = data->positions[3 * nodes[k] + d];
  FaceNormal(n, (const PetscReal(*)[3])x, normal, &data->face_areas[f]);
  FaceNodeAreas(n, (const PetscReal(*)[3])x, normal, areas);
  if (surface->axisymmetric) /* 2 pi x is linear along the face */
    for (PetscInt k = 0; k < 2; k++) areas[k] = PETSC_PI / 3 * data->face_areas[f] * (2 * x[k][0] + x[1 - k][0]);
  for (PetscInt k = 0; k < n; k++) {
    if (surface->near && !surface->near[nodes[k]]) continue;
    data->areas[nodes[k]] += areas[k];
    data->sizes[nodes[k]] = PetscMin(data->sizes[nodes[k]], FaceSize(n, data->face_areas[f]));
    if (surface->round && n > 1) AddCorner(n, k, (const PetscReal(*)[3])x, normal, data->normals + 3 * nodes[k]);
    else
      for (PetscInt d = 0; d < 3; d++) data->normals[3 * nodes[k] + d] += data->face_areas[f] * normal[d];
  }
}

/* Normals, areas and sizes from the ranks that own the nodes */
static PetscErrorCode ShareNodes(Surface surface)
{
  SurfaceData *data = &surface->data;
  PetscSF      sf = surface->sf, vectors = surface->vectors;

  PetscFunctionBegin;
  PetscCall(PetscSFBcastBegin(vectors, MPIU_REAL, data->normals, data->normals, MPI_REPLACE));
  PetscCall(PetscSFBcastBegin(sf, MPIU_REAL, data->areas, data->areas, MPI_REPLACE));
  PetscCall(PetscSFBcastBegin(sf, MPIU_REAL, data->sizes, data->sizes, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(vectors, MPIU_REAL, data->normals, data->normals, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_REAL, data->areas, data->areas, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_REAL, data->sizes, data->sizes, MPI_REPLACE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether normals of nodes are those of the round surface through them, from the next SurfaceUpdate() on, not means of the faces around
   weighted by areas, which are off by 0.3 degrees for a ball with 32 edges round (N. Max, Weights for computing vertex normals from
   facet normals, Journal of Graphics Tools 4, 1999) */
PetscErrorCode SurfaceSetRound(Surface surface, PetscBool round)
{
  PetscFunctionBegin;
  surface->round = round;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the normal of an owned node into its planes of symmetry; it need not have unit length */
void SurfaceMirrorNormal(Surface surface, PetscInt node, PetscReal normal[])
{
  for (PetscInt d = 0; d < surface->data.dim && surface->mirrors; d++)
    if (surface->mirrors[node] & (1 << d)) normal[d] = 0;
}

/* Normals, areas and sizes of near nodes where these are now */
static PetscErrorCode UpdateNodes(Surface surface)
{
  SurfaceData   *data    = &surface->data;
  const PetscInt n_faces = surface->near ? surface->n_near_faces : data->n_faces;
  const PetscInt n_nodes = surface->near ? surface->n_near_nodes : data->n_nodes;
  PetscSF        sf = surface->sf, vectors = surface->vectors;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n_nodes; k++) Clear(data, surface->near ? surface->near_nodes[k] : k);
  for (PetscInt i = data->n_owned; i < data->n_nodes; i++) Clear(data, i); /* owners add what ghosts have */
  for (PetscInt k = 0; k < n_faces; k++) AddFace(surface, surface->near ? surface->near_faces[k] : k);
  if (surface->divided) {
    PetscCall(PetscSFReduceBegin(vectors, MPIU_REAL, data->normals, data->normals, MPIU_SUM));
    PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, data->areas, data->areas, MPIU_SUM));
    PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, data->sizes, data->sizes, MPIU_MIN));
    PetscCall(PetscSFReduceEnd(vectors, MPIU_REAL, data->normals, data->normals, MPIU_SUM));
    PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, data->areas, data->areas, MPIU_SUM));
    PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, data->sizes, data->sizes, MPIU_MIN));
  }
  for (PetscInt k = 0; k < n_nodes; k++) {
    const PetscInt i = surface->near ? surface->near_nodes[k] : k;

    if (i >= data->n_owned) break;
    if (surface->axisymmetric && data->reference[3 * i] <= surface->on_axis) data->normals[3 * i] = 0;
    SurfaceMirrorNormal(surface, i, data->normals + 3 * i);
    (void)Normalize(data->normals + 3 * i);
  }
  if (surface->divided) PetscCall(ShareNodes(surface));
  for (PetscInt k = 0; k < n_nodes; k++) {
    const PetscInt i = surface->near ? surface->near_nodes[k] : k;

    for (PetscInt d = 0; d < 3; d++) surface->smooth[3 * i + d] = surface->sharp[i] ? 0 : data->normals[3 * i + d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of which nodes that this rank owns SurfaceMove() finds normals, areas and sizes from now on; NULL: of all */
PetscErrorCode SurfaceSetNear(Surface surface, const PetscBool near[])
{
  const SurfaceData *data = &surface->data;

  PetscFunctionBegin;
  PetscCall(PetscFree3(surface->near, surface->near_nodes, surface->near_faces));
  if (!near) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc3(data->n_nodes + 1, &surface->near, data->n_nodes, &surface->near_nodes, data->n_faces,
                         &surface->near_faces)); /* never NULL */
  PetscCall(PetscArraycpy(surface->near, near, data->n_owned));
  if (surface->divided) {
    PetscCall(PetscSFBcastBegin(surface->sf, MPI_C_BOOL, surface->near, surface->near, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(surface->sf, MPI_C_BOOL, surface->near, surface->near, MPI_REPLACE));
  }
  surface->n_near_nodes = surface->n_near_faces = 0;
  for (PetscInt i = 0; i < data->n_nodes; i++)
    if (surface->near[i]) surface->near_nodes[surface->n_near_nodes++] = i;
  for (PetscInt f = 0; f < data->n_faces; f++) {
    PetscBool any = PETSC_FALSE;

    for (PetscInt k = 0; k < data->face_nodes; k++) any = (PetscBool)(any || surface->near[data->faces[f * data->face_nodes + k]]);
    if (any) surface->near_faces[surface->n_near_faces++] = f;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As SurfaceUpdate(), but for normals, areas and sizes of nodes that are not near, and under the displacements u + time v; v NULL: u */
PetscErrorCode SurfaceMove(Surface surface, Vec u, PetscReal time, Vec v)
{
  PetscFunctionBegin;
  PetscCall(UpdatePositions(surface, u, time, v));
  PetscCall(UpdateNodes(surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves a surface to where its body is under the displacements u; NULL: its reference position */
PetscErrorCode SurfaceUpdate(Surface surface, Vec u)
{
  PetscBool *near = surface->near;

  PetscFunctionBegin;
  surface->near = NULL; /* all nodes */
  PetscCall(SurfaceMove(surface, u, 0, NULL));
  surface->near = near;
  PetscFunctionReturn(PETSC_SUCCESS);
}
