/* Which surfaces of a body may touch another one by the options, before there is a mesh: their faces are work to spread over ranks. */
#include "meshimpl.h"
#include <sys/names.h>

/* Work for a face in contact, in explicit hexahedra: two bars of 3.5e5 of these and 3904 faces took 73 ms a step apart, 85 ms in contact */
#define CONTACT_COST 15

/* Adds a surface to the list if one side of a pair, such as left.xmax, is that surface of the body with this name */
static PetscErrorCode AddSide(const char name[], const char side[], PetscInt *n, char ***names)
{
  char      body[256], *dot;
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(body, side, sizeof(body)));
  PetscCall(PetscStrchr(body, '.', &dot));
  if (!dot) PetscFunctionReturn(PETSC_SUCCESS);
  *dot = 0;
  PetscCall(PetscStrcmp(body, name, &same));
  for (PetscInt i = 0; i < *n && same; i++) {
    PetscBool known;

    PetscCall(PetscStrcmp((*names)[i], dot + 1, &known));
    if (known) same = PETSC_FALSE;
  }
  if (!same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscRealloc((size_t)(*n + 1) * sizeof(**names), names));
  PetscCall(PetscStrallocpy(dot + 1, &(*names)[(*n)++]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadPairs(const char name[], PetscInt *n, char ***names)
{
  char   **pairs;
  PetscInt n_pairs;

  PetscFunctionBegin;
  PetscCall(NamesRead(NULL, "-contact_pairs", &n_pairs, &pairs, NULL));
  for (PetscInt p = 0; p < n_pairs; p++) {
    char *second;

    PetscCall(PetscStrchr(pairs[p], ':', &second));
    if (!second) PetscCall(PetscStrchr(pairs[p], '~', &second));
    if (!second) continue; /* a word such as auto, or a mistake, which whoever makes the pairs finds */
    *second = 0;
    PetscCall(AddSide(name, pairs[p], n, names));
    PetscCall(AddSide(name, second + 1, n, names));
  }
  PetscCall(NamesDestroy(n_pairs, &pairs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Names of the surfaces of a body that may touch another one, and the work for one of their faces; free the names with NamesDestroy() */
PetscErrorCode MeshReadContact(MPI_Comm comm, const char prefix[], const char name[], PetscInt *n, char ***names, PetscReal *cost)
{
  PetscBool set;

  PetscFunctionBegin;
  *cost = CONTACT_COST;
  PetscCall(PetscOptionsGetReal(NULL, prefix, "-mesh_contact_cost", cost, NULL));
  PetscCheck(*cost >= 0 && *cost <= 1e6, comm, PETSC_ERR_USER_INPUT,
             "-%smesh_contact_cost %g: the work for a face in contact, in units of that for an element, must be from 0 to 1e6", prefix,
             (double)*cost);
  PetscCall(NamesRead(prefix, "-mesh_contact_surfaces", n, names, &set));
  if (!set) PetscCall(ReadPairs(name, n, names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surfaces that the user has named must be there, on any number of ranks */
PetscErrorCode MeshCheckContact(DM dm, const char prefix[])
{
  char   **names, missing[PETSC_MAX_OPTION_NAME] = "";
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(NamesRead(prefix, "-mesh_contact_surfaces", &n, &names, NULL));
  for (PetscInt i = 0; i < n && !missing[0]; i++) {
    PetscBool has;

    PetscCall(MeshHasSurface(dm, names[i], &has));
    if (!has) PetscCall(PetscStrncpy(missing, names[i], sizeof(missing)));
  }
  PetscCall(NamesDestroy(n, &names));
  PetscCheck(
      !missing[0], PetscObjectComm((PetscObject)dm), PETSC_ERR_USER_INPUT,
      "-%smesh_contact_surfaces: the mesh has no surface '%s'; give names of surfaces as in -contact_pairs, with commas between them",
      prefix, missing);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of a side (xmin, xmax, ymin, ...) in the face sets of DMPLEX's boxes */
PetscInt MeshBoxSideNumber(PetscInt dim, PetscInt side)
{
  static const PetscInt numbers[3][6] = {{1, 2}, {4, 2, 1, 3}, {6, 5, 3, 4, 1, 2}};

  return numbers[dim - 1][side];
}

/* Marks the sides of a box that may touch another body. Names that the mesh does not have MeshCheckContact() finds. */
PetscErrorCode MeshBoxMarkContact(MPI_Comm comm, const char prefix[], const char name[], MeshBox *box)
{
  const char *const sides[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  char            **names;
  PetscInt          n;

  PetscFunctionBegin;
  PetscCall(MeshReadContact(comm, prefix, name, &n, &names, &box->contact_cost));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt side = 0; side < 2 * box->dim; side++) {
      char      number[16];
      PetscBool same[2];

      PetscCall(PetscSNPrintf(number, sizeof(number), "%" PetscInt_FMT, MeshBoxSideNumber(box->dim, side)));
      PetscCall(PetscStrcmp(names[i], sides[side], &same[0]));
      PetscCall(PetscStrcmp(names[i], number, &same[1]));
      if (same[0] || same[1]) box->contact[side] = PETSC_TRUE;
    }
  PetscCall(NamesDestroy(n, &names));
  PetscFunctionReturn(PETSC_SUCCESS);
}
