/* Mesh files of Gmsh, versions 2.2 and 4.1, text and binary */
#include "fuzz.h"
#include <mesh/meshimpl.h>

int LLVMFuzzerTestOneInput(const uint8_t data[], size_t size)
{
  char        path[64];
  DM          dm      = NULL;
  MeshMiddles middles = {NULL, NULL};

  FuzzWrite(data, size, ".msh", path, sizeof(path));
  FUZZ_IGNORE(MeshCreateFromFile(PETSC_COMM_WORLD, "body_", "body", path, &dm, &middles));
  FUZZ_IGNORE(MeshMiddlesDestroy(&middles));
  FUZZ_IGNORE(DMDestroy(&dm));
  (void)unlink(path);
  return 0;
}
