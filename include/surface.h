/* A part of a body's boundary that may touch something. */
#pragma once
#include <petscdmplex.h>

/*S
   Surface - faces of a `DMPLEX` boundary with their nodes, normals and areas, known on every rank

   Level: developer

.seealso: `SurfaceCreate()`, `Transfer`
S*/
typedef struct _n_Surface *Surface;

/*S
   SurfaceData - what a surface consists of; arrays are owned by the `Surface`

   Level: developer

   Note:
   A face in d dimensions has d or fewer edges that leave its first node; in one dimension it is a point of area 1.

.seealso: `Surface`, `SurfaceGetData()`
S*/
typedef struct {
  PetscInt         dim, face_nodes; /* space dimension, nodes of one face */
  PetscInt         n_nodes, n_faces;
  const PetscInt  *dofs;               /* per node: global number of its first displacement; ascending */
  const PetscReal *positions;          /* per node: reference position, dim [m] */
  const PetscReal *areas;              /* per node: its share of the faces [m^2, m or 1] */
  const PetscReal *normals;            /* per node: outward unit normal, dim */
  const PetscInt  *faces;              /* per face: its nodes, face_nodes */
  const PetscReal *face_normals;       /* per face: outward unit normal, dim */
  PetscReal        lower[3], upper[3]; /* bounding box of the whole body [m] */
} SurfaceData;

PETSC_EXTERN PetscErrorCode SurfaceCreate(DM, const char[], Surface *);
PETSC_EXTERN PetscErrorCode SurfaceDestroy(Surface *);
PETSC_EXTERN PetscErrorCode SurfaceGetData(Surface, const SurfaceData **);
PETSC_EXTERN PetscErrorCode SurfaceGetVertices(Surface, PetscInt, const PetscInt[], PetscInt *, PetscInt **);
