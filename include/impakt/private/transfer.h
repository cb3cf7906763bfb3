/* What goes between the two surfaces of a contact pair, and back by the transpose. */
#pragma once
#include <petscmat.h>
#include <impakt/private/surface.h>

/*
   Transfer - rows that compare the two surfaces of a contact pair, or a surface and an obstacle: the gap at a node i of the
   Dirichlet side is

     gap_i = n_i . (sum_j P_ij x_j - x_i)

   with its outward normal n_i and weights P_ij of the nodes j of the Neumann side that sum to one. Forces go back by the transposes.
*/
typedef struct _p_Transfer *Transfer;

PETSC_EXTERN PetscClassId TRANSFER_CLASSID;

/*
   TransferRows - the rows of the Dirichlet nodes that this rank owns; arrays are owned by the `Transfer`, and valid until it is
   updated again

   Note:
   A row without anything opposite has gap `PETSC_MAX_REAL`, area 0, and no entries on the Neumann side.
*/
typedef struct {
  PetscInt         n;        /* the same over the whole run */
  const PetscInt  *dofs;     /* global number of the first displacement */
  const PetscBool *opposite; /* something of the partner lies opposite */
  const PetscBool *beyond;   /* the partner ends before the node, see TransferOptions */
  const PetscReal *gap;      /* n_i . (sum_j P_ij X_j - X_i) with reference positions X: the present gap is that + B_N u_N - B_D u_D [m] */
  const PetscReal *area;     /* integral of the node's shape function over the part of the surface that has something opposite
                                [m^2; m in two dimensions; 1 in one] */
  const PetscReal *normals;  /* dim each: outward unit normal of the Dirichlet side; against that of an obstacle */
  const PetscReal *size;     /* edge length of the smallest face at the node [m; 1 in one dimension] */
  const PetscBool *changed;  /* the last update has built the row anew, and has changed it */
  const PetscBool *followed; /* the row has followed the surfaces since, see TransferFollow() */
  const PetscReal *slip;     /* by how much the partner had slipped between the two last builds of the row, in parts of the face size */
  const PetscReal *bow;      /* depth that the row may have between surfaces which only touch [m] */
} TransferRows;

/*
   TransferOptions - how rows are made

   Notes:
   Curved rows have a normal between that of their node and those of the partner opposite, and a gap that is counted to a surface of second
   order with the normals of the partner's nodes. Then it hardly matters which surface has the nodes of the rows. Where normals differ by
   more than 26 degrees, which is an edge, rows are as they are otherwise. Where two curved surfaces are pressed flat on each other, each
   gives way in proportion to its compliance: what is flat then has a slope between those of both, closer to that of the stiffer one
   (Johnson 1985, section 4.2). With moduli E1 of the side with the nodes and E2 of the partner the share is E2 / (E1 + E2).

   If a face is covered in part, a node of it beyond the end of the partner is guarded: compared with the straight line that continues the
   covered part (Popp, Seitz, Gee, Wall 2013), with the gap counted from where the partner ends. Without these rows the end of a tilting
   partner gets into the surface by half an element times the angle.
*/
typedef struct {
  PetscReal   slip_bound;    /* how far surfaces may move along each other before rows are built again [parts of the face] */
  PetscReal   angle_bound;   /* how far normals may turn [rad] */
  PetscBool   unguarded;     /* nodes just beyond the end of the partner have no rows */
  PetscBool   curved;        /* rows take the bend of both surfaces into account */
  PetscReal   share;         /* of the partner's normals in those of curved rows, 0 to 1 */
  PetscBool   turns;         /* gaps can be turned, see TransferBalance(); not with an owner */
  PetscBool   owned;         /* one rank has all of both surfaces, and alone knows what an update finds; updates are not collective */
  PetscMPIInt owner;         /* that rank */
  Surface     boundaries[2]; /* of the whole bodies, by which it is known how deep these lie inside each other; borrowed; NULL: they
                               are the surfaces */
} TransferOptions;

/* Numbers by which the motion of the surfaces is told, see TransferMeasureMotion() */
#define TRANSFER_MOTION 7

PETSC_EXTERN PetscErrorCode ObstacleSetUp(Obstacle);
PETSC_EXTERN PetscErrorCode ObstacleGetGap(Obstacle, const PetscReal[], PetscReal *, PetscReal[]);

PETSC_EXTERN PetscErrorCode TransferCreate(MPI_Comm, Surface, Surface, Obstacle, const TransferOptions *, Transfer *);
PETSC_EXTERN PetscErrorCode TransferGetDrift(Transfer, Vec, Vec, PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode TransferSetBounds(Transfer, PetscReal, PetscReal);
PETSC_EXTERN PetscErrorCode TransferSetNear(Transfer, const PetscBool[], PetscBool[], PetscBool[]);
PETSC_EXTERN PetscErrorCode TransferUpdate(Transfer, Vec, Vec, PetscReal, PetscBool *);
PETSC_EXTERN PetscErrorCode TransferMeasureMotion(Transfer, PetscReal, PetscReal[TRANSFER_MOTION]);
PETSC_EXTERN PetscErrorCode TransferIsStale(Transfer, PetscReal, PetscBool, const PetscReal[TRANSFER_MOTION], PetscBool *);
PETSC_EXTERN PetscErrorCode TransferRenew(Transfer, Vec, Vec, PetscReal, PetscBool);
PETSC_EXTERN PetscErrorCode TransferFollow(Transfer, const PetscBool[], PetscReal, PetscReal, PetscBool, PetscBool, PetscReal, PetscReal,
                                           PetscBool *);
PETSC_EXTERN PetscErrorCode TransferSave(Transfer);
PETSC_EXTERN PetscErrorCode TransferRestore(Transfer);
PETSC_EXTERN PetscErrorCode TransferGetTurns(Transfer, PetscInt *, const PetscReal *[], const PetscReal *[], PetscReal[]);
PETSC_EXTERN PetscErrorCode TransferTurn(Transfer, const PetscReal[]);
PETSC_EXTERN PetscErrorCode TransferBalance(Transfer, const PetscReal[], PetscReal, PetscBool *);
PETSC_EXTERN PetscErrorCode TransferGetRows(Transfer, TransferRows *);
PETSC_EXTERN PetscErrorCode TransferGetGaps(Transfer, PetscReal[]);
PETSC_EXTERN PetscErrorCode TransferGetTilts(Transfer, PetscReal[]);
PETSC_EXTERN PetscErrorCode TransferSetValues(Transfer, const PetscInt[2], PetscInt, const PetscReal[], const Mat[2]);
PETSC_EXTERN PetscErrorCode TransferCountValues(Transfer, PetscInt[], PetscInt[]);
PETSC_EXTERN PetscErrorCode TransferSetNeighbours(Transfer, PetscInt, PetscInt, PetscReal, Mat);
PETSC_EXTERN PetscErrorCode TransferDestroy(Transfer *);
