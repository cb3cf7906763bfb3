/* Dimensions and variables of an Exodus II file, which it may lack or have in another size. */
#include "exodusimpl.h"

/* A dimension of the NetCDF file; 0 if the file does not have it */
PetscErrorCode ExodusGetDimension(const Exodus *exodus, const char name[], PetscInt *length)
{
  int    dimension, status = nc_inq_dimid(exodus->id, name, &dimension);
  size_t n = 0;

  PetscFunctionBegin;
  *length = 0;
  if (status == NC_EBADDIM) PetscFunctionReturn(PETSC_SUCCESS);
  NetCDFCall(status, "dimension '%s'", name);
  NetCDFCall(nc_inq_dimlen(exodus->id, dimension, &n), "dimension '%s'", name);
  PetscCheck(n < PETSC_INT_MAX / 8, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "dimension '%s' is %zu, too many", name, n);
  *length = (PetscInt)n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A dimension whose name ends with the number of a set or block */
PetscErrorCode ExodusGetDimensionOf(const Exodus *exodus, const char name[], PetscInt number, PetscInt *length)
{
  char full[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(full, sizeof(full), "%s%" PetscInt_FMT, name, number));
  PetscCall(ExodusGetDimension(exodus, full, length));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds a variable that the file must have, with n values */
PetscErrorCode ExodusFindVariable(const Exodus *exodus, const char name[], PetscInt n, int *variable)
{
  int    rank, dimensions[NC_MAX_VAR_DIMS], status = nc_inq_varid(exodus->id, name, variable);
  double total = 1;

  PetscFunctionBegin;
  PetscCheck(status != NC_ENOTVAR, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "it has no variable '%s'", name);
  NetCDFCall(status, "variable '%s'", name);
  NetCDFCall(nc_inq_varndims(exodus->id, *variable, &rank), "variable '%s'", name);
  NetCDFCall(nc_inq_vardimid(exodus->id, *variable, dimensions), "variable '%s'", name);
  for (int d = 0; d < rank; d++) {
    size_t length;

    NetCDFCall(nc_inq_dimlen(exodus->id, dimensions[d], &length), "variable '%s'", name);
    total *= (double)length;
  }
  PetscCheck(total == (double)n, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "variable '%s' has %.0f values, where %" PetscInt_FMT " are expected", name, total, n);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the n values of a variable whose name ends with a number, into one of the two arrays that the reader keeps */
PetscErrorCode ExodusReadInts(Exodus *exodus, const char name[], PetscInt number, PetscInt n, PetscInt place, const int *values[])
{
  char full[64];
  int  variable;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(full, sizeof(full), "%s%" PetscInt_FMT, name, number));
  PetscCall(ExodusFindVariable(exodus, full, n, &variable));
  PetscCall(PetscFree(exodus->values[place]));
  PetscCall(PetscMalloc1(n, &exodus->values[place]));
  NetCDFCall(nc_get_var_int(exodus->id, variable, exodus->values[place]), "variable '%s'", full);
  *values = exodus->values[place];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of the i-th block or set, from a variable such as eb_prop1; i + 1 if the file has no such variable */
PetscErrorCode ExodusReadNumber(const Exodus *exodus, const char kind[], PetscInt i, PetscInt *number)
{
  char   full[64];
  int    variable, value;
  size_t at = (size_t)i;

  PetscFunctionBegin;
  *number = i + 1;
  PetscCall(PetscSNPrintf(full, sizeof(full), "%s_prop1", kind));
  if (nc_inq_varid(exodus->id, full, &variable)) PetscFunctionReturn(PETSC_SUCCESS);
  NetCDFCall(nc_get_var1_int(exodus->id, variable, &at, &value), "variable '%s'", full);
  PetscCheck(value >= 0, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "variable '%s' has the number %d, which is negative", full, value);
  *number = value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name of the i-th block or set; empty if it has none */
PetscErrorCode ExodusReadName(const Exodus *exodus, const char kind[], PetscInt i, char name[MESH_NAME_LENGTH])
{
  char   full[64];
  int    variable, rank, dimensions[NC_MAX_VAR_DIMS];
  size_t start[2] = {(size_t)i, 0}, count[2] = {1, MESH_NAME_LENGTH - 1}, n, length;

  PetscFunctionBegin;
  name[0] = 0;
  PetscCall(PetscSNPrintf(full, sizeof(full), "%s_names", kind));
  if (nc_inq_varid(exodus->id, full, &variable)) PetscFunctionReturn(PETSC_SUCCESS);
  NetCDFCall(nc_inq_varndims(exodus->id, variable, &rank), "variable '%s'", full);
  PetscCheck(rank == 2, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "variable '%s' has %d dimensions, where 2 are expected", full, rank);
  NetCDFCall(nc_inq_vardimid(exodus->id, variable, dimensions), "variable '%s'", full);
  NetCDFCall(nc_inq_dimlen(exodus->id, dimensions[1], &n), "variable '%s'", full);
  count[1] = PetscMin(count[1], n);
  PetscCall(PetscMemzero(name, MESH_NAME_LENGTH));
  NetCDFCall(nc_get_vara_text(exodus->id, variable, start, count, name), "variable '%s'", full);
  PetscCall(PetscStrlen(name, &length));
  while (length && name[length - 1] == ' ') name[--length] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
