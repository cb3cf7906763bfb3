/* Private to src/interface. */
#pragma once
#include <petscsf.h>
#include <petsc/private/petscimpl.h>
#include <checkpoint/statelist.h>
#include <impakt/private/box.h>
#include <impakt/private/transfer.h>

/* Two faces count as facing each other if the cosine of the angle between their outward normals is below this, which means an angle of more
   than 96 degrees: faces at right angles cannot push each other */
#define OPPOSED (-0.1)
/* Cosine of half the angle, 35 degrees, by which the normals of two neighbouring faces differ at least if their edge is sharp */
#define SHARP_COSINE 0.9537

struct _p_Surface {
  PETSCHEADER(int);
  DM           dm;
  SurfaceData  data;
  PetscInt    *points;      /* per face: point of the DMPLEX, ascending */
  PetscInt    *owner_index; /* per node: its number on the rank that owns it */
  PetscMPIInt *owner_rank;
  PetscBool    divided;      /* some rank has nodes of the mesh that another one owns */
  PetscBool    axisymmetric; /* areas are those of rings, see SurfaceSetAxisymmetric() */
  PetscReal    on_axis;      /* nodes with a smaller first coordinate lie on the axis [m] */
  PetscBool   *sharp;        /* per node: it lies on a sharp edge of the mesh */
  PetscReal   *smooth;       /* per node: its normal, 0 on a sharp edge */
  PetscInt    *mirrors;      /* per owned node: a bit for each axis across its planes of symmetry, see SurfaceSetMirrors(); or NULL */
  PetscBool   *near;         /* per node: SurfaceMove() finds its normal, area and size; NULL: those of all nodes, see SurfaceSetNear() */
  PetscInt     n_near_nodes, *near_nodes; /* these nodes, */
  PetscInt     n_near_faces, *near_faces; /* and the faces at them */
  PetscBool    round;                     /* nodal normals are those of the round surface through the nodes, see SurfaceSetRound() */
  PetscSF      sf;                        /* from owned nodes to ghosts, one number for each node */
  PetscSF      vectors;                   /* the same, three numbers for each node */
};

/* A face of the Neumann side as one rank sends it to another */
typedef struct {
  PetscInt    dofs[4], owner_index[4];
  PetscMPIInt owner_rank[4];
  PetscReal   x[4][3], normal[3], size;
} Face;

/* What is known of the point of some faces that is closest to a given point: the square of their distance, the height of the given point
   above the face, which is negative inside, and the edge of the face */
typedef struct {
  PetscReal square, height, size;
} Closest;

/* Squares of distances that differ by less, relative, are those of one point */
#define CLOSEST_SAME_POINT 1e-9

/* The plane in which a Dirichlet face is compared with faces of its partner: centroid, unit normal n, and tangents with t0 x t1 = n */
typedef struct {
  PetscReal origin[3], normal[3], tangents[2][3];
} Frame;

/* A node of a tree of boxes that bound faces */
typedef struct {
  PetscReal bounds[6];         /* see impakt/private/box.h */
  PetscInt  begin, end, child; /* its faces are order[begin] to order[end - 1]; the first of its two children, or: */
} Box;
#define TREE_LEAF  (-1) /* it has none, */
#define TREE_WHOLE 0    /* or no query has looked into it */
typedef struct {
  PetscInt   n_boxes, *order;
  Box       *boxes;
  PetscReal *bounds, *middles; /* per face: its box; twice the middle of that along an axis */
  PetscInt  *found, max_found; /* work space of the query */
} Tree;

/* The share of one Neumann node in one row */
typedef struct {
  PetscInt    row, dof, owner_index;
  PetscMPIInt owner_rank;
  PetscReal   value;    /* its weight */
  PetscReal   goal;     /* what the weight is to become as a row that follows the surfaces slips on; of other rows the weight itself */
  PetscReal   area;     /* part of the node's area at which its shape function weighs, from 0 to 1 */
  PetscReal   slope[3]; /* mean gradient of its shape function over what a node on a sharp edge sees, 0 in other rows [1/m] */
} Share;

/* Smaller weights and parts of areas are round-off, and would only fill the matrices */
#define ROUND_OFF_WEIGHT 1e-12

