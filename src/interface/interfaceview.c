/* What surfaces and transfers tell of themselves. */
#include "interfaceimpl.h"
#include <sys/units.h>

/* Whether there is anything to print on: ASCII viewers alone; standard output where none is given */
static PetscErrorCode IsPrinted(PetscObject object, PetscViewer *viewer, PetscBool *printed)
{
  PetscFunctionBegin;
  if (!*viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm(object), viewer));
  PetscValidHeaderSpecific(*viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)*viewer, PETSCVIEWERASCII, printed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  SurfaceView - prints how many faces and nodes a surface has, and its area

  Collective

  Input Parameters:
+ surface - the `Surface`
- viewer  - an ASCII viewer, `NULL` for standard output

  Level: developer

.seealso: `Surface`, `SurfaceViewFromOptions()`
@*/
PetscErrorCode SurfaceView(Surface surface, PetscViewer viewer)
{
  const SurfaceData       *data;
  PetscInt                 counts[2];
  static const char *const powers[] = {"^0", "^1", "^2"};
  const char              *unit;
  PetscReal                area = 0;
  PetscBool                printed;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(surface, SURFACE_CLASSID, 1);
  PetscCall(IsPrinted((PetscObject)surface, &viewer, &printed));
  if (!printed) PetscFunctionReturn(PETSC_SUCCESS);
  unit      = UnitsOf((PetscObject)surface, UNIT_LENGTH);
  data      = &surface->data;
  counts[0] = data->n_faces;
  counts[1] = data->n_owned;
  for (PetscInt f = 0; f < data->n_faces; f++) area += data->face_areas[f];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)surface)));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &area, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)surface)));
  PetscCall(PetscViewerASCIIPrintf(viewer, "surface %s: %" PetscInt_FMT " faces, %" PetscInt_FMT " nodes, area %g%s%s\n",
                                   ((PetscObject)surface)->name, counts[0], counts[1], (double)area, unit,
                                   unit[0] ? powers[data->dim - 1] : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  SurfaceViewFromOptions - prints a surface where an option asks for it

  Collective

  Input Parameters:
+ surface - the `Surface`
. object  - has the prefix of the option, `NULL` for the surface
- name    - the option

  Options Database Key:
. -contact_surface_view - print the surfaces of all contact pairs at the set-up

  Level: developer

.seealso: `Surface`, `SurfaceView()`, `PetscObjectViewFromOptions()`
@*/
PetscErrorCode SurfaceViewFromOptions(Surface surface, PetscObject object, const char name[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(surface, SURFACE_CLASSID, 1);
  PetscCall(PetscObjectViewFromOptions((PetscObject)surface, object, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferView - prints what a transfer joins, how many of its rows have something opposite, and how often they have been built

  Collective

  Input Parameters:
+ transfer - the `Transfer`, updated once at least
- viewer   - an ASCII viewer, `NULL` for standard output

  Level: developer

.seealso: `Transfer`, `TransferViewFromOptions()`
@*/
PetscErrorCode TransferView(Transfer transfer, PetscViewer viewer)
{
  const char *partner;
  PetscInt    counts[2] = {0, 0};
  PetscBool   printed;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCall(IsPrinted((PetscObject)transfer, &viewer, &printed));
  if (!printed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  counts[0] = transfer->n;
  for (PetscInt i = 0; i < transfer->n; i++) counts[1] += transfer->rows.opposite[i] ? 1 : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)transfer)));
  PetscCall(PetscObjectGetName(transfer->neumann ? (PetscObject)transfer->neumann : (PetscObject)transfer->obstacle, &partner));
  PetscCall(PetscViewerASCIIPrintf(viewer,
                                   "transfer %s:%s: %" PetscInt_FMT " of %" PetscInt_FMT
                                   " nodes have something opposite, built %" PetscInt_FMT
                                   " times, bounds: slip %g of a face, angle %g rad\n",
                                   ((PetscObject)transfer->dirichlet)->name, partner, counts[1], counts[0], transfer->counts.builds,
                                   (double)transfer->slip_bound, (double)transfer->angle_bound));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferViewFromOptions - prints a transfer where an option asks for it

  Collective

  Input Parameters:
+ transfer - the `Transfer`, updated once at least
. object   - has the prefix of the option, `NULL` for the transfer
- name     - the option

  Options Database Key:
. -contact_transfer_view - print the transfers of all contact pairs at the set-up

  Level: developer

.seealso: `Transfer`, `TransferView()`, `PetscObjectViewFromOptions()`
@*/
PetscErrorCode TransferViewFromOptions(Transfer transfer, PetscObject object, const char name[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCall(PetscObjectViewFromOptions((PetscObject)transfer, object, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}
