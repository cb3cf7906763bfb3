/* Mesh files of Exodus II in NetCDF's classic containers and in HDF5 */
#include "fuzz.h"
#include <mesh/meshimpl.h>

int LLVMFuzzerTestOneInput(const uint8_t data[], size_t size)
{
  char path[64];
  DM   dm = NULL;

  FuzzWrite(data, size, ".g", path, sizeof(path));
  FUZZ_IGNORE(MeshCreateFromFile(PETSC_COMM_WORLD, "body_", "body", path, &dm));
  FUZZ_IGNORE(DMDestroy(&dm));
  (void)unlink(path);
  return 0;
}
