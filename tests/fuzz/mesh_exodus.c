/* Mesh files of Exodus II in NetCDF's classic containers. Of 5500 damaged files in HDF5 containers 18 had HDF5 1.10.8 crash, and 5 had it
   go round without end, nearly all in its global heap (H5HG_read()), while the NetCDF library asks for the variables: the seeds have none.
 */
#include "fuzz.h"
#include <mesh/meshimpl.h>

int LLVMFuzzerTestOneInput(const uint8_t data[], size_t size)
{
  char        path[64];
  DM          dm      = NULL;
  MeshMiddles middles = {NULL, NULL};

  FuzzWrite(data, size, ".g", path, sizeof(path));
  FUZZ_IGNORE(MeshCreateFromFile(PETSC_COMM_WORLD, "body_", "body", path, &dm, &middles));
  FUZZ_IGNORE(MeshMiddlesDestroy(&middles));
  FUZZ_IGNORE(DMDestroy(&dm));
  (void)unlink(path);
  return 0;
}
