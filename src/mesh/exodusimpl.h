/* What the parts of the reader of Exodus II files share. Private to src/mesh. */
#pragma once
#include "meshimpl.h"
#include <netcdf.h>

#define NetCDFCall(call, ...)                                                                                                              \
  do {                                                                                                                                     \
    const int status_ = (call);                                                                                                            \
    char      what_[256];                                                                                                                  \
    if (PetscUnlikely(status_)) {                                                                                                          \
      PetscCall(PetscSNPrintf(what_, sizeof(what_), __VA_ARGS__));                                                                         \
      SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "%s: %s", what_, nc_strerror(status_));                                               \
    }                                                                                                                                      \
  } while (0)

/* A block, and where its elements are in the file */
typedef struct {
  PetscInt       number, n, first; /* number of elements, and of the first of them, from 0, in the order of the file */
  PetscInt       first_node;       /* where their nodes begin in `element_nodes`; -1: they are not of this body */
  DMPolytopeType shape;
  PetscInt       nodes; /* of an element: those of its corners, and of the middle of its edges where there are some */
  PetscBool      shell; /* sides 1 and 2 are the faces of the element */
} Block;

typedef struct {
  MeshFile *file;
  int       id; /* the file's, to the NetCDF library */
  PetscInt  dim, n_elements, n_blocks;
  Block    *blocks;
  int      *values[2]; /* of variables that have been read, so that they are freed after an error too */
  double   *reals;
} Exodus;

PETSC_INTERN PetscErrorCode ExodusGetDimension(const Exodus *, const char[], PetscInt *);
PETSC_INTERN PetscErrorCode ExodusGetDimensionOf(const Exodus *, const char[], PetscInt, PetscInt *);
PETSC_INTERN PetscErrorCode ExodusFindVariable(const Exodus *, const char[], PetscInt, int *);
PETSC_INTERN PetscErrorCode ExodusReadInts(Exodus *, const char[], PetscInt, PetscInt, PetscInt, const int *[]);
PETSC_INTERN PetscErrorCode ExodusReadNumber(const Exodus *, const char[], PetscInt, PetscInt *);
PETSC_INTERN PetscErrorCode ExodusReadName(const Exodus *, const char[], PetscInt, char[MESH_NAME_LENGTH]);
