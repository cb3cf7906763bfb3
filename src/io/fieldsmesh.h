/* The meshes of all bodies as one, for files of fields. */
#pragma once
#include <impakt/body.h>
#include <hdf5.h>

/* Rows of a dataset, body after body, and in each body rank after rank */
typedef struct {
  PetscInt n;             /* pieces of this rank: one for each body */
  hsize_t  total;         /* rows of all ranks */
  hsize_t *begin, *count; /* first row of each piece, and how many it has */
  hsize_t  local;         /* rows of this rank */
} FieldsRows;

typedef struct {
  PetscInt    n_bodies;
  const Body *bodies; /* borrowed */
  FieldsRows  nodes, cells;
  FieldsRows  topology;      /* the cells; if they have several shapes, the entries of a list that tells each cell's shape too */
  PetscInt    cell_nodes;    /* components of the topology: nodes of a cell; 1 if cells have several shapes */
  PetscBool   mixed;         /* cells have several shapes */
  const char *topology_type; /* XDMF's word for the shape */
} FieldsMesh;

PETSC_INTERN PetscErrorCode FieldsMeshCreate(PetscInt, const Body[], FieldsMesh *);
PETSC_INTERN PetscErrorCode FieldsMeshGetTopology(const FieldsMesh *, int[]);
PETSC_INTERN PetscErrorCode FieldsMeshGetNodes(const FieldsMesh *, PetscReal[]);
PETSC_INTERN PetscErrorCode FieldsMeshDestroy(FieldsMesh *);
