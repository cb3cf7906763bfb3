/* What differs between the PETSc versions that Impakt builds with, in one place. */
#pragma once
#include <petscversion.h>

#if PETSC_VERSION_LT(3, 21, 0)
  #error "Impakt needs PETSc 3.21 or newer (TSAlpha2SetPredictor)"
#endif
#if PETSC_VERSION_LT(3, 26, 0)
  #define SNESLINESEARCHNONE SNESLINESEARCHBASIC
#endif
