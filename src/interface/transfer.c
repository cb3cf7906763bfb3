/* The rows of a transfer as others see them: creation, settings, views of them. */
#include "interfaceimpl.h"
#include <sys/citations.h>

/* Bounds beyond which rows are built again, unless TransferSetBounds() is called: with this slip bound a half disc that is led round
   another one has a normal force steady to 0.2 % */
#define SLIP_BOUND  0.05 /* [parts of the face] */
#define ANGLE_BOUND 0.02 /* [rad] */

/* Prepares the rows that compare a surface, which takes displacements and gives tractions, with another one or with an obstacle, the
   other being NULL. Surfaces and obstacle belong to the caller and must live as long. `comm`: that of both */
PetscErrorCode TransferCreate(MPI_Comm comm, Surface dirichlet, Surface neumann, Obstacle obstacle, Transfer *transfer)
{
  Transfer t;

  PetscFunctionBegin;
  PetscCall(InterfaceInitializePackage());
  PetscCall(PetscHeaderCreate(*transfer, TRANSFER_CLASSID, "Transfer", "Rows between contact surfaces", "Interface", comm, TransferDestroy,
                              NULL));
  PetscCheck(!neumann != !obstacle, comm, PETSC_ERR_ARG_WRONG, "A transfer is between a surface and either another surface or an obstacle");
  t              = *transfer;
  t->comm        = comm;
  t->owner       = PETSC_DECIDE;
  t->dirichlet   = dirichlet;
  t->neumann     = neumann;
  t->obstacle    = obstacle;
  t->dim         = dirichlet->data.dim;
  t->n           = dirichlet->data.n_owned;
  t->slip_bound  = SLIP_BOUND;
  t->angle_bound = ANGLE_BOUND;
  t->share       = 0.5;
  t->guards      = PETSC_TRUE;
  if (neumann && t->dim > 1) {
    PetscCall(ImpaktCite(CITE_DUAL_MORTAR));
    PetscCall(ImpaktCite(CITE_SEGMENTS));
  }
  if (neumann)
    PetscCheck(t->dim == neumann->data.dim, comm, PETSC_ERR_USER_INPUT,
               "The two bodies of a contact pair have %" PetscInt_FMT " and %" PetscInt_FMT " dimensions", t->dim, neumann->data.dim);
  PetscCall(PetscCalloc5(3 * t->n, &t->built_x[0], neumann ? 3 * neumann->data.n_owned : 0, &t->built_x[1], 3 * t->n, &t->built_slip, t->n,
                         &t->slip, t->n, &t->keep));
  PetscCall(PetscCalloc2(t->n, &t->followed, t->n, &t->goes_on));
  if (neumann)
    PetscCall(PetscCalloc6(3 * t->n, &t->follow.x[0], 3 * neumann->data.n_owned, &t->follow.x[1], 3 * t->n, &t->follow.moved,
                           3 * neumann->data.n_owned, &t->follow.partner_moved, 3 * t->n, &t->follow.slip, t->n, &t->follow.known));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TransferDestroy(Transfer *transfer)
{
  PetscFunctionBegin;
  if (!*transfer) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*transfer, TRANSFER_CLASSID, 1);
  if (--((PetscObject)*transfer)->refct > 0) {
    *transfer = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(RowSetDestroy(&(*transfer)->rows));
  PetscCall(TransferDestroySaved(*transfer));
  for (PetscInt side = 0; side < 2; side++) PetscCall(SurfaceDestroy(&(*transfer)->boundaries[side]));
  PetscCall(PetscFree5((*transfer)->built_x[0], (*transfer)->built_x[1], (*transfer)->built_slip, (*transfer)->slip, (*transfer)->keep));
  PetscCall(PetscFree2((*transfer)->followed, (*transfer)->goes_on));
  PetscCall(PetscFree((*transfer)->near));
  PetscCall(PetscFree3((*transfer)->balance.bends[0], (*transfer)->balance.bends[1], (*transfer)->balance.bend));
  PetscCall(PetscFree5((*transfer)->balance.uneven, (*transfer)->balance.lever, (*transfer)->balance.across, (*transfer)->balance.gap,
                       (*transfer)->balance.turned));
  PetscCall(PetscFree6((*transfer)->follow.x[0], (*transfer)->follow.x[1], (*transfer)->follow.moved, (*transfer)->follow.partner_moved,
                       (*transfer)->follow.slip, (*transfer)->follow.known));
  PetscCall(PetscFree4((*transfer)->column_x, (*transfer)->column_normals, (*transfer)->column_moved, (*transfer)->column_reference));
  PetscCall(PetscHeaderDestroy(transfer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far the surfaces may move along each other [parts of the face], and normals turn [rad], before the rows are built again */
PetscErrorCode TransferSetBounds(Transfer transfer, PetscReal slip, PetscReal angle)
{
  PetscFunctionBegin;
  PetscCheck(slip >= 0 && angle >= 0, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE,
             "The bounds of slip, %g, and angle, %g, must not be negative", (double)slip, (double)angle);
  transfer->slip_bound  = slip;
  transfer->angle_bound = angle;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The whole boundaries of both bodies, by which it is known how deep they lie inside each other, for all transfers of these bodies; else
   each has its own */
PetscErrorCode TransferSetBoundaries(Transfer transfer, Surface dirichlet, Surface neumann)
{
  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) {
    PetscCall(PetscObjectReference((PetscObject)(side ? neumann : dirichlet)));
    PetscCall(SurfaceDestroy(&transfer->boundaries[side]));
    transfer->boundaries[side] = side ? neumann : dirichlet;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says, before the first update, that one rank has all of both surfaces. From then on that rank alone knows what an update finds;
   updates are collective no more. Gaps must not be turned. */
PetscErrorCode TransferSetOwner(Transfer transfer, PetscMPIInt rank)
{
  PetscMPIInt mine;

  PetscFunctionBegin;
  PetscCheck(!transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call before TransferUpdate()");
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)transfer), &mine));
  transfer->comm  = PETSC_COMM_SELF;
  transfer->owner = rank;
  transfer->idle  = (PetscBool)(mine != rank);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which rank has all of both surfaces; PETSC_DECIDE: there may be several */
PetscErrorCode TransferGetOwner(Transfer transfer, PetscMPIInt *rank)
{
  PetscFunctionBegin;
  *rank = transfer->owner;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether Dirichlet nodes just beyond the end of the partner have rows too, which they do by default. If a face is covered in part, a
   node of it beyond the end of the partner is compared with the straight line that continues the covered part (Popp, Seitz, Gee, Wall
   2013), with the gap counted from where the partner ends. Without these rows the end of a tilting partner gets into the surface by half
   an element times the angle. */
PetscErrorCode TransferSetGuards(Transfer transfer, PetscBool guards)
{
  PetscFunctionBegin;
  PetscCheck(!transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call before TransferUpdate()");
  transfer->guards = guards;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TransferGetRows(Transfer transfer, TransferRows *rows)
{
  const RowSet *set = &transfer->rows;

  PetscFunctionBegin;
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  rows->n        = transfer->n;
  rows->dofs     = transfer->dirichlet->data.dofs;
  rows->opposite = set->opposite;
  rows->beyond   = set->beyond;
  rows->gap      = set->gap;
  rows->area     = set->area;
  rows->normals  = set->normals;
  rows->size     = transfer->dirichlet->data.sizes;
  rows->changed  = set->changed;
  rows->followed = transfer->followed;
  rows->slip     = transfer->slip;
  rows->bow      = set->bow;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How often rows have been built, the first time included */
PetscErrorCode TransferGetBuilds(Transfer transfer, PetscInt *builds)
{
  PetscFunctionBegin;
  *builds = transfer->builds;
  PetscFunctionReturn(PETSC_SUCCESS);
}
