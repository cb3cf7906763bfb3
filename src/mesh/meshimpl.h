/* What the readers of mesh files share with the making of a DMPlex. Private to src/mesh. */
#pragma once
#include <impakt/private/mesh.h>

#define MESH_NAME_LENGTH 256
/* The label of meshes of composite elements; it has no points */
#define MESH_COMPOSITE "composite"

/* What a group of a mesh file means to the body */
typedef enum {
  MESH_BLOCK,     /* its cells */
  MESH_SIDE_SET,  /* faces of its cells */
  MESH_NODE_SET,  /* vertices */
  MESH_UNDECIDED, /* the file does not say: it follows from the dimension of the elements, once that of the body is known */
} MeshGroupKind;

typedef struct {
  MeshGroupKind kind;
  PetscInt      dim; /* dimension of its elements */
  PetscInt      number;
  char          name[MESH_NAME_LENGTH]; /* empty: it has none */
} MeshGroup;

/* Elements that follow each other in a file, of one shape and in the same groups */
typedef struct {
  DMPolytopeType shape;
  PetscInt       dim, corners;
  PetscInt       nodes;                /* corners, and the nodes in the middle of the edges where there are some, in VTK's order */
  PetscInt       n, first, first_node; /* number of elements; where those of the first begin in `numbers` and in `element_nodes` */
  PetscInt       n_groups, first_group;
  PetscBool      chosen; /* they are cells of this body */
} MeshRun;

/* A mesh file as it is read, whatever its format, or a mesh that is made as one */
typedef struct {
  const char *path;
  PetscMPIInt rank; /* that alone has what follows: the first one, or the one that a mesh is made for */
  /* options: which blocks make the body; none: all */
  PetscInt n_wanted;
  char   **wanted;
  /* nodes, with three coordinates */
  PetscInt   n_nodes;
  PetscReal *coordinates;
  PetscInt  *node_numbers;                  /* in the file; NULL: 1, 2, 3 ... */
  PetscInt  *sorted_numbers, *sorted_nodes; /* the same in ascending order */
  /* groups and elements of all dimensions */
  PetscInt   n_groups, max_groups;
  MeshGroup *groups;
  PetscInt   n_runs, max_runs;
  MeshRun   *runs;
  PetscInt   n_run_groups, max_run_groups;
  PetscInt  *run_groups;
  PetscInt   n_elements, max_elements;
  PetscInt  *numbers; /* of elements in the file */
  PetscInt   n_element_nodes, max_element_nodes;
  PetscInt  *element_nodes;
  /* the body: cells in the file's order, vertices that belong to one of them */
  PetscInt       dim;
  DMPolytopeType shape;
  PetscInt       corners, n_cells, n_vertices;
  PetscInt      *cells, *cell_numbers; /* vertices of each cell; its number in the file */
  PetscInt      *vertex_of_node;       /* < 0: not the body's */
  PetscReal     *vertices;
  /* of a body of six-node triangles or ten-node tetrahedra: ends and middle node of all edges of all cells, 3 numbers; none: 0 */
  PetscInt  n_edges;
  PetscInt *edges;
  PetscInt *edge_of_node; /* point of the DMPlex; -1: the node is in the middle of none. NULL without such cells */
  PetscInt *node_of_edge; /* the node in the middle of each edge of the DMPlex, from the first one on; -1: none yet */
  /* memory of a reader, which is freed with the file if reading ends with an error */
  char *text;
} MeshFile;

/* Where the nodes in the middle of the edges of second-order cells are [m]; NULL: there are none */
typedef struct {
  PetscSection section; /* of the edges */
  Vec          positions;
} MeshMiddles;

/* What the label of the edges with the middle nodes of a node set is named, before its name */
#define MESH_MIDDLES "middles of "

/* The ranks that have a part of a mesh each */
typedef struct {
  PetscMPIInt        n;    /* parts */
  const PetscMPIInt *list; /* the rank of each, ascending; NULL: all ranks */
} MeshRanks;

/* What there is of a mesh before DMSetFromOptions() */
typedef enum { MESH_TO_BE_MADE, MESH_ON_ONE_RANK, MESH_DIVIDED } MeshStage;

/* A box as its options describe it */
typedef struct {
  PetscInt  dim, faces[3];
  PetscReal lower[3], upper[3]; /* [m] */
  PetscBool simplex, is_box;
  /* how it is divided among ranks */
  const MeshRanks *ranks;        /* that have a part */
  PetscBool        contact[6];   /* sides (xmin, xmax, ymin, ...) that may touch another body */
  PetscReal        contact_cost; /* work for one of their faces, in units of the work for an element */
  PetscReal        along[3];     /* how much the cells along each axis count when the longest edge is looked for, to be cut */
} MeshBox;

