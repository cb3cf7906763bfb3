/* Options files, as the program takes them: looked at, read by PETSc, their values checked, the unknown ones named */
#include "fuzz.h"
#include <sys/optionsfiles.h>
#include <sys/optionvalues.h>

int LLVMFuzzerTestOneInput(const uint8_t data[], size_t size)
{
  const char *const names[] = {"left", "right"};
  char              path[64], error[1024] = "";
  PetscOptions      options;

  FuzzWrite(data, size, ".opts", path, sizeof(path));
  if (PetscOptionsCreate(&options) || PetscOptionsPush(options)) abort();
  if (!OptionsFileCheck(path, error, sizeof(error)) && !error[0] && !PetscOptionsInsertFile(PETSC_COMM_SELF, options, path, PETSC_TRUE)) {
    FUZZ_IGNORE(OptionsCheckValues());
    FUZZ_IGNORE(ImpaktCheckOptions(2, names));
  }
  if (PetscOptionsPop() || PetscOptionsDestroy(&options)) abort();
  (void)unlink(path);
  return 0;
}
