/* What the parts of the reader of Gmsh's files share. Private to src/mesh. */
#pragma once
#include "meshimpl.h"

/* A file as it is read */
typedef struct {
  MeshFile   *file;
  const char *begin, *at, *end;
  PetscBool   binary, swapped;
  int         version; /* 22 or 41 */
  int         word;    /* bytes of counts and of numbers of nodes and elements in binary files of version 4.1 */
  /* in version 4.1, geometrical entities: their physical groups are those of the elements on them */
  PetscInt n_entities;
  PetscInt (*entities)[4]; /* dimension, number, and the place and number of their physical groups in `groups` */
  PetscInt *groups;
} Gmsh;

/* Ends with an error that tells the place in the file, unless a condition holds */
#define GmshCheck(gmsh, condition, ...)                                                                                                    \
  do {                                                                                                                                     \
    if (PetscUnlikely(!(condition))) {                                                                                                     \
      char message_[512], where_[64];                                                                                                      \
      PetscCall(PetscSNPrintf(message_, sizeof(message_), __VA_ARGS__));                                                                   \
      SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "%s (%s)", message_, GmshWhere(gmsh, where_));                                        \
    }                                                                                                                                      \
  } while (0)

PETSC_INTERN const char    *GmshWhere(const Gmsh *, char[64]);
PETSC_INTERN void           GmshSkipSpace(Gmsh *);
PETSC_INTERN PetscErrorCode GmshReadText(Gmsh *, PetscInt, PetscInt64[]);
PETSC_INTERN PetscErrorCode GmshReadBytes(Gmsh *, size_t, PetscInt, void *);
PETSC_INTERN PetscErrorCode GmshReadInts(Gmsh *, PetscInt, PetscInt64[]);
PETSC_INTERN PetscErrorCode GmshReadWords(Gmsh *, PetscInt, PetscInt64[]);
PETSC_INTERN PetscErrorCode GmshReadReals(Gmsh *, PetscInt, double[]);
PETSC_INTERN PetscErrorCode GmshCheckCount(Gmsh *, const char[], PetscInt64, PetscInt64, PetscInt *);
PETSC_INTERN PetscErrorCode GmshReadCount(Gmsh *, const char[], PetscInt64, PetscInt *);
PETSC_INTERN PetscErrorCode GmshCheckNumber(Gmsh *, PetscInt64, PetscInt *);
PETSC_INTERN PetscErrorCode GmshReadNodes22(Gmsh *);
PETSC_INTERN PetscErrorCode GmshReadNodes41(Gmsh *);
PETSC_INTERN PetscErrorCode GmshReadElements22(Gmsh *);
PETSC_INTERN PetscErrorCode GmshReadElements41(Gmsh *);