PETSC_INTERN PetscErrorCode MeshFileInitialize(MeshFile *, const char[]);
PETSC_INTERN PetscErrorCode MeshFileDestroy(MeshFile *);
PETSC_INTERN PetscErrorCode MeshFileAddGroup(MeshFile *, MeshGroupKind, PetscInt, PetscInt, PetscInt *);
PETSC_INTERN PetscErrorCode MeshFileAddRun(MeshFile *, DMPolytopeType, PetscBool, PetscInt, const PetscInt[]);
PETSC_INTERN PetscErrorCode MeshFileAddElement(MeshFile *, PetscInt, PetscInt *[]);
PETSC_INTERN PetscErrorCode MeshFileNumberNodes(MeshFile *);
PETSC_INTERN PetscErrorCode MeshFileFindNode(MeshFile *, PetscInt, PetscInt *);
PETSC_INTERN PetscErrorCode MeshFileWants(const MeshFile *, PetscInt, const char[], PetscBool *);
PETSC_INTERN PetscErrorCode MeshFileSelect(void *);
PETSC_INTERN PetscErrorCode MeshFileDoubt(const MeshFile *, const char[]);
PETSC_INTERN PetscErrorCode MeshFileLabel(const MeshFile *, DM);
PETSC_INTERN PetscErrorCode MeshReadGmsh(MeshFile *);
PETSC_INTERN PetscErrorCode MeshReadExodus(MeshFile *);
PETSC_INTERN PetscErrorCode MeshCheckNetCDFSize(const char[]);
PETSC_INTERN const PetscInt MeshSimplexEdges[6][2];
PETSC_INTERN PetscErrorCode MeshFileCollectEdges(MeshFile *);
PETSC_INTERN PetscErrorCode MeshFileFindEdges(MeshFile *, DM);
PETSC_INTERN PetscErrorCode MeshFileGetMiddles(const MeshFile *, DM, MeshMiddles *);
PETSC_INTERN PetscErrorCode MeshMiddlesDestroy(MeshMiddles *);
PETSC_INTERN PetscErrorCode MeshDistributeWithMiddles(DM *, const char[], MeshMiddles *);
PETSC_INTERN PetscErrorCode MeshDivideWithMiddles(DM *, MeshMiddles *);
PETSC_INTERN PetscErrorCode MeshMakeComposite(DM *, const char[], const char[], MeshMiddles *);
PETSC_INTERN PetscErrorCode MeshWantsComposite(const char[], PetscBool *);
PETSC_INTERN PetscErrorCode MeshOnRank(MPI_Comm, PetscMPIInt, PetscErrorCode (*)(void *), void *, const char[]);
PETSC_INTERN PetscErrorCode MeshCreateFromFile(MPI_Comm, const char[], const char[], const char[], DM *, MeshMiddles *);
PETSC_INTERN PetscErrorCode MeshCreateBox(MPI_Comm, const char[], const char[], const MeshRanks *, DM *, MeshStage *);
PETSC_INTERN PetscErrorCode MeshTellLabels(PetscMPIInt, DM);
PETSC_INTERN PetscMPIInt    MeshRanksFind(const MeshRanks *, PetscMPIInt);
PETSC_INTERN PetscErrorCode MeshRanksCheck(MPI_Comm, const char[], PetscMPIInt, const MeshRanks *);
PETSC_INTERN PetscErrorCode MeshSetParts(DM, const MeshRanks *, PetscInt, const PetscInt[]);
PETSC_INTERN PetscErrorCode MeshDivideAmong(const MeshRanks *, const char[], const char[], MeshStage, PetscBool, DM *, MeshMiddles *);
PETSC_INTERN PetscInt       MeshBoxSideNumber(PetscInt, PetscInt);
PETSC_INTERN PetscErrorCode MeshHasSurface(DM, const char[], PetscBool *);
PETSC_INTERN PetscErrorCode MeshCheckContact(DM, const char[]);
PETSC_INTERN PetscErrorCode MeshReadContact(MPI_Comm, const char[], const char[], PetscInt *, char ***, PetscReal *);
PETSC_INTERN PetscErrorCode MeshFindBlock(DM, const char[], PetscInt *, PetscInt *[], PetscBool *);
PETSC_INTERN PetscErrorCode MeshFindSurface(DM, const char[], PetscBool, PetscInt *, PetscInt *[]);
PETSC_INTERN PetscErrorCode MeshSpreadContact(DM, const MeshRanks *, const char[], const char[], PetscBool, PetscBool *);
PETSC_INTERN PetscErrorCode MeshBoxMarkContact(MPI_Comm, const char[], const char[], MeshBox *);
PETSC_INTERN PetscErrorCode MeshBricksChoose(MeshBox *, PetscBool *);
PETSC_INTERN PetscErrorCode MeshCreateBricks(MPI_Comm, const MeshBox *, DM *);
PETSC_INTERN PetscErrorCode MeshCreateRod(MPI_Comm, const char[], const char[], PetscMPIInt, DM *, MeshMiddles *);
PETSC_INTERN PetscErrorCode MeshHasShape(const char[], const char[], PetscBool *);
PETSC_INTERN PetscErrorCode MeshCreateBall(MPI_Comm, const char[], const char[], PetscMPIInt, DM *, MeshMiddles *);
PETSC_INTERN PetscErrorCode MeshReadNumbers(MPI_Comm, const char[], const char[], PetscInt, const char[], PetscReal[], PetscBool *);
PETSC_INTERN PetscErrorCode MeshBuild(MPI_Comm, MeshFile *, const char[], DM *, MeshMiddles *);
PETSC_INTERN PetscErrorCode MeshMarkSides(DM);
PETSC_INTERN PetscErrorCode MeshPlace(DM, const char[], const char[]);
PETSC_INTERN PetscErrorCode MeshLabelHasPoints(DM, DMLabel, PetscInt, PetscInt, PetscBool *);
PETSC_INTERN PetscErrorCode MeshListLabels(DM, PetscInt, PetscInt, const char[], char[], size_t);
PETSC_INTERN PetscErrorCode MeshLabelIsInternal(const char[], PetscBool *);