/* Most partners of a row that follows the surfaces: with so many faces to one of the other side it hardly slips by a bound */
#define FOLLOW_MAX 256

/* What lies opposite to a Dirichlet node: nothing; nothing, but the partner ends on a face beside the node; a face of the partner */
enum { MARK_NONE, MARK_BEYOND, MARK_COVERED };

typedef struct {
  PetscBool *opposite, *beyond, *changed;
  PetscReal *gap, *area, *normals; /* normals: dim each */
  PetscReal *partner;              /* of a node on a sharp edge: mean outward normal of what it sees of the partner at the build, if that
                                      has no sharp edge there, else 0; 3 each */
  PetscReal *bow;                  /* depth that the row may have between surfaces that only touch [m] */
  PetscReal *rest;                 /* how far its weights still are from their goals, from 1 at the last build to 0 */
  PetscInt  *offsets;              /* of each row among the shares, n + 1 */
  Share     *shares;               /* sorted by row and dof */
  PetscInt   n_columns;            /* number of distinct Neumann nodes that the shares name */
  PetscInt  *columns;              /* per share: which of these nodes it names */
  PetscSF    vectors;              /* from their owners to these nodes, three numbers for each */
} RowSet;

/* What rows that follow the surfaces know of the step before */
typedef struct {
  PetscReal *x[2];                  /* positions of the owned nodes of both sides at the last update [m] */
  PetscReal *moved, *partner_moved; /* since the update before [m] */
  PetscReal *slip;                  /* per row: what the partner is expected to slip in a step, 3 numbers each [m] */
  PetscBool *known;                 /* per row: it has followed in the last step too */
} Follow;

/* How the gaps of the rows are turned, see src/interface/balance.c */
typedef struct {
  PetscInt   n;        /* number of turns: 0, gaps are not turned; 1 in two dimensions, 2 in three */
  PetscReal *uneven;   /* per row: c_i, n each */
  PetscReal *lever;    /* per row: the mean of these and of those of the step before, n each */
  PetscReal *across;   /* per row: r_i x (n_i + m_i), 3 each */
  PetscReal *bends[2]; /* per owned node of both sides: how far the normals of its faces turn in the mesh [rad], 3 numbers of which the
                          first counts */
  PetscReal *bend;     /* per row: half of that of both sides together */
  PetscReal *gap;      /* per row: present gap [m] */
  PetscReal *turned;   /* per row: what has been added to its gap [m] */
} Balance;

/* What updates read and change beside arrays */
typedef struct {
  PetscBool has_last;      /* the motion since the last update is known */
  PetscReal near;          /* partners at most that far away are known since the last build [m] */
  PetscReal smallest_size; /* edge of the smallest face of both sides at the last build [m] */
  PetscReal step;          /* that the slip is expected in [s] */
  PetscReal scale;         /* of this step to that one */
  PetscReal turn[3];       /* of gaps: the sum of turns times axes [m] */
  PetscReal axes[2][3];    /* of the turns, unit vectors */
} TransferNumbers;

typedef struct {
  PetscInt        builds; /* those counted when the rows were put aside; 0: none have been */
  RowSet          rows;   /* their shares */
  TransferNumbers numbers;
  PetscReal      *state[2]; /* of rows and of partners, see TransferListState(); NULL: there is no room for it yet */
} TransferSaved;

