/* Runs whose bodies begin with the state of a checkpoint: displacements, velocities and the history of materials at a new time, under other
   loads, with other integrators, on any number of ranks. Nodes are found by their places in the mesh. */
#include <body/interface/bodyvisit.h>
#include "outputimpl.h"
#include <impakt/private/contactsteps.h>
#include <sys/units.h>

/* The bodies begin with the state of the checkpoint -restart_state, as far as it has them. Collective; before the first step. */
PetscErrorCode OutputTakeState(Output output, const char path[])
{
  MPI_Comm       comm = PetscObjectComm((PetscObject)output);
  CheckpointFile file;
  const Body    *bodies;
  Contact        contact;
  Tables         tables;
  PetscReal      start;
  PetscInt       n, found = 0;
  char           again[256] = "";

  PetscFunctionBegin;
  PetscCall(CheckpointFileOpen(comm, "-restart_state", path, &file));
  PetscCall(CheckpointFileReadTables(comm, &file, &tables));
  PetscCall(ControllerGetBodies(output->controller, &n, &bodies));
  for (PetscInt b = 0; b < n; b++) {
    const char *name;
    PetscBool   has;

    PetscCall(PetscObjectGetName((PetscObject)bodies[b], &name));
    PetscCall(BodyTakeState(bodies[b], tables, &has));
    if (!has)
      PetscCall(
          PetscFPrintf(comm, stderr, "impakt: warning: -restart_state %s has no body '%s', which begins as its options say\n", path, name));
    found += has;
  }
  PetscCall(TablesDestroy(&tables));
  PetscCheck(found, comm, PETSC_ERR_USER_INPUT, "-restart_state %s has none of the bodies of this run", path);
  PetscCall(ControllerGetContact(output->controller, &contact));
  PetscCall(ContactTakeStart(contact, PETSC_TRUE));
  PetscCall(ControllerGetTimes(output->controller, &start, NULL, NULL));
  if (start != file.info.time)
    PetscCall(PetscSNPrintf(again, sizeof(again),
                            "; time starts again at %g%s, and so do formulas in t of loads and displacements: a load that is to stay needs "
                            "its value there, or -time_start %.9g, with which formulas go on",
                            (double)start, UnitsOf((PetscObject)output->controller, UNIT_TIME), (double)file.info.time));
  PetscCall(PetscFPrintf(comm, stderr, "impakt: begun with the state of %s, after its controller step %" PetscInt_FMT " at time %g%s%s\n",
                         path, file.info.step, (double)file.info.time, UnitsOf((PetscObject)output->controller, UNIT_TIME), again));
  PetscCall(CheckpointFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}
