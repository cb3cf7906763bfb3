/* A part of a body's boundary that may touch something. */
#pragma once
#include <petscdmplex.h>
#include <impakt/obstacle.h>

/*
   Surface - faces of a `DMPLEX` boundary with their nodes, normals and areas; each rank knows those of its own faces
*/
typedef struct _p_Surface *Surface;

PETSC_EXTERN PetscClassId SURFACE_CLASSID;

/*
   SurfaceData - what a rank has of a surface; arrays are owned by the `Surface` and are not to be changed

   Notes:
   Vectors have three components in any dimension. The nodes of a face are ordered such that its normal is outward. In one
   dimension a face is a point of area and size 1.

   Nodes that this rank owns come first, in the order of their vertices; then come ghosts.
*/
typedef struct {
  PetscInt   dim, face_nodes;           /* space dimension, nodes of one face */
  PetscInt   n_faces, n_nodes, n_owned; /* of this rank */
  PetscInt  *vertices;                  /* per node: point of the `DMPLEX` */
  PetscInt  *dofs;                      /* per node: global number of its first displacement */
  PetscInt  *faces;                     /* per face: its nodes, face_nodes */
  PetscReal *reference;                 /* per node: reference position [m] */
  PetscReal *positions;                 /* per node: present position [m] */
  PetscReal *normals;                   /* per node: outward unit normal, of the faces around it weighted by their areas, or
                                           as SurfaceSetRound() says */
  PetscReal *areas;                     /* per node: integral of its shape function [m^2, m or 1]; of rings times 2 pi x [m^2] */
  PetscReal *sizes;                     /* per node: edge length of the smallest face around it [m or 1] */
  PetscReal *face_normals;              /* per face: outward unit normal */
  PetscReal *face_areas;                /* per face [m^2, m or 1] */
} SurfaceData;

/*
   SurfaceDepth - the deepest point of one surface inside the body of another
*/
typedef struct {
  PetscInt  surfaces[2]; /* number of the surface that has the point, and of that whose body it is in; numbers of obstacles follow */
  PetscReal depth;       /* distance of the point from the closest face of the second surface; 0 where no point is inside [m] */
  PetscReal size;        /* edge of the smallest face there, of either surface [m or 1] */
  PetscReal x[3];        /* the point [m] */
} SurfaceDepth;

PETSC_EXTERN PetscErrorCode InterfaceInitializePackage(void);
PETSC_EXTERN PetscErrorCode SurfaceCreate(DM, const char[], Surface *);
PETSC_EXTERN PetscErrorCode SurfaceKeepFacing(Surface, Surface, Obstacle, PetscBool, PetscBool);
PETSC_EXTERN PetscErrorCode SurfaceSetRound(Surface, PetscBool);
PETSC_EXTERN PetscErrorCode SurfaceSetAxisymmetric(Surface);
PETSC_EXTERN PetscErrorCode SurfaceSetMirrors(Surface, PetscInt, const PetscInt[], PetscInt);
PETSC_EXTERN PetscErrorCode SurfaceMove(Surface, Vec, PetscReal, Vec);
PETSC_EXTERN PetscErrorCode SurfaceSetNear(Surface, const PetscBool[]);
PETSC_EXTERN PetscErrorCode SurfaceUpdate(Surface, Vec);
PETSC_EXTERN PetscErrorCode SurfacesFindDepths(MPI_Comm, PetscInt, const Surface[], PetscInt, const Obstacle[], PetscInt *,
                                               SurfaceDepth *[]);
PETSC_EXTERN PetscErrorCode SurfaceDestroy(Surface *);
PETSC_EXTERN PetscErrorCode SurfaceGetData(Surface, const SurfaceData **);