struct _p_Transfer {
  PETSCHEADER(int);
  MPI_Comm        comm;               /* of what is found of both surfaces: one rank where that has all of both */
  PetscBool       idle;               /* it is another one than this, which has no rows */
  Surface         dirichlet, neumann; /* neumann NULL: an obstacle */
  Obstacle        obstacle;
  PetscInt        dim, n;
  TransferOptions options;
  RowSet          rows;
  PetscBool       built;
  TransferNumbers numbers;
  PetscReal      *built_x[2]; /* positions of the owned nodes of both sides at the last build */
  PetscReal      *built_slip; /* per row: the part of sum_j P_ij x_j - x_i across the normal at the last build, 3 numbers each [m] */
  PetscReal      *slip; /* per row: how far the partner had slipped since the row was built, as of the last update [parts of the face] */
  PetscInt        n_near, *near; /* rows that updates look at between builds, see TransferSetNear() */
  PetscBool       some_near;     /* there may be others */
  PetscBool      *keep;          /* per row: in the next build it stays as it is, being near contact and within the bounds */
  PetscBool      *followed;      /* per row: it has followed the surfaces since the last update, see TransferFollow() */
  PetscBool      *goes_on;       /* per row: in the next build its weights go on from where they are */
  Follow          follow;
  PetscReal      *column_x, *column_normals;       /* of the columns: present positions and normals, */
  PetscReal      *column_moved, *column_reference; /* motion in the last step, positions in the mesh */
  Balance         balance;
  PetscInt        builds; /* how often rows have been built */
  TransferSaved   saved;
};

static inline PetscReal Dot(const PetscReal a[], const PetscReal b[])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void Cross(const PetscReal a[], const PetscReal b[], PetscReal c[])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline PetscReal Normalize(PetscReal a[])
{
  const PetscReal length = PetscSqrtReal(Dot(a, a));

  if (length > 0)
    for (PetscInt d = 0; d < 3; d++) a[d] /= length;
  return length;
}

/* Two unit vectors across a unit vector n, n x a = b; in the plane a lies in it, and b is across it */
static inline void UnitsAcross(PetscInt dim, const PetscReal n[], PetscReal a[], PetscReal b[])
{
  PetscInt thinnest = dim == 2 ? 2 : 0;

  for (PetscInt d = 1; d < 3 && dim > 2; d++)
    if (PetscAbsReal(n[d]) < PetscAbsReal(n[thinnest])) thinnest = d;
  for (PetscInt d = 0; d < 3; d++) b[d] = d == thinnest;
  Cross(b, n, a);
  (void)Normalize(a);
  Cross(n, a, b);
}

/* Geometry of faces with 1 to 4 nodes. In one dimension a face is a point, whose area and size are 1. */
PETSC_INTERN void      FaceNormal(PetscInt, const PetscReal[][3], PetscReal[], PetscReal *);
PETSC_INTERN void      FaceNodeAreas(PetscInt, const PetscReal[][3], const PetscReal[], PetscReal[]);
PETSC_INTERN void      FaceGradients(PetscInt, const PetscReal[][3], PetscReal[][3]);
PETSC_INTERN PetscReal FaceSize(PetscInt, PetscReal);
PETSC_INTERN void      FrameOfFace(PetscInt, const PetscReal[][3], const PetscReal[], Frame *);
PETSC_INTERN void      FrameProject(const Frame *, const PetscReal[], PetscReal[]);
PETSC_INTERN void      FaceShapes(PetscInt, const PetscReal[][2], const PetscReal[], PetscReal[]);
PETSC_INTERN PetscInt  PolygonClip(PetscInt, const PetscReal[][2], PetscInt, const PetscReal[][2], PetscReal[][2]);
PETSC_INTERN PetscReal PolygonMeasure(PetscInt, const PetscReal[][2], PetscReal[]);
PETSC_INTERN PetscReal PolygonDistance(PetscInt, const PetscReal[][2], const PetscReal[]);
PETSC_INTERN PetscInt  PolygonQuadrature(PetscInt, const PetscReal[][2], PetscReal[][2], PetscReal[]);

PETSC_INTERN void     ClosestTake(Closest *, const Closest *);
PETSC_INTERN void     FaceFindClosest(PetscInt, const Face *, const PetscReal[], Closest *);
PETSC_INTERN PetscInt FaceFindCrossings(PetscInt, const Face *, const PetscReal[], const PetscReal[], PetscReal[2]);

PETSC_INTERN PetscErrorCode TreeCreate(PetscInt, PetscInt, const Face[], Tree *);
PETSC_INTERN PetscErrorCode TreeDestroy(Tree *);
PETSC_INTERN PetscErrorCode TreeQuery(Tree *, const Frame *, const PetscReal[], const PetscReal[], PetscInt *, const PetscInt *[]);
PETSC_INTERN void           BoxDistances(const PetscReal[6], const PetscReal[], PetscReal *, PetscReal *);
PETSC_INTERN void           TreeFindClosest(Tree *, PetscInt, const Face[], const PetscReal[], Closest *);

