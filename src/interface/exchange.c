/* What ranks send each other: records of any kind, vectors of nodes, and the faces that come near. */
#include "interfaceimpl.h"

/* Beyond the box in which partners are looked for [parts of the face]: keeps those that touch its side but for round-off */
#define BOX_MARGIN 0.1

/* Sends record i, of `bytes` bytes, to rank destination[i]; what arrives is sorted by the rank it comes from. Free with PetscFree(). */
PetscErrorCode ExchangeRecords(MPI_Comm comm, size_t bytes, PetscInt n, const PetscMPIInt destination[], const void *records,
                               PetscInt *n_received, void **received)
{
  MPI_Datatype type;
  PetscMPIInt  size, *sent, *arrived, *from, *to;
  char        *sorted;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscCalloc4(size, &sent, size, &arrived, size + 1, &from, size + 1, &to));
  for (PetscInt i = 0; i < n; i++) sent[destination[i]]++;
  PetscCallMPI(MPI_Alltoall(sent, 1, MPI_INT, arrived, 1, MPI_INT, comm));
  for (PetscMPIInt r = 0; r < size; r++) {
    from[r + 1] = from[r] + sent[r];
    to[r + 1]   = to[r] + arrived[r];
  }
  *n_received = to[size];
  PetscCall(PetscMalloc((size_t)n * bytes, &sorted));
  PetscCall(PetscMalloc((size_t)*n_received * bytes, received));
  for (PetscInt i = 0; i < n; i++)
    PetscCall(PetscMemcpy(sorted + (size_t)(from[destination[i]]++) * bytes, (const char *)records + (size_t)i * bytes, bytes));
  for (PetscMPIInt r = 0; r < size; r++) from[r] -= sent[r];
  PetscCallMPI(MPI_Type_contiguous((int)bytes, MPI_BYTE, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  PetscCallMPI(MPI_Alltoallv(sorted, sent, from, type, *received, arrived, to, type, comm));
  PetscCallMPI(MPI_Type_free(&type));
  PetscCall(PetscFree(sorted));
  PetscCall(PetscFree4(sent, arrived, from, to));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A star forest from `n_roots` to `n_leaves` nodes that carries three numbers for each node. PETSc could carry them as one MPI type of
   three numbers, but then it compares that type with its own, and allocates memory, in each communication. */
PetscErrorCode CreateVectorForest(MPI_Comm comm, PetscInt n_roots, PetscInt n_leaves, const PetscInt leaves[], const PetscSFNode roots[],
                                  PetscSF *vectors)
{
  PetscInt    *numbers = NULL;
  PetscSFNode *from;

  PetscFunctionBegin;
  if (leaves) PetscCall(PetscMalloc1(3 * n_leaves, &numbers));
  PetscCall(PetscMalloc1(3 * n_leaves, &from));
  for (PetscInt i = 0; i < 3 * n_leaves; i++) {
    if (leaves) numbers[i] = 3 * leaves[i / 3] + i % 3;
    from[i].rank  = roots[i / 3].rank;
    from[i].index = 3 * roots[i / 3].index + i % 3;
  }
  PetscCall(PetscSFCreate(comm, vectors));
  PetscCall(PetscSFSetGraph(*vectors, 3 * n_roots, 3 * n_leaves, numbers, PETSC_OWN_POINTER, from, PETSC_OWN_POINTER));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The box of all that may lie opposite to this rank's faces: these, swept along their normals. */
static void SweptBox(const SurfaceData *data, PetscReal ahead, PetscReal behind, PetscReal box[])
{
  BoxFind(0, NULL, box);
  for (PetscInt f = 0; f < data->n_faces; f++) {
    const PetscReal *normal = data->face_normals + 3 * f, size = FaceSize(data->face_nodes, data->face_areas[f]);

    for (PetscInt k = 0; k < data->face_nodes; k++)
      for (PetscInt d = 0; d < 3; d++) {
        const PetscReal x = data->positions[3 * data->faces[f * data->face_nodes + k] + d], to = x + normal[d] * (ahead + size),
                        from = x - normal[d] * (behind + size);

        box[d]     = PetscMin(box[d], PetscMin(from, to) - BOX_MARGIN * size);
        box[3 + d] = PetscMin(box[3 + d], -PetscMax(from, to) - BOX_MARGIN * size);
      }
  }
  if (ahead < PETSC_MAX_REAL || !data->n_faces) return;
  for (PetscInt k = 0; k < 6; k++) box[k] = -PETSC_MAX_REAL; /* partners at any distance are wanted */
}

/* Face f of a surface, where it is now */
void SurfaceGetFace(Surface surface, PetscInt f, Face *face)
{
  const SurfaceData *data = &surface->data;

  face->size = FaceSize(data->face_nodes, data->face_areas[f]);
  for (PetscInt d = 0; d < 3; d++) face->normal[d] = data->face_normals[3 * f + d];
  for (PetscInt k = 0; k < data->face_nodes; k++) {
    const PetscInt node = data->faces[f * data->face_nodes + k];

    face->dofs[k]        = data->dofs[node];
    face->owner_index[k] = surface->owner_index[node];
    face->owner_rank[k]  = surface->owner_rank[node];
    for (PetscInt d = 0; d < 3; d++) face->x[k][d] = data->positions[3 * node + d];
  }
}

/* The faces of `to` that may lie opposite to those that this rank has of `from`. Free with PetscFree(). */
PetscErrorCode ExchangeFaces(MPI_Comm comm, Surface from, Surface to, PetscReal ahead, PetscReal behind, PetscInt *n_faces, Face *faces[])
{
  const SurfaceData *data = &to->data;
  PetscReal          box[6], *boxes;
  PetscMPIInt        size, *destination = NULL;
  PetscInt           n = 0, max = 0;
  Face              *sent = NULL;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(6 * size, &boxes));
  SweptBox(&from->data, ahead, behind, box);
  PetscCallMPI(MPI_Allgather(box, 6, MPIU_REAL, boxes, 6, MPIU_REAL, comm));
  for (PetscMPIInt r = 0; r < size; r++)
    for (PetscInt f = 0; f < data->n_faces; f++) {
      Face face = {0};

      SurfaceGetFace(to, f, &face);
      BoxFind(data->face_nodes, face.x[0], box);
      if (!BoxesMeet(box, boxes + 6 * r)) continue;
      if (n == max) {
        max = 2 * max + 64;
        PetscCall(PetscRealloc((size_t)max * sizeof(Face), &sent));
        PetscCall(PetscRealloc((size_t)max * sizeof(PetscMPIInt), &destination));
      }
      sent[n]          = face;
      destination[n++] = r;
    }
  PetscCall(ExchangeRecords(comm, sizeof(Face), n, destination, sent, n_faces, (void **)faces));
  PetscCall(PetscFree(sent));
  PetscCall(PetscFree(destination));
  PetscCall(PetscFree(boxes));
  PetscFunctionReturn(PETSC_SUCCESS);
}
