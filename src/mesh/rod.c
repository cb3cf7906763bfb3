/* Rods from options: a disc, or a half or a quarter of it, drawn out along z. */
#include "ballimpl.h"

static PetscErrorCode ReadLength(MPI_Comm comm, const char prefix[], const char option[], PetscReal *value)
{
  PetscReal values[4];
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(MeshReadNumbers(comm, prefix, option, 1, "a length [m]", values, &set));
  if (set) *value = values[0];
  PetscCheck(*value > 0, comm, PETSC_ERR_USER_INPUT, "-%s%s %g: must be positive", prefix, option + 1, (double)*value);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadCount(MPI_Comm comm, const char prefix[], const char option[], PetscInt *value)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsGetInt(NULL, prefix, option, value, NULL));
  PetscCheck(*value >= 1, comm, PETSC_ERR_USER_INPUT, "-%s%s %" PetscInt_FMT ": there must be at least 1", prefix, option + 1, *value);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadPart(MPI_Comm comm, const char prefix[], Ball *disc)
{
  const char *const parts[] = {"full", "half", "quarter"};
  PetscInt          part    = 0;
  PetscBool         set;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetEList(NULL, prefix, "-rod_part", parts, 3, &part, &set));
  disc->n_cuts = part;
  PetscCheck(!part || disc->divisions % 2 == 0, comm, PETSC_ERR_USER_INPUT,
             "-%srod_divisions %" PetscInt_FMT ": must be even for -%srod_part %s, which cuts the central block in its middle", prefix,
             disc->divisions, prefix, parts[part]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadRod(MPI_Comm comm, const char prefix[], Ball *disc)
{
  PetscInt dim = 3, elements = 10;

  PetscFunctionBegin;
  *disc = (Ball){.dim = 2, .divisions = 4, .radius = 1, .length = 1, .grading = 1, .keep_volume = PETSC_TRUE, .pole = {0, -1, 0}};
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-dm_plex_dim", &dim, NULL));
  PetscCheck(dim == 3, comm, PETSC_ERR_USER_INPUT, "-%sdm_plex_dim %" PetscInt_FMT ": -%sdm_plex_shape rod has 3 dimensions", prefix, dim,
             prefix);
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-dm_plex_simplex", &disc->simplex, NULL));
  PetscCall(ReadLength(comm, prefix, "-rod_radius", &disc->radius));
  PetscCall(ReadLength(comm, prefix, "-rod_length", &disc->length));
  PetscCall(ReadCount(comm, prefix, "-rod_divisions", &disc->divisions));
  disc->layers = (disc->divisions + 1) / 2;
  PetscCall(ReadCount(comm, prefix, "-rod_layers", &disc->layers));
  PetscCall(ReadCount(comm, prefix, "-rod_elements", &elements));
  PetscCheck(elements < PETSC_INT_MAX / 24, comm, PETSC_ERR_USER_INPUT, "-%srod_elements %" PetscInt_FMT " are too many: take fewer",
             prefix, elements);
  PetscCall(ReadPart(comm, prefix, disc));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-rod_keep_volume", &disc->keep_volume, NULL));
  PetscCall(BallChooseOrder(prefix, disc));
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