PETSC_INTERN PetscErrorCode CreateVectorForest(MPI_Comm, PetscInt, PetscInt, const PetscInt[], const PetscSFNode[], PetscSF *);
PETSC_INTERN PetscErrorCode ExchangeRecords(MPI_Comm, size_t, PetscInt, const PetscMPIInt[], const void *, PetscInt *, void **);
PETSC_INTERN void           SurfaceGetFace(Surface, PetscInt, Face *);
PETSC_INTERN PetscErrorCode ExchangeFaces(MPI_Comm, Surface, Surface, PetscReal, PetscReal, PetscInt *, Face *[]);
PETSC_INTERN PetscErrorCode SurfaceSetUpNodes(Surface);
PETSC_INTERN PetscErrorCode SurfaceListVertices(DM, PetscInt, PetscInt *, PetscInt[]);
PETSC_INTERN PetscErrorCode SurfaceMarkVertices(DM, PetscInt, const PetscInt[], PetscSF, PetscInt[]);
PETSC_INTERN PetscErrorCode SurfaceFindEdges(Surface, PetscSF);
PETSC_INTERN void           SurfaceMirrorNormal(Surface, PetscInt, PetscReal[]);
PETSC_INTERN PetscErrorCode SurfaceClearNodes(Surface);
PETSC_INTERN PetscErrorCode SurfaceKeepFaces(Surface, const PetscBool[]);

PETSC_INTERN PetscErrorCode TransferIntegrate(Transfer, PetscReal, PetscReal, PetscInt[], PetscReal[], PetscReal[], PetscReal[], PetscInt *,
                                              Share *[]);
PETSC_INTERN PetscErrorCode TransferBuildRows(Transfer, Vec, Vec, PetscReal);
PETSC_INTERN PetscErrorCode RowSetGetColumns(const RowSet *, const PetscReal[], PetscReal[]);
PETSC_INTERN PetscErrorCode TransferSetUpColumns(Transfer, RowSet *, PetscBool);
PETSC_INTERN void           TransferListState(Transfer, StateList[2]);
PETSC_INTERN PetscErrorCode TransferSetUpTurns(Transfer);
PETSC_INTERN PetscReal      TransferPresentGap(Transfer, PetscInt);
PETSC_INTERN PetscReal      TransferSplitRow(const Transfer, const RowSet *, PetscInt, const PetscReal[], const PetscReal[], PetscReal[]);
PETSC_INTERN PetscErrorCode TransferGetReach(Transfer, PetscReal, PetscReal *);
PETSC_INTERN PetscBool      RowPartnerNormal(Surface, const RowSet *, PetscInt, const PetscReal[], PetscReal[]);
PETSC_INTERN PetscErrorCode TransferPresentNormal(Transfer, PetscInt, PetscReal[], PetscReal *);
PETSC_INTERN PetscErrorCode TransferBringColumns(Transfer);
PETSC_INTERN PetscErrorCode TransferBuildObstacleRows(Transfer, PetscReal);
PETSC_INTERN PetscErrorCode RowSetAllocate(PetscInt, PetscInt, PetscInt, RowSet *);
PETSC_INTERN PetscErrorCode RowSetDestroy(RowSet *);
PETSC_INTERN int            ShareCompare(const void *, const void *, void *);
PETSC_INTERN void      RowNormal(PetscInt, PetscInt, PetscReal, const PetscReal[], const PetscReal *[], const PetscReal[], PetscReal[]);
PETSC_INTERN PetscReal RowBulge(PetscInt, PetscInt, const PetscReal[], const PetscReal[], const PetscReal *[], const PetscReal *[],
                                const PetscReal[], const Share[]);
PETSC_INTERN PetscReal RowBow(PetscInt, PetscInt, const PetscReal[], const PetscReal[], const PetscReal *[], const PetscReal[]);
PETSC_INTERN void      RowCorrect(PetscInt, PetscInt, const PetscReal[], const PetscReal[], const PetscReal *[], const Share[], PetscReal,
                                  PetscReal[]);
