/* The rows of a transfer as others see them: creation, settings, views of them. */
#include "interfaceimpl.h"
#include <sys/citations.h>

/* Prepares the rows that compare a surface, which takes displacements and gives tractions, with another one or with an obstacle, the
   other being NULL. Surfaces and obstacle belong to the caller and must live as long. `comm`: that of both */
PetscErrorCode TransferCreate(MPI_Comm comm, Surface dirichlet, Surface neumann, Obstacle obstacle, const TransferOptions *options,
                              Transfer *transfer)
{
  PetscMPIInt rank;
  Transfer    t;

  PetscFunctionBegin;
  PetscCall(InterfaceInitializePackage());
  PetscCall(PetscHeaderCreate(*transfer, TRANSFER_CLASSID, "Transfer", "Rows between contact surfaces", "Interface", comm, TransferDestroy,
                              NULL));
  PetscCheck(!neumann != !obstacle, comm, PETSC_ERR_ARG_WRONG, "A transfer is between a surface and either another surface or an obstacle");
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  t            = *transfer;
  t->comm      = options->owned ? PETSC_COMM_SELF : comm;
  t->idle      = (PetscBool)(options->owned && rank != options->owner);
  t->dirichlet = dirichlet;
  t->neumann   = neumann;
  t->obstacle  = obstacle;
  t->dim       = dirichlet->data.dim;
  t->n         = dirichlet->data.n_owned;
  t->options   = *options;
  if (!options->boundaries[0]) { /* the surfaces are the whole boundaries */
    t->options.boundaries[0] = dirichlet;
    t->options.boundaries[1] = neumann;
  }
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
  if (options->turns) PetscCall(TransferSetUpTurns(t));
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
  PetscCall(RowSetDestroy(&(*transfer)->saved.rows));
  for (PetscInt side = 0; side < 2; side++) PetscCall(PetscFree((*transfer)->saved.state[side]));
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
  transfer->options.slip_bound  = slip;
  transfer->options.angle_bound = angle;
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
