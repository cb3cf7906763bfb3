/* Rods from options: a disc, or a half or a quarter of it, drawn out along z. */
#include "ballimpl.h"

static PetscErrorCode ReadRod(MPI_Comm comm, const char prefix[], Ball *disc)
{
  const BallOptions options = {"-rod_radius", "-rod_divisions", "-rod_layers", "-rod_part", "-rod_keep_volume"};
  PetscInt          dim = 3, elements = 10;

  PetscFunctionBegin;
  *disc = (Ball){.dim = 2, .divisions = 4, .radius = 1, .length = 1, .grading = 1, .keep_volume = PETSC_TRUE, .pole = {0, -1, 0}};
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-dm_plex_dim", &dim, NULL));
  PetscCheck(dim == 3, comm, PETSC_ERR_USER_INPUT, "-%sdm_plex_dim %" PetscInt_FMT ": -%sdm_plex_shape rod has 3 dimensions", prefix, dim,
             prefix);
  PetscCall(BallReadSection(comm, prefix, &options, disc));
  PetscCall(BallReadLength(comm, prefix, "-rod_length", &disc->length));
  PetscCall(BallReadCount(comm, prefix, "-rod_elements", &elements));
  PetscCheck(elements < PETSC_INT_MAX / 24, comm, PETSC_ERR_USER_INPUT, "-%srod_elements %" PetscInt_FMT " are too many: take fewer",
             prefix, elements);
  disc->sections = disc->step * elements;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A rod from options, along z from 0, and where the nodes in the middle of its edges are, if it has some */
PetscErrorCode MeshCreateRod(MPI_Comm comm, const char prefix[], const char name[], PetscMPIInt rank, DM *dm, MeshMiddles *middles)
{
  Ball      disc;
  PetscReal missing;
  char      where[256];

  PetscFunctionBegin;
  PetscCall(ReadRod(comm, prefix, &disc));
  PetscCall(PetscSNPrintf(where, sizeof(where), "Body '%s', -%sdm_plex_shape rod", name, prefix));
  PetscCall(BallCreate(comm, &disc, where, rank, dm, middles, &missing));
  PetscFunctionReturn(PETSC_SUCCESS);
}
