/* What HDF5 files of a run have in common. Functions are not collective: one rank calls them. */
#include "hdf5file.h"
#include <impakt.h>
#include <sys/optionstext.h>
#include <sys/units.h>

/* Ends with an error if HDF5 could not do something */
PetscErrorCode HDF5Check(hid_t result, const char what[], const char path[])
{
  PetscFunctionBegin;
  PetscCheck(result >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "HDF5 cannot %s in %s; is the disk full, or the file damaged?", what,
             path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Creates a file, replacing what is there. In the format of HDF5 1.8 and newer: the older one looks through all attributes for each that is
   added, and those of the root are the options. A history of 2560 bodies, of 31 000 options, took minutes to create */
PetscErrorCode HDF5Create(const char path[], hid_t *file)
{
  hid_t access;

  PetscFunctionBegin;
  access = H5Pcreate(H5P_FILE_ACCESS);
  PetscCall(HDF5Check(access, "make a property list", path));
  PetscCall(HDF5Check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST), "choose a format", path));
  *file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
  PetscCall(HDF5Check(*file, "create a file", path));
  PetscCall(HDF5Check(H5Pclose(access), "close a property list", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes a dataset, and the groups that it is in. `most`: the sizes that it may grow to, NULL: those that it has; `layout`: of its creation,
   which is closed, or H5P_DEFAULT */
PetscErrorCode HDF5CreateDataset(hid_t file, const char name[], hid_t type, int n, const hsize_t size[], const hsize_t most[], hid_t layout,
                                 const char path[], hid_t *dataset)
{
  hid_t space, links;

  PetscFunctionBegin;
  space = H5Screate_simple(n, size, most);
  PetscCall(HDF5Check(space, "make a data space", path));
  links = H5Pcreate(H5P_LINK_CREATE);
  PetscCall(HDF5Check(H5Pset_create_intermediate_group(links, 1), "make groups", path));
  *dataset = H5Dcreate2(file, name, type, space, links, layout, H5P_DEFAULT);
  PetscCall(HDF5Check(*dataset, "create a dataset", path));
  PetscCall(HDF5Check(H5Pclose(links), "close a property list", path));
  if (layout != H5P_DEFAULT) PetscCall(HDF5Check(H5Pclose(layout), "close a property list", path));
  PetscCall(HDF5Check(H5Sclose(space), "close a data space", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds an attribute: a string of variable length, or `fixed`, in the object's own header: fast with ten thousands of datasets */
PetscErrorCode HDF5WriteText(hid_t object, const char name[], const char value[], PetscBool fixed, const char path[])
{
  hid_t  type, space, attribute;
  size_t length;

  PetscFunctionBegin;
  PetscCall(PetscStrlen(value, &length));
  type = H5Tcopy(H5T_C_S1);
  PetscCall(HDF5Check(H5Tset_size(type, fixed ? length + 1 : H5T_VARIABLE), "make a string type", path));
  PetscCall(HDF5Check(H5Tset_cset(type, H5T_CSET_UTF8), "make a string type", path));
  space = H5Screate(H5S_SCALAR);
  PetscCall(HDF5Check(space, "make a data space", path));
  attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  PetscCall(HDF5Check(attribute, "create an attribute", path));
  PetscCall(HDF5Check(H5Awrite(attribute, type, fixed ? (const void *)value : (const void *)&value), "write an attribute", path));
  PetscCall(HDF5Check(H5Aclose(attribute), "write an attribute", path));
  PetscCall(HDF5Check(H5Sclose(space), "close a data space", path));
  PetscCall(HDF5Check(H5Tclose(type), "close a type", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the options, the version and the units of a run as attributes, so that a file tells how it was made */
PetscErrorCode HDF5WriteRun(hid_t file, const char options[], const char path[])
{
  const char *name, *value;
  char       *copy, *rest;
  Units       units;

  PetscFunctionBegin;
  PetscCall(UnitsGet(NULL, &units));
  PetscCall(HDF5WriteText(file, "version", IMPAKT_VERSION, PETSC_FALSE, path));
  PetscCall(HDF5WriteText(file, "units", UnitsNames[units], PETSC_FALSE, path));
  PetscCall(PetscStrallocpy(options, &copy));
  for (rest = copy; OptionsTextNext(&rest, &name, &value);) PetscCall(HDF5WriteText(file, name, value, PETSC_FALSE, path));
  PetscCall(PetscFree(copy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* HDF5SilenceBegin - keeps HDF5 from printing errors itself, which would hide Impakt's message */
void HDF5SilenceBegin(HDF5Silence *silence)
{
  H5Eget_auto2(H5E_DEFAULT, &silence->print, &silence->data);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

/* HDF5SilenceEnd - lets HDF5 print errors again. Not after an error: HDF5 would complain at exit of the unfinished file. */
void HDF5SilenceEnd(const HDF5Silence *silence)
{
  H5Eset_auto2(H5E_DEFAULT, silence->print, silence->data);
}
